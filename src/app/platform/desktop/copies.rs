//! Places for copies of unsaved edits: numbered files, each locked by the window that uses it.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use crate::app::platform::desktop::files;

/// Numbered file, locked during the lifetime of this value.
#[derive(Debug)]
pub(crate) struct CopyPlace {
    file: PathBuf,
    _lock: File,
}

impl CopyPlace {
    /// Locks the file with this number in `folder`, which is created if it does not exist; `None` if another window has
    /// locked it.
    ///
    /// # Errors
    /// Error of the operating system.
    pub(crate) fn lock(folder: &Path, number: usize) -> io::Result<Option<Self>> {
        std::fs::create_dir_all(folder)?;
        let lock = folder.join(format!("{number}.lock"));
        let lock = OpenOptions::new().create(true).truncate(false).write(true).open(lock)?;
        match lock.try_lock() {
            Ok(()) => Ok(Some(Self { file: folder.join(format!("{number}.toml")), _lock: lock })),
            Err(std::fs::TryLockError::WouldBlock) => Ok(None),
            Err(std::fs::TryLockError::Error(error)) => Err(error),
        }
    }

    /// Returns the file of the copy.
    pub(crate) fn file(&self) -> &Path {
        &self.file
    }

    /// Returns `true` if there is no copy.
    pub(crate) fn is_empty(&self) -> bool {
        !self.file.exists()
    }

    /// Reads the copy.
    ///
    /// # Errors
    /// Error of the operating system.
    pub(crate) fn read(&self) -> io::Result<String> {
        std::fs::read_to_string(&self.file)
    }

    /// Writes the copy.
    ///
    /// # Errors
    /// Error of the operating system; the previous copy is unchanged.
    pub(crate) fn write(&self, text: &str) -> io::Result<()> {
        files::save_without_sync(&self.file, text.as_bytes())
    }

    /// Removes the copy, if there is one.
    ///
    /// # Errors
    /// Error of the operating system.
    pub(crate) fn remove(&self) -> io::Result<()> {
        match std::fs::remove_file(&self.file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }
}
