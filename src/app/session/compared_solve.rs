//! Solve of one of several compared settings of a scene at rest. Small models iterate between two frames, large ones
//! are solved in the background. The cost is measured by a solve from rest.

use std::sync::Arc;

use web_time::{Duration, Instant};

use crate::app::session::fallback::is_lost;
use crate::app::session::has_mesh_of;
use crate::app::task::background_solve::BackgroundSolve;
use crate::app::task::quality::Quality;
use crate::app::task::solve::{Bodies, MAX_PANE_UNKNOWNS, Model, Phase, SolveRequest, SolveStart};
use crate::assembly::System;
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::{Beam, MeshFile, Scene};
use crate::sentence::{Sentence, sentence};
use crate::simulation::{ProbeResult, Simulation, Status, probe_results};

/// A background solve of an outdated load is cancelled after this time.
const LONGEST_OUTDATED: Duration = Duration::from_millis(300);

/// Solve of a scene, for comparison with others.
#[derive(Debug, Default)]
pub(crate) struct ComparedSolve {
    /// Number of iterations after which a solve is stopped.
    most_iterations: Option<u32>,
    /// Requested scene.
    wanted: Option<Scene>,
    /// Scene that the simulation has, is being solved for in the background, or was refused for.
    given: Option<Scene>,
    /// `true` if `given` is too large to be solved between two frames.
    is_large: bool,
    body: ComparedBody,
    /// `true` if the solve started from rest, so that its cost does not depend on earlier states.
    from_rest: bool,
    /// `true` while a solve from rest only measures the cost; the equilibrium found before stays on display.
    measures: bool,
    end: Option<PaneEnd>,
    /// Display geometry of a mesh that was made in the background.
    geometry: Option<Arc<DisplayGeometry>>,
}

/// Result of a pane's solve from rest.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PaneEnd {
    /// Final status; [`Status::Running`] if it was stopped after the setting's number of iterations.
    pub status: Status,
    /// Iterations from rest.
    pub iterations: u32,
    /// Results at the probes.
    pub probes: Vec<ProbeResult>,
    /// `true` if an element is turned inside out.
    pub is_inside_out: bool,
    /// Relative change of the body's area.
    pub area_change: f64,
}

#[derive(Debug, Default)]
enum ComparedBody {
    /// No body yet.
    #[default]
    None,
    Here(Box<Simulation>),
    Away(Box<BackgroundSolve>),
    /// Error of the scene.
    Refused(Sentence),
}

/// Returns the model of a solve: an existing simulation, existing equations of the scene's mesh, or a new mesh.
fn model(simulation: Option<Box<Simulation>>, system: Option<Arc<System>>) -> Model {
    match (simulation, system) {
        (Some(simulation), _) => Model::Existing(Box::new((Bodies { simulation: *simulation, linear: None }, None))),
        (None, Some(system)) => Model::Equations(system),
        (None, None) => Model::New,
    }
}

/// Sets up a model on the current thread.
fn set_up(model: Model, scene: &Scene) -> ComparedBody {
    match model.set_up(scene) {
        Ok((bodies, _)) => ComparedBody::Here(Box::new(bodies.simulation)),
        Err(rejected) => ComparedBody::Refused((&rejected.error).into()),
    }
}

fn has_ended(simulation: &Simulation, most_iterations: Option<u32>) -> bool {
    *simulation.status() != Status::Running || most_iterations.is_some_and(|most| simulation.iterations() >= most)
}

/// Conditions of a solve in one frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameConditions {
    /// `true` while the pointer is pressed: the solve continues from the current state of a dragged load.
    pub holds: bool,
    /// `true` if iterations are made at all.
    pub runs: bool,
    /// End of the time for iterations.
    pub until: Instant,
}

/// Current activity of a solve.
#[derive(Debug)]
pub(crate) enum Activity<'a> {
    /// The solve has ended.
    Rests(&'a PaneEnd),
    /// Iterating, with the number of iterations.
    Iterates(u32),
    /// Solving in the background, with the number of iterations.
    Works(u32),
    Refused(&'a Sentence),
}

impl ComparedSolve {
    /// Creates a solve without a scene, which is stopped after this number of iterations.
    pub(crate) fn new(most_iterations: Option<u32>) -> Self {
        Self { most_iterations, ..Self::default() }
    }

    /// Returns the requested scene; `None` before the first [`Self::advance`].
    pub(crate) fn scene(&self) -> Option<&Scene> {
        self.wanted.as_ref()
    }

    /// Returns the result of the solve from rest; `None` until it has ended.
    pub(crate) fn end(&self) -> Option<&PaneEnd> {
        self.end.as_ref()
    }

    /// Returns the simulation; `None` while it is solved in the background.
    pub(crate) fn simulation(&self) -> Option<&Simulation> {
        match &self.body {
            ComparedBody::Here(simulation) => Some(simulation),
            _ => None,
        }
    }

    /// Returns the equations of the simulation, for solves on the same mesh.
    pub(crate) fn equations(&self) -> Option<Equations> {
        let simulation = self.simulation()?;
        Some(Equations::new(simulation.scene(), simulation.system(), self.geometry.clone()))
    }

    /// Returns the simulation whose state is to be displayed; `None` if the last displayed one stays.
    pub(crate) fn displayed(&self) -> Option<&Simulation> {
        self.simulation().filter(|_| !self.measures)
    }

    pub(crate) fn activity(&self) -> Activity<'_> {
        match (&self.end, &self.body) {
            (Some(end), _) => Activity::Rests(end),
            (None, ComparedBody::Refused(reason)) => Activity::Refused(reason),
            (None, ComparedBody::Away(solve)) => Activity::Works(match solve.phase() {
                Phase::Iterating(iterations) => iterations,
                _ => 0,
            }),
            (None, ComparedBody::Here(simulation)) => Activity::Iterates(simulation.iterations()),
            (None, ComparedBody::None) => Activity::Iterates(0),
        }
    }

    /// Returns `true` if no work is left.
    pub(crate) fn is_settled(&self) -> bool {
        self.wanted == self.given && (self.end.is_some() || matches!(self.body, ComparedBody::Refused(_)))
    }

    /// Returns `true` if the scene is solved in the background.
    pub(crate) fn is_away(&self) -> bool {
        matches!(self.body, ComparedBody::Away(_))
    }

    /// Returns `true` if the solve from rest found no equilibrium; while a load is held, the one from the state before.
    pub(crate) fn has_failed(&self) -> bool {
        let is_lost = || self.displayed().is_some_and(is_lost);
        self.end.as_ref().map_or_else(is_lost, |end| end.status.failure().is_some())
    }

    /// Returns `true` if the displayed state is a result for its load.
    pub(crate) fn is_sound(&self) -> bool {
        self.end.as_ref().map_or_else(|| self.answer().is_some_and(|(_, good)| good), |_| !self.has_failed())
    }

    /// Returns `true` if the solve waits for the pointer to be released.
    pub(crate) fn waits(&self) -> bool {
        self.end.is_none() && !self.from_rest && self.answer().is_some()
    }

    /// Returns `true` if the displayed state belongs to an earlier load.
    pub(crate) fn is_outdated(&self) -> bool {
        self.is_away() && !self.measures
    }

    /// Returns the result at the first probe, and `true` if it is an equilibrium; `None` while the load is being
    /// solved.
    pub(crate) fn answer(&self) -> Option<(ProbeResult, bool)> {
        let ComparedBody::Here(simulation) = &self.body else { return None };
        let ended = self.given == self.wanted && has_ended(simulation, self.most_iterations);
        if !ended || self.measures {
            return None;
        }
        let probe = probe_results(simulation.problem(), simulation.state()).into_iter().next()?;
        let good = !matches!(simulation.status(), Status::NotConverged(_) | Status::Diverged(_));
        // A solve that starts from another state may fail where one from rest does not.
        (good || self.end.is_some()).then_some((probe, good))
    }

    /// Restarts from rest with another limit of iterations. A background solve is dropped.
    pub(crate) fn restart(&mut self, most_iterations: Option<u32>) {
        self.most_iterations = most_iterations;
        if self.is_away() {
            (self.body, self.given) = (ComparedBody::None, None);
        }
        self.reset();
    }

    /// Restarts from rest.
    pub(crate) fn reset(&mut self) {
        match &mut self.body {
            ComparedBody::Here(simulation) => {
                simulation.reset();
                (self.from_rest, self.measures, self.end) = (true, false, None);
            }
            ComparedBody::Away(_) => {}
            ComparedBody::None | ComparedBody::Refused(_) => self.given = None,
        }
    }

    /// Makes one iteration.
    pub(crate) fn step(&mut self) {
        let most = self.most_iterations;
        if let ComparedBody::Here(simulation) = &mut self.body
            && !has_ended(simulation, most)
        {
            simulation.step();
            self.conclude();
        }
    }

    /// Applies a changed scene, starting from the current state, and iterates.
    pub(crate) fn advance(&mut self, wanted: Scene, equations: &[Equations], frame: FrameConditions) {
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
        let ComparedBody::Away(solve) = &mut self.body else { return true };
        if self.given != self.wanted && solve.age() > LONGEST_OUTDATED {
            solve.cancel();
        }
        let Some(ended) = solve.poll_end() else { return false };
        self.body = match ended {
            Ok(solved) => {
                self.geometry = solved.snapshot.geometry.or_else(|| self.geometry.take());
                ComparedBody::Here(Box::new(solved.snapshot.bodies.simulation))
            }
            Err(reason) => ComparedBody::Refused(reason),
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
            ComparedBody::Here(simulation) => Some(simulation),
            _ => None,
        };
        // A state cannot be transferred to another mesh.
        let simulation = simulation.filter(|simulation| has_mesh_of(simulation.scene(), &scene));
        self.from_rest = simulation.is_none();
        if simulation.is_none() {
            self.geometry = None;
        }
        let system = Equations::of(equations, &scene);
        let model = model(simulation, system);
        self.is_large = scene.unknowns() > MAX_PANE_UNKNOWNS;
        if self.is_large {
            self.send(scene, model, SolveStart::Present);
        } else {
            self.body = set_up(model, &scene);
        }
    }

    /// Starts a solve in the background.
    fn send(&mut self, scene: Scene, model: Model, start: SolveStart) {
        // A search that continues has made a part of its iterations.
        let made = match (&model, &start) {
            (Model::Existing(own), SolveStart::Present) if *own.0.simulation.scene() == scene => {
                own.0.simulation.iterations()
            }
            _ => 0,
        };
        let iterations = self.most_iterations.map(|most| most.saturating_sub(made));
        let request = SolveRequest { scene, model, start, iterations, residuals: Vec::new(), is_displayed: false };
        self.body = match BackgroundSolve::start(request) {
            Ok(solve) => ComparedBody::Away(Box::new(solve)),
            Err(error) => ComparedBody::Refused(sentence!(
                "the system starts no thread for the solve: %{error}",
                error = error.to_string()
            )),
        };
    }

    fn iterate(&mut self, frame: FrameConditions) {
        let most = self.most_iterations;
        let ComparedBody::Here(simulation) = &mut self.body else { return };
        if self.end.is_some() || !frame.runs {
            return;
        }
        while !self.is_large && !has_ended(simulation, most) {
            simulation.step();
            if Instant::now() >= frame.until {
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
        if let (ComparedBody::Here(simulation), Some(scene)) = (std::mem::take(&mut self.body), self.given.clone()) {
            let start = if ended { SolveStart::Rest } else { SolveStart::Present };
            self.send(scene, model(Some(simulation), None), start);
        }
    }

    /// Records the result of a solve from rest.
    fn conclude(&mut self) {
        let ComparedBody::Here(simulation) = &self.body else { return };
        if !self.from_rest || !has_ended(simulation, self.most_iterations) {
            return;
        }
        self.measures = false;
        self.end = Some(PaneEnd {
            status: simulation.status().clone(),
            iterations: simulation.iterations(),
            probes: probe_results(simulation.problem(), simulation.state()),
            is_inside_out: Quality::default().is_inside_out(simulation),
            area_change: simulation.area_change(),
        });
    }

    /// Solves a scene to the end, and waits for it.
    pub(crate) fn solve_to_end(&mut self, wanted: Scene, equations: &[Equations]) {
        let system = Equations::of(equations, &wanted);
        self.body = set_up(model(None, system), &wanted);
        if let ComparedBody::Here(simulation) = &mut self.body {
            while !has_ended(simulation, self.most_iterations) {
                simulation.step();
            }
        }
        (self.wanted, self.given) = (Some(wanted.clone()), Some(wanted));
        (self.from_rest, self.end) = (true, None);
        self.conclude();
    }
}

/// Equations that several solves may share.
#[derive(Clone, Debug)]
pub(crate) struct Equations {
    beam: Option<Beam>,
    mesh: Option<MeshFile>,
    system: Arc<System>,
    /// Display geometry of the mesh, if it is known.
    geometry: Option<Arc<DisplayGeometry>>,
}

impl Equations {
    /// Creates the entry for the equations of a scene.
    pub(crate) fn new(scene: &Scene, system: &Arc<System>, geometry: Option<Arc<DisplayGeometry>>) -> Self {
        Self { beam: scene.beam.clone(), mesh: scene.mesh.clone(), system: system.clone(), geometry }
    }

    /// Returns the equations for a scene's mesh, if they are among `all`.
    pub(super) fn of(all: &[Self], scene: &Scene) -> Option<Arc<System>> {
        let own = all.iter().find(|own| own.beam == scene.beam && own.mesh == scene.mesh);
        own.map(|own| own.system.clone())
    }

    pub(crate) fn system(&self) -> &System {
        &self.system
    }

    /// Returns `true` if the display geometry is known.
    #[cfg(test)]
    pub(crate) fn has_geometry(&self) -> bool {
        self.geometry.is_some()
    }

    /// Returns the display geometry of a system's mesh, if it is among `all`.
    pub(crate) fn geometry_of(all: &[Self], system: &System) -> Option<Arc<DisplayGeometry>> {
        all.iter().filter(|own| own.system.shares_mesh(system)).find_map(|own| own.geometry.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MethodKind;

    /// Returns a cantilever with a downward tip force, N, solved by `method`.
    fn scene(method: MethodKind, cells: [u32; 2], force: f64) -> Scene {
        let mut scene = Scene::beam(2.0, 0.2).clamp("left").force("right", [0.0, -force]).probe("tip", "right");
        scene.solver.method = method;
        scene.beam.as_mut().unwrap().cells = cells;
        scene
    }

    /// Returns the conditions of a frame that has time for one iteration.
    fn frame(holds: bool) -> FrameConditions {
        FrameConditions { holds, runs: true, until: Instant::now() }
    }

    /// Advances until no work is left; returns the number of frames.
    fn iterate(solve: &mut ComparedSolve, scene: &Scene) -> u32 {
        let mut frames = 0;
        loop {
            solve.advance(scene.clone(), &[], frame(false));
            if solve.is_settled() {
                return frames;
            }
            frames += 1;
            std::thread::yield_now();
        }
    }

    /// Returns the result of an independent solve from rest.
    fn independent(scene: &Scene) -> (u32, ProbeResult) {
        let mut simulation = Simulation::new(scene).unwrap();
        simulation.solve();
        let probe = probe_results(simulation.problem(), simulation.state()).remove(0);
        (simulation.iterations(), probe)
    }

    #[test]
    fn a_dragged_load_continues_and_its_cost_is_measured_from_rest() {
        let (light, heavy) = (scene(MethodKind::Newton, [12, 2], 1e3), scene(MethodKind::Newton, [12, 2], 4e6));
        let mut solve = ComparedSolve::new(None);
        assert!(iterate(&mut solve, &light) > 0, "one iteration per frame");
        while !solve.waits() {
            solve.advance(heavy.clone(), &[], frame(true));
            assert!(solve.end().is_none(), "the load is still held");
        }
        let (iterations, probe) = independent(&heavy);
        let (dragged, is_good) = solve.answer().unwrap();
        assert!(is_good && (dragged.u - probe.u).norm() < 1e-6 * probe.u.norm());
        iterate(&mut solve, &heavy);
        let end = solve.end().unwrap();
        assert_eq!((end.iterations, &end.probes[0]), (iterations, &probe));
    }

    #[test]
    fn a_large_model_is_solved_in_the_background_and_follows_the_last_load() {
        let scene = |force| scene(MethodKind::Newton, [300, 8], force);
        let mut solve = ComparedSolve::new(None);
        solve.advance(scene(30.0), &[], frame(false));
        assert!(solve.is_away() && solve.is_outdated() && solve.answer().is_none());
        let last = scene(60.0);
        iterate(&mut solve, &last);
        let (iterations, probe) = independent(&last);
        let end = solve.end().unwrap();
        assert!((end.probes[0].u - probe.u).norm() < 1e-6 * probe.u.norm());
        assert_eq!(end.iterations, iterations, "measured from rest");
    }

    #[test]
    fn a_solve_stops_at_its_limit_of_iterations_and_restarts_with_another() {
        let scene = scene(MethodKind::Newton, [12, 2], 4e6);
        let most = independent(&scene).0;
        assert!(most > 2, "the limit would not be reached");
        let mut solve = ComparedSolve::new(Some(2));
        iterate(&mut solve, &scene);
        assert_eq!(solve.end().map(|end| (&end.status, end.iterations)), Some((&Status::Running, 2)));
        solve.restart(None);
        assert!(solve.end().is_none());
        iterate(&mut solve, &scene);
        assert_eq!(solve.end().map(|end| end.iterations), Some(most));
    }

    #[test]
    fn a_refused_scene_is_named_and_a_later_one_is_solved() {
        let good = scene(MethodKind::Newton, [12, 2], 1e3);
        let mut free = good.clone();
        free.supports.clear();
        let mut solve = ComparedSolve::new(None);
        iterate(&mut solve, &free);
        assert!(matches!(solve.activity(), Activity::Refused(_)) && solve.end().is_none());
        iterate(&mut solve, &good);
        assert!(matches!(solve.activity(), Activity::Rests(end) if end.status.is_success()));
    }
}
