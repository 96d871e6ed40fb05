//! Report of the decisions of `auto` in a motion.

use crate::sentence::{Sentence, displayed, sentence};

/// Decisions of `auto` since the start of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[non_exhaustive]
pub struct MotionReport {
    /// Kind of the last step.
    pub decision: MotionDecision,
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

/// Kind of a time step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MotionDecision {
    /// No step yet.
    #[default]
    Undecided,
    /// Linear theory.
    Linear,
    /// Corotated, all stages with an older factor.
    OldFactor,
    /// Corotated, with a new factor.
    NewFactor,
}

impl MotionDecision {
    /// Returns the identifier in JSON.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Undecided => "undecided",
            Self::Linear => "linear",
            Self::OldFactor => "old_factor",
            Self::NewFactor => "new_factor",
        }
    }
}

displayed!(MotionDecision);

impl From<&MotionDecision> for Sentence {
    fn from(decision: &MotionDecision) -> Self {
        match decision {
            MotionDecision::Undecided => sentence!("not decided yet"),
            MotionDecision::Linear => sentence!("linear theory suffices"),
            MotionDecision::OldFactor => sentence!("old factorization reused"),
            MotionDecision::NewFactor => sentence!("new factorization"),
        }
    }
}

impl MotionReport {
    /// Records a step.
    pub(crate) fn note(&mut self, decision: MotionDecision) {
        self.decision = decision;
        match decision {
            MotionDecision::Undecided => {}
            MotionDecision::Linear => self.linear_steps += 1,
            MotionDecision::OldFactor => self.old_factor_steps += 1,
            MotionDecision::NewFactor => self.new_factor_steps += 1,
        }
    }
}
