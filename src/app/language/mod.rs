//! Languages of the window. The source code is in English, and `assets/locales` has the translations. Texts are
//! translated only where they are displayed: stored and compared texts are English.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::LazyLock;

use egui::RichText;

use crate::format;
use crate::sentence::{self, Sentence};

/// Language of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
pub enum Language {
    /// English, the language of the source code.
    #[default]
    #[serde(rename = "en")]
    #[value(name = "en")]
    English,
    /// 简体中文.
    #[serde(rename = "zh")]
    #[value(name = "zh")]
    Chinese,
}

impl Language {
    /// Returns the language's name in that language.
    pub fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Chinese => "中文",
        }
    }

    /// Returns the language that the language button switches to.
    pub fn other(self) -> Self {
        match self {
            Self::English => Self::Chinese,
            Self::Chinese => Self::English,
        }
    }
}

/// Chinese texts by English texts. Tests check that the file is well formed.
static CHINESE: LazyLock<BTreeMap<String, String>> =
    LazyLock::new(|| toml::from_str(include_str!("../../../assets/locales/zh-CN.toml")).unwrap_or_default());

thread_local! {
    /// Language of the lab on this thread; tests run on threads of their own.
    static CURRENT: Cell<Language> = const { Cell::new(Language::English) };
}

/// Sets the language of this thread's texts.
pub(super) fn speak(language: Language) {
    CURRENT.set(language);
}

/// Returns the translation of a text. A text without translation, such as the name of a file, is returned unchanged.
pub(super) fn tr(english: &str) -> &str {
    match CURRENT.get() {
        Language::English => english,
        Language::Chinese => CHINESE.get(english).map_or(english, String::as_str),
    }
}

/// Renders a sentence or a text of the library in the language of the window.
pub(super) fn said<'a, T: ?Sized>(text: &'a T) -> String
where
    Sentence: From<&'a T>,
{
    Sentence::from(text).render(&tr)
}

/// Translates a sentence and inserts values for its placeholders `%{name}`, each written `name = value`, or `name` for a
/// variable of that name.
macro_rules! fill {
    ($english:expr, $($name:ident $(= $value:expr)?),+ $(,)?) => {
        $crate::app::language::filled($english, &[$(stringify!($name)),+], &[$(fill!(@text $name $($value)?)),+])
    };
    (@text $name:ident) => {
        ::std::string::ToString::to_string(&$name)
    };
    (@text $name:ident $value:expr) => {
        ::std::string::ToString::to_string(&$value)
    };
}
pub(super) use fill;

/// Translates a sentence and inserts `values` for the placeholders `names`; implementation of [`fill`].
pub(super) fn filled(english: &str, names: &[&str], values: &[String]) -> String {
    sentence::fill(tr(english), |name| names.iter().position(|own| *own == name).and_then(|i| values.get(i)).cloned())
}

/// Formats a number of things: translation of [`format::count`].
pub(super) fn count(n: impl Into<u64>, what: &str) -> String {
    let n = n.into();
    match CURRENT.get() {
        Language::English => format::count(n, what),
        Language::Chinese => filled(&format!("%{{n}} {what}"), &["n"], &[n.to_string()]),
    }
}

/// Formats a percentage: translation of [`format::percent`].
pub(super) fn percent(value: f64) -> String {
    tr(&format::percent(value)).to_owned()
}

/// Formats the relative change of an area.
pub(super) fn area_text(change: f64) -> String {
    fill!("area %{change}", change = signed_percent(change))
}

/// Formats a relative change in percent, with its sign.
pub(super) fn signed_percent(change: f64) -> String {
    let sign = if change > 0.0 { "+" } else { "\u{2212}" };
    match (1e4 * change.abs()).round() / 100.0 {
        0.0 => "0 %".to_owned(),
        size if size.is_finite() => format!("{sign}{}", percent(size)),
        _ => "\u{2013}".to_owned(),
    }
}

/// Formats the bound of an error, percent: translation of [`format::bound_percent`].
pub(super) fn bound_percent(value: f64) -> String {
    tr(&format::bound_percent(value)).to_owned()
}

/// Increases the line spacing of a text of this size, points, in Chinese, whose characters fill the line.
pub(super) fn spaced(text: RichText, size: f32) -> RichText {
    const LINE: f32 = 1.5;
    match CURRENT.get() {
        Language::English => text,
        Language::Chinese => text.line_height(Some((LINE * size).round())),
    }
}

/// Joins parts with the language's comma.
pub(super) fn joined<T: AsRef<str>>(parts: impl IntoIterator<Item = T>) -> String {
    let parts: Vec<T> = parts.into_iter().collect();
    parts.iter().map(AsRef::as_ref).collect::<Vec<&str>>().join(tr(", "))
}

/// Makes a sentence of `text`: a capital letter and a full stop.
pub(super) fn sentence(text: &str) -> String {
    if CURRENT.get() == Language::Chinese {
        return format!("{text}。");
    }
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}

#[cfg(test)]
mod tests;
