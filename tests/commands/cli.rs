//! Tests of the command line for scripts: exit codes, messages, JSON, files.

use std::fs;
use std::path::Path;

use crate::common::*;

#[test]
fn scenes_lists_every_scene_with_its_sentence() {
    let text = stdout(&warpbeam(&["scenes"]));
    for id in scene_ids() {
        assert!(text.lines().any(|line| line.starts_with(id)), "{id}");
        assert!(text.contains(&scene(id).about), "{id}");
    }
}

/// The keys are compared with `docs/reference/results.md` in `docs.rs`.
#[test]
fn json_of_a_body_at_rest_is_complete() {
    for id in ids_of(Analysis::Static) {
        let json = solve_json(&[id]);
        assert_eq!(json["status"], "converged", "{id}");
        assert!(json["residual"].as_f64().unwrap() <= 1e-8);
        // A body at rest has no kinetic energy and no dissipation: absent values are null.
        assert!(json["energy"]["kinetic"].is_null() && json["energy"]["dissipated"].is_null());
        // The solve time is the sum of its stages, and the reported times sum to the total.
        let time = |key: &str| json["time_us"][key].as_f64().unwrap();
        let solve: f64 = ["rotate", "assemble", "factorize", "solve"].map(time).iter().sum();
        let beside: f64 = ["certify", "set_up", "stress", "reference", "other"].map(time).iter().sum();
        assert!((solve - time("total")).abs() < 1e-6 * solve, "{id}: {solve} of {} µs", time("total"));
        assert!((solve + beside - time("wall")).abs() < 1e-6 * time("wall"), "{id}: {solve} + {beside} µs");
        // Linear theory has no certificate of its own, but the load path is followed to its critical load.
        assert!(json["time_us"]["certify"].as_f64().unwrap() > 0.0, "{id}");
        assert_eq!(json["stable"].is_null(), json["method"] == "linear", "{id}");
        assert!(json["reason"].is_null(), "{id}");
    }
}

/// A motion has the same object with additional fields. Its energy ledger balances, and its energy drift is small.
#[test]
fn json_of_a_motion_has_its_energy_ledger() {
    for integrator in ["implicit-euler", "tr-bdf2", "energy-momentum"] {
        let choice = format!("dynamics.integrator={integrator}");
        let json = solve_json(&["swing", "--set", &choice, "--set", "dynamics.duration=0.5"]);
        let what = (json["status"].as_str(), json["integrator"].as_str(), json["steps"].as_u64());
        assert_eq!(what, (Some("finished"), Some(integrator), Some(30)));
        assert!((json["time"].as_f64().unwrap() - 0.5).abs() < 1e-9);
        let energy = |key: &str| json["energy"][key].as_f64().unwrap_or_else(|| panic!("{integrator}: {key}"));
        let lost = energy("dissipated") + energy("integrator") - energy("pulses") - energy("mouse_spring");
        let sum = energy("kinetic") + energy("elastic") - energy("external") + lost;
        assert!(sum.abs() < 1e-9 * energy("external"), "{integrator}: the terms of the ledger sum to {sum} J");
        assert!(json["energy_drift"].as_f64().unwrap() < 1e-6);
        assert!(json["momentum"]["linear"][1].as_f64().unwrap() < 0.0 && json["momentum"]["angular"].is_number());
    }
    let (code, json) = solve_end(&["swing", "--set", "dynamics.integrator=symplectic-euler"]);
    assert_eq!((code, json["status"].as_str()), (Some(1), Some("stopped")));
    assert!(json["critical_step"].as_f64().unwrap() < 1e-3);
}

#[test]
fn set_changes_any_value() {
    let json = solve_json(&["cantilever", "--set", "beam.cells=[10,1]", "--set", "solver.method=linear"]);
    assert_eq!((json["dofs"].as_u64(), json["method"].as_str()), (Some(120), Some("linear")));
    let double = solve_u(&["cantilever", "--set", "solver.method=linear", "--set", "load.0.force=[0,-3000]"]);
    let single = solve_u(&["cantilever", "--set", "solver.method=\"linear\""]);
    assert!((double.y / single.y - 2.0).abs() < 1e-9);
    // A table that the file does not contain.
    assert!(solve_json(&["shear", "--set", "solver.tolerance=1e-4"])["residual"].as_f64().unwrap() > 1e-8);
}

#[test]
fn results_are_written_as_csv_and_vtu() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str| {
        succeeds_in(folder.path(), &["solve", "article", "--out", name]);
        fs::read_to_string(folder.path().join(name)).unwrap()
    };
    let rows = numbers(&written("nodes.csv"));
    assert_eq!((rows.len(), rows[0].len()), (12, 17));
    for row in &rows {
        assert!((row[1] + row[5] - row[3]).abs() < 1e-12 && (row[2] + row[6] - row[4]).abs() < 1e-12);
    }
    let vtu = written("mesh.vtu");
    assert!(vtu.contains("NumberOfPoints=\"12\" NumberOfCells=\"10\"") && vtu.contains("von Mises (Cauchy) [Pa]"));
}

/// Returns the columns and the rows of a CSV file of numbers.
pub fn read_table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    (table(&text).0.into_iter().map(str::to_owned).collect(), numbers(&text))
}

/// Returns `true` if a number equals one in a JSON text, which `serde_json` parses to all but the last digit.
pub fn same(number: f64, json: &serde_json::Value) -> bool {
    (number - json.as_f64().unwrap()).abs() <= 1e-14 * number.abs()
}

/// The table has a row for every step. The last one is the result, and the energy ledger balances in every row.
#[test]
fn a_motion_is_written_as_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    for (id, integrator, iterations) in [
        ("swing", "tr-bdf2", 1),
        ("swing", "energy-momentum", 0),
        ("jelly", "implicit-euler", 1),
        ("flick", "tr-bdf2", 1),
    ] {
        let set = [format!("dynamics.integrator={integrator}"), format!("dynamics.iterations={iterations}")];
        let args = [id, "--set", &set[0], "--set", &set[1], "--set", "dynamics.duration=0.5"];
        let json = solve_json(&[&args[..], &["--out", path.to_str().unwrap()]].concat());
        let (header, rows) = read_table(&path);
        let (probe, from) = (&json["probes"][0], header.len() - 7);
        let name = probe["name"].as_str().unwrap();
        let columns = ["x", "y", "u_x", "u_y", "v_x", "v_y"].map(|c| format!("{name}_{c}"));
        assert_eq!((&*header[0], &header[1..7]), ("t", &columns[..]));
        let energies = ["kinetic", "elastic", "potential", "dissipated", "integrator", "pulses", "mouse_spring"];
        assert_eq!(header[from..], energies);
        let steps = json["steps"].as_u64().unwrap() as usize;
        assert_eq!((rows.len(), steps > 20), (steps + 1, true), "{id}");
        assert!(rows.windows(2).all(|w| w[1][0] > w[0][0]) && rows[0][0] == 0.0, "{id}: times increase");
        let last = rows.last().unwrap();
        let seen = [&json["time"], &probe["x"][0], &probe["x"][1], &probe["u"][0], &probe["u"][1]];
        let kept = energies.iter().enumerate().filter(|(_, key)| **key != "potential");
        let kept = kept.map(|(at, key)| (last[from + at], &json["energy"][key]));
        for (column, value) in last.iter().copied().zip(seen).chain(kept) {
            assert!(same(column, value), "{id}: {column} {value}");
        }
        let sum = |row: &[f64]| row[from..from + 5].iter().sum::<f64>() - row[from + 5] - row[from + 6];
        let largest = rows.iter().flat_map(|r| &r[from..]).fold(0.0_f64, |m, v| m.max(v.abs()));
        for row in &rows {
            assert!((sum(row) - sum(&rows[0])).abs() < 1e-9 * largest, "{id}, {integrator}: the ledger of {row:?}");
        }
        // The velocity is the derivative of the displacement, for steps that resolve it.
        let h = rows[1][0] - rows[0][0];
        let fastest = rows.iter().map(|r| r[6].abs()).fold(0.0, f64::max);
        let off = rows.windows(3).map(|w| ((w[2][4] - w[0][4]) / (2.0 * h) - w[1][6]).abs()).fold(0.0, f64::max);
        assert!(off < 0.2 * fastest, "{id}, {integrator}: the velocity is off by {off} of {fastest} m/s");
    }
}

/// A series for ParaView has existing files, increasing times, and the result at the end.
#[test]
fn a_motion_is_written_as_a_series_of_states() {
    let folder = tempfile::tempdir().unwrap();
    // A name with a character that XML must escape.
    let path = folder.path().join("swing & sway.pvd");
    let last = folder.path().join("last.vtu");
    for (step, duration, states) in [("0.016666666666666666", "0.5", 31), ("0.001", "0.65", 218)] {
        let set = [format!("dynamics.time_step={step}"), format!("dynamics.duration={duration}")];
        let args = ["swing", "--set", &set[0], "--set", &set[1], "--set", "beam.cells=[4,1]"];
        let json = solve_json(&[&args[..], &["--out", path.to_str().unwrap()]].concat());
        let text = fs::read_to_string(&path).unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        let root = document.root_element();
        assert_eq!((root.tag_name().name(), root.attribute("type")), ("VTKFile", Some("Collection")));
        let sets: Vec<_> = document.descendants().filter(|n| n.has_tag_name("DataSet")).collect();
        assert_eq!(sets.len(), states, "every step, or every third of 650, and the last");
        let times: Vec<f64> = sets.iter().map(|n| n.attribute("timestep").unwrap().parse().unwrap()).collect();
        assert!(times.windows(2).all(|w| w[1] > w[0]) && times[0] == 0.0);
        assert!(same(*times.last().unwrap(), &json["time"]));
        let files = sets.iter().map(|n| folder.path().join(n.attribute("file").unwrap()));
        let files: Vec<String> = files.map(|file| fs::read_to_string(file).unwrap()).collect();
        assert!(files.iter().all(|file| roxmltree::Document::parse(file).is_ok()));
        // The state in the last file is the result: the tip is the mean of the right edge.
        let text = files.last().unwrap();
        let vectors = |name: &str| -> Vec<Vec<f64>> {
            let document = roxmltree::Document::parse(text).unwrap();
            let array = document.descendants().find(|n| match name {
                "points" => n.parent().is_some_and(|p| p.has_tag_name("Points")),
                name => n.attribute("Name") == Some(name),
            });
            let text = array.unwrap().text().unwrap();
            let numbers: Vec<f64> = text.split_whitespace().map(|v| v.parse().unwrap()).collect();
            numbers.chunks(3).map(<[f64]>::to_vec).collect()
        };
        let (points, u, v) = (vectors("points"), vectors("displacement"), vectors("velocity"));
        assert!(u.len() == points.len() && v.len() == points.len());
        let tip = &json["probes"][0];
        let weight = |y: f64| if y.abs() < 1e-9 { 4.0 / 6.0 } else { 1.0 / 6.0 };
        for axis in 0..2 {
            let tips = points.iter().zip(&u).filter(|(p, _)| p[0] > 1.0 - 1e-9);
            let mean: f64 = tips.map(|(p, u)| weight(p[1]) * u[axis]).sum();
            assert!((mean - tip["u"][axis].as_f64().unwrap()).abs() < 1e-12, "axis {axis}: {mean}, {tip}");
        }
        assert!(v.iter().flatten().any(|v| v.abs() > 0.1));
        solve_json(&[&args[..], &["--out", last.to_str().unwrap()]].concat());
        assert_eq!(fs::read_to_string(&last).unwrap(), *text);
    }
}

pub const GOOD: &str = include_str!("../data/files/bar.toml");

#[test]
fn a_certificate_can_be_left_out() {
    let json = solve_json(&["elastica", "--no-certificate"]);
    assert!(json["stable"].is_null() && json["fixed_point_rho"].is_null());
    assert_eq!(json["time_us"]["certify"], 0.0);
    assert!(solve_json(&["jump", "--reference=none", "--no-certificate"])["jumped"].is_null());
    assert!(!stdout(&warpbeam(&["solve", "elastica", "--no-certificate"])).contains("ρ"));
}

/// Steel moves by micrometres: the text has unit prefixes and enough digits.
#[test]
fn small_motions_have_digits() {
    let set = ["material.young=210 GPa", "load.0.force=[0 N, -1 kN]"];
    let args = ["cantilever", "--set", set[0], "--set", set[1]];
    let u = solve_u(&args).y;
    let text = solve_text(&args);
    assert!((-1e-3..-1e-7).contains(&u), "{u}");
    let digits = |u: f64| format!("{}", format!("{u:.3e}").parse::<f64>().unwrap());
    assert!(text.contains(&format!(", {}) µm", digits(1e6 * u))), "{u}: {text}");
    assert!(text.contains(", 1) kN, moment about"), "{text}");
    assert!(text.lines().last().unwrap().starts_with("time ") && text.contains(", certify "), "{text}");
    let curve = stdout(&warpbeam(&["curve", "cantilever", "--set", set[0]]));
    assert!(curve.contains("tip displacement, µm"), "{curve}");
}

#[test]
fn without_a_display_run_reports_it_and_writes_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    for args in [&[][..], &["run", "stretch"]] {
        let text = succeeds_in(folder.path(), args);
        assert!(text.starts_with("No window: ") && text.contains("converged after"), "{text}");
        let picture = folder.path().join("warpbeam.png");
        assert!(fs::metadata(&picture).unwrap().len() > 10_000);
        fs::remove_file(picture).unwrap();
    }
}

#[test]
fn without_an_adapter_shot_names_the_package_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let mut shot = program(folder.path(), &["shot", "article", "-o", "x.png"]);
    shot.envs([("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null"), ("WGPU_BACKEND", "vulkan")]);
    let output = shot.output().unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("no usable graphics adapter") && text.contains("mesa-vulkan-drivers"), "{text}");
    assert!(text.contains("\n  vulkan: no adapter found\n"), "{text}");
}

#[test]
fn gpu_lists_the_adapters_and_a_name_chooses_one() {
    let text = stdout(&warpbeam(&["gpu"]));
    assert_eq!(text.matches("usable  yes, and used").count(), 1, "{text}");
    assert!(text.contains("  backend ") && text.contains("  driver  "), "{text}");
    let used = text.split_once("usable  yes, and used").unwrap().0;
    assert!(!used.contains("usable  yes"), "{text}");
    let name = used.lines().rfind(|line| !line.starts_with(' ')).unwrap().to_uppercase();
    assert_eq!(succeeds(&["gpu", "--adapter", &name]), text);
    let folder = tempfile::tempdir().unwrap();
    let [none, _] = ends_in(folder.path(), 3, &["gpu", "--adapter", "abacus"]);
    assert_eq!(none, text.replace("yes, and used", "yes"));
    for (command, file) in [("shot", "x.png"), ("record", "x.gif")] {
        let output = warpbeam_in(folder.path(), &[command, "article", "-o", file, "--adapter", "abacus"]);
        has_all(&stderr(&output), "its name does not contain \"abacus\"|`warpbeam gpu` lists all adapters");
    }
    let output = program(folder.path(), &["gpu"]).env("WGPU_BACKEND", "abacus").output().unwrap();
    assert!(stderr(&output).contains("WGPU_BACKEND: expected vulkan, metal, dx12 or gl"), "{}", stderr(&output));
    let shot = &["shot", "article", "-o", "x.png"];
    let output = program(folder.path(), shot).env("WGPU_ADAPTER_NAME", "abacus").output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
}

#[test]
fn curve_prints_linear_theory_the_exact_beam_and_the_end_of_the_path() {
    let path = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
    let text = succeeds(&["curve", "elastica", "--out", path.path().to_str().unwrap()]);
    has_all(&text, "differs by 3 %|differs by 5 %|differs by 10 %");
    let end = solve_json(&["elastica", "--set", "solver.method=newton"])["probes"][0]["u"].clone();
    let end = warpbeam::format::engineering_pair([0, 1].map(|axis| end[axis].as_f64().unwrap()), "m");
    assert!(text.contains(&format!("at full load: {end}\n")), "{end}: {text}");
    let rows = numbers(&fs::read_to_string(path).unwrap());
    let full = rows.iter().find(|r| (r[0] - 1.0).abs() < 1e-9).unwrap();
    let reference = &solve_json(&["elastica"])["probes"][0]["reference_u"];
    assert!((0..2).all(|axis| (full[3 + axis] - reference[axis].as_f64().unwrap()).abs() < 1e-6), "{full:?}");
}

/// The arch is stable with held supports; the table says where a force in place of the motion would make it unstable.
#[test]
fn curve_follows_an_arch_through_its_limit_load() {
    let folder = tempfile::tempdir().unwrap();
    let text = succeeds_in(folder.path(), &["curve", "snap", "--out", "snap.csv", "--picture", "snap.svg"]);
    assert!(text.matches("limit load").count() == 1 && !text.contains("stable"), "{text}");
    // Text output names a support as `solve` does; its number is for scripts.
    assert!(text.contains("displacement of support (0.1, 0.0085)  its reaction"), "{text}");
    let picture = fs::read_to_string(folder.path().join("snap.svg")).unwrap();
    let axes = ["displacement of support (0.1, 0.0085), mm", "reaction in this direction, N"];
    assert!(axes.iter().all(|axis| picture.contains(axis)), "{axes:?}");
    let csv = fs::read_to_string(folder.path().join("snap.csv")).unwrap();
    let (header, rows) = table(&csv);
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let (force, stable) = (column("support.2_force_y"), column("stable_under_force"));
    // States are unstable where the force decreases.
    for three in rows.windows(3) {
        let f: Vec<f64> = three.iter().map(|row| -row[force].parse::<f64>().unwrap()).collect();
        if (f[1] - f[0]) * (f[2] - f[1]) > 0.0 && (f[2] - f[1]).abs().min((f[1] - f[0]).abs()) > 0.2 {
            assert_eq!(three[1][stable], if f[2] > f[0] { "true" } else { "false" }, "{f:?}");
        }
    }
    assert!(rows.iter().filter(|row| row[stable] == "false").count() > 20);
    assert!(!picture.contains("stroke-dasharray=\"9 5\""));
    for of in ["crown", "support.0"] {
        succeeds_in(folder.path(), &["curve", "snap", "--picture", "snap.svg", "--of", of]);
    }
}

/// The reaction of every support is in JSON and in the text output. Displacements and rotations may have units.
#[test]
fn solve_prints_the_reaction_of_every_support() {
    let set = ["--set", "support.1.turn=30°", "--set", "support.1.displacement=[-5 mm, 0 mm]"];
    let json = solve_json(&[&["snap", "--reference=none"][..], &set].concat());
    let supports = json["supports"].as_array().unwrap();
    assert_eq!(supports.len(), 3);
    assert_eq!((&supports[1]["edge"], &supports[1]["displacement"][0]), (&"right".into(), &(-0.005).into()));
    assert!((supports[1]["turn"].as_f64().unwrap() - std::f64::consts::FRAC_PI_6).abs() < 1e-12);
    assert_eq!(supports[2]["at"], serde_json::json!([0.1, 0.0085]));
    let sum: f64 = supports.iter().map(|s| s["force"][1].as_f64().unwrap()).sum();
    assert!(sum.abs() < 1e-3, "{sum}");
    let text = stdout(&warpbeam(&[&["solve", "snap", "--reference=none"][..], &set].concat()));
    assert!(text.contains("support right, moved by (-5, 0) mm, rotated by 30°: reaction ("), "{text}");
}

/// The JSON has the certificate, ρ, the reference solution and the error.
#[test]
fn json_certifies_its_result() {
    let json = solve_json(&["elastica"]);
    assert_eq!(json["stable"], true);
    assert!(json["fixed_point_rho"].as_f64().unwrap() > 3.5);
    assert!(json["probes"][0]["error_percent"].as_f64().unwrap() < 0.3);
    let linear = solve_json(&["elastica", "--set", "solver.method=linear"]);
    assert!(linear["stable"].is_null() && linear["fixed_point_rho"].is_null());
    assert!(linear["probes"][0]["error_percent"].as_f64().unwrap() > 100.0);
    // Where beam theory does not apply, or is too inaccurate, a fine solution is the
    // reference, and its source is named.
    for (id, source) in [
        ("elastica", "the exact beam"),
        ("article", "a fine solution"),
        ("shear", "a fine solution"),
        ("bracket", "a solution on the refined mesh"),
    ] {
        let probe = &solve_json(&[id])["probes"][0];
        assert_eq!(probe["reference_source"], source, "{id}");
        let own = probe["reference_error_percent"].as_f64().unwrap();
        assert!(probe["error_percent"].as_f64().unwrap() > 0.0 && own > 0.0 && own < 1.0, "{id}: {own}");
        let text = stdout(&warpbeam(&["solve", id]));
        assert!(text.contains(&format!("  {source}: (")) && text.contains("its own error at most "), "{id}: {text}");
    }
    let none = solve_json(&["shear", "--reference=none"]);
    assert!(none["probes"][0]["reference_u"].is_null() && none["probes"][0]["error_percent"].is_null());
    // A probe that moves only by rounding errors has no error relative to its displacement.
    assert!(solve_json(&["shear", "--set", "load.0.force=[0,0]"])["probes"][0]["error_percent"].is_null());
}

/// In the stability atlas every case is classified, every number is finite, and the counts add up.
#[test]
fn extremes_writes_the_stability_atlas() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("atlas");
    let summary = succeeds(&["extremes", "--quick", "--out", out.to_str().unwrap()]);
    let csv = fs::read_to_string(out.join("extremes.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(rows.len() >= 150 && rows.iter().all(|row| row.len() == 17));
    for row in &rows {
        for value in row[3..8].iter().chain(&row[9..13]) {
            assert!(value.parse::<f64>().unwrap().is_finite(), "{row:?}");
        }
        // A result at working precision has a residual above the tolerance and below its bound.
        if let Ok(floor) = row[16].parse::<f64>() {
            let residual: f64 = row[10].parse().unwrap();
            assert!(residual > 1e-8 && residual <= floor && floor <= 1e-5 && row[8] != "not_converged", "{row:?}");
        }
    }
    let count = |element: &str, method: &str, outcome: &str| {
        rows.iter().filter(|r| (r[0], r[1]) == (element, method) && (outcome.is_empty() || r[8] == outcome)).count()
    };
    for element in ["t3", "t6", "q4"] {
        let all = count(element, "newton", "");
        // A cube under a thousand times its bending load is inverted.
        assert!(count(element, "newton", "certified") * 100 >= 80 * all, "{element}");
        let unsolved = ["not_converged", "stalled"].map(|outcome| count(element, "newton", outcome));
        assert_eq!(unsolved, [0, 0], "{element}");
        // Distorted cells succeed like others under any load.
        let distorted: Vec<_> = rows.iter().filter(|r| (r[0], r[1]) == (element, "newton") && r[14] != "0").collect();
        assert!(distorted.len() >= 3 && distorted.iter().all(|r| r[8] == "certified"), "{distorted:?}");
        assert!(count(element, "warped", "stalled") > count(element, "newton", "stalled"), "{element}");
        // From every starting state, however bad, the solve ends in a certified equilibrium.
        let bad_starts: Vec<_> =
            rows.iter().filter(|r| (r[0], r[1]) == (element, "newton") && r[2] != "rest").collect();
        assert!(bad_starts.len() >= 12 && bad_starts.iter().all(|r| r[8] == "certified"), "{bad_starts:?}");
    }
    for file in ["bracket", "clip", "cook"] {
        let of = |element: &str| rows.iter().filter(|r| r[0] == element && r[15] == file).count();
        assert!(of("t3") >= 12 && of("t6") == of("t3") && of("q4") == 0, "{file}");
        let newton = rows.iter().filter(|r| (r[1], r[15]) == ("newton", file));
        assert!(newton.into_iter().all(|r| r[3] != "0.1" || r[8] == "certified"), "{file}");
    }
    assert_eq!(summary, fs::read_to_string(out.join("extremes.txt")).unwrap());
    let certified = count("t6", "newton", "certified");
    assert!(summary.lines().any(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.starts_with(&["t6", "newton"]) && words[2] == certified.to_string()
    }));
    assert!(fs::read_to_string(out.join("extremes.svg")).unwrap().contains("stalled"));
    let csv = fs::read_to_string(out.join("extremes-motion.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(rows.len() >= 72 && rows.iter().all(|row| row.len() == 13));
    for row in &rows {
        assert!(row[2..6].iter().chain(&row[7..]).all(|v| v.parse::<f64>().unwrap().is_finite()), "{row:?}");
        // Implicit integrators run to the end, and no integrator gains energy; far above its critical step the explicit
        // one explodes.
        let is_explicit = row[1] == "symplectic-euler";
        match row[6] {
            "finished" | "inverted" => assert_eq!(row[7], "100", "{row:?}"),
            outcome => assert!(is_explicit && outcome == "exploded", "{row:?}"),
        }
        assert!(!is_explicit || row[3].parse::<f64>().unwrap() < 1e6 || row[6] == "exploded", "{row:?}");
    }
    let exploded = rows.iter().filter(|r| (r[0], r[1], r[6]) == ("t6", "symplectic-euler", "exploded")).count();
    let line = summary.lines().find(|line| line.starts_with("t6      symplectic-euler")).unwrap();
    assert_eq!(line.split_whitespace().nth(5).unwrap(), exploded.to_string());
    assert!(summary.contains(&format!("in motion: {} cases", rows.len())));
    assert!(fs::read_to_string(out.join("extremes-motion.svg")).unwrap().contains("gained energy"));
}

/// The speed–accuracy study splits errors, has positive times and a correct front, and writes its files.
#[test]
fn study_measures_error_against_time() {
    let folder = tempfile::tempdir().unwrap();
    for (id, source) in [
        ("cantilever", "the exact beam"),
        ("bracket", "a solution on the refined mesh"),
        ("shear", "a fine solution"),
        ("article", "a fine solution"),
    ] {
        let out = folder.path().join(id);
        let summary = succeeds(&["study", id, "--quick", "--out", out.to_str().unwrap()]);
        let own = summary.lines().next().unwrap().split("its own error at most ").nth(1);
        let own: Option<f64> = own.and_then(|t| t.split(' ').next()).map(|t| t.parse().unwrap());
        assert!(own.is_some_and(|own| own > 0.0 && own < 5.0), "{summary}");
        // Beam theory is no reference for a stubby beam under large strains.
        assert_eq!(summary.contains("beam theory differs"), id == "article", "{summary}");
        assert!(summary.contains(source) && summary.contains("an error of 10 % costs"), "{id}: {summary}");
        let csv = fs::read_to_string(out.join("study.csv")).unwrap();
        let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
        let number = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
        for row in &rows {
            assert!(row[7..17].iter().all(|v| v.parse::<f64>().unwrap().is_finite()), "{row:?}");
            // The parts are distances along a chain from the result to the reference: their sum bounds the total.
            let parts = number(row, 13) + number(row, 14) + number(row, 15);
            assert!(number(row, 7) > 0.0 && (number(row, 16) - parts).abs() < 1e-9 * number(row, 16).max(1.0));
            assert!(number(row, 12) <= parts * (1.0 + 1e-6) + 1e-4, "{row:?}");
            assert!(["linear", "auto"].contains(&row[4]) || number(row, 15) == 0.0, "{row:?}");
        }
        let front: Vec<&Vec<&str>> = rows.iter().filter(|r| r[17] == "true").collect();
        assert!(!front.is_empty() && front.len() < rows.len());
        for f in &front {
            assert!(!rows.iter().any(|r| number(r, 7) < number(f, 7) && number(r, 16) < number(f, 16)), "{f:?}");
        }
        assert!(fs::read_to_string(out.join("study.svg")).unwrap().contains("Pareto front"));
    }
    // Locking is distinguished from the model error: converged T3 has only discretization error, and
    // linear T6 only model error.
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

/// It gives the reason, and writes the scene. If demands cannot be met, the exit code is 1.
#[test]
fn tune_chooses_a_setting_that_meets_the_demand() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tuned.toml");
    let path = path.to_str().unwrap();
    for (id, force, asked) in [
        ("cantilever", "[0,-1000]", "5%"),
        ("cantilever", "[0,-1000]", "1"),
        ("cantilever", "[0,-2]", "1 %"),
        ("elastica", "[0,-20]", "2%"),
    ] {
        let set = format!("load.0.force={force}");
        let text = succeeds(&["tune", id, "--error", asked, "--time", "100s", "--set", &set, "--write", path]);
        assert!(text.contains("settings measured here meet at most") && text.contains("; the fastest:"), "{text}");
        let bound: f64 = text.split(" ms, error at most ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let asked: f64 = asked.trim_end_matches([' ', '%']).parse().unwrap();
        assert!(bound <= asked, "{text}");
        let json = solve_json(&[path]);
        let error = json["probes"][0]["error_percent"].as_f64().unwrap();
        assert!(error <= bound * (1.0 + 1e-3) + 1e-4, "{error} %: {text}");
        let chosen = format!("  {} ", json["element"].as_str().unwrap());
        assert!(text.lines().any(|line| line.starts_with(&chosen)), "{text}");
    }
    // With a time limit only, it chooses the most accurate setting within it.
    let text = stdout(&warpbeam(&["tune", "bracket", "--time", "100s"]));
    assert!(text.contains("meet at most 100000 ms; the most accurate"), "{text}");
    assert!(!text.contains("the reference's own 0.0000 %"), "{text}");
    let [hopeless, _] = ends_in(Path::new("."), 1, &["tune", "cantilever", "--error", "1%", "--time", "1e-6ms"]);
    has_all(&hopeless, "none of|the fastest of all|the fastest within the error:");
}

/// It finds its mesh file from any folder.
#[test]
fn a_tuned_scene_keeps_its_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let [from, to] = ["from", "to"].map(|name| folder.path().join(name));
    for folder in [&from, &to] {
        fs::create_dir(folder).unwrap();
    }
    write_square(&from, &[SQUARE_PROBE, SQUARE_LOAD].join("\n"));
    let tuned = to.join("tuned.toml");
    let tuned = tuned.to_str().unwrap();
    for (folder, source) in [(Path::new("."), from.join("square.toml")), (from.as_path(), "square.toml".into())] {
        // Two triangles cannot reach one percent; the closest setting is written nevertheless.
        ends_in(folder, 1, &["tune", source.to_str().unwrap(), "--write", tuned]);
        assert_eq!(solve_json(&[tuned])["element"], "t6");
        fs::remove_file(tuned).unwrap();
    }
}

/// Every `solve` gives the same result and report, on the scene's own mesh.
#[test]
fn auto_keeps_the_mesh_and_its_answer() {
    for id in ["article", "elastica"] {
        let args = [id, "--set", "solver.method=auto"];
        let (once, again) = (solve_json(&args), solve_json(&args));
        let own = solve_json(&[id]);
        assert_eq!((&once["element"], &once["dofs"]), (&own["element"], &own["dofs"]));
        for key in ["probes", "iterations", "residual", "auto", "energy"] {
            assert_eq!(once[key], again[key], "{id}: {key}");
        }
        assert!(once["auto"]["decision"].is_string() && own.get("auto").is_none());
        let text = stdout(&warpbeam(&["solve", id, "--set", "solver.method=auto"]));
        assert!(text.contains("method auto") && text.contains("estimated error"), "{text}");
    }
}

/// `solve` stops after the number of iterations that a scene accepts, as a study does with the same number.
#[test]
fn an_accepted_result_is_a_success() {
    let args = ["cantilever", "--set", "solver.accept_after=3"];
    let json = solve_json(&args);
    assert_eq!((json["status"].as_str(), json["iterations"].as_u64()), (Some("accepted"), Some(3)));
    let text = succeeds(&[&["solve"], &args[..]].concat());
    assert!(text.contains("accepted after 3 iterations"), "{text}");
}
