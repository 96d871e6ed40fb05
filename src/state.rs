//! State of a simulated body at one instant. A clone is a snapshot that can be saved, restored and compared.

use nalgebra::Vector2;
use thiserror::Error;

use crate::displacement::{Compensated, Displacement};
use crate::rotation::Rotation;

/// Positions, rotations and velocities of a body. Slices over nodes are in the mesh's order; rotations are in the order
/// of the elements.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct State {
    /// u = x − X of every node, m.
    pub(crate) displacement: Displacement,
    /// R of every element or quadrature point. Where the polar factor of F is undefined, the previous rotation is kept.
    pub(crate) rotations: Vec<Rotation>,
    /// Rotation of every named edge since rest, rad, full turns included; 0 for edges that are not straight.
    pub(crate) edge_angles: Vec<f64>,
    /// Velocity of every node, m/s; zero in statics.
    pub(crate) velocity: Vec<Vector2<f64>>,
    /// Time since the start, s; zero in statics.
    pub(crate) time: f64,
    /// Force that accelerates every node at the end of the last time step, N, without pulses and mouse spring. Valid
    /// only if [`Self::knows_net_force`].
    pub(crate) net_force: Vec<Vector2<f64>>,
    /// `true` if `net_force` is valid: `false` at the start and after the body has been moved or loaded from outside.
    pub(crate) knows_net_force: bool,
}

/// Error for a state or a nodal vector that does not fit a body.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum StateError {
    /// The number of values differs from the body's.
    #[error("expected {expected} {what}, got {got}")]
    Length {
        /// Name of the counted values.
        what: &'static str,
        /// Number of values that the body has.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
    /// A value that is NaN or infinite.
    #[error("expected finite {what}")]
    NotFinite {
        /// Name of the values.
        what: &'static str,
    },
}

impl State {
    /// Returns a body at rest with these numbers of nodes, rotations and named edges.
    pub(crate) fn at_rest(nodes: usize, rotations: usize, edges: usize) -> Self {
        Self {
            displacement: Displacement::zeros(nodes),
            rotations: vec![Rotation::IDENTITY; rotations],
            edge_angles: vec![0.0; edges],
            velocity: vec![Vector2::zeros(); nodes],
            time: 0.0,
            net_force: vec![Vector2::zeros(); nodes],
            knows_net_force: false,
        }
    }

    /// Returns to the rest position with zero velocity and time.
    pub(crate) fn reset(&mut self) {
        self.displacement.reset();
        self.rotations.fill(Rotation::IDENTITY);
        self.edge_angles.fill(0.0);
        self.stop();
    }

    /// Sets velocity and time to zero.
    pub(crate) fn stop(&mut self) {
        self.velocity.fill(Vector2::zeros());
        self.time = 0.0;
        self.knows_net_force = false;
    }

    /// Copies another state of the same body without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.displacement.copy_from(&other.displacement);
        self.rotations.clone_from(&other.rotations);
        self.edge_angles.clone_from(&other.edge_angles);
        self.velocity.clone_from(&other.velocity);
        self.time = other.time;
        self.net_force.clone_from(&other.net_force);
        self.knows_net_force = other.knows_net_force;
    }

    /// Returns the displacement u = x − X of every node, m.
    pub fn displacement(&self) -> &[Vector2<f64>] {
        &self.displacement
    }

    /// Returns the displacement including the digits that [`Self::displacement`] rounds away, m.
    #[doc(hidden)]
    pub fn compensated(&self) -> Compensated<'_> {
        self.displacement.view()
    }

    /// Returns the rotations R, element by element: one per `t3` and `q4`, one per quadrature point (three) of a `t6`,
    /// element by element.
    pub fn rotations(&self) -> &[Rotation] {
        &self.rotations
    }

    /// Returns the rotation of every named edge of the mesh since rest, rad, counter-clockwise, full turns included, in
    /// the order of their names; 0 for edges that are not straight.
    pub fn edge_angles(&self) -> &[f64] {
        &self.edge_angles
    }

    /// Returns the velocity of every node, m/s.
    pub fn velocity(&self) -> &[Vector2<f64>] {
        &self.velocity
    }

    /// Returns the time since the start, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Returns the memory of the state's arrays, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let vectors = 2 * self.displacement.len() + self.velocity.len() + self.net_force.len();
        size_of::<Vector2<f64>>() * vectors
            + size_of_val(self.rotations.as_slice())
            + size_of_val(self.edge_angles.as_slice())
    }

    /// Returns `true` if every number is finite.
    pub fn is_finite(&self) -> bool {
        is_finite(&self.displacement)
            && is_finite(&self.velocity)
            && self.rotations.iter().all(|r| r.c.is_finite() && r.s.is_finite())
            && self.edge_angles.iter().all(|t| t.is_finite())
            && self.time.is_finite()
            && (!self.knows_net_force || is_finite(&self.net_force))
    }

    /// Returns a copy of the state with displacement `u`, m, and the same rotations.
    ///
    /// # Errors
    /// [`StateError`] if the number of vectors differs from the number of nodes, or one is not finite.
    pub fn with_displacement(&self, u: Vec<Vector2<f64>>) -> Result<Self, StateError> {
        same_length("displacements", self.displacement.len(), u.len())?;
        if !is_finite(&u) {
            return Err(StateError::NotFinite { what: "displacements" });
        }
        Ok(Self { displacement: Displacement::from_rounded(u), knows_net_force: false, ..self.clone() })
    }

    /// Checks that `other` is a finite state of the same body.
    ///
    /// # Errors
    /// [`StateError`].
    pub(crate) fn accept(&self, other: &Self) -> Result<(), StateError> {
        same_length("displacements", self.displacement.len(), other.displacement.len())?;
        same_length("rotations", self.rotations.len(), other.rotations.len())?;
        same_length("turns of edges", self.edge_angles.len(), other.edge_angles.len())?;
        same_length("velocities", self.velocity.len(), other.velocity.len())?;
        same_length("net forces", self.net_force.len(), other.net_force.len())?;
        if other.is_finite() { Ok(()) } else { Err(StateError::NotFinite { what: "numbers in a state" }) }
    }
}

/// Returns `true` if every component is finite.
pub(crate) fn is_finite(nodal: &[Vector2<f64>]) -> bool {
    nodal.iter().all(|v| v.x.is_finite() && v.y.is_finite())
}

/// Checks a count.
pub(crate) fn same_length(what: &'static str, expected: usize, got: usize) -> Result<(), StateError> {
    if expected == got { Ok(()) } else { Err(StateError::Length { what, expected, got }) }
}

/// Returns the largest distance of a node between two nodal fields.
pub(crate) fn largest_distance(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Returns the largest length in a nodal field.
pub(crate) fn largest(nodal: &[Vector2<f64>]) -> f64 {
    nodal.iter().map(|v| v.norm()).fold(0.0, f64::max)
}
