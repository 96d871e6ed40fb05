//! Modes of the window. Each module owns the state of its mode.

pub(crate) mod compare;
pub(crate) mod figure;
pub(crate) mod learn;
pub(crate) mod measure;
pub(crate) mod motion_plot;
pub(crate) mod section_plot;
