//! Tests that every integrator must pass.

use crate::common::motion::{beam, grab, vibrating, with};
use crate::common::*;
use crate::{Test, has_own_colors, suite};
use libtest_mimic::Trial;

const TESTS: &[Test<IntegratorKind>] = tests! {
    the_error_has_the_stated_order_in_the_step a_free_body_falls the_ledger_closes
    damping_removes_the_energy_of_rayleighs_formula linear_theory_is_the_limit_of_small_loads
    motion_is_reproduced_to_the_last_bit its_colour_is_its_own
};

pub fn trials() -> Vec<Trial> {
    suite("integrator", IntegratorKind::all().map(|kind| (kind.id().to_owned(), kind)), TESTS)
}

fn its_colour_is_its_own(kind: IntegratorKind) {
    has_own_colors(kind.entry().colors);
}

/// Returns a step that suits the integrator; for explicit ones, a step far below the critical one.
fn step(kind: IntegratorKind, implicit: f64) -> f64 {
    if kind.entry().is_explicit() { 2e-4 } else { implicit }
}

/// For three steps, each half of the one before, the differences of the results fall by 2 to the integrator's order.
fn the_error_has_the_stated_order_in_the_step(kind: IntegratorKind) {
    // The explicit integrator is stable only at steps this much smaller.
    let (coarse, steps): (f64, u32) =
        if kind.entry().is_explicit() { (1.0 / 7680.0, 3840) } else { (1.0 / 480.0, 240) };
    let tip = |halvings: u32| {
        let mut scene = beam(8, 10.0).moving(kind, coarse * 0.5_f64.powi(halvings as i32));
        scene.dynamics.iterations = 0;
        scene.solver.tolerance = 1e-12;
        let (mut simulation, _) = vibrating(&scene);
        // The amplitude is so small that only the first mode moves: modes along the beam grow with its square.
        let mode: Vec<_> = simulation.displacement().iter().map(|u| u * 1e-6).collect();
        simulation.start_from(&mode).unwrap();
        (0..steps << halvings).for_each(|_| _ = simulation.step());
        // Position of the tip in its swing: displacement, and velocity over the angular frequency.
        Vector2::new(simulation.probe("tip").unwrap().y, simulation.probe_velocity("tip").unwrap().y / 3.2)
    };
    let [a, b, c] = [0, 1, 2].map(tip);
    let order = ((a - b).norm() / (b - c).norm()).log2();
    let expected = if kind.entry().order == 1 { 0.9..1.1 } else { 1.8..2.2 };
    assert!(expected.contains(&order), "{order}: {a} {b} {c}");
}

/// A free body falls as Galileo's law says: second-order integrators are exact, Euler's is off by g h t/2.
fn a_free_body_falls(kind: IntegratorKind) {
    let h = step(kind, 0.01);
    let mut scene = with("spin", kind, h, 1, 1.0).gravity([0.0, -9.81]);
    (scene.start.spin, scene.start.velocity) = (0.0, [0.5, 3.0]);
    let simulation = run(&scene);
    let late = if kind.entry().order == 1 { 0.5 * 9.81 * h } else { 0.0 };
    // The explicit integrator's lumped masses differ from the consistent nodal weights, which excites small vibrations.
    let close = if kind.entry().is_explicit() { 1e-4 } else { 1e-9 };
    let expected = Vector2::new(0.5, 3.0 - 0.5 * 9.81 - late);
    let fallen = simulation.probe("end").unwrap();
    assert!((fallen - expected).norm() < close, "{fallen} {expected}");
    let v = simulation.probe_velocity("end").unwrap();
    assert!((v - Vector2::new(0.5, 3.0 - 9.81)).norm() < 100.0 * close, "{v}");
}

/// The ledger has all entries at once: weight, pulses, damping, a mouse spring that is released, and an edit.
fn the_ledger_closes(kind: IntegratorKind) {
    let h = step(kind, 1.0 / 120.0);
    let scene = with("swing", kind, h, 1, 1.0).force("right", [0.0, 30.0]).pulse(0.1, 0.3);
    let mut scene = scene.moment("right", 5.0).moment("right", 20.0).pulse(0.0, 0.2);
    scene.dynamics.damping.mass = 0.3;
    scene.dynamics.damping.stiffness = if kind.entry().is_explicit() { 1e-5 } else { 1e-3 };
    scene.solver.tolerance = 1e-10;
    let mut simulation = Simulation::new(&scene).unwrap();
    let steps = (1.0 / h).round() as u32;
    for step in 0..steps {
        if step == steps / 4 {
            grab(&mut simulation, Vector2::new(0.9, 0.01));
        }
        if (steps / 4..steps / 2).contains(&step) {
            let t = f64::from(step) * h;
            simulation.pull_to(Vector2::new(0.8 + 0.2 * (9.0 * t).sin(), -0.3 + 0.3 * (7.0 * t).cos())).unwrap();
        }
        if step == steps / 2 {
            simulation.release();
            simulation.change_scene(&simulation.scene().clone().with_material(Material::new(1.5e6, 0.35))).unwrap();
        }
        simulation.step();
    }
    assert_eq!(*simulation.status(), Status::Finished);
    let ledger = *simulation.motion().unwrap().ledger();
    assert!(ledger.imbalance().abs() < 1e-11 * ledger.throughput, "{ledger:?}");
    for (what, recorded) in [
        ("dissipated", ledger.dissipated),
        ("pulses", ledger.pulses.abs()),
        ("mouse_spring", ledger.mouse_spring.abs()),
        ("edits", ledger.edits.abs()),
    ] {
        assert!(recorded > 1e-3, "{what} {recorded}");
    }
}

/// Rayleigh damping: after whole periods, a small first mode keeps exp(−(a + b ω²) t) of its energy. The ledger records the
/// loss as damping.
fn damping_removes_the_energy_of_rayleighs_formula(kind: IntegratorKind) {
    let rate: f64 = if kind.entry().is_explicit() { 7680.0 } else { 960.0 };
    let kept = |mass: f64, stiffness: f64| {
        let mut scene = beam(8, 10.0).moving(kind, 1.0 / rate);
        (scene.dynamics.damping.mass, scene.dynamics.damping.stiffness) = (mass, stiffness);
        (scene.dynamics.iterations, scene.dynamics.duration) = (0, 3.0);
        let (mut simulation, omega) = vibrating(&scene);
        let steps = (TAU / omega * rate).round();
        (0..steps as u32).for_each(|_| _ = simulation.step());
        let (ledger, expected) =
            (*simulation.motion().unwrap().ledger(), (-(mass + stiffness * omega * omega) * steps / rate).exp());
        let taken = ledger.start - ledger.total();
        let is_damping = (ledger.dissipated / taken - 1.0).abs() < 0.02;
        // Implicit Euler takes energy, too.
        assert!(is_damping || expected == 1.0 || kind == IntegratorKind::ImplicitEuler, "{mass}: {ledger:?}");
        assert!(ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{ledger:?}");
        ledger.total() / ledger.start / expected
    };
    // The integrator's own dissipation is divided out.
    let undamped = kept(0.0, 0.0);
    for damping in [(0.1, 0.0), (0.0, if kind.entry().is_explicit() { 1e-3 } else { 0.01 })] {
        let off = kept(damping.0, damping.1) / undamped;
        assert!((off - 1.0).abs() < 0.003, "{damping:?}: {off}");
    }
}

/// Under small loads, linear theory gives the same motion as the corotational formulation.
fn linear_theory_is_the_limit_of_small_loads(kind: IntegratorKind) {
    let mut scene = with("swing", kind, step(kind, 1.0 / 60.0), 1, 1.0);
    scene.scale_loads(1e-6);
    let tip = |method| run(&scene.clone().with_method(method)).probe("tip").unwrap();
    let [corotated, linear] = [MethodKind::Newton, MethodKind::Linear].map(tip);
    assert!((corotated - linear).norm() < 1e-4 * linear.norm(), "{corotated} {linear}");
}

/// The motion is the same with or without a ledger, from a snapshot, and after a reset.
fn motion_is_reproduced_to_the_last_bit(kind: IntegratorKind) {
    let scene = if kind.entry().is_explicit() {
        with("swing", kind, 2e-4, 1, 0.1)
    } else {
        with("flick", kind, 1.0 / 120.0, 1, 0.5)
    };
    let (mut a, mut b) = (Simulation::new(&scene).unwrap(), Simulation::new(&scene).unwrap());
    b.keep_ledger(false);
    for _ in 0..40 {
        a.step();
        b.step();
    }
    assert_eq!(a.state(), b.state(), "without a ledger");
    let snapshot = a.state().clone();
    a.solve();
    b.reset();
    b.restore(&snapshot).unwrap();
    b.solve();
    assert_eq!(a.state(), b.state(), "from a snapshot");
    a.reset();
    a.solve();
    assert_eq!(a.state(), b.state(), "from the start again");
}
