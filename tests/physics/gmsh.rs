//! Tests of Gmsh files: accepted and refused files, and no panics. Other messages about them are in `tests/golden/texts.txt`.

use std::collections::BTreeSet;
use std::fs;

use crate::common::*;

/// Two triangles, the second clockwise; the left side is a physical curve.
const SQUARE: &str = include_str!("../data/files/square-with-a-loose-node.msh");
/// The square, and a third triangle that shares no node with it.
const PARTS: &str = include_str!("../data/files/parts.msh");
/// The square, and two triangles that share one node with it; in the ring, a third one closes them.
const HINGED: &str = include_str!("../data/files/hinged.msh");
const RING: &str = include_str!("../data/files/ring.msh");
/// Two quadrilaterals side by side, the second clockwise; the left side is a physical curve.
const QUADS: &str = include_str!("../data/files/quads.msh");

#[test]
fn a_small_file_is_read() {
    let mesh = Mesh::from_gmsh(SQUARE, ElementKind::T3).unwrap();
    // The fifth node belongs to no triangle.
    assert_eq!((mesh.nodes().len(), mesh.element_count()), (4, 2));
    let corners = mesh.elements().map(|t| [t[0], t[1], t[2]].map(|n| mesh.nodes()[n as usize]));
    let areas: Vec<f64> = corners.map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a))).collect();
    assert!(areas.iter().all(|area| *area > 0.0), "a clockwise triangle was not turned");
    assert!((areas.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    let wall = mesh.edge_nodes("wall").unwrap();
    assert_eq!(wall.len(), 2);
    assert!(wall.iter().all(|&n| mesh.nodes()[n as usize].x == 0.0));
    // With six-node triangles, each of the five sides has a middle node.
    let mesh = Mesh::from_gmsh(SQUARE, ElementKind::T6).unwrap();
    assert_eq!(mesh.nodes().len(), 9);
    assert_eq!(mesh.edge_nodes("wall").unwrap().len(), 3);
    assert!(mesh.edges()["wall"][0].nodes().iter().any(|&n| mesh.nodes()[n as usize] == Vector2::new(0.0, 0.5)));
}

#[test]
fn shipped_meshes_are_read_with_their_curved_sides() {
    let text = include_str!("../../assets/meshes/bracket.msh");
    let mesh = Mesh::from_gmsh(text, ElementKind::T6).unwrap();
    assert_eq!(mesh.edges().keys().collect::<Vec<_>>(), ["end", "fillet", "wall"]);
    // The fillet's middle nodes lie on its circle, not on its chords.
    for segment in &mesh.edges()["fillet"] {
        assert!(((mesh.nodes()[segment.nodes()[1] as usize] - Vector2::new(0.5, 0.5)).norm() - 0.2).abs() < 1e-9);
    }
    let straight = Mesh::from_gmsh(text, ElementKind::T3).unwrap();
    assert_eq!(straight.element_count(), mesh.element_count());
    assert!(straight.nodes().len() < mesh.nodes().len() / 2);
    assert!(straight.edges()["fillet"].iter().all(|s| s.nodes().len() == 2));
}

#[test]
fn unusable_mesh_files_are_refused_with_the_line() {
    let cases = [
        ("4.1 0 8", "2.2 0 8", "line 2: expected Gmsh format 4.1, ASCII, got version 2.2; save it with `gmsh in.msh"),
        ("4.1 0 8", "4.1 1 8", "got version 4.1, binary; save it with"),
        ("4.1 0 8", "four", "(\"4.1 0 8\"); save it with"),
        ("$MeshFormat", "*Heading", "line 1: expected $MeshFormat, Gmsh format 4.1, ASCII; if Gmsh reads the file"),
        ("1 1 0\n0 1 0\n", "1 1 0.5\n0 1 0\n", "line 27: expected a mesh in the plane z = 0, got z = 0.5 m"),
        ("1 1 0\n0 1 0\n", "1 inf 0\n0 1 0\n", "line 27: expected coordinates within 1e6 m"),
        ("1 1 0\n0 1 0\n", "1 one 0\n0 1 0\n", "line 27: expected the coordinates of a node"),
        ("3 1 4 3", "3 1 4 8", "expected nodes that exist, got 8"),
        ("3 1 4 3", "3 1 4", "expected an element: tag, nodes"),
        ("2 1 2 2", "2 1 10 2", "got quadrangles of second order (element type 10): mesh with `-order 1`"),
        ("2 1 2 2", "2 1 21 2", "got triangles of third order (element type 21): mesh with `-order 1` or `-order 2`"),
        ("2 1 2 2", "2 1 4 2", "got volumes (element type 4): mesh with `gmsh -2`"),
        ("2 3 1 3\n1 5 1 1\n1 4 1\n2 1 2 2\n2 1 2 3\n3 1 4 3\n", "1 1 1 1\n1 5 1 1\n1 4 1\n", "got only 1 lines; Gmsh"),
        ("2 1 2 2", "2 1 2 2000000000", "expected an element"),
        ("$EndElements", "", "expected $EndElements"),
        ("2 1 2 3\n3 1 4 3", "2 1 2 3\n3 1 2 5\n4 1 2 2", "$EndElements"),
        ("3\n4\n5\n", "3\n4\n3\n", "line 24: expected every node once, got node 3 a second time"),
        ("3 1 4 3", "2 1 4 3", "line 37: expected every element once, got element 2 a second time"),
        (
            "3 1 4 3",
            "3 3 2 1",
            "line 37: expected every element once, got nodes [1, 2, 3], which the element of line 36",
        ),
    ];
    for (old, new, message) in cases {
        assert!(SQUARE.contains(old));
        let error = Mesh::from_gmsh(&SQUARE.replacen(old, new, 1), ElementKind::T3);
        let error = error.map_or_else(|e| e.to_string(), |_| String::new());
        assert!(error.contains(message) || message == "$EndElements", "{new}: {error}");
    }
    let error = Mesh::from_gmsh(&SQUARE.replacen("0 1 0\n9", "2 2 0\n9", 1), ElementKind::T3).unwrap_err();
    assert!(matches!(error, GmshError::Mesh(MeshError::Degenerate { element: 1, .. })), "{error}");
    assert!(error.to_string().contains("element 1 has no area"), "{error}");
    assert!(matches!(Mesh::from_gmsh("", ElementKind::T3), Err(GmshError::Syntax { .. })));
    // A plane up to rounding is a plane.
    for (z, flat) in [("1e-12", true), ("-3e-10", true), ("1e-6", false)] {
        let text = SQUARE.replacen("1 1 0\n0 1 0\n", &format!("1 1 {z}\n0 1 0\n"), 1);
        assert_eq!(Mesh::from_gmsh(&text, ElementKind::T3).is_ok(), flat, "{z}");
        assert_eq!(Mesh::from_gmsh_scaled(&text, ElementKind::T3, 1e-3).is_ok(), flat, "{z}");
    }
}

/// A file that is truncated anywhere, or has any byte replaced, gives an error or a mesh, never a panic or a hang.
#[test]
fn damaged_files_never_panic() {
    let text = SQUARE;
    for end in 0..text.len() {
        let _ = Mesh::from_gmsh(&text[..end], ElementKind::T6);
        let _ = Mesh::gmsh_nodes(&text[..end], ElementKind::T6);
    }
    for at in 0..text.len() {
        for with in ["9", "-", " ", "\n", "$", "e", "999999999999999999999"] {
            let damaged = format!("{}{with}{}", &text[..at], &text[at + 1..]);
            let _ = Mesh::gmsh_nodes(&damaged, ElementKind::T6);
            if let Ok(mesh) = Mesh::from_gmsh(&damaged, ElementKind::T6) {
                assert!(mesh.nodes().iter().all(|x| x.x.is_finite() && x.y.is_finite()));
            }
        }
    }
}

/// Exactly, but for another element than the file's: two unknowns per hole of the body may be missing.
#[test]
fn unknowns_are_known_before_a_scene_is_meshed() {
    let mut files = 0;
    for id in scene_ids() {
        let own = scene(id);
        for element in own.elements() {
            let scene = own.clone().with_element(element);
            let mesh = System::new(&scene).unwrap().mesh().clone();
            let nodes = mesh.nodes().len();
            let exact = scene.beam.is_some() || element == own.element();
            // V − E + F = 1 − holes, for a body of one part.
            let corners = element.entry().cell.corners.len();
            let vertices: BTreeSet<u32> = mesh.elements().flat_map(|nodes| nodes[..corners].to_vec()).collect();
            let sides: BTreeSet<[u32; 2]> =
                mesh.elements().flat_map(|nodes| mesh.sides(nodes).map(|s| s.key())).collect();
            let holes = 1 + sides.len() - vertices.len() - mesh.element_count();
            let off = scene.unknowns().abs_diff(2 * nodes as u64) as usize;
            assert!(off <= if exact { 0 } else { 2 * holes }, "{id} of {}: off by {off} of {nodes}", element.id());
            files += usize::from(!exact);
        }
    }
    assert!(files >= 2, "files with another element than their own: {files}");
}

/// Sets up a body on a mesh file, held at its wall, with further keys and supports.
fn on_mesh(mesh: &str, keys: &str, support: &str) -> Result<Simulation, SimulationError> {
    let text = format!(
        "name = \"Parts\"\n{keys}[mesh]\nfile = \"parts.msh\"\n[material]\nyoung = 1e6\npoisson = 0.3\n\
         [[support]]\nedge = \"wall\"\nfix = [\"x\", \"y\"]\n{support}"
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("parts.msh"), mesh).unwrap();
    Simulation::new(&Scene::from_toml_in(&text, folder.path()).unwrap())
}

/// Several parts with separate supports are accepted, and in motion a part may be free.
#[test]
fn held_parts_are_solved() {
    let scene = |support: &str, keys: &str| on_mesh(PARTS, keys, support);
    let pin = |x: f64, y: f64| format!("[[support]]\nat = [{x:?}, {y:?}]\nfix = [\"x\", \"y\"]\n");
    assert!(scene("", "").is_err());
    assert!(scene(&pin(9.0, 9.0), "").is_err());
    assert!(scene(&(pin(9.0, 9.0) + &pin(10.0, 9.0)), "").is_ok());
    assert!(scene("", "analysis = \"dynamic\"\n").is_ok());
}

/// It can rotate about the node, whose number is named. Another support or a second common node holds it.
#[test]
fn a_part_connected_at_one_node_only_is_refused() {
    let scene = |mesh: &str, support: &str| on_mesh(mesh, "", support);
    let error = scene(HINGED, "").unwrap_err().to_string();
    assert!(error.contains("a part that is connected only at node 3 at (1, 1) and can rotate about it"), "{error}");
    // A support in the direction of the hinge does not prevent the rotation.
    assert!(scene(HINGED, "[[support]]\nat = [2.0, 1.0]\nfix = [\"x\"]\n").is_err());
    let mut held = scene(HINGED, "[[support]]\nat = [2.0, 1.0]\nfix = [\"y\"]\n").unwrap();
    assert_eq!(*held.solve(), Status::Converged);
    assert!(scene(RING, "").is_ok());
}

#[test]
fn a_mesh_has_the_unit_and_the_element_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let large = SQUARE.replace("1 0 0\n1 1 0\n0 1 0\n", "60 0 0\n60 60 0\n0 60 0\n");
    fs::write(folder.path().join("large.msh"), large).unwrap();
    fs::write(folder.path().join("bracket.msh"), include_str!("../../assets/meshes/bracket.msh")).unwrap();
    let path = folder.path().join("scene.toml");
    let solve = |file: &str, keys: &str| {
        let text = format!(
            "name = \"Part\"\n[mesh]\nfile = \"{file}.msh\"\n{keys}[material]\nyoung = 1e9\npoisson = 0.3\n\
             [[support]]\nedge = \"wall\"\nfix = [\"x\", \"y\"]\n[[load]]\nkind = \"gravity\"\nacceleration = [0.0, -1.0]\n"
        );
        fs::write(&path, text).unwrap();
        warpbeam(&["solve", path.to_str().unwrap(), "--json", "--reference=none"])
    };
    let json = |output: &std::process::Output| serde_json::from_str::<serde_json::Value>(&stdout(output)).unwrap();
    assert_eq!(json(&solve("bracket", ""))["element"], "t6");
    assert_eq!(json(&solve("bracket", "element = \"t3\"\n"))["element"], "t3");
    let metres = solve("large", "");
    assert_eq!(json(&metres)["element"], "t3");
    let warning = "warning: large.msh is 85 m across; if it is in millimetres, write scale = 0.001";
    assert!(stderr(&metres).contains(warning), "{}", stderr(&metres));
    for (keys, size, warns) in [
        ("", 60.0, true),
        ("scale = 0.001\n", 0.06, false),
        ("scale = \"1 mm\"\n", 0.06, false),
        ("scale = 1\n", 60.0, false),
    ] {
        let output = solve("large", keys);
        assert_eq!(stderr(&output).is_empty(), !warns, "{}", stderr(&output));
        let weight = json(&output)["reaction"]["force"][1].as_f64().unwrap();
        assert!((weight - 1000.0 * size * size).abs() < 1e-6 * weight, "{weight}");
    }
}

#[test]
fn quadrilaterals_are_read() {
    let mesh = Mesh::from_gmsh(QUADS, ElementKind::Q4).unwrap();
    assert_eq!((mesh.nodes().len(), mesh.element_count()), (6, 2));
    assert_eq!(mesh.edge_nodes("wall").unwrap().len(), 2);
    for quad in mesh.elements() {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| mesh.nodes()[quad[i] as usize]);
        assert!((0.5 * (c - a).perp(&(d - b)) - 1.0).abs() < 1e-15, "a clockwise quadrilateral was not turned");
    }
    assert_eq!(mesh.outline().len(), 6);
    assert_eq!(Mesh::gmsh_element(QUADS), Some(ElementKind::Q4));
    assert_eq!(Mesh::gmsh_element(SQUARE), Some(ElementKind::T3));
    assert_eq!(Mesh::gmsh_element(""), None);
    // Not convex: a corner points inwards.
    let error = Mesh::from_gmsh(&QUADS.replacen("1 1 0\n0 1", "0.2 0.2 0\n0 1", 1), ElementKind::Q4).unwrap_err();
    assert!(matches!(error, GmshError::Mesh(MeshError::Folded { element: 0 })), "{error}");
    assert!(error.to_string().contains("convex"), "{error}");
}

/// A scene on a file of quadrilaterals without an element uses `q4`, and names it when it is written.
#[test]
fn a_scene_of_quadrilaterals_needs_no_element() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("quads.msh"), QUADS).unwrap();
    let text = r#"
        name = "Quads"
        mesh.file = "quads.msh"
        material = { young = 1e6, poisson = 0.3, density = 1000.0, thickness = 1.0, plane = "stress" }
        support = [{ edge = "wall", fix = ["x", "y"] }]
        load = [{ kind = "gravity", acceleration = [0.0, -9.81] }]
        probe = [{ name = "tip", at = [2.0, 0.5] }]
    "#;
    let scene = Scene::from_toml_in(text, folder.path()).unwrap();
    assert_eq!(scene.element(), ElementKind::Q4);
    assert_eq!(scene.elements().collect::<Vec<_>>(), [ElementKind::Q4]);
    let simulation = solved(&scene);
    // Its reference solution is computed on the refined mesh of the same element.
    let reference = Reference::of(&scene).unwrap().first().unwrap().displacement;
    assert!(reference.y < 0.0 && (simulation.solution().probes[0].u - reference).norm() < 0.2 * reference.norm());
}
