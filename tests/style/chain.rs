//! The chain of calls from a frame to faer, as `CONTRIBUTING.md` lists it.

use std::collections::{BTreeMap, BTreeSet};

/// Returns the body of `Type::function` in Rust source text, formatted by rustfmt.
fn body<'a>(source: &'a str, name: &str) -> Option<&'a str> {
    let (of, function) = name.split_once("::")?;
    let is_head = |head: &str| head.split(|c: char| !c.is_alphanumeric()).any(|word| word == of);
    let mut blocks = source.split("\nimpl").skip(1).filter(|block| block.lines().next().is_some_and(is_head));
    let block = blocks.find(|block| block.contains(&format!("fn {function}(")))?;
    let (_, rest) = block.split_once(&format!("fn {function}("))?;
    rest.split("\n    }\n").next()
}

/// At most ten functions in six files lead from `Simulation::step` to faer; each exists and calls those that it lists.
#[test]
fn a_frame_reaches_faer_in_ten_functions() {
    let text = std::fs::read_to_string("CONTRIBUTING.md").unwrap();
    let (_, section) = text.split_once("## From a frame to faer\n").unwrap();
    let rows = section.split("\n## ").next().unwrap().lines().filter_map(|line| line.strip_prefix("| [`"));
    let rows: BTreeMap<&str, [&str; 2]> = rows
        .map(|row| {
            let (name, row) = row.split_once("`](").unwrap();
            let (file, calls) = row.split_once(") | ").unwrap();
            (name, [file, calls.trim_end_matches(" |")])
        })
        .collect();
    let files: BTreeSet<&str> = rows.values().map(|[file, _]| *file).collect();
    assert!((1..=10).contains(&rows.len()) && files.len() <= 6, "{} functions in {} files", rows.len(), files.len());
    let mut called = BTreeSet::from(["Simulation::step"]);
    for (name, [file, calls]) in &rows {
        let source = std::fs::read_to_string(file).unwrap();
        let body = body(&source, name).unwrap_or_else(|| panic!("{name} is not in {file}"));
        for callee in calls.split(", ").map(|callee| callee.trim_matches('`')) {
            let function = callee.rsplit("::").next().unwrap();
            assert!(body.contains(&format!("{function}(")), "{name} does not call {callee}");
            assert!(rows.contains_key(callee) || source.contains("use faer::"), "{callee} is not in the list");
            called.insert(callee);
        }
    }
    assert!(rows.keys().all(|name| called.contains(name)), "not every function is called: {called:?}");
}
