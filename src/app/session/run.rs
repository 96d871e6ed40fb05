//! Run of a scene, to be compared with others: a solve or a motion. Small models are made and iterate between two
//! frames, large ones in the background. The cost of a solve is measured from rest.

use super::*;
use crate::app::session::facts::first_probe;
use crate::app::task::solve::{BackgroundSolve, Equations, MAX_PANE_UNKNOWNS, ModelBase, Phase, SolveRequest};
use crate::app::task::thread::Update;
use crate::simulation::{Deformation, ProbeResult, probe_results};

/// Solve or motion of a scene, for comparison with others.
#[derive(Default)]
pub struct Run {
    /// Number of iterations after which a solve is stopped.
    most_iterations: Option<u32>,
    /// Requested scene; `None` before the first [`Self::turn_to`].
    pub wanted: Option<Scene>,
    /// Scene that the model has, is being solved for in the background, or was refused for.
    given: Option<Scene>,
    /// `true` if `given` is too large to be solved between two frames.
    is_large: bool,
    place: RunPlace,
    /// `true` if the solve started from rest, so that its cost does not depend on earlier states.
    from_rest: bool,
    /// `true` while a solve from rest only measures the cost; the equilibrium found before stays on display.
    measures: bool,
    /// Result of the solve from rest; `None` until it has ended.
    pub end: Option<PaneEnd>,
}

/// Result of a pane's solve from rest.
#[derive(Clone, Debug, PartialEq)]
pub struct PaneEnd {
    /// Final status; [`Status::Running`] if it was stopped after the setting's number of iterations.
    pub status: Status,
    /// Iterations from rest.
    pub iterations: u32,
    /// Results at the probes.
    pub probes: Vec<ProbeResult>,
    /// Deformation of the final state.
    pub deformation: Deformation,
}

/// Condition of a displayed state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Condition {
    /// The state is a result for its load, or a motion that goes on.
    Result,
    /// The solve has not ended.
    Unfinished,
    /// The state belongs to an earlier load.
    Outdated,
    /// The solve from rest found no equilibrium, or, while a load is held, the one from the state before; or a motion has
    /// stopped, or there is no model. The state is dimmed.
    Failed,
}

/// Place where a model is solved.
#[derive(Default)]
enum RunPlace {
    /// No model yet.
    #[default]
    None,
    Here(Box<Model>),
    Away(Box<BackgroundSolve>),
    /// Error of the scene.
    Refused(Sentence),
}

impl RunPlace {
    /// Sets up a model on the current thread.
    fn here(base: ModelBase, scene: &Scene) -> Self {
        base.set_up(scene).map_or_else(|error| Self::Refused((&error).into()), Self::Here)
    }
}

/// Returns `true` if a simulation needs no more steps.
fn has_ended(simulation: &Simulation, most_iterations: Option<u32>) -> bool {
    let is_over = match simulation.motion() {
        Some(_) => matches!(simulation.status(), Status::Stopped(_)),
        None => *simulation.status() != Status::Running,
    };
    is_over || most_iterations.is_some_and(|most| simulation.iterations() >= most)
}

/// Returns `true` if a state can be transferred from one scene to the other: not to another mesh, and not to a motion with
/// other settings.
fn continues(one: &Scene, other: &Scene) -> bool {
    has_mesh_of(one, other) && one.dynamics == other.dynamics
}

impl Run {
    /// Creates a run without a scene, whose solves are stopped after this number of iterations.
    pub(crate) fn new(most_iterations: Option<u32>) -> Self {
        Self { most_iterations, ..Self::default() }
    }

    /// Returns the model; `None` while it is set up or solved in the background.
    pub(crate) fn model(&self) -> Option<&Model> {
        if let RunPlace::Here(model) = &self.place { Some(model) } else { None }
    }

    /// Returns the model whose state is to be displayed; `None` if the last displayed one stays.
    pub(crate) fn displayed(&self) -> Option<&Model> {
        self.model().filter(|_| !self.measures)
    }

    /// Returns the number of iterations that have been made.
    pub(crate) fn iterations(&self) -> u32 {
        match &self.place {
            RunPlace::Here(model) => model.simulation.iterations(),
            RunPlace::Away(solve) => match solve.phase {
                Phase::Iterating(iterations) => iterations,
                _ => 0,
            },
            RunPlace::None | RunPlace::Refused(_) => 0,
        }
    }

    /// Returns the error of the scene, if there is no model.
    pub(crate) fn refused(&self) -> Option<&Sentence> {
        if let RunPlace::Refused(reason) = &self.place { Some(reason) } else { None }
    }

    /// Returns `true` if no work is left of a solve.
    pub(crate) fn is_settled(&self) -> bool {
        self.wanted == self.given && (self.end.is_some() || self.refused().is_some())
    }

    /// Returns `true` if the model is set up or solved in the background.
    pub(crate) fn is_away(&self) -> bool {
        matches!(self.place, RunPlace::Away(_))
    }

    pub(crate) fn moves(&self) -> bool {
        self.model().is_some_and(|model| !model.simulation.is_at_rest())
    }

    pub(crate) fn condition(&self) -> Condition {
        let status = self.end.as_ref().map(|end| &end.status);
        let status = status.or_else(|| Some(self.displayed()?.simulation.status()));
        let is_result = |model: &Model| {
            let ends = || self.given == self.wanted && has_ended(&model.simulation, self.most_iterations);
            self.end.is_some() || model.simulation.motion().is_some() || ends()
        };
        if self.is_away() && !self.measures {
            Condition::Outdated
        } else if self.refused().is_some() || status.is_some_and(|status| status.failure().is_some()) {
            Condition::Failed
        } else if self.displayed().is_some_and(is_result) {
            Condition::Result
        } else {
            Condition::Unfinished
        }
    }

    /// Returns `true` if the displayed state is a result for its load, or a motion that goes on.
    pub(crate) fn is_sound(&self) -> bool {
        self.condition() == Condition::Result
    }

    /// Returns `true` if the solve waits for the pointer to be released.
    pub(crate) fn waits(&self) -> bool {
        self.end.is_none() && !self.from_rest && self.is_sound()
    }

    /// Returns the displacement of the first probe, m, in a sound state.
    pub(crate) fn answer(&self) -> Option<Vector2<f64>> {
        first_probe(&self.displayed().filter(|_| self.is_sound())?.simulation)
    }

    /// Restarts from rest with another limit of iterations. A background solve is dropped.
    pub(crate) fn restart(&mut self, most_iterations: Option<u32>) {
        self.most_iterations = most_iterations;
        if self.is_away() {
            (self.place, self.given) = (RunPlace::None, None);
        }
        self.reset();
    }

    /// Restarts from rest, or from the start of the motion.
    pub(crate) fn reset(&mut self) {
        match &mut self.place {
            RunPlace::Here(model) => {
                model.simulation.reset();
                (self.from_rest, self.measures, self.end) = (true, false, None);
            }
            RunPlace::Away(_) => {}
            RunPlace::None | RunPlace::Refused(_) => self.given = None,
        }
    }

    /// Makes one iteration or time step.
    pub(crate) fn step(&mut self) {
        let most = self.most_iterations;
        if let RunPlace::Here(model) = &mut self.place
            && !has_ended(&model.simulation, most)
        {
            model.simulation.step();
            self.conclude();
        }
    }

    /// Applies a changed scene; a mesh that is among `known` is not made again. Returns `true` if the run starts over,
    /// because its mesh or its dynamics has changed, or comes back from the background.
    pub(crate) fn turn_to(&mut self, wanted: Scene, known: &[Equations]) -> bool {
        if self.wanted.as_ref() != Some(&wanted) {
            self.wanted = Some(wanted);
            self.end = None;
        }
        let was_away = self.is_away();
        if !self.take_solved() {
            return false;
        }
        let starts_over = self.given != self.wanted && self.take_on(known);
        starts_over || was_away
    }

    /// Applies a changed scene at rest, and iterates `until` the end of the time for that, if it runs. While the pointer
    /// `holds` a load, the solve continues from the current state.
    pub(crate) fn advance(&mut self, wanted: Scene, known: &[Equations], until: Option<Instant>, holds: bool) {
        self.turn_to(wanted, known);
        if let Some(until) = until {
            self.iterate(until, holds);
        }
    }

    /// Takes back a model that was solved in the background; returns `false` while it is still being solved.
    fn take_solved(&mut self) -> bool {
        let RunPlace::Away(solve) = &mut self.place else { return true };
        if self.given != self.wanted {
            solve.task.cancel();
        }
        self.place = loop {
            match solve.task.poll() {
                Update::None => return false,
                Update::Progress(phase) => solve.phase = phase,
                Update::Done(outcome) => {
                    break outcome.map_or_else(|error| RunPlace::Refused((&error).into()), RunPlace::Here);
                }
                Update::Died => {
                    let reason = sentence!("the solve ended unexpectedly: change a value to solve again");
                    break RunPlace::Refused(reason);
                }
            }
        };
        if self.given == self.wanted {
            self.conclude();
        }
        true
    }

    /// Sets the scene of the model, or creates one; returns `true` if it starts over.
    fn take_on(&mut self, known: &[Equations]) -> bool {
        let Some(scene) = self.wanted.clone() else { return false };
        self.given = Some(scene.clone());
        self.measures = false;
        let base = match std::mem::take(&mut self.place) {
            RunPlace::Here(model) if continues(model.simulation.scene(), &scene) => ModelBase::Model(model),
            _ => ModelBase::among(known, &scene),
        };
        self.from_rest = !matches!(base, ModelBase::Model(_));
        self.is_large = scene.unknowns() > MAX_PANE_UNKNOWNS;
        // The time steps of a large motion are made between two frames.
        if self.is_large && (self.from_rest || scene.analysis == Analysis::Static) {
            self.send(scene, base, false);
        } else {
            self.place = RunPlace::here(base, &scene);
        }
        self.from_rest && self.refused().is_none()
    }

    /// Starts a solve in the background.
    fn send(&mut self, scene: Scene, base: ModelBase, from_rest: bool) {
        // A search that continues has made a part of its iterations.
        let made = match &base {
            ModelBase::Model(model) if !from_rest && *model.simulation.scene() == scene => {
                model.simulation.iterations()
            }
            _ => 0,
        };
        let iterations = self.most_iterations.map(|most| most.saturating_sub(made));
        let request = SolveRequest { scene, base, from_rest, iterations, is_displayed: false };
        self.place = match BackgroundSolve::start(request) {
            Ok(solve) => RunPlace::Away(Box::new(solve)),
            Err(error) => RunPlace::Refused(sentence!(
                "the system starts no thread for the solve: %{error}",
                error = error.to_string()
            )),
        };
    }

    fn iterate(&mut self, until: Instant, holds: bool) {
        let most = self.most_iterations;
        let RunPlace::Here(model) = &mut self.place else { return };
        let simulation = &mut model.simulation;
        if self.end.is_some() {
            return;
        }
        while !self.is_large && !has_ended(simulation, most) {
            simulation.step();
            if Instant::now() >= until {
                break;
            }
        }
        let ended = has_ended(simulation, most);
        if ended && self.from_rest {
            return self.conclude();
        }
        if ended && holds || !ended && !self.is_large {
            return;
        }
        // The result reports the cost of a solve from rest, so a solve from another state is repeated from rest.
        if ended {
            (self.from_rest, self.measures) = (true, true);
        }
        if !self.is_large {
            return simulation.reset();
        }
        if let (RunPlace::Here(model), Some(scene)) = (std::mem::take(&mut self.place), self.given.clone()) {
            self.send(scene, ModelBase::Model(model), ended);
        }
    }

    /// Records the result of a solve from rest.
    fn conclude(&mut self) {
        let RunPlace::Here(model) = &self.place else { return };
        let simulation = &model.simulation;
        if !self.from_rest || !has_ended(simulation, self.most_iterations) {
            return;
        }
        self.measures = false;
        self.end = Some(PaneEnd {
            status: simulation.status().clone(),
            iterations: simulation.iterations(),
            probes: probe_results(simulation.problem(), simulation.state()),
            deformation: Deformation::of(simulation.problem(), simulation.state(), &simulation.nodal_stress()),
        });
    }

    /// Solves a scene to the end, and waits for it.
    pub(crate) fn solve_to_end(&mut self, wanted: Scene, known: &[Equations]) {
        self.place = RunPlace::here(ModelBase::among(known, &wanted), &wanted);
        (self.wanted, self.given) = (Some(wanted.clone()), Some(wanted));
        (self.from_rest, self.end) = (true, None);
        while self.model().is_some_and(|model| !has_ended(&model.simulation, self.most_iterations)) {
            self.step();
        }
        self.conclude();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a cantilever with a downward tip force, N, solved by `method`.
    fn scene(method: MethodKind, cells: [u32; 2], force: f64) -> Scene {
        let mut scene = Scene::beam(2.0, 0.2).clamp("left").force("right", [0.0, -force]).probe("tip", "right");
        scene.solver.method = method;
        scene.beam.as_mut().unwrap().cells = cells;
        scene
    }

    /// Makes a frame that has time for one iteration.
    fn advance(run: &mut Run, scene: &Scene, holds: bool) {
        run.advance(scene.clone(), &[], Some(Instant::now()), holds);
    }

    /// Advances until no work is left; returns the number of frames.
    fn iterate(run: &mut Run, scene: &Scene) -> u32 {
        let mut frames = 0;
        loop {
            advance(run, scene, false);
            if run.is_settled() {
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
        let mut run = Run::new(None);
        assert!(iterate(&mut run, &light) > 0, "one iteration per frame");
        while !run.waits() {
            advance(&mut run, &heavy, true);
            assert!(run.end.is_none(), "the load is still held");
        }
        let (iterations, probe) = independent(&heavy);
        let dragged = run.answer().unwrap();
        assert!(run.is_sound() && (dragged - probe.u).norm() < 1e-6 * probe.u.norm());
        iterate(&mut run, &heavy);
        let end = run.end.as_ref().unwrap();
        assert_eq!((end.iterations, &end.probes[0]), (iterations, &probe));
    }

    #[test]
    fn a_large_model_is_solved_in_the_background_and_follows_the_last_load() {
        let scene = |force| scene(MethodKind::Newton, [300, 8], force);
        let mut run = Run::new(None);
        advance(&mut run, &scene(30.0), false);
        assert!(run.is_away() && run.condition() == Condition::Outdated && run.answer().is_none());
        let last = scene(60.0);
        iterate(&mut run, &last);
        let (iterations, probe) = independent(&last);
        let end = run.end.as_ref().unwrap();
        assert!((end.probes[0].u - probe.u).norm() < 1e-6 * probe.u.norm());
        assert_eq!(end.iterations, iterations, "measured from rest");
    }

    #[test]
    fn a_solve_stops_at_its_limit_of_iterations_and_restarts_with_another() {
        let scene = scene(MethodKind::Newton, [12, 2], 4e6);
        let most = independent(&scene).0;
        assert!(most > 2, "the limit would not be reached");
        let mut run = Run::new(Some(2));
        iterate(&mut run, &scene);
        assert_eq!(run.end.as_ref().map(|end| (&end.status, end.iterations)), Some((&Status::Running, 2)));
        run.restart(None);
        assert!(run.end.is_none());
        iterate(&mut run, &scene);
        assert_eq!(run.end.as_ref().map(|end| end.iterations), Some(most));
    }

    #[test]
    fn a_refused_scene_is_named_and_a_later_one_is_solved() {
        let good = scene(MethodKind::Newton, [12, 2], 1e3);
        let mut free = good.clone();
        free.supports.clear();
        let mut run = Run::new(None);
        iterate(&mut run, &free);
        assert!(run.refused().is_some() && run.end.is_none());
        iterate(&mut run, &good);
        assert!(run.end.as_ref().is_some_and(|end| end.status.is_success()));
    }

    fn simulation(run: &Run) -> &Simulation {
        &run.model().unwrap().simulation
    }

    #[test]
    fn a_changed_load_continues_the_motion_and_a_changed_integrator_restarts_it() {
        let fall = |acceleration: f64, integrator| {
            let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -acceleration]).probe("tip", "right");
            scene.moving(integrator, 0.01)
        };
        let mut motion = Run::default();
        assert!(motion.turn_to(fall(9.81, IntegratorKind::TrBdf2), &[]));
        (0..5).for_each(|_| motion.step());
        let tip = motion.answer().unwrap();
        assert!(tip.y < 0.0);
        assert!(!motion.turn_to(fall(20.0, IntegratorKind::TrBdf2), &[]), "the motion continues");
        assert_eq!(motion.answer(), Some(tip));
        assert!(motion.turn_to(fall(20.0, IntegratorKind::ImplicitEuler), &[]));
        assert_eq!(motion.answer(), Some(Vector2::zeros()));
        // One that cannot begin does not begin again at every frame, with all others.
        let refused = fall(20.0, IntegratorKind::TrBdf2).clamp("nowhere");
        assert!(!motion.turn_to(refused.clone(), &[]) && motion.refused().is_some());
        motion.reset();
        assert!(!motion.turn_to(refused, &[]));
    }

    /// Neither another integrator nor another damping makes the mesh again; a large motion is set up in the background.
    #[test]
    fn a_mesh_is_made_once_and_a_large_motion_in_the_background() {
        let scene = |cells: u32, damping: f64, integrator| {
            let scene = Scene::beam(20.0, 0.5).with_cells(cells, 2).clamp("left").gravity([0.0, -9.81]);
            let mut scene = scene.probe("tip", "right").moving(integrator, 0.01);
            scene.dynamics.damping.stiffness = damping;
            scene
        };
        let mut motion = Run::default();
        assert!(motion.turn_to(scene(1000, 0.0, IntegratorKind::TrBdf2), &[]));
        assert!(motion.is_away() && motion.model().is_none() && !motion.moves());
        while !motion.turn_to(scene(1000, 0.0, IntegratorKind::TrBdf2), &[]) {
            std::thread::yield_now();
        }
        assert!(motion.moves() && simulation(&motion).status() == &Status::Running);
        let system = simulation(&motion).system().clone();
        for (damping, integrator) in [(1e-3, IntegratorKind::TrBdf2), (1e-3, IntegratorKind::ImplicitEuler)] {
            let equations: Vec<_> = motion.model().map(Model::equations).into_iter().collect();
            assert!(motion.turn_to(scene(1000, damping, integrator), &equations));
            while !motion.turn_to(scene(1000, damping, integrator), &[]) {
                std::thread::yield_now();
            }
            assert!(Arc::ptr_eq(simulation(&motion).system(), &system), "{integrator:?}");
        }
    }

    #[test]
    fn an_unstable_motion_stops_and_names_the_reason() {
        let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -9.81]);
        let mut motion = Run::default();
        motion.turn_to(scene.moving(IntegratorKind::SymplecticEuler, 0.01), &[]);
        for _ in 0..1000 {
            if !motion.is_sound() {
                break;
            }
            motion.step();
        }
        assert!(simulation(&motion).status().failure().is_some() && !motion.is_sound());
        let stopped = simulation(&motion).state().clone();
        motion.step();
        assert!(*simulation(&motion).state() == stopped, "an unstable motion makes no more steps");
        motion.reset();
        assert!(motion.is_sound() && simulation(&motion).status().failure().is_none());
    }
}
