//! Drawings of measurements: error over time, lines of elements, atlases and figures, as SVG.

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
pub use trade::{LARGEST_ERROR, SMALLEST_ERROR};
#[cfg(feature = "app")]
pub(crate) use {axes::ScaledAxis, limits::rating_color};
