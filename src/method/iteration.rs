//! Data of an iteration, and the step shared by all methods.

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::{Forces, Kinematics, Matrix, Problem, System};
use crate::element::Tangent;
use crate::sentence::{Sentence, sentence};
use crate::solver::{Factor, SolverError};
use crate::state::State;
use crate::timings::{Timings, timed};

/// Reason why an iteration produced no new state.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum IterationError {
    /// The factorization failed.
    Solver(#[from] SolverError),
    /// The solution is not finite.
    NotFinite,
}

impl From<&IterationError> for Sentence {
    fn from(error: &IterationError) -> Self {
        match error {
            IterationError::Solver(error) => error.into(),
            IterationError::NotFinite => sentence!("the solution is not a finite number: reduce the load"),
        }
    }
}

/// Work memory of an iteration, allocated once per system.
#[derive(Debug)]
pub struct Workspace {
    /// A matrix over the free unknowns.
    pub(crate) matrix: Matrix,
    /// Kind of tangent in `matrix`, if it is one of the current state at the current load.
    pub(crate) tangent: Option<Tangent>,
    /// Factor of the last factorized matrix.
    pub(crate) factor: Factor,
    /// Vector over the free unknowns.
    pub(crate) free: Vec<f64>,
    /// Nodal vector.
    pub(crate) nodal: Vec<Vector2<f64>>,
    /// State for trial steps.
    pub(crate) trial: State,
}

impl Workspace {
    /// Allocates the memory.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(system: &System) -> Result<Self, SolverError> {
        Ok(Self {
            matrix: Matrix::new(system.pattern()),
            tangent: None,
            factor: Factor::new(system.symbolic()?)?,
            free: vec![0.0; system.dofs()],
            nodal: vec![Vector2::zeros(); system.mesh().nodes().len()],
            trial: system.at_rest(),
        })
    }
}

/// Convergence criteria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Relative residual, for methods that iterate to an equilibrium.
    pub residual: f64,
    /// Error relative to the displacement, for `auto`.
    pub error: f64,
}

/// Residual that counts as small: if one below it stops falling, it is near convergence, not diverging, and may be
/// rounding error.
pub(super) const ROUNDING: f64 = 1e-6;
/// Largest bound of the rounding error with which a solve may end; larger bounds are not meaningful.
const LOOSEST_FLOOR: f64 = 1e-5;

/// Data that a method may use and change in one iteration.
#[derive(Debug)]
pub struct Iteration<'a> {
    /// Problem to solve.
    pub problem: &'a Problem,
    /// Forces of the current state at the current load.
    pub forces: &'a mut Forces,
    /// Relative residual.
    pub residual: f64,
    /// Convergence criteria.
    pub tolerances: Tolerances,
    /// State, with the rotations of its displacement; methods replace the displacement.
    pub state: &'a mut State,
    /// Work memory.
    pub workspace: &'a mut Workspace,
    /// Measured times.
    pub timings: &'a mut Timings,
    /// Number of linear solves before the limit of iterations is reached, at least 1.
    pub solves_left: u32,
}

impl Iteration<'_> {
    /// Returns the system of the problem.
    pub(super) fn system(&self) -> &System {
        self.problem.system()
    }

    /// Ensures that the workspace's matrix is this tangent of the current state at this load factor, including the
    /// loads' part.
    pub(super) fn assemble(&mut self, tangent: Tangent, load_factor: f64) {
        if self.workspace.tangent == Some(tangent) {
            return;
        }
        let Self { problem, forces, state, workspace, timings, .. } = self;
        timed(&mut timings.assemble, || {
            assemble(problem, state, forces, workspace, tangent, load_factor);
        });
    }

    /// Returns the bound of the residual's rounding error if the residual is small and within it, and the bound is
    /// small enough to be meaningful.
    pub(super) fn floor(&mut self) -> Option<f64> {
        if self.residual > ROUNDING {
            return None;
        }
        let Self { problem, forces, state, workspace, residual, .. } = self;
        let floor = timed(&mut self.timings.assemble, || problem.residual_floor(state, forces, &mut workspace.nodal));
        floor.filter(|floor| *residual <= *floor && *floor <= LOOSEST_FLOOR)
    }

    /// Returns `true` if the supports are at their positions for this load factor.
    pub(super) fn supports_are_at(&self, load_factor: f64, kinematics: Kinematics) -> bool {
        let system = self.problem.system();
        self.problem.supports().are_at(system.mesh(), load_factor, kinematics, &self.state.displacement)
    }

    /// Returns `true` if the body has not moved.
    pub(super) fn is_at_rest(&self) -> bool {
        self.state.displacement.iter().all(|u| *u == Vector2::zeros())
    }

    /// Returns `true` if the supports are at rest and rotate so far that their motion must be applied in parts.
    pub(super) fn supports_rotate_in_steps(&self) -> bool {
        let supports = self.problem.supports();
        supports.largest_load_step() < 1.0 && supports.are_at_rest(&self.state.displacement)
    }

    /// Rotates the body as a whole with its supports, if they are not at their positions for this load factor; returns
    /// `true` if it did. [`Self::put_supports`] applies the rest of their motion.
    pub(super) fn carry(&mut self, load_factor: f64) -> bool {
        let carries = !self.supports_are_at(load_factor, Kinematics::Corotated)
            && self.problem.supports().carry(self.problem.system().mesh(), load_factor, self.state);
        if carries {
            self.workspace.tangent = None;
        }
        carries
    }

    /// Moves the supports to their positions for this load factor, if necessary. The rotations are kept, so that the
    /// residual force is f_ext − f_int − A v, v the motion of the supports, and the next step moves the body
    /// accordingly.
    pub(super) fn put_supports(&mut self, load_factor: f64, kinematics: Kinematics) {
        if self.supports_are_at(load_factor, kinematics) {
            return;
        }
        let Self { problem, forces, state, .. } = self;
        let mesh = problem.system().mesh();
        self.residual = timed(&mut self.timings.assemble, || {
            problem.supports().put(mesh, load_factor, kinematics, &mut state.displacement);
            problem.linearize(state, forces, None);
            problem.balance(state, kinematics, load_factor, forces)
        });
    }

    /// Factorizes the workspace's matrix, which must be positive definite.
    pub(super) fn factorize(&mut self) -> Result<(), SolverError> {
        let Workspace { matrix, factor, .. } = &mut *self.workspace;
        timed(&mut self.timings.factorize, || factor.factorize(matrix.values()))
    }

    /// Factorizes the workspace's matrix, which may be indefinite; returns `true` if it is positive definite.
    pub(super) fn factorize_symmetric(&mut self) -> bool {
        let Workspace { matrix, factor, .. } = &mut *self.workspace;
        timed(&mut self.timings.factorize, || factor.factorize_symmetric(matrix.values()))
    }

    /// Performs u ← u + K⁻¹ (f_ext − f_int) with the last factor; returns the step's length.
    ///
    /// With K = A = Σ R Ke Rᵀ this is the article's iteration A x = f_ext + R K X (eq. 2) with A x on the right-hand
    /// side: f_int is A x − R K X. The fixed unknowns do not move, so eliminating them leaves no extra term (the
    /// article's 24 → 20 → 24), and a small step keeps its digits next to a large x.
    pub(super) fn step(&mut self) -> Result<f64, IterationError> {
        self.solve_for_step()?;
        self.advance(1.0);
        Ok(self.step_length())
    }

    /// Computes the step K⁻¹ (f_ext − f_int) with the last factor into the workspace.
    pub(super) fn solve_for_step(&mut self) -> Result<(), IterationError> {
        let Workspace { factor, free, .. } = &mut *self.workspace;
        timed(&mut self.timings.solve, || {
            self.problem.system().pattern().restrict(&self.forces.residual, free);
            factor.solve_in_place(free);
            if free.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(IterationError::NotFinite) }
        })
    }

    /// Performs u ← u + `fraction` · step; the workspace keeps the scaled step.
    pub(super) fn advance(&mut self, fraction: f64) {
        let free = &mut self.workspace.free;
        if fraction != 1.0 {
            free.iter_mut().for_each(|v| *v *= fraction);
        }
        self.problem.system().pattern().advance(free, 1.0, &mut self.state.displacement);
        self.workspace.tangent = None;
    }

    /// Returns the length of the step in the workspace.
    pub(super) fn step_length(&self) -> f64 {
        self.workspace.free.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

/// Computes the forces of a state and a tangent, including the loads' part.
pub(crate) fn assemble(
    problem: &Problem,
    state: &State,
    forces: &mut Forces,
    workspace: &mut Workspace,
    tangent: Tangent,
    load_factor: f64,
) {
    problem.linearize(state, forces, Some((tangent, &mut workspace.matrix)));
    problem.add_load_stiffness(state, tangent, load_factor, &mut workspace.matrix);
    workspace.tangent = Some(tangent);
}

/// Computes the forces of a state, and a tangent if requested. If `follow` is `true`, the displacement is new, and
/// rotations and edge angles are updated in the same loop. Returns the relative residual.
pub(crate) fn measure(
    problem: &Problem,
    state: &mut State,
    (kinematics, follow): (Kinematics, bool),
    (tangent, load_factor): (Option<Tangent>, f64),
    forces: &mut Forces,
    workspace: &mut Workspace,
    timings: &mut Timings,
) -> f64 {
    timed(&mut timings.assemble, || {
        let matrix = tangent.map(|tangent| (tangent, &mut workspace.matrix));
        if follow {
            problem.update_and_linearize(state, kinematics, forces, matrix);
        } else {
            problem.linearize(state, forces, matrix);
        }
        if let Some(tangent) = tangent {
            problem.add_load_stiffness(state, tangent, load_factor, &mut workspace.matrix);
        }
        workspace.tangent = tangent;
        problem.balance(state, kinematics, load_factor, forces)
    })
}
