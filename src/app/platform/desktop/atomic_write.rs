//! Files that are written whole: readers never see a part.

use std::io::Write as _;
use std::path::Path;

/// Writes a file under a temporary name in the same folder and then renames it, so that readers see the old content or
/// the new content, never a part.
///
/// # Errors
/// Error of the operating system; the previous content is unchanged.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    replace_file(path, bytes, true)
}

/// Writes a file as [`save`] does, but without waiting for the disk: the file survives a crash of the program,
/// but not of the machine.
///
/// # Errors
/// Error of the operating system; the previous content is unchanged.
pub(crate) fn save_without_sync(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    replace_file(path, bytes, false)
}

fn replace_file(path: &Path, bytes: &[u8], syncs: bool) -> std::io::Result<()> {
    // A symbolic link stays; the file that it points to is written.
    let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let name = path.file_name().ok_or(std::io::ErrorKind::InvalidInput)?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(temporary);
    let write = || {
        let mut file = std::fs::File::create(&temporary)?;
        file.write_all(bytes)?;
        if syncs {
            file.sync_all()?;
        }
        if let Ok(before) = std::fs::metadata(&path) {
            file.set_permissions(before.permissions())?;
        }
        drop(file);
        std::fs::rename(&temporary, &path).map_err(explained)
    };
    write().inspect_err(|_| drop(std::fs::remove_file(&temporary)))
}

/// Adds the usual reason to an error of Windows, which does not replace a file that another program keeps for itself. Its
/// message may be "Access is denied".
fn explained(error: std::io::Error) -> std::io::Error {
    /// Error of Windows: another program has opened the file.
    const SHARING_VIOLATION: i32 = 32;
    let is_open =
        error.kind() == std::io::ErrorKind::PermissionDenied || error.raw_os_error() == Some(SHARING_VIOLATION);
    match cfg!(windows) && is_open {
        true => std::io::Error::new(error.kind(), format!("another program may have opened the file: {error}")),
        false => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_that_cannot_be_written_leaves_the_file_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        save(&path, b"one").unwrap();
        save(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        // A folder with the same name makes writing fail.
        let taken = folder.path().join("taken");
        std::fs::create_dir_all(taken.join("inside")).unwrap();
        assert!(save(&taken, b"three").is_err());
        assert!(save(&folder.path().join("nowhere/scene.toml"), b"three").is_err());
        // No temporary file remains.
        let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["scene.toml", "taken"]);
    }
}
