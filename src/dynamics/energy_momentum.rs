//! Energy–momentum: M (v₁ − v₀)/h = f̄, (x₁ − x₀)/h = (v₀ + v₁)/2, with f̄ the discrete gradient of the energy.
//!
//! Simo and Tarnow 1992, *The discrete energy–momentum method*; Gonzalez 2000, *Exact energy and momentum conserving
//! algorithms for general models in nonlinear elasticity*. For the corotated energy the discrete gradient has a closed
//! form: [`crate::element::Elements::linearize_between`]. Energy, momentum and angular momentum are conserved up to the
//! residual of the step; the halves of a halved step conserve them too.

use nalgebra::Vector2;

use super::IntegratorEntry;
use super::stage::{Stage, Step};
use super::step::{Solves, StepEnergy, StepError, combine};
use crate::element::Tangent;
use crate::scene::IntegratorKind;

pub(super) static ENTRY: IntegratorEntry = IntegratorEntry {
    kind: IntegratorKind::EnergyMomentum,
    id: "energy-momentum",
    about: "Energy–momentum: second order, conserves energy, momentum and angular momentum; always iterates to the \
            tolerance.",
    order: 2,
    stages: 1,
    always_iterates: true,
    colors: [[185, 20, 110], [255, 150, 205]],
    step,
};

fn step(step: &mut Step<'_>) -> Result<StepEnergy, StepError> {
    let Step { solver, h, start, state, records_energy, .. } = step;
    let h = *h;
    // With a fixed number of solves the remaining residual would add energy, which grows.
    if let Solves::Times(_) = solver.solves {
        solver.solves = Solves::Tolerance(solver.tolerance);
    }
    solver.problem.set_stage(start.time + 0.5 * h, &|pulse| pulse.mean(start.time, start.time + h));
    combine(&mut solver.memory.free_flight, [(1.0, &start.displacement), (h, &start.velocity)]);
    state.displacement.overwrite().copy_from_slice(&solver.memory.free_flight);
    solver.update_rotations(state);
    let stage = Stage {
        start,
        inertia: 2.0 / (h * h),
        from_start: false,
        start_force: None,
        between: true,
        // Half of A + G at the mean rotation approximates the derivative with respect to the end state.
        tangent: Tangent { warped: 0.5, geometric: 0.5, definite: false },
        rate: 1.0 / h,
        others: &[(-1.0 / h, &start.displacement)],
        damps_at_midpoint: true,
        damping: 1.0,
    };
    solver.solve(&stage, state)?;
    combine(
        &mut state.velocity,
        [(2.0 / h, &state.displacement), (-2.0 / h, &start.displacement), (-1.0, &start.velocity)],
    );
    state.time = start.time + h;
    let record = || solver.record(&stage, [start, state], (Vector2::zeros(), 1.0));
    let energies = records_energy.then(record).unwrap_or_default();
    // The target of a mouse spring moves on from its position at the end of the step.
    solver.problem.set_time(state.time);
    Ok(energies)
}
