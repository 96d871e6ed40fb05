//! An end moment that turns with its edge. In the plane it is conservative: its potential is −M θ, θ the edge's mean
//! rotation.

use nalgebra::{Matrix2, Vector2};

use super::pattern::Pattern;
use crate::mesh::Mesh;

/// A moment on a straight edge, N m, positive counter-clockwise.
///
/// With weights c (a node's share of the edge times its distance from the middle, normalised), d = Σ cⱼ xⱼ is the
/// edge's unit direction at rest, and θ the angle it has turned since. The nodal forces are M ∇θ.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeMoment {
    /// N m.
    pub moment: f64,
    /// Node and weight cⱼ, 1/m.
    pub weights: Vec<(u32, f64)>,
}

impl EdgeMoment {
    /// From the nodes of an edge with their shares, which sum to 1; `None` where the edge is not straight.
    pub(super) fn new(mesh: &Mesh, shares: &[(u32, f64)], moment: f64) -> Option<Self> {
        /// Distance from the line, over the edge's size, that counts as straight.
        const STRAIGHT: f64 = 1e-6;
        let position = |node: u32| mesh.nodes[node as usize];
        let middle: Vector2<f64> = shares.iter().map(|&(node, share)| position(node) * share).sum();
        let farthest =
            shares.iter().map(|&(node, _)| position(node) - middle).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let size = farthest.norm();
        if size <= 0.0 {
            return None;
        }
        let direction = farthest / size;
        let straight =
            shares.iter().all(|&(node, _)| direction.perp(&(position(node) - middle)).abs() <= STRAIGHT * size);
        let distance = |node: u32| direction.dot(&(position(node) - middle));
        let second: f64 = shares.iter().map(|&(node, share)| share * distance(node).powi(2)).sum();
        let weights = shares.iter().map(|&(node, share)| (node, share * distance(node) / second)).collect();
        straight.then_some(Self { moment, weights })
    }

    /// d = d₀ + Σ cⱼ uⱼ over the rest direction d₀.
    fn direction(&self, mesh: &Mesh, u: &[Vector2<f64>]) -> Vector2<f64> {
        self.weights.iter().map(|&(node, c)| (mesh.nodes[node as usize] + u[node as usize]) * c).sum()
    }

    /// The potential −M θ relative to rest, J; θ in (−π, π].
    #[must_use]
    pub fn potential(&self, mesh: &Mesh, u: &[Vector2<f64>]) -> f64 {
        let now = self.direction(mesh, u);
        let rest: Vector2<f64> = self.weights.iter().map(|&(node, c)| mesh.nodes[node as usize] * c).sum();
        -self.moment * rest.perp(&now).atan2(rest.dot(&now))
    }

    /// Adds `factor` M ∇θ to the nodal forces, N. Where the edge has shrunk to a point θ has no gradient: none is added.
    pub(super) fn add_force(&self, mesh: &Mesh, u: &[Vector2<f64>], factor: f64, force: &mut [Vector2<f64>]) {
        let d = self.direction(mesh, u);
        let turned = Vector2::new(-d.y, d.x) * (factor * self.moment / d.norm_squared());
        if turned.iter().all(|v| v.is_finite()) {
            for &(node, c) in &self.weights {
                force[node as usize] += turned * c;
            }
        }
    }

    /// Adds the Hessian of −`factor` M θ to the lower-triangle values, N/m.
    pub(super) fn add_stiffness(
        &self,
        mesh: &Mesh,
        u: &[Vector2<f64>],
        factor: f64,
        pattern: &Pattern,
        values: &mut [f64],
    ) {
        let d = self.direction(mesh, u);
        let (p, q) = (2.0 * d.x * d.y, d.y * d.y - d.x * d.x);
        let hessian = Matrix2::new(p, q, q, -p) * (-factor * self.moment / d.norm_squared().powi(2));
        if !hessian.iter().all(|v| v.is_finite()) {
            return;
        }
        for (i, &(a, ca)) in self.weights.iter().enumerate() {
            for &(b, cb) in &self.weights[..=i] {
                for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if a == b && column > row {
                        continue;
                    }
                    values[pattern.slot(2 * a + row, 2 * b + column) as usize] +=
                        hessian[(row as usize, column as usize)] * ca * cb;
                }
            }
        }
    }
}
