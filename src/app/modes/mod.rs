//! Modes of the window. Each module owns the state of its mode.

pub(crate) mod compare;
pub(crate) mod explore;
pub(crate) mod figure;
pub(crate) mod learn;
pub(crate) mod measure;
