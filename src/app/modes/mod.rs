//! The modes of the window. Each owns its state.

pub(crate) mod budget;
pub(crate) mod compare;
pub(crate) mod explore;
pub(crate) mod learn;
