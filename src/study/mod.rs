//! Measurements over many solves.

mod choice;
mod curve;
pub mod extremes;
pub mod plot;
mod reference;
mod report;
#[cfg(feature = "rivals")]
pub mod rivals;
mod timing;
mod trade;

pub use choice::{Choice, Demand};
pub use curve::{Limit, LoadCurve, MethodPoint, Sample};
pub use reference::Reference;
pub use trade::{ErrorSplit, Extent, Measurement, Progress, Setting, Study, StudyError, Watch};
