//! The command line as scripts see it: exit codes, messages, JSON, files.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::fs;

use common::{scene, scene_ids, solve_json, stderr, stdout, warpbeam, warpbeam_in};
use warpbeam::scene::{Scene, registry};

#[test]
fn every_command_has_help() {
    for args in [
        &["--help"][..],
        &["run", "--help"],
        &["scenes", "--help"],
        &["solve", "--help"],
        &["shot", "--help"],
        &["curve", "--help"],
    ] {
        let output = warpbeam(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}");
        let text = stdout(&output);
        assert!(text.contains("Usage: warpbeam"), "{args:?}: {text}");
        assert!(text.lines().all(|line| line.len() < 200));
    }
    for command in ["run", "scenes", "solve", "curve", "study", "extremes", "shot"] {
        assert!(stdout(&warpbeam(&["--help"])).contains(&format!("  {command}")));
    }
    assert!(stdout(&warpbeam(&["solve", "--help"])).contains("Exit codes"));
    assert!(stdout(&warpbeam(&["--version"])).starts_with("warpbeam "));
}

#[test]
fn scenes_lists_every_scene_with_its_sentence() {
    let text = stdout(&warpbeam(&["scenes"]));
    for id in scene_ids() {
        assert!(text.lines().any(|line| line.starts_with(id)), "{id}");
        assert!(text.contains(&scene(id).about), "{id}");
    }
}

#[test]
fn built_in_scenes_are_what_their_files_say() {
    for built_in in registry::BUILT_IN {
        let file = fs::read_to_string(format!("assets/scenes/{}.toml", built_in.id)).unwrap();
        assert_eq!(file, built_in.toml);
        // Through TOML and back.
        let scene = scene(built_in.id);
        let again = Scene::from_toml(&scene.to_toml().unwrap(), "copy".as_ref()).unwrap();
        assert_eq!(scene, again);
    }
    let files = fs::read_dir("assets/scenes").unwrap().count();
    assert_eq!(files, registry::BUILT_IN.len(), "a scene file that is not in the registry");
}

#[test]
fn json_has_every_field_of_the_contract() {
    for id in scene_ids() {
        let json = solve_json(&[id]);
        let keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
        let contract = [
            "scene",
            "element",
            "method",
            "dofs",
            "status",
            "stable",
            "iterations",
            "load_steps",
            "residual",
            "fixed_point_rho",
            "max_rotation_deg",
            "max_strain",
            "inverted_elements",
            "probes",
            "energy",
            "reaction",
            "time_us",
        ];
        assert_eq!(keys, contract, "{id}");
        assert_eq!(json["status"], "converged", "{id}");
        assert!(json["residual"].as_f64().unwrap() <= 1e-8);
        let probe = &json["probes"][0];
        for key in ["name", "x", "u", "truth_u", "error_percent"] {
            assert!(probe.get(key).is_some(), "{id}: {key}");
        }
        for (object, keys) in [
            ("energy", &["elastic", "external", "kinetic", "dissipated"][..]),
            ("reaction", &["force", "moment"]),
            ("time_us", &["total", "rotate", "assemble", "factorize", "solve"]),
        ] {
            for key in keys {
                assert!(json[object].get(key).is_some(), "{id}: {object}.{key}");
            }
        }
        let total = json["time_us"]["total"].as_f64().unwrap();
        let stages = ["rotate", "assemble", "factorize", "solve"].map(|k| json["time_us"][k].as_f64().unwrap());
        assert!((stages.iter().sum::<f64>() - total).abs() < 0.01 * total.max(1.0));
    }
}

#[test]
fn the_axial_bar_is_its_own_check() {
    let json = solve_json(&["stretch"]);
    assert!((json["probes"][0]["u"][0].as_f64().unwrap() - 0.4).abs() < 1e-9);
    assert!((json["energy"]["elastic"].as_f64().unwrap() - 10_000.0).abs() < 1e-3);
    assert!((json["reaction"]["force"][0].as_f64().unwrap() + 50_000.0).abs() < 1e-3);
}

#[test]
fn set_changes_any_value() {
    let json = solve_json(&["cantilever", "--set", "beam.cells=[20,2]", "--set", "solver.method=linear"]);
    assert_eq!((json["dofs"].as_u64(), json["method"].as_str()), (Some(120), Some("linear")));
    let double = solve_json(&["cantilever", "--set", "solver.method=linear", "--set", "load.0.force=[0,-2000]"]);
    let single = solve_json(&["cantilever", "--set", "solver.method=\"linear\""]);
    let tip = |json: &serde_json::Value| json["probes"][0]["u"][1].as_f64().unwrap();
    assert!((tip(&double) / tip(&single) - 2.0).abs() < 1e-9);
    // A table that the file leaves out.
    let scene = solve_json(&["shear", "--set", "solver.tolerance=1e-4"]);
    assert!(scene["residual"].as_f64().unwrap() > 1e-8);
}

#[test]
fn exit_code_1_for_a_solve_that_does_not_converge_and_the_result_is_still_printed() {
    let limit = warpbeam(&["solve", "cantilever", "--json", "--set", "solver.max_iterations=2"]);
    assert_eq!(limit.status.code(), Some(1));
    let json: serde_json::Value = serde_json::from_slice(&limit.stdout).unwrap();
    assert_eq!((json["status"].as_str(), json["iterations"].as_u64()), (Some("not_converged"), Some(2)));
    let diverged = warpbeam(&["solve", "cantilever", "--json", "--set", "load.0.force=[0,-9000]"]);
    assert_eq!(diverged.status.code(), Some(1));
    let json: serde_json::Value = serde_json::from_slice(&diverged.stdout).unwrap();
    assert_eq!(json["status"], "diverged");
    let words = stdout(&warpbeam(&["solve", "cantilever", "--set", "load.0.force=[0,-9000]"]));
    assert!(words.contains("too large for the iteration"), "{words}");
}

#[test]
fn results_are_written_as_csv_and_vtu() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str| {
        let path = folder.path().join(name);
        let output = warpbeam(&["solve", "article", "--out", path.to_str().unwrap()]);
        (output.status.code(), fs::read_to_string(path).unwrap_or_default(), stderr(&output))
    };
    let (code, csv, _) = run("nodes.csv");
    assert_eq!(code, Some(0));
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    assert_eq!((rows.len(), rows[0].len()), (12, 7));
    for row in &rows {
        assert!((row[1] + row[5] - row[3]).abs() < 1e-12 && (row[2] + row[6] - row[4]).abs() < 1e-12);
    }
    let (code, vtu, _) = run("mesh.vtu");
    assert_eq!(code, Some(0));
    assert!(vtu.contains("NumberOfPoints=\"12\" NumberOfCells=\"10\"") && vtu.contains("von Mises stress [Pa]"));
    let (code, _, message) = run("mesh.obj");
    assert_eq!(code, Some(2));
    assert!(message.contains(".csv or .vtu"), "{message}");
}

const GOOD: &str = r#"name = "Bar"
[beam]
length = 2.0
height = 1.0
cells = [4, 2]

[material]
young = 1.0e6
poisson = 0.3

[[support]]
edge = "left"
fix = ["x", "y"]

[[load]]
kind = "force"
edge = "right"
force = [0.0, -10.0]
"#;

/// The scene above with one line changed: exit code 2, one message with file and line that says what was expected.
#[test]
fn bad_scene_files_get_one_clear_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let cases: &[(&str, &str, Option<usize>, &str)] = &[
        // Missing keys.
        ("name = \"Bar\"\n", "", Some(1), "missing field `name`"),
        ("length = 2.0\n", "", Some(2), "missing field `length`"),
        ("poisson = 0.3\n", "", Some(7), "missing field `poisson`"),
        ("force = [0.0, -10.0]\n", "", Some(15), "force = [fx, fy] in N"),
        ("[[support]]\nedge = \"left\"\nfix = [\"x\", \"y\"]\n", "", None, "at least one [[support]]"),
        // Unknown keys and words.
        ("length = 2.0", "length = 2.0\nlenght = 3.0", Some(4), "unknown field `lenght`"),
        ("kind = \"force\"", "kind = \"wind\"", Some(16), "unknown variant `wind`"),
        ("cells = [4, 2]", "cells = [4, 2]\nelement = \"q4\"", Some(6), "unknown variant `q4`"),
        ("edge = \"right\"", "edge = \"rihgt\"", None, "expected one of bottom, left, right, top"),
        // Numbers out of range.
        ("length = 2.0", "length = -2.0", Some(3), "expected 1e-6 to 1000000 m, got -2"),
        ("height = 1.0", "height = 0.0", Some(4), "beam.height: expected"),
        ("height = 1.0", "height = nan", Some(4), "got NaN"),
        ("young = 1.0e6", "young = inf", Some(8), "got inf"),
        ("poisson = 0.3", "poisson = 0.6", Some(9), "expected -0.99 to 0.5, got 0.6"),
        ("poisson = 0.3", "poisson = 0.5\nplane = \"strain\"", Some(9), "to 0.4999, got 0.5"),
        ("force = [0.0, -10.0]", "force = [0.0, nan]", Some(18), "load.0.force: expected"),
        ("cells = [4, 2]", "cells = [0, 2]", Some(5), "beam.cells: expected 1 to"),
        ("cells = [4, 2]", "cells = [1000000000, 1]", Some(5), "beam.cells: expected 1 to 100000"),
        ("cells = [4, 2]", "cells = [31623, 31623]", Some(5), "cells in all"),
        ("cells = [4, 2]", "cells = [99999999999, 1]", Some(5), "99999999999"),
        // Wrong types.
        ("length = 2.0", "length = \"2 m\"", Some(3), "invalid type: string \"2 m\", expected f64"),
        ("cells = [4, 2]", "cells = 4", Some(5), "expected an array"),
        ("cells = [4, 2]", "cells = [4.5, 2]", Some(5), "expected u32"),
        ("edge = \"left\"", "edge = \"left\"\nat = [0.0, 0.0]", Some(11), "got both"),
        ("fix = [\"x\", \"y\"]", "fix = [\"x\"]", None, "can still move freely"),
        ("fix = [\"x\", \"y\"]", "fix = [\"z\"]", Some(13), "unknown variant `z`"),
        // Not TOML.
        ("[material]", "[material", Some(7), "unclosed table"),
        ("name = \"Bar\"", "{ \"name\": \"Bar\" }", Some(1), ""),
    ];
    fs::write(&path, GOOD).unwrap();
    assert_eq!(warpbeam(&["solve", path.to_str().unwrap()]).status.code(), Some(0));
    for (old, new, line, message) in cases {
        assert!(GOOD.contains(old));
        fs::write(&path, GOOD.replacen(old, new, 1)).unwrap();
        for command in [&["solve"][..], &["shot", "-o", "never.png"]] {
            let output = warpbeam(&[command, &[path.to_str().unwrap()]].concat());
            let text = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{new}: {text}");
            assert!(output.stdout.is_empty());
            assert!(text.contains(message), "{new}: {text}");
            assert_eq!(text.trim().lines().count(), 1, "{new}: {text}");
            assert!(text.contains("scene.toml"), "{new}: {text}");
            if let Some(line) = line {
                assert!(text.contains(&format!("scene.toml:{line}:")), "{new}: line {line} in {text}");
            }
        }
    }
}

#[test]
fn unreadable_files_and_wrong_usage_get_one_clear_message() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = folder.path().join("bytes.toml");
    fs::write(&bytes, [0xff, 0xfe, 0x00]).unwrap();
    let bytes = bytes.to_str().unwrap();
    let cases: &[(&[&str], &str)] = &[
        (&["solve", "no-such-scene"], "built-in scenes: article, cantilever"),
        (&["solve", folder.path().to_str().unwrap()], "not a file"),
        (&["solve", bytes], "UTF-8"),
        (&["solve", "article", "--set", "material.young"], "expected PATH=VALUE"),
        (&["solve", "article", "--set", "material.young=-1"], "--set material.young=-1: expected"),
        (&["solve", "article", "--set", "material.yuong=1"], "unknown field `yuong`"),
        (&["solve", "article", "--set", "load.3.force=[0,1]"], "expected an index below 1, got 3"),
        (&["solve", "article", "--set", "load.0.force=[0]"], "--set load.0.force=[0]"),
        (&["solve", "article", "--set", "name.x=1"], "expected a table or a list"),
        (&["solve", "article", "--set", "beam.cells=[1000000000,1]"], "expected 1 to 100000"),
        (&["solve"], "SCENE"),
        (&["melt"], "melt"),
        (&["shot", "article", "-o", "x.png", "--size", "10x10"], "64 to 8192"),
        (&["shot", "article", "-o", "x.png", "--size", "big"], "WIDTHxHEIGHT"),
        (&["shot", "article", "-o", "/no/such/folder/x.png"], "/no/such/folder/x.png"),
        (&["solve", "article", "--out", "/no/such/folder/x.csv"], "/no/such/folder/x.csv"),
    ];
    for (args, message) in cases {
        let output = warpbeam(args);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(text.contains(message), "{args:?}: {text}");
        assert!(!text.contains("panicked"), "{text}");
    }
}

#[test]
fn without_a_display_run_says_so_and_draws() {
    let folder = tempfile::tempdir().unwrap();
    for args in [&[][..], &["run", "stretch"]] {
        let output = warpbeam_in(folder.path(), args);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = stdout(&output);
        assert!(text.starts_with("No window: ") && text.contains("converged after"), "{text}");
        let picture = folder.path().join("warpbeam.png");
        assert!(fs::metadata(&picture).unwrap().len() > 10_000);
        fs::remove_file(picture).unwrap();
    }
}

#[test]
fn without_an_adapter_shot_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_warpbeam"))
        .args(["shot", "article", "-o", "x.png"])
        .current_dir(folder.path())
        .env("VK_DRIVER_FILES", "/dev/null")
        .env("VK_ICD_FILENAMES", "/dev/null")
        .env("WGPU_BACKEND", "vulkan")
        .output()
        .unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("no usable graphics adapter") && text.contains("mesa-vulkan-drivers"), "{text}");
}

#[test]
fn curve_prints_linear_theory_beside_the_truth_and_every_method() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("curve.csv");
    let output = warpbeam(&["curve", "elastica", "--out", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for words in [
        "off by 3 %",
        "off by 5 %",
        "off by 10 %",
        "linear  at full load",
        "warped  at",
        "diverged",
        "newton  at full load",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let rows: Vec<Vec<f64>> = fs::read_to_string(path)
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|v| v.parse().unwrap()).collect())
        .collect();
    // The full load's row is the truth that solve compares with.
    let full = rows.iter().find(|r| (r[0] - 1.0).abs() < 1e-9).unwrap();
    let truth = &solve_json(&["elastica"])["probes"][0]["truth_u"];
    assert!((full[3] - truth[0].as_f64().unwrap()).abs() < 1e-6 && (full[4] - truth[1].as_f64().unwrap()).abs() < 1e-6);
    let none = warpbeam(&["curve", "shear"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(stderr(&none).contains("no truth is known"));
}

/// Sentences of the physics that the JSON carries: certificate, ρ, truth and error.
#[test]
fn json_certifies_its_result() {
    let json = solve_json(&["elastica"]);
    assert_eq!(json["stable"], true);
    assert!(json["fixed_point_rho"].as_f64().unwrap() > 3.5);
    assert!(json["probes"][0]["error_percent"].as_f64().unwrap() < 0.3);
    let linear = solve_json(&["elastica", "--set", "solver.method=linear"]);
    assert!(linear["stable"].is_null() && linear["fixed_point_rho"].is_null());
    assert!(linear["probes"][0]["error_percent"].as_f64().unwrap() > 100.0);
    let none = solve_json(&["shear"]);
    assert!(none["probes"][0]["truth_u"].is_null() && none["probes"][0]["error_percent"].is_null());
}

/// The stability atlas: every case classified, everything finite, every count accounted for.
#[test]
fn extremes_writes_the_stability_atlas() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("atlas");
    let output = warpbeam(&["extremes", "--quick", "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let csv = fs::read_to_string(out.join("extremes.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(rows.len() >= 150 && rows.iter().all(|row| row.len() == 13));
    for row in &rows {
        for value in row[3..8].iter().chain(&row[9..]) {
            assert!(value.parse::<f64>().unwrap().is_finite(), "{row:?}");
        }
    }
    let count = |element: &str, method: &str, outcome: &str| {
        rows.iter().filter(|r| (r[0], r[1]) == (element, method) && (outcome.is_empty() || r[8] == outcome)).count()
    };
    for element in ["t3", "t6"] {
        let all = count(element, "newton", "");
        // What rounding takes: L/H = 1000 with ν = 0.4999, and a cube under a thousand times what bends it.
        assert!(count(element, "newton", "certified") * 100 >= 80 * all, "{element}");
        assert!(count(element, "warped", "limit_cycle") > count(element, "newton", "limit_cycle"), "{element}");
        // Every starting state, however bad, ends in a certified equilibrium.
        let bad_starts: Vec<_> =
            rows.iter().filter(|r| (r[0], r[1]) == (element, "newton") && r[2] != "rest").collect();
        assert!(bad_starts.len() >= 12 && bad_starts.iter().all(|r| r[8] == "certified"), "{bad_starts:?}");
    }
    // The summary's counts are those of the table, and the picture is there.
    let summary = stdout(&output);
    assert_eq!(summary, fs::read_to_string(out.join("extremes.txt")).unwrap());
    let certified = count("t6", "newton", "certified");
    assert!(summary.lines().any(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.starts_with(&["t6", "newton"]) && words[2] == certified.to_string()
    }));
    assert!(fs::read_to_string(out.join("extremes.svg")).unwrap().contains("limit cycle"));
    assert!(fs::metadata(out.join("extremes.png")).unwrap().len() > 10_000);
}

/// The trade: errors split, times positive, the front the front, the files there.
#[test]
fn study_measures_error_against_time() {
    let folder = tempfile::tempdir().unwrap();
    for (id, source) in [
        ("cantilever", "the exact beam"),
        ("bracket", "the t6 solution of its refined mesh"),
        ("shear", "a fine t6 solution"),
        ("article", "a fine t6 solution"),
    ] {
        let out = folder.path().join(id);
        let output = warpbeam(&["study", id, "--quick", "--out", out.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{id}: {}", stderr(&output));
        let summary = stdout(&output);
        // Every truth says how wrong it may be itself.
        let own = summary.lines().next().unwrap().split("its own error about ").nth(1);
        let own: Option<f64> = own.and_then(|t| t.split(' ').next()).map(|t| t.parse().unwrap());
        assert!(own.is_some_and(|own| own > 0.0 && own < 5.0), "{summary}");
        // Beam theory is no truth of a stubby beam under large strains.
        assert_eq!(summary.contains("beam theory, with its small strains"), id == "article", "{summary}");
        assert!(summary.contains(source) && summary.contains("an error of 10 % costs"), "{id}: {summary}");
        let csv = fs::read_to_string(out.join("study.csv")).unwrap();
        let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
        let number = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
        for row in &rows {
            assert!(row[7..17].iter().all(|v| v.parse::<f64>().unwrap().is_finite()), "{row:?}");
            assert!(
                number(row, 7) > 0.0
                    && (number(row, 16) - number(row, 13) - number(row, 14) - number(row, 15)).abs()
                        < 1e-9 * number(row, 16).max(1.0)
            );
            // The parts are distances on the way from the result to the truth: the whole is no longer than all of them.
            let parts = number(row, 13) + number(row, 14) + number(row, 15);
            assert!(number(row, 12) <= parts * (1.0 + 1e-6) + 1e-4, "{row:?}");
            assert!(["linear", "auto"].contains(&row[4]) || number(row, 15) == 0.0, "{row:?}");
        }
        // Nothing beats the front, and the front beats something.
        let front: Vec<&Vec<&str>> = rows.iter().filter(|r| r[17] == "true").collect();
        assert!(!front.is_empty() && front.len() < rows.len());
        for f in &front {
            let beaten = rows.iter().any(|r| number(r, 7) < number(f, 7) && number(r, 16) < number(f, 16));
            assert!(!beaten, "{f:?}");
        }
        assert!(fs::read_to_string(out.join("study.svg")).unwrap().contains("Pareto front"));
        assert!(fs::metadata(out.join("study.png")).unwrap().len() > 10_000);
    }
    // Locking is not mistaken for warping: converged T3 is all discretization, linear T6 all model.
    let csv = fs::read_to_string(folder.path().join("cantilever/study.csv")).unwrap();
    let row = |element: &str, method: &str| {
        let mut rows = csv.lines().map(|l| l.split(',').collect::<Vec<_>>());
        let last = rows.rfind(|r| r[0] == element && r[4] == method && r[1] == "20" && r[6] == "true").unwrap();
        [12, 13, 14, 15].map(|c| last[c].parse::<f64>().unwrap())
    };
    let [total, discretization, iteration, model] = row("t3", "newton");
    assert!(total > 10.0 && (discretization - total).abs() < 1e-6 && iteration < 1e-6 && model == 0.0);
    let [total, discretization, _, model] = row("t6", "linear");
    assert!(total > 5.0 && discretization < 0.5 && (model - total).abs() < 0.5);
}

/// `auto` measures, chooses, says why, and stays within what was asked; what cannot be had ends with exit code 1.
#[test]
fn auto_chooses_a_setting_that_meets_the_demand() {
    for (id, force, asked) in [
        ("cantilever", "[0,-1000]", 5.0),
        ("cantilever", "[0,-1000]", 1.0),
        ("cantilever", "[0,-2]", 1.0),
        ("elastica", "[0,-20]", 2.0),
    ] {
        let set = [format!("load.0.force={force}"), format!("solver.max_error_percent={asked}")];
        let json = solve_json(&[
            id,
            "--set",
            "solver.method=auto",
            "--set",
            "solver.budget_ms=1e5",
            "--set",
            &set[0],
            "--set",
            &set[1],
        ]);
        let auto = &json["auto"]["choice"];
        assert_eq!(auto["met"], true, "{json}");
        let chosen = &auto["chosen"];
        let bound = chosen["error_percent"]["at_most"].as_f64().unwrap();
        assert!(bound <= asked, "{json}");
        assert_eq!(chosen["element"], json["element"]);
        assert_eq!(chosen["method"], json["method"]);
        let error = json["probes"][0]["error_percent"].as_f64().unwrap();
        assert!(error <= bound * (1.0 + 1e-6) && error <= asked, "{error} % of {bound} %: {json}");
        assert!(auto["settings_meeting"].as_u64().unwrap() >= 1);
        assert_eq!(json["auto"]["thrift"].is_null(), json["method"] != "auto");
    }
    // A truth without formula counts with its own error.
    let json = solve_json(&["bracket", "--set", "solver.method=auto", "--set", "solver.budget_ms=1e5"]);
    assert!(json["auto"]["choice"]["chosen"]["error_percent"]["truth"].as_f64().unwrap() > 0.0);
    // In words; and a demand nothing meets.
    let text =
        stdout(&warpbeam(&["solve", "cantilever", "--set", "solver.method=auto", "--set", "solver.budget_ms=1e5"]));
    assert!(
        text.contains("settings measured here meet at most 1 % error and 100000 ms a frame; the fastest:"),
        "{text}"
    );
    let hopeless = warpbeam(&["solve", "cantilever", "--set", "solver.method=auto", "--set", "solver.budget_ms=1e-6"]);
    assert_eq!(hopeless.status.code(), Some(1));
    assert!(stdout(&hopeless).contains("none of"), "{}", stdout(&hopeless));
    // Nothing to measure at: the scene's own mesh, and the decisions while it runs.
    let text = stdout(&warpbeam(&["solve", "article", "--set", "probe=[]", "--set", "solver.method=auto"]));
    assert!(text.contains("method auto") && text.contains("estimated error"), "{text}");
    assert_eq!(warpbeam(&["solve", "article", "--set", "solver.max_error_percent=0"]).status.code(), Some(2));
}
