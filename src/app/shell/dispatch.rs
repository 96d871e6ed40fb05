//! Dispatch of actions: edits go to the session, other actions to the part of the window that they concern; and messages
//! over the view. The mode Learn has a desk of its own with the article's beam; the user's desk is restored when it ends.

use super::*;
use crate::app::modes::compare::Compare;
use crate::app::modes::figure;
use crate::app::modes::learn::{self, Learn, Setup};
use crate::app::panel::edges;
use crate::app::session::{Changed, Edit, Notice};
use crate::app::shell::files::banner;
use crate::app::viewport::arrow::vector;
use crate::app::viewport::objects::{self, Object};
use crate::app::viewport::pointer::Interaction;

/// Time for which a message is shown.
const TOAST: Duration = Duration::from_secs(4);

impl Lab {
    /// Updates the window after changes of the session.
    pub(super) fn apply_session_changes(&mut self) {
        let Desk { session, viewport, view, panel, compare, measure, .. } = &mut self.desk;
        let changed = std::mem::take(&mut session.changed);
        if changed == Changed::default() {
            return;
        }
        if changed.scene {
            let scene = session.simulation().scene();
            view.drawer = view.drawer.filter(|drawer| *drawer == Drawer::of(scene));
        }
        let mesh = session.simulation().system().mesh();
        if changed.mesh {
            // A camera set by the user is kept.
            viewport.camera.set_body(mesh.bounds().into());
            viewport.probe = None;
        }
        if changed.document || changed.restart {
            viewport.clear_swept();
        }
        if changed.document || compare.in_motion != session.is_motion() {
            *compare = Compare::new(session.is_motion());
        }
        if changed.document {
            *panel = PanelState::default();
            measure.open(session.scene());
            viewport.start(mesh);
            view.why = false;
            view.fixed_range = None;
            view.magnification = Magnification::default();
            self.learn.line = 0;
        }
    }

    /// Applies an edit, and shows a message if it is refused.
    pub(super) fn apply(&mut self, ctx: &Context, edit: Edit) -> bool {
        let applied = self.desk.session.apply(edit);
        self.apply_session_changes();
        if let Err(error) = &applied {
            self.say(ctx, said(error));
        }
        applied.is_ok()
    }

    pub(super) fn act(&mut self, ctx: &Context, action: Action) {
        // Bars and panel are laid out before the action; they show its effect in the next frame.
        ctx.request_repaint();
        match action {
            Action::Open(_) | Action::New(_) | Action::OpenFile | Action::Close => self.depart(ctx, action),
            Action::Reload => self.open(ctx, self.desk.session.document().source.clone()),
            Action::Save => self.save_here(ctx, None),
            Action::SaveAs => self.ask_where_to_save(ctx, None),
            Action::Undo if self.desk.session.undo.can_undo() => self.undo(ctx, Edit::Undo),
            Action::Redo if self.desk.session.undo.can_redo() => self.undo(ctx, Edit::Redo),
            Action::Undo | Action::Redo => {}
            Action::Escape if self.desk.view.help => self.desk.view.help = false,
            Action::Escape if self.desk.view.why => self.desk.view.why = false,
            Action::Cancel => self.desk.session.cancel(),
            Action::Escape if self.desk.session.is_working() => self.desk.session.cancel(),
            Action::Escape => self.desk.viewport.probe = None,
            Action::Edit(label, scene) => self.edit(ctx, label, scene),
            Action::ToggleRun => {
                let is_running = self.desk.session.is_running();
                // A body that has reached its end cannot be paused.
                if !(is_running && self.desk.has_ended()) {
                    self.desk.session.set_running(!is_running);
                }
            }
            Action::Forward if self.compares_motions() => self.step(),
            Action::Step => self.step(),
            Action::Scrub(_) | Action::Back | Action::Forward
                if !self.desk.session.is_motion()
                    || self.desk.session.is_in_background()
                    || self.compares_motions() => {}
            Action::Scrub(time) => self.desk.session.show_moment(time),
            Action::Back | Action::Forward => self.desk.session.show_neighbour(action == Action::Forward),
            Action::Reset => {
                self.reset();
                // A card that waits for its steps waits again.
                if self.aside.is_some() && self.learn.card().setup.waits {
                    self.desk.session.set_running(false);
                }
            }
            Action::Speed(speed) => {
                self.desk.session.playback.clock.set_speed(speed);
                self.desk.compare.clock.set_speed(speed);
            }
            Action::Fit => {
                self.desk.viewport.clear_swept();
                self.desk.viewport.camera.own = None;
                self.desk.compare.fit();
            }
            // The drawer of the other kind of scene does not exist here.
            Action::Toggle(Toggle::Drawer(drawer)) if drawer != Drawer::of(self.scene()) => {}
            Action::Toggle(Toggle::Tab(tab)) if !MeasureTab::of(self.scene()).contains(&tab) => {}
            Action::Toggle(toggle) => {
                self.desk.view.toggle(toggle);
                self.enter_or_leave();
            }
            Action::Card(card) => self.go_to_card(card),
            Action::Story => self.tell_story(),
            Action::Color(field) => self.desk.view.color_with(field),
            Action::ToggleTheme => {
                let dark = ctx.theme() == egui::Theme::Dark;
                ctx.set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Action::ToggleLanguage => self.settings.language = self.settings.language.other(),
            Action::Plot(plot) => self.desk.view.curve_plot = Some(plot),
            Action::Export(extension, text) => {
                let text = match figure::save(extension, &text) {
                    Ok(path) => fill!("Saved %{file}", file = path.display()),
                    Err(reason) => fill!("Not saved: %{reason}", reason = said(&reason)),
                };
                self.say(ctx, text);
            }
            Action::Screenshot => self.requests.push(Request::Screenshot),
            Action::Copy => self.copy(ctx, false),
            Action::CopyLink => self.copy(ctx, true),
            Action::Measure(true) => {
                if self.desk.session.is_motion() {
                    // A motion that runs beside would take the time that is measured.
                    self.desk.session.pause();
                }
                self.desk.measure.budget.measure(self.desk.session.scene());
            }
            Action::Measure(false) => self.desk.measure.budget.cancel(),
        }
        self.apply_session_changes();
    }

    fn edit(&mut self, ctx: &Context, label: &'static str, scene: Box<Scene>) {
        let before = self.scene().loads.len();
        match self.desk.session.apply(Edit::Scene(label, scene)) {
            Ok(_) => _ = self.desk.panel.messages.remove(label),
            Err(error) => self.refuse(ctx, label, (&error).into()),
        }
        // The sliders set a new force.
        if let [rest @ .., Load::Force { .. }] = self.scene().loads.as_slice()
            && rest.len() >= before
        {
            self.desk.panel.force = Some(rest.len());
        }
    }

    fn undo(&mut self, ctx: &Context, edit: Edit) {
        self.desk.panel.messages.clear();
        self.apply(ctx, edit);
    }

    /// Pauses, and makes one step in the current mode.
    fn step(&mut self) {
        if self.desk.view.mode == Mode::Compare {
            self.desk.session.pause();
            return self.desk.compare.step();
        }
        let session = &mut self.desk.session;
        // On the pseudocode card a step goes to the next line, and only one of the lines iterates.
        let ended = !session.is_motion() && session.simulation().is_at_rest();
        let line = self.aside.as_ref().and_then(|_| self.learn.next_line(session.simulation(), ended));
        let Some(line) = line.filter(|_| !session.is_in_background()) else {
            return session.step();
        };
        session.pause();
        if ended && line == learn::AT_REST {
            session.reset();
        }
        if line == learn::SOLVE {
            session.iterate();
        }
        self.learn.line = line;
    }

    /// Returns to rest, or to the start of the motion.
    pub(super) fn reset(&mut self) {
        let Desk { session, viewport, compare, .. } = &mut self.desk;
        compare.reset();
        let is_here = !session.is_in_background();
        session.reset();
        if is_here {
            viewport.clear_swept();
            self.learn.line = 0;
        }
    }

    /// Sets the load whose arrow is dragged, or resets a load to the value in the scene's document; the force whose base was
    /// dropped is the selected one.
    pub(super) fn edit_loads(&mut self, ctx: &Context, interaction: &Interaction) {
        if let Some((Object::Load(load), _)) = interaction.dropped {
            self.desk.panel.force = Some(load);
        }
        let dragged = interaction.load.and_then(|(load, (value, direction))| {
            self.desk.panel.force = Some(load);
            let mut scene = self.scene().clone();
            let (label, set) = match direction {
                Some(degrees) => {
                    self.desk.panel.force_direction = Some(degrees);
                    ("Force", scene.set_force(load, vector(value, degrees)))
                }
                None => ("Moment", scene.set_moment(load, value)),
            };
            // An arrow always belongs to an existing load.
            (set.is_ok() && scene != *self.scene()).then_some((label, scene))
        });
        let session = &self.desk.session;
        let restored = interaction.restore.and_then(|load| {
            let restored = session.with_original_load(load)?;
            let label = if restored.loads.get(load).is_some_and(Load::is_moment) { "Moment" } else { "Force" };
            Some((label, restored))
        });
        for (label, scene) in dragged.into_iter().chain(restored) {
            self.act(ctx, Action::Edit(label, Box::new(scene)));
        }
    }

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

    /// Shows a message for a while.
    pub fn say(&mut self, ctx: &Context, message: String) {
        self.toast = Some((message, ctx.input(|i| i.time) + TOAST.as_secs_f64()));
    }

    /// Shows the reason for which an edit was refused: beside the field with this label, or over the body.
    pub(super) fn refuse(&mut self, ctx: &Context, label: &'static str, reason: Sentence) {
        // The message of a long list may be out of view.
        if [objects::EDIT, edges::SECTION].contains(&label) {
            self.say(ctx, sentence(&said(&reason)));
        }
        if label != objects::EDIT {
            self.desk.panel.messages.insert(label, reason);
        }
    }

    /// Prints a message, and shows it until the user closes it. Returns `false` if it has been given
    /// before.
    pub fn warn(&mut self, message: String) -> bool {
        let is_new = !self.warnings.contains(&message);
        if is_new {
            eprintln!("warpbeam: {message}");
            self.warnings.push(message);
        }
        is_new
    }

    /// Shows warnings and offers in rows under the toolbar, if there are any.
    pub(super) fn show_banners(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let has_warning = self.warnings.len() > self.closed_warnings;
        if !(has_warning || self.offered().is_some() || self.desk.session.is_outdated) {
            return;
        }
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(12, 4));
        Panel::top("banners").resizable(false).frame(frame).show(ui, |ui| {
            if let Some(message) = self.warnings.get(self.closed_warnings) {
                let color = ui.visuals().warn_fg_color;
                let is_closed = banner(ui, RichText::new(message).color(color), &["Close"]).is_some();
                self.closed_warnings += usize::from(is_closed);
            }
            self.offer_changed_file(ui, actions);
            self.offer_unsaved(ui);
        });
    }

    pub(super) fn show_notices(&mut self, ctx: &Context) {
        self.apply_session_changes();
        for Notice { label, message } in std::mem::take(&mut self.desk.session.notices) {
            match label {
                Some(label) => self.refuse(ctx, label, message),
                None => self.say(ctx, said(&message)),
            }
        }
    }

    /// Reports the first self-intersection of the body's outline of a document.
    pub(super) fn report_crossing(&mut self, ui: &Ui) {
        let is_shown =
            self.desk.view.layout.bars && self.aside.is_none() && self.story.is_none() && self.toast.is_none();
        let now = ui.input(|i| i.time);
        let (viewport, content) = self.viewport_and_content();
        if is_shown && viewport.finds_crossing(&content, now) {
            self.say(ui.ctx(), tr("The body passes through itself: contact is not modelled").to_owned());
        }
    }

    /// Paints the message, while it is shown.
    pub(super) fn paint_toast(&mut self, ui: &Ui, painter: &Painter, rect: Rect) {
        let Some((message, until)) = &self.toast else { return };
        let left = until - ui.input(|i| i.time);
        if left <= 0.0 {
            self.toast = None;
            return;
        }
        let (visuals, color) = (ui.visuals(), ui.visuals().strong_text_color());
        let at = rect.center_bottom() - vec2(0.0, if self.desk.session.is_motion() { 48.0 } else { 24.0 });
        Labels::new(painter, visuals).add(at, Align2::CENTER_BOTTOM, message, color, rect.width() - 48.0);
        // For screen readers.
        let place = Rect::from_center_size(rect.center_bottom(), Vec2::ZERO);
        let said = ui.interact(place, Id::unique("toast"), Sense::empty());
        said.widget_info(|| WidgetInfo::labeled(Role::Label, true, message));
        ui.ctx().request_repaint_after(Duration::from_secs_f64(left.clamp(0.0, TOAST.as_secs_f64())));
    }
}
