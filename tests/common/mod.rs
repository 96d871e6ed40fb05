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

pub use std::f64::consts::{PI, TAU};
pub use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};

pub use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
pub use warpbeam::assembly::{Forces, Kinematics, Matrix, Problem, System};
pub use warpbeam::element::{ELEMENTS, Tangent};
pub use warpbeam::method::METHODS;
pub use warpbeam::rotation::polar;
pub use warpbeam::scene::{Source, open, registry};
pub use warpbeam::study::{Claim, LoadPath};
pub use warpbeam::*;

pub use random::Random;

/// Observer that lets everything go on.
pub fn go_on(_: Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Returns `true` where sweeps run in full: by `scripts/test --all`.
pub fn sweeps_run_in_full() -> bool {
    std::env::var_os("WARPBEAM_ALL_SCENES").is_some()
}

/// Returns all cases of a sweep where sweeps run in full, and otherwise the first of every `stride` cases.
pub fn sampled<T>(cases: impl IntoIterator<Item = T>, stride: usize) -> Vec<T> {
    cases.into_iter().step_by(if sweeps_run_in_full() { 1 } else { stride }).collect()
}

/// Returns the seeds of a sweep from `WARPBEAM_SEED`, or `usual`, on: `all` where sweeps run in full, and otherwise `few`.
pub fn seeds(usual: u64, few: usize, all: usize) -> Vec<u64> {
    let first = std::env::var("WARPBEAM_SEED").map_or(usual, |seed| seed.parse().unwrap());
    (first..).take(if sweeps_run_in_full() { all } else { few }).collect()
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

/// Solves a scene, whatever the end.
pub fn ended(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(scene).unwrap();
    simulation.solve();
    simulation
}

/// Solves a scene; fails unless it ends so.
pub fn ends_as(scene: &Scene, status: &Status) -> Simulation {
    to_end(Simulation::new(scene).unwrap(), status)
}

fn to_end(mut simulation: Simulation, status: &Status) -> Simulation {
    simulation.solve();
    let (scene, element) = (simulation.scene(), simulation.mesh().element());
    let what = format!("{}, {element:?} {:?}, {:?}", scene.name, scene.solver.method, scene.dynamics.integrator);
    assert_eq!(simulation.status(), status, "{what}: residual {:e}", simulation.residual());
    simulation
}

/// Solves a scene; fails unless it converges.
pub fn solved(scene: &Scene) -> Simulation {
    ends_as(scene, &Status::Converged)
}

/// Solves a scene on a mesh; fails unless it converges.
pub fn solved_on(scene: &Scene, mesh: Mesh) -> Simulation {
    to_end(Simulation::with_mesh(scene, mesh).unwrap(), &Status::Converged)
}

/// Runs a motion; fails unless it finishes.
pub fn run(scene: &Scene) -> Simulation {
    ends_as(scene, &Status::Finished)
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

/// Asserts that a text has each of these parts, which `|` separates.
pub fn has_all(text: &str, parts: &str) {
    parts.split('|').for_each(|part| assert!(text.contains(part), "no {part:?}: {text}"));
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

/// Returns the JSON object of a command that succeeds in a folder.
pub fn json_in(folder: &Path, args: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeeds_in(folder, args)).unwrap()
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

/// Returns the exit code and the JSON object of `solve --json`, whatever the end.
pub fn solve_end(args: &[&str]) -> (Option<i32>, serde_json::Value) {
    let output = warpbeam(&[&["solve", "--json"], args].concat());
    (output.status.code(), parsed(&output))
}

/// Returns the text of `solve`, whatever the end.
pub fn solve_text(args: &[&str]) -> String {
    stdout(&warpbeam(&[&["solve"], args].concat()))
}

/// Returns the path of a scene of `tests/data/scenes`.
pub fn file(name: &str) -> String {
    format!("tests/data/scenes/{name}.toml")
}

/// Returns the output of `solve --json`; fails unless the solve converges.
pub fn solve_json(args: &[&str]) -> serde_json::Value {
    json_in(Path::new("."), &[&["solve", "--json"], args].concat())
}

/// Returns the displacement of the first probe, as `solve --json` prints it.
pub fn solve_u(args: &[&str]) -> Vector2<f64> {
    first_u(&solve_json(args))
}

/// Returns the displacement of the first probe of a JSON object.
pub fn first_u(json: &serde_json::Value) -> Vector2<f64> {
    [0, 1].map(|i| json["probes"][0]["u"][i].as_f64().unwrap()).into()
}

/// Returns the error of the first probe, percent, as `solve --json` prints it.
pub fn solve_error(args: &[&str]) -> f64 {
    solve_json(args)["probes"][0]["error_percent"].as_f64().unwrap()
}

/// Returns the dense matrix of a tangent of a state over the free unknowns, and the forces there.
pub fn dense(problem: &Problem, state: &State, tangent: Tangent) -> (DMatrix<f64>, Forces) {
    let pattern = problem.system().pattern();
    let (mut matrix, mut forces) = (Matrix::new(pattern), Forces::new(state.displacement().len()));
    problem.linearize(state, &mut forces, Some((tangent, &mut matrix)));
    (columns(problem, |unit, image| matrix.multiply(pattern, unit, image)), forces)
}

/// Returns the matrix of a linear map over the free unknowns.
pub fn columns(problem: &Problem, mut map: impl FnMut(&[f64], &mut [f64])) -> DMatrix<f64> {
    let n = problem.system().dofs();
    let mut dense = DMatrix::zeros(n, n);
    for column in 0..n {
        let mut unit = vec![0.0; n];
        unit[column] = 1.0;
        map(&unit, dense.column_mut(column).as_mut_slice());
    }
    dense
}

/// Returns the forces of a state.
pub fn forces_at(problem: &Problem, state: &State) -> Forces {
    let mut forces = Forces::new(state.displacement().len());
    problem.linearize(state, &mut forces, None);
    forces
}

/// Returns the components of a nodal vector at the free unknowns.
pub fn restrict(problem: &Problem, nodal: &[Vector2<f64>]) -> DVector<f64> {
    let mut free = DVector::zeros(problem.system().dofs());
    problem.system().pattern().restrict(nodal, free.as_mut_slice());
    free
}

/// Returns the derivative of the forces out of balance under a load factor by the free unknowns, N/m, by central differences.
pub fn numeric_stiffness(problem: &Problem, state: &State, factor: f64, step: f64) -> DMatrix<f64> {
    let out_of_balance = |unit: &[f64], by: f64| {
        let mut u = state.displacement().to_vec();
        problem.system().pattern().add_free(unit, by, &mut u);
        let mut moved = state.with_displacement(u).unwrap();
        problem.system().update_rotations(&mut moved, Kinematics::Corotated);
        let mut forces = forces_at(problem, &moved);
        problem.balance(&moved, Kinematics::Corotated, factor, &mut forces);
        restrict(problem, forces.residual())
    };
    columns(problem, |unit, image| {
        let change = out_of_balance(unit, -step) - out_of_balance(unit, step);
        image.copy_from_slice((change / (2.0 * step)).as_slice());
    })
}

/// Returns the distance of a state's strains from exact ones in the energy norm, relative to these. The rule has points and
/// weights on the cell.
pub fn strain_error(
    problem: &Problem,
    state: &State,
    rule: &[([f64; 2], f64)],
    exact: impl Fn(Vector2<f64>) -> Matrix2<f64>,
) -> f64 {
    let (system, moduli) = (problem.system(), problem.material().membrane());
    let (mesh, entry) = (system.mesh(), system.mesh().element().entry());
    let (u, rotations, mut strains) = (state.displacement(), state.rotations(), Vec::new());
    system.elements().visit_strains(moduli, u, rotations, &mut |_, _, strain| strains.push(*strain));
    let (mut error, mut energy) = (0.0, 0.0);
    for (own, strains) in mesh.elements().zip(strains.chunks(entry.points.len())) {
        let rest: Vec<_> = own.iter().map(|&n| mesh.nodes()[n as usize]).collect();
        for &(at, weight) in rule {
            let area = weight * entry.jacobian(&rest, at).determinant();
            let exact = exact(rest.iter().zip((entry.shape)(at)).map(|(x, n)| x * n).sum());
            let found: Matrix2<f64> = strains.iter().zip((entry.point_weights)(at)).map(|(s, w)| s * w).sum();
            error += area * moduli.energy_density(&(found - exact));
            energy += area * moduli.energy_density(&exact);
        }
    }
    (error / energy).sqrt()
}

/// Returns the displacement of a point that is given at rest; `None` outside of the body.
pub fn displacement_at(simulation: &Simulation, x: Vector2<f64>) -> Option<Vector2<f64>> {
    let (mesh, u) = (simulation.mesh(), simulation.displacement());
    let weights = mesh.weights(mesh.locate(x)?)?;
    Some(weights.iter().map(|&(node, weight)| u[node as usize] * weight).sum())
}

/// Returns all pairs of the entries of two lists.
pub fn pairs<A: Clone, B>(a: impl IntoIterator<Item = A>, b: impl IntoIterator<Item = B> + Clone) -> Vec<(A, B)> {
    a.into_iter().flat_map(|a| b.clone().into_iter().map(move |b| (a.clone(), b))).collect()
}

/// Both directions of a support.
pub const BOTH: &[Axis] = &[Axis::X, Axis::Y];

/// Returns the largest length of the vectors of a list.
pub fn largest(u: &[Vector2<f64>]) -> f64 {
    u.iter().map(|u| u.norm()).fold(0.0, f64::max)
}

/// Checks that a nodal vector is the gradient of a function, by central differences.
pub fn check_gradient(of: &[Vector2<f64>], step: f64, bound: f64, value: impl Fn(usize, Vector2<f64>) -> f64) {
    for (node, expected) in of.iter().enumerate() {
        let along = |axis: Vector2<f64>| (value(node, axis * step) - value(node, axis * -step)) / (2.0 * step);
        let found = Vector2::new(along(Vector2::x()), along(Vector2::y()));
        assert!((found - expected).amax() < bound, "node {node}: {found} {expected}");
    }
}

/// Returns the largest distance of the points of two lists.
pub fn largest_distance(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Writes the scene of a square with sides of 1 m, held at its wall, and its mesh into a folder; `more` has its loads.
pub fn write_square(folder: &Path, more: &str) -> String {
    std::fs::write(folder.join("square.msh"), include_str!("../data/square.msh")).unwrap();
    let body = "name = \"Square\"\nmesh.file = \"square.msh\"\nmaterial = { young = 1e4, poisson = 0.3 }\n";
    let text = format!("{body}support = [{{ edge = \"wall\", fix = [\"x\", \"y\"] }}]\n{more}\n");
    std::fs::write(folder.join("square.toml"), &text).unwrap();
    text
}

/// Load of [`write_square`], and its probe.
pub const SQUARE_LOAD: &str = "load = [{ kind = \"gravity\", acceleration = [0, -0.1] }]";
pub const SQUARE_PROBE: &str = "probe = [{ name = \"corner\", at = [1, 0] }]";

/// Returns a cantilever of height 1 and thickness 1 under the downward tip load P, given as α = P L² / (E I).
pub fn cantilever(length_over_height: f64, alpha: f64, set: &[&str]) -> Scene {
    let length = length_over_height;
    let force = alpha * 1e6 / 12.0 / (length * length);
    let own = [format!("beam.length={length}"), format!("load.0.force=[0,{}]", -force)];
    scene_with("elastica", &[&own.each_ref().map(String::as_str), set].concat())
}
