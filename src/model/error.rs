//! Errors of scenes, with file, line and expected value.

use std::path::PathBuf;
use std::sync::Arc;

use thiserror::Error;

/// Value that can be parsed but not used.
///
/// See [`LoadId`](crate::LoadId) for an example.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{key}: {message}")]
pub struct Invalid {
    /// Key as in `--set`: `load.0.force`.
    pub key: String,
    /// Expected and actual value.
    pub message: String,
}

impl Invalid {
    /// Returns an error for `key` with this message.
    pub fn new(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into() }
    }
}

/// Reason why the text of a scene could not be read.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// I/O error of the operating system.
    #[error("{0}")]
    System(Arc<std::io::Error>),
    /// The path is a folder or a device.
    #[error("not a file")]
    NoFile,
    /// The text is larger than the limit for scenes.
    #[error("{bytes} bytes, more than the {most} a scene may have")]
    TooLarge {
        /// Bytes read; for a stream, at most one over the limit.
        bytes: u64,
        /// The limit.
        most: u64,
    },
}

impl From<std::io::Error> for ReadError {
    fn from(error: std::io::Error) -> Self {
        Self::System(Arc::new(error))
    }
}

/// Reason why a scene could not be opened.
///
/// See [`Scene::from_toml`](crate::Scene::from_toml) for an example.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a built-in scene nor a readable file.
    #[error("{path}: {reason}; expected a scene file, or one of the built-in scenes: {built_in}", path = path.display())]
    Read {
        /// Path or name given.
        path: PathBuf,
        /// Reason why it could not be read.
        reason: ReadError,
        /// Names of the built-in scenes.
        built_in: String,
    },
    /// Not TOML, an unknown key, or a value of the wrong type.
    #[error("{}{message}", at(file.as_deref(), *line))]
    Syntax {
        /// File, or built-in name; `None` for a text without a name.
        file: Option<PathBuf>,
        /// One-based line, if the parser gave one.
        line: Option<usize>,
        /// The parser's message.
        message: String,
    },
    /// A value that cannot be used, or a missing key.
    #[error("{}{invalid}", at(file.as_deref(), *line))]
    Invalid {
        /// File, or built-in name; `None` for a text without a name.
        file: Option<PathBuf>,
        /// One-based line of the key, or of the table that lacks it; `None` if neither is written in the file.
        line: Option<usize>,
        /// Key and message.
        invalid: Invalid,
    },
    /// A `--set` that cannot be applied.
    #[error("--set {assignment}: {message}")]
    Set {
        /// The assignment as typed.
        assignment: String,
        /// Expected value.
        message: String,
    },
}

fn at(file: Option<&std::path::Path>, line: Option<usize>) -> String {
    match (file, line) {
        (Some(file), Some(line)) => format!("{}:{line}: ", file.display()),
        (Some(file), None) => format!("{}: ", file.display()),
        (None, Some(line)) => format!("line {line}: "),
        (None, None) => String::new(),
    }
}
