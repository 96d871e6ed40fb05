//! The numbers of a state, as the command line prints them.

use nalgebra::{Matrix2, Vector2};

use super::field::largest_principal;
use super::{Certificate, Simulation, Status};
use crate::method::{Profile, Thrift};
use crate::rotation::polar;
use crate::truth::{Truth, error_percent};

/// A probe's result.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeResult {
    /// Its name.
    pub name: String,
    /// Current position, m.
    pub x: Vector2<f64>,
    /// Displacement, m.
    pub u: Vector2<f64>,
    /// The true displacement, m, where the scene has one and the probe is the right edge.
    pub truth: Option<Vector2<f64>>,
}

impl ProbeResult {
    /// The distance from the truth over the length of the true displacement, percent.
    #[must_use]
    pub fn error_percent(&self) -> Option<f64> {
        error_percent(self.u, self.truth?)
    }
}

/// Energies, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Stored in the body.
    pub elastic: f64,
    /// Work of the loads, from rest.
    pub external: f64,
}

/// What the supports do to the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction {
    /// Total force, N.
    pub force: Vector2<f64>,
    /// Total moment about the origin, with current lever arms, N m, counter-clockwise.
    pub moment: f64,
}

/// The numbers of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Free unknowns.
    pub dofs: usize,
    /// How the iteration ended.
    pub status: Status,
    /// Solves taken.
    pub iterations: u32,
    /// Load steps taken.
    pub load_steps: u32,
    /// ‖f_ext − f_int‖ / ‖Σ|fₑ|‖.
    pub residual: f64,
    /// Stability, and ρ.
    pub certificate: Certificate,
    /// Largest magnitude of the polar rotation, degrees.
    pub max_rotation_deg: f64,
    /// Largest magnitude of a principal strain.
    pub max_strain: f64,
    /// Elements with det F ≤ 0 somewhere.
    pub inverted_elements: usize,
    /// The probes.
    pub probes: Vec<ProbeResult>,
    /// Energies.
    pub energy: Energy,
    /// Support reactions.
    pub reaction: Reaction,
    /// Time since the start, by stage.
    pub time: Profile,
    /// What `auto` left out; `None` for other methods.
    pub thrift: Option<Thrift>,
}

impl Simulation {
    /// The numbers of the current state, beside the truth of its scene, if it has one.
    #[must_use]
    pub fn solution(&self, truth: Option<&Truth>) -> Solution {
        let system = &self.system;
        let mut max_rotation: f64 = 0.0;
        let mut max_strain: f64 = 0.0;
        let mut inverted = 0;
        let mut last_inverted = None;
        system.elements.visit_strains(&self.u, &self.r, &mut |q, h, strain| {
            let f = Matrix2::identity() + h;
            let element = q / system.elements.points_per_element();
            if f.determinant() <= 0.0 && last_inverted != Some(element) {
                last_inverted = Some(element);
                inverted += 1;
            }
            max_rotation = max_rotation.max(polar(&f).map_or(0.0, |r| r.angle().abs()));
            max_strain = max_strain.max(largest_principal(strain));
        });
        let truth = truth.and_then(|t| t.tip_displacement());
        let probes = system.probes.iter().map(|probe| {
            let u = probe.mean(&self.u);
            let truth = truth.filter(|_| probe.is_at_tip());
            ProbeResult { name: probe.name.clone(), x: probe.mean(&system.mesh.nodes) + u, u, truth }
        });
        Solution {
            dofs: system.dofs(),
            status: self.status.clone(),
            iterations: self.iterations,
            load_steps: self.method.load_steps(),
            residual: self.residual,
            certificate: self.certificate(),
            max_rotation_deg: max_rotation.to_degrees(),
            max_strain,
            inverted_elements: inverted,
            probes: probes.collect(),
            energy: Energy {
                elastic: system.elements.energy(system.lame, &self.u, &self.r),
                external: -system.load_potential(&self.u, self.method.load_factor()),
            },
            reaction: self.reaction(),
            time: self.profile,
            thrift: self.thrift(),
        }
    }

    /// f_int − f_ext on the held unknowns.
    fn reaction(&self) -> Reaction {
        let mut total = Reaction::default();
        for (node, imbalance) in self.imbalance.iter().enumerate() {
            let on = |axis: usize| {
                if self.system.pattern.is_held(2 * node + axis) { -imbalance[axis] } else { 0.0 }
            };
            let force = Vector2::new(on(0), on(1));
            total.force += force;
            total.moment += (self.system.mesh.nodes[node] + self.u[node]).perp(&force);
        }
        total
    }
}
