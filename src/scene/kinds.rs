//! Values of another kind than their key takes: a list of three numbers for a vector, a text for a table, an unknown
//! choice.

use toml::{Table, Value};

use super::Invalid;
use super::keys::{KEYS, Key, KeyKind};

/// Returns the first key, as in `--set`, whose value is of another kind than [`KEYS`] says. Numbers are checked
/// elsewhere.
pub(super) fn wrong_kind(table: &Table) -> Option<Invalid> {
    in_table(table, "", "")
}

/// Checks the keys of a table: `path` is its place in [`KEYS`], `place` the one with indices.
fn in_table(table: &Table, path: &str, place: &str) -> Option<Invalid> {
    table.iter().find_map(|(name, value)| {
        let join = |prefix: &str| if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        let (path, place) = (join(path), join(place));
        let key = KEYS.iter().find(|key| key.path == path)?;
        match (expected(key, value), value) {
            (Some(expected), _) => Some(Invalid::new(place, format!("expected {expected}, got {}", shown(value)))),
            (None, Value::Table(table)) => in_table(table, &path, &place),
            (None, Value::Array(items)) => items.iter().enumerate().find_map(|(i, item)| match item {
                Value::Table(table) => in_table(table, &path, &format!("{place}.{i}")),
                _ => None,
            }),
            (None, _) => None,
        }
    })
}

/// Returns the expected value if the given one is of another kind.
fn expected(key: &Key, value: &Value) -> Option<String> {
    let list = |what: &str| format!("{what}, as in {}", key.example);
    match (key.kind, value) {
        (KeyKind::Table, Value::Table(_)) => None,
        (KeyKind::Table, _) if key.example.is_empty() => Some(format!("a table, as in {}", example(key.path))),
        (KeyKind::Table, _) => Some(list("a table")),
        (KeyKind::Tables, Value::Array(items)) if items.iter().all(Value::is_table) => None,
        (KeyKind::Tables, _) => Some(format!("[[{}]], one for each", key.path)),
        (KeyKind::Pair(_) | KeyKind::Vector(_) | KeyKind::IntegerPair(_), Value::Array(items)) if items.len() == 2 => {
            None
        }
        (KeyKind::Pair(_) | KeyKind::Vector(_) | KeyKind::IntegerPair(_), _) => Some(list("a list of two numbers")),
        (KeyKind::Choice(known), Value::String(text)) if known.contains(&text.as_str()) => None,
        (KeyKind::Choice(known), _) => Some(one_of(known)),
        (KeyKind::Choices(known), Value::Array(items)) => {
            let is_known = |item: &Value| item.as_str().is_some_and(|text| known.contains(&text));
            (!items.iter().all(is_known)).then(|| list(&format!("a list of {}", one_of(known))))
        }
        (KeyKind::Choices(_), _) => Some(list("a list")),
        (KeyKind::Text, Value::String(_)) | (KeyKind::Number(_) | KeyKind::Integer(_), _) => None,
        (KeyKind::Text, _) => Some(list("a text")),
    }
}

/// Formats the choices: `"x" or "y"`.
fn one_of(known: &[&str]) -> String {
    let quoted: Vec<String> = known.iter().map(|text| format!("\"{text}\"")).collect();
    match quoted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => quoted.concat(),
    }
}

/// Returns a table with the examples of its keys: `{ start = 0.2, duration = 0.1 }`.
fn example(path: &str) -> String {
    let own = |key: &&Key| key.path.rsplit_once('.').is_some_and(|(table, _)| table == path);
    let name = |key: &Key| key.path.rsplit('.').next().unwrap_or_default();
    let keys: Vec<String> = KEYS.iter().filter(own).map(|key| format!("{} = {}", name(key), key.example)).collect();
    format!("{{ {} }}", keys.join(", "))
}

/// Formats a value for a message; a table by its kind.
fn shown(value: &Value) -> String {
    match value {
        Value::Table(_) => "a table".to_owned(),
        Value::Array(items) if items.iter().any(Value::is_table) => "a list of tables".to_owned(),
        value => value.to_string(),
    }
}
