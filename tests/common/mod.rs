//! What tests of several topics need.
#![allow(dead_code, reason = "each test uses its part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::path::Path;
use std::process::{Command, Output};

use warpbeam::scene::{Scene, Source, open, registry};

/// A built-in scene.
pub fn scene(id: &str) -> Scene {
    scene_with(id, &[])
}

/// A built-in scene with `--set` assignments.
pub fn scene_with(id: &str, set: &[&str]) -> Scene {
    open(&Source { name: id.to_owned(), assignments: set.iter().map(|s| (*s).to_owned()).collect() }).unwrap()
}

/// The names of all built-in scenes.
pub fn scene_ids() -> Vec<&'static str> {
    registry::BUILT_IN.iter().map(|b| b.id).collect()
}

/// Runs the program.
pub fn warpbeam(args: &[&str]) -> Output {
    warpbeam_in(Path::new("."), args)
}

/// Runs the program in a folder, without a display.
pub fn warpbeam_in(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_warpbeam"))
        .args(args)
        .current_dir(folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// `solve --json` of a scene that converges.
pub fn solve_json(args: &[&str]) -> serde_json::Value {
    let output = warpbeam(&[&["solve", "--json"], args].concat());
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}
