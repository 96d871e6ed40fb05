//! What `auto` reports of its decisions in a motion.

/// What `auto` did since the start of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MotionReport {
    /// What the last step came down to.
    pub decision: MotionDecision,
    /// Back substitutions.
    pub solves: u64,
    /// Matrices factorized.
    pub factorizations: u64,
    /// Steps taken under linear theory.
    pub linear_steps: u64,
    /// Corotated steps without a factorization, and …
    pub old_factor_steps: u64,
    /// … those with one.
    pub new_factor_steps: u64,
}

/// What a time step came down to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionDecision {
    /// No step yet.
    #[default]
    Undecided,
    /// Linear theory.
    Linear,
    /// Corotated, all stages with an older factor.
    OldFactor,
    /// Corotated, factorized anew.
    NewFactor,
}

impl MotionDecision {
    /// The word in JSON.
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

impl std::fmt::Display for MotionDecision {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Undecided => "not decided yet",
            Self::Linear => "linear theory serves",
            Self::OldFactor => "the old factor serves",
            Self::NewFactor => "factorized anew",
        })
    }
}

impl MotionReport {
    /// Notes a step.
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
