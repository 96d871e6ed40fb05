//! Tests that commands end on signals, and refuse unsuitable files and options.

use std::fs;
use std::path::Path;

use crate::common::process::{on_a_terminal, start, wait_for};
use crate::common::{solve_json, stderr, stdout, warpbeam, warpbeam_in};
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
    let args = [&["curve"][..], &LARGE].concat();
    let (code, out, _) = interrupted(folder.path(), &args, Signal::SIGINT);
    assert_eq!(code, Some(1), "{out}");
    assert!(out.contains("not followed beyond ") && out.contains("interrupted"), "{out}");
    // Before the first measurement there is no setting to choose.
    let (code, _, said) = interrupted(folder.path(), &["tune", "cantilever"], Signal::SIGINT);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("interrupted"), "{said}");
}

/// A slow reference solution shows its progress on a terminal.
#[test]
fn a_long_solve_shows_a_bar() {
    let args = [&["solve", "--reference", "full"][..], &LARGE].concat();
    let (code, text) = on_a_terminal(Path::new("."), &args);
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
    for (toml, code) in [
        (
            "name = \"Bar\"\n[beam]\nlength = 2.0\nheight = 1.0\ncells = [4, 2]\n[material]\nyoung = 1e6\npoisson = 0.3\n[[support]]\nedge = \"left\"\nfix = [\"x\", \"y\"]\n",
            0,
        ),
        (
            "name = \"Bar\"\n[beam]\nlength = 2.0\nheight = 1.0\ncells = [4, 2]\n[material]\nyoung = 1e6\npoisson = 0.3\n[[support]]\nedge = \"lift\"\nfix = [\"x\", \"y\"]\n",
            2,
        ),
    ] {
        nix::unistd::mkfifo(&pipe, nix::sys::stat::Mode::S_IRWXU).unwrap();
        let (writer, at) = (toml.to_owned(), pipe.clone());
        let writing = std::thread::spawn(move || fs::write(at, writer));
        let output = warpbeam(&["solve", pipe.to_str().unwrap()]);
        writing.join().unwrap().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        if code == 2 {
            assert!(stderr(&output).contains("pipe:10: support.0.edge: expected one of"), "{}", stderr(&output));
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
    let output = warpbeam_in(folder.path(), &["curve", "a.toml", "--out", "a.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let csv = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert!(
        csv.starts_with("load_factor,\"tip, right \"\"end\"\"_u_x\",\"tip, right \"\"end\"\"_u_y\",middle_u_x"),
        "{csv}"
    );
    fs::write(folder.path().join("b.toml"), scene("'tip, right \"end\"'")).unwrap();
    let refused = warpbeam_in(folder.path(), &["solve", "b.toml"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("probe.1.name: expected a unique name"), "{}", stderr(&refused));
}

/// Results report their limitations, in the text output and in JSON.
#[test]
fn results_name_their_limits() {
    for (args, expected) in [
        (&["cook"][..], "errors refer to the polygon of the file's straight sides"),
        (&["article"], "the largest stress is at the end of a support, where it grows without limit"),
        (&["jump"], "the largest stress is at a point force, where it grows without limit"),
        (&["article", "--set", "load.0={kind='force',at=[3.4,0.2],force=[0,-10]}"], "acts on the nearest node, "),
    ] {
        let text = stdout(&warpbeam(&[&["solve"][..], args].concat()));
        assert!(text.contains(expected), "{args:?}: {text}");
        let warnings = solve_json(args)["warnings"].to_string();
        assert!(warnings.contains(expected), "{args:?}: {warnings}");
    }
    // Bending without a side force has no corner with infinite stress at ν = 0, and its ends are nodes.
    let bent = solve_json(&["roll-up"])["warnings"].clone();
    assert_eq!(bent, serde_json::json!([]));
}

/// Held points in one element say that their reactions depend on the mesh, and a point held twice that it has none. Of
/// others nothing is said, also of the stress of bending across the height from them, and a cut of a part without loads
/// carries nothing.
#[test]
fn held_points_say_when_their_reactions_mean_little() {
    let folder = tempfile::tempdir().unwrap();
    let beam = |at: &[f64]| {
        let supports: String = at
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let fix = if i == 0 { "[\"x\", \"y\"]" } else { "[\"y\"]" };
                format!("[[support]]\nat = [{x}, 0.0]\nacts_on = \"point\"\nfix = {fix}\n")
            })
            .collect();
        let body = "name = \"held\"\n[beam]\nlength = 2.0\nheight = 0.2\ncells = [40, 2]\nelement = \"q4\"\n[material]\n\
                    young = 2.1e11\npoisson = 0.3\ndensity = 7850.0\nthickness = 0.01\n[[load]]\nkind = \"force\"\nedge = \"right\"\nforce = [0.0, -12e3]\n\
                    [[probe]]\nname = \"tip\"\nedge = \"right\"\n";
        fs::write(folder.path().join("held.toml"), format!("{body}{supports}")).unwrap();
        let output = warpbeam_in(folder.path(), &["solve", "held.toml", "--json"]);
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()["warnings"].clone()
    };
    assert_eq!(beam(&[0.13, 1.57]), serde_json::json!([]));
    let cut = stdout(&warpbeam_in(folder.path(), &["section", "held.toml", "--at", "0.1"]));
    assert!(cut.contains("normal force N             0 N") && cut.contains("bending moment M         0 N m"), "{cut}");
    let close = beam(&[0.13, 0.14, 1.57]).to_string();
    for (support, is_named) in [("support.0", true), ("support.1", true), ("support.2", false)] {
        let note = format!("{support} holds a point of an element that another support holds: its reaction depends");
        assert_eq!(close.contains(&note), is_named, "{close}");
    }
    let twice = beam(&[0.13, 1.57, 1.57]).to_string();
    assert!(twice.contains("support.2 holds a point that other supports hold: it has no reaction"), "{twice}");
}

/// Above a certain size, certificates are computed on request only.
#[test]
fn large_scenes_are_certified_on_request() {
    let args = ["solve", "cantilever", "--set", "beam.cells=[320,160]", "--reference", "none"];
    let text = stdout(&warpbeam(&args));
    assert!(text.contains("not certified: ") && !text.contains("ρ = "), "{text}");
}
