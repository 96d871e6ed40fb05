//! Measurements over many solves.

mod curve;
pub mod extremes;
pub mod plot;
mod trade;

pub use curve::{Limit, LoadCurve, MethodPoint, Sample};
pub use trade::{ErrorSplit, Measurement, Setting, Study, StudyError};
