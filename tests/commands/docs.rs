//! Tests of the documents: links and anchors lead somewhere, the reference and the JSON Schema are those of the program.
//!
//! `UPDATE_DOCS=1 cargo test --test commands docs` rewrites the generated parts: `assets/scene.schema.json`, and in the documents
//! the text between `<!-- generated: NAME -->` and `<!-- end -->`.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::common::files::{files_of, rust_files};
use crate::common::*;
use serde_json::{Value, json};
use warpbeam::scene::keys::{KEYS, Key, KeyKind, Need};
use warpbeam::scene::limits::Limit;

// Links.

/// Returns every document, sorted.
fn documents() -> Vec<PathBuf> {
    let mut files = files_of(Path::new("docs"), "md");
    files.extend(["README.md", "README.zh-CN.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(PathBuf::from));
    files
}

/// Link of a document: its text and its target.
struct Link {
    text: String,
    target: String,
}

/// Returns the lines of a document without code blocks.
fn prose(text: &str) -> Vec<&str> {
    let mut in_block = false;
    let outside = |line: &&str| {
        let fence = line.trim_start().starts_with("```");
        in_block ^= fence;
        !in_block && !fence
    };
    text.lines().filter(outside).collect()
}

/// Returns the links and images of a document, and the sources of its `<img>` and `<source>`.
fn links(text: &str) -> Vec<Link> {
    let text = prose(text).join("\n");
    let mut links = Vec::new();
    for (at, _) in text.match_indices("](") {
        let begin = text[..at].rfind('[').unwrap_or(at);
        // DOIs contain pairs of brackets.
        let (mut depth, mut end) = (1, at + 2);
        for c in text[end..].chars() {
            depth += i32::from(c == '(') - i32::from(c == ')');
            if depth == 0 {
                break;
            }
            end += c.len_utf8();
        }
        links.push(Link { text: text[begin + 1..at].to_owned(), target: text[at + 2..end].to_owned() });
    }
    for attribute in ["src=\"", "srcset=\""] {
        for part in text.split(attribute).skip(1) {
            let target = part.split('"').next().unwrap_or_default().to_owned();
            links.push(Link { text: String::new(), target });
        }
    }
    links
}

/// Returns the anchors of the headings of a document, as GitHub makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).into_iter().filter(|line| line.starts_with('#'));
    let slug = |heading: &str| {
        let heading = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(slug).collect()
}

/// Outward links are secure and complete.
#[test]
fn no_link_or_anchor_of_the_documents_is_broken() {
    let mut broken = Vec::new();
    for file in documents() {
        let text = std::fs::read_to_string(&file).unwrap();
        for Link { target, .. } in links(&text) {
            if target.contains("://") {
                let rest = target.strip_prefix("https://").unwrap_or_default();
                let host = rest.split('/').next().unwrap_or_default();
                assert!(host.contains('.') && !rest.contains(char::is_whitespace), "{}: {target}", file.display());
                continue;
            }
            let (path, anchor) = target.split_once('#').map_or((target.as_str(), None), |(p, a)| (p, Some(a)));
            let to = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
            let leads = match anchor {
                None => to.exists(),
                Some(anchor) => std::fs::read_to_string(&to).is_ok_and(|text| anchors(&text).contains(anchor)),
            };
            if !leads {
                broken.push(format!("{}: {target}", file.display()));
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

#[test]
fn links_and_anchors_are_read() {
    let text = "# A `b` (c): d-e\n\n[x](a.md#b) ![y](<p.svg>)\n```text\n[no](no.md)\n```\n[d](https://e.org/1(2)3) <img src=\"q.png\">";
    let targets: Vec<_> = links(text).into_iter().map(|link| link.target).collect();
    assert_eq!(targets, ["a.md#b", "<p.svg>", "https://e.org/1(2)3", "q.png"]);
    assert_eq!(anchors(text), BTreeSet::from(["a-b-c-d-e".to_owned()]));
}

/// A link whose text is a name of the code, such as `` [`polar`](../../src/rotation.rs) ``, leads to its definition.
#[test]
fn every_link_to_code_leads_to_a_definition() {
    let mut count = 0;
    for file in documents() {
        for Link { text, target } in links(&std::fs::read_to_string(&file).unwrap()) {
            let name = text.strip_prefix('`').and_then(|text| text.strip_suffix('`'));
            let (Some(name), true) = (name, target.ends_with(".rs")) else { continue };
            let Some(name) = name.rsplit("::").next().filter(|name| !name.contains(['/', '.'])) else { continue };
            let code = std::fs::read_to_string(file.parent().unwrap().join(&target)).unwrap_or_default();
            let defined = ["fn", "struct", "enum", "trait", "const", "static"].iter().any(|kind| {
                code.match_indices(&format!("{kind} {name}"))
                    .any(|(at, found)| !code[at + found.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_'))
            });
            assert!(defined, "{}: no definition of `{name}` in {target}", file.display());
            count += 1;
        }
    }
    assert!(count >= 20, "{count} links to code");
}

#[test]
fn the_map_names_every_page_and_the_readmes_link_outwards() {
    let map = std::fs::read_to_string("docs/README.md").unwrap();
    let listed: BTreeSet<_> = links(&map).into_iter().map(|link| link.target).collect();
    for file in files_of(Path::new("docs"), "md") {
        let name = file.strip_prefix("docs").unwrap().to_str().unwrap();
        assert!(name == "README.md" || listed.contains(name), "docs/README.md does not name {name}");
    }
    for file in ["README.md", "README.zh-CN.md"] {
        let text = std::fs::read_to_string(file).unwrap();
        assert!(text.len() <= 6500, "{file} has {} bytes", text.len());
        let outward = links(&text).iter().filter(|link| link.target.starts_with("https://")).count();
        assert!(outward >= 6, "{file} has {outward} outward links");
    }
}

// Generated parts.

/// Compares a generated part of a document with the document; with `UPDATE_DOCS=1`, replaces it.
fn check_part(file: &str, name: &str, expected: &str) {
    let text = std::fs::read_to_string(file).unwrap();
    let begin = format!("<!-- generated: {name} -->\n");
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("{file}: no {begin}"));
    let (part, after) = rest.split_once("<!-- end -->").unwrap();
    let expected = format!("\n{expected}\n");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(file, format!("{before}{begin}{expected}<!-- end -->{after}")).unwrap();
        return;
    }
    let first = part.lines().zip(expected.lines()).find(|(old, new)| old != new);
    assert!(part == expected, "{file} is not that of the program, from {first:#?} on: UPDATE_DOCS=1 rewrites it");
}

// Keys of a scene.

/// Scene at rest with every kind of load, support, probe and section.
const AT_REST: &str = include_str!("../data/files/at-rest.toml");

/// Returns a scene that has the table of a key, and the place of the key in it.
fn scene_for(key: &Key) -> (toml::Table, Vec<String>) {
    let mut table: toml::Table = toml::from_str(AT_REST).unwrap();
    let first = key.path.split('.').next().unwrap();
    if first == "mesh" {
        table.remove("beam");
        table.insert("mesh".to_owned(), toml::from_str::<toml::Table>("file = \"a.msh\"").unwrap().into());
    }
    if ["dynamics", "start"].contains(&first) || key.path.starts_with("load.pulse") {
        table.insert("analysis".to_owned(), "dynamic".into());
        let pulse: toml::Table = toml::from_str("start = 0.0\nduration = 1.0").unwrap();
        let load = &mut table["load"].as_array_mut().unwrap()[0];
        load.as_table_mut().unwrap().insert("pulse".to_owned(), pulse.into());
    }
    let index = match key.path {
        "support.at" | "support.acts_on" | "support.width" | "probe.at" | "load.at" | "load.acts_on" | "load.width" => {
            "1"
        }
        "load.acceleration" => "2",
        "load.moment" => "3",
        _ => "0",
    };
    let mut place: Vec<String> = key.path.split('.').map(str::to_owned).collect();
    if ["support", "load", "probe", "section"].contains(&first) && place.len() > 1 {
        place.insert(1, index.to_owned());
    }
    (table, place)
}

/// Reads the scene of a key with this value for the key, as written in a file; `None` leaves the key out.
fn read_with(key: &Key, value: Option<&str>) -> Result<Scene, String> {
    let (mut table, place) = scene_for(key);
    let mut at = &mut table;
    for part in place.split_last().unwrap().1.chunk_by(|_, next| next.parse::<usize>().is_ok()) {
        let inner = at.entry(part[0].clone()).or_insert_with(|| toml::Table::new().into());
        at = match part {
            [_, index] => inner[index.parse::<usize>().unwrap()].as_table_mut().unwrap(),
            _ => inner.as_table_mut().unwrap(),
        };
    }
    let name = place.last().unwrap();
    match value {
        Some(value) => {
            _ = at.insert(name.clone(), toml::from_str::<toml::Table>(&format!("v = {value}")).unwrap()["v"].clone())
        }
        None => _ = at.remove(name),
    }
    Scene::from_toml(&toml::to_string(&table).unwrap()).map_err(|error| error.to_string())
}

/// Returns a value that the key does not accept, as written in a file.
fn unacceptable(key: &Key) -> Option<String> {
    let beyond = |limit: Limit| format!("{:?}", if limit.max == 0.0 { 1.0 } else { 10.0 * limit.max });
    let whole = |limit: Limit| format!("{}", 10.0 * limit.max);
    Some(match key.kind {
        KeyKind::Table | KeyKind::Tables => return None,
        KeyKind::Text => "1".to_owned(),
        KeyKind::Choice(_) => "\"other\"".to_owned(),
        KeyKind::Choices(_) => "[\"z\"]".to_owned(),
        KeyKind::Number(limit) => beyond(limit),
        KeyKind::Pair(limit) | KeyKind::Vector(limit) => format!("[{}, 0.0]", beyond(limit)),
        KeyKind::Integer(limit) => whole(limit),
        KeyKind::IntegerPair(limit) => format!("[{}, 1]", whole(limit)),
    })
}

/// Returns the message about a value that the key does not accept, without its place in the file.
fn refusal(key: &Key) -> Option<String> {
    let value = unacceptable(key)?;
    let Err(message) = read_with(key, Some(&value)) else { panic!("{} = {value} is accepted", key.path) };
    let message = message.split_once(": ").map_or(message.as_str(), |(place, rest)| {
        if place.starts_with("line") || place.contains('`') { rest } else { &message }
    });
    Some(message.to_owned())
}

#[test]
fn every_example_and_every_default_of_a_key_is_right() {
    for key in KEYS {
        if !key.example.is_empty() {
            let read = read_with(key, Some(key.example));
            assert!(read.is_ok(), "{} = {}: {read:?}", key.path, key.example);
        }
        if let KeyKind::Choice(known) = key.kind {
            let reads =
                |value: &&&str| !read_with(key, Some(&format!("\"{value}\""))).is_err_and(|e| e.contains("variant"));
            assert!(known.iter().all(|value| reads(&value)), "{}: {known:?}", key.path);
        }
        let left_out = read_with(key, None);
        match key.need {
            // A scene file can leave out a whole list of tables.
            Need::Default(value) if key.kind != KeyKind::Tables => {
                assert_eq!(left_out, read_with(key, Some(value)), "{} is {value} by default", key.path);
            }
            Need::Required(_) => assert!(left_out.is_err(), "{} can be left out", key.path),
            _ => {}
        }
        refusal(key);
    }
}

/// Returns a number in the shortest form.
fn short(value: f64) -> String {
    let text =
        if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) { format!("{value:e}") } else { value.to_string() };
    text.replace('-', "−")
}

fn range(limit: Limit) -> String {
    let unit = if limit.unit.is_empty() { String::new() } else { format!(" {}", limit.unit) };
    format!("{} to {}{unit}", short(limit.min), short(limit.max))
}

fn described(kind: KeyKind) -> String {
    let choices = |all: &[&str]| all.iter().map(|text| format!("`\"{text}\"`")).collect::<Vec<_>>().join(", ");
    match kind {
        KeyKind::Table => "table".to_owned(),
        KeyKind::Tables => "tables".to_owned(),
        KeyKind::Text => "text".to_owned(),
        KeyKind::Choice(all) => format!("one of {}", choices(all)),
        KeyKind::Choices(all) => format!("list of {}", choices(all)),
        KeyKind::Number(limit) => format!("number, {}", range(limit)),
        KeyKind::Pair(limit) => format!("[x, y], each {}", range(limit)),
        KeyKind::Vector(limit) => format!("[x, y], its length {}", range(limit)),
        KeyKind::Integer(limit) => format!("integer, {}", range(limit)),
        KeyKind::IntegerPair(limit) => format!("two integers, each {}", range(limit)),
    }
}

/// Returns the reference of the keys, a section for each table.
fn reference_of_keys() -> String {
    let mut text = String::new();
    let row = |key: &Key, name: &str| {
        let need = match key.need {
            Need::Required(_) => "required".to_owned(),
            Need::Default(value) => format!("`{value}`"),
            Need::Optional(when) => when.to_owned(),
        };
        let refused = refusal(key).unwrap_or_default();
        let about = key.about.replace('|', "\\|");
        let example = if key.example.is_empty() { name.to_owned() } else { format!("{name} = {}", key.example) };
        format!("| `{example}` | {} | {need} | {about} | {refused} |\n", described(key.kind))
    };
    let head = "\n| key, with an example | value | if left out | meaning | message about a wrong value |\n|---|---|---|---|---|\n";
    let top = |key: &&Key| !key.path.contains('.');
    let is_table = |key: &Key| matches!(key.kind, KeyKind::Table | KeyKind::Tables);
    let _ = write!(text, "## The scene itself\n\nKeys before the first table.\n{head}");
    for key in KEYS.iter().filter(top).filter(|key| !is_table(key)) {
        text.push_str(&row(key, key.path));
    }
    for table in KEYS.iter().filter(top).filter(|key| is_table(key)) {
        let brackets = if table.kind == KeyKind::Tables { ["[[", "]]"] } else { ["[", "]"] };
        let need = match table.need {
            Need::Required(_) => "Required",
            Need::Default(_) => "Optional",
            Need::Optional(when) => when,
        };
        let [open, close] = brackets;
        let _ = write!(text, "\n## {open}{}{close}\n\n{} {need}.\n{head}", table.path, table.about);
        for key in KEYS {
            if let Some(name) = key.path.strip_prefix(&format!("{}.", table.path)) {
                text.push_str(&row(key, name));
            }
        }
    }
    text
}

#[test]
fn generated_parts_are_current() {
    check_part("docs/reference/scene-file.md", "keys", &reference_of_keys());
    let mut text = String::from("| command | does | options |\n|---|---|---|\n");
    for command in warpbeam::cli::command().get_subcommands() {
        let about = command.get_about().unwrap().to_string();
        let long = command.get_arguments().filter_map(|argument| Some(format!("`--{}`", argument.get_long()?)));
        let options = long.collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "| `{}` | {} | {options} |", command.get_name(), about.split(". ").next().unwrap());
    }
    check_part("docs/reference/commands.md", "commands", text.trim_end());
    let mut text = String::from("| scene | | |\n|---|---|---|\n");
    for id in scene_ids() {
        let scene = scene(id);
        let _ = writeln!(text, "| `{id}` | ![{}](../../assets/scenes/{id}.png) | {} |", scene.name, scene.about);
    }
    check_part("docs/guide/gallery.md", "gallery", text.trim_end());
}

/// Scenes in the documents are read; pieces of a scene are read as part of one.
#[test]
fn every_scene_in_the_documents_is_read() {
    const WHOLE: &str = "[beam]\nlength = 10.0\nheight = 1.0\ncells = [20, 2]\n[material]\nyoung = 1e6\npoisson = 0.3\n\
        [[support]]\nedge = \"left\"\nfix = [\"x\", \"y\"]\n";
    let mut count = 0;
    for file in files_of(Path::new("docs"), "md") {
        let text = std::fs::read_to_string(&file).unwrap();
        for block in text.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap_or_default()) {
            let tables = block.find("\n[").map_or(0, |at| at + 1);
            let (keys, tables) = block.split_at(if block.starts_with('[') { 0 } else { tables });
            let name = if keys.contains("name =") { "" } else { "name = \"A\"\n" };
            let moves = if block.contains("pulse =") { "analysis = \"dynamic\"\n" } else { "" };
            let rest = if ["[beam]", "[mesh]"].iter().any(|table| block.contains(table)) { "" } else { WHOLE };
            if block.starts_with("#:schema") {
                continue;
            }
            let scene = Scene::from_toml(&format!("{name}{moves}{keys}{rest}{tables}"));
            assert!(scene.is_ok(), "{}: {:?}\n{block}", file.display(), scene.err());
            count += 1;
        }
    }
    assert!(count >= 8, "{count} scenes");
}

// JSON Schema.

/// Returns a value of a scene file as JSON.
fn as_json(toml: &str) -> Value {
    let value = toml::from_str::<toml::Table>(&format!("v = {toml}")).unwrap()["v"].clone();
    serde_json::to_value(value).unwrap()
}

/// Returns the schema of a number, or of a text with a unit.
fn number_schema(limit: Limit) -> Value {
    json!({ "anyOf": [
        { "type": "number", "minimum": limit.min, "maximum": limit.max },
        { "type": "string", "pattern": "^\\s*[-+−]?[0-9.]" },
    ] })
}

fn pair_schema(items: Value) -> Value {
    json!({ "type": "array", "items": items, "minItems": 2, "maxItems": 2 })
}

/// Returns the schema of a key with the keys inside it.
fn schema_of(key: &Key) -> Value {
    let mut schema = match key.kind {
        KeyKind::Table => table_schema(key.path),
        KeyKind::Tables => json!({ "type": "array", "items": table_schema(key.path) }),
        KeyKind::Text => json!({ "type": "string" }),
        KeyKind::Choice(all) => json!({ "enum": all }),
        KeyKind::Choices(all) => json!({ "type": "array", "items": { "enum": all }, "minItems": 1 }),
        KeyKind::Number(limit) => number_schema(limit),
        KeyKind::Pair(limit) => pair_schema(number_schema(limit)),
        KeyKind::Vector(limit) => pair_schema(number_schema(Limit { min: -limit.max, ..limit })),
        KeyKind::Integer(limit) => {
            json!({ "type": "integer", "minimum": limit.min as i64, "maximum": limit.max as i64 })
        }
        KeyKind::IntegerPair(limit) => {
            pair_schema(json!({ "type": "integer", "minimum": limit.min as i64, "maximum": limit.max as i64 }))
        }
    };
    let unit = key.kind.quantity().map_or("", |limit| limit.unit);
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    schema["description"] = json!(format!("{}{unit}", key.about));
    if let Need::Default(value) = key.need {
        schema["default"] = as_json(value);
    }
    schema
}

/// Returns the schema of a table; an empty path is the scene.
fn table_schema(path: &str) -> Value {
    let prefix = if path.is_empty() { String::new() } else { format!("{path}.") };
    let inner = |key: &&Key| key.path.strip_prefix(&prefix).is_some_and(|name| !name.contains('.'));
    let name = |key: &Key| key.path[prefix.len()..].to_owned();
    let keys: Vec<&Key> = KEYS.iter().filter(inner).collect();
    let properties: serde_json::Map<_, _> = keys.iter().map(|key| (name(key), schema_of(key))).collect();
    let required: Vec<_> =
        keys.iter().filter(|key| matches!(key.need, Need::Required(_))).map(|key| name(key)).collect();
    let mut schema = json!({ "type": "object", "additionalProperties": false, "properties": properties });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    let one_of = |names: [&str; 2]| json!(names.map(|name| json!({ "required": [name] })));
    match path {
        "" => schema["oneOf"] = one_of(["beam", "mesh"]),
        "support" | "probe" => schema["oneOf"] = one_of(["edge", "at"]),
        "load" => {
            schema["oneOf"] = json!([
                { "properties": { "kind": { "enum": ["force"] } }, "required": ["force"], "oneOf": one_of(["edge", "at"]) },
                { "properties": { "kind": { "enum": ["gravity"] } }, "required": ["acceleration"] },
                { "properties": { "kind": { "enum": ["moment"] } }, "required": ["edge", "moment"] },
            ]);
        }
        _ => {}
    }
    schema
}

/// Returns `true` if the value fits the schema; knows the words that the schema of scenes uses.
fn fits(schema: &Value, value: &Value) -> bool {
    let of_type = match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("integer") => value.is_i64(),
        Some("number") => value.is_number(),
        _ => true,
    };
    let all = |word: &str| schema[word].as_array().cloned().unwrap_or_default();
    let count = |word: &str| all(word).iter().filter(|inner| fits(inner, value)).count();
    let number = value.as_f64();
    let within = number.is_none_or(|number| {
        schema["minimum"].as_f64().is_none_or(|min| number >= min)
            && schema["maximum"].as_f64().is_none_or(|max| number <= max)
    });
    let items = value.as_array().is_none_or(|items| {
        let length = items.len() as u64;
        schema["minItems"].as_u64().is_none_or(|min| length >= min)
            && schema["maxItems"].as_u64().is_none_or(|max| length <= max)
            && (schema["items"].is_null() || items.iter().all(|item| fits(&schema["items"], item)))
    });
    let keys = value.as_object().is_none_or(|table| {
        all("required").iter().all(|name| table.contains_key(name.as_str().unwrap()))
            && table.iter().all(|(name, inner)| match &schema["properties"][name] {
                Value::Null => schema["additionalProperties"] != json!(false),
                known => fits(known, inner),
            })
    });
    of_type
        && within
        && items
        && keys
        && (schema["enum"].is_null() || all("enum").contains(value))
        && (schema["anyOf"].is_null() || count("anyOf") > 0)
        && (schema["oneOf"].is_null() || count("oneOf") == 1)
}

fn scene_schema() -> Value {
    let mut schema = json!({
        "$schema": "http://json-schema.org/draft-04/schema#",
        "title": "Scene of warpbeam",
        "description": "Numbers are in SI units, or texts with a unit such as \"210 GPa\".",
    });
    schema.as_object_mut().unwrap().extend(table_schema("").as_object().unwrap().clone());
    schema
}

#[test]
fn the_schema_is_current_and_accepts_the_built_in_scenes() {
    const FILE: &str = "assets/scene.schema.json";
    let schema = scene_schema();
    let text = format!("{schema:#}\n");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(FILE, &text).unwrap();
    }
    assert!(std::fs::read_to_string(FILE).unwrap() == text, "{FILE} is old: UPDATE_DOCS=1 rewrites it");
    let as_json = |toml: &str| serde_json::to_value(toml::from_str::<toml::Table>(toml).unwrap()).unwrap();
    for id in scene_ids() {
        assert!(fits(&schema, &as_json(registry::find(id).unwrap().toml)), "{id}");
    }
    assert!(fits(&schema, &as_json(AT_REST)));
    for (old, new) in [
        ("length = 10.0", "lenght = 10.0"),
        ("length = 10.0", "length = -1.0"),
        ("[20, 2]", "[20]"),
        ("\"moment\"", "\"torque\""),
        ("force = [0.0, -1.0]", "moment = 1.0"),
        ("name = \"a\"\n", ""),
        ("at = [5.0, 0.0]", "at = [5.0, 0.0]\nedge = \"top\""),
    ] {
        assert!(AT_REST.contains(old), "{old}");
        assert!(!fits(&schema, &as_json(&AT_REST.replace(old, new))), "{new}");
    }
}

// Commands, keys and results.

/// Returns the first cell of every row of the tables in a section of a document, each code span in it for itself.
fn first_cells(text: &str, section: &str) -> BTreeSet<String> {
    let (_, rest) = text.split_once(&format!("\n## {section}\n")).unwrap_or_else(|| panic!("no section {section}"));
    let rows = rest.lines().take_while(|line| !line.starts_with("## ")).filter(|line| line.starts_with("| `"));
    let cells = rows.map(|row| row.split(" | ").next().unwrap_or_default());
    cells.flat_map(|cell| cell.split('`').skip(1).step_by(2).map(str::to_owned)).collect()
}

/// Adds the paths of all values of a JSON object; items of a list share one.
fn json_paths(value: &Value, path: &str, paths: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (key, inner) in object {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                paths.insert(path.clone());
                json_paths(inner, &path, paths);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| json_paths(item, path, paths)),
        _ => {}
    }
}

#[test]
fn the_reference_of_results_has_every_key_of_json() {
    let text = std::fs::read_to_string("docs/reference/results.md").unwrap();
    let mut paths = BTreeSet::new();
    let short = ["--set", "dynamics.duration=0.05", "--reference=none"];
    for args in [
        vec!["article"],
        vec!["snap", "--reference=none"],
        vec!["gravity", "--set=solver.method=auto"],
        [&["swing"][..], &short].concat(),
        [&["swing", "--set=solver.method=auto"][..], &short].concat(),
    ] {
        let output = warpbeam(&[&["solve", "--json"][..], &args].concat());
        json_paths(&serde_json::from_slice(&output.stdout).unwrap(), "", &mut paths);
    }
    assert_eq!(first_cells(&text, "JSON of solve"), paths);
}

#[test]
fn the_reference_of_results_has_every_column_of_csv() {
    let text = std::fs::read_to_string("docs/reference/results.md").unwrap();
    // Headers of tables are literals with many commas.
    let is_name = |c: char| c.is_ascii_lowercase() || c == '_';
    let mut columns = BTreeSet::new();
    for file in rust_files(Path::new("src")) {
        let code = std::fs::read_to_string(&file).unwrap();
        for literal in code.split('"').filter(|literal| literal.ends_with("\\n") || literal.starts_with("node,")) {
            let names: Vec<_> = literal.trim_end_matches("\\n").split(',').filter(|name| !name.is_empty()).collect();
            if names.len() > 4 && names.iter().all(|name: &&str| name.chars().all(is_name)) {
                columns.extend(names.into_iter().map(str::to_owned));
            }
        }
    }
    assert!(columns.len() > 60, "{columns:?}");
    let sections = ["CSV of solve, at rest", "CSV of solve, in motion", "CSV of curve", "JSON and CSV of section"];
    let sections = sections.into_iter().chain(["JSON and CSV of limits", "CSV of study, tune and extremes"]);
    let documented: BTreeSet<_> = sections.flat_map(|section| first_cells(&text, section)).collect();
    let missing: Vec<_> = columns.difference(&documented).collect();
    assert!(missing.is_empty(), "not in docs/reference/results.md: {missing:?}");
    // The headers of the tables that one solve writes are in the reference.
    let folder = tempfile::tempdir().unwrap();
    let short = ["--set", "dynamics.duration=0.05", "--reference=none"];
    let supports = ["left_", "right_", "support.2_"].map(|name| (name, "SUPPORT_"));
    let snap = [&supports[..], &[("crown_", "NAME_"), ("quarter_", "NAME_")]].concat();
    for (section, args, names) in [
        ("CSV of solve, at rest", vec!["solve", "cook", "--reference=none", "--out=a.csv"], &[][..]),
        ("CSV of solve, in motion", [&["solve", "swing", "--out=a.csv"][..], &short].concat(), &[("tip_", "NAME_")]),
        ("CSV of curve", vec!["curve", "elastica", "--out=a.csv"], &[]),
        ("CSV of curve", vec!["curve", "snap", "--out=a.csv"], &snap),
    ] {
        succeeds_in(folder.path(), &args);
        let table = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
        let general = |name: &str| {
            let known = names.iter().find_map(|(from, to)| Some(format!("{to}{}", name.strip_prefix(from)?)));
            known.unwrap_or_else(|| name.to_owned())
        };
        let columns: BTreeSet<_> = table.lines().next().unwrap().split(',').map(general).collect();
        let documented = first_cells(&text, section);
        let missing: Vec<_> = columns.difference(&documented).collect();
        assert!(missing.is_empty(), "{section}: {missing:?}");
    }
}
