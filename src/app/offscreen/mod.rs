//! Pictures without a window: the painter that the window shares, screenshots, and recordings.

pub(crate) mod painter;
pub(crate) mod record;
pub(crate) mod recorder;
pub(crate) mod shot;
