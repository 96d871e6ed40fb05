//! Tests that commands end on signals, and refuse unsuitable files and options.

use std::fs;
use std::path::Path;

use crate::common::process::{on_a_terminal, start, wait_for};
use crate::common::*;
use nix::sys::signal::Signal;

/// Interrupts a command as soon as it handles signals; returns its exit code, standard output and standard error.
fn interrupted(folder: &Path, args: &[&str], signal: Signal) -> (Option<i32>, String, String) {
    let running = start(folder, args);
    wait_for("a handler of signals", || running.listens());
    let output = running.end_by(signal);
    (output.status.code(), stdout(&output), stderr(&output))
}

/// Arguments for a body that takes long to solve, with a reference solution that takes longer.
const LARGE: [&str; 5] = ["cantilever", "--set", "beam.cells=[400,40]", "--set", "solver.method=newton"];

/// Supports of a beam that is held at two points, the first of them beyond the cut.
const HELD: &str =
    "support=[{at=[2.13,0],acts_on=\"point\",fix=[\"x\",\"y\"]},{at=[5.57,0],acts_on=\"point\",fix=[\"y\"]}]";

/// A result that exists is printed, whatever was being computed when the signal came.
#[test]
fn interrupted_static_commands_print_their_partial_result() {
    let folder = tempfile::tempdir().unwrap();
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let args = [&["solve", "--json", "--reference", "full"][..], &LARGE].concat();
        let (code, out, said) = interrupted(folder.path(), &args, signal);
        assert_eq!(code, Some(1), "{said}");
        let json: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}"));
        assert!(json["probes"][0]["u"][1].is_f64() && json["probes"][0]["reference_u"].is_null(), "{json}");
        assert!(["converged", "not_converged"].contains(&json["status"].as_str().unwrap()), "{json}");
        assert!(json["status"] == "converged" || json["reason"].as_str().unwrap().contains("interrupted"), "{json}");
    }
    let (code, out, _) = interrupted(folder.path(), &[&["curve"][..], &LARGE].concat(), Signal::SIGINT);
    assert_eq!(code, Some(1), "{out}");
    assert!(out.contains("not followed beyond ") && out.contains("interrupted"), "{out}");
    let (code, _, said) = interrupted(folder.path(), &["tune", "cantilever"], Signal::SIGINT);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("interrupted"), "{said}");
}

/// A slow reference solution shows its progress on a terminal.
#[test]
fn a_long_solve_shows_a_bar() {
    let (code, text) = on_a_terminal(Path::new("."), &[&["solve", "--reference", "full"][..], &LARGE].concat());
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("the reference solution, "), "{text}");
}

/// Numbered pictures of an earlier recording are not mixed with those of a new one.
#[cfg(feature = "app")]
#[test]
fn a_folder_of_pictures_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let record = |seconds: &str, more: &[&str]| {
        let args = ["record", "swing", "--seconds", seconds, "--fps", "10", "--size", "64x64", "-o", "frames"];
        warpbeam_in(folder.path(), &[&args[..], more].concat())
    };
    assert_eq!(record("0.4", &[]).status.code(), Some(0));
    let count = || fs::read_dir(&frames).unwrap().count();
    assert_eq!(count(), 5);
    fs::write(frames.join("frame-notes.txt"), "mine").unwrap();
    let refused = record("0.2", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("has 5 numbered pictures; --overwrite replaces them"), "{}", stderr(&refused));
    assert_eq!(count(), 6);
    assert_eq!(record("0.2", &["--overwrite"]).status.code(), Some(0));
    // Three pictures, and a file that is not a picture of a recording.
    assert_eq!(count(), 4);
}

/// A scene can be read from a pipe, even if an error in it is found only after reading.
#[test]
fn a_scene_is_read_from_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    for (edge, code) in [("left", 0), ("lift", 2)] {
        let toml = crate::cli::GOOD.replace("left", edge);
        nix::unistd::mkfifo(&pipe, nix::sys::stat::Mode::S_IRWXU).unwrap();
        let at = pipe.clone();
        let writing = std::thread::spawn(move || fs::write(at, toml));
        let output = warpbeam(&["solve", pipe.to_str().unwrap()]);
        writing.join().unwrap().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        if code == 2 {
            assert!(stderr(&output).contains("pipe:12: support.0.edge: expected one of"), "{}", stderr(&output));
        }
        fs::remove_file(&pipe).unwrap();
    }
}

/// A name with commas remains one field, and two probes with the same name are refused.
#[test]
fn names_of_probes_are_fields_and_differ() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |second: &str| {
        format!(
            "name = \"Bar\"\n[beam]\nlength = 10.0\nheight = 1.0\ncells = [10, 1]\nelement = \"t6\"\n[material]\nyoung = 1e6\n\
             poisson = 0.3\n[[support]]\nedge = \"left\"\nfix = [\"x\", \"y\"]\n[[load]]\nkind = \"force\"\nedge = \"top\"\n\
             force = [0, -10]\n[[probe]]\nname = \"tip, right \\\"end\\\"\"\nedge = \"right\"\n[[probe]]\nname = {second}\nat = [5, 0]\n"
        )
    };
    fs::write(folder.path().join("a.toml"), scene("\"middle\"")).unwrap();
    succeeds_in(folder.path(), &["curve", "a.toml", "--out", "a.csv"]);
    let csv = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let name = "\"tip, right \"\"end\"\"_u";
    assert!(csv.starts_with(&format!("load_factor,{name}_x\",{name}_y\",middle_u_x")), "{csv}");
    fs::write(folder.path().join("b.toml"), scene("'tip, right \"end\"'")).unwrap();
    refuses_in(folder.path(), &["solve", "b.toml"], "probe.1.name: expected a unique name");
}

/// A cut of a part without loads carries nothing.
#[test]
fn a_part_without_loads_carries_nothing() {
    let text = stdout(&warpbeam(&["section", "cantilever", "--at", "1", "--set", HELD]));
    for words in ["normal force N             0 N", "bending moment M         0 N m"] {
        assert!(text.contains(words), "{text}");
    }
}
