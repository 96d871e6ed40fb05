//! The numbers of a state.

use nalgebra::{Matrix2, Vector2};

use super::field::largest_principal;
use crate::assembly::{Forces, Kinematics, Problem};
use crate::rotation::polar;
use crate::scene::Place;
use crate::state::State;
use crate::stress::{ErrorEstimate, NodalStress, PlaneTensor, Singularity};

/// What a probe sees.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProbeResult {
    /// Its name.
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
    /// Stored in the body.
    pub elastic: f64,
    /// Work of the loads at their present size, from rest.
    pub external: f64,
    /// Work of the supports that move, the integral of their reactions along the load path from rest: 0 where none moves. In
    /// linear theory half of the final reactions times the displacements; else `None`, as it takes the path, which
    /// [`crate::study::LoadPath`] follows.
    pub supports: Option<f64>,
}

/// What the supports do to the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction {
    /// Total force, N.
    pub force: Vector2<f64>,
    /// Total moment about the origin, with current lever arms, N m, counter-clockwise.
    pub moment: f64,
}

/// What one support does to the body.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SupportReaction {
    /// Where it is.
    pub place: Place,
    /// Where its middle is now, m.
    pub middle: Vector2<f64>,
    /// Its force, N.
    pub force: Vector2<f64>,
    /// Its moment about its middle, N m, counter-clockwise: of linear theory at rest, else where it is now.
    pub moment: f64,
}

/// How far a state is deformed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Deformation {
    /// Largest magnitude of the polar rotation, degrees.
    pub max_rotation_deg: f64,
    /// Largest magnitude of a principal strain.
    pub max_strain: f64,
    /// Elements with det F ≤ 0 somewhere.
    pub inverted_elements: usize,
}

impl Deformation {
    /// Of a state.
    #[must_use]
    pub fn of(problem: &Problem, state: &State) -> Self {
        let elements = problem.system().elements();
        let mut result = Self::default();
        let mut last_inverted = None;
        let lame = problem.material().lame();
        elements.visit_strains(lame, &state.displacement, &state.rotations, &mut |q, h, strain| {
            let f = Matrix2::identity() + h;
            let element = q / elements.points_per_element();
            if f.determinant() <= 0.0 && last_inverted != Some(element) {
                last_inverted = Some(element);
                result.inverted_elements += 1;
            }
            let angle = polar(&f).map_or(0.0, |r| r.angle().abs());
            result.max_rotation_deg = result.max_rotation_deg.max(angle.to_degrees());
            result.max_strain = result.max_strain.max(largest_principal(strain));
        });
        result
    }
}

/// What every probe of a problem sees of a state.
#[must_use]
pub fn probe_results(problem: &Problem, state: &State) -> Vec<ProbeResult> {
    let mesh = problem.system().mesh();
    let see = problem.probes().iter().map(|probe| {
        let u = probe.mean(&state.displacement);
        ProbeResult { name: probe.name.clone(), x: probe.mean(mesh.nodes()) + u, u }
    });
    see.collect()
}

/// Energies of a state at a load factor.
#[must_use]
pub fn energy(problem: &Problem, state: &State, load_factor: f64) -> Energy {
    let external = -problem.loads().potential(state, load_factor);
    Energy { elastic: problem.elastic_energy(state), external, supports: None }
}

/// f_int − f_ext on the fixed unknowns.
#[must_use]
pub fn reaction(problem: &Problem, state: &State, forces: &Forces) -> Reaction {
    let mut total = Reaction::default();
    let (mesh, mask) = (problem.system().mesh(), problem.system().pattern().mask());
    let nodes = mesh.nodes().iter().zip(&state.displacement).zip(mask.iter().zip(forces.residual()));
    for ((x, u), (mask, residual)) in nodes {
        let force = -residual.zip_map(mask, |f, free| if free > 0.0 { 0.0 } else { f });
        total.force += force;
        total.moment += (x + u).perp(&force);
    }
    total
}

/// What each support does to the body: f_int − f_ext on the unknowns it fixes. An unknown that several fix is the first
/// one's.
#[must_use]
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
    let react = problem.supports().all().iter().map(|support| {
        let middle: Vector2<f64> = support.weights.iter().map(|&(node, weight)| place(node) * weight).sum();
        let (mut force, mut moment) = (Vector2::zeros(), 0.0);
        for &(node, own) in &support.nodes {
            let own = Vector2::from(own.map(|own| if own { 1.0 } else { 0.0 }));
            let nodal = -forces.residual()[node as usize].component_mul(&own);
            force += nodal;
            moment += (place(node) - middle).perp(&nodal);
        }
        let moved: Vector2<f64> =
            support.weights.iter().map(|&(n, weight)| state.displacement[n as usize] * weight).sum();
        SupportReaction { place: support.place.clone(), middle: support.middle + moved, force, moment }
    });
    react.collect()
}

/// Work of the reactions of supports that move, J, for a unit of the load factor: what they do at their present size times the
/// whole displacement and rotation of each.
#[must_use]
pub fn supports_power(problem: &Problem, reactions: &[SupportReaction]) -> f64 {
    let pairs = problem.supports().all().iter().zip(reactions);
    pairs.map(|(s, r)| r.force.dot(&s.displacement) + r.moment * s.turn).sum()
}

/// The largest von Mises stress of the recovered Cauchy stresses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LargestStress {
    /// Pa.
    pub von_mises: f64,
    /// The node that has it, by its number in the mesh; [`crate::Mesh::node_name`] says what people call it.
    pub node: u32,
    /// That node's rest position, m.
    pub at: Vector2<f64>,
}

/// What is at a probe: of the mean of what has been recovered at its nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProbeStress {
    /// The angle of R, degrees, within half a turn.
    pub rotation_deg: f64,
    /// The Biot strain ε, in the frame turned back.
    pub strain: PlaneTensor,
    /// The Cauchy stress, Pa; `None` where there is none.
    pub cauchy: Option<PlaneTensor>,
}

/// Stress where people look for it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StressResult {
    /// The largest von Mises (Cauchy) stress; `None` where no node has one.
    pub largest: Option<LargestStress>,
    /// Why that stress depends on the mesh; `None` where it does not.
    pub singularity: Option<Singularity>,
    /// At every probe.
    pub probes: Vec<ProbeStress>,
    /// The estimate of the mesh's own error in the energy norm, percent; see [`ErrorEstimate`].
    pub mesh_error_percent: Option<f64>,
}

impl StressResult {
    /// Of what has been recovered of a state.
    #[must_use]
    pub fn of(problem: &Problem, nodal: &NodalStress, error: &ErrorEstimate) -> Self {
        let (mesh, material) = (problem.system().mesh(), nodal.material());
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
            singularity: largest.and_then(|(node, _)| Singularity::at(problem, node)),
            largest: largest.map(|(node, von_mises)| LargestStress {
                von_mises,
                node,
                at: mesh.nodes()[node as usize],
            }),
            probes: probes.collect(),
            mesh_error_percent: error.percent,
        }
    }
}
