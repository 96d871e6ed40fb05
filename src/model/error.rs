//! What can be wrong with a scene, said with file, line and what was expected.

use std::path::PathBuf;
use std::sync::Arc;

use thiserror::Error;

/// A value that reads well but cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{key}: {message}")]
pub struct Invalid {
    /// The key, as `--set` writes it: `load.0.force`.
    pub key: String,
    /// What was expected, and what was there.
    pub message: String,
}

impl Invalid {
    /// `key` and the sentence about it.
    pub fn new(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into() }
    }
}

/// Why the text of a scene could not be read.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The system's reason.
    #[error("{0}")]
    System(Arc<std::io::Error>),
    /// A folder, or a device.
    #[error("not a file")]
    NoFile,
    /// More bytes than a scene may have.
    #[error("{bytes} bytes, more than the {most} a scene may have")]
    TooLarge {
        /// Bytes read; for a stream, no more than one over the limit.
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

/// Why a scene could not be opened.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a built-in scene nor a readable file.
    #[error("{path}: {reason}; expected a scene file, or one of the built-in scenes: {built_in}", path = path.display())]
    Read {
        /// What was asked for.
        path: PathBuf,
        /// Why it could not be read.
        reason: ReadError,
        /// The names that would have worked.
        built_in: String,
    },
    /// Not TOML, an unknown key, or a value of the wrong type.
    #[error("{}{message}", at(file.as_deref(), *line))]
    Syntax {
        /// The file, or the built-in name; `None` for a text without a name.
        file: Option<PathBuf>,
        /// One-based line, where the parser gave one.
        line: Option<usize>,
        /// The parser's sentence.
        message: String,
    },
    /// A value that cannot be used, or a missing key.
    #[error("{}{invalid}", at(file.as_deref(), *line))]
    Invalid {
        /// The file, or the built-in name; `None` for a text without a name.
        file: Option<PathBuf>,
        /// One-based line of the key, or of the table that lacks it; `None` where neither is written in the file.
        line: Option<usize>,
        /// Key and sentence.
        invalid: Invalid,
    },
    /// A `--set` that cannot be applied.
    #[error("--set {assignment}: {message}")]
    Set {
        /// As typed.
        assignment: String,
        /// What was expected.
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
