//! Tests of `warpbeam limits`: its numbers are those of `solve`.

use std::fs;
use std::path::Path;

use crate::common::*;
use serde_json::Value;

/// Returns the strip of an element and a method.
fn strip<'a>(json: &'a Value, element: &str, method: &str) -> &'a Value {
    let mut strips = json["strips"].as_array().unwrap().iter();
    strips.find(|strip| strip["element"] == element && strip["method"] == method).unwrap()
}

/// Returns the numbers of a strip's row at a load: the load, the displacement, the error, NaN if it is not known, and others.
fn row(table: &str, strip: &str, factor: f64) -> Option<Vec<f64>> {
    let rows = table.lines().filter_map(|row| row.strip_prefix(strip)?.strip_prefix(','));
    let numbers = |row: &str| row.split(',').map(|v| v.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    rows.map(numbers).find(|row| (row[0] / factor - 1.0).abs() < 1e-9)
}

/// Returns the error of the first probe that `solve` states, with that of the reference, percent.
fn stated_error(solved: &Value) -> f64 {
    ["error_percent", "reference_error_percent"].map(|key| solved["probes"][0][key].as_f64().unwrap()).iter().sum()
}

/// Errors and displacements at the scene's own load are those of `solve`, and `warped` stops where `solve` stops.
#[test]
fn limits_are_those_of_solve() {
    let folder = tempfile::tempdir().unwrap();
    let json = json_in(folder.path(), &["limits", "article", "--json", "--out", "t.csv", "--picture", "t.svg"]);
    let strips = json["strips"].as_array().unwrap();
    assert_eq!(strips.len(), 9, "three elements, each with three methods");
    let table = fs::read_to_string(folder.path().join("t.csv")).unwrap();
    for strip in strips {
        let (element, method) = (strip["element"].as_str().unwrap(), strip["method"].as_str().unwrap());
        let set = [format!("beam.element=\"{element}\""), format!("solver.method=\"{method}\"")];
        let end = strip["converges_to"].as_f64();
        let row = row(&table, &format!("{element},{method}"), 1.0);
        assert_eq!(row.is_none(), end.is_some_and(|end| end < 1.0), "{element} {method} at the scene's load: {end:?}");
        if let Some(row) = row {
            let solved = solve_json(&["article", "--set", &set[0], "--set", &set[1]]);
            let wanted = stated_error(&solved);
            assert!((row[3] / wanted - 1.0).abs() < 1e-6, "{element} {method}: {row:?}, solve says {wanted}");
            assert!((row[2] - first_u(&solved).y).abs() < 1e-6, "{element} {method}: {row:?}");
        }
        assert!(end.is_none() || method == "warped", "newton solves every load: {strip}");
        // More load makes the error of linear theory larger.
        if method == "linear" {
            assert!(strip["within_1_percent"].as_f64() <= strip["within_5_percent"].as_f64(), "{strip}");
        }
    }
    assert!(strips.iter().any(|strip| strip["method"] == "warped" && strip["converges_to"].is_f64()));
    assert!(json["critical_load_factor"].is_null(), "a beam that is bent does not buckle");
    // Where a fine mesh folds, the reference is inaccurate: the error of a good element is not known there, that of one that
    // locks is large all the same.
    let [locks, good] = ["t3,newton", "t6,newton"].map(|strip| row(&table, strip, 10f64.sqrt()).unwrap()[3]);
    assert!(good.is_nan() && locks > 5.0 && strip(&json, "t6", "newton")["within_5_percent"].is_null(), "{locks}");
    let picture = fs::read_to_string(folder.path().join("t.svg")).unwrap();
    assert!(picture.contains("does not converge") && picture.contains("q4 newton"));
}

/// Next to buckling `warped` stops; its limit of 1 % is that of `newton`, whose results are the same. There the error has a
/// narrow peak, which is not missed.
#[test]
fn a_method_may_converge_again_beyond_buckling() {
    let json = json_in(Path::new("."), &["limits", "column", "--json"]);
    let [warped, newton] = ["warped", "newton"].map(|method| strip(&json, "t6", method));
    let number = |value: &Value| value.as_f64().unwrap();
    let [end, again] = ["converges_to", "converges_again_from"].map(|key| number(&warped[key]));
    let gaps: Vec<[f64; 2]> = serde_json::from_value(warped["does_not_converge"].clone()).unwrap();
    assert!(gaps[0] == [end, again] && again < 1.0 && gaps.len() == 2, "{gaps:?}");
    let [own, same] = [warped, newton].map(|strip| number(&strip["within_1_percent"]));
    assert!((own / same - 1.0).abs() < 0.01 && own < 0.72, "{own} {same}");
}

/// A scene that stops early has a strip of its own, with the errors that `solve` states.
#[test]
fn an_early_stop_has_a_strip() {
    let folder = tempfile::tempdir().unwrap();
    let settings = ["--set", "beam.element=\"q4\"", "--set", "beam.cells=[10,1]", "--set", "solver.accept_after=2"];
    let args = [&["limits", "cantilever", "--json", "--out", "t.csv"][..], &settings].concat();
    let json = json_in(folder.path(), &args);
    let strips = json["strips"].as_array().unwrap();
    assert_eq!(strips.len(), 10, "nine strips, and the one of the early stop");
    let early: Vec<_> = strips.iter().filter(|strip| strip["accept_after"] == 2).collect();
    assert!(early.len() == 1 && early[0]["element"] == "q4" && early[0]["method"] == "warped", "{early:?}");
    let table = fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let solved = solve_json(&[&["cantilever"][..], &settings].concat());
    let (own, wanted) = (row(&table, "q4,warped:2", 1.0).unwrap(), stated_error(&solved));
    assert!(solved["status"] == "accepted" && (own[3] / wanted - 1.0).abs() < 1e-6, "{own:?} {wanted}");
}

/// The load at which linear theory is 5 % off the exact beam is that of `curve`.
#[test]
fn the_limit_of_linear_theory_is_that_of_the_exact_beam() {
    let text = stdout(&warpbeam(&["curve", "elastica"]));
    let line = text.lines().find(|line| line.starts_with("linear theory differs by 5 %")).unwrap();
    let percent: f64 = line.split(" at ").nth(1).unwrap().split(" %").next().unwrap().parse().unwrap();
    let json = json_in(Path::new("."), &["limits", "elastica", "--json"]);
    let factor = strip(&json, "t6", "linear")["within_5_percent"].as_f64().unwrap();
    assert!((factor / (0.01 * percent) - 1.0).abs() < 0.1, "{factor}, curve: {percent} %");
}

/// Shorter steps have smaller errors, down to that of the mesh; the explicit one finishes up to where `solve` does.
#[test]
fn limits_of_a_motion_are_those_of_its_integrators() {
    let folder = tempfile::tempdir().unwrap();
    // A coarse mesh and a short motion keep the test short.
    let scene = ["jelly", "--json", "--set", "beam.cells=[8,2]", "--set", "dynamics.duration=0.5"];
    let args = [&["limits", "--out", "t.csv", "--picture", "t.svg"][..], &scene].concat();
    let json = json_in(folder.path(), &args);
    let strips = json["strips"].as_array().unwrap();
    let own = json["full_load"].as_f64().unwrap();
    assert_eq!((strips.len(), &json["load"]), (4, &"time step".into()));
    // All motions end at the end of a step of the longest.
    let duration = json["duration"].as_f64().unwrap();
    assert!((0.45..=0.5).contains(&duration), "{duration}");
    let table = fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let mesh = json["mesh_error_percent"].as_f64().unwrap();
    let mut smallest = f64::INFINITY;
    for strip in strips {
        let integrator = strip["integrator"].as_str().unwrap();
        let rows = table.lines().filter(|row| row.starts_with(&format!("{integrator},")));
        let number = |row: &str, column: usize| row.split(',').nth(column).unwrap().parse::<f64>().unwrap();
        let points: Vec<[f64; 2]> = rows.map(|row| [number(row, 1) / own, number(row, 4)]).collect();
        assert!(points.windows(2).all(|pair| (pair[1][0] / pair[0][0] - 2.0).abs() < 1e-9), "{integrator}: {points:?}");
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!(last[1] > first[1] || points.len() < 4, "{integrator}: {points:?}");
        // The error of the mesh is a part of each, and with the shortest steps of the best integrator nearly all of it.
        assert!(points.iter().all(|point| point[1] >= mesh), "{integrator}: {mesh}, {points:?}");
        smallest = points.iter().fold(smallest, |least, point| least.min(point[1]));
        let Some(end) = strip["converges_to"].as_f64() else { continue };
        assert!(end > 0.97 * last[0], "next to its end {integrator} may finish with a longer step: {end}, {points:?}");
        let finishes = |factor: f64| {
            let step = format!("dynamics.time_step={}", factor * own);
            let integrator = format!("dynamics.integrator=\"{integrator}\"");
            let args = [&["solve"][..], &scene, &["--set", &integrator, "--set", &step]].concat();
            parsed(&warpbeam(&args))["status"] != "stopped"
        };
        assert!(finishes(0.98 * end) && !finishes(1.05 * end), "{integrator}: {end}");
    }
    assert!(strips.iter().any(|strip| strip["integrator"] == "symplectic-euler" && strip["converges_to"].is_f64()));
    let picture = fs::read_to_string(folder.path().join("t.svg")).unwrap();
    assert!(picture.contains("stops early") && picture.contains("energy-momentum"));
    assert!(picture.contains("each error includes") && smallest < 1.1 * mesh + 0.1, "{smallest}, {mesh}");
}

/// The ends do not lie between loads that were tried far apart: an arch jumps at 28.6 kN, the error of a column reaches
/// 1 % at 198 N, and its critical load is Euler's.
#[test]
fn ends_are_those_of_single_solves() {
    let [jump, error, euler] = [28_600.0, 198.0, PI.powi(2) * 1e6 / 12.0 / (4.0 * 900.0)];
    for (name, element, key, wanted) in [
        ("limit-arch", "t3", "law_ends_at", jump / 8372.4),
        ("limit-column", "t6", "within_1_percent", error / 218.05),
        ("limit-column", "q4", "critical_load_factor", euler / 218.05),
    ] {
        let json = json_in(Path::new("."), &["limits", &file(name), "--json"]);
        let found = strip(&json, element, "newton")[key].as_f64().unwrap();
        assert!((found / wanted - 1.0).abs() < 0.015, "{element} {key}: {found}, {wanted}");
    }
}
