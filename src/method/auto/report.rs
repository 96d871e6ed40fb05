//! What `auto` reports of its decisions.

/// What `auto` did for the present result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AutoReport {
    /// What it came down to.
    pub decision: Decision,
    /// Back substitutions.
    pub solves: u32,
    /// Matrices factorized.
    pub factorizations: u32,
    /// Estimated error of the method (the mesh has its own) relative to the displacement; after load stepping, the
    /// relative residual. Infinite before the end.
    pub estimated_error: f64,
}

/// What a result came down to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Decision {
    /// Not there yet.
    #[default]
    Undecided,
    /// No solve: nothing has changed.
    Unchanged,
    /// Linear theory.
    Linear,
    /// Corotated steps, all with an old factor.
    OldFactor,
    /// Corotated steps, factorized anew.
    NewFactor,
    /// Load stepping.
    LoadSteps,
}

impl Decision {
    /// The word in JSON.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Undecided => "undecided",
            Self::Unchanged => "unchanged",
            Self::Linear => "linear",
            Self::OldFactor => "old_factor",
            Self::NewFactor => "new_factor",
            Self::LoadSteps => "load_steps",
        }
    }
}

impl std::fmt::Display for Decision {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Undecided => "not decided yet",
            Self::Unchanged => "nothing changed: no solve",
            Self::Linear => "linear theory serves",
            Self::OldFactor => "the old factor serves",
            Self::NewFactor => "factorized anew",
            Self::LoadSteps => "load stepping",
        })
    }
}
