//! Supports at points between nodes.
//!
//! Such a support prescribes the displacement of a point: Σ Nₐ uₐ = g, N the shape functions of the element there. Each
//! of these equations is solved for one unknown, which is eliminated; the others remain (master–slave elimination of
//! multi-point constraints: Cook, Malkus, Plesha and Witt, *Concepts and Applications of Finite Element Analysis*, 4th
//! edition, chapter 13).

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::NodeWeights;
use super::edge::weighted_sum;
use crate::mesh::Mesh;
use crate::scene::{Axis, Place, Support};

/// Coefficient below which an unknown has no influence on the displacement of a point.
const NEGLIGIBLE: f64 = 1e-9;

/// Point between nodes that a support holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HeldPoint {
    /// Index of the support in the scene.
    pub support: usize,
    /// Rest position, m.
    pub at: Vector2<f64>,
    /// Nodes of the element there, with their shape functions.
    pub weights: NodeWeights,
    /// Fixed components, x and y.
    pub axes: [bool; 2],
}

/// Linear equation between displacements of unknowns and of supports: Σ c u = Σ h g.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Constraint {
    /// Unknowns (2 · node + axis) with c.
    pub terms: BTreeMap<u32, f64>,
    /// Indices of supports with h; g is the component of the support's displacement along the axis of the unknowns.
    pub targets: BTreeMap<usize, f64>,
}

/// Unknown that a held point eliminates: u = Σ c u′ + Σ h g.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DependentUnknown {
    /// 2 · node + axis.
    pub unknown: u32,
    /// Right-hand side: unknowns u′ that are free or fixed by supports on nodes, and the supports' displacements g.
    pub on: Constraint,
}

/// Equations of all held points, solved.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HeldPoints {
    pub points: Vec<HeldPoint>,
    pub dependent: Vec<DependentUnknown>,
    /// Equations between fixed unknowns alone: their points are held by other supports already. With the index of the
    /// support.
    pub redundant: Vec<(usize, Constraint)>,
}

impl Constraint {
    /// Adds multiples of the two sides of another equation.
    fn add(&mut self, other: &Self, [of_terms, of_targets]: [f64; 2]) {
        for (&unknown, c) in &other.terms {
            *self.terms.entry(unknown).or_default() += of_terms * c;
        }
        for (&support, h) in &other.targets {
            *self.targets.entry(support).or_default() += of_targets * h;
        }
    }
}

/// Returns the axes, x and y, that a support fixes: `true` for fixed ones.
pub(super) fn axes(support: &Support) -> [bool; 2] {
    [Axis::X, Axis::Y].map(|axis| support.fix.contains(&axis))
}

/// Returns the nodes of the element at the point of a support, with their shape functions; `None` if the support is on
/// nodes, because it is meant to be, because its point is a node, or because its point is outside the body.
fn point_weights(support: &Support, mesh: &Mesh) -> Option<NodeWeights> {
    let Place::At(at) = support.place else { return None };
    let weights = if support.at_point { mesh.weights_over(at.into(), support.width) } else { None };
    let is_between = |weights: &NodeWeights| weights.iter().all(|(_, weight)| (weight - 1.0).abs() > NEGLIGIBLE);
    weights.filter(is_between)
}

/// Returns the points between nodes that supports hold.
pub(super) fn held_points(supports: &[Support], mesh: &Mesh) -> Vec<HeldPoint> {
    let held = supports.iter().enumerate().filter_map(|(i, support)| {
        let weights = point_weights(support, mesh)?;
        let at = weighted_sum(mesh.nodes(), &weights);
        Some(HeldPoint { support: i, at, weights, axes: axes(support) })
    });
    held.collect()
}

impl HeldPoints {
    /// Solves the equations of the points, each for the unknown that moves its point most; `fixed` are the unknowns that
    /// supports on nodes fix.
    pub(super) fn solve(points: Vec<HeldPoint>, fixed: &[bool]) -> Self {
        let mut result = Self::default();
        for (point, axis) in points.iter().flat_map(|point| (0..2_u32).map(move |axis| (point, axis))) {
            if !point.axes[axis as usize] {
                continue;
            }
            let mut own = Constraint {
                terms: point.weights.iter().map(|&(node, weight)| (2 * node + axis, weight)).collect(),
                targets: BTreeMap::from([(point.support, 1.0)]),
            };
            for DependentUnknown { unknown, on } in &result.dependent {
                if let Some(c) = own.terms.remove(unknown) {
                    // c u is c Σ c′ u′ on the left, and c Σ h g moves to the right.
                    own.add(on, [c, -c]);
                }
            }
            own.terms.retain(|_, c| c.abs() > NEGLIGIBLE);
            let free = own.terms.iter().filter(|(unknown, _)| !fixed[**unknown as usize]);
            let Some((&unknown, &pivot)) = free.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())) else {
                result.redundant.push((point.support, own));
                continue;
            };
            own.terms.remove(&unknown);
            let mut on = Constraint::default();
            on.add(&own, [-1.0 / pivot, 1.0 / pivot]);
            for other in &mut result.dependent {
                if let Some(c) = other.on.terms.remove(&unknown) {
                    other.on.add(&on, [c, c]);
                }
            }
            result.dependent.push(DependentUnknown { unknown, on });
        }
        Self { points, ..result }
    }

    /// Returns the supports, by their numbers, that hold a point already held by others, and those that hold a point in an
    /// element of which another support holds the point or a node in the same direction.
    #[cfg(feature = "cli")]
    pub(super) fn crowded(&self, fixed: impl Fn(u32) -> bool) -> [Vec<usize>; 2] {
        let redundant = self.redundant.iter().map(|(support, _)| *support);
        let unknowns = |point: &HeldPoint| -> Vec<u32> {
            let weights = point.weights.iter().filter(|(_, weight)| weight.abs() > NEGLIGIBLE);
            let held = (0..2_u32).filter(|&axis| point.axes[axis as usize]);
            weights.flat_map(|&(node, _)| held.clone().map(move |axis| 2 * node + axis)).collect()
        };
        let is_close = |point: &&HeldPoint| {
            let own = unknowns(point);
            let others = self.points.iter().filter(|other| other.support != point.support);
            let is_shared = |unknown: &u32| fixed(*unknown) || others.clone().any(|o| unknowns(o).contains(unknown));
            own.iter().any(is_shared)
        };
        let mut redundant: Vec<usize> = redundant.collect();
        redundant.dedup();
        let close = self.points.iter().filter(is_close).map(|point| point.support);
        let close = close.filter(|support| !redundant.contains(support)).collect();
        [redundant, close]
    }

    /// Returns the force, N, that the support number `support` exerts on its point, from the force on each unknown that
    /// keeps the nodes in balance: by virtual work, Σ h times the force on the unknowns that depend on its displacement.
    pub(super) fn force(&self, support: usize, residual: &[Vector2<f64>]) -> Vector2<f64> {
        let mut force = Vector2::zeros();
        for DependentUnknown { unknown, on } in &self.dependent {
            let (node, axis) = (*unknown as usize / 2, *unknown as usize % 2);
            force[axis] -= on.targets.get(&support).map_or(0.0, |h| h * residual[node][axis]);
        }
        force
    }
}
