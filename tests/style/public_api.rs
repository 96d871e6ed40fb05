//! The library's public face: `tests/data/public_api.txt` lists the types at the root of the crate with their fields,
//! variants and methods, so that a change of the face is visible. `UPDATE_PUBLIC_API=1` rewrites the list.

use std::collections::{BTreeMap, BTreeSet};

use crate::files::rust_files;

const LIST: &str = "tests/data/public_api.txt";
/// Largest number of public types.
const MAX_TYPES: usize = 88;

/// Folders of `src` whose types are not in the face.
const OUTSIDE: [&str; 5] = ["src/app", "src/cli", "src/plot", "src/render", "src/study/extremes"];

/// Public type: its fields or variants, and its methods.
#[derive(Default)]
struct Face {
    items: BTreeSet<String>,
}

/// Returns the names that `src/lib.rs` re-exports at the root.
fn exported() -> BTreeSet<String> {
    let text = std::fs::read_to_string("src/lib.rs").unwrap();
    let uses = text.split("\npub use ").skip(1).map(|rest| rest.split(';').next().unwrap());
    let names = uses.flat_map(|list| list.split(|c: char| !c.is_alphanumeric() && c != '_'));
    names.filter(|name| name.starts_with(char::is_uppercase)).map(str::to_owned).collect()
}

/// Returns the type of an inherent implementation; `None` for implementations of traits.
fn implemented(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("impl")?;
    let rest = if rest.starts_with('<') { rest.split_once("> ")?.1 } else { rest.trim_start() };
    if rest.contains(" for ") {
        return None;
    }
    rest.split(|c: char| !c.is_alphanumeric()).next()
}

/// Reads the types named `names` from the library's sources.
fn faces(names: &BTreeSet<String>) -> BTreeMap<String, Face> {
    let mut faces: BTreeMap<String, Face> = names.iter().map(|name| (name.clone(), Face::default())).collect();
    for file in rust_files("src".as_ref()) {
        if OUTSIDE.iter().any(|folder| file.starts_with(folder)) {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate() {
            let is_type = ["pub struct ", "pub enum ", "pub type "].iter().any(|start| line.starts_with(start));
            let name = if is_type { line.split(|c: char| !c.is_alphanumeric()).nth(2) } else { implemented(line) };
            let Some(face) = name.and_then(|name| faces.get_mut(name)) else { continue };
            if let Some((_, alias)) = line.strip_prefix("pub type ").and_then(|line| line.split_once(" = ")) {
                face.items.insert(format!("= {}", alias.trim_end_matches(';')));
            } else if line.ends_with('{') {
                let block: Vec<&str> = lines[number + 1..].iter().copied().take_while(|line| *line != "}").collect();
                face.items.extend(items(&block, line.starts_with("pub enum ")));
            }
        }
    }
    faces
}

/// Returns the public fields and methods, or the variants, in the lines of a block; items with `doc(hidden)` are left out.
fn items(block: &[&str], is_enum: bool) -> Vec<String> {
    let (mut items, mut hidden) = (Vec::new(), false);
    let mut lines = block.iter().filter_map(|line| line.strip_prefix("    "));
    while let Some(line) = lines.next() {
        if line.starts_with("pub ") || is_enum && line.starts_with(char::is_uppercase) {
            let mut item = line.to_owned();
            // A signature ends where all of its parentheses are closed.
            while item.matches('(').count() > item.matches(')').count() {
                let Some(next) = lines.next() else { break };
                item = format!("{item}{}{}", if item.ends_with('(') { "" } else { " " }, next.trim());
            }
            // A variant's fields end with its closing brace.
            if is_enum && item.ends_with('{') {
                let fields = lines.by_ref().take_while(|line| *line != "},").map(str::trim);
                let fields: Vec<&str> =
                    fields.filter(|line| !line.starts_with("///") && !line.starts_with('#')).collect();
                item = format!("{item} {} }}", fields.join(" ").trim_end_matches(','));
            }
            if !hidden {
                items.push(item.trim_end_matches([' ', '{', ';', ',', '=']).replace(", )", ")"));
            }
        }
        hidden = line == "#[doc(hidden)]" || hidden && (line.starts_with("#[") || line.starts_with("///"));
    }
    items
}

#[test]
fn the_public_face_is_the_listed_one() {
    let names = exported();
    assert!(names.len() <= MAX_TYPES, "{} public types: expected at most {MAX_TYPES}", names.len());
    let mut list = String::new();
    for (name, face) in faces(&names) {
        list += &format!("{name}\n");
        face.items.iter().for_each(|item| list += &format!("    {item}\n"));
    }
    if std::env::var_os("UPDATE_PUBLIC_API").is_some() {
        std::fs::write(LIST, &list).unwrap();
    }
    let kept = std::fs::read_to_string(LIST).unwrap();
    let (now, before): (BTreeSet<&str>, BTreeSet<&str>) = (list.lines().collect(), kept.lines().collect());
    let changed: Vec<_> = now.symmetric_difference(&before).collect();
    assert!(list == kept, "the public face has changed (UPDATE_PUBLIC_API=1 accepts it): {changed:#?}");
}

/// Types of other crates and of the standard library in public signatures.
const FOREIGN: &str = "Arc AsRef BTreeMap Box Clone ControlFlow Duration ExactSizeIterator Fn FnMut FnOnce Into \
    IntoIterator Item Iterator Matrix2 Matrix3 Option Path PathBuf Result Self Send String Sync T Vec Vector2 \
    RangeInclusive Error";

/// A program can name every type of a public field, variant or signature.
#[test]
fn every_type_of_the_face_can_be_named() {
    let names = exported();
    let mut missing = BTreeSet::new();
    for (owner, face) in faces(&names) {
        for item in &face.items {
            // A variant begins with its own name.
            let types = if item.starts_with(char::is_uppercase) {
                item.trim_start_matches(char::is_alphanumeric)
            } else {
                item
            };
            let words = types.split(|c: char| !c.is_alphanumeric() && c != '_');
            let is_type =
                |word: &&str| word.starts_with(char::is_uppercase) && word.contains(char::is_lowercase) || *word == "T";
            for word in words
                .filter(is_type)
                .filter(|word| !names.contains(*word) && !FOREIGN.split(' ').any(|known| known == *word))
            {
                missing.insert(format!("{word}: {owner}, {item}"));
            }
        }
    }
    assert!(missing.is_empty(), "not at the root of the crate: {missing:#?}");
}

#[test]
fn modules_outside_the_face_are_hidden() {
    let text = std::fs::read_to_string("src/lib.rs").unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let shown = lines.windows(2).filter(|pair| pair[1].starts_with("pub mod ") && pair[0] != "#[doc(hidden)]");
    assert_eq!(shown.map(|pair| pair[1]).collect::<Vec<_>>(), ["pub mod export;"]);
}
