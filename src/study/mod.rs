//! Measurements over many solves.

mod curve;

pub use curve::{Limit, LoadCurve, MethodPoint, Sample};
