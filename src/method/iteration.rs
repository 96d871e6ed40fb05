//! What an iteration works with, and the step all methods share.

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::{Forces, Kinematics, Matrix, Problem, System};
use crate::element::Tangent;
use crate::solver::{Factor, SolverError};
use crate::state::State;
use crate::timings::{Timings, timed};

/// Why an iteration produced no new state.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum IterationError {
    /// No factor.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The solution is not finite.
    #[error("the solution is not a finite number")]
    NotFinite,
}

/// Memory an iteration works in, made once for a system.
#[derive(Debug)]
pub struct Workspace {
    /// A matrix over the free unknowns …
    pub(crate) matrix: Matrix,
    /// … and which it is, where it is a tangent of the present state at the present load.
    pub(crate) tangent: Option<Tangent>,
    /// A factor.
    pub(crate) factor: Factor,
    /// A vector over the free unknowns.
    pub(crate) free: Vec<f64>,
    /// A nodal vector.
    pub(crate) nodal: Vec<Vector2<f64>>,
    /// A state to try steps on.
    pub(crate) trial: State,
}

impl Workspace {
    /// Makes room.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(system: &System) -> Result<Self, SolverError> {
        Ok(Self {
            matrix: Matrix::new(system.pattern()),
            tangent: None,
            factor: Factor::new(system.symbolic())?,
            free: vec![0.0; system.dofs()],
            nodal: vec![Vector2::zeros(); system.mesh().nodes().len()],
            trial: system.at_rest(),
        })
    }
}

/// When a solve is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Relative residual, for methods that iterate to an equilibrium.
    pub residual: f64,
    /// Error relative to the displacement, for `auto`.
    pub error: f64,
}

/// A residual below this is small: one that no longer falls is near its end, not diverging, and may be rounding.
pub(super) const ROUNDING: f64 = 1e-6;
/// A bound of rounding above this says too little of a residual for its solve to be called done.
const LOOSEST_FLOOR: f64 = 1e-5;

/// What a method may use and change in one iteration.
#[derive(Debug)]
pub struct Iteration<'a> {
    /// The equations and their numbers.
    pub problem: &'a Problem,
    /// Forces of the present state at the present load.
    pub forces: &'a mut Forces,
    /// The relative residual.
    pub residual: f64,
    /// When the solve is done.
    pub tolerances: Tolerances,
    /// The state, with the rotations of its displacement; methods replace the displacement.
    pub state: &'a mut State,
    /// Memory.
    pub workspace: &'a mut Workspace,
    /// Where the time goes.
    pub timings: &'a mut Timings,
}

impl Iteration<'_> {
    /// The system of the problem.
    pub(super) fn system(&self) -> &System {
        self.problem.system()
    }

    /// Sees to it that the workspace's matrix is this tangent of the present state at this load factor, the loads' own
    /// part included.
    pub(super) fn assemble(&mut self, tangent: Tangent, load_factor: f64) {
        if self.workspace.tangent == Some(tangent) {
            return;
        }
        let Self { problem, forces, state, workspace, timings, .. } = self;
        timed(&mut timings.assemble, || {
            assemble(problem, state, forces, workspace, tangent, load_factor);
        });
    }

    /// The bound of what rounding changes in the residual, where the residual is small and within it, and it
    /// says something.
    pub(super) fn floor(&mut self) -> Option<f64> {
        if self.residual > ROUNDING {
            return None;
        }
        let Self { problem, forces, state, workspace, residual, .. } = self;
        let floor = timed(&mut self.timings.assemble, || problem.residual_floor(state, forces, &mut workspace.nodal));
        floor.filter(|floor| *residual <= *floor && *floor <= LOOSEST_FLOOR)
    }

    /// Whether the supports are where they are at this load factor.
    pub(super) fn supports_are_at(&self, load_factor: f64, kinematics: Kinematics) -> bool {
        let system = self.problem.system();
        self.problem.supports().are_at(system.mesh(), load_factor, kinematics, &self.state.displacement)
    }

    /// Whether nothing has been moved yet, and supports turn so far that they must be taken on in parts.
    pub(super) fn supports_must_turn_in_steps(&self) -> bool {
        let supports = self.problem.supports();
        supports.largest_load_step() < 1.0 && supports.are_at_rest(&self.state.displacement)
    }

    /// Turns the body as a whole with its supports, where they are not yet where they are at this load factor; says
    /// whether it did. What is left of their way is for [`Self::put_supports`].
    pub(super) fn carry(&mut self, load_factor: f64) -> bool {
        let carries = !self.supports_are_at(load_factor, Kinematics::Corotated)
            && self.problem.supports().carry(self.problem.system().mesh(), load_factor, self.state);
        if carries {
            self.workspace.tangent = None;
        }
        carries
    }

    /// Puts the supports where they are at this load factor, if they are not: with the rotations as they are, so that
    /// the residual force is f_ext − f_int − A v, v the way of the supports, and the next step moves the body as v asks.
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

    /// Factorizes the workspace's matrix, definite or not.
    pub(super) fn factorize_symmetric(&mut self) -> bool {
        let Workspace { matrix, factor, .. } = &mut *self.workspace;
        timed(&mut self.timings.factorize, || factor.factorize_symmetric(matrix.values()))
    }

    /// u ← u + K⁻¹ (f_ext − f_int) with the last factor; returns the step's length.
    ///
    /// With K = A = Σ R Ke Rᵀ this is the article's iteration A x = f_ext + R K X (eq. 2) with A x taken to the
    /// right-hand side: f_int is A x − R K X. The fixed unknowns do not move, so eliminating them leaves no term behind
    /// (its 24 → 20 → 24), and a small step keeps its digits next to a large x.
    pub(super) fn step(&mut self) -> Result<f64, IterationError> {
        self.solve_for_step()?;
        self.advance(1.0);
        Ok(self.step_length())
    }

    /// The step K⁻¹ (f_ext − f_int) with the last factor, left in the workspace.
    pub(super) fn solve_for_step(&mut self) -> Result<(), IterationError> {
        let Workspace { factor, free, .. } = &mut *self.workspace;
        timed(&mut self.timings.solve, || {
            self.problem.system().pattern().restrict(&self.forces.residual, free);
            factor.solve_in_place(free);
            if free.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(IterationError::NotFinite) }
        })
    }

    /// u ← u + `fraction` · step; the workspace keeps the step that was made.
    pub(super) fn advance(&mut self, fraction: f64) {
        let free = &mut self.workspace.free;
        if fraction != 1.0 {
            free.iter_mut().for_each(|v| *v *= fraction);
        }
        self.problem.system().pattern().advance(free, 1.0, &mut self.state.displacement);
        self.workspace.tangent = None;
    }

    /// Length of the step in the workspace.
    pub(super) fn step_length(&self) -> f64 {
        self.workspace.free.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

/// Forces of a state and a tangent, the loads' own part included.
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

/// Measures a state: its forces, and a tangent where one is wanted. The displacement is new where rotations and turns of
/// edges are to `follow` it, in the same sweep. Returns the relative residual.
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
            problem.follow_and_linearize(state, kinematics, forces, matrix);
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
