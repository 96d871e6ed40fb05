//! Keys that a scene cannot do without, and what is expected there.

use toml::{Table, Value};

use super::{Invalid, units};

/// Every key that has no default, without its places in lists, and in words what it holds where that is no number in a
/// unit. The parser looks for the scene's own last.
const KEYS: &[(&str, &str)] = &[
    ("beam.length", ""),
    ("beam.height", ""),
    ("beam.cells", "the cells along and across, as in [20, 2]"),
    ("mesh.file", "the name of a mesh file"),
    ("material.young", ""),
    ("material.poisson", ""),
    ("support.fix", "the directions it fixes, as in [\"x\", \"y\"]"),
    ("load.kind", "one of \"force\", \"gravity\", \"moment\""),
    ("load.pulse.start", ""),
    ("load.pulse.duration", ""),
    ("probe.name", "what it is called in results"),
    ("name", "a title"),
    ("material", "the table [material]"),
];

/// What is missing where the parser complains of a field that is.
pub(super) fn missing(complaint: &str, table: Option<Table>) -> Option<Invalid> {
    let field = complaint.strip_prefix("missing field `")?.strip_suffix('`')?;
    let scene = Value::Table(table?);
    KEYS.iter().filter(|(key, _)| key.rsplit('.').next() == Some(field)).find_map(|(key, words)| {
        let parts: Vec<&str> = key.split('.').collect();
        let place = place_without(&scene, &parts)?;
        let expected = units::quantity_of(key).map_or_else(|| (*words).to_owned(), |quantity| quantity.to_string());
        Some(Invalid::new(place, format!("expected {expected}, got nothing")))
    })
}

/// The first place, as `--set` writes it, where a key is not written though the table that has it is.
fn place_without(value: &Value, key: &[&str]) -> Option<String> {
    match (value, key) {
        (Value::Array(items), _) => {
            items.iter().enumerate().find_map(|(i, item)| Some(format!("{i}.{}", place_without(item, key)?)))
        }
        (Value::Table(table), [last]) => (!table.contains_key(*last)).then(|| (*last).to_owned()),
        (Value::Table(table), [first, rest @ ..]) => {
            Some(format!("{first}.{}", place_without(table.get(*first)?, rest)?))
        }
        _ => None,
    }
}
