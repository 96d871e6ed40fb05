//! The state of a scene, one [`Simulation::step`] a frame, and what is known of the result.

use std::cell::{OnceCell, RefCell};

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::System;
use crate::method::{
    Frame, FrameError, Goal, Method, Occasion, Profile, Thrift, Verdict, Workspace, fixed_point_rho, is_stable, timed,
};
use crate::rotation::Rotation;
use crate::scene::{Invalid, MethodKind, Scene};
use crate::solver::SolverError;

mod field;
mod solution;

pub use crate::method::{Reason, Status};
pub use field::Field;
pub use solution::{Energy, ProbeResult, Reaction, Solution};

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimulationError {
    /// The scene asks for something that is not there.
    #[error(transparent)]
    Scene(#[from] Invalid),
    /// The mesh is too large.
    #[error("beam.cells: {0}; expected fewer cells")]
    Solver(#[from] SolverError),
}

/// What is known of a result whatever method found it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Certificate {
    /// Whether the exact tangent is positive definite there; `None` for linear theory and before the end.
    pub stable: Option<bool>,
    /// ρ = |λ|max(A⁻¹G): the warped iteration converges here if it is below 1. `None` for linear theory, before the
    /// end, and where A cannot be factorized.
    pub fixed_point_rho: Option<f64>,
}

/// A scene in motion towards its equilibrium.
#[derive(Debug)]
pub struct Simulation {
    system: System,
    kind: MethodKind,
    method: Box<dyn Method>,
    goal: Goal,
    max_iterations: u32,
    /// Borrowed for a certificate too, which is asked of a state at rest.
    workspace: RefCell<Workspace>,
    /// Displacement x − X of every node, m.
    u: Vec<Vector2<f64>>,
    previous_u: Vec<Vector2<f64>>,
    /// No displacement.
    rest: Vec<Vector2<f64>>,
    r: Vec<Rotation>,
    external_force: Vec<Vector2<f64>>,
    internal_force: Vec<Vector2<f64>>,
    imbalance: Vec<Vector2<f64>>,
    magnitude: Vec<Vector2<f64>>,
    residual: f64,
    iterations: u32,
    status: Status,
    certificate: OnceCell<Certificate>,
    profile: Profile,
    last_frame: Profile,
}

fn goal(scene: &Scene) -> Goal {
    Goal { tolerance: scene.solver.tolerance, max_error: 0.01 * scene.solver.max_error_percent }
}

impl Simulation {
    /// The scene at rest.
    ///
    /// # Errors
    /// What is wrong with the scene, or that its mesh is too large.
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        Self::with_system(scene, System::new(scene)?)
    }

    /// The equations `system` at rest, solved as `scene` says.
    ///
    /// # Errors
    /// [`SimulationError::Solver`].
    pub fn with_system(scene: &Scene, system: System) -> Result<Self, SimulationError> {
        let workspace = Workspace::new(&system)?;
        let nodes = system.mesh.nodes.len();
        let points = system.elements.point_count();
        let zero = vec![Vector2::zeros(); nodes];
        let kind = scene.solver.method;
        let mut simulation = Self {
            kind,
            method: (kind.entry().start)(),
            goal: goal(scene),
            max_iterations: scene.solver.max_iterations,
            workspace: RefCell::new(workspace),
            u: zero.clone(),
            previous_u: zero.clone(),
            rest: zero.clone(),
            r: vec![Rotation::IDENTITY; points],
            external_force: zero.clone(),
            internal_force: zero.clone(),
            imbalance: zero.clone(),
            magnitude: zero,
            residual: 0.0,
            iterations: 0,
            status: Status::Running,
            certificate: OnceCell::new(),
            profile: Profile::default(),
            last_frame: Profile::default(),
            system,
        };
        simulation.begin(Occasion::Reset);
        Ok(simulation)
    }

    /// Back to rest, with nothing iterated.
    pub fn reset(&mut self) {
        self.u.fill(Vector2::zeros());
        self.r.fill(Rotation::IDENTITY);
        self.begin(Occasion::Reset);
    }

    /// Starts over from this displacement, m; what supports hold does not move.
    pub fn start_from(&mut self, u: &[Vector2<f64>]) {
        self.reset();
        let mut free = vec![0.0; self.system.dofs()];
        self.system.restrict(u, &mut free);
        self.system.add_free(&free, &mut self.u);
        self.begin(Occasion::Reset);
    }

    /// Takes another scene on. Where only numbers change the state is kept, so that a dragged load is followed from
    /// where the body is. After a divergence, and for another mesh or method, it starts at rest.
    ///
    /// # Errors
    /// As [`Self::new`]; the simulation is unchanged then.
    pub fn change_scene(&mut self, scene: &Scene) -> Result<(), SimulationError> {
        let mut system = System::new(scene)?;
        if system.pattern != self.system.pattern || system.mesh != self.system.mesh {
            *self = Self::with_system(scene, system)?;
            return Ok(());
        }
        std::mem::swap(&mut self.system, &mut system);
        self.goal = goal(scene);
        self.max_iterations = scene.solver.max_iterations;
        if matches!(self.status, Status::Diverged(_)) || scene.solver.method != self.kind {
            self.kind = scene.solver.method;
            self.method = (self.kind.entry().start)();
            self.reset();
        } else {
            let stiffness = |system: &System| (system.lame, system.material.thickness);
            let same = stiffness(&system) == stiffness(&self.system);
            self.begin(if same { Occasion::NewLoads } else { Occasion::NewStiffness });
        }
        Ok(())
    }

    /// Forgets iterations and times, and measures the state it starts from.
    fn begin(&mut self, occasion: Occasion) {
        self.iterations = 0;
        self.status = Status::Running;
        self.certificate = OnceCell::new();
        self.method.begin(occasion);
        self.profile = Profile::default();
        self.last_frame = Profile::default();
        let mut unmeasured = Profile::default();
        self.measure(&mut unmeasured);
        let verdict = self.with_method(&mut unmeasured, |method, frame| method.judge(frame));
        self.follow(verdict, &mut unmeasured);
    }

    /// One frame: assemble, factorize, solve, and the rotations and residual of the new state. Does nothing once the
    /// status is no longer [`Status::Running`].
    pub fn step(&mut self) -> &Status {
        if self.status != Status::Running {
            return &self.status;
        }
        let mut profile = Profile::default();
        self.previous_u.copy_from_slice(&self.u);
        let solved = self.with_method(&mut profile, |method, frame| method.solve(frame));
        self.iterations += 1;
        let measured = solved.and_then(|()| {
            self.measure(&mut profile);
            if self.residual.is_finite() { Ok(()) } else { Err(FrameError::NotFinite) }
        });
        if measured.is_err() {
            self.u.copy_from_slice(&self.previous_u);
            self.measure(&mut profile);
        }
        let verdict = self.with_method(&mut profile, |method, frame| match measured {
            Ok(()) => method.judge(frame),
            Err(error) => method.recover(frame, error),
        });
        self.follow(verdict, &mut profile);
        self.profile.add(&profile);
        self.last_frame = profile;
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
    fn with_method<T>(&mut self, profile: &mut Profile, work: impl FnOnce(&mut dyn Method, &mut Frame<'_>) -> T) -> T {
        let mut frame = Frame {
            system: &self.system,
            r: &self.r,
            imbalance: &self.imbalance,
            residual: self.residual,
            goal: self.goal,
            u: &mut self.u,
            workspace: self.workspace.get_mut(),
            profile,
        };
        work(self.method.as_mut(), &mut frame)
    }

    /// Does what the method's verdict asks for.
    fn follow(&mut self, verdict: Verdict, profile: &mut Profile) {
        match verdict {
            Verdict::Continue => {}
            Verdict::Changed => self.measure(profile),
            Verdict::Converged => self.status = Status::Converged,
            Verdict::Stop(reason) => self.status = reason.status(),
        }
        if self.status == Status::Running && self.iterations >= self.max_iterations {
            self.status = Reason::IterationLimit(self.max_iterations).status();
            self.method.stop(&mut self.u);
            // What is missing to the whole load.
            self.measure_at(1.0, profile);
        }
    }

    /// Rotations, forces and residual of the current state under the load that is on the body at present.
    fn measure(&mut self, profile: &mut Profile) {
        self.measure_at(self.method.load_factor(), profile);
    }

    fn measure_at(&mut self, load_factor: f64, profile: &mut Profile) {
        timed(&mut profile.rotate, || self.method.rotate(&self.system, &self.u, &mut self.r));
        timed(&mut profile.assemble, || {
            self.system.internal_force(&self.u, &self.r, &mut self.internal_force, &mut self.magnitude);
            // Linear theory knows the loads at rest only.
            let seen = if self.method.corotates() { &self.u } else { &self.rest };
            self.system.external_force(seen, load_factor, &mut self.external_force);
            let forces = self.external_force.iter().zip(&self.internal_force);
            for (imbalance, (external, internal)) in self.imbalance.iter_mut().zip(forces) {
                *imbalance = external - internal;
            }
            self.residual = self.relative_residual();
        });
    }

    /// ‖f_ext − f_int‖ / ‖Σ|fₑ|‖ over the free unknowns. Where the elements carry nothing yet, relative to the load.
    fn relative_residual(&self) -> f64 {
        let norm = |nodal: &[Vector2<f64>]| {
            let free = self.system.pattern.free.iter().map(|&k| nodal[k as usize / 2][k as usize % 2]);
            // Scaled, so that squares of very large or small forces stay in range.
            let largest = free.clone().fold(0.0_f64, |m, v| m.max(v.abs()));
            if largest == 0.0 { 0.0 } else { largest * free.map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
        };
        let imbalance = norm(&self.imbalance);
        if imbalance == 0.0 {
            return 0.0;
        }
        imbalance / norm(&self.magnitude).max(norm(&self.external_force))
    }

    /// The equations of the scene.
    #[must_use]
    pub fn system(&self) -> &System {
        &self.system
    }

    /// The method that steps.
    #[must_use]
    pub fn method(&self) -> MethodKind {
        self.kind
    }

    /// What is known of the final state: found when it is first asked for, at the price of some solves, and remembered.
    #[must_use]
    pub fn certificate(&self) -> Certificate {
        if self.status == Status::Running || !self.method.corotates() {
            return Certificate::default();
        }
        *self.certificate.get_or_init(|| {
            let (workspace, load_factor) = (&mut *self.workspace.borrow_mut(), self.method.load_factor());
            Certificate {
                fixed_point_rho: fixed_point_rho(&self.system, &self.u, &self.r, load_factor, workspace),
                stable: Some(is_stable(&self.system, &self.u, &self.r, load_factor, workspace)),
            }
        })
    }

    /// Share of the load that is on the body, and load steps taken so far.
    #[must_use]
    pub fn load_stepping(&self) -> (f64, u32) {
        (self.method.load_factor(), self.method.load_steps())
    }

    /// Whether the state is seen corotated; if not, it is linear theory's.
    #[must_use]
    pub fn corotates(&self) -> bool {
        self.method.corotates()
    }

    /// What was left out because the scene does not need it; `None` for methods that do not decide.
    #[must_use]
    pub fn thrift(&self) -> Option<Thrift> {
        self.method.thrift()
    }

    /// Displacement x − X of every node, m.
    #[must_use]
    pub fn displacement(&self) -> &[Vector2<f64>] {
        &self.u
    }

    /// Rotation at every quadrature point.
    #[must_use]
    pub fn rotations(&self) -> &[Rotation] {
        &self.r
    }

    /// Where it stands.
    #[must_use]
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// Solves so far.
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

    /// Time of the last frame, by stage.
    #[must_use]
    pub fn last_frame(&self) -> &Profile {
        &self.last_frame
    }

    /// Time of all frames since the last change, by stage.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }
}
