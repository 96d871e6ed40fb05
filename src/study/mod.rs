//! Measurements over many solves.

mod claim;
mod convergence;
pub mod extremes;
pub mod figure;
mod fine;
pub mod limits;
mod load_curve;
mod load_path;
mod measure;
pub mod motion;
pub(crate) mod parallel;
pub mod path_chart;
mod prelude;
mod progress;
mod ranking;
mod reference;
mod report;
pub mod section_chart;
mod setting;
mod timing;
mod trade;

pub use crate::method::{Bifurcation, Drive, Jump, PathEndReason, PathEvents};
pub use claim::{Claim, driven_texts, floor_text, rho_text};
pub use fine::moved_points;
pub use load_curve::{LoadCurve, Sample};
pub use load_path::{LoadPath, PathFromRest, PathState, PathSummary, support_name, support_text};
pub use progress::{Extent, StudyError};
pub use ranking::{Demand, Tuning};
pub use reference::{FOLDS, MAX_CERTIFIED, MovedPoint, ProbeReference, Reference, ReferenceSource, is_unstable};
pub use setting::{Setting, Stepping};
pub use timing::{time_of_motion, times_from_rest};
pub use trade::{ErrorSplit, Measurement, MotionFigures, Study, StudyReference};
