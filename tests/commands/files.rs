//! Tests of the files that users bring: encodings, meshes that are not one body, scenes that are written again, tables.

use std::collections::BTreeSet;
use std::fs;

use crate::common::*;

fn file(name: &str) -> String {
    format!("{}/tests/data/files/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Returns the displacement of the first probe along y.
fn solved(name: &str) -> f64 {
    solve_u(&[&file(name), "--reference=none"]).y
}

/// Its warnings are in `tests/golden/texts.txt`.
#[test]
fn a_mesh_that_is_cut_bends_more() {
    let [merged, double, hanging] = ["s_merged.toml", "s_double.toml", "s_hang.toml"].map(solved);
    assert!((merged + 0.2625).abs() < 1e-4 && double.max(hanging) < merged, "{merged} {double} {hanging}");
}

#[test]
fn a_partitioned_mesh_has_its_edges() {
    let whole = solved("s_merged.toml");
    let folder = tempfile::tempdir().unwrap();
    for mesh in ["parted.msh", "parted0.msh", "latin1.msh"] {
        let text = fs::read_to_string(file("s_parted.toml")).unwrap().replace("parted.msh", mesh);
        fs::write(folder.path().join("scene.toml"), text).unwrap();
        fs::copy(file(mesh), folder.path().join(mesh)).unwrap();
        let json = solve_json(&[folder.path().join("scene.toml").to_str().unwrap(), "--reference=none"]);
        let tip = json["probes"][0]["u"][1].as_f64().unwrap();
        assert!((tip / whole - 1.0).abs() < 1e-6, "{mesh}: {tip}");
        assert_eq!(json["reaction"]["force"][1].as_f64().map(f64::round), Some(1000.0), "{mesh}");
    }
    // Names in Latin-1 are those that the user sees.
    assert!(solved("s_latin1.toml") < 0.0);
    assert_eq!(solve_json(&[&file("s_latin1.toml"), "--set", "load.0.edge=süd"])["status"], "converged");
}

/// Columns of a table have different names, also where those of probes and supports would be the same.
#[test]
fn columns_have_names_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    let path = path.to_str().unwrap();
    for (args, columns) in [
        (["curve", "two.toml"], &["mid_u_x", "left.0_force_x", "left.1_force_x", "right_force_y"][..]),
        (["solve", "dyn.toml"], &["tip_x", "tip.0_u_x", "tip_u.1_x", "tip_u_u_x", "=1+1_x"]),
    ] {
        let output = warpbeam(&[args[0], &file(args[1]), "--out", path]);
        assert!(output.status.code().is_some_and(|code| code < 2), "{}", stderr(&output));
        let text = fs::read_to_string(path).unwrap();
        let end = text.find(",stable_under_force\n").or(text.find(",kinetic,")).unwrap();
        // One name has a comma, quotes and a line end.
        let names = text[..end].replace("\"a, \"\"b\"\"\nc", "\"a").replace('"', "");
        let names: Vec<&str> = names.split(',').collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{names:?}");
        assert!(columns.iter().all(|column| names.contains(column)), "{names:?}");
        assert_eq!(text[..end].contains("\"a, \"\"b\"\"\nc"), args[0] == "solve", "{text}");
    }
}

/// `tune --write` changes what it chose and keeps the rest of the text; a file that may not be written stays.
#[test]
fn a_tuned_scene_keeps_its_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let own = fs::read_to_string(file("commented.toml")).unwrap()
        + "\n# where it is measured\n[[probe]]\nname = \"tip\"\nedge = \"right\"\n";
    fs::write(&path, &own).unwrap();
    let tune = || warpbeam_in(folder.path(), &["tune", "mine.toml", "--error", "20%", "--write", "mine.toml"]);
    assert_eq!(tune().status.code(), Some(0));
    let tuned = fs::read_to_string(&path).unwrap();
    for kept in own.lines().filter(|line| line.contains('#')) {
        assert!(tuned.lines().any(|line| line == kept), "{kept} is missing:\n{tuned}");
    }
    assert_eq!(solve_json(&[path.to_str().unwrap()])["status"], "converged");
    fs::write(&path, &own).unwrap();
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let refused = tune();
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("the file is read-only") && !stdout(&refused).is_empty(), "{}", stderr(&refused));
    assert_eq!(fs::read_to_string(&path).unwrap(), own);
}
