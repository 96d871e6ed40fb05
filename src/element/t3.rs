//! The three-node triangle: linear shape functions, constant strain, one quadrature point.

use nalgebra::Vector2;

use super::QuadraturePoint;

/// One sentence about it.
pub(super) const ABOUT: &str = "Three nodes, constant strain: cheap, and too stiff in bending.";

/// Nodes of the element.
pub const NODES: usize = 3;

/// Quadrature points: the centroid.
pub const POINTS: [[f64; 3]; 1] = [[1.0 / 3.0; 3]];

/// Nₐ at the area coordinates `l`: the coordinates themselves.
#[must_use]
pub fn shape(l: [f64; 3]) -> [f64; NODES] {
    l
}

/// (∂Nₐ/∂l₂, ∂Nₐ/∂l₃) with l₁ = 1 − l₂ − l₃.
#[must_use]
pub fn local_gradients() -> [Vector2<f64>; NODES] {
    [Vector2::new(-1.0, -1.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)]
}

/// The one quadrature point of a triangle with these rest corners (counter-clockwise, m) and thickness, m.
///
/// ∇Nₐ is the opposite side turned by a quarter, over twice the area. That there is an area, [`crate::mesh::Mesh`] has
/// checked.
#[must_use]
pub fn quadrature(corners: [Vector2<f64>; NODES], thickness: f64) -> [QuadraturePoint<NODES>; 1] {
    let [a, b, c] = corners;
    let doubled = (b - a).perp(&(c - a));
    let gradient = |side: Vector2<f64>| Vector2::new(-side.y, side.x) / doubled;
    [QuadraturePoint {
        shape: shape(POINTS[0]),
        gradients: [gradient(c - b), gradient(a - c), gradient(b - a)],
        volume: 0.5 * doubled * thickness,
    }]
}
