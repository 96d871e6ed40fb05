//! Settings in the local storage of the browser.

use std::io;
use std::path::{Path, PathBuf};

use web_sys::Storage;

use crate::app::platform::web::browser;

/// Returns the name of the settings.
pub(crate) fn file() -> Option<PathBuf> {
    storage().map(|_| PathBuf::from("warpbeam.settings"))
}

/// Reads the settings.
///
/// # Errors
/// [`io::ErrorKind::NotFound`] if the browser has no settings of this name.
pub(crate) fn read(file: &Path) -> io::Result<String> {
    let text = storage().zip(file.to_str()).and_then(|(storage, name)| storage.get_item(name).ok().flatten());
    text.ok_or_else(|| io::ErrorKind::NotFound.into())
}

/// Does nothing: a page has one window.
///
/// # Errors
/// None.
pub(crate) fn lock(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Writes the settings.
///
/// # Errors
/// The browser refuses them.
pub(crate) fn write(file: &Path, text: &str) -> io::Result<()> {
    let (storage, name) = storage().zip(file.to_str()).ok_or(io::ErrorKind::Unsupported)?;
    storage.set_item(name, text).map_err(|error| io::Error::other(browser::message(&error)))
}

/// Keeps settings that cannot be read under another name, and returns it.
///
/// # Errors
/// The browser refuses them.
pub(crate) fn set_aside(file: &Path) -> io::Result<PathBuf> {
    let kept = file.with_extension("unreadable");
    write(&kept, &read(file)?)?;
    remove(file)?;
    Ok(kept)
}

/// Removes an item of the storage, if there is one.
///
/// # Errors
/// The browser refuses it.
pub(super) fn remove(name: &Path) -> io::Result<()> {
    let Some((storage, name)) = storage().zip(name.to_str()) else { return Ok(()) };
    storage.remove_item(name).map_err(|error| io::Error::other(browser::message(&error)))
}

/// Returns the local storage; `None` if the browser is set to keep nothing.
pub(super) fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok().flatten()
}
