//! TR-BDF2: a trapezoidal stage to γ h, then a second-order backward difference; γ = 2 − √2.
//!
//! Bank, Coughran, Fichtner, Grosse, Rose and Smith 1985, *Transient simulation of silicon devices and circuits*; Hosea
//! and Shampine 1996, *Analysis and implementation of TR-BDF2*. L-stable: modes that the step cannot resolve are
//! damped, others hardly. Both stages have the same matrix up to the state at which it is evaluated.

use super::IntegratorEntry;
use super::stage::{Stage, Step};
use super::step::{StepEnergy, StepError, combine};
use crate::scene::IntegratorKind;
use std::f64::consts::SQRT_2;

pub(super) static ENTRY: IntegratorEntry = IntegratorEntry {
    kind: IntegratorKind::TrBdf2,
    id: "tr-bdf2",
    about: "TR-BDF2: second order, damps only what the step cannot resolve; one solve for each of its two stages is \
            enough.",
    order: 2,
    stages: 2,
    always_iterates: false,
    colors: [[85, 110, 0], [190, 225, 80]],
    step,
};

/// End of the trapezoidal stage, as a fraction of the step.
const GAMMA: f64 = 2.0 - SQRT_2;

fn step(step: &mut Step<'_>) -> Result<StepEnergy, StepError> {
    let Step { solver, h, start, state, middle, records_energy } = step;
    let h = *h;
    let spring_at_start = solver.mouse_spring_force(start);
    let mut energies = StepEnergy::default();

    // Trapezoidal stage: x_g = x₀ + γh (v₀ + v_g)/2, M (v_g − v₀) = γh (f₀ + f_g)/2 − γh f_d.
    let g = GAMMA * h;
    if !start.knows_net_force {
        solver.measure_net_force(start, state);
    }
    solver.problem.set_stage(start.time + g, &|pulse| pulse.mean(start.time, start.time + g));
    combine(&mut solver.memory.free_flight, [(1.0, &start.displacement), (g, &start.velocity)]);
    state.displacement.overwrite().copy_from_slice(&solver.memory.free_flight);
    solver.update_rotations(state);
    // `state.net_force` is overwritten at the end of the step.
    let mut net_force = std::mem::take(&mut state.net_force);
    solver.add_mouse_spring_force(spring_at_start, &mut net_force);
    // Half of the pulses acts at the start of the step, half at the end of the stage, both with their mean.
    solver.add_pulse_force(start, 1.0, &mut net_force);
    let trapezoid = Stage {
        start,
        inertia: 4.0 / (g * g),
        from_start: false,
        start_force: Some(&net_force),
        between: false,
        tangent: solver.solves.tangent(),
        rate: 1.0 / g,
        others: &[(-1.0 / g, &start.displacement)],
        damps_at_midpoint: true,
        damping: 2.0,
    };
    let solved = solver.solve(&trapezoid, state);
    let recorded = solved.is_ok() && *records_energy;
    combine(
        &mut state.velocity,
        [(2.0 / g, &state.displacement), (-2.0 / g, &start.displacement), (-1.0, &start.velocity)],
    );
    state.time = start.time + g;
    if recorded {
        let stage = solver.record(&trapezoid, [start, state], (spring_at_start * 0.5, 0.5));
        // The damping force of the stage is twice that of the step, because it acts over half of the stage's time.
        energies = StepEnergy { dissipated: 0.5 * stage.dissipated, lost: None, ..stage };
    }
    let spring_at_end = solver.applied_mouse_spring_force(&trapezoid, state);
    state.net_force = net_force;
    solved?;
    middle.copy_from(state);

    // Backward difference: v₁ = (x₁ − c₁x_g + c₀x₀)/w, M (v₁ − c₁v_g + c₀v₀)/w = f₁ − f_d.
    let w = h * (1.0 - GAMMA) / (2.0 - GAMMA);
    let c1 = 1.0 / (GAMMA * (2.0 - GAMMA));
    let c0 = (1.0 - GAMMA).powi(2) * c1;
    // M (v₁ − v₀) = c₁ M (v_g − v₀) + w f₁ is the impulse of the whole step.
    let (t, end) = (start.time, start.time + h);
    solver.problem.set_stage(end, &|pulse| (pulse.impulse(t, end) - c1 * pulse.impulse(t, t + g)) / w);
    combine(
        &mut solver.memory.free_flight,
        [
            (c1, &middle.displacement),
            (-c0, &start.displacement),
            (w * c1, &middle.velocity),
            (-w * c0, &start.velocity),
        ],
    );
    combine(state.displacement.overwrite(), [(1.0, &middle.displacement), (h - g, &middle.velocity)]);
    solver.update_rotations(state);
    let backward = Stage {
        start,
        inertia: 1.0 / (w * w),
        from_start: false,
        start_force: None,
        between: false,
        tangent: solver.solves.tangent(),
        rate: 1.0 / w,
        others: &[(-c1 / w, &middle.displacement), (c0 / w, &start.displacement)],
        damps_at_midpoint: false,
        damping: 1.0,
    };
    solver.solve(&backward, state)?;
    combine(
        &mut state.velocity,
        [(1.0 / w, &state.displacement), (-c1 / w, &middle.displacement), (c0 / w, &start.displacement)],
    );
    state.time = start.time + h;
    solver.keep_net_force(&backward, state);
    if *records_energy {
        // M (v₁ − v_g) = c₀ M (v_g − v₀) + w f₁ is the impulse of this stage.
        let earlier = (spring_at_start + spring_at_end) * (0.5 * g * c0 / (h - g));
        let stage = solver.record(&backward, [middle, state], (earlier, w / (h - g)));
        energies.dissipated += stage.dissipated;
        energies.pulses += stage.pulses;
        energies.mouse_spring += stage.mouse_spring;
    }
    Ok(energies)
}
