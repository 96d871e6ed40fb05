//! Progress of long computations, and their cancellation.

use std::ops::ControlFlow;

use crate::sentence::Sentence;

/// Progress of a long computation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// Completed fraction, 0 to 1, of the expected time, which is estimated from sizes and from times measured so far.
    pub fraction: f64,
    /// Current part of the computation, for example a setting of a study; `None` if it is the same as before.
    pub now: Option<&'a Sentence>,
}

/// Callback that receives the progress of a computation from any of its threads, and cancels it with
/// [`ControlFlow::Break`]. A computation calls it before each solve, so that it ends soon once cancelled.
pub type Observer<'a> = &'a (dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync);

impl Progress<'_> {
    /// Returns the progress of a computation whose current part is the same as before.
    pub(crate) fn at(fraction: f64) -> Self {
        Self { fraction, now: None }
    }
}
