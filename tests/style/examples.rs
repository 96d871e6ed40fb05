//! Documentation of the public face: an item that names another one for an example finds itself in the code there, and
//! no link leads to an item that the documentation does not show.
//!
//! The comments are read from the text. A name counts as used in an example if it stands there as a whole word.

use std::collections::BTreeSet;

use crate::files::rust_files;
use crate::public_api::{Face, OUTSIDE, exported, faces, implemented};

/// Phrase after the link to an item with an example.
const FOR_AN_EXAMPLE: &str = " for an example";

/// Documentation of a public item.
struct Doc {
    /// Path of the item from the root of the crate, such as `Scene::beam`.
    item: String,
    /// File and line of the item.
    place: String,
    /// Sentences without the code blocks.
    text: String,
    /// Contents of the code blocks.
    code: String,
}

/// Reads the documentation of the types named `names`, and of their public fields, variants and methods.
fn docs(text: &str, file: &str, names: &BTreeSet<String>) -> Vec<Doc> {
    let (mut docs, mut owner, mut in_enum) = (Vec::new(), None, false);
    let (mut comment, mut is_hidden) = (Vec::new(), false);
    for (number, line) in (1..).zip(text.lines()) {
        let (item, indent) = (line.trim_start(), line.len() - line.trim_start().len());
        if let Some(sentence) = item.strip_prefix("///") {
            comment.push(sentence.strip_prefix(' ').unwrap_or(sentence));
            continue;
        }
        if item.starts_with("#[") {
            is_hidden |= item == "#[doc(hidden)]";
            continue;
        }
        let is_type = ["pub struct ", "pub enum ", "pub type "].iter().any(|start| line.starts_with(start));
        if indent == 0 && !line.is_empty() {
            owner = if is_type { line.split(|c: char| !c.is_alphanumeric()).nth(2) } else { implemented(line) };
            owner = owner.filter(|name| names.contains(*name));
            in_enum = line.starts_with("pub enum ");
        }
        if let Some(owner) =
            owner.filter(|_| !comment.is_empty() && !is_hidden && (item.starts_with("pub ") || in_enum))
        {
            let item = if indent == 0 { owner.to_owned() } else { format!("{owner}::{}", name(item)) };
            let [text, code] = [false, true].map(|wanted| part(&comment, wanted));
            docs.push(Doc { item, place: format!("{file}:{number}"), text, code });
        }
        comment.clear();
        is_hidden = false;
    }
    docs
}

/// Returns the name of an item in its declaration.
fn name(item: &str) -> &str {
    let item = ["pub ", "const ", "fn "].iter().fold(item, |item, word| item.strip_prefix(word).unwrap_or(item));
    item.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default()
}

/// Returns the code blocks of a comment, or the text without them.
fn part(comment: &[&str], code: bool) -> String {
    let mut in_code = false;
    let wanted = comment.iter().filter(|line| {
        let is_fence = line.starts_with("```");
        in_code ^= is_fence;
        !is_fence && in_code == code
    });
    wanted.copied().collect::<Vec<_>>().join(if code { "\n" } else { " " })
}

/// Returns the targets of the links in a text whose shown text is code, each with the text that follows the link.
fn links(text: &str) -> Vec<(&str, &str)> {
    let links = text.match_indices("[`").filter_map(|(at, _)| {
        let (shown, rest) = text[at + 2..].split_once("`]")?;
        match rest.strip_prefix('(').and_then(|rest| rest.split_once(')')) {
            Some((target, rest)) => Some((target, rest)),
            None => Some((shown, rest)),
        }
    });
    links.collect()
}

/// Returns the path of a link's target from the root of the crate.
fn path<'a>(target: &'a str, owner: &'a str) -> Vec<&'a str> {
    let target = target.trim_end_matches("()");
    let parts = target.split("::").filter(|part| !["crate", "super"].contains(part));
    parts.map(|part| if part == "Self" { owner } else { part }).collect()
}

/// Returns `true` if a text has a word.
fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|other| other == word)
}

/// Returns one line for every item that names another one for an example in which it does not occur.
fn missing_examples(docs: &[Doc]) -> Vec<String> {
    let mut missing = Vec::new();
    for Doc { item, place, text, .. } in docs {
        let [owner, own] = [item.split("::").next(), item.rsplit("::").next()].map(Option::unwrap_or_default);
        let named = links(text).into_iter().filter(|(_, after)| after.starts_with(FOR_AN_EXAMPLE));
        let named: Vec<String> = named.map(|(target, _)| path(target, owner).join("::")).collect();
        if named.len() != text.matches(FOR_AN_EXAMPLE).count() {
            missing.push(format!("{place}: expected a link before \"{FOR_AN_EXAMPLE}\""));
        }
        for target in named {
            match docs.iter().find(|doc| doc.item == target) {
                Some(doc) if has_word(&doc.code, own) => {}
                Some(doc) => missing.push(format!("{place}: no `{own}` in the example of {target}, {}", doc.place)),
                None => missing.push(format!("{place}: {target} is not a documented public item")),
            }
        }
    }
    missing
}

/// Reads the documentation of the public types.
fn public_docs(names: &BTreeSet<String>) -> Vec<Doc> {
    let files = rust_files("src".as_ref());
    let files = files.iter().filter(|file| !OUTSIDE.iter().any(|folder| file.starts_with(folder)));
    files.flat_map(|file| docs(&std::fs::read_to_string(file).unwrap(), &file.display().to_string(), names)).collect()
}

#[test]
fn an_item_that_names_another_for_an_example_is_in_its_code() {
    let missing = missing_examples(&public_docs(&exported()));
    assert!(missing.is_empty(), "links to examples without the item:\n{}", missing.join("\n"));
}

#[test]
fn every_public_type_has_an_example_or_names_one() {
    let names = exported();
    let docs = public_docs(&names);
    let with = docs.iter().filter(|doc| !doc.code.is_empty() || doc.text.contains(FOR_AN_EXAMPLE));
    let with: BTreeSet<&String> = with.map(|doc| &doc.item).collect();
    let without: Vec<_> = names.iter().filter(|name| !with.contains(name)).collect();
    assert!(without.is_empty(), "no example and no link to one: {without:#?}");
}

/// Returns the modules that `src/lib.rs` hides.
fn hidden_modules() -> Vec<String> {
    let text = std::fs::read_to_string("src/lib.rs").unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let hidden = lines.windows(2).filter(|pair| pair[0] == "#[doc(hidden)]");
    hidden.filter_map(|pair| Some(pair[1].strip_prefix("pub mod ")?.trim_end_matches(';').to_owned())).collect()
}

/// Returns the names of all types, constants and functions of `src` that are declared public, but are not in the face.
fn hidden_names(names: &BTreeSet<String>) -> BTreeSet<String> {
    let mut hidden = BTreeSet::new();
    for file in rust_files("src".as_ref()).iter().filter(|file| !file.ends_with("export.rs")) {
        let text = std::fs::read_to_string(file).unwrap();
        for kind in ["struct", "enum", "type", "trait", "const", "static", "fn"] {
            let start = format!("\npub {kind} ");
            let declarations = text.split(start.as_str()).skip(1);
            hidden.extend(declarations.map(|declaration| name(declaration).to_owned()));
        }
    }
    hidden.difference(names).cloned().collect()
}

/// Returns `true` if the documentation shows the target of a link. A target of another crate counts as shown.
fn is_shown(path: &[&str], faces: &[(&String, &Face)], hidden: &[BTreeSet<String>; 2]) -> bool {
    let [modules, names] = hidden;
    if path.first().is_some_and(|first| modules.contains(*first) || names.contains(*first)) {
        return false;
    }
    let [.., owner, member] = path else { return true };
    match faces.iter().find(|(name, _)| name == owner) {
        Some((_, face)) => face.items.iter().any(|item| name(item) == *member),
        None => true,
    }
}

#[test]
fn no_link_of_the_public_face_leads_to_a_hidden_item() {
    let names = exported();
    let (faces, hidden) = (faces(&names), [hidden_modules().into_iter().collect(), hidden_names(&names)]);
    let faces: Vec<_> = faces.iter().collect();
    let crate_page = std::fs::read_to_string("src/lib.rs").unwrap();
    let crate_page = crate_page.lines().filter_map(|line| line.strip_prefix("//!")).collect::<Vec<_>>();
    let mut docs = public_docs(&names);
    let (item, place, code) = (String::new(), "src/lib.rs".to_owned(), String::new());
    docs.push(Doc { item, place, text: part(&crate_page, false), code });
    let mut wrong = Vec::new();
    for Doc { item, place, text, .. } in &docs {
        let owner = item.split("::").next().unwrap_or_default();
        let targets = links(text).into_iter().map(|(target, _)| target).filter(|target| !target.starts_with("http"));
        let targets = targets.filter(|target| !is_shown(&path(target, owner), &faces, &hidden));
        wrong.extend(targets.map(|target| format!("{place}: {target}")));
    }
    assert!(wrong.is_empty(), "links to items that the documentation hides:\n{}", wrong.join("\n"));
}

#[test]
fn wrong_examples_and_hidden_targets_are_found() {
    let names = ["Beam", "Load"].map(str::to_owned).into();
    let text = "\
/// A beam.
///
/// ```
/// let beam = Beam::new();
/// ```
pub struct Beam {
    /// See [`Self::new`] for an example.
    pub length: f64,
}
impl Beam {
    /// Makes a beam. See [`Load`] for an example.
    pub fn new() {}
    /// Hidden. See [`Load`] for an example.
    #[doc(hidden)]
    pub fn hidden() {}
}
/// A load. See [`Beam`](crate::Beam) for an example.
pub enum Load {
    /// A force. See [`Missing`] for an example.
    Force {
        /// In N, see above for an example.
        force: f64,
    },
}";
    let docs = docs(text, "beam.rs", &names);
    let items: Vec<_> = docs.iter().map(|doc| doc.item.as_str()).collect();
    assert_eq!(items, ["Beam", "Beam::length", "Beam::new", "Load", "Load::Force", "Load::force"]);
    let found: Vec<_> =
        missing_examples(&docs).iter().map(|line| line.split(": ").next().unwrap().to_owned()).collect();
    assert_eq!(found, ["beam.rs:8", "beam.rs:12", "beam.rs:18", "beam.rs:20", "beam.rs:22"]);

    let face = Face { items: ["pub length: f64", "pub const fn new() -> Self"].map(str::to_owned).into() };
    let (beam, hidden) = ("Beam".to_owned(), [["mesh".to_owned()].into(), ["Grid".to_owned()].into()]);
    let shown = |target: &str| is_shown(&path(target, "Beam"), &[(&beam, &face)], &hidden);
    for target in ["Beam", "crate::Beam::new", "Self::length", "ControlFlow::Break", "write()"] {
        assert!(shown(target), "{target}");
    }
    for target in ["Self::hidden", "crate::mesh::Beam", "Grid", "super::Grid::new"] {
        assert!(!shown(target), "{target}");
    }
}
