//! Status of a simulation.

use crate::dynamics::StopReason;
use crate::method::Reason;
use crate::sentence::Sentence;

/// Status of a simulation.
///
/// ```
/// use warpbeam::{IterationError, MethodKind, Reason, Scene, Simulation, Status};
///
/// // A load of α = P L²/EI = 24 is too large for the iteration `warped`.
/// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -20_000.0]).with_method(MethodKind::Warped);
/// let mut beam = Simulation::new(&scene)?;
/// let advice = match beam.solve() {
///     Status::Converged | Status::Accepted => "read the results",
///     Status::NotConverged(Reason::IterationLimit(_)) => "raise the limit of iterations",
///     Status::Diverged(Reason::Iteration(IterationError::NotFinite)) => "reduce the load",
///     Status::Diverged(_) => "use the method `newton`",
///     _ => "read the reason",
/// };
/// assert_eq!(advice, "use the method `newton`");
/// # Ok::<(), warpbeam::SimulationError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Status {
    /// Not finished.
    #[default]
    Running,
    /// The residual is below the tolerance, or within its rounding error; see [`crate::Equilibrium::residual_floor`].
    Converged,
    /// The number of iterations was reached after which the scene accepts the result:
    /// [`accept_after`](crate::SolverSettings::accept_after).
    Accepted,
    /// The search stopped while still improving, or close to convergence.
    NotConverged(Reason),
    /// The iteration diverged; the state is its last finite one.
    Diverged(Reason),
    /// A motion has reached the end of the scene's duration.
    Finished,
    /// A motion cannot continue; the state is its last finite one.
    Stopped(StopReason),
}

impl Status {
    /// Returns the identifier in JSON.
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

    /// Returns the status in English for display, such as `not converged`.
    pub fn word(&self) -> String {
        self.id().replace('_', " ")
    }

    /// Returns `true` if the simulation ended successfully.
    pub fn is_success(&self) -> bool {
        matches!(self, Self::Converged | Self::Accepted | Self::Finished)
    }

    /// Returns the reason why the simulation ended without success; `None` otherwise.
    pub fn failure(&self) -> Option<String> {
        self.failure_sentence().map(|reason| reason.to_string())
    }

    /// Returns the reason as [`Self::failure`] does, with its parts.
    pub(crate) fn failure_sentence(&self) -> Option<Sentence> {
        match self {
            Self::NotConverged(reason) | Self::Diverged(reason) => Some(reason.into()),
            Self::Stopped(reason) => Some(reason.into()),
            Self::Running | Self::Converged | Self::Accepted | Self::Finished => None,
        }
    }
}

impl From<Reason> for Status {
    fn from(reason: Reason) -> Self {
        if reason.is_divergence() { Self::Diverged(reason) } else { Self::NotConverged(reason) }
    }
}
