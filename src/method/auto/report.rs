//! Report of the decisions of `auto`.

/// Decisions of `auto` for the current result.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct AutoReport {
    /// Kind of solution.
    pub decision: Decision,
    /// Number of back substitutions.
    pub solves: u32,
    /// Number of factorized matrices.
    pub factorizations: u32,
    /// Estimated error of the method (without that of the mesh) relative to the displacement; after load stepping, the
    /// relative residual. Infinite before the end.
    pub estimated_error: f64,
}

/// Kind of solution that `auto` chose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Decision {
    /// Not finished.
    #[default]
    Undecided,
    /// No solve, because nothing has changed.
    Unchanged,
    /// Linear theory.
    Linear,
    /// Every corotated step reused the factorization of an earlier solve.
    OldFactor,
    /// Corotated steps with a new factor.
    NewFactor,
    /// Load stepping.
    LoadSteps,
}

impl Decision {
    /// Returns the identifier in JSON.
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
            Self::Linear => "linear theory suffices",
            Self::OldFactor => "old factorization reused",
            Self::NewFactor => "new factorization",
            Self::LoadSteps => "load stepping",
        })
    }
}
