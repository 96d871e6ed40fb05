//! Result of the command `solve`, formatted as JSON or text, and the magnitudes of its parts by kind: a result below the
//! rounding error of its kind is 0 in the text.

use std::time::Duration;

use nalgebra::Vector2;

use crate::format::{Context, engineering};
use crate::scene::Load;
use crate::section::Section;
use crate::simulation::{Motion, Simulation, Solution, StressResult};
use crate::stress::PlaneTensor;
use crate::study::{Claim, PathSummary, Reference};

/// Result of `solve` with all further information about it.
pub(super) struct SolvedScene<'a> {
    pub simulation: &'a Simulation,
    pub solution: Solution,
    pub stress: StressResult,
    /// Sections of the scene; none if the iteration diverged.
    pub sections: Vec<Section>,
    /// Jumps and buckling on the load path to the result; `None` if unknown.
    pub path: Option<PathSummary>,
    pub reference: Option<Reference>,
    /// Claims of a result at rest.
    pub claims: Vec<Claim>,
    /// Sentences about limitations of the result.
    pub warnings: Vec<String>,
    /// Wall clock time of the whole command.
    pub wall: Duration,
    /// Time of the solve, without certification.
    pub solve: Duration,
    /// Parts of the wall clock time, which sum to it, with their names in JSON.
    pub parts: [(&'static str, Duration); 9],
}

/// Strain that a rotation of 1 rad causes by rounding, relative to the rounding error of a strain of 1.
const ROTATION: f64 = 1e-3;
/// Rounding error of a strain energy relative to that of a strain, whose square it is.
const ENERGY_OF_STRAIN: f64 = 1e-10;

/// Contexts of the results of a scene by their units.
pub(super) struct Contexts([(&'static str, Context); 9]);

impl Contexts {
    /// Computes the contexts of a result.
    pub(super) fn of(solved: &SolvedScene<'_>) -> Self {
        let SolvedScene { simulation, solution, stress, sections, .. } = solved;
        let (scene, (low, high)) = (simulation.scene(), simulation.mesh().bounds());
        let size = (high - low).norm();
        let deformation = &solution.deformation;
        let (strain, rotation) = (deformation.max_strain, deformation.max_rotation_deg.to_radians());
        let of_strain = strain.max(ROTATION * rotation);
        let components = |tensor: &PlaneTensor| tensor.components();
        let stresses = stress.probes.iter().filter_map(|probe| probe.cauchy.as_ref()).flat_map(components);
        let largest = stress.largest.map_or(0.0, |(_, von_mises)| von_mises);
        let displacements = solution.probes.iter().map(|probe| probe.u.norm());
        let prescribed = scene.supports.iter().flat_map(|support| support.displacement);
        let total = std::iter::once((solution.reaction.force.norm(), solution.reaction.moment));
        let reactions = solution.supports.iter().map(|support| (support.force.norm(), support.moment));
        let cuts = sections.iter().map(|section| (section.force.norm(), section.forces.moment));
        let loads = scene.loads.iter().flat_map(|load| match load {
            Load::Force { force, .. } => force.map(|force| (force, 0.0)),
            Load::Moment { moment, .. } => [(0.0, *moment); 2],
            Load::Gravity { .. } => [(0.0, 0.0); 2],
        });
        let wrenches: Vec<(f64, f64)> = total.chain(reactions).chain(cuts).chain(loads).collect();
        // Forces and moments of one size differ by a lever arm of the body's size.
        let forces = wrenches.iter().flat_map(|(force, moment)| [*force, moment / size]);
        let moments = wrenches.iter().flat_map(|(force, moment)| [force * size, *moment]);
        // Forces balance to the tolerance of the solver.
        let inexact = scene.solver.tolerance.max(solution.residual).min(Context::MAX_INEXACT);
        let energy = &solution.energy;
        let mut energies = vec![energy.elastic, energy.external, energy.supports.unwrap_or_default()];
        if let Some(ledger) = simulation.motion().map(Motion::ledger) {
            energies.extend([ledger.kinetic, ledger.dissipated, ledger.pulses, ledger.put_in, ledger.potential]);
        }
        // The energy of a body that only rotates is that of the rounding errors of its strains.
        let volume = (high.x - low.x) * (high.y - low.y) * scene.material.thickness;
        energies.push(scene.material.young * volume * (ROTATION * rotation).powi(2) * ENERGY_OF_STRAIN);
        let momentum = simulation.motion().map(Motion::momentum).unwrap_or_default();
        let (linear, angular) = (momentum.linear.norm(), momentum.angular);
        Self([
            ("", Context::of([of_strain])),
            ("°", Context::of([rotation.max(strain).to_degrees()])),
            ("Pa", Context::of(stresses.chain([largest, ROTATION * rotation * scene.material.young]))),
            ("m", Context::of(displacements.chain(prescribed).chain([size * strain.max(rotation)]))),
            ("N", Context::of_inexact(forces, inexact)),
            ("N m", Context::of_inexact(moments, inexact)),
            ("J", Context::of(energies)),
            ("kg m/s", Context::of([linear, angular / size])),
            ("kg m²/s", Context::of([angular, linear * size])),
        ])
    }

    /// Returns the context of the results with this unit; that of strains is empty.
    pub(super) fn get(&self, unit: &str) -> Context {
        self.0.iter().find(|(own, _)| *own == unit).map(|(_, context)| *context).unwrap_or_default()
    }

    /// Formats a result.
    pub(super) fn engineering(&self, value: f64, unit: &str) -> String {
        self.get(unit).engineering(value, unit)
    }

    /// Formats the components of a vector.
    pub(super) fn pair(&self, vector: Vector2<f64>, unit: &str) -> String {
        self.get(unit).pair(vector.into(), unit)
    }

    /// Formats a strain in percent.
    pub(super) fn percent(&self, strain: f64) -> String {
        engineering(100.0 * self.get("").rounded(strain), "%")
    }
}
