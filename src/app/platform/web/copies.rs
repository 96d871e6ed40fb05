//! Places for copies of unsaved edits: items in the local storage of the browser, one for each visit.

use std::io;
use std::path::{Path, PathBuf};

use crate::app::platform::web::settings;

/// Item of the storage with a name of its own.
#[derive(Debug)]
pub(crate) struct CopyPlace {
    name: PathBuf,
}

impl CopyPlace {
    /// Returns the item of an earlier visit with this number, and beyond them a new one. Visits in other tabs that have
    /// unsaved edits count as earlier ones.
    ///
    /// # Errors
    /// The browser is set to keep nothing.
    pub(crate) fn lock(folder: &Path, number: usize) -> io::Result<Option<Self>> {
        let prefix = format!("warpbeam.{}.", folder.display());
        let storage = settings::storage().ok_or_else(|| io::Error::other("the browser is set to keep nothing"))?;
        let keys = (0..storage.length().unwrap_or(0)).filter_map(|i| storage.key(i).ok().flatten());
        let mut earlier: Vec<String> = keys.filter(|key| key.starts_with(&prefix)).collect();
        earlier.sort();
        let new = || format!("{prefix}{:.0}{:.0}", js_sys::Date::now(), 1e6 * js_sys::Math::random());
        Ok(Some(Self { name: earlier.get(number).cloned().unwrap_or_else(new).into() }))
    }

    /// Returns the name of the item.
    pub(crate) fn file(&self) -> &Path {
        &self.name
    }

    /// Returns `true` if there is no copy.
    pub(crate) fn is_empty(&self) -> bool {
        self.read().is_err()
    }

    /// Reads the copy.
    ///
    /// # Errors
    /// [`io::ErrorKind::NotFound`] if there is no copy.
    pub(crate) fn read(&self) -> io::Result<String> {
        settings::read(&self.name)
    }

    /// Writes the copy.
    ///
    /// # Errors
    /// The browser refuses it.
    pub(crate) fn write(&self, text: &str) -> io::Result<()> {
        settings::write(&self.name, text)
    }

    /// Removes the copy, if there is one.
    ///
    /// # Errors
    /// The browser refuses it.
    pub(crate) fn remove(&self) -> io::Result<()> {
        settings::remove(&self.name)
    }
}
