//! Measurements over many solves.

pub mod extremes;
mod heat_map;
mod load_curve;
pub mod plot;
mod reference;
mod report;
mod timing;
mod trade;
mod tune;

pub use heat_map::heat_map;
pub use load_curve::{Departure, LoadCurve, MethodPoint, Sample};
pub use reference::{ProbeTruth, Reference, TruthSource};
pub use timing::times_from_rest;
pub use trade::{ErrorSplit, Extent, Measurement, Observer, Progress, Setting, Study, StudyError};
pub use tune::{Demand, Tuning};
