//! Functions shared by the test programs.
#![allow(dead_code, unused_imports, reason = "each program uses its part")]

pub mod alone;
#[cfg(all(feature = "app", target_os = "linux"))]
pub mod drop;
pub mod files;
#[cfg(feature = "app")]
pub mod lab;
pub mod motion;
#[cfg(feature = "app")]
pub mod pictures;
#[cfg(target_os = "linux")]
pub mod process;
pub mod random;

use std::path::Path;
use std::process::{Command, Output};

use warpbeam::scene::{Analysis, Scene, Source, open, registry};
use warpbeam::{Simulation, Status};

/// Returns `true` where sweeps run in full: by `scripts/test --all`.
pub fn sweeps_run_in_full() -> bool {
    std::env::var_os("WARPBEAM_ALL_SCENES").is_some()
}

/// Returns all cases of a sweep where sweeps run in full, and otherwise the first of every `stride` cases.
pub fn sampled<T>(cases: impl IntoIterator<Item = T>, stride: usize) -> Vec<T> {
    cases.into_iter().step_by(if sweeps_run_in_full() { 1 } else { stride }).collect()
}

/// Opens a built-in scene.
pub fn scene(id: &str) -> Scene {
    scene_with(id, &[])
}

/// Opens a built-in scene with `--set` assignments.
pub fn scene_with(id: &str, set: &[&str]) -> Scene {
    open(&Source { name: id.into(), assignments: set.iter().map(|s| (*s).to_owned()).collect() }).unwrap()
}

/// Returns the names of all built-in scenes.
pub fn scene_ids() -> Vec<&'static str> {
    registry::BUILT_IN.iter().map(|b| b.id).collect()
}

/// Returns the names of the built-in scenes with this kind of analysis.
pub fn ids_of(analysis: Analysis) -> Vec<&'static str> {
    scene_ids().into_iter().filter(|id| scene(id).analysis == analysis).collect()
}

/// Solves a scene; fails unless it converges.
pub fn solved(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(scene).unwrap();
    let status = simulation.solve().clone();
    assert_eq!(status, Status::Converged, "{}: residual {:e}", scene.name, simulation.residual());
    simulation
}

/// Runs the program.
pub fn warpbeam(args: &[&str]) -> Output {
    warpbeam_in(Path::new("."), args)
}

/// Runs the program in a folder, without a display.
pub fn warpbeam_in(folder: &Path, args: &[&str]) -> Output {
    program(folder, args).output().unwrap()
}

/// Returns the command that runs the program in a folder, without a display.
pub fn program(folder: &Path, args: &[&str]) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_warpbeam"));
    program.args(args).current_dir(folder);
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        program.env_remove(display);
    }
    program
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs the program in a folder; fails unless it ends with this exit code. Returns standard output and standard error.
pub fn ends_in(folder: &Path, code: i32, args: &[&str]) -> [String; 2] {
    let output = warpbeam_in(folder, args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {}", stderr(&output));
    [stdout(&output), stderr(&output)]
}

/// Returns the standard output of a command that succeeds.
pub fn succeeds(args: &[&str]) -> String {
    succeeds_in(Path::new("."), args)
}

pub fn succeeds_in(folder: &Path, args: &[&str]) -> String {
    let [text, _] = ends_in(folder, 0, args);
    text
}

/// Fails unless a command is refused with a message that contains this text.
pub fn refuses(args: &[&str], message: &str) {
    refuses_in(Path::new("."), args, message);
}

pub fn refuses_in(folder: &Path, args: &[&str], message: &str) {
    let [_, said] = ends_in(folder, 2, args);
    assert!(said.contains(message), "{args:?}: {said}");
}

/// Returns the JSON object that a command prints, whatever its exit code.
pub fn parsed(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", stderr(output)))
}

/// Returns the header of a CSV file, and its rows.
pub fn table(text: &str) -> (Vec<&str>, Vec<Vec<&str>>) {
    let mut rows = text.lines().map(|line| line.split(',').collect());
    (rows.next().unwrap_or_default(), rows.collect())
}

/// Returns the rows of a CSV file of numbers, without the header.
pub fn numbers(text: &str) -> Vec<Vec<f64>> {
    table(text).1.iter().map(|row| row.iter().map(|value| value.parse().unwrap()).collect()).collect()
}

/// Returns the output of `solve --json`; fails unless the solve converges.
pub fn solve_json(args: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeeds(&[&["solve", "--json"], args].concat())).unwrap()
}

/// Returns the displacement of the first probe, as `solve --json` prints it.
pub fn solve_u(args: &[&str]) -> nalgebra::Vector2<f64> {
    let json = solve_json(args);
    [0, 1].map(|i| json["probes"][0]["u"][i].as_f64().unwrap()).into()
}

/// Returns the error of the first probe, percent, as `solve --json` prints it.
pub fn solve_error(args: &[&str]) -> f64 {
    solve_json(args)["probes"][0]["error_percent"].as_f64().unwrap()
}

/// Returns the largest distance of the points of two lists.
pub fn largest_distance(a: &[nalgebra::Vector2<f64>], b: &[nalgebra::Vector2<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Row of `tests/data/cantilever.csv`. Lengths are in units of the beam's length.
#[derive(Debug)]
pub struct Row {
    pub gravity: bool,
    pub length_over_height: f64,
    pub alpha: f64,
    /// Angle of the load, rad.
    pub angle: f64,
    pub reissner: nalgebra::Vector2<f64>,
}

/// Reads the reference table of clamped beams.
pub fn cantilever_table() -> Vec<Row> {
    let text = include_str!("../data/cantilever.csv");
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .map(|line| {
            let (kind, numbers) = line.split_once(',').unwrap();
            let v: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
            Row {
                gravity: kind == "gravity",
                length_over_height: v[0],
                alpha: v[1],
                angle: v[2].to_radians(),
                reissner: nalgebra::Vector2::new(v[5], v[6]),
            }
        })
        .collect()
}

/// Returns a cantilever of height 1 and thickness 1 under the downward tip load P, given as α = P L² / (E I).
pub fn cantilever(length_over_height: f64, alpha: f64, set: &[&str]) -> Scene {
    let length = length_over_height;
    let force = alpha * 1e6 / 12.0 / (length * length);
    let mut all = vec![format!("beam.length={length}"), format!("load.0.force=[0,{}]", -force)];
    all.extend(set.iter().map(|s| (*s).to_owned()));
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    scene_with("elastica", &all)
}
