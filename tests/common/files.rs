//! Source files.

use std::path::{Path, PathBuf};

/// Returns every Rust file in a folder and the folders inside it, sorted.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    files_of(folder, "rs")
}

/// Returns every file with this extension.
pub fn files_of(folder: &Path, kind: &str) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let (folders, mut files): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| path.is_dir());
    files.retain(|file| file.extension().is_some_and(|extension| extension == kind));
    files.extend(folders.iter().flat_map(|folder| files_of(folder, kind)));
    files
}
