//! Implicit Euler: v₁ = (x₁ − x₀)/h, M (v₁ − v₀)/h = f(x₁).
//!
//! By default one solve with A(R₀) from the current state, as in the article and in games. Solved to a tolerance it
//! loses even more energy, mostly from motion that should not be damped: the first mode of a beam at 60 steps per
//! second keeps 72 % of its energy per period.

use nalgebra::Vector2;

use super::IntegratorEntry;
use super::stage::{Stage, Step};
use super::step::{Solves, StepEnergy, StepError, combine, work};
use crate::element::Tangent;
use crate::scene::IntegratorKind;

pub(super) static ENTRY: IntegratorEntry = IntegratorEntry {
    kind: IntegratorKind::ImplicitEuler,
    id: "implicit-euler",
    about: "Implicit Euler, as in the article and in many games: always stable, one solve per step, but it damps the \
            motion.",
    order: 1,
    stages: 1,
    always_iterates: false,
    colors: [[190, 20, 30], [255, 105, 97]],
    step,
};

fn step(step: &mut Step<'_>) -> Result<StepEnergy, StepError> {
    let Step { solver, h, start, state, records_energy, .. } = step;
    let h = *h;
    solver.problem.set_stage(start.time + h, &|pulse| pulse.mean(start.time, start.time + h));
    combine(&mut solver.memory.free_flight, [(1.0, &start.displacement), (h, &start.velocity)]);
    // A single solve loses least energy if it starts at the current state, with the matrix A without G.
    // Several solves need fewer iterations from a predicted state.
    let from_start = solver.solves == Solves::Times(1);
    let tangent = if from_start {
        Tangent::WARPED
    } else {
        state.displacement.overwrite().copy_from_slice(&solver.memory.free_flight);
        solver.update_rotations(state);
        solver.solves.tangent()
    };
    let stage = Stage {
        start,
        inertia: 1.0 / (h * h),
        from_start,
        start_force: None,
        between: false,
        tangent,
        rate: 1.0 / h,
        others: &[(-1.0 / h, &start.displacement)],
        damps_at_midpoint: true,
        damping: 1.0,
    };
    solver.solve(&stage, state)?;
    combine(&mut state.velocity, [(1.0 / h, &state.displacement), (-1.0 / h, &start.displacement)]);
    state.time = start.time + h;
    if !*records_energy {
        return Ok(StepEnergy::default());
    }
    let mut energies = solver.record(&stage, [start, state], (Vector2::zeros(), 1.0));
    // ½ |Δv|² in the norm of M is the energy that the scheme removes from any non-uniform motion.
    let [change, momentum] = &mut solver.memory.scratch;
    combine(change, [(1.0, &state.velocity), (-1.0, &start.velocity)]);
    solver.mass.multiply(change, momentum);
    let jolt = 0.5 * super::step::dot(change, momentum);
    let elastic = solver.problem.elastic_energy(state) - solver.problem.elastic_energy(start);
    let forces = &solver.memory.forces;
    let internal = work(&forces.internal, start, state) - elastic;
    energies.lost = Some(energies.lost.unwrap_or(0.0) + jolt + internal);
    Ok(energies)
}
