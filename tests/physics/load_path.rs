//! Compares load paths with theory: critical loads, and the work of supports. Also tests paths that end early.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::common::*;
use warpbeam::study::PathEndReason;

const LENGTH: f64 = 40.0;

/// Returns a straight column of height and thickness 1, E = 1 MPa, compressed by `part` times π² E I/L².
fn column(part: f64, hold: impl Fn(Scene) -> Scene) -> Scene {
    let mut scene = Scene::beam(LENGTH, 1.0).with_cells(24, 1);
    (scene.material.young, scene.material.poisson) = (1e6, 0.0);
    let euler = PI * PI * 1e6 / 12.0 / (LENGTH * LENGTH);
    hold(scene).force("right", [-part * euler, 0.0]).probe("tip", "right")
}

/// Columns with every kind of support buckle there; each higher critical load on the path adds an unstable mode.
#[test]
fn columns_buckle_at_eulers_loads() {
    type Hold = fn(Scene) -> Scene;
    let free: Hold = |scene| scene.clamp("left");
    let pinned: Hold = |scene| scene.clamp("left").support("right", &[Axis::Y]);
    for (name, hold, part, factors) in [
        // Critical loads over π² E I/L²: 1/4, 9/4, 25/4 for a free end; 2.0457 for a pinned one (tan k = k).
        ("free", free, 0.4, &[0.25][..]),
        ("free", free, 3.0, &[0.25, 2.25]),
        ("free", free, 7.0, &[0.25, 2.25, 6.25]),
        ("pinned", pinned, 3.0, &[2.0457]),
    ] {
        for element in ElementKind::all().filter(|&e| e != ElementKind::T3) {
            let path = LoadPath::of(&column(part, hold).with_element(element), &go_on).unwrap();
            let words = format!("{name} {part} {element:?}: {:?}, {:?}", path.bifurcations, path.jump);
            assert!(path.end.is_none() && path.jump.is_none(), "{words}");
            assert_eq!(path.bifurcations.len(), factors.len(), "{words}");
            for (i, (found, factor)) in path.bifurcations.iter().zip(factors).enumerate() {
                // For a beam this slender, shear and shortening change the load by a few thousandths, and for higher
                // modes by a few hundredths.
                assert!((found.factor * part / factor - 1.0).abs() < [0.01, 0.03, 0.08][i], "{words}");
                assert_eq!(found.unstable_modes, [i, i + 1], "{words}");
            }
            for state in &path.states {
                let stable = state.factor < path.bifurcations[0].factor;
                assert_eq!(state.stable, Some(stable), "{words}: {}", state.factor);
            }
        }
    }
    // Below the critical load, or with a side load, the column does not buckle.
    assert_eq!(LoadPath::of(&column(0.2, free), &go_on).unwrap().bifurcations, []);
    assert_eq!(LoadPath::of(&column(0.4, free).force("right", [0.0, 0.3]), &go_on).unwrap().bifurcations, []);
}

#[test]
fn a_cancelled_path_is_reported_as_interrupted() {
    let asked = AtomicU32::new(0);
    let scene = scene("jump");
    let path = LoadPath::of(&scene, &|_| {
        if asked.fetch_add(1, Ordering::Relaxed) < 19 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    let path = path.unwrap();
    let (factor, reason) = path.end.unwrap();
    assert_eq!(reason, PathEndReason::Interrupted);
    let claims = Claim::of_path(&scene, &path);
    let text = claims.last().unwrap().to_string();
    assert!(factor > 0.0 && factor < 1.0 && text.contains("interrupted"), "{text}");
}

/// The command `curve` names the critical load, draws it, and calls states beyond it unstable; so does `solve`.
#[test]
fn commands_name_the_critical_load() {
    // About twice Euler's load, which is 514 N.
    let set = ["column", "--set", "load.0.force=[-1043,0]"];
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("path.svg");
    let text = stdout(&warpbeam(&[&["curve"][..], &set, &["--picture", picture.to_str().unwrap()]].concat()));
    let buckles = |text: &str| -> f64 {
        let percent = text.split("buckles at ").nth(1).unwrap_or_else(|| panic!("{text}"));
        percent.split(' ').next().unwrap().parse().unwrap()
    };
    assert!((buckles(&text) - 49.3).abs() < 0.1, "{text}");
    assert!(text.contains("the exact beam buckles at 49.2"), "{text}");
    let beyond = text.lines().filter(|line| line.ends_with("unstable") && line.contains(" %  (")).count();
    assert!(beyond > 3, "{text}");
    assert!(std::fs::read_to_string(picture).unwrap().contains("buckles at 49.3 %"));
    let json = solve_json(&set);
    assert!((json["buckles_at"].as_f64().unwrap() - 0.493).abs() < 1e-3 && json["stable"] == false, "{json}");
    assert!((buckles(&solve_text(&set)) - 49.3).abs() < 0.1);
    assert!(json["probes"][0]["error_percent"].is_null(), "{json}");
    assert!(solve_json(&["column"])["buckles_at"].is_null());
}

/// With moving supports, the residual is a positive number, not a zero in place of the rounding error.
#[test]
fn moved_supports_have_a_residual() {
    for moved in ["[0.0,0.0]", "[0.3,-2.0]"] {
        let set = format!("support.0.displacement={moved}");
        let json = solve_json(&["cantilever", "--set", &set, "--reference", "none"]);
        let [residual, floor] = ["residual", "residual_floor"].map(|key| json[key].as_f64());
        assert!(residual.unwrap() > 0.0, "{json}");
        assert!(residual.unwrap() <= 1e-8 || floor.is_some_and(|floor| residual.unwrap() <= floor), "{json}");
    }
    // A body that is only translated has no forces to compare the residual with.
    let simulation = solved(&scene_with("stretch", &["load.0.force=[0,0]", "support.0.displacement=[0.5,0]"]));
    assert!(simulation.residual().is_finite());
}
