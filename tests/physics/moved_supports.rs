//! Tests scenes whose supports turn and move, and bodies that are held at points beyond their critical load. The right
//! values are those of shooting, of closed forms and of small load steps.

use crate::common::warpbeam;

/// Returns a scene of `tests/data/scenes`.
fn file(name: &str) -> String {
    format!("{}/tests/data/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// A column held at points has an answer or a sentence beyond its critical load, where the body jumps.
#[test]
fn a_column_held_at_points_ends_with_a_sentence() {
    let file = file("held-column");
    for command in ["solve", "curve"] {
        for force in ["-20000", "-3000", "-50000", "-2e6"] {
            let output = warpbeam(&[command, &file, "--set", &format!("load.0.force=[{force},10]")]);
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.code().is_some_and(|code| code < 2), "{command} {force}: {error}");
            assert!(!output.stdout.is_empty(), "{command} {force}");
        }
    }
}
