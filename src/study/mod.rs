//! Measurements over many solves.

mod curve;
pub mod extremes;

pub use curve::{Limit, LoadCurve, MethodPoint, Sample};
