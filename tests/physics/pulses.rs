//! Tests of loads in time: a pulse has its impulse and a motion its duration, for every time step and integrator.

use crate::common::motion::{beam, momentum};
use crate::common::*;

const STEP: f64 = 1.0 / 60.0;

/// Returns a free, soft beam under a pulse. Explicit steps are short enough to be stable.
fn pushed(kind: IntegratorKind, method: MethodKind, iterations: u32, load: Load, pulse: Pulse) -> Scene {
    let mut scene = Scene::beam(1.0, 0.2).with_cells(5, 1).with_method(method).moving(kind, STEP);
    (scene.material.young, scene.dynamics.iterations) = (1e3, iterations);
    scene.loads = vec![load];
    match &mut scene.loads[0] {
        Load::Force { pulse: own, .. } | Load::Gravity { pulse: own, .. } | Load::Moment { pulse: own, .. } => {
            *own = Some(pulse);
        }
        _ => {}
    }
    scene.dynamics.duration = pulse.start + pulse.duration + 3.0 * STEP;
    scene
}

/// A pulse sin²(π t/d) of size F has the impulse F d/2, and gives a free body this momentum, to rounding.
#[test]
fn a_pulse_leaves_its_impulse_whatever_the_step() {
    let mut random = Random(18);
    let force = Vector2::new(0.4, -1.0);
    for integrator in IntegratorKind::all().map(IntegratorKind::entry) {
        for method in [MethodKind::Newton, MethodKind::Linear, MethodKind::Auto, MethodKind::Warped] {
            let steps = [0.01, 0.3, 0.6, 1.0, 1.7, 2.5, 6.3];
            for (steps, iterations) in steps.into_iter().flat_map(|steps| [(steps, 1), (steps, 0)]) {
                let pulse = Pulse { start: random.between(0.0, 2.0) * STEP, duration: steps * STEP };
                for load in [Load::force("right", force), Load::gravity(force / 200.0)] {
                    let scene = pushed(integrator.kind, method, iterations, load, pulse);
                    let simulation = run(&scene);
                    let (found, expected) = (momentum(&simulation).linear, force * (0.5 * pulse.duration));
                    // `auto` solves to a fraction of its allowed error.
                    let rounding = if method == MethodKind::Auto { 1e-6 } else { 1e-10 };
                    let words = format!("{} {} {steps} {iterations}", integrator.id, method.id());
                    assert!((found - expected).norm() < rounding * expected.norm(), "{words}: {found} {expected}");
                }
            }
        }
    }
    // A moment leaves exactly M d/2 under the energy–momentum method.
    for steps in [0.2, 1.3, 4.0] {
        let pulse = Pulse { start: 0.7 * STEP, duration: steps * STEP };
        let load = Load::moment("right", 0.05);
        let mut scene = pushed(IntegratorKind::EnergyMomentum, MethodKind::Newton, 0, load, pulse);
        scene.solver.tolerance = 1e-13;
        let simulation = run(&scene);
        let (found, expected) = (momentum(&simulation).angular, 0.05 * 0.5 * pulse.duration);
        assert!((found - expected).abs() < 1e-7 * expected, "{steps}: {found} {expected}");
    }
}

/// The ledger balances: a rigid push gives the body ½ p²/m, and all entries of the ledger sum to the total energy.
#[test]
fn the_ledger_has_the_work_of_pulses() {
    // Under explicit integrators, forces on lumped masses differ from the weight, and the body would vibrate.
    for integrator in IntegratorKind::all().map(IntegratorKind::entry).filter(|integrator| !integrator.is_explicit()) {
        for steps in [0.3, 1.0, 2.5] {
            let pulse = Pulse { start: 0.4 * STEP, duration: steps * STEP };
            let mut scene = pushed(integrator.kind, MethodKind::Newton, 0, Load::gravity([1.0, -2.0]), pulse);
            scene.dynamics.damping = Damping::default();
            let simulation = ended(&scene);
            let ledger = *simulation.motion().unwrap().ledger();
            let kinetic = 0.5 * 200.0 * 5.0 * (0.5 * pulse.duration).powi(2);
            let words = format!("{} {steps}: {ledger:?}", integrator.id);
            assert!((ledger.kinetic - kinetic).abs() < 1e-9 * kinetic, "{words}, {kinetic} J");
            assert!(ledger.imbalance().abs() < 1e-10 * ledger.throughput, "{words}");
            // Under a force that is constant over each step, the work is the energy except for
            // the integrator's dissipation.
            assert!((ledger.pulses - ledger.integrator - kinetic).abs() < 1e-9 * kinetic, "{words}, {kinetic} J");
        }
    }
}

/// Second-order integrators keep their order under pulses that the step resolves.
#[test]
fn resolved_pulses_are_followed_in_second_order() {
    for kind in [IntegratorKind::TrBdf2, IntegratorKind::EnergyMomentum] {
        let loads: [fn(Scene) -> Scene; 2] =
            [|scene| scene.force("right", [0.0, -30.0]), |scene| scene.moment("right", 20.0)];
        for (i, load) in loads.into_iter().enumerate() {
            let tip = |step: f64| {
                let mut scene = load(beam(5, 10.0)).with_element(ElementKind::T6).pulse(0.013, 0.4).moving(kind, step);
                (scene.dynamics.duration, scene.dynamics.iterations) = (0.5, 0);
                ended(&scene).probe("tip").unwrap()
            };
            let fine = tip(0.000_5);
            let errors = [0.01, 0.005].map(|step| (tip(step) - fine).norm());
            assert!((3.0..6.5).contains(&(errors[0] / errors[1])), "{} {i}: {errors:?}", kind.id());
        }
    }
}

#[test]
fn a_motion_ends_at_its_duration() {
    for (step, duration) in
        [("7", "10"), ("0.016666666666666666", "0.11"), ("0.02", "0.1"), ("0.3", "0.1"), ("0.1", "0.3")]
    {
        for integrator in ["tr-bdf2", "energy-momentum", "implicit-euler"] {
            let dynamics = format!("time_step={step},duration={duration},integrator=\"{integrator}\"");
            let set = format!("dynamics={{{dynamics}}}");
            let args = ["--set", &*set];
            // Steps of 7 s gain energy, which the exit code tells.
            let json = parsed(&warpbeam(&[&["solve", "--json", "swing"][..], &args].concat()));
            let duration: f64 = duration.parse().unwrap();
            assert_eq!(json["time"].as_f64(), Some(duration), "{set:?}");
            let steps = (duration / step.parse::<f64>().unwrap() - 1e-6).ceil();
            assert_eq!(json["steps"].as_f64(), Some(steps), "{set:?}");
        }
    }
    // A motion that continues after its end takes whole steps again.
    let mut simulation = ended(&scene_with("swing", &["dynamics.duration=0.11"]));
    simulation.step();
    assert!((simulation.state().time() - 0.11 - STEP).abs() < 1e-12 && *simulation.status() == Status::Finished);
}
