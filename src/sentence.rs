//! Sentences with their parts: the library's errors and results in words, which the window shows in other languages.

use std::borrow::Cow;
use std::fmt::{Display, Formatter, Result};

/// Sentence with its parts: `Display` renders it in English, [`Self::render`] in another language. A plain text has no
/// parts.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sentence {
    /// English text with a placeholder `%{name}` for every part.
    pattern: Cow<'static, str>,
    parts: Vec<(Cow<'static, str>, Sentence)>,
}

/// Makes a [`Sentence`] of a pattern and its parts, each written `name = value`, or `name` for a variable of that name.
/// `tests/window/language.rs` checks that every pattern is translated.
macro_rules! sentence {
    ($pattern:literal $(, $name:ident $(= $value:expr)?)* $(,)?) => {
        $crate::sentence::Sentence::new($pattern, [$((stringify!($name), sentence!(@part $name $($value)?))),*])
    };
    (@part $name:ident) => {
        $crate::sentence::Sentence::from($name)
    };
    (@part $name:ident $value:expr) => {
        $crate::sentence::Sentence::from($value)
    };
}
pub(crate) use sentence;

/// Implements `Display` by the English sentence.
macro_rules! displayed {
    ($($type:ty),+) => {
        $(impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(&$crate::sentence::Sentence::from(self), f)
            }
        })+
    };
}
pub(crate) use displayed;

impl Sentence {
    /// Returns a sentence with these parts; implementation of `sentence!`.
    pub(crate) fn new<const N: usize>(pattern: impl Into<Cow<'static, str>>, parts: [(&'static str, Self); N]) -> Self {
        Self { pattern: pattern.into(), parts: parts.map(|(name, part)| (name.into(), part)).into() }
    }

    /// Returns a count with its noun: `2 iterations`.
    pub(crate) fn count(n: u32, noun: &str) -> Self {
        Self::new(format!("%{{n}} {noun}{}", if n == 1 { "" } else { "s" }), [("n", n.into())])
    }

    /// Returns a message with its place before it: `beam.length: expected …`.
    pub(crate) fn located(place: impl Into<Self>, message: impl Into<Self>) -> Self {
        sentence!("%{key}: %{message}", key = place.into(), message = message.into())
    }

    /// Returns `true` for an empty text.
    pub fn is_empty(&self) -> bool {
        self.pattern.is_empty()
    }

    /// Renders the sentence; `tr` translates the patterns and the plain texts.
    pub fn render(&self, tr: &dyn Fn(&str) -> &str) -> String {
        let pattern = tr(&self.pattern);
        if self.parts.is_empty() {
            return pattern.to_owned();
        }
        fill(pattern, |name| Some(self.parts.iter().find(|part| part.0 == name)?.1.render(tr)))
    }
}

impl Display for Sentence {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(&self.render(&|english| english))
    }
}

impl From<&Self> for Sentence {
    fn from(sentence: &Self) -> Self {
        sentence.clone()
    }
}

macro_rules! texts {
    ($($type:ty),+) => {
        $(impl From<$type> for Sentence {
            fn from(text: $type) -> Self {
                Self::new(text.to_string(), [])
            }
        })+
    };
}
texts!(&str, String, &String, u32, &u32, usize, &usize, &f64);

/// Replaces every placeholder `%{name}` of a pattern by its value.
pub(crate) fn fill(pattern: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut parts = pattern.split("%{");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, after) = part.split_once('}').unwrap_or(("", part));
        text.push_str(&value(name).unwrap_or_default());
        text.push_str(after);
    }
    text
}
