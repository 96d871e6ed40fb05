//! Sides of triangles: two nodes, or two ends and a node between them.

use nalgebra::Vector2;

/// Gauss points and weights on [−1, 1], exact to degree 5.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Shape functions of a side at ξ in [−1, 1]: of its two ends, and of the node between them, 0 where there is none.
#[must_use]
pub fn side_shape(xi: f64, quadratic: bool) -> [f64; 3] {
    if quadratic {
        [0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi]
    } else {
        [0.5 * (1.0 - xi), 0.5 * (1.0 + xi), 0.0]
    }
}

fn shape_derivative(xi: f64, quadratic: bool) -> [f64; 3] {
    if quadratic { [xi - 0.5, xi + 0.5, -2.0 * xi] } else { [-0.5, 0.5, 0.0] }
}

/// ∫ Nₐ ds for the two ends and the middle node (0 where there is none), m: the nodes' shares of a unit traction.
#[must_use]
pub fn side_weights(ends: [Vector2<f64>; 2], middle: Option<Vector2<f64>>) -> [f64; 3] {
    let nodes = [ends[0], ends[1], middle.unwrap_or_default()];
    let mut weights = [0.0; 3];
    for (xi, weight) in GAUSS {
        let derivative = shape_derivative(xi, middle.is_some());
        let tangent: Vector2<f64> = nodes.iter().zip(derivative).map(|(x, d)| x * d).sum();
        for (sum, n) in weights.iter_mut().zip(side_shape(xi, middle.is_some())) {
            *sum += weight * tangent.norm() * n;
        }
    }
    weights
}
