//! Tests of the layers of `src`: a file imports only from its own layer and lower ones, and no files
//! import each other in a circle.
//!
//! The imports are read from the text: `use` declarations, also through re-exports, and paths that
//! begin with `crate::`, `super::` or `self::`. Macros and method calls that reach another file without
//! such a path are not detected.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::files::rust_files;

/// Layers from the lowest to the highest, with their files and folders in `src`. The longest matching entry counts;
/// `lib` is the crate's root.
const LAYERS: &[(&str, &[&str])] = &[
    ("foundations", &["format", "sentence", "progress", "timings", "simd", "image", "atomic_write"]),
    ("model", &["model"]),
    ("kinematics", &["rotation", "displacement", "material", "state", "continuation", "exact_beam"]),
    ("element", &["element"]),
    ("mesh", &["mesh", "article"]),
    ("scene files", &["scene"]),
    ("solver", &["solver"]),
    ("assembly", &["assembly"]),
    ("step", &["step"]),
    ("methods", &["method", "dynamics", "stress", "section"]),
    ("simulation", &["simulation"]),
    ("study", &["export", "study"]),
    ("plot", &["plot"]),
    ("render", &["render"]),
    ("platform", &["app/platform"]),
    ("language", &["app/language", "app/prelude"]),
    ("task", &["app/task"]),
    ("session", &["app/session"]),
    ("widgets", &["app/widgets"]),
    ("view options", &["app/view_options", "app/action"]),
    ("diagnosis", &["app/diagnosis", "app/interface"]),
    ("viewport", &["app/viewport"]),
    ("panel", &["app/panel"]),
    ("modes", &["app/modes"]),
    ("shell", &["app/shell"]),
    ("offscreen", &["app/offscreen"]),
    ("window", &["app/window"]),
    ("app", &["app"]),
    ("commands", &["cli"]),
    ("crate", &["lib"]),
];

/// Path of a module from the crate's root: `["scene", "registry"]`.
type Module = Vec<String>;

/// Text and imports of a file.
struct Source {
    file: PathBuf,
    /// Text without comments, strings, imports and unit tests.
    code: String,
    /// Imported paths, with the names that they have in the module.
    uses: Vec<(Vec<String>, String)>,
}

type Sources = BTreeMap<Module, Source>;

/// Imports of every module: the imported module, and the path that names it.
type Imports = BTreeMap<Module, BTreeMap<Module, String>>;

#[test]
fn a_file_imports_only_from_its_own_layer_and_lower_ones_and_not_in_a_circle() {
    let sources = sources("src".as_ref());
    for entry in LAYERS.iter().flat_map(|(_, entries)| *entries) {
        let path: Vec<&str> = entry.split('/').collect();
        assert!(*entry == "lib" || sources.keys().any(|module| starts_with(module, &path)), "{entry} is not in src");
    }
    let (imports, mut wrong) = (imports(&sources), Vec::new());
    let circles = circles(&imports);
    assert!(circles.is_empty(), "files import each other in a circle:\n{}", circles.join("\n"));
    for (module, imports) in &imports {
        for (imported, path) in imports {
            let [own, other] = [module, imported].map(|module| {
                layer(module).unwrap_or_else(|| panic!("{} is in no layer", sources[module].file.display()))
            });
            if other > own {
                let [importer, imported] = [module, imported].map(|module| sources[module].file.display());
                let [own, other] = [own, other].map(|layer| LAYERS[layer].0);
                wrong.push(format!("{importer} ({own}) imports {imported} ({other}) as {path}"));
            }
        }
    }
    assert!(wrong.is_empty(), "imports from higher layers:\n{}", wrong.join("\n"));
}

#[test]
fn circles_and_imports_through_re_exports_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write("lib.rs", "mod low;\nmod high;\nmod side;\npub use high::Wide;");
    write("low.rs", "// use crate::side::Nothing;\nfn f() -> crate::Wide { \"crate::side::Nothing\" }");
    write("high/mod.rs", "mod inner;\npub use self::inner::{Wide, other as another};");
    write("high/inner.rs", "use super::super::low::{self, f as g};\nuse super::Narrow;");
    write("side.rs", "use crate::low::f;\n#[cfg(test)]\nmod tests {\n    use crate::high::Wide;\n}");
    let sources = sources(folder.path());
    let imports = imports(&sources);
    let of = |module: &str| {
        let module: Module = module.split('/').map(str::to_owned).collect();
        imports.get(&module).into_iter().flat_map(BTreeMap::keys).map(|m| m.join("/")).collect::<Vec<_>>()
    };
    assert_eq!(of("low"), ["high/inner"], "a re-export leads to the file that defines the name");
    assert_eq!(of("high/inner"), ["low"], "an import of the own parent does not count");
    assert_eq!(of("side"), ["low"], "unit tests may import everything");
    let circles = circles(&imports);
    assert!(circles.len() == 1 && circles[0].contains("low.rs") && circles[0].contains("inner.rs"), "{circles:?}");
}

/// Returns the position of a module's layer in [`LAYERS`].
fn layer(module: &[String]) -> Option<usize> {
    if module.is_empty() {
        return LAYERS.iter().position(|(_, entries)| entries.contains(&"lib"));
    }
    let entries = LAYERS.iter().enumerate().flat_map(|(layer, (_, entries))| entries.iter().map(move |e| (layer, e)));
    let paths = entries.map(|(layer, entry)| (layer, entry.split('/').collect::<Vec<_>>()));
    paths.filter(|(_, path)| starts_with(module, path)).max_by_key(|(_, path)| path.len()).map(|(layer, _)| layer)
}

fn starts_with(module: &[String], path: &[&str]) -> bool {
    module.len() >= path.len() && module.iter().zip(path).all(|(a, b)| a == b)
}

/// Reads every file of the library.
fn sources(root: &Path) -> Sources {
    let mut sources = Sources::new();
    for file in rust_files(root) {
        let relative = file.strip_prefix(root).unwrap().with_extension("");
        let mut module: Module = relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        // The program is a separate crate, and tests may import everything.
        if module[0] == "main" || module.last().is_some_and(|name| name == "tests") {
            continue;
        }
        module.pop_if(|last| last == "mod" || last == "lib");
        let (code, uses) = take_uses(&code(&std::fs::read_to_string(&file).unwrap()));
        sources.insert(module, Source { file, code, uses });
    }
    sources
}

/// Removes comments, the contents of strings, and unit tests.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut code = String::new();
    let mut rest = text.char_indices().peekable();
    while let Some((i, c)) = rest.next() {
        match c {
            '/' if text[i..].starts_with("//") => while rest.next_if(|(_, c)| *c != '\n').is_some() {},
            '\'' if text[i..].starts_with("'\"'") => _ = rest.nth(1),
            '"' => {
                while let Some((_, c)) = rest.next().filter(|(_, c)| *c != '"') {
                    if c == '\\' {
                        rest.next();
                    }
                }
            }
            _ => code.push(c),
        }
    }
    code
}

/// Splits a module's code into the code without imports and the imported paths, with the names that they have there.
fn take_uses(code: &str) -> (String, Vec<(Vec<String>, String)>) {
    let (mut rest, mut uses) = (String::new(), Vec::new());
    for statement in code.split_inclusive(';') {
        let start = statement.match_indices("use ").map(|(i, _)| i).find(|&i| {
            let before = statement[..i].trim_end();
            before.is_empty() || before.ends_with(['}', ';', ']', ')', '{']) || before.ends_with("pub")
        });
        match start {
            Some(start) => {
                rest.push_str(&statement[..start]);
                flatten(&[], statement[start + 4..].trim_end_matches(';'), &mut uses);
            }
            None => rest.push_str(statement),
        }
    }
    (rest, uses)
}

/// Adds every path of an import tree such as `a::{b, c as d}`.
fn flatten(before: &[String], tree: &str, uses: &mut Vec<(Vec<String>, String)>) {
    let tree = tree.trim();
    let names =
        |path: &str| path.split("::").map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect();
    if let Some((path, group)) = tree.split_once('{') {
        let before = [before.to_vec(), names(path)].concat();
        let group = group.trim_end().trim_end_matches('}');
        let mut depth = 0;
        let parts = group.split(|c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == ',' && depth == 0
        });
        // Closing braces, which end groups that were flattened before, leave empty parts.
        parts.filter(|part| !part.trim().is_empty()).for_each(|part| flatten(&before, part, uses));
        return;
    }
    let (path, alias) = tree.split_once(" as ").map_or((tree, None), |(path, alias)| (path, Some(alias.trim())));
    let mut path = [before.to_vec(), names(path)].concat();
    path.pop_if(|last| last == "self");
    if let Some(name) = alias.map(str::to_owned).or_else(|| path.last().cloned()) {
        uses.push((path, name));
    }
}

/// Returns the imports of every module.
fn imports(sources: &Sources) -> Imports {
    let mut imports = Imports::new();
    for (module, source) in sources {
        let mut paths: Vec<Vec<String>> = source.uses.iter().map(|(path, _)| path.clone()).collect();
        for first in ["crate::", "super::", "self::"] {
            for (i, _) in source.code.match_indices(first) {
                if source.code[..i].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
                    continue;
                }
                let path = source.code[i..].split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).next();
                let names = path.unwrap_or_default().split("::").filter(|name| !name.is_empty());
                paths.push(names.map(str::to_owned).collect());
            }
        }
        for path in paths {
            let Some(absolute) = absolute(sources, module, &path) else { continue };
            let Some(imported) = definition(sources, &absolute, &mut BTreeSet::new()) else { continue };
            // A module and its children count as one; a child may use its parents.
            if !module.starts_with(&imported) {
                imports.entry(module.clone()).or_default().insert(imported, path.join("::"));
            }
        }
    }
    imports
}

/// Returns the path from the crate's root; `None` if it leads to another crate.
fn absolute(sources: &Sources, module: &[String], path: &[String]) -> Option<Vec<String>> {
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([module, &path[1..]].concat()),
        "super" => {
            let up = path.iter().take_while(|name| *name == "super").count();
            Some([&module[..module.len().checked_sub(up)?], &path[up..]].concat())
        }
        first => {
            let child = [module, &[first.to_owned()]].concat();
            sources.contains_key(&child).then(|| [module, path].concat())
        }
    }
}

/// Returns the module that defines the last name of a path, through re-exports.
fn definition(sources: &Sources, path: &[String], seen: &mut BTreeSet<Vec<String>>) -> Option<Module> {
    let length = (0..=path.len()).rev().find(|&length| sources.contains_key(&path[..length]))?;
    let module = &path[..length];
    if let Some(name) = path.get(length)
        && seen.insert(path[..=length].to_vec())
        && let Some((import, _)) = sources[module].uses.iter().find(|(_, own)| own == name)
        && let Some(absolute) = absolute(sources, module, import)
    {
        return definition(sources, &[&absolute, &path[length + 1..]].concat(), seen);
    }
    Some(module.to_vec())
}

/// Returns one line for every circle of files that import each other.
fn circles(imports: &Imports) -> Vec<String> {
    let reaches = |from: &Module| {
        let (mut reached, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(module) = next.pop() {
            let keys = imports.get(module).into_iter().flat_map(BTreeMap::keys);
            next.extend(keys.filter(|m| reached.insert((*m).clone())));
        }
        reached
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> = imports.keys().map(|module| (module, reaches(module))).collect();
    let mut circles = BTreeSet::new();
    for (module, own) in reached.iter().filter(|(module, own)| own.contains(**module)) {
        let others = own.iter().filter(|other| reached.get(other).is_some_and(|back| back.contains(*module)));
        circles.insert(others.map(|module| format!("{}.rs", module.join("/"))).collect::<Vec<_>>().join(", "));
    }
    circles.into_iter().collect()
}

/// A worker of the web page looks its work up by name: work without an entry never ends there.
#[test]
fn all_background_work_has_an_entry_for_the_page() {
    let entries = std::fs::read_to_string("src/app/window/worker.rs").unwrap();
    let mut kinds = BTreeSet::new();
    for path in rust_files(Path::new("src/app")) {
        let source = std::fs::read_to_string(&path).unwrap();
        let source = source.split("#[cfg(test)]").next().unwrap();
        for block in source.split("facts! {").skip(1) {
            let lines = block.split("\n}\n").next().unwrap().lines().filter_map(|line| line.split_once(" = \""));
            let names = lines.map(|(kind, _)| kind.split(" by ").next().unwrap().trim());
            kinds.extend(names.map(str::to_owned));
        }
        assert!(path.ends_with("task/keyed.rs") || !source.contains("Task::run("), "{}: no fact", path.display());
    }
    assert!(kinds.len() >= 8, "{kinds:?}");
    let missing: Vec<_> = kinds.iter().filter(|kind| !entries.contains(&format!("entry::<{kind}>()"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
