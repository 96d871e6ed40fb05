//! Compares elements with independent numbers. Tests that every element must pass are in `tests/registry`, those of the
//! stiffness of triangles in `src/article/stiffness`.

use crate::common::*;
use nalgebra::SMatrix;
use warpbeam::element::{Lame, side_weights, warped_strain};

fn material(plane: Plane) -> Material {
    Material { young: 100.0, poisson: 0.3, density: 1.0, thickness: 0.5, plane }
}

/// Uniaxial stress: axial strain p/E, lateral −ν p/E (the numbers of SOFA's LinearElasticity_test).
#[test]
fn uniaxial_stress_gives_the_strains_of_the_book() {
    let poissons = [1.0, 2.0].into_iter().flat_map(|young| [0.0, 0.3, 0.49].map(|nu| (young, nu)));
    for (young, nu, p) in poissons.flat_map(|(young, nu)| [0.2, -0.2, 0.6, -0.6].map(|p| (young, nu, p))) {
        let lame = Material { young, poisson: nu, density: 0.0, thickness: 1.0, plane: Plane::Stress }.lame();
        let strain = Matrix2::new(p / young, 0.0, 0.0, -nu * p / young);
        let stress = lame.stress(&strain);
        assert!((stress - Matrix2::new(p, 0.0, 0.0, 0.0)).amax() < 1e-13, "E {young} ν {nu} p {p}: {stress}");
    }
    // Hooke's law in space has no strain out of the plane in plane strain.
    let m = material(Plane::Strain);
    let Lame { lambda, mu } = m.lame();
    // ε_zz = (σ_zz − ν (σ_xx + σ_yy)) / E = 0.
    let strain = Matrix2::new(0.01, 0.002, 0.002, -0.004);
    let stress = m.lame().stress(&strain);
    let szz = m.out_of_plane_stress(stress.trace());
    assert!((szz - m.poisson * stress.trace()).abs() < 1e-12);
    assert!(((stress.m11 - m.poisson * (stress.m22 + szz)) / m.young - strain.m11).abs() < 1e-15);
    assert!((m.elasticity_matrix().m11 - (lambda + 2.0 * mu)).abs() < 1e-12);
}

fn dead_force(scene: &Scene) -> Vec<Vector2<f64>> {
    Problem::new(scene, System::new(scene).unwrap().into()).unwrap().loads().dead_force().to_vec()
}

/// On a mesh with curved sides, gravity is the weight of the true area, and the parts of a traction sum to its force.
#[test]
fn loads_on_curved_elements_add_up() {
    let mut scene = scene("bracket");
    let area = 1.2 * 0.3 + 0.9 * 0.3 + 0.2 * 0.2 * (1.0 - std::f64::consts::FRAC_PI_4);
    scene.loads = vec![Load::gravity([0.0, -9.81])];
    let total = |scene: &Scene| dead_force(scene).iter().sum::<Vector2<f64>>();
    let weight = 9.81 * scene.material.density * scene.material.thickness * area;
    assert!((total(&scene).y + weight).abs() < 1e-4 * weight, "{} {weight}", total(&scene).y);
    scene.loads = vec![Load::force("fillet", [3.0, -4.0])];
    assert!((total(&scene) - Vector2::new(3.0, -4.0)).norm() < 1e-12);
    scene.loads = vec![Load::moment("fillet", 1.0)];
    let problem = Problem::new(&scene, System::new(&scene).unwrap().into());
    assert!(problem.unwrap_err().to_string().contains("expected a straight edge"));
}

/// A force at a point acts unchanged on the nearest node: the reaction is its opposite, and it does work.
#[test]
fn a_force_at_a_point_pulls_the_nearest_node() {
    let mut scene = scene("cantilever");
    scene.loads.clear();
    let scene = scene.force([9.97, 0.51], [3.0, -7.0]);
    let forces = dead_force(&scene);
    let system = System::new(&scene).unwrap();
    let pulled: Vec<usize> = (0..forces.len()).filter(|&n| forces[n].norm() > 0.0).collect();
    assert_eq!(pulled.len(), 1);
    assert_eq!(system.mesh().nodes()[pulled[0]], Vector2::new(10.0, 0.5));
    assert_eq!(forces[pulled[0]], Vector2::new(3.0, -7.0));
    let result = solved(&scene).solution();
    assert!((result.reaction.force + Vector2::new(3.0, -7.0)).norm() < 1e-4);
    assert!(result.probes[0].u.y < 0.0 && result.energy.external > 0.0);
}

/// A quadrilateral that is far from a parallelogram.
const QUAD: [[f64; 2]; 4] = [[0.1, -0.2], [2.0, 0.3], [1.5, 1.4], [-0.3, 1.0]];

/// Returns the stiffness of [`QUAD`] as Taylor, Beresford and Wilson's element, computed by `tests/data/q4.py`.
fn textbook_q4(plane: Plane) -> SMatrix<f64, 8, 8> {
    let values = include_str!("../data/q4.csv").split([',', '\n']).filter_map(|value| value.parse().ok());
    SMatrix::from_row_iterator(values.skip(if plane == Plane::Stress { 0 } else { 64 }).take(64))
}

/// Returns the problem of a single free quadrilateral.
fn one_quad(plane: Plane) -> Problem {
    let mut scene = Scene::named("One").with_material(material(plane));
    scene.analysis = Analysis::Dynamic;
    let nodes = QUAD.map(Vector2::from).to_vec();
    let mesh = Mesh::new(nodes, ElementKind::Q4, vec![0, 1, 2, 3], Default::default()).unwrap();
    Problem::new(&scene, System::with_mesh(&scene, mesh).unwrap().into()).unwrap()
}

/// The element equals the textbook's: its force in linear theory is Ke u, and its A at rest is Ke.
#[test]
fn q4_is_the_textbooks_element() {
    for plane in [Plane::Stress, Plane::Strain] {
        let (problem, ke) = (one_quad(plane), textbook_q4(plane));
        let rest = problem.system().at_rest();
        let (matrix, _) = dense(&problem, &rest, Tangent::EXACT);
        assert!((&matrix - ke).amax() < 1e-12 * ke.norm(), "{plane:?}: {matrix} {ke}");
        for column in 0..8 {
            let mut u = vec![Vector2::zeros(); 4];
            u[column / 2][column % 2] = 1.0;
            let (_, forces) = dense(&problem, &rest.with_displacement(u).unwrap(), Tangent::WARPED);
            for row in 0..8 {
                let (force, expected) = (forces.internal[row / 2][row % 2], ke[(row, column)]);
                assert!((force - expected).abs() < 1e-12 * ke.norm(), "{plane:?} {row} {column}: {force} {expected}");
            }
        }
    }
}

/// Against W(x) = ½ d Ke d, d = Rᵀ(x − x̄) − (X − X̄), with matrices and finite differences.
#[test]
fn q4_energy_is_the_linear_energy_in_the_rotated_frame() {
    const STEP: f64 = 1e-5;
    let (problem, ke) = (one_quad(Plane::Strain), textbook_q4(Plane::Strain));
    let rest = QUAD.map(Vector2::from);
    let element = ElementKind::Q4.entry();
    let to_rest = element.jacobian(&rest, [0.0; 2]).try_inverse().unwrap();
    let written_out = |x: &[f64]| {
        let x: Vec<_> = x.chunks(2).map(|x| Vector2::new(x[0], x[1])).collect();
        let r = polar(&(element.jacobian(&x, [0.0; 2]) * to_rest)).unwrap().matrix().transpose();
        let mean = |x: &[Vector2<f64>]| x.iter().sum::<Vector2<f64>>() / 4.0;
        let (now, then) = (mean(&x), mean(&rest));
        let d = x.iter().zip(&rest).flat_map(|(x, rest)| <[f64; 2]>::from(r * (x - now) - (rest - then)));
        let d = SMatrix::<f64, 8, 1>::from_iterator(d);
        0.5 * (d.transpose() * ke * d)[0]
    };
    let x = [0.9, -0.4, 0.3, 1.8, -1.1, 1.3, -0.2, -0.6];
    let u = x.chunks(2).zip(rest).map(|(x, rest)| Vector2::new(x[0], x[1]) - rest).collect::<Vec<_>>();
    let state = problem.system().state_of(&u).unwrap();
    assert!((problem.elastic_energy(&state) - written_out(&x)).abs() < 1e-12 * written_out(&x));
    let (matrix, forces) = dense(&problem, &state, Tangent::EXACT);
    let scale = ke.norm();
    let moved = |steps: &[(usize, f64)]| {
        let mut x = x;
        steps.iter().for_each(|&(i, step)| x[i] += step);
        written_out(&x)
    };
    let mut numeric = DMatrix::zeros(8, 8);
    for i in 0..8 {
        let slope = (moved(&[(i, STEP)]) - moved(&[(i, -STEP)])) / (2.0 * STEP);
        assert!((slope - forces.internal[i / 2][i % 2]).abs() < 1e-6 * scale, "{i}: {slope}");
        for j in 0..8 {
            let h = 20.0 * STEP;
            let at = |a: f64, b: f64| moved(&[(i, a * h), (j, b * h)]);
            numeric[(i, j)] = (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * h * h);
        }
    }
    assert!((&matrix - &numeric).amax() < 1e-6 * scale, "{matrix} {numeric}");
}

/// Half to each end of a straight side, Simpson's weights with a middle node; weights sum to a curved side's length.
#[test]
fn a_traction_is_distributed_along_a_side() {
    let line = [Vector2::new(1.0, 2.0), Vector2::new(2.5, 4.0), Vector2::new(4.0, 6.0)];
    let close = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
    };
    close(&side_weights(&[line[0], line[2]]), &[2.5, 2.5]);
    close(&side_weights(&line), &[5.0 / 6.0, 20.0 / 6.0, 5.0 / 6.0]);
    close(&side_weights(&line[..1]), &[0.0]);
    // A parabola y = 4 b s (1 − s) over a chord of length 1, whose length has a closed form.
    let b: f64 = 0.1;
    let arc = side_weights(&[Vector2::zeros(), Vector2::new(0.5, b), Vector2::new(1.0, 0.0)]);
    let length = 0.5 * (1.0 + 16.0 * b * b).sqrt() + (4.0 * b).asinh() / (8.0 * b);
    assert!((arc.iter().sum::<f64>() - length).abs() < 1e-5, "{arc:?} {length}");
    assert!((arc[0] - arc[2]).abs() < 1e-14 && arc[1] > arc[0] && arc[0] > 0.0, "{arc:?}");
}

/// A small rotation gives no strain, up to a rounding error relative to the squared angle.
#[test]
fn a_small_rotation_causes_no_strain() {
    for angle in [1e-9_f64, 1e-6, 1e-4] {
        let (s, half) = (angle.sin(), (0.5 * angle).sin());
        let h = Matrix2::new(-2.0 * half * half, -s, s, -2.0 * half * half);
        let strain = warped_strain(Rotation::from_angle(angle), &h);
        assert!(strain.amax() < 1e-15 * angle * angle, "{angle}: {strain:e}");
    }
    // The loads' own tangent is added if all of G is, and only then.
    let exact = [Tangent::EXACT, Tangent::GEOMETRIC, Tangent::WARPED, Tangent::DEFINITE].map(|t| t.is_exact());
    assert_eq!(exact, [true, true, false, false]);
}

/// Few cells and few solves suffice. Errors are in percent of the tip's displacement in the scene's reference solution.
#[test]
fn q4_bends_with_few_cells() {
    let cases = [
        ("article", [5, 1], 3.6),
        ("article", [10, 1], 1.2),
        ("cantilever", [10, 1], 0.5),
        ("cantilever", [20, 2], 0.4),
        ("elastica", [20, 1], 0.5),
        ("elastica", [40, 1], 0.1),
    ];
    for (id, [along, across], bound) in cases {
        let scene = scene(id).with_element(ElementKind::Q4).with_cells(along, across);
        let scene = scene.with_method(MethodKind::Newton);
        let reference = Reference::of(&scene).unwrap().first().unwrap();
        let mut simulation = solved(&scene);
        assert_eq!(simulation.certify().stable, Some(true));
        let solution = simulation.solution();
        let error = reference.error_percent(&solution.probes[0]).unwrap();
        println!("{id} {along} x {across}: {error:.3} %, {} solves", simulation.iterations());
        assert!(error <= bound, "{id} {along} × {across}: {error} %");
        assert!(along == 5 || simulation.iterations() <= 9, "{id} {along} × {across}: {}", simulation.iterations());
    }
}

/// Nearly incompressible plane strain, against Timoshenko's beam with E/(1 − ν²), stubby and slender.
#[test]
fn q4_locks_neither_in_shear_nor_in_volume() {
    let (young, nu, load) = (1e6, 0.4999, 1e-3);
    let material = Material { plane: Plane::Strain, ..Material::new(young, nu) };
    for length in [10.0, 100.0] {
        let scene = Scene::beam(length, 1.0).with_element(ElementKind::Q4).with_cells(20, 1).with_material(material);
        let scene = scene.clamp("left").force("right", [0.0, -load]).with_method(MethodKind::Newton);
        let simulation = solved(&scene.probe("tip", "right"));
        let bending = load * length.powi(3) / (3.0 * young / (1.0 - nu * nu) / 12.0);
        let shear = load * length / (5.0 / 6.0 * young / (2.0 * (1.0 + nu)));
        let error = 100.0 * (-simulation.solution().probes[0].u.y / (bending + shear) - 1.0);
        println!("L/H = {length}: {error:.3} %");
        assert!(error.abs() < 0.5, "L/H = {length}: {error} %");
    }
}
