//! The texts of the commands: messages, claims and notes, all in one file, to be read from end to end. Elsewhere, tests
//! assert the kind of a claim and its numbers.
//!
//! `tests/golden/texts.txt` has a block for each command: after `$` its arguments, after `~` a change of the scene
//! [`GOOD`], which `solve` then reads; the exit code; messages; of a result its status, claims and notes. The commands run in a
//! copy of `tests/data/files`. `UPDATE_GOLDEN=1 cargo test --test commands texts` rewrites everything but the lines of `$` and `~`.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::cli::GOOD;
use crate::common::*;

const FILE: &str = "tests/golden/texts.txt";

/// Splits a line into arguments, as a shell does; only single quotes are known.
fn arguments(line: &str) -> Vec<String> {
    let (mut arguments, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => arguments.push(String::new()),
            c => arguments.last_mut().unwrap().push(c),
        }
    }
    arguments
}

fn entries(folder: &Path) -> BTreeSet<(std::ffi::OsString, u64)> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries.map(|entry| (entry.file_name(), entry.metadata().unwrap().len())).collect()
}

/// Runs the command of a header, and returns its texts.
fn texts(folder: &Path, header: &str) -> String {
    let mut scene = GOOD.to_owned();
    let command = match header.strip_prefix("~ ") {
        Some(change) => {
            let change = change.replace("\\n", "\n");
            let (old, new) = change.split_once(" =>").unwrap();
            assert!(scene.contains(old), "{header}");
            scene = scene.replacen(old, new.trim_start_matches(' '), 1);
            "solve scene.toml".to_owned()
        }
        None => header[2..].to_owned(),
    };
    fs::write(folder.join("scene.toml"), scene).unwrap();
    let arguments = arguments(&command);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let before = entries(folder);
    let output = warpbeam_in(folder, &arguments);
    let code = output.status.code().unwrap();
    let mut text = format!("exit {code}\n");
    // The rest of a message of clap is the usage, which `docs/reference/commands.md` has.
    stderr(&output).lines().take_while(|line| !line.is_empty()).for_each(|line| _ = writeln!(text, "{line}"));
    if code > 1 {
        assert!(entries(folder) == before, "{header}: refused commands write no files");
        // A result that cannot be written is printed.
        assert!(output.stdout.is_empty() || header.contains("/no/such/"), "{header}: refused commands print nothing");
    } else if arguments[0] == "solve" {
        let json = stdout(&warpbeam_in(folder, &[&arguments[..], &["--json"]].concat()));
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let out = stdout(&output);
        let status = out.lines().nth(1).unwrap();
        // Numbers of iterations and residuals depend on rounding errors.
        let is_still = json["time"].is_null();
        let _ = writeln!(text, "{}", if is_still { status.split(" after ").next().unwrap() } else { status });
        json["reason"].as_str().into_iter().for_each(|reason| _ = writeln!(text, "reason: {reason}"));
        for claim in json["claims"].as_array().unwrap() {
            let [kind, words] = ["claim", "text"].map(|key| claim[key].as_str().unwrap());
            let _ = writeln!(text, "{kind}: {}", words.split(": the relative residual is").next().unwrap());
        }
        let notes = json["warnings"].as_array().unwrap();
        let notes: String = notes.iter().map(|note| format!("note: {}\n", note.as_str().unwrap())).collect();
        let inverted = json["inverted_elements"].as_u64().filter(|number| *number > 0);
        let is_told = inverted.is_some_and(|number| notes.contains(&format!("inverted elements: {number} of ")));
        assert_eq!([is_told, notes.contains("inverted elements")], [inverted.is_some(); 2], "{header}");
        // The text of a diverged iteration ends before its numbers and notes.
        let is_short = json["status"] == "diverged";
        assert!(is_short || out.contains(&notes), "{header}: text and JSON differ: {out}");
        text += if is_short { "" } else { &notes };
    }
    text
}

#[test]
fn texts_are_those_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bytes.toml"), [0xff, 0xfe, 0x00]).unwrap();
    fs::copy("assets/scenes/bracket.toml", folder.path().join("alone.toml")).unwrap();
    for file in fs::read_dir("tests/data/files").unwrap().map(Result::unwrap) {
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    let kept = fs::read_to_string(FILE).unwrap();
    let is_header = |line: &&str| line.starts_with("$ ") || line.starts_with("~ ");
    let mut now = String::new();
    for header in kept.lines().filter(is_header) {
        let _ = writeln!(now, "{header}\n{}", texts(folder.path(), header));
    }
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(FILE, &now).unwrap();
        return;
    }
    let differ: Vec<_> = kept.lines().zip(now.lines()).filter(|(kept, now)| kept != now).collect();
    assert!(kept == now, "UPDATE_GOLDEN=1 cargo test --test commands texts accepts (old, new): {differ:#?}");
}
