//! Rendering without a window: the frame painter, which the window also uses, screenshots, and recordings.

pub(crate) mod options;
pub(crate) mod painter;
pub(crate) mod record;
pub(crate) mod shot;
