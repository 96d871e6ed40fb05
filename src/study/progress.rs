//! Errors and extent of studies and searches.

use std::ops::ControlFlow;

use crate::dynamics::StopReason;
use crate::format::{number, two_digits};
use crate::progress::Progress;
use crate::sentence::{Sentence, sentence};
use crate::simulation::SimulationError;

/// Reason why a scene cannot be studied.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum StudyError {
    /// The scene cannot be simulated.
    Simulation(#[from] SimulationError),
    /// The scene is dynamic and has no equilibrium to compare with.
    InMotion,
    /// The motion on the fine mesh, which would be the reference, stops.
    NoPath(StopReason),
    /// The scene has no probe that moves.
    NoProbe,
    /// The refined mesh of a file would have too many unknowns.
    TooFine {
        /// Number of elements of the mesh.
        elements: usize,
    },
    /// The equilibrium is unstable.
    Unstable,
    /// No equilibrium was found on fine meshes, or the solutions on finer and finer ones do not converge.
    NoReference,
    /// The reference solution is not more accurate than the requested result.
    NotKnown {
        /// Bound of the reference's own error, percent.
        own_percent: f64,
        /// Requested error, percent.
        asked_percent: f64,
    },
    /// Cancelled.
    Cancelled,
}

impl From<&StudyError> for Sentence {
    fn from(error: &StudyError) -> Self {
        match error {
            StudyError::Simulation(error) => error.into(),
            StudyError::InMotion => "expected a scene with analysis = \"static\": equilibria are compared, and this \
                                     scene is in motion; `warpbeam study` compares motions"
                .into(),
            StudyError::NoPath(reason) => {
                sentence!("no reference solution: the motion of the fine mesh stops: %{reason}", reason)
            }
            StudyError::NoProbe => {
                sentence!("expected a scene with a probe that moves: errors are measured at probes")
            }
            StudyError::TooFine { elements } => {
                sentence!("no reference solution: the mesh of %{n} elements is too large to be refined", n = *elements)
            }
            StudyError::Unstable => sentence!("no reference solution: the equilibrium is unstable"),
            StudyError::NoReference => sentence!("no reference solution: the solutions on fine meshes do not converge"),
            StudyError::NotKnown { own_percent, asked_percent } => sentence!(
                "the reference solution's own error may be %{own} %, not less than the %{asked} % asked for",
                own = number(two_digits(*own_percent)),
                asked = number(*asked_percent)
            ),
            StudyError::Cancelled => "cancelled".into(),
        }
    }
}

impl StudyError {
    /// Returns `true` if the scene is valid, but no sufficiently accurate reference solution exists.
    pub fn is_unknown(&self) -> bool {
        matches!(self, Self::TooFine { .. } | Self::Unstable | Self::NoReference | Self::NotKnown { .. })
    }
}

/// Result of a step of a study or search.
pub(super) type Result<T, E = StudyError> = std::result::Result<T, E>;

/// Extent of a study, or of the search for a reference solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Extent {
    /// A search for a reference during a drag stops at meshes of 3,500 unknowns, after 50 ms; a study is as a quick one.
    Drag,
    /// A study measures coarse meshes only. A search for a reference stops at meshes of about 10,000 unknowns and the work
    /// of about 30 solves on them, after a second or two.
    Quick,
    /// A study measures meshes of up to about five thousand unknowns. A search for a reference refines the mesh, up to
    /// 700,000 unknowns, until the error is 0.01 %.
    Full,
}

impl Extent {
    /// Returns the value of a quick study or search, or that of a full one.
    pub(super) fn pick<T>(self, [quick, full]: [T; 2]) -> T {
        if self == Self::Full { full } else { quick }
    }
}

/// Converts [`ControlFlow::Break`] to [`StudyError::Cancelled`].
pub(super) fn check(flow: ControlFlow<()>) -> Result<()> {
    if flow.is_break() { Err(StudyError::Cancelled) } else { Ok(()) }
}

/// Returns the progress of a whole whose part, from one fraction to another, has this progress.
pub(super) fn within(part: Progress<'_>, [from, to]: [f64; 2]) -> Progress<'_> {
    Progress { fraction: from * (1.0 - part.fraction) + to * part.fraction, ..part }
}
