//! Result types of a state.

use std::collections::BTreeSet;

use nalgebra::{Matrix2, Vector2};

use super::field::largest_principal;
use crate::assembly::{Forces, Kinematics, NodalProbe, Problem, weighted_sum};
use crate::scene::Place;
use crate::section::Wrench;
use crate::state::State;
use crate::stress::{ErrorEstimate, NodalStress, PlaneTensor, Singularity};

/// Result at a probe.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProbeResult {
    /// Name of the probe.
    pub name: String,
    /// Current position, m.
    pub x: Vector2<f64>,
    /// Displacement, m.
    pub u: Vector2<f64>,
}

/// Energies, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// Elastic energy of the body.
    pub elastic: f64,
    /// Work of the loads at their current size, from rest.
    pub external: f64,
    /// Work of supports with prescribed displacements, the integral of their reactions along the load path from rest; 0
    /// if there are none. In linear theory it is half of the final reactions times the displacements; else it is
    /// `None`, because it depends on the path, which the command `warpbeam solve` computes.
    pub supports: Option<f64>,
}

/// Reaction of one support on the body.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SupportReaction {
    /// Place of the support.
    pub place: Place,
    /// Current position of its middle, m.
    pub middle: Vector2<f64>,
    /// Force, N.
    pub force: Vector2<f64>,
    /// Moment about the middle, N m, counter-clockwise; at rest in linear theory, else in the current configuration.
    pub moment: f64,
}

/// Measures of the deformation of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Deformation {
    /// Largest magnitude of the polar rotation that is recovered at a node, as the stresses are, degrees.
    pub max_rotation_deg: f64,
    /// Largest magnitude of a principal strain that is recovered at a node, as the stresses are.
    pub max_strain: f64,
    /// Number of elements with det F ≤ 0 at a point.
    pub inverted_elements: usize,
    /// Change of the body's area relative to its area at rest: ∫ det F dA / ∫ dA − 1.
    pub area_change: f64,
}

impl Deformation {
    /// Computes the measures for a state whose stress has been recovered.
    #[doc(hidden)]
    pub fn of(problem: &Problem, state: &State, nodal: &NodalStress) -> Self {
        let elements = problem.system().elements();
        let strains = nodal.nodes().iter().map(|local| largest_principal(&local.strain));
        let rotations = nodal.nodes().iter().map(|local| local.rotation.angle().abs());
        let (lame, mut inverted) = (problem.material().lame(), BTreeSet::new());
        elements.visit_strains(lame, &state.displacement, &state.rotations, &mut |q, h, _| {
            if (Matrix2::identity() + h).determinant() <= 0.0 {
                inverted.insert(q / elements.points_per_element());
            }
        });
        Self {
            max_strain: strains.fold(0.0, f64::max),
            max_rotation_deg: rotations.fold(0.0, f64::max).to_degrees(),
            inverted_elements: inverted.len(),
            area_change: area_change(problem, state),
        }
    }
}

/// Returns the change of a body's area relative to its area at rest, ∫ det F dA / ∫ dA − 1.
pub fn area_change(problem: &Problem, state: &State) -> f64 {
    let elements = problem.system().elements();
    let (mut rest, mut change) = (0.0, 0.0);
    elements.visit_strains(problem.material().lame(), &state.displacement, &state.rotations, &mut |q, h, _| {
        let area = elements.point_area(q);
        rest += area;
        // det (I + H) − 1, without cancellation.
        change += area * (h.trace() + h.determinant());
    });
    change / rest
}

/// Returns the results of every probe of a problem for a state.
pub fn probe_results(problem: &Problem, state: &State) -> Vec<ProbeResult> {
    let result = |probe: &NodalProbe| {
        let u = probe.mean(&state.displacement);
        ProbeResult { name: probe.name.clone(), x: probe.mean(problem.system().mesh().nodes()) + u, u }
    };
    problem.probes().iter().map(result).collect()
}

/// Returns the reaction of each support on the body: f_int − f_ext on the unknowns it fixes, or the force on its point.
/// An unknown fixed by several supports belongs to the first.
pub fn support_reactions(
    problem: &Problem,
    state: &State,
    kinematics: Kinematics,
    forces: &Forces,
) -> Vec<SupportReaction> {
    let mesh = problem.system().mesh();
    let place = |node: u32| match kinematics {
        Kinematics::Linear => mesh.node(node),
        Kinematics::Corotated => mesh.node(node) + state.displacement[node as usize],
    };
    let supports = problem.supports();
    let residual = supports.with_point_forces(forces.residual());
    let mut points = supports.point_forces(forces.residual());
    let react = supports.all().iter().map(|support| {
        let middle: Vector2<f64> = support.weights.iter().map(|&(node, weight)| place(node) * weight).sum();
        let mut total = Wrench::default();
        for &(node, own) in &support.nodes {
            let own = Vector2::from(own.map(|own| if own { 1.0 } else { 0.0 }));
            total.add(place(node) - middle, -residual[node as usize].component_mul(&own));
        }
        if support.point.is_some() {
            total.force += points.next().map_or_else(Vector2::zeros, |(_, force)| force);
        }
        let Wrench { force, moment } = total;
        let middle = support.middle + weighted_sum(&state.displacement, &support.weights);
        SupportReaction { place: support.place.clone(), middle, force, moment }
    });
    react.collect()
}

/// Strain and stress at a probe, computed from the mean of strain and rotation over its nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProbeStress {
    /// Angle of the polar rotation of F, degrees, from −180 to 180; also in linear theory, whose strains are measured
    /// without it.
    pub rotation_deg: f64,
    /// Biot strain ε, in the rotated frame.
    pub strain: PlaneTensor,
    /// Cauchy stress, Pa; `None` if it is undefined.
    pub cauchy: Option<PlaneTensor>,
}

/// Von Mises stress relative to Young's modulus below which it is the rounding error of a rotation.
const ROUNDING: f64 = 1e-14;

/// Stress results of a state.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StressResult {
    /// Largest von Mises (Cauchy) stress, Pa, after its node; `None` if no node has one.
    pub largest: Option<(u32, f64)>,
    /// Cause of a mesh-dependent largest stress; `None` if the stress is bounded.
    pub singularity: Option<Singularity>,
    /// Stress at every probe.
    pub probes: Vec<ProbeStress>,
    /// Estimate of the mesh's error in the energy norm, percent; see [`ErrorEstimate`].
    pub mesh_error_percent: Option<f64>,
}

impl StressResult {
    /// Computes the results of a state from its recovered stresses.
    pub fn of(problem: &Problem, state: &State, nodal: &NodalStress) -> Self {
        let material = nodal.material();
        let probes = problem.probes().iter().map(|probe| {
            let local = nodal.mean(&probe.weights);
            ProbeStress {
                rotation_deg: local.rotation.angle().to_degrees(),
                strain: local.strain(material),
                cauchy: local.cauchy(material, nodal.kinematics()),
            }
        });
        let largest = nodal.largest_von_mises();
        Self {
            // A stress of 0 does not grow with the mesh.
            singularity: largest
                .filter(|(_, von_mises)| *von_mises > ROUNDING * material.young)
                .and_then(|(node, _)| Singularity::near(problem, node)),
            largest,
            probes: probes.collect(),
            mesh_error_percent: ErrorEstimate::of(problem, state, nodal).percent,
        }
    }
}
