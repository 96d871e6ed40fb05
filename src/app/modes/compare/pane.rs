//! Pane of a comparison: a simulation of the scene with settings of its own. Small models iterate between two frames,
//! large ones are solved in the background.

use std::sync::Arc;

use egui::{Pos2, Rect, Stroke, Ui};
use nalgebra::Vector2;
use web_time::{Duration, Instant};

use super::setting::PaneSetting;
use crate::app::session::has_mesh_of;
use crate::app::task::background_solve::{BackgroundSolve, SolveUpdate};
use crate::app::task::solve::{Bodies, MOST_PANE_UNKNOWNS, Model, Phase, SolveRequest, Start};
use crate::app::view_options::ViewOptions;
use crate::app::viewport::arrow::Forces;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::pointer::Pointer;
use crate::app::viewport::probe;
use crate::app::viewport::projection::Projection;
use crate::app::widgets::load_scale::OpeningLoads;
use crate::assembly::System;
use crate::render::Camera;
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::{Beam, MeshFile, Scene};
use crate::sentence::{Sentence, sentence};
use crate::simulation::{ProbeResult, Simulation, Status, probe_results};
use crate::study::Reference;

/// A background solve of an outdated load is cancelled after this time.
const LONGEST_OUTDATED: Duration = Duration::from_millis(300);

/// Scene with settings of its own, compared with others.
#[derive(Debug, Default)]
pub struct Pane {
    pub(super) setting: PaneSetting,
    /// Scene with the settings.
    wanted: Option<Scene>,
    /// Scene that the simulation has, is being solved for in the background, or was refused for.
    given: Option<Scene>,
    /// `true` if `given` is too large to be solved between two frames.
    is_large: bool,
    body: Body,
    /// `true` if the solve started from rest, so that its cost does not depend on earlier states.
    from_rest: bool,
    /// `true` while a solve from rest only measures the cost; the equilibrium found before stays on display.
    measures: bool,
    end: Option<PaneEnd>,
    system: Option<Arc<System>>,
    pub(super) geometry: DisplayGeometry,
    pub(super) body_mesh: BodyMesh,
    /// Range of the field over the body.
    pub(super) range: Option<[f64; 2]>,
    /// Area in which the body is drawn.
    pub(super) place: Option<Rect>,
    pub(super) error: Option<f64>,
    pub(super) pointer: Pointer,
}

/// Result of a pane's solve from rest.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PaneEnd {
    /// Final status; [`Status::Running`] if it was stopped after the setting's number of iterations.
    pub status: Status,
    /// Iterations from rest.
    pub iterations: u32,
    /// Computing time, s.
    pub seconds: f64,
    /// Results at the probes.
    pub probes: Vec<ProbeResult>,
}

#[derive(Debug, Default)]
enum Body {
    /// No body yet.
    #[default]
    None,
    Here(Box<Simulation>),
    Away(Box<PaneSolve>),
    /// Error of the scene.
    Refused(Sentence),
}

/// Background solve of a pane.
#[derive(Debug)]
struct PaneSolve {
    solve: BackgroundSolve,
    since: Instant,
}

/// Returns the model of a pane: an existing simulation, existing equations of the scene's mesh, or a new mesh.
fn model(simulation: Option<Box<Simulation>>, system: Option<Arc<System>>) -> Model {
    match (simulation, system) {
        (Some(simulation), _) => Model::Existing(Box::new((Bodies { simulation: *simulation, linear: None }, None))),
        (None, Some(system)) => Model::Equations(system),
        (None, None) => Model::New,
    }
}

/// Sets up a model on the current thread.
fn set_up(model: Model, scene: &Scene) -> Body {
    match model.set_up(scene) {
        Ok((bodies, _)) => Body::Here(Box::new(bodies.simulation)),
        Err(rejected) => Body::Refused((&rejected.error).into()),
    }
}

fn has_ended(simulation: &Simulation, most_iterations: Option<u32>) -> bool {
    *simulation.status() != Status::Running || most_iterations.is_some_and(|most| simulation.iterations() >= most)
}

/// Conditions of a pane in one frame.
#[derive(Clone, Copy)]
pub(super) struct FrameConditions {
    /// `true` while the pointer moves: a dragged load gets one iteration per frame.
    pub moves: bool,
    /// `true` while the pointer is pressed: the solve continues from the current state of a dragged load.
    pub holds: bool,
    /// `true` if iterations are made at all.
    pub runs: bool,
    /// End of the time for iterations.
    pub until: Instant,
}

/// Current activity of a pane.
pub(super) enum Doing<'a> {
    /// The solve has ended.
    Rests(&'a PaneEnd),
    /// Iterating, with the number of iterations.
    Iterates(u32),
    /// Solving in the background, with the number of iterations.
    Works(u32),
    Refused(&'a Sentence),
}

impl Pane {
    pub(super) fn new(setting: PaneSetting) -> Self {
        Self { setting, ..Self::default() }
    }

    /// Returns the settings of the pane.
    #[must_use]
    pub fn setting(&self) -> &PaneSetting {
        &self.setting
    }

    /// Returns the scene with these settings, after the pane was first shown.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        self.wanted.as_ref()
    }

    /// Returns the result of the solve from rest; `None` until it has ended.
    #[must_use]
    pub fn end(&self) -> Option<&PaneEnd> {
        self.end.as_ref()
    }

    /// Returns the error of the result at the first probe, percent of the reference displacement, as of the last
    /// [`crate::app::Lab::ui`].
    #[must_use]
    pub fn error_percent(&self) -> Option<f64> {
        self.error
    }

    /// Returns the area of the body in the window, points, as of the last [`crate::app::Lab::ui`].
    #[must_use]
    pub fn place(&self) -> Option<Rect> {
        self.place
    }

    /// Returns the simulation; `None` while it is solved in the background.
    #[must_use]
    pub fn simulation(&self) -> Option<&Simulation> {
        match &self.body {
            Body::Here(simulation) => Some(simulation),
            _ => None,
        }
    }

    /// Returns the equations of the displayed body.
    pub(super) fn system(&self) -> Option<&Arc<System>> {
        self.system.as_ref()
    }

    pub(super) fn doing(&self) -> Doing<'_> {
        match (&self.end, &self.body) {
            (Some(end), _) => Doing::Rests(end),
            (None, Body::Refused(reason)) => Doing::Refused(reason),
            (None, Body::Away(away)) => Doing::Works(match away.solve.phase() {
                Phase::Iterating(iterations) => iterations,
                _ => 0,
            }),
            (None, Body::Here(simulation)) => Doing::Iterates(simulation.iterations()),
            (None, Body::None) => Doing::Iterates(0),
        }
    }

    /// Returns `true` if the pane has no work left.
    pub(super) fn is_settled(&self) -> bool {
        self.wanted == self.given && (self.end.is_some() || matches!(self.body, Body::Refused(_)))
    }

    /// Returns `true` if the pane is solved in the background.
    pub(super) fn is_away(&self) -> bool {
        matches!(self.body, Body::Away(_))
    }

    /// Returns `true` if the solve from rest found no equilibrium.
    pub(super) fn has_failed(&self) -> bool {
        self.end.as_ref().is_some_and(|end| end.status.failure().is_some())
    }

    /// Returns `true` if the displayed state is a result for its load.
    pub(super) fn is_sound(&self) -> bool {
        self.end.as_ref().map_or_else(|| self.answer().is_some_and(|(_, good)| good), |_| !self.has_failed())
    }

    /// Returns the loads, as last drawn.
    pub(super) fn forces(&self, direction: f64, opening: OpeningLoads) -> Option<Forces<'_>> {
        let (scene, system) = (self.wanted.as_ref()?, self.system.as_ref()?);
        Some(Forces { scene, system, positions: &self.body_mesh.nodes, time: 0.0, direction, opening })
    }

    /// Returns the rest position, m, of the material point under the pointer, and the pointer's position.
    pub(super) fn under_pointer(&self) -> Option<(Vector2<f64>, Pos2)> {
        let (point, at) = self.pointer.over_body()?;
        let mesh = self.system.as_ref()?.mesh();
        Some((probe::place(mesh, mesh.nodes(), point)?, at))
    }

    /// Shows the value at the material point with the rest position `rest`, m: next to the pointer at `at`, or else
    /// next to the point.
    pub(super) fn show_value(&self, ui: &Ui, view: &ViewOptions, rest: Vector2<f64>, camera: Camera, at: Option<Pos2>) {
        let (Some(system), Some(place)) = (&self.system, self.place) else { return };
        let mesh = system.mesh();
        let Some(point) = mesh.locate(rest).filter(|_| self.is_sound() && !self.is_outdated()) else { return };
        let Some(now) = probe::place(mesh, &self.body_mesh.nodes, point) else { return };
        let painter = ui.painter_at(place);
        let at = at.unwrap_or_else(|| {
            let there = Projection { camera, rect: place }.point(now);
            painter.circle_stroke(there, 4.5, Stroke::new(2.0, ui.visuals().strong_text_color()));
            there
        });
        let value = self.body_mesh.value_at(view, mesh, point);
        probe::paint_hover(ui, &painter, at, (view.field, value), now - rest);
    }

    /// Returns `true` if the pane waits for the pointer to be released.
    pub(super) fn waits(&self) -> bool {
        self.end.is_none() && !self.from_rest && self.answer().is_some()
    }

    /// Returns `true` if the displayed state belongs to an earlier load.
    pub(super) fn is_outdated(&self) -> bool {
        self.is_away() && !self.measures
    }

    /// Returns the result at the first probe, and `true` if it is an equilibrium; `None` while the load is being
    /// solved.
    pub(super) fn answer(&self) -> Option<(ProbeResult, bool)> {
        let Body::Here(simulation) = &self.body else { return None };
        let ended = self.given == self.wanted && has_ended(simulation, self.setting.iterations);
        if !ended || self.measures {
            return None;
        }
        let probe = probe_results(simulation.problem(), simulation.state()).into_iter().next()?;
        let good = !matches!(simulation.status(), Status::NotConverged(_) | Status::Diverged(_));
        // A solve that starts from another state may fail where one from rest does not.
        (good || self.end.is_some()).then_some((probe, good))
    }

    /// Changes the settings.
    pub(super) fn set(&mut self, setting: PaneSetting) {
        self.setting = setting;
        if self.is_away() {
            (self.body, self.given) = (Body::None, None);
        }
        self.reset();
    }

    /// Restarts from rest.
    pub(super) fn reset(&mut self) {
        match &mut self.body {
            Body::Here(simulation) => {
                simulation.reset();
                (self.from_rest, self.measures, self.end) = (true, false, None);
            }
            Body::Away(_) => {}
            Body::None | Body::Refused(_) => self.given = None,
        }
    }

    /// Makes one iteration.
    pub(super) fn step(&mut self) {
        let most = self.setting.iterations;
        if let Body::Here(simulation) = &mut self.body
            && !has_ended(simulation, most)
        {
            simulation.step();
            self.conclude();
        }
    }

    /// Applies a changed scene, starting from the current state, and iterates.
    pub(super) fn advance(&mut self, scene: &Scene, equations: &[Equations], frame: FrameConditions) {
        let wanted = self.setting.apply(scene);
        if self.wanted.as_ref() != Some(&wanted) {
            self.wanted = Some(wanted);
            self.end = None;
        }
        if !self.take_solved() {
            return;
        }
        if self.given != self.wanted {
            self.take_on(equations);
        }
        self.iterate(frame);
    }

    /// Takes back a simulation that was solved in the background; returns `false` while it is still being solved.
    fn take_solved(&mut self) -> bool {
        let Body::Away(away) = &mut self.body else { return true };
        if self.given != self.wanted && away.since.elapsed() > LONGEST_OUTDATED {
            away.solve.cancel();
        }
        self.body = loop {
            match away.solve.poll() {
                SolveUpdate::Progress(_) => {}
                SolveUpdate::None => return false,
                SolveUpdate::Done(Ok(solved)) => break Body::Here(Box::new(solved.snapshot.bodies.simulation)),
                SolveUpdate::Done(Err(rejected)) => break Body::Refused((&rejected.error).into()),
                // A worker has ended before it had a model.
                SolveUpdate::Died if away.solve.is_cancelled() => {
                    self.given = None;
                    break Body::None;
                }
                SolveUpdate::Died => break Body::Refused(sentence!("the solve ended unexpectedly")),
            }
        };
        if self.given == self.wanted {
            self.conclude();
        }
        true
    }

    /// Sets the scene of the simulation, or creates one.
    fn take_on(&mut self, equations: &[Equations]) {
        let Some(scene) = self.wanted.clone() else { return };
        self.given = Some(scene.clone());
        self.measures = false;
        let simulation = match std::mem::take(&mut self.body) {
            Body::Here(simulation) => Some(simulation),
            _ => None,
        };
        // A state cannot be transferred to another mesh.
        let simulation = simulation.filter(|simulation| has_mesh_of(simulation.scene(), &scene));
        self.from_rest = simulation.is_none();
        let system = Equations::of(equations, &scene);
        let model = model(simulation, system);
        self.is_large = scene.unknowns() > MOST_PANE_UNKNOWNS;
        if self.is_large {
            self.send(scene, model, Start::Present);
        } else {
            self.body = set_up(model, &scene);
        }
    }

    /// Starts a solve in the background.
    fn send(&mut self, scene: Scene, model: Model, start: Start) {
        // A search that continues has made a part of its iterations.
        let made = match (&model, &start) {
            (Model::Existing(own), Start::Present) if *own.0.simulation.scene() == scene => {
                own.0.simulation.iterations()
            }
            _ => 0,
        };
        let iterations = self.setting.iterations.map(|most| most.saturating_sub(made));
        let request = SolveRequest { scene, model, start, iterations, residuals: Vec::new(), is_displayed: false };
        self.body = match BackgroundSolve::start(request) {
            Ok(solve) => Body::Away(Box::new(PaneSolve { solve, since: Instant::now() })),
            Err(error) => Body::Refused(sentence!("no thread for the solve: %{error}", error = error.to_string())),
        };
    }

    fn iterate(&mut self, frame: FrameConditions) {
        let most = self.setting.iterations;
        let Body::Here(simulation) = &mut self.body else { return };
        if self.end.is_some() || !frame.runs {
            return;
        }
        while !self.is_large && !has_ended(simulation, most) {
            simulation.step();
            if frame.moves || Instant::now() >= frame.until {
                break;
            }
        }
        let ended = has_ended(simulation, most);
        if ended && self.from_rest {
            return self.conclude();
        }
        if ended && frame.holds || !ended && !self.is_large {
            return;
        }
        // The result reports the cost of a solve from rest, so a solve from another state is repeated from rest.
        if ended {
            (self.from_rest, self.measures) = (true, true);
        }
        if !self.is_large {
            return simulation.reset();
        }
        if let (Body::Here(simulation), Some(scene)) = (std::mem::take(&mut self.body), self.given.clone()) {
            let start = if ended { Start::Rest } else { Start::Present };
            self.send(scene, model(Some(simulation), None), start);
        }
    }

    /// Records the result of a solve from rest.
    fn conclude(&mut self) {
        let Body::Here(simulation) = &self.body else { return };
        if !self.from_rest || !has_ended(simulation, self.setting.iterations) {
            return;
        }
        let times = simulation.timings();
        self.measures = false;
        self.end = Some(PaneEnd {
            status: simulation.status().clone(),
            iterations: simulation.iterations(),
            seconds: (times.total() - times.certify).as_secs_f64(),
            probes: probe_results(simulation.problem(), simulation.state()),
        });
    }

    /// Solves to the end, and waits for it.
    pub(super) fn settle(&mut self, scene: &Scene, equations: &[Equations]) {
        let wanted = self.setting.apply(scene);
        let system = Equations::of(equations, &wanted);
        let most = self.setting.iterations;
        self.body = set_up(model(None, system), &wanted);
        if let Body::Here(simulation) = &mut self.body {
            while !has_ended(simulation, most) {
                simulation.step();
            }
        }
        (self.wanted, self.given) = (Some(wanted.clone()), Some(wanted));
        (self.from_rest, self.end) = (true, None);
        self.conclude();
    }

    /// Updates the displayed mesh.
    pub(super) fn update_shape(&mut self, view: &ViewOptions, visuals: &egui::Visuals) {
        if let (Body::Here(simulation), false) = (&self.body, self.measures) {
            let system = simulation.system();
            if self.system.as_ref().is_none_or(|drawn| !Arc::ptr_eq(drawn, system)) {
                self.geometry = DisplayGeometry::new(system.mesh());
                self.system = Some(system.clone());
            }
            self.body_mesh.update(simulation, &self.geometry, view, None);
            self.range = Some(self.body_mesh.range);
        }
        self.body_mesh.color(visuals, view.field);
    }

    /// Computes the error of the result, if the reference solution is known.
    pub(super) fn judge(&mut self, reference: Option<&Reference>) {
        let probe = self.answer().filter(|(_, good)| *good);
        self.error = reference.zip(probe).and_then(|(reference, (probe, _))| reference.first()?.error_percent(&probe));
    }
}

/// Equations that several panes may share.
#[derive(Clone, Debug)]
pub(super) struct Equations {
    beam: Option<Beam>,
    mesh: Option<MeshFile>,
    system: Arc<System>,
}

impl Equations {
    /// Creates the entry for the equations of a scene.
    pub(super) fn new(scene: &Scene, system: &Arc<System>) -> Self {
        Self { beam: scene.beam.clone(), mesh: scene.mesh.clone(), system: system.clone() }
    }

    /// Returns the equations for a scene's mesh, if they are among `all`.
    fn of(all: &[Self], scene: &Scene) -> Option<Arc<System>> {
        let own = all.iter().find(|own| own.beam == scene.beam && own.mesh == scene.mesh);
        own.map(|own| own.system.clone())
    }
}
