//! Settings in a file of the user's folder for settings.

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

/// Writes the settings, and creates their folder if necessary.
///
/// # Errors
/// Error of the operating system.
pub(crate) fn write(file: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    files::save(file, text.as_bytes())
}
