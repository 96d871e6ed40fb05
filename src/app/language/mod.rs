//! The languages of the window. The source says everything in English; `assets/locales` has the same in the others, and
//! what is shown is looked up there at the place where it is shown: what is kept and compared stays English.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::LazyLock;

use egui::RichText;

use crate::words;

mod library;

pub(super) use library::translated;

/// A language of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
pub enum Language {
    /// That of the source.
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
    /// What it calls itself.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Chinese => "中文",
        }
    }

    /// The one that the switch goes to.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::English => Self::Chinese,
            Self::Chinese => Self::English,
        }
    }

    /// A text in this language; where the catalogue does not have it, as it is.
    fn of(self, english: &str) -> &str {
        match self {
            Self::English => english,
            Self::Chinese => CHINESE.get(english).map_or(english, String::as_str),
        }
    }
}

/// The Chinese texts by the English ones. Tests see to it that the file is well formed.
static CHINESE: LazyLock<BTreeMap<String, String>> =
    LazyLock::new(|| toml::from_str(include_str!("../../../assets/locales/zh-CN.toml")).unwrap_or_default());

thread_local! {
    /// Of the lab that this thread shows: each test has a thread of its own.
    static CURRENT: Cell<Language> = const { Cell::new(Language::English) };
}

/// From here on this thread's texts are in this language.
pub(super) fn speak(language: Language) {
    CURRENT.set(language);
}

/// What is shown for a text. One that has no translation, such as the name of a file, is shown as it is.
pub(super) fn tr(english: &str) -> &str {
    CURRENT.get().of(english)
}

/// What is shown for a sentence with values in its places, `%{name}` each.
macro_rules! fill {
    ($english:literal, $($name:ident = $value:expr),+ $(,)?) => {
        $crate::app::language::filled($english, &[$(stringify!($name)),+], &[$(::std::string::ToString::to_string(&$value)),+])
    };
}
pub(super) use fill;

/// A sentence with its values; [`fill`] names them.
pub(super) fn filled(english: &str, names: &[&str], values: &[String]) -> String {
    let mut parts = tr(english).split("%{");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, after) = part.split_once('}').unwrap_or(("", part));
        let value = names.iter().position(|own| *own == name).and_then(|i| values.get(i));
        text.push_str(value.map_or("", String::as_str));
        text.push_str(after);
    }
    text
}

/// A number of things: [`words::count`].
pub(super) fn count(n: impl Into<u64>, what: &str) -> String {
    let n = n.into();
    match CURRENT.get() {
        Language::English => words::count(n, what),
        Language::Chinese => filled(&format!("%{{n}} {what}"), &["n"], &[n.to_string()]),
    }
}

/// An error or a share: [`words::percent`].
pub(super) fn percent(value: f64) -> String {
    tr(&words::percent(value)).to_owned()
}

/// A text of this size, points, with room between its lines: Han letters fill theirs.
pub(super) fn spaced(text: RichText, size: f32) -> RichText {
    const LINE: f32 = 1.5;
    match CURRENT.get() {
        Language::English => text,
        Language::Chinese => text.line_height(Some((LINE * size).round())),
    }
}

/// Several things in a row.
pub(super) fn joined<T: AsRef<str>>(parts: impl IntoIterator<Item = T>) -> String {
    let parts: Vec<T> = parts.into_iter().collect();
    parts.iter().map(AsRef::as_ref).collect::<Vec<&str>>().join(tr(", "))
}

/// With a capital and a full stop.
pub(super) fn sentence(words: &str) -> String {
    if CURRENT.get() == Language::Chinese {
        return format!("{words}。");
    }
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}
