//! Settings in a file of the user's folder for settings.

use std::fs::File;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy as _;

use crate::app::platform::desktop::files;

/// Returns the path of this user's settings; `None` if the system has no folder for them.
pub(crate) fn file() -> Option<PathBuf> {
    let folder = etcetera::choose_base_strategy().ok()?.config_dir();
    Some(folder.join("warpbeam").join("settings.toml"))
}

/// Reads the settings.
///
/// # Errors
/// Error of the operating system.
pub(crate) fn read(file: &Path) -> std::io::Result<String> {
    std::fs::read_to_string(file)
}

/// Locks the settings until the result is dropped, and creates their folder if necessary. Waits for other windows.
///
/// # Errors
/// Error of the operating system.
pub(crate) fn lock(file: &Path) -> std::io::Result<File> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let lock = File::options().create(true).truncate(false).write(true).open(file.with_extension("lock"))?;
    lock.lock()?;
    Ok(lock)
}

/// Writes the settings.
///
/// # Errors
/// Error of the operating system.
pub(crate) fn write(file: &Path, text: &str) -> std::io::Result<()> {
    files::save_without_sync(file, text.as_bytes())
}

/// Renames settings that cannot be read, and returns their new name.
///
/// # Errors
/// Error of the operating system.
pub(crate) fn set_aside(file: &Path) -> std::io::Result<PathBuf> {
    let kept = file.with_extension("unreadable.toml");
    std::fs::rename(file, &kept)?;
    Ok(kept)
}
