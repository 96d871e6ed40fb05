//! Names of downloads.

use std::path::{Path, PathBuf};

/// Name of a download. A page has no folder: the browser changes a name that is taken.
#[derive(Debug)]
pub(crate) struct NewFile(PathBuf);

impl NewFile {
    /// Returns the name of a download.
    pub(crate) fn create(_: &Path, extension: &str) -> std::io::Result<Self> {
        Ok(Self(format!("warpbeam-001.{extension}").into()))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}
