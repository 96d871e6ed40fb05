//! Mouse spring: a damped spring from a material point of the body to the pointer.

use nalgebra::{Matrix2, Vector2};

use super::edge::weighted_sum;
use super::{Matrix, NodeWeights, System};
use crate::mesh::MaterialPoint;

/// Elongation beyond which the force is capped, relative to the body's size.
const REACH: f64 = 0.25;
/// Largest force, relative to E times thickness times the size of the held element: with 0.5, throws can invert it.
const STRAIN: f64 = 0.4;

/// Mouse spring: a damped spring from a material point at x to the pointer at p. Its force k (p − x + τ (ṗ − ẋ)), with
/// stiffness k, N/m, and delay τ, s, is capped smoothly (Huber 1964), so that its tangent is never negative and no
/// pointer motion exerts more force than a time step and the held element can handle.
#[derive(Clone, Debug, PartialEq)]
pub struct MouseSpring {
    point: MaterialPoint,
    weights: NodeWeights,
    /// Indices of its tangent's blocks in the stiffness matrix.
    slots: Vec<u32>,
    rest: Vector2<f64>,
    stiffness: f64,
    delay: f64,
    reach: f64,
    path: Path,
    target: Vector2<f64>,
    target_velocity: Vector2<f64>,
}

/// Straight path of the pointer: start and end points (m) and times (s).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Path {
    points: [Vector2<f64>; 2],
    times: [f64; 2],
}

impl MouseSpring {
    /// Returns the largest force on a point that its element carries without being inverted, N; `axial` is E times
    /// thickness, N/m.
    pub(crate) fn strength(system: &System, point: MaterialPoint, axial: f64) -> f64 {
        let (mesh, weights) = (system.mesh(), system.mesh().weights(point).unwrap_or_default());
        let places: Vec<_> = weights.iter().map(|&(node, _)| mesh.node(node)).collect();
        STRAIN * axial * mesh.entry().nodal_areas(&places).iter().sum::<f64>().sqrt()
    }

    /// Returns a spring at a point of a body, whose target is the point's rest position until [`Self::lead`] is called;
    /// `None` if there is no such point. `stiffness` is k, N/m; `delay` is τ, s: damper over spring constant; `most` is the
    /// largest force, N.
    pub(crate) fn new(system: &System, point: MaterialPoint, stiffness: f64, delay: f64, most: f64) -> Option<Self> {
        let mesh = system.mesh();
        let weights = mesh.weights(point)?;
        let nodes: Vec<u32> = weights.iter().map(|&(node, _)| node).collect();
        let rest = weighted_sum(mesh.nodes(), &weights);
        Some(Self {
            point,
            slots: system.pattern().block_slots(&nodes),
            weights,
            rest,
            stiffness,
            delay,
            reach: (REACH * system.size()).min(most / stiffness),
            path: Path { points: [rest; 2], times: [0.0; 2] },
            target: rest,
            target_velocity: Vector2::zeros(),
        })
    }

    /// Returns the same spring on another system with the same mesh.
    pub(super) fn adapt(&self, system: &System) -> Self {
        let nodes: Vec<u32> = self.weights.iter().map(|&(node, _)| node).collect();
        Self { slots: system.pattern().block_slots(&nodes), ..self.clone() }
    }

    /// Returns the material point that the spring is attached to.
    pub fn point(&self) -> MaterialPoint {
        self.point
    }

    /// Returns k, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Returns the largest force, N.
    pub fn largest_force(&self) -> f64 {
        self.stiffness * self.reach
    }

    /// Moves the target along a straight path to a point, m, within a time, s; `now` is the start time.
    pub(crate) fn lead(&mut self, to: Vector2<f64>, now: f64, within: f64) {
        self.path = Path { points: [self.target, to], times: [now, now + within] };
        self.set_time(now);
    }

    /// Sets the target to its position at a time, s.
    pub(super) fn set_time(&mut self, time: f64) {
        let Path { points: [from, to], times: [begin, end] } = self.path;
        let within = end - begin;
        if within > 0.0 && time < end {
            self.target = from + (to - from) * ((time - begin) / within).clamp(0.0, 1.0);
        } else {
            self.target = to;
        }
        // The velocity is still nonzero at the very end, because time steps use the past interval.
        let moves = within > 0.0 && time <= end;
        self.target_velocity = if moves { (to - from) / within } else { Vector2::zeros() };
    }

    /// Halves the largest force.
    pub(crate) fn slip(&mut self) {
        self.reach *= 0.5;
    }

    /// Interpolates a nodal field at the point.
    pub(crate) fn mean(&self, nodal: &[Vector2<f64>]) -> Vector2<f64> {
        weighted_sum(nodal, &self.weights)
    }

    /// Returns the position of the point for this displacement, m.
    pub fn position(&self, u: &[Vector2<f64>]) -> Vector2<f64> {
        self.rest + self.mean(u)
    }

    /// Returns the target position, m.
    pub fn target(&self) -> Vector2<f64> {
        self.target
    }

    /// Returns p − x + τ (ṗ − ẋ) for a displacement and a velocity of the point.
    fn pull(&self, u: Vector2<f64>, v: Vector2<f64>, delay: f64) -> Vector2<f64> {
        self.target - self.rest - u + (self.target_velocity - v) * delay
    }

    fn capped(&self, pull: Vector2<f64>, stiffness: f64) -> Vector2<f64> {
        pull * (stiffness * (self.reach / pull.norm()).min(1.0))
    }

    /// Returns the force on the point, N, for its displacement, m, and velocity, m/s.
    pub fn force(&self, u: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
        self.capped(self.pull(u, v, self.delay), self.stiffness)
    }

    /// Computes [`Self::force`] with stiffness and delay reduced to what is stable in an explicit step of length h, s,
    /// with masses, kg, lumped at the nodes.
    pub(crate) fn softened_force(&self, u: Vector2<f64>, v: Vector2<f64>, lumped: &[f64], h: f64) -> Vector2<f64> {
        /// Upper bound of h² k and of h k τ over the mass that moves with the point; beyond about 1 the step would
        /// overshoot.
        const SOFT: f64 = 0.25;
        let mobility: f64 = self.weights.iter().map(|&(node, w)| w * w / lumped[node as usize]).sum();
        let stiffness = self.stiffness.min(SOFT / (mobility * h * h));
        let delay = self.delay.min(SOFT / (mobility * h * stiffness));
        self.capped(self.pull(u, v, delay), stiffness)
    }

    /// Returns the force on the point of a body at rest, N.
    pub fn force_at_rest(&self, u: &[Vector2<f64>]) -> Vector2<f64> {
        self.force(self.mean(u), self.target_velocity)
    }

    /// Returns the energy of the spring of a body at rest, J.
    pub(super) fn energy(&self, u: &[Vector2<f64>]) -> f64 {
        let d = self.pull(self.mean(u), self.target_velocity, 0.0).norm();
        if d <= self.reach {
            0.5 * self.stiffness * d * d
        } else {
            self.stiffness * self.reach * (d - 0.5 * self.reach)
        }
    }

    /// Adds a force on the point to nodal forces, N.
    pub(crate) fn add_force(&self, on_point: Vector2<f64>, force: &mut [Vector2<f64>]) {
        for &(node, w) in &self.weights {
            force[node as usize] += on_point * w;
        }
    }

    /// Adds the spring's stiffness below the cap, N/m, times `factor`. The actual stiffness is never larger, so that a
    /// step with this one does not overshoot, however far away the pointer is.
    pub(super) fn add_largest_stiffness(&self, factor: f64, matrix: &mut Matrix) {
        matrix.add_blocks(&self.slots, &self.weights, &(Matrix2::identity() * (factor * self.stiffness)));
    }

    /// Adds the secant of minus the force with respect to the displacement, N/m, times `factor`; `rate`, 1/s, is the
    /// derivative of the velocity with respect to the displacement. Below the cap it is the derivative, which vanishes along
    /// the pull beyond: steps with it would overshoot.
    pub(crate) fn add_stiffness(&self, u: Vector2<f64>, v: Vector2<f64>, rate: f64, factor: f64, matrix: &mut Matrix) {
        let part = (self.reach / self.pull(u, v, self.delay).norm()).min(1.0);
        let factor = factor * part * self.stiffness * (1.0 + self.delay * rate);
        matrix.add_blocks(&self.slots, &self.weights, &(Matrix2::identity() * factor));
    }
}
