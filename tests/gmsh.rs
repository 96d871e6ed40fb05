//! Gmsh files: what is read, what is refused and how, and that nothing panics.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::fs;

use common::{stderr, warpbeam};
use nalgebra::Vector2;
use warpbeam::ElementKind;
use warpbeam::mesh::{GmshError, Mesh, MeshError};

/// Two triangles, the second clockwise; the left side is a physical curve.
const SQUARE: &str = r#"$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "wall"
2 9 "body"
$EndPhysicalNames
$Comments
anything
$EndComments
$Entities
0 1 1 0
5 0 0 0 0 1 0 1 7 0
1 0 0 0 1 1 0 1 9 1 5
$EndEntities
$Nodes
1 5 1 5
2 1 0 5
1
2
3
4
5
0 0 0
1 0 0
1 1 0
0 1 0
9 9 0
$EndNodes
$Elements
2 3 1 3
1 5 1 1
1 4 1
2 1 2 2
2 1 2 3
3 1 4 3
$EndElements
"#;

#[test]
fn a_small_file_is_read() {
    let mesh = Mesh::from_gmsh(SQUARE, ElementKind::T3).unwrap();
    // The fifth node belongs to no triangle.
    assert_eq!((mesh.nodes().len(), mesh.element_count()), (4, 2));
    let area: f64 = mesh
        .elements()
        .map(|t| [t[0], t[1], t[2]].map(|n| mesh.nodes()[n as usize]))
        .map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a)))
        .inspect(|area| assert!(*area > 0.0, "a clockwise triangle was not turned"))
        .sum();
    assert!((area - 1.0).abs() < 1e-15);
    let wall = mesh.edge_nodes("wall").unwrap();
    assert_eq!(wall.len(), 2);
    assert!(wall.iter().all(|&n| mesh.nodes()[n as usize].x == 0.0));
    // As six-node triangles: five sides, five middles.
    let mesh = Mesh::from_gmsh(SQUARE, ElementKind::T6).unwrap();
    assert_eq!(mesh.nodes().len(), 9);
    assert_eq!(mesh.edge_nodes("wall").unwrap().len(), 3);
    assert!(mesh.edges()["wall"][0].nodes().iter().any(|&n| mesh.nodes()[n as usize] == Vector2::new(0.0, 0.5)));
}

#[test]
fn shipped_meshes_are_read_with_their_curved_sides() {
    let text = include_str!("../assets/meshes/bracket.msh");
    let mesh = Mesh::from_gmsh(text, ElementKind::T6).unwrap();
    assert_eq!(mesh.edges().keys().collect::<Vec<_>>(), ["end", "fillet", "wall"]);
    // The fillet's middle nodes lie on its circle, not on its chords.
    for segment in &mesh.edges()["fillet"] {
        let middle = mesh.nodes()[segment.nodes()[1] as usize];
        assert!(((middle - Vector2::new(0.5, 0.5)).norm() - 0.2).abs() < 1e-9);
    }
    let straight = Mesh::from_gmsh(text, ElementKind::T3).unwrap();
    assert_eq!(straight.element_count(), mesh.element_count());
    assert!(straight.nodes().len() < mesh.nodes().len() / 2);
    assert!(straight.edges()["fillet"].iter().all(|s| s.nodes().len() == 2));
}

#[test]
fn what_cannot_be_used_is_said_with_its_line() {
    let cases = [
        (
            "4.1 0 8",
            "2.2 0 8",
            "line 2: expected format 4.1, ASCII, as `gmsh -format msh41` writes it (\"4.1 0 8\"), got version 2.2",
        ),
        ("4.1 0 8", "4.1 1 8", "got version 4.1 of type 1"),
        ("1 1 0\n0 1 0\n", "1 1 0.5\n0 1 0\n", "line 27: expected a mesh in the plane z = 0"),
        ("1 1 0\n0 1 0\n", "1 inf 0\n0 1 0\n", "line 27: expected coordinates within 1e6 m"),
        ("1 1 0\n0 1 0\n", "1 one 0\n0 1 0\n", "line 27: expected the coordinates of a node"),
        ("3 1 4 3", "3 1 4 8", "expected nodes that exist, got 8"),
        ("3 1 4 3", "3 1 4", "expected an element: tag, nodes"),
        ("2 1 2 2", "2 1 3 2", "expected lines and triangles"),
        ("2 1 2 2", "2 1 2 2000000000", "expected an element"),
        ("$EndElements", "", "expected $EndElements"),
        ("2 1 2 3\n3 1 4 3", "2 1 2 3\n3 1 2 5\n4 1 2 2", "$EndElements"),
    ];
    for (old, new, message) in cases {
        assert!(SQUARE.contains(old));
        let error = Mesh::from_gmsh(&SQUARE.replacen(old, new, 1), ElementKind::T3);
        let error = error.map_or_else(|e| e.to_string(), |_| String::new());
        assert!(error.contains(message) || message == "$EndElements", "{new}: {error}");
    }
    let flat = SQUARE.replacen("0 1 0\n9", "2 2 0\n9", 1);
    let error = Mesh::from_gmsh(&flat, ElementKind::T3).unwrap_err();
    assert!(matches!(error, GmshError::Mesh(MeshError::Degenerate { element: 1, .. })), "{error}");
    assert!(error.to_string().contains("element 1 has no area"), "{error}");
    assert!(matches!(Mesh::from_gmsh("", ElementKind::T3), Err(GmshError::Syntax { .. })));
}

/// Cut off anywhere, and with any byte replaced: an error or a mesh, never a panic, never a hang.
#[test]
fn damaged_files_never_panic() {
    let text = SQUARE;
    for end in 0..text.len() {
        let _ = Mesh::from_gmsh(&text[..end], ElementKind::T6);
    }
    for at in 0..text.len() {
        for with in ["9", "-", " ", "\n", "$", "e", "999999999999999999999"] {
            let damaged = format!("{}{with}{}", &text[..at], &text[at + 1..]);
            if let Ok(mesh) = Mesh::from_gmsh(&damaged, ElementKind::T6) {
                assert!(mesh.nodes().iter().all(|x| x.x.is_finite() && x.y.is_finite()));
            }
        }
    }
}

#[test]
fn a_scene_file_names_its_mesh_relative_to_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let scene = |file: &str, edge: &str| {
        format!(
            "name = \"Square\"\n[mesh]\nfile = \"{file}\"\nelement = \"t6\"\n[material]\nyoung = 1e6\npoisson = 0.3\n\
             [[support]]\nedge = \"{edge}\"\nfix = [\"x\", \"y\"]\n[[load]]\nkind = \"force\"\nat = [1.0, 1.0]\nforce = [0.0, -10.0]\n"
        )
    };
    fs::write(folder.path().join("square.msh"), SQUARE).unwrap();
    fs::write(folder.path().join("old.msh"), SQUARE.replacen("4.1 0 8", "2.2 0 8", 1)).unwrap();
    for (file, edge, code, message) in [
        ("square.msh", "wall", 0, ""),
        ("missing.msh", "wall", 2, "scene.toml:3: mesh.file:"),
        ("old.msh", "wall", 2, "format 4.1"),
        ("square.msh", "left", 2, "expected one of wall, got \"left\""),
    ] {
        fs::write(&path, scene(file, edge)).unwrap();
        let output = warpbeam(&["solve", path.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(code), "{file}: {}", stderr(&output));
        assert!(stderr(&output).contains(message), "{file}: {}", stderr(&output));
    }
}
