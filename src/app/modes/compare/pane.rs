//! A pane: a simulation of its own on the scene with a setting of its own. Small ones iterate between two frames, large
//! ones beside the window.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Pos2, Rect, Stroke, Ui};
use nalgebra::Vector2;

use super::setting::PaneSetting;
use crate::app::task::solve::{
    BackgroundSolve, Bodies, MOST_PANE_UNKNOWNS, Model, Phase, SolveRequest, SolveUpdate, Start,
};
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
use crate::simulation::{ProbeResult, Simulation, SimulationError, Status, probe_results};
use crate::study::Reference;

/// A solve of a load that is no longer wanted may take so long.
const LONGEST_OUTDATED: Duration = Duration::from_millis(300);

/// A scene with a setting of its own, beside others.
#[derive(Debug, Default)]
pub struct Pane {
    pub(super) setting: PaneSetting,
    /// The scene with the setting.
    wanted: Option<Scene>,
    /// The scene that the body has, was sent away with, or was refused for.
    given: Option<Scene>,
    /// Whether that is too large to be solved between two frames.
    is_large: bool,
    body: Body,
    /// Whether the solve began at rest: what it takes depends on nothing that was before.
    from_rest: bool,
    /// Whether it is solved anew only to be measured: what is seen is the equilibrium that was found before.
    measures: bool,
    end: Option<PaneEnd>,
    system: Option<Arc<System>>,
    pub(super) drawing: DisplayGeometry,
    pub(super) shape: BodyMesh,
    /// The range of the field over the body.
    pub(super) range: Option<[f64; 2]>,
    /// Where the body is drawn.
    pub(super) place: Option<Rect>,
    pub(super) error: Option<f64>,
    pub(super) pointer: Pointer,
}

/// How a solve of a pane from rest has ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PaneEnd {
    /// How; [`Status::Running`] where it was stopped after the iterations that the setting has.
    pub status: Status,
    /// Iterations from rest.
    pub iterations: u32,
    /// The time they took, s.
    pub seconds: f64,
    /// What the probes see.
    pub probes: Vec<ProbeResult>,
}

#[derive(Debug, Default)]
enum Body {
    /// Nothing yet.
    #[default]
    None,
    Here(Box<Simulation>),
    Away(Box<PaneSolve>),
    /// What is wrong with the scene.
    Refused(String),
}

/// A background solve of a pane.
#[derive(Debug)]
struct PaneSolve {
    solve: BackgroundSolve,
    since: Instant,
}

/// The model of a pane before its first iteration.
struct PaneModel {
    simulation: Option<Box<Simulation>>,
    /// Existing equations of the scene's mesh.
    system: Option<Arc<System>>,
}

impl PaneModel {
    /// Sets the simulation up here.
    fn set_up(self, scene: &Scene) -> Result<Box<Simulation>, SimulationError> {
        Ok(match (self.simulation, self.system) {
            (Some(mut simulation), _) => {
                simulation.change_scene(scene)?;
                simulation
            }
            (None, Some(system)) => Box::new(Simulation::with_system(scene, system)?),
            (None, None) => Box::new(Simulation::new(scene)?),
        })
    }
}

impl From<PaneModel> for Model {
    fn from(model: PaneModel) -> Self {
        match (model.simulation, model.system) {
            (Some(simulation), _) => Self::Existing(Box::new((Bodies { simulation: *simulation, linear: None }, None))),
            (None, Some(system)) => Self::Equations(system),
            (None, None) => Self::New,
        }
    }
}

fn has_ended(simulation: &Simulation, most_iterations: Option<u32>) -> bool {
    *simulation.status() != Status::Running || most_iterations.is_some_and(|most| simulation.iterations() >= most)
}

/// What a frame gives to a pane.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    /// Whether the pointer moves: what is dragged has one iteration a frame.
    pub moves: bool,
    /// Whether it is pressed: what is dragged is going to be followed from where it is.
    pub holds: bool,
    /// Whether anything iterates at all.
    pub runs: bool,
    /// When the time for iterations is over.
    pub until: Instant,
}

/// What a pane is doing.
pub(super) enum Doing<'a> {
    /// It has ended.
    Rests(&'a PaneEnd),
    /// It iterates, or will.
    Iterates(u32),
    /// Beside the window.
    Works(u32),
    Refused(&'a str),
}

impl Pane {
    pub(super) fn new(setting: PaneSetting) -> Self {
        Self { setting, ..Self::default() }
    }

    /// What it has of its own.
    #[must_use]
    pub fn setting(&self) -> &PaneSetting {
        &self.setting
    }

    /// The scene with that, once it was shown.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        self.wanted.as_ref()
    }

    /// How its solve from rest has ended, once it has.
    #[must_use]
    pub fn end(&self) -> Option<&PaneEnd> {
        self.end.as_ref()
    }

    /// The error of that at the first probe, percent of the true displacement, as of the last [`crate::app::Lab::ui`].
    #[must_use]
    pub fn error_percent(&self) -> Option<f64> {
        self.error
    }

    /// Where its body is drawn in the window, points, as of the last [`crate::app::Lab::ui`].
    #[must_use]
    pub fn place(&self) -> Option<Rect> {
        self.place
    }

    /// Its simulation, while it is not solved beside the window.
    #[must_use]
    pub fn simulation(&self) -> Option<&Simulation> {
        match &self.body {
            Body::Here(simulation) => Some(simulation),
            _ => None,
        }
    }

    /// The equations of what is drawn.
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

    /// Whether it has nothing to do.
    pub(super) fn is_settled(&self) -> bool {
        self.wanted == self.given && (self.end.is_some() || matches!(self.body, Body::Refused(_)))
    }

    /// Whether it is solved beside the window.
    pub(super) fn is_away(&self) -> bool {
        matches!(self.body, Body::Away(_))
    }

    /// Whether its solve from rest has found no equilibrium.
    pub(super) fn has_failed(&self) -> bool {
        self.end.as_ref().is_some_and(|end| end.status.failure().is_some())
    }

    /// Whether what is drawn of it is an answer to its load.
    pub(super) fn is_sound(&self) -> bool {
        self.end.as_ref().map_or_else(|| self.answer().is_some_and(|(_, good)| good), |_| !self.has_failed())
    }

    /// Its loads, as last drawn.
    pub(super) fn forces(&self, direction: f64, opening: OpeningLoads) -> Option<Forces<'_>> {
        let (scene, system) = (self.wanted.as_ref()?, self.system.as_ref()?);
        Some(Forces { scene, system, positions: &self.shape.nodes, time: 0.0, direction, opening })
    }

    /// Where at rest, m, the point of the body under the pointer is, and where the pointer is.
    pub(super) fn under_pointer(&self) -> Option<(Vector2<f64>, Pos2)> {
        let (point, at) = self.pointer.over_body()?;
        let mesh = self.system.as_ref()?.mesh();
        Some((probe::place(mesh, mesh.nodes(), point)?, at))
    }

    /// Shows the value at the point that is here at rest, m: beside the pointer, or beside the point.
    pub(super) fn show_value(&self, ui: &Ui, view: &ViewOptions, rest: Vector2<f64>, camera: Camera, at: Option<Pos2>) {
        let (Some(system), Some(place)) = (&self.system, self.place) else { return };
        let mesh = system.mesh();
        let Some(point) = mesh.locate(rest).filter(|_| self.is_sound() && !self.is_outdated()) else { return };
        let Some(now) = probe::place(mesh, &self.shape.nodes, point) else { return };
        let painter = ui.painter_at(place);
        let at = at.unwrap_or_else(|| {
            let there = Projection { camera, rect: place }.point(now);
            painter.circle_stroke(there, 4.5, Stroke::new(2.0, ui.visuals().strong_text_color()));
            there
        });
        let value = self.shape.value_at(view, mesh, point);
        probe::paint_hover(ui, &painter, at, (view.field, value), now - rest);
    }

    /// Whether it waits for the pointer to let go.
    pub(super) fn waits(&self) -> bool {
        self.end.is_none() && !self.from_rest && self.answer().is_some()
    }

    /// Whether its picture is of a load that was.
    pub(super) fn is_outdated(&self) -> bool {
        self.is_away() && !self.measures
    }

    /// What the first probe sees where the load has been answered, and whether the answer is an equilibrium.
    pub(super) fn answer(&self) -> Option<(ProbeResult, bool)> {
        let Body::Here(simulation) = &self.body else { return None };
        let ended = self.given == self.wanted && has_ended(simulation, self.setting.iterations);
        if !ended || self.measures {
            return None;
        }
        let probe = probe_results(simulation.problem(), simulation.state()).into_iter().next()?;
        let good = !matches!(simulation.status(), Status::NotConverged(_) | Status::Diverged(_));
        // What comes from elsewhere may fail where a solve from rest does not.
        (good || self.end.is_some()).then_some((probe, good))
    }

    /// Has another setting.
    pub(super) fn set(&mut self, setting: PaneSetting) {
        self.setting = setting;
        if self.is_away() {
            (self.body, self.given) = (Body::None, None);
        }
        self.reset();
    }

    /// Starts over at rest.
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

    /// One iteration.
    pub(super) fn step(&mut self) {
        let most = self.setting.iterations;
        if let Body::Here(simulation) = &mut self.body
            && !has_ended(simulation, most)
        {
            simulation.step();
            self.conclude();
        }
    }

    /// Goes on with the scene, where that is another one now from its load, and iterates.
    pub(super) fn advance(&mut self, scene: &Scene, equations: &[Equations], turn: Turn) {
        let wanted = self.setting.apply(scene);
        if self.wanted.as_ref() != Some(&wanted) {
            self.wanted = Some(wanted);
            self.end = None;
        }
        if !self.hear() {
            return;
        }
        if self.given != self.wanted {
            self.take_on(equations);
        }
        self.iterate(turn);
    }

    /// Takes the simulation that comes back; says whether it is not away.
    fn hear(&mut self) -> bool {
        let Body::Away(away) = &mut self.body else { return true };
        if self.given != self.wanted && away.since.elapsed() > LONGEST_OUTDATED {
            away.solve.cancel();
        }
        self.body = loop {
            match away.solve.poll() {
                SolveUpdate::Phase | SolveUpdate::Snapshot(_) => {}
                SolveUpdate::None => return false,
                SolveUpdate::Done(Ok(solved)) => break Body::Here(Box::new(solved.snapshot.bodies.simulation)),
                SolveUpdate::Done(Err(rejected)) => break Body::Refused(rejected.error.to_string()),
                SolveUpdate::Died => break Body::Refused("the solve ended unexpectedly".to_owned()),
            }
        };
        if self.given == self.wanted {
            self.conclude();
        }
        true
    }

    /// Gives the scene to the simulation, or makes one.
    fn take_on(&mut self, equations: &[Equations]) {
        let Some(scene) = self.wanted.clone() else { return };
        self.given = Some(scene.clone());
        self.measures = false;
        let simulation = match std::mem::take(&mut self.body) {
            Body::Here(simulation) => Some(simulation),
            _ => None,
        };
        // Another mesh has nothing of the state.
        let simulation = simulation.filter(|s| s.scene().beam == scene.beam && s.scene().mesh == scene.mesh);
        self.from_rest = simulation.is_none();
        let system = Equations::of(equations, &scene);
        let model = PaneModel { simulation, system };
        self.is_large = scene.unknowns() > MOST_PANE_UNKNOWNS;
        if self.is_large {
            self.send(scene, model, Start::Present);
        } else {
            self.body = model.set_up(&scene).map_or_else(|error| Body::Refused(error.to_string()), Body::Here);
        }
    }

    /// Starts a solve in the background.
    fn send(&mut self, scene: Scene, model: PaneModel, start: Start) {
        let iterations = self.setting.iterations;
        let (model, residuals) = (model.into(), Vec::new());
        let request = SolveRequest { scene, model, start, iterations, residuals, is_displayed: false };
        self.body = match BackgroundSolve::start(request) {
            Ok(solve) => Body::Away(Box::new(PaneSolve { solve, since: Instant::now() })),
            Err(error) => Body::Refused(format!("no thread for the solve: {error}")),
        };
    }

    fn iterate(&mut self, turn: Turn) {
        let most = self.setting.iterations;
        let Body::Here(simulation) = &mut self.body else { return };
        if self.end.is_some() || !turn.runs {
            return;
        }
        while !self.is_large && !has_ended(simulation, most) {
            simulation.step();
            if turn.moves || Instant::now() >= turn.until {
                break;
            }
        }
        let ended = has_ended(simulation, most);
        if ended && self.from_rest {
            return self.conclude();
        }
        if ended && turn.holds || !ended && !self.is_large {
            return;
        }
        // Its numbers are those of a solve from rest: where it came from elsewhere it is solved once more.
        if ended {
            (self.from_rest, self.measures) = (true, true);
        }
        if !self.is_large {
            return simulation.reset();
        }
        if let (Body::Here(simulation), Some(scene)) = (std::mem::take(&mut self.body), self.given.clone()) {
            let start = if ended { Start::Rest } else { Start::Present };
            self.send(scene, PaneModel { simulation: Some(simulation), system: None }, start);
        }
    }

    /// Notes how a solve from rest has ended.
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

    /// Solves to the end, however long it takes.
    pub(super) fn settle(&mut self, scene: &Scene, equations: &[Equations]) {
        let wanted = self.setting.apply(scene);
        let system = Equations::of(equations, &wanted);
        let most = self.setting.iterations;
        let solved = PaneModel { simulation: None, system }.set_up(&wanted).map(|mut simulation| {
            while !has_ended(&simulation, most) {
                simulation.step();
            }
            simulation
        });
        self.body = solved.map_or_else(|error| Body::Refused(error.to_string()), Body::Here);
        (self.wanted, self.given) = (Some(wanted.clone()), Some(wanted));
        (self.from_rest, self.end) = (true, None);
        self.conclude();
    }

    /// Updates what is drawn.
    pub(super) fn update_shape(&mut self, view: &ViewOptions, visuals: &egui::Visuals) {
        if let (Body::Here(simulation), false) = (&self.body, self.measures) {
            let system = simulation.system();
            if self.system.as_ref().is_none_or(|drawn| !Arc::ptr_eq(drawn, system)) {
                self.drawing = DisplayGeometry::new(system.mesh());
                self.system = Some(system.clone());
            }
            self.shape.update(simulation, &self.drawing, view, None);
            self.range = Some(self.shape.range);
        }
        self.shape.color(visuals, view.field);
    }

    /// How far off it is, once that is known.
    pub(super) fn judge(&mut self, truth: Option<&Reference>) {
        let probe = self.answer().filter(|(_, good)| *good);
        self.error = truth.zip(probe).and_then(|(truth, (probe, _))| truth.first()?.error_percent(&probe));
    }
}

/// Equations that others may share.
#[derive(Clone, Debug)]
pub(super) struct Equations {
    beam: Option<Beam>,
    mesh: Option<MeshFile>,
    system: Arc<System>,
}

impl Equations {
    /// Those of a scene.
    pub(super) fn new(scene: &Scene, system: &Arc<System>) -> Self {
        Self { beam: scene.beam.clone(), mesh: scene.mesh.clone(), system: system.clone() }
    }

    /// Those among them that are of a scene's mesh.
    fn of(all: &[Self], scene: &Scene) -> Option<Arc<System>> {
        let own = all.iter().find(|own| own.beam == scene.beam && own.mesh == scene.mesh);
        own.map(|own| own.system.clone())
    }
}
