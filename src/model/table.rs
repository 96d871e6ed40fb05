//! Tables of a scene against the list of keys: kinds and ranges of their values, and keys that are missing.

use toml::{Table, Value};

use super::error::Invalid;
use super::keys::{KEYS, Key, KeyKind, Need};
use super::units;
use crate::sentence::{Sentence, sentence};

/// Adds a table and those in it, each after the one that contains it, in the order of [`KEYS`], with its place there and
/// the one with indices.
fn collect<'a>(
    table: &'a Table,
    parent: &'static str,
    place: &str,
    tables: &mut Vec<(&'a Table, &'static str, String)>,
) {
    tables.push((table, parent, place.to_owned()));
    for key in keys_of(parent) {
        let name = name_of(key);
        match table.get(name) {
            Some(Value::Table(table)) => collect(table, key.path, &format!("{place}{name}."), tables),
            Some(Value::Array(items)) => {
                let inner = items.iter().enumerate().filter_map(|(i, item)| Some((i, item.as_table()?)));
                inner.for_each(|(i, table)| collect(table, key.path, &format!("{place}{name}.{i}."), tables));
            }
            _ => {}
        }
    }
}

/// Checks that every key of a scene is in [`KEYS`], and its value of the kind and in the range that are said there. The
/// parser checks the types of numbers.
///
/// # Errors
/// The first other key, as in `--set`, or key with another value.
pub(crate) fn check(scene: &Table) -> Result<(), Invalid> {
    let mut tables = Vec::new();
    collect(scene, "", "", &mut tables);
    let mut values = tables.iter().flat_map(|(table, parent, place)| table.iter().map(move |v| (v, *parent, place)));
    values.try_for_each(|((name, value), parent, place)| {
        let invalid = |message: Sentence| Invalid::new(format!("{place}{name}"), message);
        let Some(key) = keys_of(parent).find(|key| name_of(key) == name) else {
            let known: Vec<&str> = keys_of(parent).map(name_of).collect();
            return Err(invalid(format!("unknown key, expected one of {}", known.join(", ")).into()));
        };
        let checked = match expected(key, value) {
            Some(expected) => Err(format!("expected {expected}, got {}", shown(value)).into()),
            None => check_range(key.kind, value),
        };
        checked.map_err(invalid)
    })
}

/// Checks that no table of a scene lacks a key that it needs.
///
/// # Errors
/// The first missing key, as in `--set`; those of the scene itself come last.
pub(crate) fn check_required(scene: &Table) -> Result<(), Invalid> {
    let mut tables = Vec::new();
    collect(scene, "", "", &mut tables);
    tables.rotate_left(1);
    tables.iter().flat_map(|placed| keys_of(placed.1).map(move |key| (placed, key))).try_for_each(
        |((table, _, place), key)| match key.need {
            Need::Required(description) if !table.contains_key(name_of(key)) => {
                let expected = units::quantity_of(key.path).unwrap_or_else(|| description.into());
                let message = sentence!("expected %{what}, got nothing", what = expected);
                Err(Invalid::new(format!("{place}{}", name_of(key)), message))
            }
            _ => Ok(()),
        },
    )
}

/// Checks the numbers of a value, of a vector its length.
fn check_range(kind: KeyKind, value: &Value) -> Result<(), Sentence> {
    let items = value.as_array().map_or(std::slice::from_ref(value), Vec::as_slice);
    let mut numbers = items.iter().filter_map(|value| value.as_float().or(value.as_integer().map(|n| n as f64)));
    match kind {
        KeyKind::Vector(limit) => limit.check(numbers.fold(0.0, f64::hypot)),
        KeyKind::Number(limit) | KeyKind::Pair(limit) | KeyKind::Integer(limit) | KeyKind::IntegerPair(limit) => {
            numbers.try_for_each(|number| limit.check(number))
        }
        _ => Ok(()),
    }
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
    let keys: Vec<String> = keys_of(path).map(|key| format!("{} = {}", name_of(key), key.example)).collect();
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

/// Returns the keys of a table by its place, which is empty for the scene.
pub(crate) fn keys_of(path: &str) -> impl Iterator<Item = &'static Key> {
    KEYS.iter().filter(move |key| key.path.rsplit_once('.').map_or("", |(table, _)| table) == path)
}

/// Returns the name of a key in its table.
pub(crate) fn name_of(key: &Key) -> &'static str {
    key.path.rsplit_once('.').map_or(key.path, |(_, name)| name)
}
