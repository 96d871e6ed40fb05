//! Mode Explore: plots under the body.

pub(crate) mod motion_plot;
pub(crate) mod section_plot;
