//! A hand: a damped spring from a material point of the body to where the pointer is.

use nalgebra::{Matrix2, Vector2};

use super::{Matrix, NodeWeights, System};
use crate::mesh::MaterialPoint;

/// The part of the body's size from which on a hand pulls no harder.
const REACH: f64 = 0.25;

/// A hold on a material point. Its force k (p − x + τ (ṗ − ẋ)) grows up to a cap, smoothly (Huber 1964), so that its
/// tangent is never negative and nothing a pointer can do is too much for a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Hand {
    point: MaterialPoint,
    weights: NodeWeights,
    /// Where the blocks of its tangent go.
    slots: Vec<u32>,
    rest: Vector2<f64>,
    stiffness: f64,
    delay: f64,
    reach: f64,
    path: Path,
    target: Vector2<f64>,
    target_velocity: Vector2<f64>,
}

/// A straight way of the pointer: from where, to where (m), and when (s).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Path {
    points: [Vector2<f64>; 2],
    times: [f64; 2],
}

impl Hand {
    /// A hold on a point of a body, which pulls it to where it is at rest until it is told where to; `None` where there
    /// is no such point. `stiffness` is k, N/m; `delay` is τ, s: the damper over the spring.
    pub(crate) fn new(system: &System, point: MaterialPoint, stiffness: f64, delay: f64) -> Option<Self> {
        let mesh = system.mesh();
        let weights = mesh.weights(point)?;
        let nodes: Vec<u32> = weights.iter().map(|&(node, _)| node).collect();
        let rest = weights.iter().map(|&(node, w)| mesh.node(node) * w).sum();
        Some(Self {
            point,
            slots: system.pattern().block_slots(&nodes),
            weights,
            rest,
            stiffness,
            delay,
            reach: REACH * system.size(),
            path: Path { points: [rest; 2], times: [0.0; 2] },
            target: rest,
            target_velocity: Vector2::zeros(),
        })
    }

    /// The same hold on a system with the same mesh.
    pub(super) fn adapt(&self, system: &System) -> Self {
        let nodes: Vec<u32> = self.weights.iter().map(|&(node, _)| node).collect();
        Self { slots: system.pattern().block_slots(&nodes), ..self.clone() }
    }

    /// The material point that is held.
    #[must_use]
    pub fn point(&self) -> MaterialPoint {
        self.point
    }

    /// k, N/m.
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The largest force it pulls with, N.
    #[must_use]
    pub fn largest_force(&self) -> f64 {
        self.stiffness * self.reach
    }

    /// Lets the pointer go from where it is to a point, m, within a time, s; `now` is the time it begins.
    pub(crate) fn lead(&mut self, to: Vector2<f64>, now: f64, within: f64) {
        self.path = Path { points: [self.target, to], times: [now, now + within] };
        self.set_time(now);
    }

    /// Puts the pointer where it is at a time, s.
    pub(super) fn set_time(&mut self, time: f64) {
        let Path { points: [from, to], times: [begin, end] } = self.path;
        let within = end - begin;
        if within > 0.0 && time < end {
            self.target = from + (to - from) * ((time - begin) / within).clamp(0.0, 1.0);
        } else {
            self.target = to;
        }
        // At the very end it still moves: steps look back on what was.
        let moves = within > 0.0 && time <= end;
        self.target_velocity = if moves { (to - from) / within } else { Vector2::zeros() };
    }

    /// The mean of a nodal field at the point.
    pub(crate) fn mean(&self, nodal: &[Vector2<f64>]) -> Vector2<f64> {
        self.weights.iter().map(|&(node, w)| nodal[node as usize] * w).sum()
    }

    /// Where the point is for this displacement, m.
    #[must_use]
    pub fn position(&self, u: &[Vector2<f64>]) -> Vector2<f64> {
        self.rest + self.mean(u)
    }

    /// Where it is pulled to, m.
    #[must_use]
    pub fn target(&self) -> Vector2<f64> {
        self.target
    }

    /// p − x + τ (ṗ − ẋ) for a displacement and a velocity of the point.
    fn pull(&self, u: Vector2<f64>, v: Vector2<f64>, delay: f64) -> Vector2<f64> {
        self.target - self.rest - u + (self.target_velocity - v) * delay
    }

    fn capped(&self, pull: Vector2<f64>, stiffness: f64) -> Vector2<f64> {
        pull * (stiffness * (self.reach / pull.norm()).min(1.0))
    }

    /// The force on the point for its displacement, m, and velocity, m/s, N.
    #[must_use]
    pub fn force(&self, u: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
        self.capped(self.pull(u, v, self.delay), self.stiffness)
    }

    /// [`Self::force`] of a hand that is as soft as an explicit step of length h, s, can bear where masses, kg, are
    /// lumped on the nodes.
    pub(crate) fn softened_force(&self, u: Vector2<f64>, v: Vector2<f64>, lumped: &[f64], h: f64) -> Vector2<f64> {
        /// h² k and h k τ over the mass that moves with the point; beyond about 1 the step would overshoot.
        const SOFT: f64 = 0.25;
        let mobility: f64 = self.weights.iter().map(|&(node, w)| w * w / lumped[node as usize]).sum();
        let stiffness = self.stiffness.min(SOFT / (mobility * h * h));
        let delay = self.delay.min(SOFT / (mobility * h * stiffness));
        self.capped(self.pull(u, v, delay), stiffness)
    }

    /// The force on the point of a body at rest, N.
    #[must_use]
    pub fn force_at_rest(&self, u: &[Vector2<f64>]) -> Vector2<f64> {
        self.force(self.mean(u), self.target_velocity)
    }

    /// Energy of the spring of a body at rest, J.
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

    /// Adds the spring's stiffness as it is below the cap, N/m, times `factor`. The true one is never larger, so that a
    /// search with this one never overshoots, however far away the pointer is.
    pub(super) fn add_largest_stiffness(&self, factor: f64, matrix: &mut Matrix) {
        matrix.add_blocks(&self.slots, &self.weights, &(Matrix2::identity() * (factor * self.stiffness)));
    }

    /// Adds the derivative of minus the force with respect to the displacement, N/m, times `factor`; the velocity
    /// depends on the displacement with this rate, 1/s.
    pub(crate) fn add_stiffness(&self, u: Vector2<f64>, v: Vector2<f64>, rate: f64, factor: f64, matrix: &mut Matrix) {
        let pull = self.pull(u, v, self.delay);
        let length = pull.norm();
        let huber = if length <= self.reach {
            Matrix2::identity()
        } else {
            let direction = pull / length;
            (Matrix2::identity() - direction * direction.transpose()) * (self.reach / length)
        };
        let factor = factor * self.stiffness * (1.0 + self.delay * rate);
        matrix.add_blocks(&self.slots, &self.weights, &(huber * factor));
    }
}
