//! Tests of commands beside other processes: signals, terminals, pipes and full disks; and of unsuitable files and options.

use std::fs;
use std::path::Path;

use crate::cli::{GOOD, read_table, same};
use crate::common::process::{Signal, interrupted, on_a_terminal};
use crate::common::*;

/// Arguments for a body that takes long to solve, with a reference solution that takes longer.
const LARGE: [&str; 5] = ["cantilever", "--set", "beam.cells=[400,40]", "--set", "solver.method=newton"];

/// Supports of a beam that is held at two points, the first of them beyond the cut.
const HELD: &str =
    "support=[{at=[2.13,0],acts_on=\"point\",fix=[\"x\",\"y\"]},{at=[5.57,0],acts_on=\"point\",fix=[\"y\"]}]";

/// A result that exists is printed, whatever was being computed when the signal came.
#[test]
fn interrupted_static_commands_print_their_partial_result() {
    let folder = tempfile::tempdir().unwrap();
    let interrupted = |args: &[&str], signal: Signal| interrupted(folder.path(), args, signal, || true);
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let json = parsed(&interrupted(&[&["solve", "--json", "--reference", "full"][..], &LARGE].concat(), signal));
        assert!(json["probes"][0]["u"][1].is_f64() && json["probes"][0]["reference_u"].is_null(), "{json}");
        assert!(["converged", "not_converged"].contains(&json["status"].as_str().unwrap()), "{json}");
        assert!(json["status"] == "converged" || json["reason"].as_str().unwrap().contains("interrupted"), "{json}");
    }
    let out = stdout(&interrupted(&[&["curve"][..], &LARGE].concat(), Signal::SIGINT));
    assert!(out.contains("not followed beyond ") && out.contains("interrupted"), "{out}");
    let said = stderr(&interrupted(&["tune", "cantilever"], Signal::SIGINT));
    assert!(said.contains("interrupted"), "{said}");
}

/// Numbered pictures of an earlier recording are not mixed with those of a new one.
#[cfg(feature = "app")]
#[test]
fn a_folder_of_pictures_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let record = |code: i32, seconds: &str, more: &[&str]| {
        let args = ["record", "swing", "--seconds", seconds, "--fps", "10", "--size", "64x64", "-o", "frames"];
        ends_in(folder.path(), code, &[&args[..], more].concat())
    };
    record(0, "0.4", &[]);
    let count = || fs::read_dir(&frames).unwrap().count();
    assert_eq!(count(), 5);
    fs::write(frames.join("frame-notes.txt"), "mine").unwrap();
    has_all(&record(2, "0.2", &[])[1], "has 5 numbered pictures; --overwrite replaces them");
    assert_eq!(count(), 6);
    record(0, "0.2", &["--overwrite"]);
    // Three pictures, and a file that is not a picture of a recording.
    assert_eq!(count(), 4);
}

/// A scene can be read from a pipe, even if an error in it is found only after reading.
#[test]
fn a_scene_is_read_from_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    for (edge, code) in [("left", 0), ("lift", 2)] {
        let toml = GOOD.replace("left", edge);
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

/// A name with commas remains one field.
#[test]
fn names_of_probes_are_fields() {
    let folder = tempfile::tempdir().unwrap();
    let beam = Scene::beam(10.0, 1.0).with_cells(10, 1).clamp("left").force("top", [0.0, -10.0]);
    let beam = beam.probe("tip, right \"end\"", "right").probe("middle", [5.0, 0.0]);
    fs::write(folder.path().join("a.toml"), beam.to_toml().unwrap()).unwrap();
    succeeds_in(folder.path(), &["curve", "a.toml", "--out", "a.csv"]);
    let csv = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let name = "\"tip, right \"\"end\"\"_u";
    assert!(csv.starts_with(&format!("load_factor,{name}_x\",{name}_y\",middle_u_x")), "{csv}");
}

/// A cut of a part without loads carries nothing.
#[test]
fn a_part_without_loads_carries_nothing() {
    let text = stdout(&warpbeam(&["section", "cantilever", "--at", "1", "--set", HELD]));
    has_all(&text, "normal force N             0 N|bending moment M         0 N m");
}

/// The result is still printed. A reader that closes its pipe is no error.
#[test]
fn failed_writes_end_with_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    for args in [&["solve", "article", "--json"][..], &["solve", "swing"], &["scenes"], &["curve", "elastica"]] {
        let output = program(folder.path(), args).stdout(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(stderr(&output).contains("standard output: "), "{args:?}: {}", stderr(&output));
    }
    for (id, name) in
        [("article", "x.csv"), ("swing", "x.csv"), ("article", "x.vtu"), ("swing", "x.vtu"), ("swing", "x.pvd")]
    {
        let path = folder.path().join(name);
        std::os::unix::fs::symlink("/dev/full", &path).unwrap();
        let output = warpbeam_in(folder.path(), &["solve", id, "--out", name, "--json"]);
        fs::remove_file(path).unwrap();
        assert_eq!(output.status.code(), Some(2), "{id} {name}");
        assert!(stderr(&output).contains("x."), "{id} {name}: {}", stderr(&output));
        assert!(["converged", "finished"].map(Into::into).contains(&parsed(&output)["status"]), "{id} {name}");
    }
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = program(folder.path(), &["solve", "article"]).stdout(writer).output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
}

/// Ctrl-C ends a long command, which writes its results up to then.
#[test]
fn an_interrupted_command_writes_its_partial_result() {
    let folder = tempfile::tempdir().unwrap();
    let interrupted = |args: &[&str], path: &str, bytes: u64| {
        let is_long = || fs::metadata(folder.path().join(path)).is_ok_and(|file| file.len() > bytes);
        interrupted(folder.path(), args, Signal::SIGINT, || path.is_empty() || is_long())
    };
    let long = ["solve", "swing", "--set", "dynamics.duration=1e5", "--out"];
    let output = interrupted(&[&long[..], &["swing.csv", "--json"]].concat(), "swing.csv", 20_000);
    assert!(stderr(&output).contains("partial"), "{}", stderr(&output));
    let json = parsed(&output);
    assert_eq!(json["status"], "stopped");
    let (header, rows) = read_table(&folder.path().join("swing.csv"));
    assert!(rows.iter().all(|row| row.len() == header.len()));
    assert_eq!(rows.len() as u64 - 1, json["steps"].as_u64().unwrap());
    assert!(same(rows.last().unwrap()[0], &json["time"]));

    let output = interrupted(&[&long[..], &["series.pvd"]].concat(), "series_0000.vtu", 0);
    assert!(stdout(&output).contains("stopped at"), "{}", stdout(&output));
    let pvd = fs::read_to_string(folder.path().join("series.pvd")).unwrap();
    assert!(roxmltree::Document::parse(&pvd).unwrap().descendants().any(|n| n.has_tag_name("DataSet")));

    let output = interrupted(&["extremes", "--out", "atlas"], "", 0);
    assert!(stderr(&output).contains("not in the atlas"), "{}", stderr(&output));
    let atlas = fs::read_to_string(folder.path().join("atlas/extremes.csv")).unwrap();
    let (header, rows) = table(&atlas);
    assert!(rows.iter().all(|row| row.len() == header.len()));

    for (args, missing) in [
        (&["study", "cantilever", "--out", "trade"][..], "the finer meshes|nothing has been measured"),
        (&["tune", "cantilever", "--error", "0.001%"], "nothing has been measured|finer meshes"),
    ] {
        let text = stderr(&interrupted(args, "", 0));
        assert!(missing.split('|').any(|words| text.contains(words)), "{args:?}: {text}");
    }
}

/// A progress bar is drawn on a terminal only: of a motion, and of a slow reference solution.
#[test]
fn long_commands_show_a_progress_bar_on_a_terminal() {
    let motion = ["solve", "swing", "--set", "dynamics.duration=60"];
    assert_eq!(ends_in(Path::new("."), 0, &motion)[1], "");
    let reference = [&["solve", "--reference", "full"][..], &LARGE].concat();
    for (args, words) in
        [(&motion[..], &[" of 60 s, ", " s per second", " left"][..]), (&reference, &["the reference solution, "])]
    {
        let (code, text) = on_a_terminal(Path::new("."), args);
        assert!(code == Some(0) && words.iter().all(|words| text.contains(words)), "{code:?} {text}");
    }
}

/// The path `-` is standard input; the scene's mesh file is found from the current folder.
#[test]
fn a_scene_is_read_from_standard_input() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    let solve = |text: &str, code: i32, message: &str| {
        let mut program = program(folder.path(), &["solve", "-", "--json"]);
        let pipe = std::process::Stdio::piped;
        let mut running = program.stdin(pipe()).stdout(pipe()).stderr(pipe()).spawn().unwrap();
        running.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let output = running.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
        stdout(&output)
    };
    assert!(solve(GOOD, 0, "").contains("\"scene\": \"Bar\""));
    fs::write(folder.path().join("square.msh"), include_str!("../data/square.msh")).unwrap();
    let beam = "[beam]\nlength = 2.0\nheight = 1.0\ncells = [4, 2]\n";
    let mesh = GOOD.replacen(beam, "[mesh]\nfile = \"square.msh\"\n", 1);
    solve(&mesh.replace("\"left\"", "\"wall\"").replace("edge = \"right\"", "at = [1.0, 1.0]"), 0, "");
    // An error that only the meshing finds names the line of the scene, also of a scene from standard input.
    solve(&GOOD.replacen("\"right\"", "\"rihgt\"", 1), 2, "-:17: load.0.edge: expected one of");
    solve("", 2, "-:1: name: expected a title, got nothing");
}

/// A path need not be valid UTF-8.
#[test]
fn paths_are_any_bytes() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(std::ffi::OsStr::from_bytes(b"sc\xffne.toml"));
    fs::write(&path, GOOD).unwrap();
    let output = program(folder.path(), &["solve"]).arg(&path).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}
