//! Convergence criteria, and the questions and support motions that methods share.

use nalgebra::Vector2;

use crate::assembly::Kinematics;
use crate::step::{Iteration, Linearization, RotationUpdate};
use crate::timings::timed;

/// Convergence criteria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Criteria {
    /// Relative residual, for methods that iterate to an equilibrium.
    pub residual: f64,
    /// Error relative to the displacement, for `auto`.
    pub error: f64,
    /// Number of linear solves before the limit of iterations is reached, at least 1.
    pub solves_left: u32,
}

/// Residual that counts as small: if one below it stops falling, it is near convergence, not diverging, and may be
/// rounding error.
pub(super) const ROUNDING: f64 = 1e-6;
/// Largest bound of the rounding error with which a solve may end; larger bounds are not meaningful.
const LOOSEST_FLOOR: f64 = 1e-5;

impl Iteration<'_> {
    /// Returns the bound of the residual's rounding error if the residual is small and within it, and the bound is
    /// small enough to be meaningful.
    pub(super) fn floor(&mut self) -> Option<f64> {
        let residual = self.forces.relative_residual;
        if residual > ROUNDING {
            return None;
        }
        let Self { problem, forces, state, workspace, .. } = self;
        let floor = timed(&mut self.timings.linearize, || problem.residual_floor(state, forces, &mut workspace.nodal));
        floor.filter(|floor| residual <= *floor && *floor <= LOOSEST_FLOOR)
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

    /// Rotates the body as a whole with its supports, if they are not at their positions; then ensures that the
    /// workspace has the matrix. [`Self::put_supports`] applies the rest of their motion.
    pub(super) fn carry(&mut self, wanted: Linearization) {
        let carries = !self.supports_are_at(wanted.load_factor, Kinematics::Corotated)
            && self.problem.supports().carry(self.problem.system().mesh(), wanted.load_factor, self.state);
        if carries || self.workspace.tangent != wanted.tangent {
            self.linearize(RotationUpdate::Keep, wanted);
        }
    }

    /// Moves the supports to their positions, if necessary. The rotations are kept, so that the residual force is f_ext
    /// − f_int − A v, v the motion of the supports, and the next step moves the body accordingly.
    pub(super) fn put_supports(&mut self, wanted: Linearization) {
        if self.supports_are_at(wanted.load_factor, wanted.kinematics) {
            return;
        }
        let Self { problem, state, .. } = self;
        problem.supports().put(problem.system().mesh(), wanted.load_factor, wanted.kinematics, &mut state.displacement);
        self.linearize(RotationUpdate::Keep, Linearization { tangent: None, ..wanted });
    }

    /// Returns the length of the step in the workspace.
    pub(crate) fn step_length(&self) -> f64 {
        self.workspace.linear.correction.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}
