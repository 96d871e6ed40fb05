//! Solve in a worker of a web page. The worker solves its own model, and sends the computed states; the page sets its
//! model to these states, and displays it.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use web_time::{Duration, Instant};

use crate::app::task::quality::Quality;
use crate::app::task::sent_scene::SentScene;
use crate::app::task::solve::{
    Bodies, Model, Phase, Receipt, Rejected, Snapshot, SolveOutcome, SolveProgress, SolveRequest, SolveStart, Solved,
    linear_scene, run,
};
use crate::app::task::thread::{Reporter, Task, Update, Work};
use crate::assembly::System;
use crate::scene::Scene;
use crate::simulation::{Found, Simulation, SimulationError};
use crate::state::State;

/// Request for a solve.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct SolveWork {
    scene: SentScene,
    /// Initial state; `None` is rest.
    state: Option<State>,
    iterations: Option<u32>,
    is_displayed: bool,
}

/// Progress of a solve in a worker.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum SentProgress {
    Phase(Phase),
    Found(Box<SentBodies>),
}

/// States and results of a model.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct SentBodies {
    simulation: Found,
    /// Solution of linear theory, if it has not been sent before.
    linear: Option<Found>,
    residuals: Vec<f64>,
}

/// Solved model, and its quality; `None` if the scene has no model.
type SentOutcome = Option<Box<(SentBodies, Option<Quality>)>>;

impl Work for SolveWork {
    const NAME: &'static str = "solve";
    type Reported = SentProgress;
    type Output = SentOutcome;

    fn run(self, reporter: &Reporter<SentProgress, SentOutcome>) -> SentOutcome {
        let Self { scene, state, iterations, is_displayed } = self;
        let start = state.map_or(SolveStart::Rest, SolveStart::State);
        let (scene, residuals) = (scene.0, Vec::new());
        let request = SolveRequest { scene, model: Model::New, start, iterations, residuals, is_displayed };
        let is_linear_sent = Cell::new(false);
        let sent = |Snapshot { bodies, residuals, .. }: Snapshot| {
            let linear = bodies.linear.filter(|_| !is_linear_sent.replace(true));
            let linear = linear.and_then(|linear| linear.found());
            Some(SentBodies { simulation: bodies.simulation.found()?, linear, residuals })
        };
        let solved = run(request, &|progress| match progress {
            SolveProgress::Phase(phase) => reporter.report(SentProgress::Phase(phase)),
            SolveProgress::Snapshot(snapshot, _) => match sent(*snapshot) {
                Some(found) => reporter.report(SentProgress::Found(Box::new(found))),
                None => ControlFlow::Continue(()),
            },
        });
        let Solved { snapshot, quality } = *solved.ok()?;
        Some(Box::new((sent(snapshot)?, quality)))
    }
}

/// Time that a cancelled worker goes on. A worker that solves another load of the displayed mesh goes on until its first
/// state in any case: while a load is dragged, every solve is cancelled, and nothing would be displayed otherwise.
const GRACE: Duration = Duration::from_millis(500);

/// Solve in a worker. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct RemoteSolve {
    /// `None` if the scene has been rejected.
    task: Option<Task<SentProgress, SentOutcome>>,
    /// Time of the cancellation.
    cancelled: Cell<Option<Instant>>,
    scene: Scene,
    /// Model of the page. A new one is set up when the worker has its own, so that the page goes on until then.
    model: Result<Model, Box<Rejected>>,
    is_displayed: bool,
    /// `true` once the worker has sent a state.
    has_found: bool,
    /// Iterations made before the solve, and their residuals.
    made: u32,
    residuals: Vec<f64>,
}

impl RemoteSolve {
    /// Starts the worker.
    ///
    /// # Errors
    /// The browser cannot start another worker.
    pub(crate) fn start(request: SolveRequest) -> std::io::Result<Self> {
        let SolveRequest { scene, mut model, start, iterations, mut residuals, is_displayed } = request;
        let (mut made, mut present) = (0, None);
        let mut rejected = None;
        if let Model::Existing(own) = model {
            let continues = own.0.simulation.scene() == &scene && matches!(start, SolveStart::Present);
            model = match Model::Existing(own).set_up(&scene) {
                Ok(mut own) => {
                    made = if continues { own.0.simulation.iterations() } else { 0 };
                    // A solve that is cancelled before its first snapshot leaves the model at its start.
                    start.apply(&mut own.0.simulation);
                    present = Some(own.0.simulation.state().clone());
                    Model::Existing(Box::new(own))
                }
                Err(error) => {
                    rejected = Some(error);
                    Model::New
                }
            };
        }
        let state = match start {
            SolveStart::State(state) if present.is_none() => Some(state),
            _ => present,
        };
        if made == 0 {
            residuals.clear();
        }
        let work = SolveWork { scene: SentScene(scene.clone()), state, iterations, is_displayed };
        let task = if rejected.is_none() { Some(Task::run(work)?) } else { None };
        let model = rejected.map_or(Ok(model), Err);
        let cancelled = Cell::default();
        Ok(Self { task, cancelled, scene, model, is_displayed, has_found: false, made, residuals })
    }

    /// Ends the worker later; see [`GRACE`].
    pub(crate) fn cancel(&self) {
        self.cancelled.set(self.cancelled.get().or_else(|| Some(Instant::now())));
    }

    /// Ends the worker.
    pub(crate) fn end(&self) {
        self.cancel();
        self.task.iter().for_each(Task::cancel);
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.get().is_some()
    }

    /// Returns the next update; waits for it if `waits` is `true`.
    pub(crate) fn next(&mut self, waits: bool) -> Update<SolveProgress, SolveOutcome> {
        let may_end = self.has_found || matches!(self.model, Ok(Model::New));
        if may_end && self.cancelled.get().is_some_and(|since| since.elapsed() >= GRACE) {
            self.end();
        }
        match self.task.as_ref().map(|task| task.next(waits)) {
            Some(Update::None) => Update::None,
            Some(Update::Progress(SentProgress::Phase(phase))) => Update::Progress(SolveProgress::Phase(phase)),
            Some(Update::Progress(SentProgress::Found(sent))) => {
                self.has_found = true;
                match self.take_over(*sent) {
                    Ok(snapshot) => self.display(snapshot),
                    Err(rejected) => Update::Done(Err(rejected)),
                }
            }
            Some(Update::Done(Some(solved))) => {
                let (sent, quality) = *solved;
                Update::Done(self.take_over(sent).map(|snapshot| Box::new(Solved { snapshot, quality })))
            }
            // After a cancelled worker has ended, the page keeps its own model.
            Some(Update::Died) if self.is_cancelled() && matches!(self.model, Ok(Model::Existing(_))) => {
                Update::Done(self.set_up().map(|snapshot| Box::new(Solved { snapshot, quality: None })))
            }
            Some(Update::Died) => Update::Died,
            Some(Update::Done(None)) | None => match self.set_up() {
                Ok(_) => Update::Died,
                Err(rejected) => Update::Done(Err(rejected)),
            },
        }
    }

    /// Takes the model of the page as it is.
    fn set_up(&mut self) -> Result<Snapshot, Box<Rejected>> {
        let model = std::mem::replace(&mut self.model, Ok(Model::New))?;
        let (bodies, geometry) = model.set_up(&self.scene)?;
        Ok(Snapshot { bodies, geometry, residuals: std::mem::take(&mut self.residuals) })
    }

    /// Takes the model of the page, with what the worker has found.
    fn take_over(&mut self, sent: SentBodies) -> Result<Snapshot, Box<Rejected>> {
        let rejected = |error: SimulationError| Box::new(Rejected { error, model: None });
        let model = std::mem::replace(&mut self.model, Ok(Model::New))?;
        let needs_geometry = self.is_displayed && matches!(model, Model::New);
        let (system, known, geometry) = match model {
            Model::Existing(own) => (own.0.simulation.system().clone(), own.0.linear, own.1),
            Model::Equations(system) => (system, None, None),
            Model::New => {
                (Arc::new(System::for_display(&self.scene).map_err(|error| rejected(error.into()))?), None, None)
            }
        };
        let SentBodies { simulation: mut found, linear, residuals } = sent;
        found.add_iterations(self.made);
        let residuals = [self.residuals.as_slice(), &residuals].concat();
        let simulation = Simulation::with_found(&self.scene, system, found).map_err(rejected)?;
        let sent_linear =
            |found| Simulation::with_found(&linear_scene(&self.scene), simulation.system().clone(), found);
        let linear = linear.map_or(known, |found| sent_linear(found).ok());
        let bodies = Bodies { simulation, linear };
        let geometry = geometry.or_else(|| needs_geometry.then(|| bodies.geometry()));
        Ok(Snapshot { bodies, geometry, residuals })
    }

    /// Returns a copy to display, and keeps the model.
    fn display(&mut self, snapshot: Snapshot) -> Update<SolveProgress, SolveOutcome> {
        let Snapshot { bodies, geometry, residuals } = snapshot;
        let copy = bodies.snapshot();
        self.model = Ok(Model::Existing(Box::new((bodies, None))));
        copy.map_or(Update::None, |bodies| {
            let snapshot = Box::new(Snapshot { bodies, geometry, residuals });
            Update::Progress(SolveProgress::Snapshot(snapshot, Receipt::default()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MethodKind, Source, open};
    use crate::simulation::Status;

    fn request(scene: &Scene, model: Model) -> SolveRequest {
        let start = SolveStart::Present;
        SolveRequest { scene: scene.clone(), model, start, iterations: None, residuals: Vec::new(), is_displayed: true }
    }

    /// Solves to the end, and counts the display geometries.
    fn solve(request: SolveRequest) -> (SolveOutcome, usize) {
        let mut solve = RemoteSolve::start(request).unwrap();
        let mut geometries = 0;
        loop {
            match solve.next(true) {
                Update::Done(outcome) => break (outcome, geometries),
                Update::Died => panic!("no result"),
                Update::Progress(SolveProgress::Snapshot(shown, _)) => {
                    geometries += usize::from(shown.geometry.is_some())
                }
                Update::None | Update::Progress(_) => {}
            }
        }
    }

    #[test]
    fn a_remote_solve_ends_as_a_solve_on_the_page() {
        let mut scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        for method in [MethodKind::Linear, MethodKind::Warped, MethodKind::Newton, MethodKind::Auto] {
            scene.solver.method = method;
            let own = run(request(&scene, Model::New), &|_| std::ops::ControlFlow::Continue(())).unwrap();
            let (remote, geometries) = solve(request(&scene, Model::New));
            let remote = remote.unwrap();
            assert_eq!(geometries + usize::from(remote.snapshot.geometry.is_some()), 1);
            assert_eq!(remote.quality.unwrap().max_strain, own.quality.unwrap().max_strain);
            assert_eq!(remote.snapshot.residuals, own.snapshot.residuals);
            let (own, remote) = (own.snapshot.bodies, remote.snapshot.bodies);
            assert_eq!(remote.linear.unwrap().state(), own.linear.unwrap().state());
            let (mut own, mut remote) = (own.simulation, remote.simulation);
            assert_eq!(remote.state(), own.state());
            assert_eq!((remote.status(), remote.iterations()), (&Status::Converged, own.iterations()));
            let figures = |simulation: &Simulation| {
                let search = simulation.equilibrium().unwrap();
                let auto = search.auto_report().map(|report| (report.decision, report.solves, report.factorizations));
                (search.certificate(), search.load_factor(), search.load_steps(), search.step_ratio(), auto)
            };
            assert_eq!(figures(&remote), figures(&own));
            // The model of the page goes on from what the worker has found.
            for simulation in [&mut own, &mut remote] {
                simulation.set_force(scene.load_on("right").unwrap(), [0.0, -20e3]).unwrap();
                assert_eq!(*simulation.solve(), Status::Converged, "{method:?}");
            }
            let lift = |simulation: &Simulation| simulation.probe("tip").unwrap().y;
            assert!((lift(&remote) / lift(&own) - 1.0).abs() < 1e-6, "{method:?}");
        }
    }

    #[test]
    fn a_rejected_scene_leaves_the_model_as_it_was() {
        let scene = Scene::beam(2.0, 1.0).clamp("left");
        let own = || Bodies { simulation: Simulation::new(&scene).unwrap(), linear: None };
        let wrong = Scene::beam(2.0, 1.0);
        let existing = solve(request(&wrong, Model::Existing(Box::new((own(), None))))).0.unwrap_err();
        assert_eq!(*existing.model.unwrap().0.simulation.scene(), scene);
        let new = solve(request(&wrong, Model::New)).0.unwrap_err();
        assert_eq!((new.error, new.model.is_none()), (existing.error, true));
    }

    /// A solve that is cancelled before its first snapshot leaves the page's model, which has to be at its start then.
    #[test]
    fn the_model_of_the_page_starts_where_the_worker_starts() {
        let scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        let mut simulation = Simulation::new(&scene).unwrap();
        let rest = simulation.state().clone();
        simulation.solve();
        assert_ne!(*simulation.state(), rest);
        let model = Model::Existing(Box::new((Bodies { simulation, linear: None }, None)));
        let solve = RemoteSolve::start(SolveRequest { start: SolveStart::Rest, ..request(&scene, model) }).unwrap();
        let Ok(Model::Existing(own)) = &solve.model else { panic!("no model") };
        assert_eq!(*own.0.simulation.state(), rest);
    }

    /// While a load is dragged, every solve is cancelled before its end.
    #[test]
    fn a_cancelled_solve_on_the_displayed_mesh_goes_on_until_its_first_state() {
        let mut scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        let bodies = Bodies { simulation: Simulation::new(&scene).unwrap(), linear: None };
        scene.solver.method = MethodKind::Newton;
        let mut solve = RemoteSolve::start(request(&scene, Model::Existing(Box::new((bodies, None))))).unwrap();
        solve.cancelled.set(Instant::now().checked_sub(GRACE));
        let first = loop {
            match solve.next(true) {
                Update::Progress(SolveProgress::Snapshot(shown, _)) => {
                    break Some(shown.bodies.simulation.iterations());
                }
                Update::Done(_) | Update::Died => break None,
                Update::None | Update::Progress(SolveProgress::Phase(_)) => {}
            }
        };
        assert_eq!(first, Some(1));
    }
}
