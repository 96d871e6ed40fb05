//! Compares stiffness matrices with independent numbers, and the article's forces and frames with the solver's.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::ElementStiffness;
use crate::article::affine::Affine2;
use crate::element::{Lame, QuadraturePoint, warped_strain};
use crate::rotation::{Rotation, polar};
use crate::scene::{ElementKind, Material, Plane, Source, open};
use crate::simulation::Simulation;

const X: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 0.3], [0.4, 1.1]];
const MOVED: [[f64; 2]; 3] = [[0.1, -0.2], [0.9, 1.7], [-0.8, 0.7]];

fn material(plane: Plane) -> Material {
    Material { young: 100.0, poisson: 0.3, density: 1.0, thickness: 0.5, plane }
}

/// Returns the quadrature points of an element with these rest nodes.
fn points<const N: usize>(kind: ElementKind, nodes: [[f64; 2]; N]) -> Vec<QuadraturePoint<N>> {
    let rest = nodes.map(Vector2::from);
    kind.entry().points.iter().map(|p| QuadraturePoint::new(kind.entry(), &rest, p.at, p.weight)).collect()
}

/// The first two rows of Ke match numbers computed independently in rational arithmetic.
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

/// F, R, S, the warped force and the energy of the same triangle in a deformed state.
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
        // Eq. (2) with matrices: R Ke (Rᵀ x − X).
        let stiffness = ElementStiffness::new(&[point], moduli);
        let flat = |p: [[f64; 2]; 3]| DVector::from_iterator(6, p.into_iter().flatten());
        let written_out = stiffness.rkrt(r) * flat(MOVED) - stiffness.rk(r) * flat(X);
        for (ours, theirs) in force.iter().flat_map(|f| [f.x, f.y]).zip(written_out.iter()) {
            assert!((ours - theirs).abs() < 1e-12);
        }
    }
}

/// The first two rows of the T6 stiffness match numbers computed independently in rational arithmetic.
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

/// The triangle of `docs/theory/warped-stiffness.md`, rotated by 90° and stretched by a tenth along its first side, under
/// E = 1 Pa, ν = 0 and t = 1 m: the force at corner 1 is (0, 0.05) N.
#[test]
fn a_rotated_and_stretched_triangle_has_the_force_of_the_theory_page() {
    let points = points(ElementKind::T3, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let stiffness = ElementStiffness::new(&points, Lame { lambda: 0.0, mu: 0.5 });
    let r = polar(&Matrix2::new(0.0, -1.0, 1.1, 0.0)).unwrap();
    let x = DVector::from_row_slice(&[0.0, 0.0, 0.0, 1.1, -1.0, 0.0]);
    let rest = DVector::from_row_slice(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let force = stiffness.rkrt(r) * x - stiffness.rk(r) * rest;
    assert!((force - DVector::from_row_slice(&[0.0, -0.05, 0.0, 0.05, 0.0, 0.0])).norm() < 1e-12);
}

/// The article's frame, computed with its own dense matrices: m_cMatRK, m_cMatRKRT, R K X, 24 → 20, solve, 20 → 24,
/// element maps, polar decomposition. Every frame of `warped` gives the same positions.
#[test]
fn warped_frames_are_the_articles_frames() {
    let scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
    let mut simulation = Simulation::new(&scene).unwrap();
    let mesh = simulation.system().mesh().clone();
    assert_eq!((mesh.nodes().len(), mesh.element_count(), simulation.system().dofs()), (12, 10, 20));
    let rest = DVector::from_iterator(24, mesh.nodes().iter().flat_map(|x| [x.x, x.y]));
    let dead = simulation.problem().loads().dead_force();
    let load = DVector::from_iterator(24, dead.iter().flat_map(|f| [f.x, f.y]));
    let entry = mesh.element().entry();
    let elements: Vec<(Vec<usize>, ElementStiffness)> = mesh
        .elements()
        .map(|t| {
            let corners = [t[0], t[1], t[2]].map(|n| mesh.nodes()[n as usize]);
            let unknowns = t.iter().flat_map(|&n| [2 * n as usize, 2 * n as usize + 1]).collect();
            let point = QuadraturePoint::<3>::new(entry, &corners, entry.points[0].at, entry.points[0].weight);
            (unknowns, ElementStiffness::new(&[point], scene.material.membrane()))
        })
        .collect();
    let mut r = vec![Rotation::IDENTITY; 10];
    let mut x = rest.clone();
    for frame in 0..15 {
        let (mut a, mut b) = (DMatrix::zeros(24, 24), load.clone());
        for ((unknowns, stiffness), &r) in elements.iter().zip(&r) {
            let rkrt = stiffness.rkrt(r);
            let element_rest = DVector::from_iterator(6, unknowns.iter().map(|&i| rest[i]));
            let offset = stiffness.rk(r) * element_rest;
            for (p, &i) in unknowns.iter().enumerate() {
                b[i] += offset[p];
                for (q, &j) in unknowns.iter().enumerate() {
                    a[(i, j)] += rkrt[(p, q)];
                }
            }
        }
        // 24 → 20: the clamped nodes are the first two; their known positions go to the right-hand side.
        let free: Vec<usize> = (4..24).collect();
        let reduced = a.select_rows(&free).select_columns(&free);
        let known = a.select_rows(&free).columns(0, 4) * rest.rows(0, 4);
        let solved = reduced.lu().solve(&(b.select_rows(&free) - known)).unwrap();
        x.rows_mut(4, 20).copy_from(&solved);
        for (r, t) in r.iter_mut().zip(mesh.elements()) {
            let corner = |n: u32| Vector2::new(x[2 * n as usize], x[2 * n as usize + 1]);
            let map = Affine2::from_triangle(
                [t[0], t[1], t[2]].map(|n| mesh.nodes()[n as usize]),
                [t[0], t[1], t[2]].map(corner),
            );
            *r = polar(&map.unwrap().linear).unwrap();
        }
        simulation.step();
        for (n, u) in simulation.displacement().iter().enumerate() {
            let ours = mesh.nodes()[n] + u;
            let theirs = Vector2::new(x[2 * n], x[2 * n + 1]);
            assert!((ours - theirs).norm() < 1e-9, "frame {frame}, node {n}: {ours} {theirs}");
        }
        for (ours, theirs) in simulation.state().rotations().iter().zip(&r) {
            assert!((ours.angle() - theirs.angle()).abs() < 1e-9, "frame {frame}");
        }
    }
}
