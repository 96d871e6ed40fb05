//! Settings, and copies of unsaved edits, in files of the user's folder for settings.

use std::fs::File;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy as _;

use crate::app::platform::desktop::files;

/// Returns the path of this user's settings; `None` if the system has no folder for them.
pub(crate) fn file() -> Option<PathBuf> {
    let folder = etcetera::choose_base_strategy().ok()?.config_dir();
    Some(folder.join("warpbeam").join("settings.toml"))
}

/// Reads settings or a copy.
pub(crate) fn read(file: &Path) -> std::io::Result<String> {
    std::fs::read_to_string(file)
}

/// File for a copy, locked during the lifetime of this value.
pub(crate) struct CopyPlace {
    pub(crate) file: PathBuf,
    _lock: File,
}

/// Returns `true` if `folder` has a copy with this number.
pub(crate) fn has_copy(folder: &Path, number: usize) -> bool {
    folder.join(format!("{number}.toml")).exists()
}

/// Returns the time of the last change of a copy, if it is known.
pub(crate) fn modified(file: &Path) -> Option<std::time::SystemTime> {
    std::fs::metadata(file).and_then(|file| file.modified()).ok()
}

/// Locks the file with this number in `folder`, which is created if it does not exist; `None` if another window has
/// locked it.
pub(crate) fn lock(folder: &Path, number: usize) -> std::io::Result<Option<CopyPlace>> {
    std::fs::create_dir_all(folder)?;
    let lock = folder.join(format!("{number}.lock"));
    let lock = File::options().create(true).truncate(false).write(true).open(lock)?;
    match lock.try_lock() {
        Ok(()) => Ok(Some(CopyPlace { file: folder.join(format!("{number}.toml")), _lock: lock })),
        Err(std::fs::TryLockError::WouldBlock) => Ok(None),
        Err(std::fs::TryLockError::Error(error)) => Err(error),
    }
}

/// Writes settings or a copy, and creates their folder if necessary. After an error the previous content is unchanged.
pub(crate) fn write(file: &Path, text: &str) -> std::io::Result<()> {
    file.parent().map_or(Ok(()), std::fs::create_dir_all)?;
    files::save_without_sync(file, text.as_bytes())
}

/// Removes a copy, if there is one.
pub(crate) fn remove(file: &Path) -> std::io::Result<()> {
    match std::fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
