//! Tests that the sentences of the commands agree with the numbers of the result: warnings, units, plurals, and values
//! below the rounding error of their context.

use crate::common::*;

fn warnings(json: &serde_json::Value) -> Vec<&str> {
    json["warnings"].as_array().unwrap().iter().map(|warning| warning.as_str().unwrap()).collect()
}

/// A support whose motion needs no force has no limit load: its reaction is only rounding error.
#[test]
fn a_support_without_a_reaction_has_no_limit_load() {
    let beam = Scene::beam(2.0, 0.1).with_cells(40, 2).with_element(ElementKind::Q4);
    let beam = beam.with_material(Material::new(210e9, 0.3)).support("left", &[Axis::X]).moment("right", 2e5);
    let scene = beam.support([1.0, 0.05], &[Axis::Y]).moved([0.0, -0.005], 0.0);
    let claims = Claim::of_path(&scene, &LoadPath::of(&scene, &go_on).unwrap());
    assert!(claims.iter().all(|claim| claim.id != "limit_load"), "{claims:?}");
}

/// The text names the time step. Losses and small gains are reported without a warning.
#[test]
fn gained_energy_is_reported_and_ends_with_exit_code_1() {
    for args in [&["flick", "--set", "dynamics.time_step=.5"][..], &["tests/data/scenes/long-steps.toml"]] {
        let text = solve_text(args);
        assert!(text.contains("\ngained by the integrator ") && !text.contains("lost by the integrator"), "{text}");
        let note = text.lines().find(|line| line.starts_with("note: the integrator gained ")).unwrap();
        assert!(note.ends_with("of the energy put in: the time step is too long"), "{note}");
        let (code, json) = solve_end(args);
        assert_eq!((code, json["status"].as_str()), (Some(1), Some("finished")), "{json}");
        assert!(json["energy_drift_of_input"].as_f64().unwrap() > 0.1, "{json}");
        assert!(warnings(&json).iter().any(|said| said.ends_with("the time step is too long")), "{json}");
    }
    for id in ids_of(Analysis::Dynamic) {
        let text = succeeds(&["solve", id]);
        assert!(!text.contains("the time step is too long"), "{id}: {text}");
    }
}

/// The rotation of a probe has the definition of the largest rotation in every theory.
#[test]
fn a_probe_rotates_in_linear_theory_too() {
    let (_, json) = solve_end(&["cantilever", "--set", "solver.method=linear", "--set", "load.0.force=[0,-3000]"]);
    let (largest, own) = (&json["max_rotation_deg"], &json["probes"][0]["rotation_deg"]);
    let (largest, own) = (largest.as_f64().unwrap(), own.as_f64().unwrap());
    // The end of a cantilever rotates most.
    assert!(largest > 10.0 && own < 0.0 && (own.abs() / largest - 1.0).abs() < 0.05, "{own}° of {largest}°");
    // No probe rotates more than the largest rotation, on coarse meshes too.
    for method in ["linear", "newton"] {
        let (_, json) = solve_end(&["article", "--set", &format!("solver.method={method:?}")]);
        let (largest, own) = (&json["max_rotation_deg"], &json["probes"][0]["rotation_deg"]);
        assert!(own.as_f64().unwrap().abs() <= largest.as_f64().unwrap(), "{method}: {own}° of {largest}°");
    }
}

/// Values that are rounding errors beside others of their kind are 0 in the text, and numbers in JSON.
#[test]
fn rounding_errors_are_zero_in_text() {
    for id in ids_of(Analysis::Static) {
        let text = solve_text(&[id, "--reference", "none"]);
        // The last line has times; a residual is meant to be small.
        for line in text.lines().filter(|line| !line.starts_with("time ") && !line.contains("relative residual")) {
            assert!(!line.contains("e-9") && !line.contains("e-1"), "{id}: {line}");
            for unit in ["pPa", "nPa", "pJ", "pN", "pm"] {
                assert!(!line.contains(&format!(" {unit}")), "{id}: {line}");
            }
        }
    }
    // Pure stretch: the rotation is rounding error, the strain is not.
    let text = solve_text(&["stretch"]);
    assert!(text.contains("rotation 0°, strain ") && text.contains("largest rotation 0°, "), "{text}");
    // A rotation of the whole body causes no strain.
    let turned = ["cantilever", "--set", "load=[]", "--set", "support.0.turn=0.3", "--set", "solver.method=newton"];
    let text = solve_text(&turned);
    assert!(text.contains("largest strain 0 %") && text.contains("elastic energy 0 J"), "{text}");
    assert!(!text.contains("grows without limit"), "{text}");
}

/// Sentences of the study of a scene whose mesh is too coarse for small errors.
#[test]
fn a_study_says_which_errors_are_not_reached() {
    let folder = tempfile::tempdir().unwrap();
    write_square(folder.path(), &[SQUARE_LOAD, SQUARE_PROBE].join("\n"));
    let text = stdout(&warpbeam_in(folder.path(), &["study", "square.toml", "--quick", "--out", "out"]));
    assert!(text.contains("an error of 1 % is not reached by a measured setting"), "{text}");
    assert!(!text.contains("costs not reached"), "{text}");
}

/// Built-in meshes are in metres by definition; only files may be in another unit.
#[test]
fn a_built_in_scene_has_no_warning_of_its_unit() {
    for id in ids_of(Analysis::Static) {
        assert_eq!(stderr(&warpbeam(&["solve", id, "--reference", "none"])), "", "{id}");
    }
}
