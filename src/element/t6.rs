//! The six-node triangle: quadratic shape functions, three quadrature points with a rotation each, curved sides.
//!
//! It does not lock in bending.

use nalgebra::Vector2;

use super::cell::TRIANGLE;
use super::{ElementLoops, ElementType, Isoparametric, RulePoint};
use crate::model::ElementKind;

/// Dunavant 1985, degree 4: six points in two groups of three.
const NEAR: [f64; 2] = [0.445_948_490_915_965, 0.108_103_018_168_070];
const FAR: [f64; 2] = [0.091_576_213_509_771, 0.816_847_572_980_459];
const NEAR_WEIGHT: f64 = 0.5 * 0.223_381_589_678_011;
const FAR_WEIGHT: f64 = 0.5 * 0.109_951_743_655_322;

/// Registry entry of the element; nodes: corners, then the midpoints of sides 12, 23, 31.
pub(super) static T6: ElementType = ElementType {
    kind: ElementKind::T6,
    id: "t6",
    about: "Six nodes, linear strain: no shear locking.",
    cell: &TRIANGLE,
    nodes: &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]],
    sides: &[&[0, 3, 1], &[1, 4, 2], &[2, 5, 0]],
    shape,
    local_gradients,
    // Exact to degree 2, equal weights: sufficient for Ke of straight-sided triangles.
    points: &[
        RulePoint { at: [1.0 / 6.0, 1.0 / 6.0], weight: 1.0 / 6.0 },
        RulePoint { at: [2.0 / 3.0, 1.0 / 6.0], weight: 1.0 / 6.0 },
        RulePoint { at: [1.0 / 6.0, 2.0 / 3.0], weight: 1.0 / 6.0 },
    ],
    // Linear interpolation between the three points: 2 l − 1/3 in area coordinates.
    point_weights: |[x, y]| [1.0 - x - y, x, y].map(|l| 2.0 * l - 1.0 / 3.0).to_vec(),
    // Exact to degree 4: products of two quadratic functions. The stiffness's three points would give a mass of rank 3.
    mass_points: &[
        RulePoint { at: [NEAR[0], NEAR[0]], weight: NEAR_WEIGHT },
        RulePoint { at: [NEAR[1], NEAR[0]], weight: NEAR_WEIGHT },
        RulePoint { at: [NEAR[0], NEAR[1]], weight: NEAR_WEIGHT },
        RulePoint { at: [FAR[0], FAR[0]], weight: FAR_WEIGHT },
        RulePoint { at: [FAR[1], FAR[0]], weight: FAR_WEIGHT },
        RulePoint { at: [FAR[0], FAR[1]], weight: FAR_WEIGHT },
    ],
    drawn_pieces: 4,
    vtk_type: 22,
    gmsh_type: 9,
    loops: |nodes, connectivity| ElementLoops::T6(Isoparametric::new(&T6, nodes, connectivity)),
};

/// Returns lₐ (2 lₐ − 1) at corners, 4 lₐ l_b between them, in area coordinates l.
fn shape([b, c]: [f64; 2]) -> Vec<f64> {
    let a = 1.0 - b - c;
    vec![a * (2.0 * a - 1.0), b * (2.0 * b - 1.0), c * (2.0 * c - 1.0), 4.0 * a * b, 4.0 * b * c, 4.0 * c * a]
}

fn local_gradients([b, c]: [f64; 2]) -> Vec<Vector2<f64>> {
    let a = 1.0 - b - c;
    vec![
        Vector2::new(1.0 - 4.0 * a, 1.0 - 4.0 * a),
        Vector2::new(4.0 * b - 1.0, 0.0),
        Vector2::new(0.0, 4.0 * c - 1.0),
        Vector2::new(4.0 * (a - b), -4.0 * b),
        Vector2::new(4.0 * c, 4.0 * b),
        Vector2::new(-4.0 * c, 4.0 * (a - c)),
    ]
}
