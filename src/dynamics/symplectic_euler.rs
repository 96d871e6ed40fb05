//! Symplectic Euler: v₁ = v₀ + h M⁻¹ f(x₀, v₀), x₁ = x₀ + h v₁, M lumped at the nodes.
//!
//! No equations are solved. Stable below the critical step, which the smallest and stiffest element determines
//! ([`super::critical_step()`]); beyond it the motion explodes.

use nalgebra::Vector2;

use super::IntegratorEntry;
use super::stage::Step;
use super::step::{Memory, StepEnergy, StepError, combine};
use crate::assembly::MouseSpring;
use crate::element::StrainRate;
use crate::scene::IntegratorKind;
use crate::state::{State, is_finite};
use crate::timings::timed;

pub(super) static ENTRY: IntegratorEntry = IntegratorEntry {
    kind: IntegratorKind::SymplecticEuler,
    id: "symplectic-euler",
    about: "Symplectic Euler: explicit, no solve, cheap per step, but unstable beyond its critical time step.",
    order: 1,
    stages: 0,
    always_iterates: false,
    colors: [[115, 75, 50], [200, 165, 135]],
    step,
};

fn step(step: &mut Step<'_>) -> Result<StepEnergy, StepError> {
    let Step { solver, h, start, state, records_energy, .. } = step;
    let h = *h;
    solver.problem.set_stage(start.time, &|pulse| pulse.mean(start.time, start.time + h));
    let lumped = &solver.mass.lumped;
    let pull = |spring: &MouseSpring, State { displacement, velocity, .. }: &State| {
        spring.softened_force(spring.mean(displacement), spring.mean(velocity), lumped, h)
    };
    let problem = &*solver.problem;
    let system = problem.system();
    let Memory { forces, damping, .. } = &mut *solver.memory;
    let spring_at_start = problem.mouse_spring().map_or_else(Vector2::zeros, |spring| pull(spring, start));
    timed(&mut solver.timings.linearize, || {
        problem.linearize(start, forces, None);
        problem.loads().force(system, &start.displacement, solver.kinematics, 1.0, &mut forces.external);
        combine(&mut forces.residual, [(1.0, &forces.external), (-1.0, &forces.internal)]);
        if let Some(spring) = problem.mouse_spring() {
            spring.add_force(spring_at_start, &mut forces.residual);
        }
        for ((d, v), m) in damping.iter_mut().zip(&start.velocity).zip(lumped) {
            *d = v * (solver.damping.mass * m);
        }
        if solver.damping.stiffness > 0.0 {
            let moduli = problem.material().membrane().scaled(solver.damping.stiffness);
            let rate = StrainRate::Velocity(&start.velocity);
            system.elements().viscous_force(moduli, &start.displacement, rate, damping);
        }
    });
    timed(&mut solver.timings.solve, || {
        let nodes = forces.residual.iter().zip(&*damping).zip(lumped);
        for (i, ((f, d), m)) in nodes.enumerate() {
            state.velocity[i] = start.velocity[i] + (f - d) * (h / m);
        }
        system.pattern().stop_fixed_by_impulses(&mut state.velocity, lumped);
        let displacement = state.displacement.overwrite();
        for (i, (u, v)) in start.displacement.iter().zip(&state.velocity).enumerate() {
            displacement[i] = u + v * h;
        }
    });
    if !is_finite(&state.displacement) || !is_finite(&state.velocity) {
        return Err(StepError::NotFinite);
    }
    solver.update_rotations(state);
    state.time = start.time + h;
    if !*records_energy {
        return Ok(StepEnergy::default());
    }
    // The damping force of the start times the velocity there, which never feeds energy; the rest is the integrator's.
    let power: f64 = solver.memory.damping.iter().zip(&start.velocity).map(|(f, v)| f.dot(v)).sum();
    let dissipated = h * power;
    solver.problem.set_time(state.time);
    let mouse_spring = solver.problem.mouse_spring().map_or(0.0, |spring| {
        let moved = spring.mean(&state.displacement) - spring.mean(&start.displacement);
        (spring_at_start + pull(spring, state)).dot(&moved) * 0.5
    });
    let pulses = solver.problem.loads().pulse_work([start, state]);
    Ok(StepEnergy { dissipated, lost: None, pulses, mouse_spring })
}
