//! Tests scenes whose supports turn and move, and bodies that are held at points beyond their critical load. The right
//! values are those of shooting, of closed forms and of small load steps.

use crate::common::*;
use serde_json::Value;

/// Solves a scene with assignments.
fn solve(name: &str, set: &[String]) -> Value {
    let file = file(name);
    let set = set.iter().flat_map(|set| ["--set", set]);
    solve_json(&[&[file.as_str(), "--reference", "none"][..], &set.collect::<Vec<_>>()].concat())
}

/// Follows the path of a scene with assignments.
fn path(name: &str, set: &[String]) -> (Scene, LoadPath) {
    let scene = scene_with(&file(name), &set.iter().map(String::as_str).collect::<Vec<_>>());
    let path = LoadPath::of(&scene, &go_on).unwrap();
    (scene, path)
}

/// Returns assignments that turn both ends of a beam, and stretch it by this much.
fn turned_both(degrees: f64, length: f64, stretched: f64) -> Vec<String> {
    let (s, c) = degrees.to_radians().sin_cos();
    let [x, y] = [length * stretched * c - length, length * stretched * s];
    let turn = degrees.to_radians();
    vec![
        format!("support.0.turn={turn}"),
        format!("support.1.turn={turn}"),
        format!("support.1.displacement=[{x},{y}]"),
    ]
}

/// The path of a slender cantilever whose tip is moved across needs no short steps: at the tip one component is prescribed.
#[test]
fn a_moved_tip_takes_long_steps() {
    for (length, most) in [(20.0, 120), (100.0, 220)] {
        let scene = Scene::beam(length, 1.0).with_cells(length as u32, 2).with_element(ElementKind::Q4).clamp("left");
        let scene = scene.support([length, 0.0], &[Axis::Y]).moved([0.0, -0.8 * length], 0.0);
        let iterations = solved(&scene.with_method(MethodKind::Newton)).iterations();
        assert!(iterations <= most, "L/H = {length}: {iterations} iterations");
    }
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

/// A cantilever whose clamp is turned under a dead load follows the elastica, which shooting finds; `curve` agrees.
#[test]
fn a_turned_clamp_under_load_follows_the_elastica() {
    for (degrees, tip) in [(180.0, Some([-6.453, -0.339])), (179.0, Some([-6.411, -0.373])), (200.0, None)] {
        let set = vec![format!("support.0.turn={}", f64::to_radians(degrees))];
        for method in ["newton", "auto"] {
            let json = solve("catapult", &[&set[..], &[format!("solver.method={method}")]].concat());
            let u = first_u(&json);
            assert!(tip.is_none_or(|tip| (u - Vector2::from(tip)).norm() < 0.015), "{degrees}° {method}: {u}");
            assert!(json["stable"] == true && json["jumped"] == false && json["on_path_from_rest"] == true, "{json}");
            let end = path("catapult", &set).1.states.last().unwrap().probes[0];
            assert!((u - end).norm() < 1e-4, "{degrees}° {method}: {u} {end}");
        }
    }
    // Under less load, the path folds.
    let set = vec!["load.0.force=[0,-781.25]".to_owned()];
    let json = solve("catapult", &set);
    for factor in [json["jumped_at"].as_f64().unwrap(), path("catapult", &set).1.jump.unwrap().factor] {
        assert!((factor - 0.541).abs() < 3e-4, "{factor}");
    }
}

/// A rigid motion stores nothing, a stretch by a fifth E/2 · 0.2² per volume; a jump loses energy.
#[test]
fn the_work_of_turned_supports_is_the_stored_energy() {
    // On their straight way the ends come closer, which stores several kJ in the long beam in between.
    for (name, length, stretched, energy, off) in
        [("rigidboth", 12.0, 1.0, 0.0, 1.0), ("turnpull", 1.0, 1.2, 0.02, 2e-4)]
    {
        for degrees in [0.0, 30.0, 90.0, 135.0] {
            let json = solve(name, &turned_both(degrees, length, stretched));
            let [elastic, work] = ["elastic", "supports"].map(|key| json["energy"][key].as_f64().unwrap_or(0.0));
            let is_right = (elastic - energy).abs() < 0.01 * energy + 1e-9 && (work - elastic).abs() < off;
            assert!(is_right || json["jumped"] == true, "{name} {degrees}°: {work} J, {elastic} J, {json}");
        }
    }
}

/// A strip clamped at both ends, one of which moves, buckles and is stable again, where small steps find it.
#[test]
fn a_clamped_strip_loses_and_regains_its_stability() {
    let json = solve("clamped-strip", &[]);
    let [elastic, work] = ["elastic", "supports"].map(|key| json["energy"][key].as_f64().unwrap());
    assert!((elastic - 114.1).abs() < 0.2 && (work - elastic).abs() < 0.005 * elastic, "{elastic} {work}");
    assert!((json["buckles_at"].as_f64().unwrap() - 0.506).abs() < 2e-3 && json["stable"] == true, "{json}");
    assert!(json["iterations"].as_u64().unwrap() < 100, "{json}");
    let bifurcations = path("clamped-strip", &[]).1.bifurcations;
    let factors: Vec<f64> = bifurcations.iter().map(|bifurcation| bifurcation.factor).collect();
    assert!(factors.len() == 2 && (factors[1] - 0.778).abs() < 2e-3, "{bifurcations:?}");
    // A pinned strut that is swung is shortened: it buckles at the strain of Euler's load, and jumps.
    let json = solve("strut", &[]);
    let [buckles, jumps] = ["buckles_at", "jumped_at"].map(|key| json[key].as_f64().unwrap());
    assert!((buckles - 0.0022).abs() < 5e-5 && (jumps - 0.237).abs() < 1e-3, "{buckles} {jumps}");
    assert!(json["stable"] == true, "{json}");
}

/// The events of a path are told once, in its order, in words of what drives it.
#[test]
fn events_are_told_once_and_in_order() {
    let half = turned_both(90.0, 12.0, 1.0);
    let folded = vec!["load.0.force=[0,-781.25]".to_owned()];
    for (name, set) in [("catapult", folded), ("strut", vec![]), ("rigidboth", half), ("clamped-strip", vec![])] {
        let (scene, path) = path(name, &set);
        let claims = Claim::of_path(&scene, &path);
        let text: Vec<String> = claims.iter().map(ToString::to_string).collect();
        let events = claims.iter().filter(|claim| matches!(claim.id, "buckles" | "jumps"));
        let factors: Vec<f64> = events.map(|claim| claim.numbers[0]).collect();
        assert!(!factors.is_empty() && factors.windows(2).all(|pair| pair[0] < pair[1]), "{name}: {text:?}");
        let words = text.concat();
        assert!(!words.contains("force control") && !words.contains("not followed"), "{name}: {text:?}");
        assert!(path.jump.is_none_or(|jump| jump.distance.is_some_and(|distance| distance > 1e-3)), "{name}: {text:?}");
        assert!(path.states.windows(2).all(|pair| pair[0].factor <= pair[1].factor), "{name}");
    }
}

/// Linear theory turned by 360° is at rest again: there is no percent of that.
#[test]
fn an_error_has_no_percent_of_a_body_at_rest() {
    let file = file("spinstrip");
    let args = [file.as_str(), "--set", "solver.method=linear"];
    let json = solve_json(&args);
    assert!(json["probes"][0]["error_percent"].is_null(), "{json}");
    let text = solve_text(&args);
    assert!(text.contains("m from the result") && !text.contains("error 2"), "{text}");
    // Newton's method is at rest there, too.
    let (scene, path) = path("spinstrip", &[]);
    let end = path.states.last().unwrap();
    assert!(scene.solver.method != MethodKind::Linear && end.probes[0].norm() < 1e-9, "{end:?}");
}
