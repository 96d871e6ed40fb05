//! Tests of the files that users bring: encodings, meshes that are not one body, scenes that are written again, tables.

use std::collections::BTreeSet;
use std::fs;

use crate::common::*;

fn file(name: &str) -> String {
    format!("{}/tests/data/files/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Returns the displacement of the first probe along y, and the notes of the result.
fn solved(name: &str) -> (f64, Vec<String>) {
    let json = solve_json(&[&file(name), "--reference=none"]);
    let notes = json["warnings"].as_array().unwrap().iter().map(|note| note.as_str().unwrap().to_owned());
    (json["probes"][0]["u"][1].as_f64().unwrap(), notes.collect())
}

/// Parts that are not joined are stated at once and in the result, with their number, the first place, and the remedy.
#[test]
fn a_mesh_that_is_cut_has_a_warning() {
    let (merged, notes) = solved("s_merged.toml");
    let is_cut = notes.iter().any(|note| note.contains("the body is cut there"));
    assert!((merged + 0.2625).abs() < 1e-4 && !is_cut, "{notes:?}");
    for (name, cut) in [
        (
            "s_double.toml",
            "nodes that lie on others without being joined to them: 9, the first at (0, 0.5) m; the body is cut there, and `Coherence Mesh` in Gmsh joins them",
        ),
        (
            "s_hang.toml",
            "nodes inside of sides of elements that do not have them: 4, the first at (0.5, 0.5) m; the body is cut there, and `Coherence` in Gmsh before meshing joins its surfaces",
        ),
    ] {
        let (tip, notes) = solved(name);
        assert!(tip < merged && notes.iter().any(|note| note == cut), "{name}: {tip} {notes:?}");
        let solve = warpbeam(&["solve", &file(name), "--reference", "none"]);
        assert_eq!(stderr(&solve), format!("warpbeam: warning: {cut}\n"));
        assert!(stdout(&solve).contains(&format!("note: {cut}\n")), "{}", stdout(&solve));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("loose.toml");
    let text = fs::read_to_string(file("s_double.toml")).unwrap().replace("edge = \"left\"", "at = [0.0, 0.0]");
    let pin = "[[support]]\nat = [4.0, 0.0]\nfix = [\"y\"]\n";
    fs::write(&path, text.replace("[[load]]", &format!("{pin}[[load]]"))).unwrap();
    fs::copy(file("double.msh"), folder.path().join("double.msh")).unwrap();
    let refused = stderr(&warpbeam(&["solve", path.to_str().unwrap()]));
    let cause = "got 2 parts that share no nodes; supports leave 1 of them free to move; nodes that lie on others";
    assert!(refused.contains(cause) && refused.contains("Coherence Mesh"), "{refused}");
}

#[test]
fn a_partitioned_mesh_has_its_edges() {
    let (whole, _) = solved("s_merged.toml");
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
    assert!(solved("s_latin1.toml").0 < 0.0);
    let wrong = warpbeam(&["solve", &file("s_latin1.toml"), "--set", "load.0.edge=nowhere"]);
    assert!(stderr(&wrong).contains("süd"), "{}", stderr(&wrong));
    assert_eq!(solve_json(&[&file("s_latin1.toml"), "--set", "load.0.edge=süd"])["status"], "converged");
}

#[test]
fn scenes_in_other_encodings_are_refused_with_the_line() {
    for (name, message) in [
        (
            "latin1.toml",
            "latin1.toml:1: expected text in UTF-8, got the byte 0xE4, as in Latin-1; save it as UTF-8, or convert it: \
             `iconv -f LATIN1 -t UTF-8 in.toml > out.toml`",
        ),
        (
            "utf16.toml",
            "utf16.toml:1: expected text in UTF-8, got UTF-16; save it as UTF-8, or convert it: `iconv -f UTF-16",
        ),
    ] {
        refuses(&["solve", &file(name)], message);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, [b"# 1\n# 2\n".as_slice(), &fs::read(file("latin1.toml")).unwrap()].concat()).unwrap();
    let refused = stderr(&warpbeam(&["solve", path.to_str().unwrap()]));
    assert!(refused.contains("scene.toml:3: expected text in UTF-8"), "{refused}");
    // Without a mark at its start.
    let wide: Vec<u8> = "name = \"wide\"\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(&path, wide).unwrap();
    let refused = stderr(&warpbeam(&["solve", path.to_str().unwrap()]));
    assert!(refused.contains("scene.toml:1: expected text in UTF-8, got UTF-16"), "{refused}");
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
