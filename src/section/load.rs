//! Loads and reactions between a line and the nodes in front of it.
//!
//! Weight, edge loads, and forces and reactions at points act on nodes in the discrete problem. The nodes in front of a line carry other loads than the
//! part of the body in front of it; the difference is that of the elements which the line crosses.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::cut::{Cut, Side};
use crate::assembly::{Forces, Problem};
use crate::element::{integrate_side, side_weights};
use crate::mesh::{MaterialPoint, Mesh};
use crate::scene::{Load, Place, Pulse};

/// Body in its current positions.
pub(super) struct PlacedMesh<'a> {
    pub mesh: &'a Mesh,
    /// Current positions of the nodes, m: those of rest in linear theory.
    pub positions: &'a [Vector2<f64>],
}

/// Force and moment about a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector2<f64>,
    /// Moment about the point, N m, counter-clockwise.
    pub moment: f64,
}

impl Wrench {
    /// Adds a force at the end of an arm from the point.
    pub(crate) fn add(&mut self, arm: Vector2<f64>, force: Vector2<f64>) {
        self.force += force;
        self.moment += arm.perp(&force);
    }
}

/// Returns, for an equilibrium, the loads and reactions on the part of a body in front of a cut, minus those on the nodes in
/// front: force, N, and moment about `middle`, N m.
pub(super) fn beyond_nodes(
    problem: &Problem,
    shape: &PlacedMesh<'_>,
    cut: &Cut,
    (load_factor, forces): (f64, &Forces),
    middle: Vector2<f64>,
) -> Wrench {
    let mut sum = Wrench::default();
    for (support, force) in problem.supports().point_forces(forces.residual()) {
        shape.add_point_load(cut, support.middle, force, middle, &mut sum);
    }
    let factor = |pulse: &Option<Pulse>| load_factor * pulse.as_ref().map_or(1.0, |pulse| pulse.factor(0.0));
    let mut weight = Vector2::zeros();
    for load in problem.scene_loads() {
        match load {
            Load::Gravity { acceleration, pulse } => {
                weight += Vector2::from(*acceleration) * (factor(pulse) * problem.material().area_density());
            }
            Load::Force { place: Place::Edge(name), force, pulse, .. } => {
                shape.add_edge_load(cut, name, Vector2::from(*force) * factor(pulse), middle, &mut sum);
            }
            Load::Force { place: Place::At(at), at_point: true, force, pulse } => {
                shape.add_point_load(cut, (*at).into(), Vector2::from(*force) * factor(pulse), middle, &mut sum);
            }
            _ => {}
        }
    }
    if weight != Vector2::zeros() {
        for &element in &cut.elements {
            shape.add_weight(element, cut.side(), weight, middle, &mut sum);
        }
    }
    sum
}

impl PlacedMesh<'_> {
    fn position(&self, weights: impl Iterator<Item = (u32, f64)>) -> Vector2<f64> {
        weights.map(|(node, weight)| self.positions[node as usize] * weight).sum()
    }

    /// Adds the weight, N/m², of the part of an element in front, minus that of its nodes in front.
    fn add_weight(&self, element: usize, side: Side, weight: Vector2<f64>, middle: Vector2<f64>, sum: &mut Wrench) {
        let mesh = self.mesh;
        let Some(nodes) = mesh.elements().nth(element) else { return };
        let rest: Vec<Vector2<f64>> = nodes.iter().map(|&node| mesh.node(node)).collect();
        for (&node, area) in nodes.iter().zip(mesh.entry().nodal_areas(&rest)) {
            if side.is_in_front(mesh.node(node)) {
                sum.add(self.positions[node as usize] - middle, weight * -area);
            }
        }
        let corners = part_in_front(mesh, nodes, side);
        let Some((first, others)) = corners.split_first() else { return };
        for pair in others.windows(2) {
            let triangle = [*first, pair[0], pair[1]];
            let area = 0.5 * (triangle[1] - triangle[0]).perp(&(triangle[2] - triangle[0]));
            // The middles of the sides, exact to degree 2.
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let at = (triangle[a] + triangle[b]) * 0.5;
                let place = mesh.place_in(element, at);
                let weights = place.and_then(|at| mesh.weights(MaterialPoint { element, at }));
                if let Some(weights) = weights {
                    sum.add(self.position(weights.into_iter()) - middle, weight * (area / 3.0));
                }
            }
        }
    }

    /// Adds the force, N, at a point inside an element of the cut if the point is in front, minus its parts on the nodes
    /// in front.
    fn add_point_load(&self, cut: &Cut, at: Vector2<f64>, force: Vector2<f64>, middle: Vector2<f64>, sum: &mut Wrench) {
        let (mesh, side) = (self.mesh, cut.side());
        let Some(point) = mesh.locate(at).filter(|point| cut.elements.contains(&point.element)) else { return };
        let Some(weights) = mesh.weights(point) else { return };
        for &(node, weight) in weights.iter().filter(|(node, _)| side.is_in_front(mesh.node(*node))) {
            sum.add(self.positions[node as usize] - middle, force * -weight);
        }
        if side.is_in_front(at) {
            sum.add(self.position(weights.into_iter()) - middle, force);
        }
    }

    /// Adds the part of an edge's total load, N, in front, minus that of its nodes in front, on the sides of the cut's
    /// elements.
    fn add_edge_load(&self, cut: &Cut, name: &str, total: Vector2<f64>, middle: Vector2<f64>, sum: &mut Wrench) {
        let mesh = self.mesh;
        let Some(segments) = mesh.edges().get(name) else { return };
        let rest = |nodes: &[u32]| -> Vec<Vector2<f64>> { nodes.iter().map(|&node| mesh.node(node)).collect() };
        let length: f64 = segments.iter().flat_map(|segment| side_weights(&rest(segment.nodes()))).sum();
        let per_length = total / length;
        let elements = cut.elements.iter().filter_map(|&element| mesh.elements().nth(element));
        let crossed: BTreeSet<[u32; 2]> = elements.flat_map(|nodes| mesh.sides(nodes)).map(|side| side.key()).collect();
        let side = cut.side();
        for segment in segments.iter().filter(|segment| crossed.contains(&segment.key())) {
            let nodes = rest(segment.nodes());
            for ((&node, at), share) in segment.nodes().iter().zip(&nodes).zip(side_weights(&nodes)) {
                if side.is_in_front(*at) {
                    sum.add(self.positions[node as usize] - middle, per_length * -share);
                }
            }
            let mut ends = vec![-1.0];
            ends.extend(side.crossings(&nodes));
            ends.push(1.0);
            let mut is_in_front = nodes.first().is_some_and(|&at| side.is_in_front(at));
            for part in ends.windows(2) {
                if is_in_front {
                    integrate_side(&nodes, [part[0], part[1]], |shape, length| {
                        let at = self.position(segment.nodes().iter().copied().zip(shape.iter().copied()));
                        sum.add(at - middle, per_length * length);
                    });
                }
                is_in_front = !is_in_front;
            }
        }
    }
}

/// Returns the corners of the part of an element in front at rest, counter-clockwise; curved sides become straight
/// between their nodes.
fn part_in_front(mesh: &Mesh, nodes: &[u32], side: Side) -> Vec<Vector2<f64>> {
    let outline: Vec<Vector2<f64>> = mesh
        .sides(nodes)
        .flat_map(|segment| {
            // The last node of a side is the first of the next.
            let (_, own) = segment.nodes().split_last().unwrap_or((&0, &[]));
            own.iter().map(|&node| mesh.node(node)).collect::<Vec<_>>()
        })
        .collect();
    let mut part = Vec::new();
    for (i, &from) in outline.iter().enumerate() {
        let to = outline[(i + 1) % outline.len()];
        if side.is_in_front(from) {
            part.push(from);
        }
        part.extend(side.crossings(&[from, to]).into_iter().map(|xi| from + (to - from) * (0.5 * (xi + 1.0))));
    }
    part
}
