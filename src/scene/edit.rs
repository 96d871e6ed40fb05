//! Edits of the text of a scene file: only values that differ are changed, so that comments, units, order and absent keys
//! stay as the user wrote them.

use toml::{Table, Value};
use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, TableLike, Value as Written};

use super::keys::{Key, KeyKind, Need};
use super::{Scene, SceneError, units};
use crate::mesh::Mesh;
use crate::model::{keys_of, name_of};

/// Byte order mark, which some editors put before a text in UTF-8.
const MARK: char = '\u{feff}';

/// Returns the text of a scene file changed so that it describes `scene`. A text that describes it already is returned as
/// it is, one that is not a scene is replaced by [`Scene::to_toml`].
///
/// # Errors
/// Same errors as [`Scene::to_toml`].
pub fn edited(text: &str, scene: &Scene) -> Result<String, SceneError> {
    let Ok(before) = Scene::from_toml(text) else { return scene.to_toml() };
    let scene = as_written(scene, &before);
    if scene == before {
        return Ok(text.to_owned());
    }
    let tables = (Table::try_from(&before), Table::try_from(&scene), text.parse::<DocumentMut>());
    let (Ok(before), Ok(after), Ok(mut document)) = tables else { return scene.to_toml() };
    edit_table(document.as_table_mut(), "", &before, &after);
    let mut edited = document.to_string();
    // The parser drops the mark at the start of a file, and the ends of lines that are not comments.
    if text.starts_with(MARK) {
        edited.insert(0, MARK);
    }
    if text.contains("\r\n") {
        edited = edited.replace("\r\n", "\n").replace('\n', "\r\n");
    }
    match Scene::from_toml(&edited) {
        Ok(read) if read == scene => Ok(edited),
        // An edit with another meaning than the scene is never returned.
        _ => scene.to_toml(),
    }
}

/// Returns the scene without what opening it has added to the text of `before`: the mesh, and its element if the text has
/// none.
fn as_written(scene: &Scene, before: &Scene) -> Scene {
    let mut scene = scene.clone();
    if let Some(mesh) = &mut scene.mesh {
        let own = mesh.text.take().and_then(|text| Mesh::gmsh_element(&text));
        if before.mesh.as_ref().is_some_and(|before| before.element.is_none()) && mesh.element == own {
            mesh.element = None;
        }
    }
    scene
}

/// Changes the keys of a table that differ between two scenes; `path` is its place in the list of keys.
fn edit_table(table: &mut dyn TableLike, path: &str, before: &Table, after: &Table) {
    for key in keys_of(path) {
        let name = name_of(key);
        // Scenes are written without some keys that have their default value.
        let default = match key.need {
            Need::Default(text) => {
                toml::from_str::<Table>(&format!("{name} = {text}")).ok().and_then(|mut t| t.remove(name))
            }
            _ => None,
        };
        let (before, after) = (before.get(name).or(default.as_ref()), after.get(name));
        if before == after.or(default.as_ref()) {
            continue;
        }
        match (table.get_mut(name), after) {
            (Some(item), Some(after)) => edit_item(item, key, before, after),
            (None, Some(after)) => {
                let mut item = match key.kind {
                    KeyKind::Table if path.is_empty() => Item::Table(toml_edit::Table::new()),
                    KeyKind::Table => Item::Value(InlineTable::new().into()),
                    KeyKind::Tables => Item::ArrayOfTables(ArrayOfTables::new()),
                    _ => Item::Value(false.into()),
                };
                edit_item(&mut item, key, None, after);
                table.insert(name, item);
            }
            (Some(item), None) => match (item.as_value_mut(), key.need) {
                (Some(value), Need::Default(default)) => replace(value, default),
                _ => _ = table.remove(name),
            },
            (None, None) => {}
        }
    }
}

fn edit_item(item: &mut Item, key: &Key, before: Option<&Value>, after: &Value) {
    match (item, before, after) {
        (Item::ArrayOfTables(tables), before, Value::Array(after)) => edit_tables(tables, key.path, before, after),
        (Item::Table(table), before, Value::Table(after)) => edit_table(table, key.path, &table_of(before), after),
        (Item::Value(value), before, after) => edit_value(value, key, before, after),
        _ => {}
    }
}

fn edit_value(value: &mut Written, key: &Key, before: Option<&Value>, after: &Value) {
    match (value, before, after) {
        (_, Some(before), after) if before == after => {}
        (Written::InlineTable(table), before, Value::Table(after)) => {
            edit_table(table, key.path, &table_of(before), after);
        }
        (Written::Array(array), Some(Value::Array(before)), Value::Array(after)) => {
            let written = std::mem::take(array);
            let mut old: Vec<Option<Written>> = written.iter().cloned().map(Some).collect();
            // The array keeps its comments and its trailing comma.
            *array = written;
            array.clear();
            // The components of a vector have their places.
            let from = match before.len() == after.len() && !after.iter().any(Value::is_table) {
                true => (0..after.len()).map(Some).collect(),
                false => predecessors(before, after),
            };
            for (from, after) in from.into_iter().zip(after) {
                match from.and_then(|i| Some((old.get_mut(i)?.take()?, before.get(i)))) {
                    Some((mut value, before)) => {
                        edit_value(&mut value, key, before, after);
                        array.push_formatted(value);
                    }
                    None => {
                        let mut value = if after.is_table() { InlineTable::new().into() } else { false.into() };
                        edit_value(&mut value, key, None, after);
                        array.push(value);
                    }
                }
            }
        }
        (value, _, Value::Float(after)) => {
            let typed = value.as_str().and_then(|typed| units::in_unit_of(typed, key.path, *after));
            match typed {
                Some(typed) => replace(value, &Value::String(typed).to_string()),
                None => replace(value, &units::toml_number(*after)),
            }
        }
        (value, _, after) => replace(value, &after.to_string()),
    }
}

/// Replaces a value by another, given as TOML, between the same spaces and comments.
fn replace(value: &mut Written, toml: &str) {
    if let Ok(mut new) = toml.parse::<Written>() {
        *new.decor_mut() = value.decor().clone();
        *value = new;
    }
}

fn edit_tables(tables: &mut ArrayOfTables, path: &str, before: Option<&Value>, after: &[Value]) {
    let before = before.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut old: Vec<Option<toml_edit::Table>> = std::mem::take(tables).into_iter().map(Some).collect();
    let mut new: Vec<toml_edit::Table> = Vec::new();
    for (from, after) in predecessors(before, after).into_iter().zip(after) {
        let known = from.and_then(|i| Some((old.get_mut(i)?.take()?, before.get(i))));
        let (mut table, before) = known.unwrap_or_default();
        edit_table(&mut table, path, &table_of(before), &table_of(Some(after)));
        new.push(table);
    }
    // A new table is printed before the next old one; without one, after the last.
    let mut next = None;
    for table in new.iter_mut().rev() {
        next = table.position().or(next);
        table.set_position(next);
    }
    tables.extend(new);
}

/// Returns for every item of `after` the number of the item of `before` that it was: an equal one, else the next of those
/// that are neither equal to another nor beyond the next equal one.
fn predecessors(before: &[Value], after: &[Value]) -> Vec<Option<usize>> {
    let mut start = 0;
    let equal = |value: &Value| {
        let found = start + before.get(start..)?.iter().position(|own| own == value)?;
        start = found + 1;
        Some(found)
    };
    let mut from: Vec<Option<usize>> = after.iter().map(equal).collect();
    let mut free = 0;
    for i in 0..from.len() {
        let end = from.iter().skip(i).flatten().next().copied().unwrap_or(before.len());
        let number = from.get_mut(i).filter(|_| free < end);
        if let Some(number) = number.filter(|number| number.is_none()) {
            *number = Some(free);
        }
        free = from.get(i).copied().flatten().map_or(free, |i| i + 1);
    }
    from
}

fn table_of(value: Option<&Value>) -> Table {
    value.and_then(Value::as_table).cloned().unwrap_or_default()
}
