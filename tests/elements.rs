//! Elements against independent numbers, the patch test, rigid motion, finite differences.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::collections::BTreeMap;

use nalgebra::{DVector, Matrix2, Vector2};
use warpbeam::assembly::System;
use warpbeam::element::{ElementStiffness, GeometricShare, QuadraturePoint, biot_stress, t3, t6, warped_strain};
use warpbeam::material::Lame;
use warpbeam::mesh::{Mesh, MeshError, Segment};
use warpbeam::method::Workspace;
use warpbeam::rotation::{Rotation, polar};
use warpbeam::scene::{Beam, Diagonals, ElementKind, Load, Material, Place, Plane, Scene, Support};
use warpbeam::simulation::{Simulation, Status};

const X: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 0.3], [0.4, 1.1]];
const MOVED: [[f64; 2]; 3] = [[0.1, -0.2], [0.9, 1.7], [-0.8, 0.7]];

fn material(plane: Plane) -> Material {
    Material { young: 100.0, poisson: 0.3, density: 1.0, thickness: 0.5, plane }
}

fn points() -> [QuadraturePoint<3>; 1] {
    t3::quadrature(X.map(Vector2::from), 0.5)
}

/// Numbers computed independently in rational arithmetic: the first two rows of Ke.
#[test]
fn t3_stiffness_matches_independent_numbers() {
    let rows = [
        (
            Plane::Stress,
            [20.287405, 10.989011, -8.664413, -6.868132, -11.622992, -4.120879],
            [10.989011, 36.770921, -5.494505, 4.385038, -5.494505, -41.155959],
        ),
        (
            Plane::Strain,
            [22.189349, 14.792899, -11.279586, -5.917160, -10.909763, -8.875740],
            [14.792899, 44.378698, -10.724852, 6.286982, -4.068047, -50.665680],
        ),
    ];
    for (plane, first, second) in rows {
        let ke = ElementStiffness::new(&points(), material(plane).lame()).ke;
        for column in 0..6 {
            assert!((ke[(0, column)] - first[column]).abs() < 1e-6, "{plane:?} {ke}");
            assert!((ke[(1, column)] - second[column]).abs() < 1e-6, "{plane:?} {ke}");
        }
        assert!((ke.transpose() - &ke).norm() < 1e-12);
    }
}

/// The same triangle, moved: F, R, S, the warped force and the energy.
#[test]
fn t3_warped_force_matches_independent_numbers() {
    let cases = [
        (Plane::Stress, [4.826830, -2.485061, 3.753278, 0.968050, -8.580108, 1.517011], 0.755058787),
        (Plane::Strain, [5.870381, -4.010955, 4.666842, 1.760800, -10.537223, 2.250155], 0.934735414),
    ];
    for (plane, expected, energy) in cases {
        let lame = material(plane).lame();
        let [point] = points();
        let u = [0, 1, 2].map(|i| Vector2::from(MOVED[i]) - Vector2::from(X[i]));
        let h = point.displacement_gradient(&u);
        let f = Matrix2::identity() + h;
        assert!((f - Matrix2::new(0.552885, -1.019231, 0.875, 0.5)).amax() < 1e-6);
        let r = polar(&f).unwrap();
        assert!((r.c - 0.485831).abs() < 1e-6 && (r.s - 0.874053).abs() < 1e-6);
        let s = r.matrix().transpose() * f;
        assert!((s - Matrix2::new(1.033405, -0.058148, -0.058148, 1.133777)).amax() < 1e-6);
        assert!((warped_strain(r, &h) - (s - Matrix2::identity())).amax() < 1e-14);
        let force = point.warped_force(lame, r, &h);
        for (a, force) in force.iter().enumerate() {
            assert!((force.x - expected[2 * a]).abs() < 1e-6 && (force.y - expected[2 * a + 1]).abs() < 1e-6);
        }
        let strain = warped_strain(r, &h);
        let psi = point.volume * 0.5 * biot_stress(lame, &strain).dot(&strain);
        assert!((psi - energy).abs() < 1e-9, "{psi}");
        // Eq. (2), written out with matrices: R Ke (Rᵀ x − X).
        let stiffness = ElementStiffness::new(&points(), lame);
        let flat = |p: [[f64; 2]; 3]| DVector::from_iterator(6, p.into_iter().flatten());
        let written_out = stiffness.rkrt(r) * flat(MOVED) - stiffness.force_offset(r, &flat(X));
        for (ours, theirs) in force.iter().flat_map(|f| [f.x, f.y]).zip(written_out.iter()) {
            assert!((ours - theirs).abs() < 1e-12);
        }
    }
}

/// Uniaxial stress: axial strain p/E, lateral −ν p/E (the numbers SOFA's LinearElasticity_test uses).
#[test]
fn uniaxial_stress_gives_the_strains_of_the_book() {
    for (young, nu, p) in itertools(&[1.0, 2.0], &[0.0, 0.3, 0.49], &[0.2, -0.2, 0.6, -0.6]) {
        let lame = Material { young, poisson: nu, density: 0.0, thickness: 1.0, plane: Plane::Stress }.lame();
        let strain = Matrix2::new(p / young, 0.0, 0.0, -nu * p / young);
        let stress = biot_stress(lame, &strain);
        assert!((stress - Matrix2::new(p, 0.0, 0.0, 0.0)).amax() < 1e-13, "E {young} ν {nu} p {p}: {stress}");
    }
}

/// Every element with every one of these.
fn every<T: Copy>(choices: &[T]) -> Vec<(T, ElementKind)> {
    choices.iter().flat_map(|&choice| ElementKind::ALL.map(|element| (choice, element))).collect()
}

fn itertools(a: &[f64], b: &[f64], c: &[f64]) -> Vec<(f64, f64, f64)> {
    a.iter().flat_map(|&a| b.iter().flat_map(move |&b| c.iter().map(move |&c| (a, b, c)))).collect()
}

#[test]
fn plane_strain_has_no_strain_out_of_the_plane() {
    let m = material(Plane::Strain);
    let Lame { lambda, mu } = m.lame();
    // Hooke's law in space: ε_zz = (σ_zz − ν (σ_xx + σ_yy)) / E = 0.
    let strain = Matrix2::new(0.01, 0.002, 0.002, -0.004);
    let stress = biot_stress(m.lame(), &strain);
    let szz = m.out_of_plane_stress(stress.trace());
    assert!((szz - m.poisson * stress.trace()).abs() < 1e-12);
    let exx = (stress.m11 - m.poisson * (stress.m22 + szz)) / m.young;
    assert!((exx - strain.m11).abs() < 1e-15);
    assert!((m.elasticity_matrix().m11 - (lambda + 2.0 * mu)).abs() < 1e-12);
}

/// A square of irregular triangles around four inner nodes.
fn irregular_mesh(element: ElementKind) -> Mesh {
    let nodes = [
        [0.0, 0.0],
        [1.2, 0.0],
        [2.0, 0.0],
        [2.0, 0.9],
        [2.0, 2.0],
        [0.7, 2.0],
        [0.0, 2.0],
        [0.0, 1.1],
        [0.6, 0.5],
        [1.5, 0.7],
        [1.3, 1.4],
        [0.5, 1.3],
    ];
    let triangles = [
        [0, 1, 8],
        [1, 9, 8],
        [1, 2, 9],
        [2, 3, 9],
        [3, 10, 9],
        [3, 4, 10],
        [4, 5, 10],
        [5, 11, 10],
        [5, 6, 11],
        [6, 7, 11],
        [7, 8, 11],
        [7, 0, 8],
        [8, 9, 10],
        [8, 10, 11],
    ];
    let edge = |nodes: &[u32]| nodes.windows(2).map(|w| Segment { ends: [w[0], w[1]], middle: None }).collect();
    let edges = BTreeMap::from([
        ("left".to_owned(), edge(&[6, 7, 0])),
        ("right".to_owned(), edge(&[2, 3, 4])),
        ("bottom".to_owned(), edge(&[0, 1, 2])),
        ("top".to_owned(), edge(&[4, 5, 6])),
    ]);
    let mesh = Mesh::new(nodes.map(Vector2::from).to_vec(), ElementKind::T3, triangles.concat(), edges).unwrap();
    if element == ElementKind::T3 { mesh } else { quadratic(&mesh) }
}

/// The same mesh with a node in the middle of every side.
fn quadratic(mesh: &Mesh) -> Mesh {
    let mut nodes = mesh.nodes.clone();
    let mut middles = BTreeMap::new();
    let mut middle = |[a, b]: [u32; 2]| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            nodes.push((nodes[a as usize] + nodes[b as usize]) * 0.5);
            (nodes.len() - 1) as u32
        })
    };
    let mut connectivity = Vec::new();
    for t in mesh.triangles() {
        connectivity.extend(t);
        connectivity.extend(Mesh::sides(t).map(|side| middle(side.ends)));
    }
    let mut edges = mesh.edges.clone();
    for segment in edges.values_mut().flatten() {
        segment.middle = Some(middle(segment.ends));
    }
    Mesh::new(nodes, ElementKind::T6, connectivity, edges).unwrap()
}

fn irregular_scene(plane: Plane) -> Scene {
    let mut scene = common::scene("stretch");
    scene.material = material(plane);
    scene
}

/// Patch test: a linear displacement field has a constant strain, and no inner node feels a force.
#[test]
fn patch_test_on_an_irregular_mesh() {
    for (plane, element) in every(&[Plane::Stress, Plane::Strain]) {
        let system = System::with_mesh(&irregular_scene(plane), irregular_mesh(element)).unwrap();
        let h = Matrix2::new(0.02, -0.01, 0.03, -0.015);
        let u: Vec<_> = system.mesh.nodes.iter().map(|x| h * x + Vector2::new(0.4, -0.1)).collect();
        // Linear theory with the field as it is; the warped force with the field turned by 70° on top.
        let turn = Rotation::from_angle(70f64.to_radians());
        let stretch = Matrix2::new(1.02, 0.01, 0.01, 0.97);
        let turned: Vec<_> = system.mesh.nodes.iter().map(|x| turn.apply(stretch * x) - x).collect();
        let mut r = vec![Rotation::IDENTITY; system.elements.point_count()];
        for (u, warp) in [(u, false), (turned, true)] {
            if warp {
                system.elements.rotations(&u, &mut r);
                assert!(r.iter().all(|r| (r.c - turn.c).hypot(r.s - turn.s) < 1e-14));
            }
            let zero = vec![Vector2::zeros(); u.len()];
            let (mut force, mut magnitude) = (zero.clone(), zero);
            system.internal_force(&u, &r, &mut force, &mut magnitude);
            // Inner nodes; with six-node triangles also those of inner sides, which come last and are told by their place.
            let inner = |x: &Vector2<f64>| x.x > 1e-9 && x.x < 2.0 - 1e-9 && x.y > 1e-9 && x.y < 2.0 - 1e-9;
            for inner in (0..force.len()).filter(|&n| inner(&system.mesh.nodes[n])) {
                assert!(
                    force[inner].norm() < 1e-12 * magnitude[inner].norm(),
                    "{plane:?} {element:?} {warp} {}",
                    force[inner]
                );
            }
        }
    }
}

/// The patch test as a user would run it: uniform traction on an irregular mesh gives exactly p/E and −ν p/E.
#[test]
fn uniform_traction_gives_uniform_strain_with_every_method() {
    for (method, element) in every(&["linear", "warped", "newton"]) {
        let mut scene = irregular_scene(Plane::Stress);
        scene.solver.method = toml::Value::from(method).try_into().unwrap();
        scene.solver.tolerance = 1e-13;
        let pull = 3.0;
        scene.loads = vec![Load::Force { place: Place::edge("right"), force: [pull, 0.0] }];
        let system = System::with_mesh(&scene, irregular_mesh(element)).unwrap();
        let mut simulation = Simulation::with_system(&scene, system).unwrap();
        assert_eq!(*simulation.solve(), Status::Converged, "{method}");
        let strain = pull / (scene.material.young * scene.material.thickness * 2.0);
        for (x, u) in simulation.system().mesh.nodes.iter().zip(simulation.displacement()) {
            // Held against rising at the node nearest to (0, 0).
            let expected = Vector2::new(strain * x.x, -0.3 * strain * x.y);
            assert!((u - expected).norm() < 1e-13, "{method}: {u} {expected}");
        }
    }
}

#[test]
fn rigid_motions_give_no_force_and_no_energy() {
    for (degrees, element) in every(&[0.0f64, 1e-6, 10.0, 90.0, 179.0, -135.0]) {
        let system = System::with_mesh(&irregular_scene(Plane::Strain), irregular_mesh(element)).unwrap();
        let turn = Rotation::from_angle(degrees.to_radians());
        let u: Vec<_> = system.mesh.nodes.iter().map(|x| turn.apply(*x) + Vector2::new(3.0, -20.0) - x).collect();
        let mut r = vec![Rotation::IDENTITY; system.elements.point_count()];
        system.elements.rotations(&u, &mut r);
        let zero = vec![Vector2::zeros(); u.len()];
        let (mut force, mut magnitude) = (zero.clone(), zero);
        system.internal_force(&u, &r, &mut force, &mut magnitude);
        // Forces of a strain of 1 are about 100 N; coordinates of 20 leave roundings of 20 ε.
        assert!(force.iter().all(|f| f.norm() < 1e-11), "{degrees}°");
        assert!(system.elements.energy(system.lame, &u, &r) < 1e-25, "{degrees}°");
    }
}

/// f_int is the gradient of the energy, with R following x: central differences.
#[test]
fn the_warped_force_is_the_gradient_of_the_energy() {
    for element in ElementKind::ALL {
        force_is_the_gradient(element);
    }
}

fn force_is_the_gradient(element: ElementKind) {
    let system = System::with_mesh(&irregular_scene(Plane::Strain), irregular_mesh(element)).unwrap();
    let mut u: Vec<_> = system
        .mesh
        .nodes
        .iter()
        .map(|x| Rotation::from_angle(0.8 + 0.3 * x.x).apply(*x) * (1.0 + 0.1 * x.y) - x)
        .collect();
    let mut r = vec![Rotation::IDENTITY; system.elements.point_count()];
    let mut energy = |u: &[Vector2<f64>]| {
        system.elements.rotations(u, &mut r);
        system.elements.energy(system.lame, u, &r)
    };
    const STEP: f64 = 1e-5;
    let mut numeric = Vec::new();
    for node in 0..u.len() {
        for axis in 0..2 {
            let at = u[node][axis];
            u[node][axis] = at + STEP;
            let above = energy(&u);
            u[node][axis] = at - STEP;
            let below = energy(&u);
            u[node][axis] = at;
            numeric.push((above - below) / (2.0 * STEP));
        }
    }
    energy(&u);
    let zero = vec![Vector2::zeros(); u.len()];
    let (mut force, mut magnitude) = (zero.clone(), zero);
    system.internal_force(&u, &r, &mut force, &mut magnitude);
    let scale = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    for (node, pair) in numeric.chunks(2).enumerate() {
        let error = (Vector2::new(pair[0], pair[1]) - force[node]).norm() / scale;
        assert!(error < 1e-8, "node {node}: {error:e}");
    }
}

/// A = Σ R Ke Rᵀ is the derivative of f_int with R held fixed, and f_int = A x − R K X.
#[test]
fn stiffness_and_offset_make_up_the_force() {
    for element in ElementKind::ALL {
        stiffness_and_offset(element);
    }
}

fn stiffness_and_offset(element: ElementKind) {
    let mut scene = irregular_scene(Plane::Stress);
    scene.supports = vec![
        Support { edge: Some("left".to_owned()), at: None, fix: scene.supports[0].fix.clone() },
        scene.supports[1].clone(),
    ];
    let system = System::with_mesh(&scene, irregular_mesh(element)).unwrap();
    let u: Vec<_> = system.mesh.nodes.iter().map(|x| Rotation::from_angle(0.4 * x.x).apply(*x) - x).collect();
    let mut r = vec![Rotation::IDENTITY; system.elements.point_count()];
    system.elements.rotations(&u, &mut r);
    let zero = vec![Vector2::zeros(); u.len()];
    let (mut force, mut magnitude, mut offset) = (zero.clone(), zero.clone(), zero);
    system.internal_force(&u, &r, &mut force, &mut magnitude);
    system.force_offset(&r, &mut offset);
    let mut values = vec![0.0; system.pattern.entries() + 1];
    system.stiffness(&r, &mut values);
    // A over the free unknowns, dense.
    let n = system.dofs();
    let mut a = nalgebra::DMatrix::zeros(n, n);
    for column in 0..n {
        let entries = system.pattern.column_starts[column]..system.pattern.column_starts[column + 1];
        for (&row, &value) in system.pattern.row_indices[entries.clone()].iter().zip(&values[entries]) {
            a[(row, column)] = value;
            a[(column, row)] = value;
        }
    }
    // Moving free nodes by d changes the force by A d, exactly: it is linear in x for fixed R.
    let d = DVector::from_fn(n, |i, _| ((i * 7 % 11) as f64 - 5.0) * 0.01);
    let mut moved = u.clone();
    system.add_free(d.as_slice(), &mut moved);
    let mut moved_force = vec![Vector2::zeros(); u.len()];
    system.internal_force(&moved, &r, &mut moved_force, &mut magnitude);
    let change: Vec<_> = moved_force.iter().zip(&force).map(|(a, b)| a - b).collect();
    let mut free = vec![0.0; n];
    system.restrict(&change, &mut free);
    assert!((DVector::from_vec(free) - &a * d).norm() < 1e-10);
    // All nodes at the origin: what is left of f_int is −R K X.
    let collapsed: Vec<_> = system.mesh.nodes.iter().map(|x| -x).collect();
    system.internal_force(&collapsed, &r, &mut force, &mut magnitude);
    assert!(force.iter().zip(&offset).all(|(f, o)| (f + o).norm() < 1e-12));
}

#[test]
fn meshes_without_area_are_refused_and_clockwise_triangles_turned() {
    let nodes = vec![Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0), Vector2::new(2.0, 0.0)];
    let mesh = Mesh::new(nodes.clone(), ElementKind::T3, vec![0, 2, 1], BTreeMap::new()).unwrap();
    assert_eq!(mesh.connectivity, [0, 1, 2]);
    let flat = Mesh::new(nodes.clone(), ElementKind::T3, vec![0, 1, 2, 0, 1, 3], BTreeMap::new());
    assert!(matches!(flat, Err(MeshError::Degenerate { triangle: 1, .. })));
    let missing = Mesh::new(nodes, ElementKind::T3, vec![0, 1, 9], BTreeMap::new());
    assert!(matches!(missing, Err(MeshError::NoSuchNode { node: 9, .. })));
}

/// Numbers computed independently in rational arithmetic: the first two rows of the T6 stiffness.
#[test]
fn t6_stiffness_matches_independent_numbers() {
    let middle = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let nodes = [X[0], X[1], X[2], middle(X[0], X[1]), middle(X[1], X[2]), middle(X[2], X[0])].map(Vector2::from);
    let points = t6::quadrature(nodes, 0.5).unwrap();
    let rows = [
        (
            Plane::Stress,
            [
                20.287405, 10.989011, 2.888138, 2.289377, 3.874331, 1.373626, -11.552550, -9.157509, 0.0, 0.0,
                -15.497323, -5.494505,
            ],
            [
                10.989011, 36.770921, 1.831502, -1.461679, 1.831502, 13.718653, -7.326007, 5.846717, 0.0, 0.0,
                -7.326007, -54.874613,
            ],
        ),
        (
            Plane::Strain,
            [
                22.189349, 14.792899, 3.759862, 1.972387, 3.636588, 2.958580, -15.039448, -7.889546, 0.0, 0.0,
                -14.546351, -11.834320,
            ],
            [
                14.792899, 44.378698, 3.574951, -2.095661, 1.356016, 16.888560, -14.299803, 8.382643, 0.0, 0.0,
                -5.424063, -67.554241,
            ],
        ),
    ];
    for (plane, first, second) in rows {
        let ke = ElementStiffness::new(&points, material(plane).lame()).ke;
        for column in 0..12 {
            assert!((ke[(0, column)] - first[column]).abs() < 1e-6, "{plane:?} {column} {ke}");
            assert!((ke[(1, column)] - second[column]).abs() < 1e-6, "{plane:?} {column} {ke}");
        }
    }
}

/// A + G and the moment's own tangent are the derivative of f_int − f_ext: central differences.
#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    for element in ElementKind::ALL {
        let mut scene = irregular_scene(Plane::Strain);
        scene.loads = vec![Load::Moment { edge: "right".to_owned(), moment: 3.0 }];
        let system = System::with_mesh(&scene, irregular_mesh(element)).unwrap();
        let mut u: Vec<_> = system
            .mesh
            .nodes
            .iter()
            .map(|x| Rotation::from_angle(0.8 + 0.3 * x.x).apply(*x) * (1.0 + 0.1 * x.y - 0.2 * x.x) - x)
            .collect();
        let n = system.dofs();
        let mut r = vec![Rotation::IDENTITY; system.elements.point_count()];
        let zero = vec![Vector2::zeros(); u.len()];
        let mut out_of_balance = |u: &[Vector2<f64>]| {
            let (mut internal, mut magnitude, mut external) = (zero.clone(), zero.clone(), zero.clone());
            system.elements.rotations(u, &mut r);
            system.internal_force(u, &r, &mut internal, &mut magnitude);
            system.external_force(u, 0.7, &mut external);
            let difference: Vec<_> = internal.iter().zip(&external).map(|(i, e)| i - e).collect();
            let mut free = vec![0.0; n];
            system.restrict(&difference, &mut free);
            DVector::from_vec(free)
        };
        const STEP: f64 = 1e-6;
        let mut numeric = nalgebra::DMatrix::zeros(n, n);
        for (column, &unknown) in system.pattern.free.iter().enumerate() {
            let (node, axis) = (unknown as usize / 2, unknown as usize % 2);
            let at = u[node][axis];
            u[node][axis] = at + STEP;
            let above = out_of_balance(&u);
            u[node][axis] = at - STEP;
            let below = out_of_balance(&u);
            u[node][axis] = at;
            numeric.set_column(column, &((above - below) / (2.0 * STEP)));
        }
        system.elements.rotations(&u, &mut r);
        let mut values = vec![0.0; system.pattern.entries() + 1];
        system.stiffness(&r, &mut values);
        system.add_geometric_stiffness(&u, &r, GeometricShare::All, &mut values);
        system.add_load_stiffness(&u, 0.7, &mut values);
        let mut exact = nalgebra::DMatrix::zeros(n, n);
        let mut unit = vec![0.0; n];
        let mut image = vec![0.0; n];
        for column in 0..n {
            unit[column] = 1.0;
            system.pattern.multiply(&values, &unit, &mut image);
            unit[column] = 0.0;
            exact.set_column(column, &DVector::from_column_slice(&image));
        }
        let error = (&numeric - &exact).norm() / exact.norm();
        assert!(error < 1e-8, "{element:?}: {error:e}");
    }
}

/// A moment's forces are the gradient of its potential, and it turns nothing but the body: no net force.
#[test]
fn a_moment_is_a_couple() {
    for element in ElementKind::ALL {
        let mut scene = irregular_scene(Plane::Stress);
        scene.loads = vec![Load::Moment { edge: "right".to_owned(), moment: 3.0 }];
        let system = System::with_mesh(&scene, irregular_mesh(element)).unwrap();
        let u: Vec<_> = system.mesh.nodes.iter().map(|x| Rotation::from_angle(2.0 + 0.1 * x.y).apply(*x) - x).collect();
        let mut force = vec![Vector2::zeros(); u.len()];
        system.external_force(&u, 1.0, &mut force);
        let net: Vector2<f64> = force.iter().sum();
        let positions = system.mesh.nodes.iter().zip(&u).map(|(x, u)| x + u);
        let moment: f64 = positions.zip(&force).map(|(x, f)| x.perp(f)).sum();
        assert!(net.norm() < 1e-12 && (moment - 3.0).abs() < 1e-12, "{element:?}: {net} {moment}");
    }
}

/// The exact displacement gradient of a smooth field that vanishes on the left edge,
/// u = (sin 1.3x · cos 0.7y, sin x · sin(1.1y + 0.4)).
fn smooth_gradient(x: Vector2<f64>) -> Matrix2<f64> {
    let (a, b) = (1.3 * x.x, 0.7 * x.y);
    let (c, d) = (x.x, 1.1 * x.y + 0.4);
    Matrix2::new(1.3 * a.cos() * b.cos(), -0.7 * a.sin() * b.sin(), c.cos() * d.sin(), 1.1 * c.sin() * d.cos())
}

/// A manufactured solution of linear theory: under the loads that go with a smooth field, the finite element solution
/// approaches it in the energy norm with h¹ for T3 and h² for T6.
#[test]
fn elements_converge_in_the_energy_norm_at_their_rates() {
    for (element, rate) in [(ElementKind::T3, 1.0), (ElementKind::T6, 2.0)] {
        let errors = [4, 8, 16].map(|n| energy_norm_error(element, n));
        let rates: Vec<f64> = errors.windows(2).map(|w| (w[0] / w[1]).log2()).collect();
        println!("{element:?}: energy-norm rates {rates:?}");
        assert!((rates[1] - rate).abs() < 0.1, "{element:?}: {errors:?} {rates:?}");
    }
}

/// ‖u − u_h‖ over ‖u‖ in the energy norm, on n × n cells.
fn energy_norm_error(element: ElementKind, n: u32) -> f64 {
    let mut scene = irregular_scene(Plane::Strain);
    scene.beam = Some(Beam { length: 1.0, height: 1.0, cells: [n, n], element, diagonals: Diagonals::Alternating });
    scene.supports = vec![Support {
        edge: Some("left".to_owned()),
        at: None,
        fix: vec![warpbeam::scene::Axis::X, warpbeam::scene::Axis::Y],
    }];
    scene.loads.clear();
    scene.probes.clear();
    let system = System::new(&scene).unwrap();
    let sym = |h: Matrix2<f64>| (h + h.transpose()) * 0.5;
    // f_a = ∫ σ(u) ∇N_a dV, and ‖u‖² = ∫ σ(u) : ε(u) dV, by a rule fine enough to be exact beside the error.
    const FINE: u32 = 4;
    let mut force = vec![Vector2::zeros(); system.mesh.nodes.len()];
    let mut energy = 0.0;
    for triangle in system.mesh.triangles() {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|node| system.mesh.nodes[node as usize]);
        let jacobian = Matrix2::from_columns(&[b - a, c - a]);
        let volume = 0.5 * jacobian.determinant() * scene.material.thickness / f64::from(3 * FINE * FINE);
        let to_global = jacobian.try_inverse().unwrap().transpose();
        let h = 1.0 / f64::from(FINE);
        let corners = (0..FINE).flat_map(|j| (0..FINE - j).map(move |i| (i, j))).flat_map(|(i, j)| {
            let (p, q) = (f64::from(i) * h, f64::from(j) * h);
            // The three-point rule in the small triangle, and in the one that completes its square.
            let rule = [(1.0 / 6.0, 1.0 / 6.0), (2.0 / 3.0, 1.0 / 6.0), (1.0 / 6.0, 2.0 / 3.0)];
            let up = rule.map(|(x, y)| (p + h * x, q + h * y));
            let down = rule.map(|(x, y)| (p + h - h * x, q + h - h * y));
            up.into_iter().chain(down.into_iter().filter(move |_| i + j + 2 <= FINE))
        });
        for (p, q) in corners {
            let l = [1.0 - p - q, p, q];
            let gradients = match element {
                ElementKind::T3 => t3::local_gradients().to_vec(),
                ElementKind::T6 => t6::local_gradients(l).to_vec(),
            };
            let strain = sym(smooth_gradient(a * l[0] + b * l[1] + c * l[2]));
            let stress = biot_stress(system.lame, &strain) * volume;
            energy += stress.dot(&strain);
            for (&node, g) in triangle.iter().zip(gradients) {
                force[node as usize] += stress * (to_global * g);
            }
        }
    }
    let mut workspace = Workspace::new(&system).unwrap();
    let r = vec![Rotation::IDENTITY; system.elements.point_count()];
    system.stiffness(&r, &mut workspace.values);
    workspace.factor.factorize(&workspace.values).unwrap();
    system.restrict(&force, &mut workspace.free);
    let load = workspace.free.clone();
    workspace.factor.solve_in_place(&mut workspace.free);
    // Galerkin: ‖u − u_h‖² = ‖u‖² − f · u_h.
    let work: f64 = load.iter().zip(&workspace.free).map(|(f, u)| f * u).sum();
    ((energy - work) / energy).sqrt()
}

/// On a mesh with curved sides: gravity is the weight of the true area, and a traction's shares add up to the force.
#[test]
fn loads_on_curved_elements_add_up() {
    let mut scene = common::scene("bracket");
    let area = 1.2 * 0.3 + 0.9 * 0.3 + 0.2 * 0.2 * (1.0 - std::f64::consts::FRAC_PI_4);
    scene.loads = vec![Load::Gravity { acceleration: [0.0, -9.81] }];
    let total = |scene: &Scene| System::new(scene).unwrap().dead_force.iter().sum::<Vector2<f64>>();
    let weight = 9.81 * scene.material.density * scene.material.thickness * area;
    assert!((total(&scene).y + weight).abs() < 1e-4 * weight, "{} {weight}", total(&scene).y);
    scene.loads = vec![Load::Force { place: Place::edge("fillet"), force: [3.0, -4.0] }];
    assert!((total(&scene) - Vector2::new(3.0, -4.0)).norm() < 1e-12);
    // A moment needs a straight edge.
    scene.loads = vec![Load::Moment { edge: "fillet".to_owned(), moment: 1.0 }];
    assert!(System::new(&scene).unwrap_err().to_string().contains("expected a straight edge"));
}
