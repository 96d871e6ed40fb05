//! Magnitudes of the results of `solve` by kind: a result below the rounding error of its kind is 0 in the text.

use super::solved::SolvedScene;
use crate::format::Context;
use crate::scene::Load;
use crate::simulation::Motion;
use crate::stress::PlaneTensor;

/// Strain that a rotation of 1 rad causes by rounding, relative to the rounding error of a strain of 1.
const ROTATION: f64 = 1e-3;
/// Rounding error of a strain energy relative to that of a strain, whose square it is.
const ENERGY_OF_STRAIN: f64 = 1e-10;

/// Contexts of the results of a scene.
pub(super) struct Contexts {
    /// Strains, pure numbers.
    pub strain: Context,
    /// Angles, degrees.
    pub rotation: Context,
    /// Stresses, Pa.
    pub stress: Context,
    /// Displacements, m.
    pub displacement: Context,
    /// Forces, N.
    pub force: Context,
    /// Moments, N m.
    pub moment: Context,
    /// Energies, J.
    pub energy: Context,
    /// Momentum, kg m/s.
    pub momentum: Context,
    /// Angular momentum, kg m²/s.
    pub angular_momentum: Context,
}

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
        let largest = stress.largest.map_or(0.0, |largest| largest.von_mises);
        let displacements = solution.probes.iter().map(|probe| probe.u.norm());
        let prescribed = scene.supports.iter().flat_map(|support| support.displacement);
        let (mut forces, mut moments) = (vec![solution.reaction.force.norm()], vec![solution.reaction.moment]);
        for support in &solution.supports {
            forces.push(support.force.norm());
            moments.push(support.moment);
        }
        for section in sections {
            forces.push(section.force.norm());
            moments.push(section.forces.moment);
        }
        for load in &scene.loads {
            match load {
                Load::Force { force, .. } => forces.extend(force),
                Load::Moment { moment, .. } => moments.push(*moment),
                Load::Gravity { .. } => {}
            }
        }
        // Forces and moments of one size differ by a lever arm of the body's size.
        let arms = moments.iter().map(|moment| moment / size).collect::<Vec<_>>();
        moments.extend(forces.iter().map(|force| force * size));
        forces.extend(arms);
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
        Self {
            strain: Context::of([of_strain]),
            rotation: Context::of([rotation.max(strain).to_degrees()]),
            stress: Context::of(stresses.chain([largest, ROTATION * rotation * scene.material.young])),
            displacement: Context::of(displacements.chain(prescribed).chain([size * strain.max(rotation)])),
            force: Context::of_inexact(forces, inexact),
            moment: Context::of_inexact(moments, inexact),
            energy: Context::of(energies),
            momentum: Context::of([linear, angular / size]),
            angular_momentum: Context::of([angular, linear * size]),
        }
    }
}
