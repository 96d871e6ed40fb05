//! Mode Learn in the window: it has a desk of its own with the article's beam, and the user's desk is restored when it
//! ends.

use super::*;
use crate::app::modes::learn::{Learn, Setup};

impl Lab {
    /// Enters or leaves Learn after a change of the mode.
    pub(super) fn enter_or_leave(&mut self) {
        match (self.desk.view.mode == Mode::Learn, self.aside.take()) {
            (true, None) => self.enter(),
            (false, Some(aside)) => self.leave(*aside),
            (_, same) => self.aside = same,
        }
    }

    fn enter(&mut self) {
        let session = built_in("article")
            .and_then(|(source, scene)| Some(Session::new(source, scene.clone(), Simulation::new(&scene).ok()?)));
        let own = &mut self.desk;
        own.view.mode = Mode::Explore;
        let Some(session) = session else { return };
        let mut desk = Desk::new(session);
        desk.viewport.eases = own.viewport.eases;
        desk.viewport.view.rect = own.viewport.view.rect;
        // A card has the controls that it needs, so the panel is closed until the user opens it.
        let layout = LayoutOptions { panel: false, sheet: false, ..own.view.layout };
        desk.view = ViewOptions { mode: Mode::Learn, layout, raw: true, ..ViewOptions::default() };
        self.aside = Some(Box::new(std::mem::replace(own, desk)));
        self.set_card_up();
    }

    fn leave(&mut self, aside: Desk) {
        let ViewOptions { mode, tab, drawer, .. } = self.desk.view;
        self.desk = aside;
        self.learn = Learn::new(self.learn.card);
        let view = &mut self.desk.view;
        (view.mode, view.tab) = (mode, tab);
        // A drawer opened from a card stays open.
        view.drawer = drawer.filter(|drawer| *drawer == Drawer::of(self.desk.session.scene())).or(view.drawer);
    }

    /// Goes to card number `card`, from 0.
    pub(super) fn go_to_card(&mut self, card: usize) {
        if self.aside.is_some() {
            self.learn.go_to(card);
            self.set_card_up();
        }
    }

    /// Sets up the scene and the view of the card.
    pub(super) fn set_card_up(&mut self) {
        let setup = self.learn.card().setup;
        let Some((source, mut scene)) = built_in("article") else { return };
        setup.edit(&mut scene);
        let reach = setup.reach.and_then(|force| {
            let mut scene = scene.clone();
            Setup { force, ..setup }.edit(&mut scene);
            let mut simulation = Simulation::new(&scene).ok()?;
            simulation.solve();
            Some(simulation)
        });
        // Cannot fail: the article's beam suits the scene of every card.
        if self.set_scene(scene).is_err() {
            return;
        }
        self.learn.reach = reach;
        let Desk { session, viewport, view, panel, .. } = &mut self.desk;
        session.rebase(source);
        session.frame.is_slow = setup.waits;
        *panel = PanelState::default();
        view.color_with(setup.field);
        view.fixed_range = None;
        (view.lines.exact, view.lines.rest_outline, view.lines.ghost) = (setup.exact, setup.rest, false);
        viewport.camera.own = None;
        session.set_running(!setup.waits);
        if setup.waits {
            self.reset();
            let (viewport, content) = self.viewport_and_content();
            viewport.expect_bending(&content);
        }
    }
}
