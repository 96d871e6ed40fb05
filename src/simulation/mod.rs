//! A scene at work, one [`Simulation::step`] an iteration on the way to its equilibrium, or a step in time; and what is
//! known of the result.

use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use self::motion::start_of;
use self::search::Search;
use crate::assembly::{Change, Forces, Hand, Kinematics, Mass, Matrix, NodalProbe, Problem, System, SystemError};
use crate::dynamics::{Counts, Ledger, Momentum, MotionReport};
use crate::element::Tangent;
use crate::mesh::{MaterialPoint, Mesh};
use crate::method::{AutoReport, Certificate, Restart, is_useful_start};
use crate::scene::{Analysis, Invalid, Material, MethodKind, Scene};
use crate::solver::{Factor, SolverError};
use crate::state::{State, StateError, is_finite};
use crate::stress::{ErrorEstimate, NodalStress, RecoveryScratch};
use crate::timings::Timings;

mod field;
mod motion;
mod point;
mod results;
mod search;
mod status;

pub use self::motion::{Moment, Motion};
pub use field::Field;
pub use point::{PointState, PointValues};
pub use results::{
    Deformation, Energy, LargestStress, ProbeResult, ProbeStress, Reaction, StressResult, SupportReaction, energy,
    probe_results, reaction, support_reactions, supports_power,
};
pub use status::Status;

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// The scene gives no equations.
    #[error(transparent)]
    System(#[from] SystemError),
    /// Not enough memory.
    #[error(transparent)]
    Solver(#[from] SolverError),
}

impl From<Invalid> for SimulationError {
    fn from(invalid: Invalid) -> Self {
        Self::System(invalid.into())
    }
}

/// The numbers of a state, together.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// Free unknowns.
    pub dofs: usize,
    /// How the iteration ended.
    pub status: Status,
    /// Solves taken.
    pub iterations: u32,
    /// Load steps taken.
    pub load_steps: u32,
    /// ‖f_ext − f_int‖ / ‖Σ|fₑ|‖.
    pub residual: f64,
    /// See [`Simulation::residual_floor`].
    pub residual_floor: Option<f64>,
    /// Stability, and ρ, if [`Simulation::certify`] has been asked.
    pub certificate: Option<Certificate>,
    /// How far the body is deformed.
    pub deformation: Deformation,
    /// The probes.
    pub probes: Vec<ProbeResult>,
    /// Energies.
    pub energy: Energy,
    /// Support reactions, all together.
    pub reaction: Reaction,
    /// The reaction of each.
    pub supports: Vec<SupportReaction>,
    /// Time since the last edit, by stage.
    pub time: Timings,
    /// What `auto` skipped; `None` for other methods.
    pub auto: Option<AutoReport>,
    /// What there is beside of a body in motion.
    pub motion: Option<MotionResult>,
}

/// The numbers of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionResult {
    /// Time since the start, s.
    pub time: f64,
    /// Steps and solves.
    pub counts: Counts,
    /// Where the energy has gone.
    pub ledger: Ledger,
    /// Momentum, linear and angular.
    pub momentum: Momentum,
    /// The longest stable step, s, of an integrator that has one.
    pub critical_step: Option<f64>,
    /// What `auto` decided; `None` for other methods.
    pub auto: Option<MotionReport>,
}

/// A scene at work: on its way to equilibrium, or in motion.
///
/// ```
/// use warpbeam::{Scene, Simulation, Status};
///
/// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]).probe("tip", "right");
/// let mut beam = Simulation::new(&scene)?;
/// assert_eq!(*beam.solve(), Status::Converged);
/// beam.set_force(0, [0.0, -1000.0])?; // the next solve goes on from here
/// assert_eq!(*beam.solve(), Status::Converged);
/// # Ok::<(), warpbeam::SimulationError>(())
/// ```
#[derive(Debug)]
pub struct Simulation {
    body: Body,
    process: Process,
    status: Status,
}

/// A scene, its equations, and where the body is.
#[derive(Clone, Debug)]
struct Body {
    scene: Scene,
    problem: Problem,
    state: State,
}

impl Body {
    /// Whether a solve that starts where the body is has a chance.
    fn is_useful_start(&self, same_unknowns: bool) -> bool {
        let system = self.problem.system();
        let holds = || same_unknowns || system.pattern().are_fixed_at_rest(&self.state.displacement);
        is_useful_start(system, &self.state) && holds()
    }
}

/// What a step does.
#[derive(Debug)]
enum Process {
    /// An iteration.
    Search(Box<Search>),
    /// A time step.
    Motion(Box<Motion>),
}

impl Process {
    fn new(body: &mut Body) -> Result<Self, SimulationError> {
        Ok(match body.scene.analysis {
            Analysis::Static => Self::Search(Box::new(Search::new(body)?)),
            Analysis::Dynamic => Self::Motion(Box::new(Motion::new(body)?)),
        })
    }
}

/// Frequency of a body's mass on the spring of a hand, Hz: firm, and still a spring.
const HAND_FREQUENCY: f64 = 5.0;
/// Damping ratio of that vibration.
const HAND_DAMPING: f64 = 0.7;
/// Stiffness of a hand's spring over that of the body where it is held: the body follows the pointer.
const HAND_FIRMNESS: f64 = 10.0;

impl Simulation {
    /// The scene at its start.
    ///
    /// # Errors
    /// What is wrong with the scene, or that its mesh is too large.
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        Self::with_system(scene, Arc::new(System::new(scene)?))
    }

    /// The scene on a mesh of the caller's, which it keeps through every edit. The scene's own `[beam]` or `[mesh]`, if
    /// it has one, is not read.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_mesh(scene: &Scene, mesh: Mesh) -> Result<Self, SimulationError> {
        Self::with_system(scene, Arc::new(System::with_mesh(scene, mesh)?))
    }

    /// The scene at its start on equations made before: shared as they are where they are the scene's, adapted where
    /// they are not.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_system(scene: &Scene, system: Arc<System>) -> Result<Self, SimulationError> {
        Self::with_problem(scene.clone(), Problem::new(scene, system)?)
    }

    fn with_problem(scene: Scene, problem: Problem) -> Result<Self, SimulationError> {
        let state = start_of(&scene, &problem);
        let mut body = Body { scene, problem, state };
        let process = Process::new(&mut body)?;
        let mut simulation = Self { body, process, status: Status::Running };
        simulation.judge();
        Ok(simulation)
    }

    fn judge(&mut self) {
        self.status = match &self.process {
            Process::Search(search) => search.status().clone(),
            Process::Motion(motion) => motion.status(&self.body.scene, &self.body.state),
        };
    }

    /// Back to the start of the scene: at rest, or with the velocity that it gives the body.
    pub fn reset(&mut self) {
        match &mut self.process {
            Process::Search(search) => {
                self.body.state.reset();
                search.restart(&mut self.body, Restart::AtRest);
            }
            Process::Motion(motion) => motion.reset(&mut self.body),
        }
        self.judge();
    }

    /// Starts over from this displacement, m, one vector a node of the mesh, at rest; what supports fix is where they
    /// take it.
    ///
    /// # Errors
    /// [`StateError`] where there are not as many vectors as nodes, or one is not finite. Nothing is changed then.
    pub fn start_from(&mut self, u: &[Vector2<f64>]) -> Result<(), StateError> {
        let system = self.body.problem.system();
        let mut state = system.at_rest().with_displacement(u.to_vec())?;
        self.body.problem.supports().put(system.mesh(), 1.0, Kinematics::Corotated, &mut state.displacement);
        self.body.state = state;
        self.begin();
        Ok(())
    }

    /// Starts over from a state of this body: a clone of an earlier [`Self::state`].
    ///
    /// # Errors
    /// [`StateError`] where it is another body's state. Nothing is changed then.
    pub fn restore(&mut self, state: &State) -> Result<(), StateError> {
        self.body.state.accept(state)?;
        self.body.state.copy_from(state);
        self.begin();
        Ok(())
    }

    /// The motion as it stands, to go back to; `None` of a search.
    #[must_use]
    pub fn moment(&self) -> Option<Moment> {
        self.motion().map(|motion| Moment::of(motion, &self.body))
    }

    /// Stores the motion as it stands in an earlier moment of the same body, without allocating. Nothing of a search.
    pub fn copy_moment(&self, moment: &mut Moment) {
        if let Process::Motion(motion) = &self.process {
            moment.copy_from(motion, &self.body);
        }
    }

    /// Goes back to a moment of this motion. Steps from there are those after [`Self::restore`]; energies and counts are
    /// those of the moment. A search restores the state alone.
    ///
    /// # Errors
    /// [`StateError`] where it is another body's moment. Nothing is changed then.
    pub fn return_to(&mut self, moment: &Moment) -> Result<(), StateError> {
        self.body.state.accept(moment.state())?;
        match &mut self.process {
            Process::Search(_) => return self.restore(moment.state()),
            Process::Motion(motion) => motion.return_to(&mut self.body, moment),
        }
        self.judge();
        Ok(())
    }

    /// Forgets what was, and goes on from where the body is.
    fn begin(&mut self) {
        match &mut self.process {
            Process::Search(search) => search.restart(&mut self.body, Restart::AtRest),
            Process::Motion(motion) => motion.begin(&mut self.body),
        }
        self.judge();
    }

    /// Takes another scene on, at the price of what has changed. The state is kept where the mesh is: an edited load is
    /// followed from where the body is, and in mid-motion it keeps its velocity. A search starts at rest after a
    /// divergence, for another method, and where the state is of no use as a start (not finite, absurdly far away,
    /// crushed); either does where a new support holds what has moved away. Another `analysis` goes on from where the
    /// body is, without velocity.
    ///
    /// # Errors
    /// As [`Self::new`]; the simulation is unchanged then.
    pub fn change_scene(&mut self, scene: &Scene) -> Result<(), SimulationError> {
        if scene.analysis == Analysis::Dynamic {
            scene.solver.method.entry().in_motion()?;
        }
        let Self { body, process, .. } = self;
        let change = body.problem.update(scene)?;
        if change == Change::Mesh {
            *self = Self::with_problem(scene.clone(), body.problem.clone())?;
            return Ok(());
        }
        let before = std::mem::replace(&mut body.scene, scene.clone());
        if scene.analysis != before.analysis {
            body.problem.set_time(0.0);
            let useful = body.is_useful_start(false);
            body.state.stop();
            if !useful {
                body.state = start_of(scene, &body.problem);
            }
            *process = Process::new(body)?;
        } else {
            match process {
                Process::Search(search) => search.edit(body, &before, change)?,
                Process::Motion(motion) => motion.edit(body, &before, change)?,
            }
        }
        self.judge();
        Ok(())
    }

    /// A copy of a search as it stands, for who looks on while the search goes on elsewhere. It has no memory for
    /// iterations: that is made where it goes on itself. `None` of a motion.
    #[must_use]
    pub fn snapshot(&self) -> Option<Self> {
        let process = Process::Search(Box::new(self.search()?.copy()));
        Some(Self { body: self.body.clone(), process, status: self.status.clone() })
    }

    /// Sets the components of a force, N; `load` counts the scene's loads from 0.
    ///
    /// # Errors
    /// Where there is no such force, or its size is out of range. Nothing is changed then.
    pub fn set_force(&mut self, load: usize, force: [f64; 2]) -> Result<(), SimulationError> {
        self.edit(|scene| scene.set_force(load, force))
    }

    /// Sets a moment, N m; `load` counts the scene's loads from 0.
    ///
    /// # Errors
    /// Where there is no such moment, or its size is out of range. Nothing is changed then.
    pub fn set_moment(&mut self, load: usize, moment: f64) -> Result<(), SimulationError> {
        self.edit(|scene| scene.set_moment(load, moment))
    }

    /// Sets the acceleration of a weight, m/s²; `load` counts the scene's loads from 0.
    ///
    /// # Errors
    /// Where there is no such gravity, or its size is out of range. Nothing is changed then.
    pub fn set_gravity(&mut self, load: usize, acceleration: [f64; 2]) -> Result<(), SimulationError> {
        self.edit(|scene| scene.set_gravity(load, acceleration))
    }

    /// Sets where a support takes its place, m, and how far it turns it about its middle, rad; `support` counts the
    /// scene's supports from 0.
    ///
    /// # Errors
    /// Where there is no such support, it does not fix what is to move, or a number is out of range. Nothing is changed
    /// then.
    pub fn move_support(&mut self, support: usize, displacement: [f64; 2], turn: f64) -> Result<(), SimulationError> {
        self.edit(|scene| scene.move_support(support, displacement, turn))
    }

    /// Sets the material.
    ///
    /// # Errors
    /// Where a number is out of range. Nothing is changed then.
    pub fn set_material(&mut self, material: Material) -> Result<(), SimulationError> {
        self.edit(|scene| {
            scene.material = material;
            Ok(())
        })
    }

    /// Takes on the scene that `change` makes of the present one.
    fn edit(&mut self, change: impl FnOnce(&mut Scene) -> Result<(), Invalid>) -> Result<(), SimulationError> {
        let mut scene = self.body.scene.clone();
        change(&mut scene)?;
        self.change_scene(&scene)
    }

    /// Takes hold of a material point with a damped spring, which holds it where it is until [`Self::pull_to`] says
    /// where to. Returns whether there is such a point.
    ///
    /// The spring makes the body's mass vibrate at 5 Hz, or is ten times as stiff as the body is there, whichever is
    /// stiffer; it pulls no harder than stretched by a quarter of the body's size.
    pub fn grab(&mut self, point: MaterialPoint) -> bool {
        let Body { scene, problem, state } = &mut self.body;
        let mass = Mass::new(problem.system(), scene.material.area_density()).total();
        let omega = std::f64::consts::TAU * HAND_FREQUENCY;
        let mut stiffness = mass * omega * omega;
        if let Some(compliance) = compliance(problem, state, point) {
            stiffness = stiffness.max(HAND_FIRMNESS / compliance);
        }
        let delay = 2.0 * HAND_DAMPING * (mass / stiffness).sqrt();
        let Some(mut hand) = Hand::new(problem.system(), point, stiffness, delay) else { return false };
        hand.lead(hand.position(&state.displacement), state.time, 0.0);
        *problem.hand_mut() = Some(hand);
        self.pulled(false);
        true
    }

    /// Pulls the point that is held to a position, m, within the next time step. Nothing happens where none is held.
    ///
    /// # Errors
    /// [`StateError::NotFinite`]; the pull is unchanged then.
    pub fn pull_to(&mut self, position: Vector2<f64>) -> Result<(), StateError> {
        if !is_finite(&[position]) {
            return Err(StateError::NotFinite { what: "position of the pointer" });
        }
        let within = match self.process {
            Process::Search(_) => 0.0,
            Process::Motion(_) => self.body.scene.dynamics.time_step,
        };
        let now = self.body.state.time;
        if let Some(hand) = self.body.problem.hand_mut() {
            hand.lead(position, now, within);
            self.pulled(true);
        }
        Ok(())
    }

    /// Lets go.
    pub fn release(&mut self) {
        if self.body.problem.hand_mut().take().is_some() {
            self.pulled(false);
        }
    }

    /// The hand that holds the body, and its force on the body, N.
    #[must_use]
    pub fn hand(&self) -> Option<(&Hand, Vector2<f64>)> {
        let State { displacement, velocity, .. } = &self.body.state;
        let hand = self.body.problem.hand()?;
        let force = match self.process {
            Process::Search(_) => hand.force_at_rest(displacement),
            Process::Motion(_) => hand.force(hand.mean(displacement), hand.mean(velocity)),
        };
        Some((hand, force))
    }

    fn pulled(&mut self, moved_only: bool) {
        match &mut self.process {
            Process::Search(search) => search.pulled(&mut self.body, moved_only),
            Process::Motion(motion) => motion.pulled(&self.body),
        }
        self.judge();
    }

    /// One iteration (assemble, factorize, solve, and the rotations and residual of the new state), or one time step. A
    /// search does nothing once its status is no longer [`Status::Running`]; a motion goes on until it is
    /// [`Status::Stopped`].
    pub fn step(&mut self) -> &Status {
        match &mut self.process {
            Process::Search(search) => search.step(&mut self.body),
            Process::Motion(motion) => motion.step(&mut self.body),
        }
        self.judge();
        &self.status
    }

    /// Whether another step would change nothing: a search has ended, or a motion has been given up or come to rest
    /// (nothing has moved for half a second by more than a millionth of the body's size a second, and no pulse is to
    /// come).
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        match &self.process {
            Process::Search(_) => self.status != Status::Running,
            Process::Motion(motion) => {
                matches!(self.status, Status::Stopped(_)) || motion.is_at_rest(&self.body.scene, &self.body.state)
            }
        }
    }

    /// Steps until the status is final: to the equilibrium, or to the end of the scene's duration.
    pub fn solve(&mut self) -> &Status {
        while self.status == Status::Running {
            self.step();
        }
        &self.status
    }

    /// Ends a search or a motion that has not come to its end, with the best state there is.
    pub fn stop(&mut self) {
        match &mut self.process {
            Process::Search(search) => search.stop(&mut self.body),
            Process::Motion(motion) => motion.stop(&self.body),
        }
        self.judge();
    }

    /// Finds out what is known of the final state whatever method found it, at the price of some solves; remembered
    /// until the next change. Nothing is known of linear theory's results, before the end, in motion, and while a hand
    /// pulls.
    pub fn certify(&mut self) -> Certificate {
        match &mut self.process {
            Process::Search(search) => search.certify(&self.body.problem, &self.body.state),
            Process::Motion(_) => Certificate::default(),
        }
    }

    /// What [`Self::certify`] has found, if it has been asked since the last change.
    #[must_use]
    pub fn certificate(&self) -> Option<Certificate> {
        self.search().and_then(Search::certificate)
    }

    /// The numbers of the current state.
    #[must_use]
    pub fn solution(&self) -> Solution {
        let Body { problem, state, .. } = &self.body;
        let (load_factor, load_steps) = self.load_stepping();
        let supports = self.support_reactions();
        Solution {
            dofs: problem.system().dofs(),
            status: self.status.clone(),
            iterations: self.iterations(),
            load_steps,
            residual: self.residual(),
            residual_floor: self.residual_floor(),
            certificate: self.certificate(),
            deformation: Deformation::of(problem, state),
            probes: probe_results(problem, state),
            energy: Energy {
                supports: match (problem.supports().move_the_body(), self.is_linear()) {
                    (false, _) => Some(0.0),
                    (true, true) => Some(0.5 * supports_power(problem, &supports)),
                    (true, false) => None,
                },
                ..energy(problem, state, load_factor)
            },
            reaction: reaction(problem, state, self.forces()),
            supports,
            time: *self.timings(),
            auto: self.auto_report(),
            motion: self.motion().map(|motion| MotionResult {
                time: state.time,
                counts: motion.counts(),
                ledger: *motion.ledger(),
                momentum: motion.momentum(&self.body),
                critical_step: motion.critical_step(),
                auto: motion.auto_report(&self.body.scene),
            }),
        }
    }

    /// Stress and strain at every node, recovered from the current state.
    #[must_use]
    pub fn nodal_stress(&self) -> NodalStress {
        NodalStress::of(&self.body.problem, &self.body.state, self.kinematics())
    }

    /// The estimate of the mesh's own error in the current state; see [`ErrorEstimate`].
    #[must_use]
    pub fn mesh_error(&self, nodal: &NodalStress) -> ErrorEstimate {
        ErrorEstimate::of(&self.body.problem, &self.body.state, nodal)
    }

    /// How the current state is seen.
    fn kinematics(&self) -> Kinematics {
        if self.is_linear() { Kinematics::Linear } else { Kinematics::Corotated }
    }

    /// A field's value at every quadrature point; see [`Field::values`].
    pub fn field(&self, field: Field, values: &mut Vec<Option<f64>>) {
        field.values(&self.body.problem, &self.body.state, self.kinematics(), values);
    }

    /// A field's values as people expect them, recovered at the nodes; of a field of elements, those of
    /// [`Self::field`]. `nodal` and `scratch` are room to work in, kept from state to state.
    pub fn smooth_field(
        &self,
        field: Field,
        (nodal, scratch): (&mut Option<NodalStress>, &mut RecoveryScratch),
        values: &mut Vec<Option<f64>>,
    ) {
        if field.is_of_elements() {
            return self.field(field, values);
        }
        let Body { problem, state, .. } = &self.body;
        let nodal = nodal.get_or_insert_with(|| NodalStress::empty(*problem.material()));
        nodal.follow(problem, state, self.kinematics(), scratch);
        field.nodal_values(nodal, values);
    }

    /// Stress where people look for it: the largest, that of the probes, and how far the mesh is to be trusted.
    #[must_use]
    pub fn stress_result(&self) -> StressResult {
        let nodal = self.nodal_stress();
        StressResult::of(&self.body.problem, &nodal, &self.mesh_error(&nodal))
    }

    /// Displacement of a probe, m, the mean over its edge; `None` where there is no such probe.
    #[must_use]
    pub fn probe(&self, name: &str) -> Option<Vector2<f64>> {
        self.nodal_probe(name).map(|probe| probe.mean(&self.body.state.displacement))
    }

    /// Velocity of a probe, m/s; `None` where there is no such probe.
    #[must_use]
    pub fn probe_velocity(&self, name: &str) -> Option<Vector2<f64>> {
        self.nodal_probe(name).map(|probe| probe.mean(&self.body.state.velocity))
    }

    fn nodal_probe(&self, name: &str) -> Option<&NodalProbe> {
        self.body.problem.probes().iter().find(|p| p.name == name)
    }

    /// The scene as it stands.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.body.scene
    }

    /// The equations of the scene, with their numbers.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.body.problem
    }

    /// The equations without their numbers: mesh, elements, sparsity.
    #[must_use]
    pub fn system(&self) -> &Arc<System> {
        self.body.problem.system()
    }

    /// The method that steps.
    #[must_use]
    pub fn method(&self) -> MethodKind {
        self.body.scene.solver.method
    }

    fn search(&self) -> Option<&Search> {
        match &self.process {
            Process::Search(search) => Some(search),
            Process::Motion(_) => None,
        }
    }

    /// What is known of the motion; `None` of a search for an equilibrium.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        match &self.process {
            Process::Search(_) => None,
            Process::Motion(motion) => Some(motion),
        }
    }

    /// Keeps the energy ledger of a motion, which costs two more sweeps over the elements a step, or not. It is kept
    /// unless told otherwise; taken up again it starts anew.
    pub fn keep_ledger(&mut self, keep: bool) {
        if let Process::Motion(motion) = &mut self.process {
            motion.keep_ledger(keep, &self.body);
        }
    }

    /// Where the body is; a clone can be given back to [`Self::restore`].
    #[must_use]
    pub fn state(&self) -> &State {
        &self.body.state
    }

    /// Displacement x − X of every node, m.
    #[must_use]
    pub fn displacement(&self) -> &[Vector2<f64>] {
        &self.body.state.displacement
    }

    /// Forces of the current state; of a motion, those of its last stage.
    #[must_use]
    pub fn forces(&self) -> &Forces {
        match &self.process {
            Process::Search(search) => search.forces(),
            Process::Motion(motion) => motion.forces(),
        }
    }

    /// Fraction of the load that is on the body, and load steps taken so far.
    #[must_use]
    pub fn load_stepping(&self) -> (f64, u32) {
        self.search().map_or((1.0, 1), Search::load_stepping)
    }

    /// What each support does to the body, in the scene's order.
    #[must_use]
    pub fn support_reactions(&self) -> Vec<SupportReaction> {
        let kinematics = if self.is_linear() { Kinematics::Linear } else { Kinematics::Corotated };
        support_reactions(&self.body.problem, &self.body.state, kinematics, self.forces())
    }

    /// Whether the state is linear theory's; if not, its elements are turned back before their strain is measured.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        match &self.process {
            Process::Search(search) => search.kinematics() == Kinematics::Linear,
            Process::Motion(motion) => motion.is_linear(),
        }
    }

    /// What was skipped because the scene does not need it; `None` for methods that do not decide.
    #[must_use]
    pub fn auto_report(&self) -> Option<AutoReport> {
        self.search().and_then(Search::auto_report)
    }

    /// Where it stands.
    #[must_use]
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// Solves since the last edit, or since the motion began.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        match &self.process {
            Process::Search(search) => search.iterations(),
            Process::Motion(motion) => u32::try_from(motion.counts().solves).unwrap_or(u32::MAX),
        }
    }

    /// ‖f_ext − f_int‖ / ‖Σ|fₑ|‖ of the current state; of a motion what the last stage has left unsolved, over the
    /// largest of its forces.
    #[must_use]
    pub fn residual(&self) -> f64 {
        match &self.process {
            Process::Search(search) => search.residual(),
            Process::Motion(motion) => motion.residual(),
        }
    }

    /// Where a solve has converged to working precision only: a bound of what rounding changes in [`Self::residual`],
    /// which is within it and above the tolerance. `None` where the tolerance is met, or nothing is.
    #[must_use]
    pub fn residual_floor(&self) -> Option<f64> {
        let floor = self.search().and_then(Search::residual_floor);
        floor.filter(|_| self.residual() > self.body.scene.solver.tolerance)
    }

    /// Length of the last step over that of the one before: below 1 the iteration contracts.
    #[must_use]
    pub fn step_ratio(&self) -> Option<f64> {
        self.search().and_then(Search::step_ratio)
    }

    /// Time of the last iteration or time step, by stage.
    #[must_use]
    pub fn last_iteration(&self) -> &Timings {
        match &self.process {
            Process::Search(search) => search.last_iteration(),
            Process::Motion(motion) => motion.last_step(),
        }
    }

    /// Time of all iterations since the last edit, or of all time steps, by stage.
    #[must_use]
    pub fn timings(&self) -> &Timings {
        match &self.process {
            Process::Search(search) => search.timings(),
            Process::Motion(motion) => motion.timings(),
        }
    }
}

/// The largest displacement that a unit force on a point makes of it, m/N; `None` for a body that is not held.
fn compliance(problem: &Problem, state: &State, point: MaterialPoint) -> Option<f64> {
    let system = problem.system();
    let weights = system.mesh().weights(point)?;
    let mut matrix = Matrix::new(system.pattern());
    let mut forces = Forces::new(state.displacement.len());
    problem.linearize(state, &mut forces, Some((Tangent::WARPED, &mut matrix)));
    let mut factor = Factor::new(system.symbolic()).ok()?;
    factor.factorize(matrix.values()).ok()?;
    let mut compliance = Matrix2::zeros();
    let (mut nodal, mut free) = (vec![Vector2::zeros(); state.displacement.len()], vec![0.0; system.dofs()]);
    for axis in 0..2 {
        nodal.fill(Vector2::zeros());
        weights.iter().for_each(|&(node, w)| nodal[node as usize][axis] += w);
        system.pattern().restrict(&nodal, &mut free);
        factor.solve_in_place(&mut free);
        nodal.fill(Vector2::zeros());
        system.pattern().add_free(&free, 1.0, &mut nodal);
        let moved: Vector2<f64> = weights.iter().map(|&(node, w)| nodal[node as usize] * w).sum();
        compliance.set_column(axis, &moved);
    }
    let largest = compliance.symmetric_eigenvalues().max();
    (largest.is_finite() && largest > 0.0).then_some(largest)
}
