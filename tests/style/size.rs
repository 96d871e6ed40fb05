//! The size of the program, which only falls: lines of Rust in the parts of `src` and in `tests`, and the number of
//! crates that the program is built from. Whoever removes code lowers the number. Raising a number is a commit of its
//! own, whose body says what users get for it.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use crate::files::rust_files;

/// Parts with their files and folders, and their largest number of lines.
const LINES: &[(&str, &[&str], usize)] = &[
    ("app", &["src/app"], 21_809),
    ("study", &["src/study"], 5_200),
    ("model", &["src/model", "src/scene"], 3_093),
    ("method", &["src/method", "src/continuation.rs", "src/step.rs"], 3_228),
    ("simulation", &["src/simulation"], 2_400),
    ("assembly", &["src/assembly"], 2_926),
    ("cli", &["src/cli"], 2_193),
    ("dynamics", &["src/dynamics"], 1_887),
    ("render", &["src/render"], 1_860),
    ("element", &["src/element"], 1_998),
    ("mesh", &["src/mesh"], 1_914),
    ("plot", &["src/plot"], 756),
    ("the rest of src", &["src"], 5_001),
    ("tests", &["tests"], 19_412),
];
/// Largest number of lines of `src`.
const SRC: usize = 54_265;
/// Largest number of crates of the program on Linux.
const CRATES: usize = 236;

/// Says what to do if `actual` is more than `most`, or at least 3 % less.
fn problem(name: &str, actual: usize, most: usize) -> Option<String> {
    if actual > most {
        return Some(format!("{name}: expected at most {most}, got {actual}; remove something of equal size"));
    }
    (actual * 100 <= most * 97)
        .then(|| format!("{name}: {actual} is less than {most}; lower the number in {}", file!()))
}

/// Returns the lines of every part. A file belongs to the part with the longest path that contains it.
fn lines() -> Vec<usize> {
    let mut lines = vec![0; LINES.len()];
    for file in ["src", "tests"].iter().flat_map(|root| rust_files(root.as_ref())) {
        let paths =
            LINES.iter().enumerate().flat_map(|(part, (_, paths, _))| paths.iter().map(move |path| (part, path)));
        let (part, _) = paths.filter(|(_, path)| file.starts_with(path)).max_by_key(|(_, path)| path.len()).unwrap();
        lines[part] += std::fs::read_to_string(&file).unwrap().lines().count();
    }
    lines
}

#[test]
fn lines_only_become_fewer() {
    let lines = lines();
    let parts = LINES.iter().zip(&lines).filter_map(|((name, _, most), actual)| problem(name, *actual, *most));
    let src = LINES.iter().zip(&lines).filter(|((_, paths, _), _)| paths[0].starts_with("src")).map(|(_, lines)| lines);
    let problems: Vec<_> = parts.chain(problem("src", src.sum(), SRC)).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[cfg(target_os = "linux")]
#[test]
fn crates_only_become_fewer() {
    let tree = ["tree", "--locked", "--offline", "--edges", "normal", "--prefix", "none", "--format", "{p}"];
    let tree =
        Command::new(env!("CARGO")).args(tree).current_dir(Path::new(env!("CARGO_MANIFEST_DIR"))).output().unwrap();
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let tree = String::from_utf8(tree.stdout).unwrap();
    let crates: BTreeSet<_> = tree.lines().map(|line| line.trim_end_matches(" (*)")).collect();
    assert_eq!(problem("crates", crates.len(), CRATES), None, "{crates:#?}");
}

#[test]
fn more_and_much_less_are_problems() {
    let problems: Vec<_> = [98, 100, 101, 97].map(|actual| problem("", actual, 100).is_some()).into();
    assert_eq!(problems, [false, false, true, true]);
}
