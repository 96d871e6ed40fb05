//! The four-node quadrilateral: bilinear shape functions, incompatible modes, one rotation.
//!
//! It represents bending with one element across the beam; see [`IncompatibleQuads`].

use nalgebra::Vector2;

use super::cell::{SQUARE, bilinear};
use super::{ElementLoops, ElementType, IncompatibleQuads, RulePoint};
use crate::model::ElementKind;

/// Gauss's two points on [−1, 1]: ±1/√3.
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Gauss's rule of 2 × 2 points: exact to degree 3 in ξ and in η.
const RULE: [RulePoint; 4] = [
    RulePoint { at: [-GAUSS, -GAUSS], weight: 1.0 },
    RulePoint { at: [GAUSS, -GAUSS], weight: 1.0 },
    RulePoint { at: [GAUSS, GAUSS], weight: 1.0 },
    RulePoint { at: [-GAUSS, GAUSS], weight: 1.0 },
];

/// Registry entry of the element.
pub(super) static Q4: ElementType = ElementType {
    kind: ElementKind::Q4,
    id: "q4",
    about: "Four nodes and incompatible bending modes: the most accurate per unknown, on quadrilaterals.",
    cell: &SQUARE,
    nodes: SQUARE.corners,
    sides: &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
    shape: bilinear,
    local_gradients,
    points: &RULE,
    // Bilinear interpolation between the four points.
    point_weights: |[x, y]| bilinear([x / GAUSS, y / GAUSS]),
    mass_points: &RULE,
    // Sides stay straight, but the strain varies over the element.
    drawn_pieces: 4,
    vtk_type: 9,
    gmsh_type: 3,
    loops: |nodes, connectivity| ElementLoops::Q4(IncompatibleQuads::new(&Q4, nodes, connectivity)),
};

fn local_gradients([x, y]: [f64; 2]) -> Vec<Vector2<f64>> {
    SQUARE.corners.iter().map(|[a, b]| Vector2::new(0.25 * a * (1.0 + b * y), 0.25 * b * (1.0 + a * x))).collect()
}
