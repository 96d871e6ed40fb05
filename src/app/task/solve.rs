//! Solve of a large model: request, progress and result.

use std::ops::ControlFlow;
use std::sync::Arc;

use web_time::{Duration, Instant};

use crate::app::platform::IS_PAGE;
use crate::app::task::quality::Quality;
use crate::assembly::System;
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::{Analysis, Invalid, MethodKind, Scene, SolverSettings};
use crate::sentence::sentence;
use crate::simulation::{Equilibrium, Simulation, SimulationError, Status};
use crate::state::State;

/// Largest number of unknowns of a model that is meshed and solved between two frames.
pub(crate) const MAX_UNKNOWNS: u64 = 16_000;
/// Largest number of unknowns of a model that is solved between two frames in a pane of Compare, which shows several.
pub(crate) const MAX_PANE_UNKNOWNS: u64 = 4000;

/// Time between two snapshots while a model is solved.
const SNAPSHOT: Duration = Duration::from_millis(100);

/// Largest number of residuals recorded for one solve.
const MAX_RESIDUALS: usize = 400;

/// Simulation, and the one of linear theory on the same equations; `None` if it could not be set up.
#[derive(Debug)]
pub(crate) struct Bodies {
    pub simulation: Simulation,
    pub linear: Option<Simulation>,
}

impl Bodies {
    /// Returns copies of both simulations to display while the solve goes on; `None` for a motion, which has no
    /// search.
    pub(crate) fn snapshot(&self) -> Option<Self> {
        let linear = self.linear.as_ref().and_then(Simulation::equilibrium).map(Equilibrium::snapshot);
        Some(Self { simulation: self.simulation.equilibrium()?.snapshot(), linear })
    }

    /// Returns the display geometry of a new mesh.
    pub(crate) fn geometry(&self) -> Arc<DisplayGeometry> {
        // Smooth fields need the nodal recovery; computing it here avoids a delay between two frames.
        let _ = self.simulation.system().recovery();
        Arc::new(DisplayGeometry::new(self.simulation.system().mesh()))
    }
}

/// Model that a solve starts with.
#[derive(Debug)]
pub(crate) enum Model {
    /// Existing model, with its display geometry if that has not been displayed yet.
    Existing(Box<(Bodies, Option<Arc<DisplayGeometry>>)>),
    /// New model on existing equations.
    Equations(Arc<System>),
    /// New model, which is meshed first.
    New,
}

/// State that a solve starts from.
#[derive(Debug, Default)]
pub(crate) enum SolveStart {
    /// Current state of the model.
    #[default]
    Present,
    Rest,
    State(State),
}

impl SolveStart {
    /// Sets the state that a solve starts from. A state of another mesh does not fit and is ignored.
    pub(crate) fn apply(&self, simulation: &mut Simulation) {
        match self {
            Self::Present => {}
            Self::Rest => simulation.reset(),
            Self::State(state) => _ = simulation.restore(state),
        }
    }
}

/// Request for a solve.
#[derive(Debug)]
pub(crate) struct SolveRequest {
    pub scene: Scene,
    pub model: Model,
    pub start: SolveStart,
    /// Largest number of iterations; `None` for no limit.
    pub iterations: Option<u32>,
    /// Residuals recorded before the solve.
    pub residuals: Vec<f64>,
    /// `true` if the main view shows the model: the solve then reports snapshots, and also computes the solution of
    /// linear theory and the quality.
    pub is_displayed: bool,
}

/// Model to display, at one instant.
#[derive(Debug)]
pub(crate) struct Snapshot {
    pub bodies: Bodies,
    /// Display geometry of a new mesh.
    pub geometry: Option<Arc<DisplayGeometry>>,
    pub residuals: Vec<f64>,
}

/// Current phase of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Meshing,
    LinearSolve,
    /// Iterating, with the number of iterations made.
    Iterating(u32),
    Certifying,
}

/// Progress of a solve.
#[derive(Debug)]
pub(crate) enum SolveProgress {
    Phase(Phase),
    Snapshot(Box<Snapshot>, Receipt),
}

/// Receipt of a snapshot, dropped when the snapshot has been received: until then no other one is made, so that those of
/// a hidden window, which receives none, do not pile up.
#[derive(Clone, Debug, Default)]
pub(crate) struct Receipt(Arc<()>);

impl Receipt {
    /// Returns `true` if no copy is left.
    fn is_received(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}

/// Solved model: the original, not a copy.
#[derive(Debug)]
pub(crate) struct Solved {
    pub snapshot: Snapshot,
    /// Quality of a displayed model whose iteration has ended.
    pub quality: Option<Quality>,
}

/// Error of a scene that has no model; the existing model is unchanged.
#[derive(Debug)]
pub(crate) struct Rejected {
    pub error: SimulationError,
    pub model: Option<(Bodies, Option<Arc<DisplayGeometry>>)>,
}

pub(crate) type SolveOutcome = Result<Box<Solved>, Box<Rejected>>;

/// Records the residual of an iteration; a new solve starts a new list.
pub(crate) fn note_residual(simulation: &Simulation, residuals: &mut Vec<f64>) {
    if simulation.iterations() <= 1 || residuals.len() >= MAX_RESIDUALS {
        residuals.clear();
    }
    residuals.push(simulation.residual());
}

/// Returns the scene with linear theory as the method.
pub(crate) fn linear_scene(scene: &Scene) -> Scene {
    let solver = SolverSettings { method: MethodKind::Linear, ..scene.solver.clone() };
    Scene { solver, ..scene.clone() }
}

/// Solves a static scene with linear theory on existing equations; `None` for a motion. `known` is the solution of the
/// previous scene.
pub(crate) fn solve_linear(scene: &Scene, system: &Arc<System>, known: Option<Simulation>) -> Option<Simulation> {
    if scene.analysis == Analysis::Dynamic {
        return None;
    }
    let scene = linear_scene(scene);
    let mut shared = known.filter(|linear| Arc::ptr_eq(linear.system(), system));
    shared = shared.and_then(|mut linear| linear.change_scene(&scene).is_ok().then_some(linear));
    let mut linear = shared.or_else(|| Simulation::with_system(&scene, system.clone()).ok())?;
    linear.solve();
    Some(linear)
}

/// Refuses a model that takes too long for a web page, which solves it on its own thread.
///
/// # Errors
/// The number of unknowns that a page solves.
pub(crate) fn check_size(scene: &Scene) -> Result<(), SimulationError> {
    let (most, n) = (MAX_UNKNOWNS, scene.unknowns());
    if !IS_PAGE || n <= most {
        return Ok(());
    }
    let key = if scene.mesh.is_some() { "mesh.file" } else { "beam.cells" };
    let [most, n] = [most, n].map(|n| n as usize);
    Err(Invalid::new(
        key,
        sentence!(
            "expected at most %{most} unknowns on a web page, got %{n}; the program for desktops solves larger models",
            most,
            n
        ),
    )
    .into())
}

impl Model {
    /// Sets up the model of a scene, before its first iteration.
    ///
    /// # Errors
    /// [`Rejected`].
    pub(crate) fn set_up(self, scene: &Scene) -> Result<(Bodies, Option<Arc<DisplayGeometry>>), Box<Rejected>> {
        let made = match self {
            Self::Existing(own) if own.0.simulation.scene() == scene => return Ok(*own),
            Self::Existing(mut own) => {
                return match own.0.simulation.change_scene(scene) {
                    Ok(()) => Ok(*own),
                    Err(error) => Err(Box::new(Rejected { error, model: Some(*own) })),
                };
            }
            Self::Equations(system) => Simulation::with_system(scene, system),
            Self::New => check_size(scene).and_then(|()| Simulation::new(scene)),
        };
        let simulation = made.map_err(|error| Box::new(Rejected { error, model: None }))?;
        Ok((Bodies { simulation, linear: None }, None))
    }
}

/// Solves; `report` breaks to cancel.
///
/// # Errors
/// [`Rejected`].
pub(crate) fn run(request: SolveRequest, report: &dyn Fn(SolveProgress) -> ControlFlow<()>) -> SolveOutcome {
    let SolveRequest { scene, model, start, iterations, mut residuals, is_displayed } = request;
    let is_new = matches!(model, Model::New);
    let (mut bodies, mut geometry) = model.set_up(&scene)?;
    if is_new {
        geometry = Some(bodies.geometry());
    }
    start.apply(&mut bodies.simulation);
    if is_displayed && bodies.linear.as_ref().is_none_or(|linear| *linear.scene() != linear_scene(&scene)) {
        let known = bodies.linear.take();
        if report(SolveProgress::Phase(Phase::LinearSolve)).is_continue() {
            bodies.linear = solve_linear(&scene, bodies.simulation.system(), known);
        }
    }
    let (mut made, mut shown, receipt) = (0, None::<Instant>, Receipt::default());
    while bodies.simulation.motion().is_none()
        && *bodies.simulation.status() == Status::Running
        && iterations.is_none_or(|most| made < most)
        && report(SolveProgress::Phase(Phase::Iterating(bodies.simulation.iterations()))).is_continue()
    {
        bodies.simulation.step();
        note_residual(&bodies.simulation, &mut residuals);
        made += 1;
        if is_displayed
            && shown.is_none_or(|shown| shown.elapsed() >= SNAPSHOT)
            && receipt.is_received()
            && let Some(bodies) = bodies.snapshot()
        {
            let snapshot = Snapshot { bodies, geometry: geometry.take(), residuals: residuals.clone() };
            let _ = report(SolveProgress::Snapshot(Box::new(snapshot), receipt.clone()));
            shown = Some(Instant::now());
        }
    }
    let mut quality = None;
    let has_ended = bodies.simulation.motion().is_none() && *bodies.simulation.status() != Status::Running;
    if is_displayed && has_ended && report(SolveProgress::Phase(Phase::Certifying)).is_continue() {
        quality = Some(Quality::certified(&mut bodies.simulation));
    }
    Ok(Box::new(Solved { snapshot: Snapshot { bodies, geometry, residuals }, quality }))
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    /// The snapshots of a hidden window, which receives none, do not pile up.
    #[test]
    fn a_snapshot_waits_until_the_one_before_has_been_received() {
        let scene = Scene::beam(20.0, 1.0).with_cells(600, 9).clamp("left").force("right", [0.0, -100.0]);
        let request = || SolveRequest {
            scene: scene.clone(),
            model: Model::New,
            start: SolveStart::Rest,
            iterations: None,
            residuals: Vec::new(),
            is_displayed: true,
        };
        let (held, received) = (RefCell::new(Vec::new()), RefCell::new(0));
        for holds in [true, false] {
            run(request(), &|progress| {
                if matches!(progress, SolveProgress::Snapshot(..)) {
                    *received.borrow_mut() += u32::from(!holds);
                    held.borrow_mut().extend(holds.then_some(progress));
                } else {
                    // The next snapshot is due after this time.
                    std::thread::sleep(SNAPSHOT);
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        }
        assert_eq!(held.borrow().len(), 1);
        assert!(*received.borrow() > 1);
    }
}
