//! Mode Explore: plots under the body.

pub(crate) mod figure;
pub(crate) mod load_curve;
pub(crate) mod motion_plot;
pub(crate) mod section_plot;
