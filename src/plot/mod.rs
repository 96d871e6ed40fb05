//! Charts of measurements: error over time, limits, atlases and figures, drawn in SVG files and in the window.

mod atlas;
mod axes;
mod drawing;
mod figure;
mod limits;
mod trade;

pub use atlas::atlas;
pub use drawing::Drawing;
pub use figure::figures;
pub use limits::limits;
pub use trade::study;
#[cfg(feature = "app")]
pub(crate) use {
    axes::{ChartAxis, ChartFrame, mark},
    drawing::{Anchor, DrawTarget},
    figure::{chart, draw},
    limits::{LimitsChart, hatch},
    trade::{SMALLEST_ERROR, StudyChart},
};
