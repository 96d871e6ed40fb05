//! What the lab does beside the window: a large body is meshed and solved by an errand, one at a time. Meanwhile the last
//! picture stays, of one state as it was; edits change what is wanted, and the last of them is what the next errand takes
//! along.

use std::time::Instant;

use egui::{Align2, Rect, Ui};

use super::{Lab, has_mesh_of};
use crate::app::action::Action;
use crate::app::document::Document;
use crate::app::drawing::Drawing;
use crate::app::edits::Snapshot;
use crate::app::errand::{Bodies, Done, Ended, Errand, News, Order, Picture, Refused, Start};
use crate::app::job::Heard;
use crate::app::language::{fill, tr, translated};
use crate::app::palette::Palette;
use crate::app::quality::Quality;
use crate::app::size::MOST_ALONE;
use crate::scene::{Analysis, Scene};
use crate::simulation::Status;

/// The work beside the window.
#[derive(Debug)]
pub(super) struct Beside {
    /// More unknowns than this are not solved between two frames.
    most_unknowns: u64,
    errand: Option<Errand>,
    /// What an errand has brought back that is not to be shown.
    back: Option<(Bodies, Option<Drawing>)>,
    /// Where the next solve begins, and the iterations that are asked for, if not all.
    start: Start,
    steps: Option<u32>,
    /// How it was before the first of the edits that are not shown to their end yet.
    before: Option<Before>,
    /// What is to be said where there is a window to say it.
    pub(super) unsaid: Option<String>,
}

impl Default for Beside {
    fn default() -> Self {
        Self {
            most_unknowns: MOST_ALONE,
            errand: None,
            back: None,
            start: Start::There,
            steps: None,
            before: None,
            unsaid: None,
        }
    }
}

/// What a cancelled edit goes back to.
#[derive(Debug)]
struct Before {
    since: Instant,
    snapshot: Snapshot,
    /// Steps that could be undone.
    depth: usize,
    /// The control that was edited.
    label: Option<&'static str>,
    /// Whether the scene comes from somewhere else, and is not shown yet.
    adopts: bool,
    /// What was shown, once something else is.
    shown: Option<Picture>,
    quality: Quality,
}

impl Lab {
    /// More unknowns than this are meshed and solved beside the window, fewer between two frames.
    pub fn set_most_unknowns(&mut self, most: u64) {
        self.beside.most_unknowns = most;
    }

    /// Whether a large body is being meshed or solved beside the window.
    #[must_use]
    pub fn is_working(&self) -> bool {
        self.beside.errand.is_some()
    }

    /// Whether a scene is taken on beside the window: a large body that is meshed, or that is on its way to an
    /// equilibrium. Motions take their steps between frames.
    pub(super) fn goes_beside(&self, scene: &Scene) -> bool {
        let is_search = scene.analysis == Analysis::Static && self.simulation.motion().is_none();
        scene.unknowns() > self.beside.most_unknowns && (is_search || !has_mesh_of(scene, self.simulation.scene()))
    }

    /// Whether what is shown is solved beside the window.
    pub(super) fn is_beside(&self) -> bool {
        self.is_working() || self.goes_beside(&self.scene)
    }

    /// Takes note of a scene that is wanted from now on.
    pub(super) fn wish_for(&mut self, scene: Scene) {
        self.begin_beside();
        self.scene = scene;
        self.intro = None;
        self.call_off();
    }

    /// The scene that is wanted comes from here.
    pub(super) fn adopt_beside(&mut self, document: Document) {
        self.document = document;
        self.is_outdated = false;
        self.beside.start = Start::AtRest;
        if let Some(before) = &mut self.beside.before {
            before.adopts = true;
        }
        self.tend();
    }

    /// Names the control whose edit is on its way.
    pub(super) fn blame(&mut self, label: &'static str) {
        if let Some(before) = &mut self.beside.before {
            before.label = Some(label);
        }
    }

    /// Starts over at rest; or makes some iterations only.
    pub(super) fn restart_beside(&mut self, start: Start, steps: Option<u32>) {
        self.begin_beside();
        (self.beside.start, self.beside.steps) = (start, steps);
        self.call_off();
        self.tend();
    }

    /// Remembers how it is, to come back to.
    fn begin_beside(&mut self) {
        // What is away cannot be pulled.
        self.simulation.release();
        self.playback.release();
        if self.beside.before.is_none() {
            self.beside.before = Some(Before {
                since: Instant::now(),
                snapshot: self.snapshot(),
                depth: self.edits.depth(),
                label: None,
                adopts: false,
                shown: None,
                quality: Quality::default(),
            });
        }
    }

    /// Asks the errand to come back with what it has.
    pub(super) fn call_off(&self) {
        if let Some(errand) = &self.beside.errand {
            errand.job.call_off();
        }
    }

    /// There is no use for an errand any more.
    pub(super) fn recall(&mut self) {
        let most_unknowns = self.beside.most_unknowns;
        self.beside = Beside { most_unknowns, unsaid: self.beside.unsaid.take(), ..Beside::default() };
    }

    /// Hears of the errand, and sends another where there is something to do.
    pub(super) fn tend(&mut self) {
        while let Some(errand) = &self.beside.errand {
            match errand.job.hear() {
                Heard::Nothing => return,
                heard => self.take_heard(heard),
            }
        }
        self.send();
    }

    /// Waits until there is nothing to do beside the window.
    pub(super) fn finish_beside(&mut self) {
        self.tend();
        while let Some(errand) = &self.beside.errand {
            let heard = errand.job.wait();
            self.take_heard(heard);
            self.tend();
        }
    }

    fn take_heard(&mut self, heard: Heard<News, Ended>) {
        let Some(errand) = &mut self.beside.errand else { return };
        match heard {
            Heard::Nothing => {}
            Heard::News(News::Doing(doing)) => errand.doing = doing,
            Heard::News(News::Picture(_)) if errand.is_cancelled => {}
            Heard::News(News::Picture(picture)) => self.show_picture(*picture),
            Heard::Done(ended) => {
                if let Some(errand) = self.beside.errand.take() {
                    match ended {
                        Ok(done) => self.receive(&errand, *done),
                        Err(refused) => self.hear_refusal(&errand, *refused),
                    }
                }
            }
            Heard::Died => {
                self.beside.errand = None;
                self.go_back();
                // It would only end so again.
                self.running = false;
                self.beside.unsaid = Some(tr("The solve ended unexpectedly").to_owned());
            }
        }
    }

    fn receive(&mut self, errand: &Errand, done: Done) {
        let Done { picture, quality } = done;
        if errand.is_cancelled {
            if !errand.is_new {
                self.beside.back = Some((picture.bodies, None));
            }
            // What is shown is a copy of that body.
            if self.beside.back.is_some() && matches!(self.beside.start, Start::There) {
                self.beside.start = Start::From(self.simulation.state().clone());
            }
            return;
        }
        if errand.given != self.scene || !matches!(self.beside.start, Start::There) || self.beside.steps.is_some() {
            // Of another mesh it is of no use.
            if has_mesh_of(&self.scene, picture.bodies.simulation.scene()) {
                self.beside.back = Some((picture.bodies, picture.drawing));
            }
            return;
        }
        self.show_picture(picture);
        if let Some(quality) = quality {
            self.quality = quality;
        }
        (self.beside.before, self.beside.back) = (None, None);
    }

    fn hear_refusal(&mut self, errand: &Errand, refused: Refused) {
        self.beside.back = refused.bodies.or_else(|| self.beside.back.take());
        if errand.is_cancelled || errand.given != self.scene {
            return;
        }
        let label = self.beside.before.as_ref().and_then(|before| before.label);
        let message = refused.error.to_string();
        self.go_back();
        match label {
            Some(label) => _ = self.panel.messages.insert(label, message),
            None => self.beside.unsaid = Some(translated(&message)),
        }
    }

    /// Shows a picture in the place of the one before, with everything that belongs to it.
    fn show_picture(&mut self, picture: Picture) {
        let scene = self.simulation.scene().clone();
        let Picture { bodies, drawing, residuals } = picture;
        let simulation = std::mem::replace(&mut self.simulation, bodies.simulation);
        let linear = std::mem::replace(&mut self.linear, bodies.linear);
        let residuals = std::mem::replace(&mut self.residuals, residuals);
        let drawing = drawing.map(|drawing| std::mem::replace(&mut self.drawing, drawing));
        self.timings = *self.simulation.last_iteration();
        let adopts = self.beside.before.as_mut().is_some_and(|before| {
            if before.shown.is_none() {
                before.quality = std::mem::take(&mut self.quality);
                before.shown = Some(Picture { bodies: Bodies { simulation, linear }, drawing, residuals });
            }
            std::mem::take(&mut before.adopts)
        });
        self.take_over(&scene);
        if adopts {
            self.start_fresh();
        }
    }

    /// Sends an errand, if there is something to do for one.
    fn send(&mut self) {
        if !self.goes_beside(&self.scene) {
            return;
        }
        let own = self.beside.back.as_ref().map_or(&self.simulation, |(bodies, _)| &bodies.simulation);
        let is_new = !has_mesh_of(&self.scene, own.scene());
        let is_asked = own.scene() != &self.scene
            || !matches!(self.beside.start, Start::There)
            || self.beside.steps.is_some()
            || self.beside.back.is_some()
            || self.running && *own.status() == Status::Running;
        if !is_new && (!is_asked || own.motion().is_some()) {
            self.beside.before = None;
            return;
        }
        self.begin_beside();
        let bodies = if is_new { None } else { self.take_bodies() };
        if !is_new && bodies.is_none() {
            return;
        }
        let order = Order {
            scene: self.scene.clone(),
            bodies,
            start: std::mem::take(&mut self.beside.start),
            iterations: self.beside.steps.take().or((!self.running).then_some(0)),
            residuals: self.residuals.clone(),
        };
        match Errand::start(order) {
            Ok(errand) => self.beside.errand = Some(errand),
            Err(error) => {
                self.go_back();
                self.running = false;
                self.beside.unsaid = Some(fill!("No thread for the solve: %{error}", error = error));
            }
        }
    }

    /// The body itself, to be sent away; a copy of it stays.
    fn take_bodies(&mut self) -> Option<(Bodies, Option<Drawing>)> {
        if let Some(back) = self.beside.back.take() {
            return Some(back);
        }
        let simulation = self.simulation.snapshot()?;
        let linear = self.linear.as_ref().and_then(crate::simulation::Simulation::snapshot);
        let simulation = std::mem::replace(&mut self.simulation, simulation);
        let linear = std::mem::replace(&mut self.linear, linear);
        Some((Bodies { simulation, linear }, None))
    }

    /// Goes back to how it was before what is on its way.
    pub(super) fn cancel_work(&mut self) {
        if let Some(errand) = &mut self.beside.errand {
            errand.job.call_off();
            errand.is_cancelled = true;
        }
        self.go_back();
        // What had not come to its end would only go on.
        self.running &= self.simulation.is_at_rest();
    }

    fn go_back(&mut self) {
        (self.beside.start, self.beside.steps) = (Start::There, None);
        let Some(Before { snapshot, depth, shown, quality, .. }) = self.beside.before.take() else { return };
        self.edits.take_back(depth);
        Snapshot { document: self.document, scene: self.scene, iterations: self.iterations } = snapshot;
        if let Some(Picture { bodies, drawing, residuals }) = shown {
            let scene = self.simulation.scene().clone();
            (self.simulation, self.linear, self.residuals) = (bodies.simulation, bodies.linear, residuals);
            self.quality = quality;
            if let Some(drawing) = drawing {
                self.drawing = drawing;
            }
            self.take_over(&scene);
        }
    }

    /// Says what is done beside the window, and how to stop it.
    pub(super) fn show_work(&self, ui: &Ui, rect: Rect, actions: &mut Vec<Action>) {
        let (Some(errand), Some(before)) = (&self.beside.errand, &self.beside.before) else { return };
        let palette = Palette::new(ui.visuals());
        let area = egui::Area::new(egui::Id::unique("work"))
            .order(egui::Order::Middle)
            .fixed_pos(rect.center_top() + egui::vec2(0.0, 52.0))
            .pivot(Align2::CENTER_TOP)
            .constrain_to(rect);
        area.show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.horizontal(|ui| {
                    let seconds = before.since.elapsed().as_secs();
                    ui.colored_label(palette.text, format!("{}\u{2026} {seconds} s", errand.words()));
                    if ui.button(tr("Cancel")).on_hover_text(tr("Back to how it was (Esc)")).clicked() {
                        actions.push(Action::Cancel);
                    }
                });
            });
        });
    }
}
