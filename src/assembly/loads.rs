//! Loads: dead forces, and moments that rotate with their edges; constant, or pulses in time.
//!
//! In the plane such a moment is conservative: its potential is −M θ, θ the rotation of its edge, and its nodal forces
//! are M ∇θ.

use nalgebra::{Matrix2, Vector2};

use super::edge::node_at;
use super::{Edge, Kinematics, Matrix, NodeWeights, System};
use crate::element::UNIT;
use crate::mesh::Mesh;
use crate::scene::{Invalid, Load, Material, Place, Pulse};
use crate::sentence::sentence;
use crate::state::State;

/// Forces on some nodes, N.
type NodalForces = Vec<(u32, Vector2<f64>)>;

/// Nodal loads of a scene at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Loads {
    /// Constant dead forces, N.
    constant: Vec<Vector2<f64>>,
    /// Dead forces with pulses.
    pulses: Vec<(Pulse, NodalForces)>,
    moments: Vec<EdgeMoment>,
    /// All dead forces at the current time, N.
    dead: Vec<Vector2<f64>>,
}

/// Returns the weights of the nodes on which a force at a point acts, in the scene's table `key`; they sum to 1. `None` in
/// place of a width is the nearest node.
fn force_weights(mesh: &Mesh, at: [f64; 2], width: Option<f64>, key: &str) -> Result<NodeWeights, Invalid> {
    let weights = width.and_then(|width| mesh.weights_over(at.into(), width));
    weights.map_or_else(|| Ok(vec![(node_at(mesh, at, key)?, 1.0)]), Ok)
}

/// A moment on a straight edge.
#[derive(Clone, Debug, PartialEq)]
struct EdgeMoment {
    /// Index of the edge.
    edge: usize,
    /// Full size, N m, positive counter-clockwise.
    moment: f64,
    pulse: Option<Pulse>,
    /// Size at the current time, N m.
    now: f64,
    /// Indices of its tangent's blocks in the stiffness matrix.
    slots: Vec<u32>,
}

impl EdgeMoment {
    /// Adds M ∇θ at the current size times `factor`, N.
    fn add_force(
        &self,
        system: &System,
        factor: f64,
        gradient: impl Fn(&Edge, usize) -> Vector2<f64>,
        force: &mut [Vector2<f64>],
    ) {
        let edge = &system.edges()[self.edge];
        let scaled = gradient(edge, self.edge) * (factor * self.now);
        // If the edge has shrunk to a point, θ has no gradient and nothing is added.
        if scaled.iter().all(|v| v.is_finite()) {
            for &(node, c) in &edge.arms {
                force[node as usize] += scaled * c;
            }
        }
    }
}

impl Loads {
    /// Returns the loads of a scene at time 0; the pattern of `system` must couple the nodes of edges with moments.
    pub(super) fn new(loads: &[Load], material: &Material, system: &System) -> Result<Self, Invalid> {
        let nodes = system.mesh().nodes().len();
        let mut result = Self {
            constant: vec![Vector2::zeros(); nodes],
            pulses: Vec::new(),
            moments: Vec::new(),
            dead: vec![Vector2::zeros(); nodes],
        };
        for (i, load) in loads.iter().enumerate() {
            let key = format!("load.{i}");
            let (forces, pulse): (NodalForces, _) = match load {
                Load::Force { place: Place::At(at), at_point, width, force, pulse } => {
                    let weights = force_weights(system.mesh(), *at, at_point.then_some(*width), &key)?;
                    (weights.into_iter().map(|(node, weight)| (node, Vector2::from(*force) * weight)).collect(), pulse)
                }
                Load::Force { place: Place::Edge(name), force, pulse, .. } => {
                    let weights = &system.edge(name, &key)?.1.weights;
                    (weights.iter().map(|&(node, weight)| (node, Vector2::from(*force) * weight)).collect(), pulse)
                }
                Load::Gravity { acceleration, pulse } => {
                    let per_area = Vector2::from(*acceleration) * material.area_density();
                    ((0..).zip(system.nodal_areas().iter().map(|area| per_area * *area)).collect(), pulse)
                }
                Load::Moment { edge: name, moment, pulse } => {
                    let (edge, straight) = system.edge(name, &key)?;
                    if !straight.is_straight() {
                        let edge = format!("\"{name}\"");
                        let message = sentence!("expected a straight edge, got %{edge}, which is not straight", edge);
                        return Err(Invalid::new(format!("{key}.edge"), message));
                    }
                    let nodes: Vec<u32> = straight.arms.iter().map(|&(node, _)| node).collect();
                    let slots = system.pattern().block_slots(&nodes);
                    result.moments.push(EdgeMoment { edge, moment: *moment, pulse: *pulse, now: 0.0, slots });
                    continue;
                }
            };
            match pulse {
                Some(pulse) => result.pulses.push((*pulse, forces)),
                None => forces.into_iter().for_each(|(node, f)| result.constant[node as usize] += f),
            }
        }
        result.dead.copy_from_slice(&result.constant);
        result.set_time(0.0);
        Ok(result)
    }

    /// Sets pulses to their factor at a time, s.
    pub fn set_time(&mut self, time: f64) {
        self.set_pulses(&|pulse| pulse.factor(time));
    }

    /// Sets every pulse to a factor of its full size: in a time step, to its mean over the step, so that the step
    /// applies exactly the pulse's impulse.
    pub(crate) fn set_pulses(&mut self, factor: &dyn Fn(&Pulse) -> f64) {
        if !self.pulses.is_empty() {
            self.dead.copy_from_slice(&self.constant);
        }
        for (pulse, forces) in &self.pulses {
            let factor = factor(pulse);
            forces.iter().for_each(|&(node, f)| self.dead[node as usize] += f * factor);
        }
        for moment in &mut self.moments {
            moment.now = moment.moment * moment.pulse.as_ref().map_or(1.0, factor);
        }
    }

    /// Adds the nodal forces of pulses alone at their current size, N, times `factor`.
    pub(crate) fn add_pulse_force(
        &self,
        system: &System,
        u: &[Vector2<f64>],
        kinematics: Kinematics,
        factor: f64,
        force: &mut [Vector2<f64>],
    ) {
        if !self.pulses.is_empty() {
            for (f, (dead, constant)) in force.iter_mut().zip(self.dead.iter().zip(&self.constant)) {
                *f += (dead - constant) * factor;
            }
        }
        for moment in self.moments.iter().filter(|m| m.pulse.is_some()) {
            moment.add_force(system, factor, |edge, _| angle_gradient(edge.direction_in(u, kinematics)), force);
        }
    }

    /// Returns the work of the pulses from one state to another at a later time, J: the mean of their forces over that
    /// time times the change of displacement.
    pub(crate) fn pulse_work(&self, [before, after]: [&State; 2]) -> f64 {
        let mean = |pulse: &Pulse| pulse.mean(before.time, after.time);
        let increment = |node: u32| after.displacement[node as usize] - before.displacement[node as usize];
        let forces = self
            .pulses
            .iter()
            .map(|(pulse, forces)| mean(pulse) * forces.iter().map(|&(node, f)| f.dot(&increment(node))).sum::<f64>());
        let moments = self.moments.iter().filter_map(|m| {
            let pulse = m.pulse.as_ref()?;
            Some(mean(pulse) * m.moment * (after.edge_angles[m.edge] - before.edge_angles[m.edge]))
        });
        forces.chain(moments).sum()
    }

    /// Returns the nodal forces of the dead loads at the current time, N.
    pub fn dead_force(&self) -> &[Vector2<f64>] {
        &self.dead
    }

    /// Iterates over the indices of edges with a moment and the moments at the current time, N m.
    pub fn moments(&self) -> impl Iterator<Item = (usize, f64)> {
        self.moments.iter().map(|m| (m.edge, m.now))
    }

    /// Computes the external nodal force f_ext at this load factor, N. Linear theory uses the edges' rest directions.
    pub fn force(
        &self,
        system: &System,
        u: &[Vector2<f64>],
        kinematics: Kinematics,
        factor: f64,
        force: &mut [Vector2<f64>],
    ) {
        self.sum(system, factor, force, |edge, _| angle_gradient(edge.direction_in(u, kinematics)));
    }

    /// Adds to `bound` an upper bound of the rounding error of the moments' part of an external force, N. Dead forces
    /// count as exact.
    pub(super) fn add_rounding(
        &self,
        system: &System,
        u: &[Vector2<f64>],
        external: &[Vector2<f64>],
        bound: &mut [Vector2<f64>],
    ) {
        for EdgeMoment { edge, .. } in &self.moments {
            let edge = &system.edges()[*edge];
            let direction = edge.direction(u);
            let terms = edge.arms.iter().map(|&(node, c)| (u[node as usize] * c).abs()).sum::<Vector2<f64>>();
            let off = (terms + direction.abs()) * (edge.arms.len() as f64 + 1.0) * UNIT;
            // The gradient of the angle is J d/|d|²: its relative error is at most three times that of d.
            let relative = 3.0 * off.norm() / direction.norm() + 8.0 * UNIT;
            if relative.is_finite() {
                for &(node, _) in &edge.arms {
                    bound[node as usize] += Vector2::repeat(relative * external[node as usize].norm());
                }
            }
        }
    }

    /// Computes the discrete gradient of the loads between two states, N: its work from one to the other is exactly
    /// that of the loads (Gonzalez 1996, for the angle of an edge).
    pub fn force_between(&self, system: &System, [before, after]: [&State; 2], force: &mut [Vector2<f64>]) {
        /// Relative change of an edge's direction below which its angle is only rounding error.
        const NO_TURN: f64 = 1e-10;
        self.sum(system, 1.0, force, |edge, number| {
            let (d0, d1) = (edge.direction(&before.displacement), edge.direction(&after.displacement));
            let (mean, change) = ((d0 + d1) * 0.5, d1 - d0);
            let gradient = angle_gradient(mean);
            let scaled = after.edge_angles[number] - before.edge_angles[number];
            if change.norm() > NO_TURN * mean.norm() {
                gradient + change * ((scaled - gradient.dot(&change)) / change.norm_squared())
            } else {
                gradient
            }
        });
    }

    /// Adds up dead forces and moments, which act along the gradients of their edges' angles with respect to their
    /// directions.
    fn sum(
        &self,
        system: &System,
        factor: f64,
        force: &mut [Vector2<f64>],
        gradient: impl Fn(&Edge, usize) -> Vector2<f64>,
    ) {
        for (f, dead) in force.iter_mut().zip(&self.dead) {
            *f = dead * factor;
        }
        for moment in &self.moments {
            moment.add_force(system, factor, &gradient, force);
        }
    }

    /// Adds the derivative of −f_ext at this load factor: the Hessian of the moments' potential, N/m.
    pub fn add_stiffness(&self, system: &System, u: &[Vector2<f64>], factor: f64, matrix: &mut Matrix) {
        for EdgeMoment { edge, now, slots, .. } in &self.moments {
            let edge = &system.edges()[*edge];
            let d = edge.direction(u);
            let (p, q) = (2.0 * d.x * d.y, d.y * d.y - d.x * d.x);
            let hessian = Matrix2::new(p, q, q, -p) * (-factor * now / d.norm_squared().powi(2));
            if hessian.iter().all(|v| v.is_finite()) {
                matrix.add_blocks(slots, &edge.arms, &hessian);
            }
        }
    }

    /// Returns the potential of the loads relative to rest at this load factor, J: minus the work of the constant loads
    /// at full size. Pulses have no potential.
    pub fn potential(&self, state: &State, factor: f64) -> f64 {
        let dead: f64 = self.constant.iter().zip(&state.displacement).map(|(f, u)| f.dot(u)).sum();
        let always = self.moments.iter().filter(|m| m.pulse.is_none());
        let moments: f64 = always.map(|m| m.moment * state.edge_angles[m.edge]).sum();
        -factor * (dead + moments)
    }
}

/// Returns ∇θ with respect to an edge's direction d: d rotated by 90°, over its squared length.
fn angle_gradient(d: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-d.y, d.x) / d.norm_squared()
}
