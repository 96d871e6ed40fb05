//! Background work: threads with progress and cancellation, lazily computed values, and the solve of a large model.

pub(crate) mod keyed;
pub(crate) mod solve;
pub(crate) mod thread;
