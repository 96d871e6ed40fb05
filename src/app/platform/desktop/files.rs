//! Files on disk. The window has a dialog of its own to choose them.

use std::fs::File;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

pub(crate) use crate::atomic_write::{save, save_without_sync};
use crate::scene::Source;
pub(crate) use crate::scene::open;

pub(crate) fn text(source: &Source) -> Option<String> {
    source.text().ok()
}

/// Asks the browser for scene files.
pub(crate) fn choose() {}

/// Returns a file chosen in the browser or dropped on the page.
pub(crate) fn arrived() -> Option<PathBuf> {
    None
}

/// File under the first free name of its folder. It is created at once, so that no other recording and no other window
/// takes the name. Dropping it removes the file if nothing has been written to it.
pub(crate) struct NewFile(PathBuf);

impl NewFile {
    /// Creates the file under the first free name of `warpbeam-001.png`, …
    pub(crate) fn create(folder: &Path, extension: &str) -> std::io::Result<Self> {
        let create = |i| {
            let path = folder.join(format!("warpbeam-{i:03}.{extension}"));
            match File::create_new(&path) {
                Ok(_) => Ok(Self(path)),
                Err(error) => Err(Error::new(error.kind(), format!("{}: {error}", path.display()))),
            }
        };
        (2..1000).fold(create(1), |created, i| match created {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => create(i),
            other => other,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if std::fs::metadata(&self.0).is_ok_and(|file| file.len() == 0) {
            // If it cannot be removed, an empty file stays.
            let _ = std::fs::remove_file(&self.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_taken_at_once_and_free_again_if_nothing_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let create = || NewFile::create(folder, "gif").unwrap();
        let (first, second) = (create(), create());
        assert_eq!(first.path(), folder.join("warpbeam-001.gif"));
        assert_eq!(second.path(), folder.join("warpbeam-002.gif"));
        std::fs::write(second.path(), "pictures").unwrap();
        drop((first, second));
        assert_eq!(create().path(), folder.join("warpbeam-001.gif"));
        let _first = create();
        assert_eq!(create().path(), folder.join("warpbeam-003.gif"));
        let error = NewFile::create(&folder.join("none"), "gif").err().unwrap();
        assert!(error.to_string().contains("none/warpbeam-001.gif"), "{error}");
    }
}
