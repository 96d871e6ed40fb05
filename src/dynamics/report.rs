//! Report of the decisions of `auto` in a motion.

use crate::method::Decision;

/// Decisions of `auto` since the start of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[non_exhaustive]
pub struct MotionReport {
    /// Kind of the last step.
    pub decision: Decision,
    /// Number of back substitutions.
    pub solves: u64,
    /// Number of factorized matrices.
    pub factorizations: u64,
    /// Number of steps with linear theory.
    pub linear_steps: u64,
    /// Number of corotated steps without a factorization.
    pub old_factor_steps: u64,
    /// Number of corotated steps with a factorization.
    pub new_factor_steps: u64,
}

impl MotionReport {
    /// Records a step.
    pub(crate) fn note(&mut self, decision: Decision) {
        self.decision = decision;
        match decision {
            Decision::Linear => self.linear_steps += 1,
            Decision::OldFactor => self.old_factor_steps += 1,
            Decision::NewFactor => self.new_factor_steps += 1,
            _ => {}
        }
    }
}
