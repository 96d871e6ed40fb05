//! Files that are written whole: readers never see a part.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Result, Write as _};
use std::path::Path;

/// Writes a file under a temporary name in the same folder and then renames it, so that readers see the old content or
/// the new content, never a part. A file that has other names or another owner is overwritten, so that it keeps them.
///
/// # Errors
/// Error of the operating system, or the file is read-only; the previous content is unchanged.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_file(path, bytes, true)
}

/// Writes a file as [`save`] does, but without waiting for the disk: the file survives a crash of the program,
/// but not of the machine.
///
/// # Errors
/// Same errors as [`save`].
#[cfg(feature = "app")]
pub(crate) fn save_without_sync(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_file(path, bytes, false)
}

fn replace_file(path: &Path, bytes: &[u8], syncs: bool) -> Result<()> {
    // A symbolic link stays; the file that it points to is written.
    let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let before = std::fs::metadata(&path).ok();
    if let Some(before) = &before {
        // A rename would replace a file that may not be written.
        if before.permissions().readonly() {
            return Err(Error::new(ErrorKind::PermissionDenied, "the file is read-only; choose another name"));
        }
        let mut file = File::options().write(true).open(&path).map_err(explained)?;
        if !before.is_file() {
            return file.write_all(bytes);
        }
    }
    let name = path.file_name().ok_or(ErrorKind::InvalidInput)?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(temporary);
    let write = || {
        let mut file = match File::create(&temporary) {
            // No file may be added to the folder.
            Err(error) if error.kind() == ErrorKind::PermissionDenied && before.is_some() => {
                return overwrite(&path, bytes, syncs);
            }
            file => file?,
        };
        file.write_all(bytes)?;
        if syncs {
            file.sync_all()?;
        }
        if let Some(before) = &before {
            if has_other_names_or_owner(before, &file.metadata()?) {
                overwrite(&path, bytes, syncs)?;
                return std::fs::remove_file(&temporary);
            }
            file.set_permissions(before.permissions())?;
        }
        drop(file);
        std::fs::rename(&temporary, &path).map_err(explained)
    };
    write().inspect_err(|_| drop(std::fs::remove_file(&temporary)))
}

/// Replaces the content of a file. If that fails, as on a full disk, the previous content is written again: its place on
/// the disk is still there.
fn overwrite(path: &Path, bytes: &[u8], syncs: bool) -> Result<()> {
    let write = |bytes: &[u8]| {
        let mut file = File::options().write(true).open(path)?;
        file.write_all(bytes)?;
        file.set_len(bytes.len() as u64)?;
        if syncs { file.sync_all() } else { Ok(()) }
    };
    let before = std::fs::read(path)?;
    write(bytes).inspect_err(|_| drop(write(&before)))
}

/// Returns `true` for a file with several names (hard links) or another owner than a new file has.
#[cfg(unix)]
fn has_other_names_or_owner(file: &Metadata, new: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    file.nlink() > 1 || (file.uid(), file.gid()) != (new.uid(), new.gid())
}

#[cfg(not(unix))]
fn has_other_names_or_owner(_: &Metadata, _: &Metadata) -> bool {
    false
}

/// Adds the usual reason to an error of Windows, which does not replace a file that another program keeps for itself. Its
/// message may be "Access is denied".
fn explained(error: Error) -> Error {
    /// Error of Windows: another program has opened the file.
    const SHARING_VIOLATION: i32 = 32;
    let is_open = error.kind() == ErrorKind::PermissionDenied || error.raw_os_error() == Some(SHARING_VIOLATION);
    match cfg!(windows) && is_open {
        true => Error::new(error.kind(), format!("another program may have opened the file: {error}")),
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

    #[test]
    fn a_read_only_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        save(&path, b"one").unwrap();
        let mut permissions = std::fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&path, permissions).unwrap();
        let refused = save(&path, b"two").unwrap_err();
        assert!(refused.to_string().contains("read-only"), "{refused}");
        assert_eq!(std::fs::read(&path).unwrap(), b"one");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_names_and_its_permissions() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let [path, hard, soft] = ["scene.toml", "hard.toml", "soft.toml"].map(|name| folder.path().join(name));
        save(&path, b"a long text").unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &soft).unwrap();
        for (is_linked, text) in [(false, "longer"), (true, "a link")] {
            if is_linked {
                std::fs::hard_link(&path, &hard).unwrap();
            }
            save(&soft, b"short").unwrap();
            save(&path, text.as_bytes()).unwrap();
            assert_eq!(std::fs::read_to_string(if is_linked { &hard } else { &soft }).unwrap(), text);
            assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
            assert!(std::fs::symlink_metadata(&soft).unwrap().is_symlink());
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "a temporary file remains");
        // A device is written to, and stays.
        std::os::unix::fs::symlink("/dev/full", folder.path().join("full.toml")).unwrap();
        assert!(save(&folder.path().join("full.toml"), b"lost").is_err());
        assert!(!std::fs::metadata("/dev/full").unwrap().is_file());
    }
}
