//! Settings, and copies of unsaved edits, in the local storage of the browser.

use std::io;
use std::path::{Path, PathBuf};

use web_sys::Storage;

use crate::app::platform::web;

/// Returns the name of the settings.
pub(crate) fn file() -> Option<PathBuf> {
    storage().map(|_| PathBuf::from("warpbeam.settings"))
}

/// Reads settings or a copy; the error is [`io::ErrorKind::NotFound`] if the browser has no item of this name.
pub(crate) fn read(file: &Path) -> io::Result<String> {
    let text = storage().zip(file.to_str()).and_then(|(storage, name)| storage.get_item(name).ok().flatten());
    text.ok_or_else(|| io::ErrorKind::NotFound.into())
}

/// Item for a copy.
pub(crate) struct CopyPlace {
    pub(crate) file: PathBuf,
}

/// Returns `true` if there is a copy with this number beyond the first new one: earlier ones have lower numbers.
pub(crate) fn has_copy(_: &Path, _: usize) -> bool {
    false
}

/// Returns the time of the last change of a copy: it is not known.
pub(crate) fn modified(_: &Path) -> Option<std::time::SystemTime> {
    None
}

/// Returns the item of an earlier visit with this number, and beyond them a new one. Visits in other tabs that have
/// unsaved edits count as earlier ones.
pub(crate) fn lock(folder: &Path, number: usize) -> io::Result<Option<CopyPlace>> {
    let prefix = format!("warpbeam.{}.", folder.display());
    let storage = storage().ok_or_else(|| io::Error::other("the browser is set to keep nothing"))?;
    let keys = (0..storage.length().unwrap_or(0)).filter_map(|i| storage.key(i).ok().flatten());
    let mut earlier: Vec<String> = keys.filter(|key| key.starts_with(&prefix)).collect();
    earlier.sort();
    let new = || format!("{prefix}{:.0}{:.0}", js_sys::Date::now(), 1e6 * js_sys::Math::random());
    Ok(Some(CopyPlace { file: earlier.get(number).cloned().unwrap_or_else(new).into() }))
}

/// Writes settings or a copy.
pub(crate) fn write(file: &Path, text: &str) -> io::Result<()> {
    let (storage, name) = storage().zip(file.to_str()).ok_or(io::ErrorKind::Unsupported)?;
    storage.set_item(name, text).map_err(|error| io::Error::other(web::message(&error)))
}

/// Removes a copy, if there is one.
pub(crate) fn remove(name: &Path) -> io::Result<()> {
    let Some((storage, name)) = storage().zip(name.to_str()) else { return Ok(()) };
    storage.remove_item(name).map_err(|error| io::Error::other(web::message(&error)))
}

/// Returns the local storage; `None` if the browser is set to keep nothing.
fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok().flatten()
}
