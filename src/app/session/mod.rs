//! The model that is being worked on, without the user interface.

pub(crate) mod clock;
pub(crate) mod document;
pub(crate) mod history;
pub(crate) mod past;
pub(crate) mod playback;
pub(crate) mod quality;
pub(crate) mod recovery;
pub(crate) mod undo;
