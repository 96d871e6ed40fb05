//! Pane of the comparison of equilibria: a solve of the scene with settings of its own, and its display.

use std::collections::VecDeque;

use egui::{Color32, Pos2, Rect, Stroke, Ui};
use nalgebra::Vector2;

use super::CompareInput;
use super::panes::{ComparedPane, Condition, PaneDisplay};
use super::setting::PaneSetting;
use crate::app::session::WILD;
use crate::app::session::compared_solve::{ComparedSolve, Equations, PaneEnd};
use crate::app::session::facts::TimeFact;
use crate::app::session::fallback::Fallback;
use crate::app::task::keyed::Keyed;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::probe;
use crate::app::viewport::projection::Projection;
use crate::app::widgets::palette::Palette;
use crate::exact_beam::error_percent;
use crate::render::Camera;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::study::Reference;

/// Scene with settings of its own, compared with others.
#[derive(Debug)]
pub struct Pane {
    pub(super) setting: PaneSetting,
    pub(super) solve: ComparedSolve,
    pub(super) display: PaneDisplay,
    pub(super) error: Option<f64>,
    /// Displacements of the first probe under the last loads, m.
    recent: VecDeque<(Scene, Vector2<f64>)>,
    /// Bodies drawn in place of a search that has found no equilibrium.
    fallback: Fallback,
    /// `true` while the load is dragged, and the pane iterates as fast as it can.
    pub(super) is_dragged: bool,
    /// Time of the solve from rest.
    time: Keyed<TimeFact>,
}

impl Pane {
    /// Returns the settings of the pane.
    #[must_use]
    pub fn setting(&self) -> &PaneSetting {
        &self.setting
    }

    /// Returns the scene with these settings, after the pane was first shown.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        self.solve.scene()
    }

    /// Returns the result of the solve from rest; `None` until it has ended.
    #[must_use]
    pub fn end(&self) -> Option<&PaneEnd> {
        self.solve.end()
    }

    /// Returns the error of the result at the first probe, percent of the reference displacement, as of the last
    /// [`crate::app::Lab::ui`].
    #[must_use]
    pub fn error_percent(&self) -> Option<f64> {
        self.error
    }

    /// Returns the time of the solve from rest, s; `None` until it has been measured.
    #[must_use]
    pub fn seconds(&self) -> Option<f64> {
        Some(self.time.get(&self.timed_scene()?)?.timings.total().as_secs_f64())
    }

    /// Returns the scene whose solve is timed: it ends after the setting's number of iterations.
    fn timed_scene(&self) -> Option<Scene> {
        let mut scene = self.scene()?.clone();
        scene.solver.accept_after = self.setting.iterations.unwrap_or(scene.solver.accept_after);
        Some(scene)
    }

    /// Returns the time of the solve from rest to show, s: that of the status bar for the panel's settings.
    pub(super) fn shown_seconds(&self, input: &CompareInput<'_>) -> Option<f64> {
        let is_own = || self.timed_scene().as_ref() == Some(input.common.scene);
        let of_panel = input.from_rest.filter(|_| is_own()).map(|solve| solve.timings.total().as_secs_f64());
        of_panel.or_else(|| self.seconds())
    }

    /// Requests the time of the solve from rest; returns `true` while it is pending.
    pub(super) fn request_time(&mut self) -> bool {
        let scene = self.timed_scene().filter(|_| self.end().is_some());
        scene.is_some_and(|scene| self.time.request(&scene))
    }

    /// Measures the time of the solve from rest, and waits for it.
    pub(super) fn wait_for_time(&mut self) {
        if let Some(scene) = self.timed_scene().filter(|_| self.end().is_some()) {
            self.time.wait(&scene);
        }
    }

    /// Returns the area of the body in the window, points, as of the last [`crate::app::Lab::ui`].
    #[must_use]
    pub fn place(&self) -> Option<Rect> {
        self.display.place
    }

    /// Returns the values of the displayed field at both ends of the colour map, as of the last
    /// [`crate::app::Lab::ui`].
    #[must_use]
    pub fn color_range(&self) -> [f64; 2] {
        self.display.body_mesh.range
    }

    /// Returns the simulation; `None` while it is solved in the background.
    #[must_use]
    pub fn simulation(&self) -> Option<&Simulation> {
        self.solve.simulation()
    }

    /// Returns the equations of the simulation and of the displayed body, for other panes with the same mesh.
    pub(super) fn equations(&self) -> impl Iterator<Item = Equations> {
        let scene = self.simulation().map(Simulation::scene);
        self.solve.equations().into_iter().chain(scene.and_then(|scene| self.display.equations(scene)))
    }

    /// Restarts from rest.
    pub(super) fn reset(&mut self) {
        self.solve.reset();
    }

    /// Returns the rest position, m, of the material point under the pointer, and the pointer's position.
    pub(super) fn under_pointer(&self) -> Option<(Vector2<f64>, Pos2)> {
        let (point, at) = self.display.pointer.over_body()?;
        let mesh = self.display.system.as_ref()?.mesh();
        Some((probe::place(mesh, mesh.nodes(), point)?, at))
    }

    /// Shows the value at the material point with the rest position `rest`, m: next to the pointer at `at`, or else
    /// next to the point.
    pub(super) fn show_value(&self, ui: &Ui, view: &ViewOptions, rest: Vector2<f64>, camera: Camera, at: Option<Pos2>) {
        let PaneDisplay { system, place, body_mesh, .. } = &self.display;
        let (Some(system), Some(place)) = (system, *place) else { return };
        let mesh = system.mesh();
        let Some(point) = mesh.locate(rest).filter(|_| self.condition() == Condition::Result) else { return };
        let Some(now) = probe::place(mesh, &body_mesh.nodes, point) else { return };
        let painter = ui.painter_at(place);
        let at = at.unwrap_or_else(|| {
            let there = Projection { camera, rect: place }.point(now);
            painter.circle_stroke(there, 4.5, Stroke::new(2.0, ui.visuals().strong_text_color()));
            there
        });
        let value = body_mesh.value_at(mesh, point);
        probe::paint_hover(ui, &painter, at, (view.field, value), now - rest);
    }

    /// Keeps the bodies that are drawn where a search finds no equilibrium: `last`, if the panel describes it for the same
    /// setting.
    pub(super) fn keep_equilibrium(&mut self, last: Option<&Simulation>) {
        let last = last.filter(|_| self.solve.has_failed());
        self.solve.displayed().into_iter().chain(last).for_each(|simulation| self.fallback.keep(simulation));
    }

    /// Updates the displayed mesh.
    pub(super) fn update_display(
        &mut self,
        (view, reference): (&ViewOptions, Option<&Reference>),
        magnification: f64,
        visuals: &egui::Visuals,
        known: &[Equations],
    ) {
        let is_sound = self.solve.is_sound();
        if let Some(simulation) =
            in_place(&self.solve, &self.fallback, self.is_dragged).or_else(|| self.solve.displayed())
        {
            self.display.update(simulation, (view, reference.filter(|_| is_sound)), magnification, None, known);
        }
        self.display.body_mesh.color(visuals, view.field);
    }

    /// Computes the error of the result, if the reference solution is known. One that follows the load may be of a load
    /// before, of which the result is kept.
    pub(super) fn update_error(&mut self, input: &CompareInput<'_>) {
        /// Largest number of results that are kept.
        const MOST: usize = 20;
        let u = self.solve.answer().filter(|(_, good)| *good).map(|(probe, _)| probe.u);
        let first = input.reference.and_then(Reference::first);
        let error = |u: Option<Vector2<f64>>| error_percent(u?, first?.displacement);
        let Some(live) = input.live else {
            self.recent.clear();
            self.error = error(u);
            return;
        };
        if let Some((scene, u)) = self.solve.scene().cloned().zip(u) {
            self.recent.retain(|(earlier, _)| *earlier != scene);
            self.recent.push_front((scene, u));
            self.recent.truncate(MOST);
        }
        if let Some((_, u)) = self.recent.iter().find(|(scene, _)| live.is_of(scene)) {
            self.error = error(Some(*u));
        }
    }
}

/// Returns the body drawn in place of a solve that has found no equilibrium.
fn in_place<'a>(solve: &ComparedSolve, fallback: &'a Fallback, is_dragged: bool) -> Option<&'a Simulation> {
    let is_wild = |simulation: &Simulation| is_dragged && !solve.is_settled() && simulation.residual() > WILD;
    fallback.of(solve.simulation().filter(|simulation| solve.has_failed() || is_wild(simulation))?)
}

impl ComparedPane for Pane {
    fn new(setting: PaneSetting) -> Self {
        let solve = ComparedSolve::new(setting.iterations);
        Self {
            setting,
            solve,
            display: PaneDisplay::default(),
            error: None,
            recent: VecDeque::new(),
            fallback: Fallback::default(),
            is_dragged: false,
            time: Keyed::default(),
        }
    }

    fn own_setting(&self) -> PaneSetting {
        self.setting
    }

    fn color(&self, scene: &Scene, palette: &Palette) -> Color32 {
        self.setting.of(scene).method.map_or(palette.text, |method| palette.method(method))
    }

    fn change_setting(&mut self, setting: PaneSetting) {
        self.setting = setting;
        self.solve.restart(setting.iterations);
    }

    fn display(&self) -> &PaneDisplay {
        &self.display
    }

    fn condition(&self) -> Condition {
        if self.solve.is_outdated() {
            Condition::Outdated
        } else if self.solve.has_failed() {
            Condition::Failed
        } else if self.solve.is_sound() {
            Condition::Result
        } else {
            Condition::Unfinished
        }
    }

    fn parts(&mut self) -> (Option<(&Scene, f64)>, &mut PaneDisplay) {
        let fallback = in_place(&self.solve, &self.fallback, self.is_dragged).map(Simulation::scene);
        (fallback.or_else(|| self.solve.scene()).map(|scene| (scene, 0.0)), &mut self.display)
    }

    fn unreached(&self) -> Option<&Scene> {
        self.solve.scene().filter(|_| in_place(&self.solve, &self.fallback, self.is_dragged).is_some())
    }
}
