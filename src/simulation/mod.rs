//! A scene in search of its equilibrium, one [`Simulation::step`] an iteration, and what is known of the result.

use std::sync::Arc;

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::{Change, Forces, Kinematics, Problem, System, SystemError};
use crate::element::Tangent;
use crate::mesh::Mesh;
use crate::method::{
    AutoReport, Certificate, Iteration, IterationError, Method, Restart, Timings, Tolerances, Verdict, Workspace,
    fixed_point_rho, is_stable, is_useful_start, measure, timed,
};
use crate::scene::{Invalid, Material, MethodKind, Scene, SolverSettings};
use crate::solver::SolverError;
use crate::state::{State, StateError};

mod field;
mod results;

pub use crate::method::{Reason, Status};
pub use field::Field;
pub use results::{Deformation, Energy, ProbeResult, Reaction, energy, probe_results, reaction};

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
    /// Stability, and ρ, if [`Simulation::certify`] has been asked.
    pub certificate: Option<Certificate>,
    /// How far the body is deformed.
    pub deformation: Deformation,
    /// The probes.
    pub probes: Vec<ProbeResult>,
    /// Energies.
    pub energy: Energy,
    /// Support reactions.
    pub reaction: Reaction,
    /// Time since the last edit, by stage.
    pub time: Timings,
    /// What `auto` skipped; `None` for other methods.
    pub auto: Option<AutoReport>,
}

/// A scene on its way to equilibrium.
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
    scene: Scene,
    problem: Problem,
    method: Box<dyn Method>,
    state: State,
    /// Displacement and turns before the present iteration.
    previous: (Vec<Vector2<f64>>, Vec<f64>),
    forces: Forces,
    workspace: Workspace,
    residual: f64,
    iterations: u32,
    status: Status,
    certificate: Option<Certificate>,
    timings: Timings,
    last_iteration: Timings,
}

fn tolerances(settings: &SolverSettings) -> Tolerances {
    Tolerances { residual: settings.tolerance, error: 0.01 * settings.max_error_percent }
}

impl Simulation {
    /// The scene at rest.
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

    /// The scene at rest on equations made before: shared as they are where they are the scene's, adapted where they
    /// are not.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_system(scene: &Scene, system: Arc<System>) -> Result<Self, SimulationError> {
        Self::with_problem(scene.clone(), Problem::new(scene, system)?)
    }

    fn with_problem(scene: Scene, problem: Problem) -> Result<Self, SimulationError> {
        let workspace = Workspace::new(problem.system())?;
        let state = problem.system().at_rest();
        let mut simulation = Self {
            method: (scene.solver.method.entry().start)(),
            scene,
            previous: (state.displacement.clone(), state.turns.clone()),
            forces: Forces::new(state.displacement.len()),
            state,
            workspace,
            residual: 0.0,
            iterations: 0,
            status: Status::Running,
            certificate: None,
            timings: Timings::default(),
            last_iteration: Timings::default(),
            problem,
        };
        simulation.restart(Restart::AtRest);
        Ok(simulation)
    }

    /// Back to rest, with nothing iterated.
    pub fn reset(&mut self) {
        self.state.reset();
        self.restart(Restart::AtRest);
    }

    /// Starts over from this displacement, m, one vector a node of the mesh; what supports fix does not move.
    ///
    /// # Errors
    /// [`StateError`] where there are not as many vectors as nodes, or one is not finite. Nothing is changed then.
    pub fn start_from(&mut self, u: &[Vector2<f64>]) -> Result<(), StateError> {
        let mut state = self.problem.system().at_rest().with_displacement(u.to_vec())?;
        let mask = self.problem.system().pattern().mask();
        state.displacement.iter_mut().zip(mask).for_each(|(u, mask)| u.component_mul_assign(mask));
        self.state = state;
        self.restart(Restart::AtRest);
        Ok(())
    }

    /// Starts over from a state of this body: a clone of an earlier [`Self::state`].
    ///
    /// # Errors
    /// [`StateError`] where it is another body's state. Nothing is changed then.
    pub fn restore(&mut self, state: &State) -> Result<(), StateError> {
        self.state.accept(state)?;
        self.state.copy_from(state);
        self.restart(Restart::AtRest);
        Ok(())
    }

    /// Takes another scene on, at the price of what has changed. The state is kept where the mesh is, so that an edited
    /// load is followed from where the body is; after a divergence, for another method, and where the state is of no
    /// use as a start (not finite, absurdly far away, crushed, away from a new support) the body starts at rest.
    ///
    /// # Errors
    /// As [`Self::new`]; the simulation is unchanged then.
    pub fn change_scene(&mut self, scene: &Scene) -> Result<(), SimulationError> {
        let moments = |problem: &Problem| problem.loads().moments().next().is_some();
        let had_moments = moments(&self.problem);
        let change = self.problem.update(scene)?;
        let why = match change {
            Change::Mesh => {
                *self = Self::with_problem(scene.clone(), self.problem.clone())?;
                return Ok(());
            }
            Change::Unknowns => {
                self.workspace = Workspace::new(self.problem.system())?;
                Restart::NewUnknowns
            }
            Change::Stiffness => Restart::NewStiffness,
            Change::Loads => Restart::NewLoads,
        };
        if had_moments || moments(&self.problem) {
            // The exact tangent has the moments in it.
            self.workspace.tangent = None;
        }
        let same_method = scene.solver.method == self.scene.solver.method;
        let keeps_state = same_method
            && !matches!(self.status, Status::Diverged(_))
            && is_useful_start(self.problem.system(), &self.state)
            && self.problem.system().pattern().are_fixed_at_rest(&self.state.displacement);
        self.scene.clone_from(scene);
        if !same_method {
            self.method = (scene.solver.method.entry().start)();
        }
        self.method.restart(why);
        if keeps_state {
            self.restart(why);
        } else {
            self.reset();
        }
        Ok(())
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
        let mut scene = self.scene.clone();
        change(&mut scene)?;
        self.change_scene(&scene)
    }

    /// Forgets iterations and times, and measures the state it starts from.
    fn restart(&mut self, why: Restart) {
        self.iterations = 0;
        self.status = Status::Running;
        self.certificate = None;
        self.timings = Timings::default();
        self.last_iteration = Timings::default();
        let mut unmeasured = Timings::default();
        if why == Restart::NewLoads {
            // Forces within the body are what they were.
            self.residual = self.problem.balance(
                &self.state,
                self.method.kinematics(),
                self.method.load_factor(),
                &mut self.forces,
            );
        } else {
            if why == Restart::AtRest {
                self.method.restart(why);
                self.follow_displacement(&mut unmeasured);
            }
            self.measure_forces(self.method.tangent(), self.method.load_factor(), &mut unmeasured);
        }
        let verdict = self.with_method(&mut unmeasured, |method, it| method.judge(it));
        self.follow(verdict, &mut unmeasured);
    }

    /// One iteration: assemble, factorize, solve, and the rotations and residual of the new state. Does nothing once the
    /// status is no longer [`Status::Running`].
    pub fn step(&mut self) -> &Status {
        if self.status != Status::Running {
            return &self.status;
        }
        let mut timings = Timings::default();
        let State { displacement, turns, .. } = &self.state;
        self.previous.0.copy_from_slice(displacement);
        self.previous.1.copy_from_slice(turns);
        let iterated = self.with_method(&mut timings, |method, it| method.iterate(it));
        self.iterations += 1;
        let measured = iterated.and_then(|()| {
            self.measure(&mut timings);
            if self.residual.is_finite() { Ok(()) } else { Err(IterationError::NotFinite) }
        });
        if measured.is_err() {
            self.state.displacement.copy_from_slice(&self.previous.0);
            self.state.turns.copy_from_slice(&self.previous.1);
            self.measure(&mut timings);
        }
        let verdict = self.with_method(&mut timings, |method, it| match measured {
            Ok(()) => method.judge(it),
            Err(error) => method.recover(it, error),
        });
        self.follow(verdict, &mut timings);
        self.timings.add(&timings);
        self.last_iteration = timings;
        &self.status
    }

    /// Steps until the status is final.
    pub fn solve(&mut self) -> &Status {
        while self.status == Status::Running {
            self.step();
        }
        &self.status
    }

    /// Lets the method work on the current state.
    fn with_method<T>(
        &mut self,
        timings: &mut Timings,
        work: impl FnOnce(&mut dyn Method, &mut Iteration<'_>) -> T,
    ) -> T {
        let mut iteration = Iteration {
            problem: &self.problem,
            forces: &mut self.forces,
            residual: self.residual,
            tolerances: tolerances(&self.scene.solver),
            state: &mut self.state,
            workspace: &mut self.workspace,
            timings,
        };
        work(self.method.as_mut(), &mut iteration)
    }

    /// Does what the method's verdict asks for.
    fn follow(&mut self, verdict: Verdict, timings: &mut Timings) {
        match verdict {
            Verdict::Continue => {}
            Verdict::Changed => self.measure(timings),
            Verdict::Converged => self.status = Status::Converged,
            Verdict::Stop(reason) => self.status = reason.status(),
        }
        let most = self.scene.solver.max_iterations;
        if self.status == Status::Running && self.iterations >= most {
            self.status = Reason::IterationLimit(most).status();
            self.method.stop(&mut self.state);
            // What is missing to the whole load.
            self.follow_displacement(timings);
            self.measure_forces(None, 1.0, timings);
        }
    }

    /// Rotations, forces and residual of the current state under the load that is on the body at present, and the
    /// tangent that the next iteration needs.
    fn measure(&mut self, timings: &mut Timings) {
        self.follow_displacement(timings);
        self.measure_forces(self.method.tangent(), self.method.load_factor(), timings);
    }

    fn follow_displacement(&mut self, timings: &mut Timings) {
        let (system, kinematics) = (self.problem.system(), self.method.kinematics());
        timed(&mut timings.rotate, || system.follow(&mut self.state, kinematics));
    }

    fn measure_forces(&mut self, tangent: Option<Tangent>, load_factor: f64, timings: &mut Timings) {
        self.residual = measure(
            &self.problem,
            &self.state,
            self.method.kinematics(),
            (tangent, load_factor),
            &mut self.forces,
            &mut self.workspace,
            timings,
        );
    }

    /// Finds out what is known of the final state whatever method found it, at the price of some solves; remembered
    /// until the next change. Nothing is known of linear theory's results, and before the end.
    pub fn certify(&mut self) -> Certificate {
        if let Some(certificate) = self.certificate {
            return certificate;
        }
        if self.status == Status::Running || self.is_linear() {
            return Certificate::default();
        }
        let Self { problem, state, forces, workspace, method, .. } = self;
        let load_factor = method.load_factor();
        let certificate = Certificate {
            fixed_point_rho: fixed_point_rho(problem, state, load_factor, forces, workspace),
            stable: Some(is_stable(problem, state, load_factor, forces, workspace)),
        };
        *self.certificate.insert(certificate)
    }

    /// What [`Self::certify`] has found, if it has been asked since the last change.
    #[must_use]
    pub fn certificate(&self) -> Option<Certificate> {
        self.certificate
    }

    /// The numbers of the current state.
    #[must_use]
    pub fn solution(&self) -> Solution {
        let Self { problem, state, .. } = self;
        Solution {
            dofs: problem.system().dofs(),
            status: self.status.clone(),
            iterations: self.iterations,
            load_steps: self.method.load_steps(),
            residual: self.residual,
            certificate: self.certificate,
            deformation: Deformation::of(problem, state),
            probes: probe_results(problem, state),
            energy: energy(problem, state, self.method.load_factor()),
            reaction: reaction(problem, state, &self.forces),
            time: self.timings,
            auto: self.method.report(),
        }
    }

    /// A field's value at every quadrature point; see [`Field::values`].
    pub fn field(&self, field: Field, values: &mut Vec<Option<f64>>) {
        field.values(&self.problem, &self.state, values);
    }

    /// Displacement of a probe, m, the mean over its edge; `None` where there is no such probe.
    #[must_use]
    pub fn probe(&self, name: &str) -> Option<Vector2<f64>> {
        let probe = self.problem.probes().iter().find(|p| p.name == name)?;
        Some(probe.mean(&self.state.displacement))
    }

    /// The scene as it stands.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The equations of the scene, with their numbers.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The equations without their numbers: mesh, elements, sparsity.
    #[must_use]
    pub fn system(&self) -> &Arc<System> {
        self.problem.system()
    }

    /// The method that steps.
    #[must_use]
    pub fn method(&self) -> MethodKind {
        self.scene.solver.method
    }

    /// Where the body is; a clone can be given back to [`Self::restore`].
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Displacement x − X of every node, m.
    #[must_use]
    pub fn displacement(&self) -> &[Vector2<f64>] {
        &self.state.displacement
    }

    /// Forces of the current state.
    #[must_use]
    pub fn forces(&self) -> &Forces {
        &self.forces
    }

    /// Fraction of the load that is on the body, and load steps taken so far.
    #[must_use]
    pub fn load_stepping(&self) -> (f64, u32) {
        (self.method.load_factor(), self.method.load_steps())
    }

    /// Whether the state is linear theory's; if not, its elements are turned back before their strain is measured.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.method.kinematics() == Kinematics::Linear
    }

    /// What was skipped because the scene does not need it; `None` for methods that do not decide.
    #[must_use]
    pub fn auto_report(&self) -> Option<AutoReport> {
        self.method.report()
    }

    /// Where it stands.
    #[must_use]
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// Solves since the last edit.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    /// ‖f_ext − f_int‖ / ‖Σ|fₑ|‖ of the current state.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// Length of the last step over that of the one before: below 1 the iteration contracts.
    #[must_use]
    pub fn step_ratio(&self) -> Option<f64> {
        self.method.step_ratio()
    }

    /// Time of the last iteration, by stage.
    #[must_use]
    pub fn last_iteration(&self) -> &Timings {
        &self.last_iteration
    }

    /// Time of all iterations since the last edit, by stage.
    #[must_use]
    pub fn timings(&self) -> &Timings {
        &self.timings
    }
}
