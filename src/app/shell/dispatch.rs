//! Dispatch of actions: edits go to the session, other actions to the part of the window that they concern.

use super::*;
use crate::app::modes::compare::Compare;
use crate::app::modes::{figure, learn};
use crate::app::session::{Changed, Edit};
use crate::app::viewport::arrow::vector;
use crate::app::viewport::objects::Object;
use crate::app::viewport::pointer::Interaction;

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
}
