//! Named edges: distribution of a traction among their nodes, and rotation angle.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::Kinematics;
use crate::element::side_weights;
use crate::format::{engineering, number};
use crate::mesh::Mesh;
use crate::scene::Invalid;
use crate::sentence::sentence;

/// Nodes with a weight each.
pub type NodeWeights = Vec<(u32, f64)>;

/// Returns the sum of a nodal field's values times the nodes' weights: the mean, or the value at a point.
pub(crate) fn weighted_sum(nodal: &[Vector2<f64>], weights: &[(u32, f64)]) -> Vector2<f64> {
    weights.iter().map(|&(node, weight)| nodal[node as usize] * weight).sum()
}

/// Named edge of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    name: String,
    /// Nodes with their fraction of a uniform traction, ∫ Nₐ ds over the edge's length; the fractions sum to 1.
    pub weights: NodeWeights,
    /// Nodes with their weight cⱼ, 1/m, in the edge's direction d = Σ cⱼ xⱼ, which has length 1 at rest; empty if the edge
    /// is not straight.
    pub(super) arms: NodeWeights,
    direction: Vector2<f64>,
}

impl Edge {
    /// Returns all edges of a mesh, by name.
    pub(super) fn of(mesh: &Mesh) -> Vec<Self> {
        mesh.edges().keys().map(|name| Self::new(mesh, name)).collect()
    }

    fn new(mesh: &Mesh, name: &str) -> Self {
        let mut weights = BTreeMap::new();
        let mut total = 0.0;
        for segment in mesh.edges().get(name).into_iter().flatten() {
            let positions: Vec<Vector2<f64>> = segment.nodes().iter().map(|&n| mesh.node(n)).collect();
            for (&node, weight) in segment.nodes().iter().zip(side_weights(&positions)) {
                *weights.entry(node).or_insert(0.0) += weight;
                total += weight;
            }
        }
        let weights: NodeWeights = weights.into_iter().map(|(node, weight)| (node, weight / total)).collect();
        let (arms, direction) = arms(mesh, &weights).unwrap_or_default();
        Self { name: name.to_owned(), weights, arms, direction }
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns `true` if the edge is straight at rest: only then does it have a direction and can carry a moment.
    pub fn is_straight(&self) -> bool {
        !self.arms.is_empty()
    }

    /// Returns d = d₀ + Σ cⱼ uⱼ.
    pub(super) fn direction(&self, u: &[Vector2<f64>]) -> Vector2<f64> {
        self.direction + weighted_sum(u, &self.arms)
    }

    /// Returns the direction used for loads on the edge: the rest direction in linear theory, else the current one.
    pub(super) fn direction_in(&self, u: &[Vector2<f64>], kinematics: Kinematics) -> Vector2<f64> {
        match kinematics {
            Kinematics::Corotated => self.direction(u),
            Kinematics::Linear => self.direction,
        }
    }

    /// Returns the angle between the edge's rest and current directions, rad, chosen nearest to `previous` among
    /// multiples of 2π; `previous` if the edge has shrunk to a point.
    pub(super) fn angle(&self, u: &[Vector2<f64>], previous: f64) -> f64 {
        use std::f64::consts::TAU;
        let now = self.direction(u);
        let angle = self.direction.perp(&now).atan2(self.direction.dot(&now));
        let turns = ((previous - angle) / TAU).round();
        if now == Vector2::zeros() || !(angle + TAU * turns).is_finite() { previous } else { angle + TAU * turns }
    }

    /// Returns the rotation angle of linear theory, rad, which is linear in the displacement.
    pub(super) fn linear_angle(&self, u: &[Vector2<f64>]) -> f64 {
        self.direction.perp(&weighted_sum(u, &self.arms))
    }
}

/// Returns the weights cⱼ and the rest direction of a straight edge; `None` if it is not straight.
///
/// cⱼ is a node's fraction of the edge times its distance from the edge's middle, normalised.
fn arms(mesh: &Mesh, weights: &[(u32, f64)]) -> Option<(NodeWeights, Vector2<f64>)> {
    /// Largest distance from the line, relative to the edge's size, that counts as straight.
    const STRAIGHT: f64 = 1e-6;
    let middle = weighted_sum(mesh.nodes(), weights);
    let from_middle = |node: u32| mesh.node(node) - middle;
    let farthest = weights.iter().map(|&(n, _)| from_middle(n)).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let size = farthest.norm();
    if size <= 0.0 {
        return None;
    }
    let axis = farthest / size;
    if weights.iter().any(|&(node, _)| axis.perp(&from_middle(node)).abs() > STRAIGHT * size) {
        return None;
    }
    let distance = |node: u32| axis.dot(&from_middle(node));
    let second: f64 = weights.iter().map(|&(node, weight)| weight * distance(node).powi(2)).sum();
    let arms: NodeWeights = weights.iter().map(|&(node, weight)| (node, weight * distance(node) / second)).collect();
    let direction = weighted_sum(mesh.nodes(), &arms);
    direction.iter().all(|v| v.is_finite()).then_some((arms, direction))
}

/// Returns the node nearest to a point in the scene's table `key`; an error if it is farther away than the size of its
/// elements.
pub(super) fn node_at(mesh: &Mesh, at: [f64; 2], key: &str) -> Result<u32, Invalid> {
    let node = mesh.nearest_node(at.into());
    let nearest = mesh.node(node);
    let distance = (nearest - Vector2::from(at)).norm();
    let sizes = mesh.elements().filter(|nodes| nodes.contains(&node)).map(|nodes| {
        let from_node = nodes.iter().map(|&n| (mesh.node(n) - nearest).norm());
        from_node.fold(0.0, f64::max)
    });
    let size = sizes.fold(0.0, f64::max);
    // The comparison is `false` for NaN. Where elements differ much in size, the nearest node may belong to a smaller
    // element than the one that contains the point.
    if distance <= size || mesh.locate(at.into()).is_some() {
        return Ok(node);
    }
    let [x, y] = at;
    let message = format!(
        "expected a point in the body, or at most one element size ({}) from a node; ({}, {}) is {} from the nearest \
         node, at ({}, {})",
        engineering(size, "m"),
        number(x),
        number(y),
        engineering(distance, "m"),
        number(nearest.x),
        number(nearest.y)
    );
    Err(Invalid::new(format!("{key}.at"), message))
}

/// Returns the error for a scene's table `key` that names an edge that does not exist.
pub(super) fn no_such_edge(mesh: &Mesh, name: &str, key: &str) -> Invalid {
    if mesh.edges().is_empty() {
        let message = format!(
            "expected a named edge, got \"{name}\", but the mesh has no named edges; in Gmsh, make curves physical \
             groups, and the surface too: Gmsh saves only the physical groups if there are any"
        );
        return Invalid::new(format!("{key}.edge"), message);
    }
    let known: Vec<&str> = mesh.edges().keys().map(String::as_str).collect();
    let got = format!("\"{name}\"");
    let message = sentence!("expected one of %{known}, got %{got}", known = known.join(", "), got);
    Invalid::new(format!("{key}.edge"), message)
}
