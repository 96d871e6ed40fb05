//! Pane of a comparison: a run of the scene with settings of its own, and its display.

use std::collections::VecDeque;

use super::*;
use crate::app::diagnosis::equilibrium_text;
use crate::app::session::WILD;
use crate::app::session::fallback::Fallback;
use crate::app::session::run::{Condition, Run};
use crate::app::viewport::body_view::BodyView;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::overlay::{self, Overlay};
use crate::app::viewport::pointer::{HitTargets, Interaction, Interactivity};
use crate::app::viewport::probe;
use crate::app::viewport::projection::DrawnBody;
use crate::exact_beam::error_percent;

/// Scene with settings of its own, compared with others.
#[derive(Default)]
pub struct Pane {
    /// Settings of the pane.
    pub setting: PaneSetting,
    /// Run of the scene with these settings.
    pub run: Run,
    /// Error of the result at the first probe, percent of the reference displacement, as of the last
    /// [`crate::app::Lab::ui`].
    pub error_percent: Option<f64>,
    /// Displacements of the first probe under the last loads, m.
    recent: VecDeque<(Scene, Vector2<f64>)>,
    /// Bodies drawn in place of a search that has found no equilibrium.
    fallback: Fallback,
    /// `true` while the load is dragged, and the pane iterates as fast as it can.
    pub(super) is_dragged: bool,
    cost: Keyed<facts::CostFact>,
    pub(super) view: BodyView,
    /// Colour range of this pane alone; all panes are drawn with a common range that contains it.
    pub(super) range: Option<[f64; 2]>,
}

impl Pane {
    pub(super) fn new(setting: PaneSetting) -> Self {
        Self { setting, run: Run::new(setting.iterations), ..Self::default() }
    }

    /// Returns the computing time of the solve from rest, or of a motion's frame at 60 Hz, s; `None` until it has been
    /// measured.
    pub fn seconds(&self) -> Option<f64> {
        self.cost.get(&self.timed_scene()?).copied()
    }

    /// Returns the scene whose solve, which ends after the setting's number of iterations, or whose motion is timed; `None`
    /// while there is no result.
    fn timed_scene(&self) -> Option<Scene> {
        let mut scene = self.run.wanted.clone()?;
        scene.solver.accept_after = self.setting.iterations.unwrap_or(scene.solver.accept_after);
        let is_motion = scene.analysis == Analysis::Dynamic;
        (if is_motion { self.run.is_sound() } else { self.run.end.is_some() }).then_some(scene)
    }

    /// Returns the time of the solve from rest to show, s: that of the status bar for the panel's settings.
    pub(super) fn shown_seconds(&self, input: &CompareInput<'_>) -> Option<f64> {
        let is_own = || self.timed_scene().as_ref() == Some(input.scene);
        let of_panel =
            input.session.timed_from_rest().filter(|_| is_own()).map(|solve| solve.timings.total().as_secs_f64());
        of_panel.or_else(|| self.seconds())
    }

    /// Requests the computing time, or measures it and `waits`; returns `true` while it is pending.
    pub(super) fn obtain_time(&mut self, waits: bool) -> bool {
        self.timed_scene().is_some_and(|scene| self.cost.obtain(&scene, waits))
    }

    /// Returns the values of the displayed field at both ends of the colour map, as of the last
    /// [`crate::app::Lab::ui`].
    pub fn color_range(&self) -> [f64; 2] {
        self.view.body.range
    }

    /// Returns the area of the body in the window, points, as of the last [`crate::app::Lab::ui`].
    pub fn place(&self) -> Rect {
        self.view.rect
    }

    /// Returns the simulation; `None` while it is solved in the background.
    pub fn simulation(&self) -> Option<&Simulation> {
        Some(&self.run.model()?.simulation)
    }

    /// Returns the rest position, m, of the material point under the pointer, and the pointer's position.
    pub(super) fn under_pointer(&self) -> Option<(Vector2<f64>, Pos2)> {
        let (point, at) = self.view.pointer.over_body()?;
        let mesh = self.view.body.system.as_ref()?.mesh();
        Some((probe::place(mesh, mesh.nodes(), point)?, at))
    }

    /// Shows the value at the material point with the rest position `rest`, m: next to the pointer at `at`, or else
    /// next to the point.
    pub(super) fn show_value(&self, ui: &Ui, rest: Vector2<f64>, camera: &CameraController, at: Option<Pos2>) {
        let sound = self.run.displayed().filter(|_| self.run.is_sound());
        let Some(body) = sound.map(|model| &model.simulation) else { return };
        let Some(point) = body.mesh().locate(rest) else { return };
        let Some(now) = probe::place(body.mesh(), &self.view.body.nodes, point) else { return };
        let at = at.unwrap_or_else(|| {
            let there = self.view.projection(camera).point(now);
            let stroke = Stroke::new(2.0, ui.visuals().strong_text_color());
            ui.painter_at(self.view.rect).circle_stroke(there, 4.5, stroke);
            there
        });
        self.view.show_value(ui, body, point, at);
    }

    /// Keeps the bodies that are drawn where a search finds no equilibrium: `last`, if the panel describes it for the same
    /// setting.
    pub(super) fn keep_equilibrium(&mut self, last: Option<&Simulation>) {
        let displayed = self.run.displayed().map(|model| &model.simulation);
        let last = last.filter(|_| self.run.condition() == Condition::Failed);
        displayed.into_iter().chain(last).for_each(|simulation| self.fallback.keep(simulation));
    }

    /// Returns the body drawn in place of a solve that has found no equilibrium.
    fn in_place(&self) -> Option<&Simulation> {
        let is_wild =
            |simulation: &Simulation| self.is_dragged && !self.run.is_settled() && simulation.residual() > WILD;
        let is_replaced = |simulation: &&Simulation| self.run.condition() == Condition::Failed || is_wild(simulation);
        self.fallback.of(self.simulation().filter(is_replaced)?)
    }

    /// Updates the displayed mesh, with `magnification` times the displacement of the body; `played` is the playing time of a
    /// motion, s.
    pub(super) fn update_display(&mut self, input: &CompareInput<'_>, magnification: f64, played: Option<f64>) {
        let mut body = std::mem::take(&mut self.view.body);
        let displayed = self.run.displayed().map(|model| &model.simulation);
        if let (Some(simulation), Some(Model { geometry, .. })) = (self.in_place().or(displayed), self.run.model()) {
            let reference = input.reference.filter(|_| input.live.is_none() && self.run.is_sound());
            body.update(simulation, geometry, (input.view, reference), magnification, played);
            self.range = Some(body.range);
        }
        self.view.body = body;
    }

    /// Returns the displayed body with the loads of the scene that was asked for.
    pub(super) fn drawn_body<'a>(&'a self, projection: Projection, input: &CompareInput<'a>) -> Option<DrawnBody<'a>> {
        let time = self.simulation().map_or(0.0, |simulation| simulation.state().time());
        self.view.drawn_body(projection, (self.run.wanted.as_ref()?, time), (input.session, input.direction))
    }

    /// Computes the error of the result, if the reference solution is known. One that follows the load may be of a load
    /// before, of which the result is kept.
    pub(super) fn update_error(&mut self, input: &CompareInput<'_>) {
        /// Largest number of results that are kept.
        const MAX_RECENT: usize = 20;
        let u = self.run.answer();
        let first = input.reference.and_then(Reference::first);
        let error = |u: Option<Vector2<f64>>| error_percent(u?, first?.displacement);
        let Some(live) = input.live else {
            self.recent.clear();
            self.error_percent = error(u);
            return;
        };
        if let Some((scene, u)) = self.run.wanted.clone().zip(u) {
            self.recent.retain(|(earlier, _)| *earlier != scene);
            self.recent.push_front((scene, u));
            self.recent.truncate(MAX_RECENT);
        }
        if self.in_place().is_some() {
            self.error_percent = None;
        } else if let Some((_, u)) = self.recent.iter().find(|(scene, _)| live.is_of(scene)) {
            self.error_percent = error(Some(*u));
        }
    }

    /// Shows the overlays of the body in its place, with the outline `exact` of the reference solution, m, and a scale bar
    /// if it is the `first` pane. Moving the view moves it in all panes.
    pub(super) fn show_body(
        &mut self,
        ui: &Ui,
        number: usize,
        controller: &mut CameraController,
        input: &CompareInput<'_>,
        exact: &[Vec<Vector2<f64>>],
    ) -> Interaction {
        let place = self.view.rect;
        let condition = self.run.condition();
        let arrows = self.drawn_body(self.view.projection(controller), input);
        let arrows = arrows.map_or_else(Vec::new, |body| body.arrows());
        let response = ui.interact(place, ui.scope_id().with(("body", number)), Sense::click_and_drag());
        // States that are no result show no values.
        let interactivity = if condition == Condition::Result { Interactivity::None } else { Interactivity::Absent };
        let BodyView { pointer, body, .. } = &mut self.view;
        let (camera, arrows) = (&*controller, &arrows);
        let targets = HitTargets { response: &response, camera, body, interactivity, arrows, bases: &[] };
        let interaction = pointer.process(ui, &targets);
        if interaction.camera.is_some() {
            controller.follow(interaction.camera);
            ui.ctx().request_repaint();
        }
        let (palette, painter) = (Palette::new(ui.visuals()), ui.painter_at(place));
        let in_place = self.in_place().map(Simulation::scene);
        // The scene whose state diverges, if an equilibrium is displayed in its place.
        let wanted = self.run.wanted.as_ref().filter(|_| in_place.is_some());
        if let Some(body) = self.drawn_body(self.view.projection(controller), input) {
            let body = DrawnBody { scene: in_place.unwrap_or(body.scene), ..body };
            let note = wanted.map(|wanted| equilibrium_text(body.scene, wanted));
            let overlay = Overlay {
                view: &self.view,
                apart: false,
                body,
                wanted,
                options: input.view,
                exact: if wanted.is_some() { &[] } else { exact },
                note: note.as_deref(),
                session: None,
                ghost: None,
            };
            overlay::paint(&painter, &overlay, ui.visuals());
        }
        if number == 0 {
            bars::scale_bar(&painter, place, &controller.shown, &palette);
        }
        match condition {
            Condition::Result | Condition::Unfinished => {}
            // An equilibrium in its place is dimmed already.
            Condition::Failed if wanted.is_some() => {}
            Condition::Failed => overlay::dim(&painter, place, &palette),
            Condition::Outdated => {
                overlay::dim(&painter, place, &palette);
                let font = FontId::proportional(BODY);
                painter.text(place.center(), Align2::CENTER_CENTER, tr("solving…"), font, palette.text);
            }
        }
        interaction
    }
}
