//! Tests of meshes given by the caller: accepted and refused ones, and their errors.

use std::collections::BTreeMap;

use crate::common::*;

fn square() -> Vec<Vector2<f64>> {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from).to_vec()
}

fn edge(name: &str, nodes: &[&[u32]]) -> BTreeMap<String, Vec<Segment>> {
    BTreeMap::from([(name.to_owned(), nodes.iter().map(|n| Segment::new(n).unwrap()).collect())])
}

/// An invalid mesh gives an error that names the problem; nothing panics later.
#[test]
fn files_without_a_mesh_are_refused() {
    let triangles = || vec![0, 1, 2, 0, 2, 3];
    let mesh = |nodes, element, connectivity, edges| Mesh::new(nodes, element, connectivity, edges).map(|_| ());
    let none = BTreeMap::new;
    assert_eq!(mesh(square(), ElementKind::T3, vec![], none()), Err(MeshError::Connectivity { expected: 3, got: 0 }));
    let short = mesh(square(), ElementKind::T6, vec![0, 1, 2], none());
    assert_eq!(short, Err(MeshError::Connectivity { expected: 6, got: 3 }));
    assert!(matches!(mesh(vec![], ElementKind::T3, vec![0, 1, 2], none()), Err(MeshError::NoSuchNode { .. })));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut nodes = square();
        nodes[2].y = bad;
        assert!(matches!(mesh(nodes, ElementKind::T3, triangles(), none()), Err(MeshError::NotFinite { node: 2, .. })));
    }
    let mut far = square();
    far[1].x = 1e200;
    assert!(mesh(far, ElementKind::T3, triangles(), none()).is_err());
    // Edges with a missing node, with nodes that are no element's side, or with too many nodes are refused.
    for nodes in [&[0, 9][..], &[1, 3], &[0, 0], &[0, 1, 2]] {
        let refused = mesh(square(), ElementKind::T3, triangles(), edge("e", &[nodes]));
        assert_eq!(refused, Err(MeshError::NoSuchSide { edge: "e".to_owned(), nodes: nodes.to_vec() }));
    }
    for nodes in [&[][..], &[1], &[0, 1, 2, 3]] {
        assert_eq!(Segment::new(nodes), None);
    }
    // A side may have either direction, and may be a diagonal inside the mesh.
    assert_eq!(mesh(square(), ElementKind::T3, triangles(), edge("e", &[&[1, 0], &[0, 2]])), Ok(()));
    // The side is so curved that its element folds over.
    let mut nodes = square();
    nodes.extend([[0.5, 0.8], [1.0, 0.5], [0.5, 0.5]].map(Vector2::from));
    assert_eq!(mesh(nodes, ElementKind::T6, vec![0, 1, 2, 4, 5, 6], none()), Err(MeshError::Folded { element: 0 }));
    // A mesh without area is refused; a clockwise triangle is turned.
    let nodes = vec![Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0), Vector2::new(2.0, 0.0)];
    let mesh = Mesh::new(nodes.clone(), ElementKind::T3, vec![0, 2, 1], BTreeMap::new()).unwrap();
    assert_eq!(mesh.connectivity(), [0, 1, 2]);
    let flat = Mesh::new(nodes.clone(), ElementKind::T3, vec![0, 1, 2, 0, 1, 3], BTreeMap::new());
    assert!(matches!(flat, Err(MeshError::Degenerate { element: 1, .. })));
    let missing = Mesh::new(nodes, ElementKind::T3, vec![0, 1, 9], BTreeMap::new());
    assert!(matches!(missing, Err(MeshError::NoSuchNode { element: 0, node: 9, count: 4 })));
}

/// A mesh of the caller, with its own edges, can be solved like any other.
#[test]
fn a_mesh_given_by_the_caller_is_used() {
    let mesh = Mesh::new(square(), ElementKind::T3, vec![0, 1, 2, 0, 2, 3], edge("foot", &[&[0, 1]])).unwrap();
    let scene = Scene::named("Square").clamp("foot").force([0.0, 1.0], [1000.0, 0.0]).probe("corner", [1.0, 1.0]);
    let simulation = solved_on(&scene, mesh);
    assert!(simulation.probe("corner").unwrap().x > 0.0);
    assert_eq!(simulation.probe("nowhere"), None);
}
