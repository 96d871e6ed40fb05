//! The three-node triangle: linear shape functions, constant strain, one quadrature point.

use nalgebra::Vector2;

use super::cell::TRIANGLE;
use super::{ElementLoops, ElementType, Isoparametric, RulePoint};
use crate::model::ElementKind;

/// Registry entry of the element.
pub(super) static T3: ElementType = ElementType {
    kind: ElementKind::T3,
    id: "t3",
    about: "Three nodes, constant strain: cheap, and too stiff in bending (shear locking).",
    cell: &TRIANGLE,
    nodes: TRIANGLE.corners,
    sides: &[&[0, 1], &[1, 2], &[2, 0]],
    shape: |[x, y]| vec![1.0 - x - y, x, y],
    local_gradients: |_| vec![Vector2::new(-1.0, -1.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)],
    points: &[RulePoint { at: [1.0 / 3.0; 2], weight: 0.5 }],
    point_weights: |_| vec![1.0],
    // Exact to degree 2: products of two linear functions.
    mass_points: &[
        RulePoint { at: [1.0 / 6.0, 1.0 / 6.0], weight: 1.0 / 6.0 },
        RulePoint { at: [2.0 / 3.0, 1.0 / 6.0], weight: 1.0 / 6.0 },
        RulePoint { at: [1.0 / 6.0, 2.0 / 3.0], weight: 1.0 / 6.0 },
    ],
    drawn_pieces: 1,
    vtk_type: 5,
    gmsh_type: 2,
    loops: |nodes, connectivity| ElementLoops::T3(Isoparametric::new(&T3, nodes, connectivity)),
};
