//! Files on disk. The window has a dialog of its own to choose them.

use std::path::PathBuf;

pub(crate) use crate::app::platform::desktop::atomic_write::{save, save_without_sync};
pub(crate) use crate::scene::open;

/// Asks the browser for scene files.
pub(crate) fn choose() {}

/// Returns a file chosen in the browser or dropped on the page.
pub(crate) fn arrived() -> Option<PathBuf> {
    None
}
