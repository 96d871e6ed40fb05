//! The state of a scene, one [`Simulation::step`] a frame, and what is known of the result.

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::System;
use crate::method::{Frame, FrameError, Profile, Workspace, timed};
use crate::rotation::Rotation;
use crate::scene::{Invalid, MethodKind, Scene};
use crate::solver::SolverError;

mod convergence;
mod field;
mod solution;

pub use convergence::{Reason, Status};
pub use field::Field;
pub use solution::{Energy, ProbeResult, Reaction, Solution};

use convergence::Watch;

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

/// A scene in motion towards its equilibrium.
#[derive(Debug)]
pub struct Simulation {
    system: System,
    method: MethodKind,
    tolerance: f64,
    max_iterations: u32,
    workspace: Workspace,
    /// Displacement x − X of every node, m.
    u: Vec<Vector2<f64>>,
    previous_u: Vec<Vector2<f64>>,
    r: Vec<Rotation>,
    internal_force: Vec<Vector2<f64>>,
    imbalance: Vec<Vector2<f64>>,
    magnitude: Vec<Vector2<f64>>,
    residual: f64,
    iterations: u32,
    status: Status,
    watch: Watch,
    profile: Profile,
    last_frame: Profile,
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
        let (low, high) = system.mesh.bounds();
        let mut simulation = Self {
            method: scene.solver.method,
            tolerance: scene.solver.tolerance,
            max_iterations: scene.solver.max_iterations,
            workspace,
            u: zero.clone(),
            previous_u: zero.clone(),
            r: vec![Rotation::IDENTITY; points],
            internal_force: zero.clone(),
            imbalance: zero.clone(),
            magnitude: zero,
            residual: 0.0,
            iterations: 0,
            status: Status::Running,
            watch: Watch::new((high - low).norm()),
            profile: Profile::default(),
            last_frame: Profile::default(),
            system,
        };
        simulation.begin();
        Ok(simulation)
    }

    /// Back to rest, with nothing iterated.
    pub fn reset(&mut self) {
        self.u.fill(Vector2::zeros());
        self.r.fill(Rotation::IDENTITY);
        self.begin();
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
        self.tolerance = scene.solver.tolerance;
        self.max_iterations = scene.solver.max_iterations;
        if matches!(self.status, Status::Diverged(_)) || scene.solver.method != self.method {
            self.method = scene.solver.method;
            self.reset();
        } else {
            self.begin();
        }
        Ok(())
    }

    /// Forgets iterations and times, and measures the state it starts from.
    fn begin(&mut self) {
        self.iterations = 0;
        self.status = Status::Running;
        self.watch.restart();
        self.profile = Profile::default();
        self.last_frame = Profile::default();
        let mut unmeasured = Profile::default();
        self.measure(&mut unmeasured);
        self.judge();
    }

    /// One frame: assemble, factorize, solve, and the rotations and residual of the new state. Does nothing once the
    /// status is no longer [`Status::Running`].
    pub fn step(&mut self) -> &Status {
        if self.status != Status::Running {
            return &self.status;
        }
        let mut profile = Profile::default();
        self.previous_u.copy_from_slice(&self.u);
        let mut frame = Frame {
            system: &self.system,
            r: &self.r,
            imbalance: &self.imbalance,
            u: &mut self.u,
            workspace: &mut self.workspace,
            profile: &mut profile,
        };
        let solved = self.method.method().solve(&mut frame);
        self.iterations += 1;
        match solved {
            Ok(()) => {
                self.measure(&mut profile);
                if self.residual.is_finite() {
                    self.judge();
                } else {
                    self.abandon(&mut profile, Reason::Frame(FrameError::NotFinite));
                }
            }
            Err(error) => self.abandon(&mut profile, Reason::Frame(error)),
        }
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

    /// Rotations, forces and residual of the current state.
    fn measure(&mut self, profile: &mut Profile) {
        timed(&mut profile.rotate, || self.method.method().rotate(&self.system, &self.u, &mut self.r));
        timed(&mut profile.assemble, || {
            self.system.internal_force(&self.u, &self.r, &mut self.internal_force, &mut self.magnitude);
            let forces = self.system.external_force.iter().zip(&self.internal_force);
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
        imbalance / norm(&self.magnitude).max(norm(&self.system.external_force))
    }

    fn judge(&mut self) {
        if self.residual <= self.tolerance {
            self.status = Status::Converged;
            return;
        }
        let step = self.u.iter().zip(&self.previous_u).map(|(a, b)| (a - b).norm_squared()).sum::<f64>().sqrt();
        let farthest = self.u.iter().map(|u| u.norm()).fold(0.0, f64::max);
        if let Some(reason) = self.watch.observe(self.residual, step, farthest) {
            self.status = reason.status();
        } else if self.iterations >= self.max_iterations {
            self.status = Status::NotConverged(Reason::IterationLimit(self.max_iterations));
        }
    }

    /// Ends with the last finite state.
    fn abandon(&mut self, profile: &mut Profile, reason: Reason) {
        self.u.copy_from_slice(&self.previous_u);
        self.measure(profile);
        self.status = reason.status();
    }

    /// The equations of the scene.
    #[must_use]
    pub fn system(&self) -> &System {
        &self.system
    }

    /// The method that steps.
    #[must_use]
    pub fn method(&self) -> MethodKind {
        self.method
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
        self.watch.step_ratio()
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
