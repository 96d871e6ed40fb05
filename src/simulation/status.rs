//! Where a simulation stands.

use crate::dynamics::StopReason;
use crate::method::Reason;

/// Where a simulation stands.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Status {
    /// Not there yet.
    #[default]
    Running,
    /// The residual is below the tolerance, or within what rounding changes in it; see
    /// [`crate::Simulation::residual_floor`].
    Converged,
    /// It has made the iterations after which the scene accepts its result: [`crate::scene::SolverSettings::accept_after`].
    Accepted,
    /// It stopped while still improving, or near its end.
    NotConverged(Reason),
    /// The iteration does not lead to an equilibrium; the state shown is its last finite one.
    Diverged(Reason),
    /// A motion has come to the end of the scene's duration.
    Finished,
    /// A motion cannot go on; the state shown is its last finite one.
    Stopped(StopReason),
}

impl Status {
    /// The word in JSON.
    #[must_use]
    pub fn id(&self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Converged => "converged",
            Self::Accepted => "accepted",
            Self::NotConverged(_) => "not_converged",
            Self::Diverged(_) => "diverged",
            Self::Finished => "finished",
            Self::Stopped(_) => "stopped",
        }
    }

    /// The word people read.
    #[must_use]
    pub fn word(&self) -> String {
        self.id().replace('_', " ")
    }

    /// Whether it has come to its result.
    #[must_use]
    pub fn is_success(&self) -> bool {
        matches!(self, Self::Converged | Self::Accepted | Self::Finished)
    }

    /// Why it has ended without its result.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        match self {
            Self::NotConverged(reason) | Self::Diverged(reason) => Some(reason.to_string()),
            Self::Stopped(reason) => Some(reason.to_string()),
            Self::Running | Self::Converged | Self::Accepted | Self::Finished => None,
        }
    }
}

impl From<Reason> for Status {
    fn from(reason: Reason) -> Self {
        if reason.is_divergence() { Self::Diverged(reason) } else { Self::NotConverged(reason) }
    }
}
