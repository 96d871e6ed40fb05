//! Files on disk. The window has a dialog of its own to choose them.

use std::path::{Path, PathBuf};

use crate::app::platform::desktop::atomic_write::{write_whole, write_without_sync};
use crate::scene::{self, Scene, SceneError, Source};

/// Opens a built-in scene or a scene file.
///
/// # Errors
/// [`SceneError`].
pub(crate) fn open(source: &Source) -> Result<Scene, SceneError> {
    scene::open(source)
}

/// Writes a file; readers see the old content or the new one, never a part.
///
/// # Errors
/// Error of the operating system; the previous content is unchanged.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    write_whole(path, bytes)
}

/// Writes a file as [`save`] does, but without waiting for the disk: the file survives a crash of the program, but not
/// of the machine.
///
/// # Errors
/// Error of the operating system; the previous content is unchanged.
pub(crate) fn save_without_sync(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    write_without_sync(path, bytes)
}

/// Asks the browser for scene files.
pub(crate) fn choose() {}

/// Returns a file chosen in the browser or dropped on the page.
pub(crate) fn arrived() -> Option<PathBuf> {
    None
}
