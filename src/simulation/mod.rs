//! Simulation of a scene: each [`Simulation::step`] is one iteration towards the equilibrium, or one time step; and
//! results of the current state.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};

use self::motion::{TimeStepping, start_of};
use self::search::Search;
use crate::assembly::{Change, Forces, Kinematics, LinearSystem, Mass, MouseSpring, NodalProbe, Problem, System};
use crate::dynamics::StopReason;
use crate::element::Tangent;
use crate::mesh::{MaterialPoint, Mesh};
use crate::method::{AutoReport, Certificate, Restart, is_useful_start};
use crate::rotation::{Rotation, polar};
use crate::scene::{Analysis, Invalid, Scene};
use crate::section::Wrench;
use crate::state::{State, StateError, is_finite};
use crate::stress::NodalStress;
use crate::timings::Timings;

mod field;
mod motion;
mod point;
mod results;
mod search;
mod section;
mod status;
mod view;

pub use self::motion::Moment;
pub use self::view::{Equilibrium, Motion};
pub use crate::assembly::SimulationError;
pub use field::Field;
pub use point::{PointState, PointValues};
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
pub(crate) use results::ProbeStress;
use results::area_change;
pub use results::{Deformation, Energy, ProbeResult, StressResult, SupportReaction, probe_results, support_reactions};
pub use status::Status;

/// Results of a state; [`Motion`] has further results of a motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// Number of free unknowns.
    pub dofs: usize,
    /// Status of the iteration.
    pub status: Status,
    /// Number of solves.
    pub iterations: u32,
    /// Number of load steps.
    pub load_steps: u32,
    /// Fraction of loads and prescribed displacements that the state belongs to: below 1 if the search ended on the
    /// way.
    pub load_factor: f64,
    /// Relative residual ‖f_ext − f_int‖ / ‖Σ|fₑ|‖.
    pub residual: f64,
    /// Bound of the residual's rounding error; see [`Equilibrium::residual_floor`].
    pub residual_floor: Option<f64>,
    /// Stability and ρ, if [`Simulation::certify`] has been called.
    pub certificate: Option<Certificate>,
    /// Largest rotation and strain.
    pub deformation: Deformation,
    /// Results at the probes.
    pub probes: Vec<ProbeResult>,
    /// Energies.
    pub energy: Energy,
    /// Total reaction of all supports, with the moment about the origin: of forces at rest positions in linear theory, else
    /// at current ones.
    pub reaction: Wrench,
    /// Reaction of each support.
    pub supports: Vec<SupportReaction>,
    /// Decisions of `auto`; `None` for other methods.
    pub auto: Option<AutoReport>,
}

/// Simulation of a scene: search for an equilibrium, or motion.
///
/// ```
/// use warpbeam::{Scene, Simulation, Status};
///
/// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]).probe("tip", "right");
/// let mut beam = Simulation::new(&scene)?;
/// assert_eq!(*beam.solve(), Status::Converged);
/// let force = beam.scene().load_on("right").ok_or("no load")?;
/// beam.edit(|scene| scene.set_force(force, [0.0, -1000.0]))?; // the next solve continues from here
/// assert_eq!(*beam.solve(), Status::Converged);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulation {
    body: Body,
    process: Process,
}

/// Scene with its equations, current state, status and computing times.
#[derive(Clone, Debug)]
struct Body {
    scene: Scene,
    problem: Problem,
    state: State,
    status: Status,
    timings: Timings,
    last_iteration: Timings,
}

impl Body {
    /// Returns `true` if a solve may start from the current state.
    fn is_useful_start(&self, same_unknowns: bool) -> bool {
        let system = self.problem.system();
        is_useful_start(system, &self.state)
            && (same_unknowns || system.pattern().are_fixed_at_rest(&self.state.displacement))
    }
}

/// Kind of simulation.
#[derive(Debug)]
enum Process {
    /// Search for an equilibrium; a step is an iteration.
    Search(Box<Search>),
    /// Motion; a step is a time step.
    Motion(Box<TimeStepping>),
}

impl Process {
    fn new(body: &mut Body) -> Result<Self, SimulationError> {
        Ok(match body.scene.analysis {
            Analysis::Static => Self::Search(Box::new(Search::new(body)?)),
            Analysis::Dynamic => Self::Motion(Box::new(TimeStepping::new(body)?)),
        })
    }
}

/// Frequency of the body's mass on the mouse spring, Hz; high enough to feel firm.
const SPRING_FREQUENCY: f64 = 5.0;
/// Damping ratio of this vibration.
const SPRING_DAMPING: f64 = 0.7;
/// Stiffness of the mouse spring relative to that of the body at the grabbed point, so that the body follows the
/// pointer.
const SPRING_FIRMNESS: f64 = 10.0;

impl Simulation {
    /// Returns a simulation in the initial state of the scene.
    ///
    /// # Errors
    /// [`SimulationError`] if the scene is invalid or its mesh too large.
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        Self::with_system(scene, Arc::new(System::new(scene)?))
    }

    /// Returns a simulation of the scene on a given mesh, which is kept through every edit. The scene's own `[beam]` or
    /// `[mesh]`, if any, is not read.
    ///
    /// # Errors
    /// Same errors as [`Self::new`].
    pub fn with_mesh(scene: &Scene, mesh: Mesh) -> Result<Self, SimulationError> {
        Self::with_system(scene, Arc::new(System::with_mesh(scene, mesh)?))
    }

    /// Returns a simulation in the initial state of the scene on an existing system, which is shared if it fits the
    /// scene, and adapted otherwise.
    ///
    /// # Errors
    /// Same errors as [`Self::new`].
    #[doc(hidden)]
    pub fn with_system(scene: &Scene, system: Arc<System>) -> Result<Self, SimulationError> {
        Self::with_problem(scene.clone(), Problem::new(scene, system)?)
    }

    fn with_problem(scene: Scene, problem: Problem) -> Result<Self, SimulationError> {
        let state = start_of(&scene, &problem);
        let (status, timings) = (Status::Running, Timings::default());
        let mut body = Body { scene, problem, state, status, timings, last_iteration: timings };
        let process = Process::new(&mut body)?;
        Ok(Self { body, process })
    }

    /// Returns to the initial state of the scene: at rest, or with its initial velocity.
    pub fn reset(&mut self) {
        self.body.state = start_of(&self.body.scene, &self.body.problem);
        self.begin();
    }

    /// Restarts from this displacement, m, one vector per node, with zero velocity; fixed components are set to the
    /// supports' displacements.
    ///
    /// # Errors
    /// [`StateError`] if the number of vectors differs from the number of nodes, or one is not finite. Nothing is
    /// changed then.
    pub fn start_from(&mut self, u: &[Vector2<f64>]) -> Result<(), StateError> {
        let system = self.body.problem.system();
        let mut state = system.at_rest().with_displacement(u.to_vec())?;
        self.body.problem.supports().put(system.mesh(), 1.0, Kinematics::Corotated, &mut state.displacement);
        self.body.state = state;
        self.begin();
        Ok(())
    }

    /// Restarts from a state of this body: a clone of an earlier [`Self::state`].
    ///
    /// ```
    /// use warpbeam::{Scene, Simulation, State, StateError};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]);
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.solve();
    /// let solved: State = beam.state().clone();
    /// beam.reset();
    /// beam.restore(&solved)?;
    /// assert_eq!(beam.displacement(), solved.displacement());
    /// let mut finer = Simulation::new(&scene.with_cells(40, 4))?;
    /// assert!(matches!(finer.restore(&solved), Err(StateError::Length { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`StateError`] if it is a state of another body. Nothing is changed then.
    pub fn restore(&mut self, state: &State) -> Result<(), StateError> {
        self.body.state.accept(state)?;
        self.body.state.copy_from(state);
        self.begin();
        Ok(())
    }

    /// Returns to an earlier moment of this motion. Steps from there are the same as after [`Self::restore`]; energies
    /// and counts are those of the moment. For a search, only the state is restored.
    ///
    /// # Errors
    /// [`StateError`] if it is a moment of another body. Nothing is changed then.
    pub fn return_to(&mut self, moment: &Moment) -> Result<(), StateError> {
        self.body.state.accept(moment.state())?;
        match &mut self.process {
            Process::Search(_) => return self.restore(moment.state()),
            Process::Motion(motion) => motion.return_to(&mut self.body, moment),
        }
        Ok(())
    }

    /// Restarts search or motion from the current state.
    fn begin(&mut self) {
        match &mut self.process {
            Process::Search(search) => search.restart(&mut self.body, Restart::AtRest),
            Process::Motion(motion) => motion.begin(&mut self.body),
        }
    }

    /// Changes the scene, recomputing only what has changed. The state is kept if the mesh is unchanged: a search
    /// follows an edited load from the current state, and a motion keeps its velocity. A search restarts at rest after
    /// a divergence, for another method, and if the state is not a useful start (not finite, too far away, crushed);
    /// both restart if a new support fixes nodes that have moved. After a change of `analysis` the current displacement
    /// is kept without velocity.
    ///
    /// # Errors
    /// Same errors as [`Self::new`]; the simulation is then unchanged.
    pub fn change_scene(&mut self, scene: &Scene) -> Result<(), SimulationError> {
        let Self { body, process } = self;
        let change = body.problem.update(&body.scene, scene)?;
        if change == Change::Mesh {
            *self = Self::with_problem(scene.clone(), body.problem.clone())?;
            return Ok(());
        }
        let before = std::mem::replace(&mut body.scene, scene.clone());
        if body.scene.analysis != before.analysis {
            body.problem.set_time(0.0);
            let useful = body.is_useful_start(false);
            body.state.stop();
            if !useful {
                body.state = start_of(&body.scene, &body.problem);
            }
            *process = Process::new(body)?;
        } else {
            match process {
                Process::Search(search) => search.edit(body, &before, change)?,
                Process::Motion(motion) => motion.edit(body, &before, change)?,
            }
        }
        Ok(())
    }

    /// Applies a change to the scene, such as [`Scene::set_force`] or [`Scene::move_support`], as [`Self::change_scene`]
    /// does.
    ///
    /// # Errors
    /// The error of `change`, or an error of [`Self::change_scene`], for example for a number out of range. The simulation
    /// is then unchanged.
    pub fn edit(&mut self, change: impl FnOnce(&mut Scene) -> Result<(), Invalid>) -> Result<(), SimulationError> {
        let mut scene = self.body.scene.clone();
        change(&mut scene)?;
        self.change_scene(&scene)
    }

    /// Attaches a mouse spring to a material point; its target is the current position until [`Self::pull_to`] is
    /// called. Returns `true` if there is such a point.
    ///
    /// ```
    /// use warpbeam::{MaterialPoint, MouseSpring, Scene, Simulation};
    ///
    /// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left"))?;
    /// let tip: MaterialPoint = beam.mesh().locate([9.9, 0.0].into()).ok_or("no such point")?;
    /// beam.grab(tip);
    /// beam.pull_to([9.0, 3.0])?;
    /// beam.solve();
    /// let (spring, force): (&MouseSpring, _) = beam.mouse_spring().ok_or("nothing is grabbed")?;
    /// assert!((spring.position(beam.displacement()) - spring.target()).norm() < 0.1 && force.norm() > 0.0);
    /// beam.release();
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// The stiffness of the spring is the larger of two values: the one at which the body's mass on the spring vibrates
    /// at 5 Hz, and ten times the body's stiffness at the point. Its force is capped at an elongation of a quarter of the
    /// body's size, in a motion also at 0.4 E times thickness times the size of the element, so that no throw inverts it.
    pub fn grab(&mut self, point: MaterialPoint) -> bool {
        let Body { scene, problem, state, .. } = &mut self.body;
        let mass = Mass::new(problem.system(), scene.material.area_density()).total;
        let axial = scene.material.young * scene.material.thickness;
        let most = match scene.analysis {
            Analysis::Static => f64::INFINITY,
            Analysis::Dynamic => MouseSpring::strength(problem.system(), point, axial),
        };
        let omega = std::f64::consts::TAU * SPRING_FREQUENCY;
        let mut stiffness = mass * omega * omega;
        if let Some(compliance) = compliance(problem, state, point) {
            stiffness = stiffness.max(SPRING_FIRMNESS / compliance);
        }
        let delay = 2.0 * SPRING_DAMPING * (mass / stiffness).sqrt();
        let Some(mut spring) = MouseSpring::new(problem.system(), point, stiffness, delay, most) else { return false };
        spring.lead(spring.position(&state.displacement), state.time, 0.0);
        problem.mouse_spring = Some(spring);
        self.pulled(false);
        true
    }

    /// Moves the target of the mouse spring to a position, m, within the next time step. Does nothing without a mouse
    /// spring.
    ///
    /// # Errors
    /// [`StateError::NotFinite`]; the target is then unchanged.
    pub fn pull_to(&mut self, position: impl Into<Vector2<f64>>) -> Result<(), StateError> {
        let position = position.into();
        if !is_finite(&[position]) {
            return Err(StateError::NotFinite { what: "position of the pointer" });
        }
        let Body { scene, problem, state, .. } = &mut self.body;
        let within = if scene.analysis == Analysis::Dynamic { scene.dynamics.time_step } else { 0.0 };
        if let Some(spring) = &mut problem.mouse_spring {
            spring.lead(position, state.time, within);
            self.pulled(true);
        }
        Ok(())
    }

    /// Removes the mouse spring. Does nothing without one.
    pub fn release(&mut self) {
        if self.body.problem.mouse_spring.take().is_some() {
            self.pulled(false);
        }
    }

    /// Returns the mouse spring and its force on the body, N.
    pub fn mouse_spring(&self) -> Option<(&MouseSpring, Vector2<f64>)> {
        let State { displacement, velocity, .. } = &self.body.state;
        let spring = self.body.problem.mouse_spring()?;
        let force = match self.process {
            Process::Search(_) => spring.force_at_rest(displacement),
            Process::Motion(_) => spring.force(spring.mean(displacement), spring.mean(velocity)),
        };
        Some((spring, force))
    }

    fn pulled(&mut self, moved_only: bool) {
        match &mut self.process {
            Process::Search(search) => search.pulled(&mut self.body, moved_only),
            Process::Motion(motion) => motion.pulled(&self.body),
        }
    }

    /// Performs one iteration (factorize, solve, advance, linearize the new state), or one time step. A search does
    /// nothing once its status is no longer [`Status::Running`]; a motion goes on until it is [`Status::Stopped`].
    pub fn step(&mut self) -> &Status {
        match &mut self.process {
            Process::Search(search) => search.step(&mut self.body),
            Process::Motion(motion) => motion.step(&mut self.body),
        }
        &self.body.status
    }

    /// Returns `true` if another step would change nothing: the search has ended, or the motion has stopped or come to
    /// rest (for half a second no node has moved faster than a millionth of the body's size per second, and no pulse is
    /// to come).
    pub fn is_at_rest(&self) -> bool {
        match &self.process {
            Process::Search(_) => self.body.status != Status::Running,
            Process::Motion(motion) => matches!(self.body.status, Status::Stopped(_)) || motion.is_at_rest(&self.body),
        }
    }

    /// Steps until the status is final: to the equilibrium, or to the end of the scene's duration.
    pub fn solve(&mut self) -> &Status {
        let _ = self.solve_watched(&mut |_| ControlFlow::Continue(()));
        &self.body.status
    }

    /// Steps as [`Self::solve`], calls `watch` before each step, and ends early if it breaks.
    pub(crate) fn solve_watched(&mut self, watch: &mut dyn FnMut(&Self) -> ControlFlow<()>) -> ControlFlow<()> {
        while self.body.status == Status::Running {
            watch(self)?;
            self.step();
        }
        ControlFlow::Continue(())
    }

    /// Interrupts a search or a motion, leaving the best available state.
    pub fn stop(&mut self) {
        match &mut self.process {
            _ if self.body.status != Status::Running => {}
            Process::Search(search) => search.stop(&mut self.body),
            Process::Motion(_) => self.body.status = Status::Stopped(StopReason::Interrupted),
        }
    }

    /// Computes properties of the final state that do not depend on the method, at the cost of some solves; the result
    /// is kept until the next change. All properties are `None` for linear theory, while the search is running, for
    /// motions, and with a mouse spring.
    ///
    /// ```
    /// use warpbeam::{Certificate, Scene, Simulation};
    ///
    /// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]))?;
    /// beam.solve();
    /// let Certificate { stable, fixed_point_rho } = beam.certify();
    /// // The load α = P L²/EI = 0.6 is small, so that the iteration `warped` converges: ρ < 1.
    /// assert!(stable == Some(true) && fixed_point_rho.is_some_and(|rho| rho < 1.0));
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    pub fn certify(&mut self) -> Certificate {
        match &mut self.process {
            Process::Search(search) => search.certify(&mut self.body),
            Process::Motion(_) => Certificate::default(),
        }
    }

    /// Returns the rotation R of every element, or the mean of those at its quadrature points. In linear theory all are
    /// the identity.
    pub(crate) fn element_rotations(&self) -> Vec<Rotation> {
        let per_element =
            (self.system().elements().rotation_count() / self.system().mesh().element_count().max(1)).max(1);
        let mean = |own: &[Rotation]| {
            let (c, s) = own.iter().fold((0.0, 0.0), |(c, s), r| (c + r.c, s + r.s));
            polar(&Matrix2::new(c, -s, s, c)).unwrap_or(Rotation::IDENTITY)
        };
        self.state().rotations().chunks(per_element).map(mean).collect()
    }

    /// Returns the change of the body's area relative to its area at rest, ∫ det F dA / ∫ dA − 1.
    pub fn area_change(&self) -> f64 {
        area_change(&self.body.problem, &self.body.state)
    }

    /// Returns the results of the current state.
    ///
    /// ```
    /// use warpbeam::{Deformation, Energy, ProbeResult, Scene, Simulation, Solution, SupportReaction, Wrench};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).probe("tip", "right");
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.solve();
    /// let Solution { reaction, supports, energy, probes, deformation, .. } = beam.solution();
    /// // The only support balances 1 N at a distance of 10 m.
    /// let Wrench { force, moment } = reaction;
    /// assert!((force.y - 1.0).abs() < 1e-6 && (moment - 10.0).abs() < 1e-3);
    /// let SupportReaction { force, .. } = supports[0];
    /// assert!((force.y - 1.0).abs() < 1e-6);
    /// // While displacements are small, the elastic energy is half of the work of the constant load, 1 N · |u_y|.
    /// let ProbeResult { u, .. } = probes[0];
    /// let Energy { elastic, external, .. } = energy;
    /// assert!((external + u.y).abs() < 1e-9 && (elastic / external - 0.5).abs() < 1e-3);
    /// // The tip rotates by P L²/(2 E I) = 6e-4 rad.
    /// let Deformation { max_rotation_deg, inverted_elements, .. } = deformation;
    /// assert!((max_rotation_deg.to_radians() - 6e-4).abs() < 3e-5 && inverted_elements == 0);
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    pub fn solution(&self) -> Solution {
        let Body { problem, state, .. } = &self.body;
        let search = self.equilibrium();
        let load_factor = search.map_or(1.0, Equilibrium::load_factor);
        let (elastic, external) = (problem.elastic_energy(state), -problem.loads().potential(state, load_factor));
        let supports = self.support_reactions();
        let mut reaction = Wrench::default();
        for (support, own) in problem.supports().all().iter().zip(&supports) {
            reaction.add(if self.is_linear() { support.middle } else { own.middle }, own.force);
            reaction.moment += own.moment;
        }
        Solution {
            dofs: problem.system().dofs(),
            status: self.body.status.clone(),
            iterations: self.iterations(),
            load_steps: search.map_or(1, Equilibrium::load_steps),
            load_factor,
            residual: self.residual(),
            residual_floor: search.and_then(Equilibrium::residual_floor),
            certificate: search.and_then(Equilibrium::certificate),
            deformation: Deformation::of(problem, state, &self.nodal_stress()),
            probes: probe_results(problem, state),
            energy: Energy {
                elastic,
                external,
                supports: match (problem.supports().move_the_body(), self.is_linear()) {
                    (false, _) => Some(0.0),
                    // Loads that grow with the displacement do half of their final work.
                    (true, true) => Some(elastic - 0.5 * external),
                    (true, false) => None,
                },
            },
            reaction,
            supports,
            auto: search.and_then(Equilibrium::auto_report),
        }
    }

    /// Recovers stress and strain at every node from the current state.
    ///
    /// ```
    /// use warpbeam::{NodalStress, Scene, Simulation};
    ///
    /// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]))?;
    /// beam.solve();
    /// let stress: NodalStress = beam.nodal_stress();
    /// let (node, pascals) = stress.largest_von_mises().ok_or("the state is not finite")?;
    /// // The largest moment, 10 N m, is at the support. Beam theory: M (h/2)/I = 60 Pa.
    /// assert!(beam.mesh().nodes()[node as usize].x == 0.0 && (pascals - 60.0).abs() < 6.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn nodal_stress(&self) -> NodalStress {
        NodalStress::of(&self.body.problem, &self.body.state, self.kinematics())
    }

    /// Returns the strain measure of the current state.
    pub(crate) fn kinematics(&self) -> Kinematics {
        match &self.process {
            Process::Search(search) => search.kinematics(),
            Process::Motion(motion) => motion.kinematics(),
        }
    }

    /// Replaces `values` by the field at every quadrature point, in [`Field::unit`]: element by element in the mesh's
    /// order, one point per `t3`, three per `t6`, four per `q4`. `None` if a value is not finite, and for the Cauchy
    /// stress in an inverted element. [`Field::MeshError`] has the element's value at each of its points.
    pub fn field(&self, field: Field, values: &mut Vec<Option<f64>>) {
        field.values(&self.body.problem, &self.body.state, self.kinematics(), values);
    }

    /// Returns the stress results: the largest stress, those at the probes, and the estimated mesh error.
    #[doc(hidden)]
    pub fn stress_result(&self) -> StressResult {
        StressResult::of(&self.body.problem, &self.body.state, &self.nodal_stress())
    }

    /// Returns the displacement of a probe, m, the mean over its edge; `None` if there is no such probe.
    pub fn probe(&self, name: &str) -> Option<Vector2<f64>> {
        self.nodal_probe(name).map(|probe| probe.mean(&self.body.state.displacement))
    }

    /// Returns the velocity of a probe, m/s; `None` if there is no such probe.
    pub fn probe_velocity(&self, name: &str) -> Option<Vector2<f64>> {
        self.nodal_probe(name).map(|probe| probe.mean(&self.body.state.velocity))
    }

    fn nodal_probe(&self, name: &str) -> Option<&NodalProbe> {
        self.body.problem.probes().iter().find(|p| p.name == name)
    }

    /// Returns the current scene.
    pub fn scene(&self) -> &Scene {
        &self.body.scene
    }

    /// Returns the equations of the scene with numerical values.
    #[doc(hidden)]
    pub fn problem(&self) -> &Problem {
        &self.body.problem
    }

    /// Returns the parts of the equations that do not depend on the state and the material: mesh, elements, sparsity.
    #[doc(hidden)]
    pub fn system(&self) -> &Arc<System> {
        self.body.problem.system()
    }

    /// Returns the results of the search; `None` for a motion.
    pub fn equilibrium(&self) -> Option<Equilibrium<'_>> {
        match &self.process {
            Process::Search(search) => Some(Equilibrium { search, body: &self.body }),
            Process::Motion(_) => None,
        }
    }

    /// Returns the results of the motion; `None` for a search for an equilibrium.
    pub fn motion(&self) -> Option<Motion<'_>> {
        match &self.process {
            Process::Search(_) => None,
            Process::Motion(steps) => Some(Motion { steps, body: &self.body }),
        }
    }

    /// Switches the energy ledger of a motion on or off; it costs two additional loops over the elements per step. It
    /// is on by default, and starts again from zero when switched on. Does nothing if the scene is static.
    pub fn keep_ledger(&mut self, keep: bool) {
        if let Process::Motion(motion) = &mut self.process {
            motion.keep_ledger(keep, &self.body);
        }
    }

    /// Returns the current state; a clone can be passed to [`Self::restore`].
    pub fn state(&self) -> &State {
        &self.body.state
    }

    /// Returns the displacement x − X of every node, m.
    pub fn displacement(&self) -> &[Vector2<f64>] {
        &self.body.state.displacement
    }

    /// Returns the current position x of every node, m.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vector2<f64>> + '_ {
        self.mesh().nodes().iter().zip(self.displacement()).map(|(x, u)| x + u)
    }

    /// Returns `true` if the body passes through itself in the current state: contact is not modelled. Takes a sweep over
    /// the outline.
    pub fn passes_through_itself(&self) -> bool {
        let positions: Vec<Vector2<f64>> = self.positions().collect();
        self.mesh().passes_through_itself(&self.mesh().outline(), &positions)
    }

    /// Returns the mesh: nodes at rest, elements and named edges.
    pub fn mesh(&self) -> &Mesh {
        self.system().mesh()
    }

    /// Returns the forces of the current state; for a motion, those of its last stage.
    #[doc(hidden)]
    pub fn forces(&self) -> &Forces {
        match &self.process {
            Process::Search(search) => &search.forces,
            Process::Motion(motion) => &motion.memory.forces,
        }
    }

    /// Returns the reaction of each support, in the scene's order.
    pub fn support_reactions(&self) -> Vec<SupportReaction> {
        support_reactions(&self.body.problem, &self.body.state, self.kinematics(), self.forces())
    }

    /// Returns `true` if the state is one of linear theory; otherwise strains are measured in the rotated frames of the
    /// elements.
    pub fn is_linear(&self) -> bool {
        self.kinematics() == Kinematics::Linear
    }

    /// Returns the status of the simulation.
    pub fn status(&self) -> &Status {
        &self.body.status
    }

    /// Returns the number of solves since the last edit, or since the start of the motion.
    pub fn iterations(&self) -> u32 {
        match &self.process {
            Process::Search(search) => search.iterations,
            Process::Motion(motion) => u32::try_from(motion.counts.solves).unwrap_or(u32::MAX),
        }
    }

    /// Returns ‖f_ext − f_int‖ / ‖Σ|fₑ|‖ of the current state; for a motion, the residual of the last stage relative to
    /// the largest of its forces.
    pub fn residual(&self) -> f64 {
        match &self.process {
            Process::Search(search) => search.residual(),
            Process::Motion(motion) => motion.memory.residual,
        }
    }

    /// Returns the computing time of the last iteration or time step, by stage.
    pub fn last_iteration(&self) -> &Timings {
        &self.body.last_iteration
    }

    /// Returns the computing time of all iterations since the last edit, or of all time steps, by stage.
    ///
    /// ```
    /// use warpbeam::{Scene, Simulation, Timings};
    ///
    /// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]))?;
    /// beam.solve();
    /// let timings: &Timings = beam.timings();
    /// assert!(timings.total() >= timings.linearize + timings.factorize);
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    pub fn timings(&self) -> &Timings {
        &self.body.timings
    }
}

/// Returns the largest displacement of a point under a unit force on it, m/N; `None` if supports leave the body free to
/// move.
fn compliance(problem: &Problem, state: &State, point: MaterialPoint) -> Option<f64> {
    let (system, mut untimed) = (problem.system(), Timings::default());
    let weights = system.mesh().weights(point)?;
    let mut linear = LinearSystem::new(system).ok()?;
    let mut forces = Forces::new(state.displacement.len());
    problem.linearize(state, &mut forces, Some((Tangent::WARPED, &mut linear.matrix)));
    linear.factorize(&mut untimed).ok()?;
    let (mut compliance, mut nodal) = (Matrix2::zeros(), vec![Vector2::zeros(); state.displacement.len()]);
    for axis in 0..2 {
        nodal.fill(Vector2::zeros());
        weights.iter().for_each(|&(node, w)| nodal[node as usize][axis] += w);
        linear.solve(system.pattern(), &nodal, &mut untimed).ok()?;
        nodal.fill(Vector2::zeros());
        system.pattern().add_free(&linear.correction, 1.0, &mut nodal);
        let moved: Vector2<f64> = weights.iter().map(|&(node, w)| nodal[node as usize] * w).sum();
        compliance.set_column(axis, &moved);
    }
    let largest = compliance.symmetric_eigenvalues().max();
    (largest.is_finite() && largest > 0.0).then_some(largest)
}
