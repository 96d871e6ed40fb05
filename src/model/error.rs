//! Errors of scenes, with file, line and expected value.

use std::path::PathBuf;

use thiserror::Error;

use crate::sentence::Sentence;

/// Value that can be parsed but not used.
///
/// ```
/// use warpbeam::{Invalid, Scene};
///
/// let mut scene = Scene::beam(10.0, 1.0).clamp("left").moment("right", 5.0);
/// let invalid: Invalid = scene.set_force(0, [0.0, -1.0]).unwrap_err();
/// assert_eq!(invalid.key, "load.0");
/// assert_eq!(invalid.message(), "expected a load of kind \"force\", got a moment");
/// ```
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}", Sentence::from(self))]
pub struct Invalid {
    /// Key as in `--set`: `load.0.force`.
    pub key: String,
    pub(crate) message: Sentence,
}

impl Invalid {
    /// Returns an error for `key` with this message.
    pub fn new(key: impl Into<String>, message: impl Into<Sentence>) -> Self {
        Self { key: key.into(), message: message.into() }
    }

    /// Returns the expected and the actual value.
    pub fn message(&self) -> String {
        self.message.to_string()
    }
}

impl From<&Invalid> for Sentence {
    fn from(Invalid { key, message }: &Invalid) -> Self {
        Self::located(key.as_str(), message.clone())
    }
}

/// Reason why a scene could not be opened.
///
/// ```
/// use warpbeam::{Scene, SceneError};
///
/// let advice = match Scene::from_toml("name = \"Beam\"\nlength = 10.0").unwrap_err() {
///     SceneError::Syntax { line: Some(line), .. } | SceneError::Invalid { line: Some(line), .. } => {
///         format!("edit line {line}")
///     }
///     other => other.to_string(),
/// };
/// assert_eq!(advice, "edit line 2"); // `length` belongs to the table [beam]
/// ```
#[derive(Debug, Error)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a built-in scene nor a readable file.
    Read {
        /// Path or name given.
        path: PathBuf,
        /// Reason why it could not be read, and the names of the built-in scenes.
        message: String,
    },
    /// Not TOML, an unknown key, or a value of the wrong type.
    Syntax {
        /// File, or built-in name; `None` for a text without a name.
        file: Option<PathBuf>,
        /// One-based line, if the parser gave one.
        line: Option<usize>,
        /// The parser's message.
        message: String,
    },
    /// A value that cannot be used, or a missing key.
    Invalid {
        /// File, or built-in name; `None` for a text without a name.
        file: Option<PathBuf>,
        /// One-based line of the key, or of the table that lacks it; `None` if neither is written in the file.
        line: Option<usize>,
        /// Key and message.
        invalid: Invalid,
    },
    /// A `--set` that cannot be applied.
    Set {
        /// The assignment as typed.
        assignment: String,
        /// Expected value.
        message: String,
    },
}

impl From<&SceneError> for Sentence {
    fn from(error: &SceneError) -> Self {
        let (place, message) = match error {
            SceneError::Read { path, message } => (Some(path.display().to_string()), message.as_str().into()),
            SceneError::Syntax { file, line, message } => (at(file.as_deref(), *line), message.as_str().into()),
            SceneError::Invalid { file, line, invalid } => (at(file.as_deref(), *line), invalid.into()),
            SceneError::Set { assignment, message } => (Some(format!("--set {assignment}")), message.as_str().into()),
        };
        match place {
            Some(place) => Self::located(place, message),
            None => message,
        }
    }
}

fn at(file: Option<&std::path::Path>, line: Option<usize>) -> Option<String> {
    let file = file.map(|file| file.display().to_string());
    match (file, line) {
        (Some(file), Some(line)) => Some(format!("{file}:{line}")),
        (None, Some(line)) => Some(format!("line {line}")),
        (file, None) => file,
    }
}
