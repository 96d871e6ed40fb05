//! Files on disk. The window has a dialog of its own to choose them.

use std::path::PathBuf;

pub(crate) use crate::atomic_write::{save, save_without_sync};
use crate::scene::Source;
pub(crate) use crate::scene::open;

pub(crate) fn text(source: &Source) -> Option<String> {
    source.text().ok()
}

/// Asks the browser for scene files.
pub(crate) fn choose() {}

/// Returns a file chosen in the browser or dropped on the page.
pub(crate) fn arrived() -> Option<PathBuf> {
    None
}
