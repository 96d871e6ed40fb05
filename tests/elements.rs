//! Elements against independent numbers. What every element must do is in `tests/registry`.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use nalgebra::{DVector, Matrix2, Vector2};
use warpbeam::article::stiffness::ElementStiffness;
use warpbeam::assembly::{Problem, System};
use warpbeam::element::{QuadraturePoint, warped_strain};
use warpbeam::material::Lame;
use warpbeam::rotation::polar;
use warpbeam::{ElementKind, Load, Material, Plane, Scene};

const X: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 0.3], [0.4, 1.1]];
const MOVED: [[f64; 2]; 3] = [[0.1, -0.2], [0.9, 1.7], [-0.8, 0.7]];

fn material(plane: Plane) -> Material {
    Material { young: 100.0, poisson: 0.3, density: 1.0, thickness: 0.5, plane }
}

/// The quadrature points of an element with these rest nodes.
fn points<const N: usize>(kind: ElementKind, nodes: [[f64; 2]; N]) -> Vec<QuadraturePoint<N>> {
    let rest = nodes.map(Vector2::from);
    kind.entry().points.iter().map(|p| QuadraturePoint::new(kind.entry(), &rest, p.at, p.weight)).collect()
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
        let ke = ElementStiffness::new(&points(ElementKind::T3, X), material(plane).membrane()).ke;
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
        let moduli = material(plane).membrane();
        let points = points(ElementKind::T3, X);
        let [point] = points[..] else { unreachable!("one point") };
        let u = [0, 1, 2].map(|i| Vector2::from(MOVED[i]) - Vector2::from(X[i]));
        let h = point.displacement_gradient(&u);
        let f = Matrix2::identity() + h;
        assert!((f - Matrix2::new(0.552885, -1.019231, 0.875, 0.5)).amax() < 1e-6);
        let r = polar(&f).unwrap();
        assert!((r.c - 0.485831).abs() < 1e-6 && (r.s - 0.874053).abs() < 1e-6);
        let s = r.matrix().transpose() * f;
        assert!((s - Matrix2::new(1.033405, -0.058148, -0.058148, 1.133777)).amax() < 1e-6);
        assert!((warped_strain(r, &h) - (s - Matrix2::identity())).amax() < 1e-14);
        let force = point.warped_force(moduli, r, &h);
        for (a, force) in force.iter().enumerate() {
            assert!((force.x - expected[2 * a]).abs() < 1e-6 && (force.y - expected[2 * a + 1]).abs() < 1e-6);
        }
        let strain = warped_strain(r, &h);
        let psi = point.area * 0.5 * moduli.stress(&strain).dot(&strain);
        assert!((psi - energy).abs() < 1e-9, "{psi}");
        assert!((point.area * moduli.energy_density(&strain) - energy).abs() < 1e-9);
        // Eq. (2), written out with matrices: R Ke (Rᵀ x − X).
        let stiffness = ElementStiffness::new(&[point], moduli);
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
        let stress = lame.stress(&strain);
        assert!((stress - Matrix2::new(p, 0.0, 0.0, 0.0)).amax() < 1e-13, "E {young} ν {nu} p {p}: {stress}");
    }
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
    let stress = m.lame().stress(&strain);
    let szz = m.out_of_plane_stress(stress.trace());
    assert!((szz - m.poisson * stress.trace()).abs() < 1e-12);
    let exx = (stress.m11 - m.poisson * (stress.m22 + szz)) / m.young;
    assert!((exx - strain.m11).abs() < 1e-15);
    assert!((m.elasticity_matrix().m11 - (lambda + 2.0 * mu)).abs() < 1e-12);
}

/// Numbers computed independently in rational arithmetic: the first two rows of the T6 stiffness.
#[test]
fn t6_stiffness_matches_independent_numbers() {
    let middle = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let nodes = [X[0], X[1], X[2], middle(X[0], X[1]), middle(X[1], X[2]), middle(X[2], X[0])];
    let points = points(ElementKind::T6, nodes);
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
        let ke = ElementStiffness::new(&points, material(plane).membrane()).ke;
        for column in 0..12 {
            assert!((ke[(0, column)] - first[column]).abs() < 1e-6, "{plane:?} {column} {ke}");
            assert!((ke[(1, column)] - second[column]).abs() < 1e-6, "{plane:?} {column} {ke}");
        }
    }
}

fn dead_force(scene: &Scene) -> Vec<Vector2<f64>> {
    let problem = Problem::new(scene, System::new(scene).unwrap().into()).unwrap();
    problem.loads().dead_force().to_vec()
}

/// On a mesh with curved sides: gravity is the weight of the true area, and a traction's parts add up to the force.
#[test]
fn loads_on_curved_elements_add_up() {
    let mut scene = common::scene("bracket");
    let area = 1.2 * 0.3 + 0.9 * 0.3 + 0.2 * 0.2 * (1.0 - std::f64::consts::FRAC_PI_4);
    scene.loads = vec![Load::gravity([0.0, -9.81])];
    let total = |scene: &Scene| dead_force(scene).iter().sum::<Vector2<f64>>();
    let weight = 9.81 * scene.material.density * scene.material.thickness * area;
    assert!((total(&scene).y + weight).abs() < 1e-4 * weight, "{} {weight}", total(&scene).y);
    scene.loads = vec![Load::force("fillet", [3.0, -4.0])];
    assert!((total(&scene) - Vector2::new(3.0, -4.0)).norm() < 1e-12);
    // A moment needs a straight edge.
    scene.loads = vec![Load::moment("fillet", 1.0)];
    let problem = Problem::new(&scene, System::new(&scene).unwrap().into());
    assert!(problem.unwrap_err().to_string().contains("expected a straight edge"));
}

/// A force at a point pulls the nearest node, as it is given: its reaction is its opposite, and it does work.
#[test]
fn a_force_at_a_point_pulls_the_nearest_node() {
    let mut scene = common::scene("cantilever");
    scene.loads.clear();
    let scene = scene.force([9.97, 0.51], [3.0, -7.0]);
    let forces = dead_force(&scene);
    let system = System::new(&scene).unwrap();
    let pulled: Vec<usize> = (0..forces.len()).filter(|&n| forces[n].norm() > 0.0).collect();
    assert_eq!(pulled.len(), 1);
    assert_eq!(system.mesh().nodes()[pulled[0]], Vector2::new(10.0, 0.5));
    assert_eq!(forces[pulled[0]], Vector2::new(3.0, -7.0));
    let result = common::solved(&scene).solution();
    assert!((result.reaction.force + Vector2::new(3.0, -7.0)).norm() < 1e-4);
    assert!(result.probes[0].u.y < 0.0 && result.energy.external > 0.0);
}
