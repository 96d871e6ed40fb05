//! Progress of studies and of searches, and why they end without a result.

use std::ops::ControlFlow;

use crate::dynamics::StopReason;
use crate::simulation::SimulationError;
use crate::words::{number, two_digits};

/// Why a scene cannot be studied.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[non_exhaustive]
pub enum StudyError {
    /// The scene does not set up.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A body in motion has no equilibrium to compare with.
    #[error(
        "expected a scene with analysis = \"static\": this measures solves of its equilibrium, and it is in motion"
    )]
    InMotion,
    /// A body at rest has no path to compare with.
    #[error("expected a scene with analysis = \"dynamic\": this measures the path of its motion, and it is at rest")]
    AtRest,
    /// The fine motion that would be the reference cannot go on.
    #[error("no reference solution: the fine motion of the scene stops: {0}")]
    NoPath(StopReason),
    /// A mesh from a file cannot be made of other cells.
    #[error("expected a scene with [beam]: this measures it on coarser and finer meshes")]
    NoBeam,
    /// Nothing to compare.
    #[error("expected a scene with a probe that moves; errors are measured there")]
    NoProbe,
    /// A mesh from a file that has too many unknowns when it is refined.
    #[error("no reference solution: the mesh of {elements} elements is too large to be refined")]
    TooFine {
        /// Elements of the mesh.
        elements: usize,
    },
    /// The equilibrium is unstable: the body would not stay there.
    #[error("no reference solution: the equilibrium is unstable")]
    Unstable,
    /// No equilibrium was found on fine meshes.
    #[error("no reference solution: the fine solution of the scene does not converge")]
    NoReference,
    /// The solutions on finer and finer meshes do not approach each other, or too slowly.
    #[error("no reference solution: solutions on finer and finer meshes do not approach each other")]
    NoBound,
    /// The reference solution is no better than what is asked of a result.
    #[error(
        "the reference solution's own error may be {} %, no less than the {} % asked",
        number(two_digits(*own_percent)),
        number(*asked_percent)
    )]
    NotKnown {
        /// Bound of the reference's own error, percent.
        own_percent: f64,
        /// Error asked for, percent.
        asked_percent: f64,
    },
    /// Called off.
    #[error("called off")]
    Cancelled,
}

impl StudyError {
    /// `true` if there is nothing wrong with the scene, but no reference solution that is good enough.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        matches!(
            self,
            Self::TooFine { .. } | Self::Unstable | Self::NoReference | Self::NoBound | Self::NotKnown { .. }
        )
    }
}

/// How far a study is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// Fraction that is done, 0 to 1: of the time that is expected, from sizes and from what has been timed so far.
    pub fraction: f64,
    /// Setting being measured.
    pub now: &'a str,
}

/// Is told how far a study is, and calls it off with [`ControlFlow::Break`].
pub type Observer<'a> = &'a mut dyn FnMut(Progress<'_>) -> ControlFlow<()>;

/// How many meshes a study looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Without the finer ones.
    Quick,
    /// Up to some five thousand unknowns.
    Full,
}

/// Goes on, or is called off.
pub(super) fn check(flow: ControlFlow<()>) -> Result<(), StudyError> {
    if flow.is_break() { Err(StudyError::Cancelled) } else { Ok(()) }
}

/// Results of all items of [`super::parallel::map`], or the error of the first that failed or was called off.
pub(super) fn all_done<T>(results: Vec<Option<Result<T, StudyError>>>) -> Result<Vec<T>, StudyError> {
    results.into_iter().map(|result| result.ok_or(StudyError::Cancelled)?).collect()
}
