//! The six-node triangle: quadratic shape functions, three quadrature points, curved edges.
//!
//! Nodes: corners, then the midpoints of sides 12, 23, 31. One rotation a quadrature point. It does not lock in bending.

use nalgebra::{Matrix2, Vector2};

use super::QuadraturePoint;

/// One sentence about it.
pub(super) const ABOUT: &str = "Six nodes, linear strain: bends as it should.";

/// Nodes of the element.
pub const NODES: usize = 6;

/// Quadrature points: the rule of degree 2 with equal weights, exact for Ke of straight-sided triangles.
pub const POINTS: [[f64; 3]; 3] =
    [[2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0]];

/// Nₐ at the area coordinates `l`: lₐ (2 lₐ − 1) at corners, 4 lₐ l_b between them.
#[must_use]
pub fn shape(l: [f64; 3]) -> [f64; NODES] {
    let [a, b, c] = l;
    [a * (2.0 * a - 1.0), b * (2.0 * b - 1.0), c * (2.0 * c - 1.0), 4.0 * a * b, 4.0 * b * c, 4.0 * c * a]
}

/// (∂Nₐ/∂l₂, ∂Nₐ/∂l₃) with l₁ = 1 − l₂ − l₃.
#[must_use]
pub fn local_gradients(l: [f64; 3]) -> [Vector2<f64>; NODES] {
    let [a, b, c] = l;
    [
        Vector2::new(1.0 - 4.0 * a, 1.0 - 4.0 * a),
        Vector2::new(4.0 * b - 1.0, 0.0),
        Vector2::new(0.0, 4.0 * c - 1.0),
        Vector2::new(4.0 * (a - b), -4.0 * b),
        Vector2::new(4.0 * c, 4.0 * b),
        Vector2::new(-4.0 * c, 4.0 * (a - c)),
    ]
}

/// The quadrature points of a triangle with these rest nodes (m) and thickness, m; `None` where the isoparametric map
/// folds over.
#[must_use]
pub fn quadrature(nodes: [Vector2<f64>; NODES], thickness: f64) -> Option<[QuadraturePoint<NODES>; 3]> {
    let point = |l: [f64; 3]| {
        let local = local_gradients(l);
        // J = ∂X/∂(l₂, l₃); gradients with respect to X are local gradients times J⁻¹.
        let mut jacobian = Matrix2::zeros();
        for (x, g) in nodes.iter().zip(&local) {
            jacobian += x * g.transpose();
        }
        let determinant = jacobian.determinant();
        let inverse = jacobian.try_inverse().filter(|_| determinant > 0.0)?;
        Some(QuadraturePoint {
            shape: shape(l),
            gradients: local.map(|g| inverse.transpose() * g),
            volume: determinant * thickness / 6.0,
        })
    };
    let [a, b, c] = POINTS.map(point);
    Some([a?, b?, c?])
}
