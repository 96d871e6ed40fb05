//! Background work: a thread with progress and cancellation, values computed in one, and the solve of a large model.

pub(crate) mod lazy;
pub(crate) mod quality;
pub(crate) mod solve;
pub(crate) mod thread;
