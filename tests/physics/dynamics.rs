//! Compares motions with an independent trajectory, beam theory, conservation laws, and properties of the integrators.

use crate::common::motion::{beam, drift, grab, momentum, vibrating, with};
use crate::common::*;
use warpbeam::Counts;
use warpbeam::assembly::Mass;
use warpbeam::element::{DiscreteGradient, Lame, warped_strain};
use warpbeam::rotation::polar_or;

const EULER: IntegratorKind = IntegratorKind::ImplicitEuler;
const TR_BDF2: IntegratorKind = IntegratorKind::TrBdf2;
const ENERGY_MOMENTUM: IntegratorKind = IntegratorKind::EnergyMomentum;
const IMPLICIT: [IntegratorKind; 3] = [EULER, TR_BDF2, ENERGY_MOMENTUM];
const SYMPLECTIC: IntegratorKind = IntegratorKind::SymplecticEuler;

/// Returns times and tip displacements of the swing at multiples of 1/240 s, computed by `tests/data/swing.py`.
fn swing_truth() -> Vec<(f64, Vector2<f64>)> {
    let text = include_str!("../data/swing.csv");
    let rows = numbers(text.split_once("\ntime,").map_or(text, |(_, table)| table));
    rows.into_iter().map(|v| (v[0], Vector2::new(v[1], v[2]))).collect()
}

/// Returns the largest distance of the swing's tip from the reference in a time, relative to the beam's length, and the work.
fn swing_error(kind: IntegratorKind, rate: usize, duration: f64, method: MethodKind) -> (f64, Counts) {
    let scene = with("swing", kind, 1.0 / rate as f64, 1, duration).with_method(method);
    let mut simulation = Simulation::new(&scene).unwrap();
    let (mut worst, apart) = (0.0_f64, (240 / rate).max(1));
    let is_within = |(time, _): &&(f64, Vector2<f64>)| *time < duration + 1e-9;
    for (time, reference) in swing_truth().iter().skip(apart - 1).step_by(apart).take_while(is_within) {
        (0..(rate / 240).max(1)).for_each(|_| _ = simulation.step());
        assert!((simulation.state().time() - time).abs() < 1e-9);
        worst = worst.max((simulation.probe("tip").unwrap() - reference).norm());
    }
    assert_eq!(*simulation.status(), Status::Finished);
    (worst, simulation.motion().unwrap().counts())
}

/// Implicit Euler with one solve per step, as used in games, has a large error; steps of a reference nearly none.
#[test]
fn a_swing_follows_the_reference_solution() {
    for (kind, bounds) in [(TR_BDF2, [0.025, 0.008, 0.003]), (ENERGY_MOMENTUM, [0.025, 0.009, 0.004])] {
        for (rate, bound) in [60, 120, 240].into_iter().zip(bounds) {
            let (error, _) = swing_error(kind, rate, 2.0, MethodKind::Newton);
            assert!(error <= bound, "{} at 1/{rate}: {error}", kind.id());
        }
    }
    let (error, _) = swing_error(EULER, 60, 2.0, MethodKind::Newton);
    assert!((0.12..0.25).contains(&error), "{error}");
    let size = swing_truth().iter().take(240).map(|(_, u)| u.norm()).fold(0.0, f64::max);
    let (error, _) = swing_error(ENERGY_MOMENTUM, 960, 1.0, MethodKind::Newton);
    assert!(error < 1e-4 * size, "{error} of {size}");
}

/// Old factors of `auto` do not spoil the energy.
#[test]
fn a_swing_and_a_spin_keep_their_energy_as_their_integrator_promises() {
    for method in NEWTON_AND_AUTO {
        let drift = drift(&run(&with("swing", ENERGY_MOMENTUM, 1.0 / 60.0, 0, 10.0).with_method(method)));
        assert!(drift.abs() <= 1e-6, "{method:?}: {drift}");
    }
    for (rate, bound) in [(120.0, 0.05), (240.0, 0.005)] {
        let drift = drift(&run(&with("swing", TR_BDF2, 1.0 / rate, 1, 10.0)));
        assert!(drift <= 0.0 && drift >= -bound, "1/{rate}: {drift}");
    }
    let spin = |kind, iterations, method| {
        let scene = with("spin", kind, 1.0 / 60.0, iterations, 10.0).with_method(method);
        momentum(&ended(&scene)).angular / momentum(&Simulation::new(&scene).unwrap()).angular
    };
    let kept = spin(TR_BDF2, 1, MethodKind::Newton);
    assert!((0.99..=1.001).contains(&kept), "{kept}");
    let kept = spin(ENERGY_MOMENTUM, 0, MethodKind::Auto);
    assert!((kept - 1.0).abs() < 1e-6, "{kept}");
    // Under implicit Euler the points of a rigid body move along chords: dL/dt = −h ω² L, with ω proportional to L.
    let (omega, h, time) = (6.0_f64, 1.0 / 60.0, 10.0);
    let law = (1.0 + 2.0 * h * omega * omega * time).powf(-0.5);
    let kept = spin(EULER, 0, MethodKind::Newton);
    assert!((kept / law - 1.0).abs() < 0.01, "{kept} {law}");
}

/// Energy and momentum are conserved over 10⁴ steps of a free bar, with few iterations, also in linear theory.
#[test]
fn energy_momentum_is_exact_in_few_iterations() {
    let mut scene = with("spin", ENERGY_MOMENTUM, 1.0 / 60.0, 0, 1e4 / 60.0);
    scene.solver.tolerance = 1e-11;
    scene.start.velocity = [0.3, -0.2];
    let mut simulation = Simulation::new(&scene).unwrap();
    let before = momentum(&simulation);
    simulation.solve();
    let (ledger, after) = (*simulation.motion().unwrap().ledger(), momentum(&simulation));
    assert_eq!(simulation.motion().unwrap().counts().steps, 10_000);
    assert!((ledger.total() - ledger.start).abs() < 1e-10 * ledger.start, "{ledger:?}");
    assert!((after.linear - before.linear).norm() < 1e-10 * before.linear.norm(), "{before:?} {after:?}");
    assert!((after.angular - before.angular).abs() < 1e-9 * before.angular, "{before:?} {after:?}");
    // Few iterations are enough.
    for (rate, bound) in [(60.0, 7.5), (120.0, 5.0)] {
        let counts = run(&with("swing", ENERGY_MOMENTUM, 1.0 / rate, 0, 2.0)).motion().unwrap().counts();
        let iterations = counts.solves as f64 / counts.steps as f64;
        assert!(iterations <= bound && counts.halvings == 0, "1/{rate}: {iterations}, {counts:?}");
    }
    // In linear theory one solve per step is exact, and the motion agrees with the other integrators.
    let end = |kind, iterations| {
        let simulation = run(&with("swing", kind, 1.0 / 960.0, iterations, 0.5).with_method(MethodKind::Linear));
        (simulation.probe("tip").unwrap(), simulation.motion().unwrap().counts(), drift(&simulation))
    };
    let ((tip, counts, drift), (other, ..)) = (end(ENERGY_MOMENTUM, 0), end(TR_BDF2, 1));
    assert!((tip - other).norm() < 1e-3 * other.norm() && tip.y < -1.0, "{tip} {other}");
    assert_eq!((counts.solves, counts.halvings), (counts.steps, 0));
    assert!(drift.abs() < 1e-9, "{drift}");
    // The energy decreases by the dissipation of the damping only.
    let mut scene = with("swing", ENERGY_MOMENTUM, 1.0 / 120.0, 0, 2.0).moment("right", 20.0);
    scene.dynamics.damping.stiffness = 2e-3;
    scene.solver.tolerance = 1e-11;
    let ledger = *run(&scene).motion().unwrap().ledger();
    assert!(ledger.dissipated > 0.01 * ledger.largest_kinetic);
    assert!(ledger.integrator.abs() < 1e-9 * ledger.throughput, "{ledger:?}");
}

/// A linear vibration under implicit Euler keeps 1/(1 + ω²h²) of its energy per step.
#[test]
fn implicit_euler_damps_the_first_mode_by_28_percent_a_period() {
    let mut scene = beam(20, 10.0).moving(EULER, 1.0 / 60.0).with_method(MethodKind::Linear);
    scene.dynamics.duration = 1e3;
    let (mut simulation, omega) = vibrating(&scene);
    let before = simulation.motion().unwrap().ledger().total();
    let (periods, period) = (5.0, TAU / omega);
    let steps = (periods * period * 60.0).round();
    (0..steps as u32).for_each(|_| _ = simulation.step());
    let kept = (simulation.motion().unwrap().ledger().total() / before).powf(period * 60.0 / steps);
    assert!((period - 1.96).abs() < 0.01, "{period}");
    assert!((1.0 - kept - 0.284).abs() < 0.005, "{}", 1.0 - kept);
}

/// P : ΔF = Δψ holds and P F̄ᵀ is symmetric, for random and adversarial pairs.
#[test]
fn the_discrete_gradient_is_exact() {
    let lame = Lame { lambda: 0.6, mu: 0.4 };
    let mut seed = Random(1);
    let mut random = || seed.between(-1.0, 1.0);
    let mut worst = [0.0_f64; 2];
    for i in 0..1_000_000_u32 {
        let mut any = |size: f64| Matrix2::new(random(), random(), random(), random()) * size;
        let f0 = match i % 5 {
            // Small strains with any rotation; inverted ones; arbitrary ones.
            0 => Rotation::from_angle(4.0 * any(1.0).m11).matrix() * (Matrix2::identity() + any(1e-3)),
            1 => Matrix2::new(-1.0, 0.0, 0.0, 1.0) + any(0.5),
            _ => any(2.0),
        };
        let f1 = match i % 7 {
            // Tiny changes; half a turn; a compression through zero; arbitrary ones.
            0 => f0 + any(1e-12),
            1 => f0 + any(1e-5),
            2 => Rotation::from_angle(PI).matrix() * (f0 + any(1e-9)),
            3 => -f0 + any(1e-3),
            4 => any(1e-6),
            _ => any(2.0),
        };
        let [h0, h1] = [f0, f1].map(|f| f - Matrix2::identity());
        let [r0, r1] = [f0, f1].map(|f| polar_or(&f, Rotation::IDENTITY));
        let stress = DiscreteGradient::new([h0, h1], [r0, r1]).stress(lame);
        let [w0, w1] = [(r0, h0), (r1, h1)].map(|(r, h)| lame.energy_density(&warped_strain(r, &h)));
        let scale = 1.0 + w0 + w1;
        worst[0] = worst[0].max((stress.dot(&(h1 - h0)) - (w1 - w0)).abs() / scale);
        let turning = stress * ((f0 + f1) * 0.5).transpose();
        worst[1] = worst[1].max((turning.m12 - turning.m21).abs() / scale);
    }
    assert!(worst[0] < 1e-12 && worst[1] < 1e-12, "{worst:?}");
}

/// An explicit integrator is stable just below its critical step; just above it, it explodes and reports this.
#[test]
fn the_critical_step_is_critical() {
    let at = |factor: f64| {
        let mut scene = with("swing", SYMPLECTIC, 1e-4, 1, 1e3);
        scene.dynamics.time_step = factor * Simulation::new(&scene).unwrap().motion().unwrap().critical_step().unwrap();
        let mut simulation = Simulation::new(&scene).unwrap();
        (0..6000).for_each(|_| _ = simulation.step());
        assert!(simulation.state().is_finite());
        (simulation.status().clone(), simulation.motion().unwrap().ledger().drift())
    };
    let (status, drift) = at(0.97);
    assert_eq!(status, Status::Running);
    assert!(drift.abs() < 0.1, "{drift}");
    let (status, _) = at(1.05);
    assert!(matches!(status, Status::Stopped(_)), "{status:?}");
    // The critical step is that of the current scene, after any edit.
    let mut scene = with("swing", SYMPLECTIC, 1e-5, 1, 1e3);
    let mut simulation = Simulation::new(&scene).unwrap();
    let mut critical = vec![simulation.motion().unwrap().critical_step().unwrap()];
    let edits: [fn(&mut Scene); 4] = [
        |scene| scene.material.density *= 4.0,
        |scene| scene.material.young *= 9.0,
        |scene| scene.dynamics.damping.stiffness = 1e-3,
        |scene| scene.scale_loads(2.0),
    ];
    for edit in edits {
        edit(&mut scene);
        simulation.change_scene(&scene).unwrap();
        let fresh = Simulation::new(&scene).unwrap().motion().unwrap().critical_step();
        assert_eq!(simulation.motion().unwrap().critical_step(), fresh);
        critical.push(fresh.unwrap());
    }
    assert!((critical[1] / critical[0] - 2.0).abs() < 1e-9 && (critical[2] / critical[1] - 1.0 / 3.0).abs() < 1e-9);
    assert!(critical[3] < 0.9 * critical[2] && critical[4] == critical[3], "{critical:?}");
    scene.dynamics.integrator = TR_BDF2;
    simulation.change_scene(&scene).unwrap();
    assert_eq!(simulation.motion().unwrap().critical_step(), None);
    // With the damping ratio ξ = (a/ω + b ω)/2, it is 2 (√(1 + ξ²) − ξ)/ω.
    let step = |mass_damping: f64, stiffness: f64| {
        let mut scene = beam(6, 10.0).moving(SYMPLECTIC, 1e-5);
        (scene.dynamics.damping.mass, scene.dynamics.damping.stiffness) = (mass_damping, stiffness);
        Simulation::new(&scene).unwrap().motion().unwrap().critical_step().unwrap()
    };
    let omega = 2.0 / step(0.0, 0.0);
    assert!(omega > 10.0);
    for (a, b) in [(omega, 0.0), (0.0, 1.0 / omega), (0.5 * omega, 3.0 / omega)] {
        let ratio = 0.5 * (a / omega + b * omega);
        let expected = 2.0 * ((1.0 + ratio * ratio).sqrt() - ratio) / omega;
        assert!((step(a, b) / expected - 1.0).abs() < 1e-9, "{a} {b}: {} {expected}", step(a, b));
    }
}

/// A step without a solution is halved, which is counted; the halves add up, and conserved quantities are conserved.
#[test]
fn a_step_that_fails_is_halved() {
    for (velocity, duration) in [([0.0, 0.0], 8.0), ([0.5, -0.25], 4.0)] {
        let mut scene = with("spin", ENERGY_MOMENTUM, 0.4, 0, duration);
        scene.material.young = 2e4;
        (scene.start.spin, scene.start.velocity) = (12.0, velocity);
        let before = momentum(&Simulation::new(&scene).unwrap()).angular;
        let simulation = run(&scene);
        let counts = simulation.motion().unwrap().counts();
        assert!(counts.halvings > 0 && counts.steps == (duration / 0.4).round() as u64, "{counts:?}");
        assert!((simulation.state().time() - duration).abs() < 1e-9);
        assert!((momentum(&simulation).angular / before - 1.0).abs() < 1e-6);
        assert!(drift(&simulation).abs() < 1e-6, "{}", drift(&simulation));
        // A free body moves with its velocity, however a step is divided.
        let mass = Mass::new(simulation.system(), scene.material.area_density());
        let moved = simulation.displacement().iter().zip(&mass.lumped).map(|(u, m)| u * *m).sum::<Vector2<f64>>();
        let centre = moved / mass.lumped.iter().sum::<f64>();
        assert!((centre - Vector2::from(velocity) * duration).norm() < 1e-2, "{centre}");
    }
}

#[test]
fn edits_in_mid_motion_keep_position_and_velocity() {
    let mut simulation = Simulation::new(&scene("swing")).unwrap();
    (0..20).for_each(|_| _ = simulation.step());
    let before = simulation.state().clone();
    let mut edited = scene("swing");
    edited.material = Material::new(3e6, 0.4);
    edited.loads = vec![Load::gravity([1.0, -5.0]), Load::moment("right", 30.0)];
    edited.dynamics.integrator = ENERGY_MOMENTUM;
    edited.dynamics.time_step = 1.0 / 100.0;
    simulation.change_scene(&edited).unwrap();
    let after = simulation.state();
    assert_eq!((after.displacement(), after.velocity()), (before.displacement(), before.velocity()));
    assert_eq!(after.time(), before.time());
    simulation.step();
    assert!((simulation.state().time() - before.time() - 0.01).abs() < 1e-12);
    // If the scene changes from dynamic to static, the body keeps its position and loses its velocity.
    let mut at_rest = edited.clone();
    at_rest.analysis = Analysis::Static;
    (at_rest.dynamics, at_rest.start) = Default::default();
    let position = simulation.displacement().to_vec();
    simulation.change_scene(&at_rest).unwrap();
    assert_eq!(simulation.displacement(), position);
    assert_eq!(*simulation.solve(), Status::Converged);
    let balanced = simulation.displacement().to_vec();
    simulation.change_scene(&edited).unwrap();
    assert_eq!(simulation.displacement(), balanced);
    assert_eq!(simulation.state().time(), 0.0);
    (0..50).for_each(|_| _ = simulation.step());
    let farthest = largest_distance(simulation.displacement(), &balanced);
    assert!(farthest < 1e-6, "an equilibrium stays one: {farthest}");
}

/// One solve per stage is enough for finite results in all scenes, under all stiffnesses and steps.
#[test]
fn tr_bdf2_and_auto_are_finite_everywhere() {
    let bodies = ["swing", "flick", "spin", "sway", "chime", "jelly"].into_iter();
    for (id, young) in bodies.flat_map(|id| [1e3, 1e6, 1e9, 1e12].map(|young| (id, young))) {
        for (h, method) in pairs([1.0 / 240.0, 1.0 / 60.0, 0.1], NEWTON_AND_AUTO) {
            let mut scene = with(id, TR_BDF2, h, 1, 1e4).with_method(method);
            scene.material.young = young;
            let mut simulation = Simulation::new(&scene).unwrap();
            simulation.keep_ledger(false);
            (0..100).for_each(|_| _ = simulation.step());
            assert_eq!(*simulation.status(), Status::Running, "{id} E = {young} h = {h} {method:?}");
            assert!(simulation.state().is_finite());
        }
    }
}

/// Steps of method `linear` are counted as those of linear theory, as by `auto`.
#[test]
fn steps_of_linear_theory_are_counted() {
    let mut simulation = Simulation::new(&scene("chime").with_method(MethodKind::Linear)).unwrap();
    (0..5).for_each(|_| _ = simulation.step());
    let counts = simulation.motion().unwrap().counts();
    assert_eq!((counts.linear_steps, counts.old_factor_steps, counts.new_factor_steps), (counts.steps, 0, 0));
    assert!(counts.steps > 0);
}

/// Returns the numbers of steps of a motion by decision of `auto`.
fn report(simulation: &Simulation) -> Counts {
    assert!(simulation.motion().unwrap().decision().is_some());
    simulation.motion().unwrap().counts()
}

/// Returns the largest distance of two methods' bodies over a motion, percent of the largest displacement of the first,
/// and the second's simulation.
fn distance(scene: &Scene, methods: [MethodKind; 2]) -> (f64, Simulation) {
    let mut simulations = methods.map(|method| Simulation::new(&scene.clone().with_method(method)).unwrap());
    let (mut farthest, mut largest) = (0.0_f64, 0.0_f64);
    while *simulations[0].status() == Status::Running {
        simulations.iter_mut().for_each(|s| _ = s.step());
        let [a, b] = [0, 1].map(|i| simulations[i].displacement());
        farthest = farthest.max(largest_distance(a, b));
        largest = a.iter().map(|u| u.norm()).fold(largest, f64::max);
    }
    let [a, b] = simulations;
    assert_eq!((a.status(), b.status()), (&Status::Finished, &Status::Finished));
    (100.0 * farthest / largest, b)
}

const NEWTON_AND_AUTO: [MethodKind; 2] = [MethodKind::Newton, MethodKind::Auto];

#[test]
fn auto_moves_as_newton_does_within_the_requested_error() {
    const ASKED: [f64; 3] = [10.0, 1.0, 0.1];
    for (id, kind) in ids_of(Analysis::Dynamic).into_iter().flat_map(|id| IMPLICIT.map(|kind| (id, kind))) {
        let mut scene = scene(id);
        scene.dynamics.integrator = kind;
        let mut newton = Simulation::new(&scene.clone().with_method(MethodKind::Newton)).unwrap();
        scene.solver.method = MethodKind::Auto;
        let mut autos = ASKED.map(|asked| {
            scene.solver.max_error_percent = asked;
            Simulation::new(&scene).unwrap()
        });
        let (mut farthest, mut largest) = ([0.0_f64; 3], 0.0_f64);
        for _ in 0..120 {
            newton.step();
            largest = newton.displacement().iter().map(|u| u.norm()).fold(largest, f64::max);
            for (auto, farthest) in autos.iter_mut().zip(&mut farthest) {
                auto.step();
                *farthest = farthest.max(largest_distance(auto.displacement(), newton.displacement()));
            }
        }
        for ((asked, farthest), auto) in ASKED.into_iter().zip(farthest).zip(&autos) {
            let error = 100.0 * farthest / largest;
            assert!(error <= asked, "{id} {} {asked} %: {error} %, {:?}", kind.id(), report(auto));
        }
    }
}

/// The error of a swing is due to its integrator, not to old factors, which are reused many times.
#[test]
fn auto_swings_as_well_with_far_fewer_factorizations() {
    for (rate, kind) in [(60, TR_BDF2), (120, TR_BDF2), (60, ENERGY_MOMENTUM)] {
        let [(newton, of_newton), (auto, of_auto)] = NEWTON_AND_AUTO.map(|method| swing_error(kind, rate, 2.0, method));
        assert!(auto <= 1.05 * newton, "{} 1/{rate}: {auto} {newton}", kind.id());
        assert!(5 * of_auto.factorizations <= of_newton.factorizations, "{of_auto:?} {of_newton:?}");
    }
}

/// Under small loads linear theory is used for as long as its phase is accurate; under large loads it is not.
#[test]
fn auto_uses_linear_theory_where_it_is_accurate_enough() {
    for kind in IMPLICIT {
        let mut small = with("swing", kind, 1.0 / 60.0, 1, 4.0);
        let large = small.clone();
        small.scale_loads(1e-5);
        let (error, auto) = distance(&small, NEWTON_AND_AUTO);
        assert!(error <= 1.0, "{error}");
        assert!(auto.is_linear());
        let (decision, Counts { linear_steps, factorizations, .. }) =
            (auto.motion().unwrap().decision(), report(&auto));
        assert_eq!((decision, linear_steps, factorizations), (Some(Decision::Linear), 240, 1), "{}", kind.id());
        let auto = run(&large.with_method(MethodKind::Auto));
        assert!(!auto.is_linear() && report(&auto).linear_steps < 5, "{:?}", report(&auto));
    }
    let mut between = with("swing", TR_BDF2, 1.0 / 60.0, 1, 10.0);
    between.scale_loads(2e-3);
    let (error, auto) = distance(&between, NEWTON_AND_AUTO);
    assert!(error <= 1.0, "{error}");
    assert!((10..600).contains(&report(&auto).linear_steps), "{:?}", report(&auto));
}

/// Linear theory has no buckling, so that `auto` must not use it for a column.
#[test]
fn auto_sees_a_column_buckle() {
    let euler = PI.powi(2) * 1e6 / 12.0 * f64::powi(0.05, 3) / 4.0;
    let mut column =
        beam(20, 20.0).force("right", [-1.5 * euler, 0.0]).force("right", [0.0, 1e-3 * euler]).pulse(0.0, 0.2);
    (column.dynamics.time_step, column.dynamics.duration) = (1.0 / 60.0, 8.0);
    let (error, auto) = distance(&column, NEWTON_AND_AUTO);
    assert!(auto.probe("tip").unwrap().y.abs() > 0.1, "it buckles: {:?}", auto.probe("tip"));
    assert!(error <= 1.0, "{error} {:?}", report(&auto));
}

/// The decisions of `auto` depend on no time measurement, whatever the previous state was.
#[test]
fn auto_is_reproduced_to_the_last_bit() {
    // Linear theory is used for the smaller load until its phase may be inaccurate.
    for (id, kind, load) in [("flick", TR_BDF2, 1.0), ("swing", ENERGY_MOMENTUM, 1.0), ("swing", TR_BDF2, 2e-3)] {
        let duration = if load < 1.0 { 8.0 } else { 0.5 };
        let mut scene = with(id, kind, 1.0 / 120.0, 1, duration).with_method(MethodKind::Auto);
        scene.scale_loads(load);
        let (mut a, mut b) = (Simulation::new(&scene).unwrap(), Simulation::new(&scene).unwrap());
        b.keep_ledger(false);
        a.solve();
        b.solve();
        assert_eq!(a.state(), b.state(), "{id}");
        let counts = a.motion().unwrap().counts();
        a.reset();
        a.solve();
        assert_eq!((a.state(), a.motion().unwrap().counts()), (b.state(), counts), "{id} from the start again");
    }
}

/// A body at rest is grabbed, pulled, and released with another material: the motion is the same as under Newton.
#[test]
fn auto_follows_a_grab_and_edits() {
    for kind in IMPLICIT {
        let mut scene = with("swing", kind, 1.0 / 120.0, 1, 1e3);
        scene.scale_loads(1e-6);
        let mut bodies = NEWTON_AND_AUTO.map(|method| Simulation::new(&scene.clone().with_method(method)).unwrap());
        let mut worst = 0.0_f64;
        for step in 0..160 {
            for body in &mut bodies {
                if step == 20 {
                    grab(body, Vector2::new(0.9, 0.01));
                }
                if (20..80).contains(&step) {
                    let t = f64::from(step - 20) / 120.0;
                    body.pull_to(Vector2::new(0.9 - 0.4 * t, 0.01 + 0.9 * t)).unwrap();
                }
                if step == 80 {
                    body.release();
                    body.change_scene(&body.scene().clone().with_material(Material::new(2e6, 0.35))).unwrap();
                }
                body.step();
            }
            worst = worst.max((bodies[0].probe("tip").unwrap() - bodies[1].probe("tip").unwrap()).norm());
        }
        let [newton, auto] = &bodies;
        assert!(newton.probe("tip").unwrap().norm() > 0.1, "it was pulled");
        assert!(worst <= 0.01 * 0.5, "{} {worst}", kind.id());
        let ledger = auto.motion().unwrap().ledger();
        assert!(ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{ledger:?}");
        assert!(report(auto).linear_steps >= 20, "{:?}", report(auto));
    }
}

/// The decisions are reported in JSON and in the text output.
#[test]
fn auto_reports_its_decisions() {
    let args = ["swing", "--set", "solver.method=\"auto\"", "--set", "dynamics.duration=0.5"];
    let json = solve_json(&args);
    let number = |key: &str| json["auto"][key].as_u64().unwrap();
    let steps = ["linear_steps", "old_factor_steps", "new_factor_steps"].map(number);
    assert_eq!(steps.iter().sum::<u64>(), json["steps"].as_u64().unwrap(), "{json}");
    assert!(number("factorizations") < 30 && number("solves") >= 60, "{json}");
    let text = solve_text(&args);
    assert!(text.contains("with an old factor"), "{text}");
}

/// The stresses of a stiff body change much in a long step: the factor of an earlier matrix does not serve then.
#[test]
fn auto_adds_no_energy_to_a_stiff_body_in_long_steps() {
    for young in [5e11, 1.1e12, 1.3e12, 2e12] {
        let mut scene = with("spin", TR_BDF2, 0.1, 1, 1e4).with_method(MethodKind::Auto);
        scene.material.young = young;
        let mut simulation = Simulation::new(&scene).unwrap();
        (0..20).for_each(|_| _ = simulation.step());
        assert_eq!(*simulation.status(), Status::Running, "E = {young}");
        let drift = simulation.motion().unwrap().ledger().drift_of_input();
        assert!(drift < 1e-3, "E = {young}: drift {drift}");
    }
}

/// A body is at rest if nothing has moved for half a second and ten steps, and no pulse will follow.
#[test]
fn a_body_at_rest_is_reported_as_at_rest() {
    for h in [1.0 / 60.0, 0.125] {
        let mut scene = Scene::beam(3.0, 0.3).with_cells(4, 1).clamp("left").moving(EULER, h);
        scene = scene.with_material(Material::new(1e8, 0.3)).force("right", [0.0, 10.0]).pulse(1.5, 0.5);
        scene.dynamics.damping.mass = 8.0;
        scene.dynamics.duration = 1e3;
        let mut simulation = Simulation::new(&scene).unwrap();
        assert!(!simulation.is_at_rest());
        let (mut still, mut rested) = (0_u32, 0_u32);
        for _ in 0..(12.0 / h) as u32 {
            simulation.step();
            let fastest = largest(simulation.state().velocity());
            still = if fastest < 1e-6 * simulation.system().size() { still + 1 } else { 0 };
            let expected = still >= 10 && f64::from(still) * h >= 0.5 && simulation.state().time() >= 2.0;
            assert_eq!(simulation.is_at_rest(), expected, "h = {h} at {} s", simulation.state().time());
            rested += u32::from(expected);
        }
        assert!(rested > 5, "it comes to rest");
    }
    let mut search = Simulation::new(&scene("cantilever")).unwrap();
    assert!(!search.is_at_rest());
    search.solve();
    assert!(search.is_at_rest());
    let mut exploding = Simulation::new(&with("swing", SYMPLECTIC, 0.01, 1, 1e3)).unwrap();
    while !matches!(exploding.status(), Status::Stopped(_)) {
        assert!(!exploding.is_at_rest());
        exploding.step();
    }
    assert!(exploding.is_at_rest());
}

/// A ledger that is kept continues; a ledger that is switched on again starts from the current state.
#[test]
fn a_resumed_ledger_starts_with_the_present_energy() {
    let mut simulation = Simulation::new(&scene("swing")).unwrap();
    let ledger = |simulation: &Simulation| *simulation.motion().unwrap().ledger();
    (0..10).for_each(|_| drop(simulation.step().clone()));
    let kept = ledger(&simulation);
    simulation.keep_ledger(true);
    assert_eq!(ledger(&simulation), kept);
    simulation.keep_ledger(false);
    (0..10).for_each(|_| drop(simulation.step().clone()));
    assert_eq!(ledger(&simulation), kept, "nothing is recorded");
    simulation.keep_ledger(true);
    let anew = ledger(&simulation);
    assert_eq!((anew.start, anew.throughput), (anew.total(), 0.0));
    assert_ne!(anew.total(), kept.total());
    (0..10).for_each(|_| drop(simulation.step().clone()));
    let after = ledger(&simulation);
    assert!(after.throughput > 0.0 && after.imbalance().abs() < 1e-11 * after.throughput, "{after:?}");
}

/// The trapezoidal rule integrates the work over short steps; implicit Euler applies the force at the end of a step.
#[test]
fn work_is_force_times_displacement() {
    for (kind, close) in [(EULER, 1e-9), (TR_BDF2, 2e-3), (ENERGY_MOMENTUM, 2e-3), (SYMPLECTIC, 2e-3)] {
        let h = if kind == SYMPLECTIC { 1e-4 } else { 1.0 / 480.0 };
        let steps = (0.5 / h) as u32;
        let mut scene = beam(6, 10.0).moving(kind, h).force("right", [3.0, 20.0]).pulse(0.05, 0.4);
        scene = scene.moment("right", 6.0).pulse(0.05, 0.4);
        scene.dynamics.duration = 1e3;
        let mut simulation = Simulation::new(&scene).unwrap();
        let middle = simulation.system().mesh().locate(Vector2::new(0.6, 0.01)).unwrap();
        let (mut pulses, mut hands) = (0.0, 0.0);
        let right = simulation.system().edges().iter().position(|edge| edge.name() == "right").unwrap();
        // Mean over a step, by Simpson's rule on many parts.
        let pulse = |from: f64, to: f64| {
            let at = |time: f64| {
                let part = (time - 0.05) / 0.4;
                if (0.0..1.0).contains(&part) { (part * TAU / 2.0).sin().powi(2) } else { 0.0 }
            };
            let parts =
                (0..64).map(|i| [0.0, 0.5, 1.0].map(|half| at(from + (to - from) * (f64::from(i) + half) / 64.0)));
            parts.map(|[a, b, c]| (a + 4.0 * b + c) / (6.0 * 64.0)).sum::<f64>()
        };
        for step in 0..steps {
            if step == steps / 4 {
                assert!(simulation.grab(middle));
            }
            if step >= steps / 4 {
                let t = f64::from(step - steps / 4) * h;
                simulation.pull_to(Vector2::new(0.6 - 0.1 * t, 0.01 + 0.2 * (8.0 * t).sin())).unwrap();
            }
            let spring = |simulation: &Simulation| {
                let (spring, force) = simulation.mouse_spring()?;
                Some((spring.position(simulation.displacement()), force))
            };
            let along = |simulation: &Simulation| {
                let tip = simulation.probe("tip").unwrap();
                Vector2::new(3.0, 20.0).dot(&tip) + 6.0 * simulation.state().edge_angles()[right]
            };
            let before = (along(&simulation), simulation.state().time(), spring(&simulation));
            simulation.step();
            let after = (along(&simulation), simulation.state().time(), spring(&simulation));
            pulses += pulse(before.1, after.1) * (after.0 - before.0);
            if let (Some((x0, f0)), Some((x1, f1))) = (before.2, after.2) {
                let applied = if kind == EULER { f1 } else { 0.5 * (f0 + f1) };
                hands += applied.dot(&(x1 - x0));
            }
        }
        let ledger = *simulation.motion().unwrap().ledger();
        assert!(pulses.abs() > 0.1 && hands.abs() > 0.1, "{pulses} {hands}");
        assert!((ledger.pulses - pulses).abs() < close * pulses.abs(), "{}: {} {pulses}", kind.id(), ledger.pulses);
        let by_hand = ledger.mouse_spring;
        assert!((by_hand - hands).abs() < 10.0 * close * hands.abs(), "{}: {by_hand} {hands}", kind.id());
    }
}

/// A switch to or from linear theory changes the energy of a state, which the ledger records.
#[test]
fn a_change_of_theory_is_recorded_in_the_ledger() {
    let mut scene = with("swing", TR_BDF2, 1.0 / 60.0, 1, 4.0).with_method(MethodKind::Auto);
    scene.scale_loads(4e-3);
    let mut simulation = Simulation::new(&scene).unwrap();
    let (mut changes, mut linear, mut throughput) = (0, simulation.is_linear(), 0.0);
    while *simulation.status() == Status::Running {
        simulation.step();
        changes += u32::from(simulation.is_linear() != linear);
        linear = simulation.is_linear();
        let ledger = *simulation.motion().unwrap().ledger();
        assert!(ledger.imbalance().abs() < 1e-10 * ledger.throughput, "{changes} changes: {ledger:?}");
        assert!(ledger.throughput >= throughput, "{changes} changes: {ledger:?}");
        throughput = ledger.throughput;
    }
    assert!(changes >= 2, "{changes} changes, {:?}", report(&simulation));
}

/// A free body starts with its scene's velocity and with its spin about its centre. It is stopped when it is far away.
#[test]
fn a_body_starts_with_the_velocity_and_spin_of_its_scene() {
    let mut scene = Scene::beam(2.0, 1.0).with_cells(6, 3).moving(TR_BDF2, 0.5).probe("end", "right");
    (scene.start.velocity, scene.start.spin, scene.dynamics.duration) = ([3.0, -1.5], 0.7, 1e6);
    scene.solver.method = MethodKind::Linear;
    let simulation = Simulation::new(&scene).unwrap();
    let centre = Vector2::new(1.0, 0.0);
    for (x, v) in simulation.system().mesh().nodes().iter().zip(simulation.state().velocity()) {
        let arm = x - centre;
        let expected = Vector2::new(3.0 - 0.7 * arm.y, -1.5 + 0.7 * arm.x);
        assert!((v - expected).norm() < 1e-12, "at {x}: {v} {expected}");
    }
    assert!(simulation.is_linear() && !Simulation::new(&with("swing", EULER, 0.01, 1, 1.0)).unwrap().is_linear());
    let mass = 2.0 * scene.material.area_density();
    let start = momentum(&simulation);
    assert!((start.linear - Vector2::new(3.0, -1.5) * mass).norm() < 1e-9 * mass);
    // Angular momentum about the origin: c × m v, and that of the spin, ω m (L² + H²)/12.
    let expected = mass * (centre.perp(&Vector2::new(3.0, -1.5)) + 0.7 * 5.0 / 12.0);
    assert!((start.angular - expected).abs() < 1e-9 * mass, "{} {expected}", start.angular);
    // A free body moves on until it is so far away that its strains have lost their digits.
    let mut thrown = scene.clone();
    (thrown.start.velocity, thrown.start.spin) = ([0.0, 9e3], 0.0);
    thrown.dynamics.time_step = 10.0;
    let mut simulation = Simulation::new(&thrown).unwrap();
    let limit = 1e6 * simulation.system().size();
    while *simulation.status() == Status::Running {
        let gone = simulation.probe("end").unwrap().norm();
        assert!(gone <= limit, "{gone} m of {limit}");
        simulation.step();
    }
    assert!(matches!(simulation.status(), Status::Stopped(StopReason::RanAway(_))), "{:?}", simulation.status());
    assert!(simulation.probe("end").unwrap().norm() > limit);
    // The residual of a step is below the tolerance if it iterates, and small if it solves once.
    let left = |iterations: u32| {
        let mut scene = with("swing", TR_BDF2, 1.0 / 60.0, iterations, 1.0);
        scene.solver.tolerance = 1e-9;
        run(&scene).residual()
    };
    assert!(left(0) <= 1e-9 && (1e-8..0.1).contains(&left(1)), "{:e} {:e}", left(0), left(1));
}

/// After an edit, a motion continues like one that starts in this state, independent of any cached data.
#[test]
fn an_edited_motion_continues_as_a_new_one() {
    for method in [MethodKind::Linear, MethodKind::Newton, MethodKind::Auto] {
        for kind in [EULER, TR_BDF2, ENERGY_MOMENTUM] {
            let mut scene = with("swing", kind, 1.0 / 60.0, 1, 1e3).with_method(method);
            scene.scale_loads(0.1);
            scene.solver.max_error_percent = 0.1;
            let mut simulation = Simulation::new(&scene).unwrap();
            (0..20).for_each(|_| drop(simulation.step().clone()));
            // `start_from` sets this displacement with zero velocity, so that both motions start in the same state.
            let u = simulation.displacement().to_vec();
            let mut edited = scene.clone();
            edited.material = Material { density: 500.0, ..Material::new(4e6, 0.2) };
            edited.dynamics.damping.mass = 0.5;
            simulation.change_scene(&edited).unwrap();
            let before = *simulation.motion().unwrap().ledger();
            assert!(before.edits != 0.0 && before.throughput >= before.edits.abs(), "{before:?}");
            simulation.start_from(&u).unwrap();
            let mut new = Simulation::new(&edited).unwrap();
            new.start_from(&u).unwrap();
            for step in 0..20 {
                simulation.step();
                new.step();
                let off = (simulation.probe("tip").unwrap() - new.probe("tip").unwrap()).norm();
                assert!(off < 1e-12, "{} {method:?} in step {step}: {off}", kind.id());
            }
        }
    }
    // The same without a new start, if the solves are not approximate.
    for method in [MethodKind::Linear, MethodKind::Newton] {
        let mut scene = with("swing", EULER, 1.0 / 60.0, 0, 1e3).with_method(method);
        scene.scale_loads(0.1);
        let mut simulation = Simulation::new(&scene).unwrap();
        (0..20).for_each(|_| drop(simulation.step().clone()));
        let ledger = *simulation.motion().unwrap().ledger();
        scene.material = Material::new(4e6, 0.2);
        simulation.change_scene(&scene).unwrap();
        let edited = *simulation.motion().unwrap().ledger();
        let change = edited.total() - ledger.total();
        assert!((edited.edits - change).abs() < 1e-12 * change.abs() && change != 0.0, "{ledger:?} {edited:?}");
        assert!((edited.throughput - ledger.throughput - change.abs()).abs() < 1e-9 * edited.throughput);
        let mut new = Simulation::new(&scene).unwrap();
        new.restore(simulation.state()).unwrap();
        [&mut simulation, &mut new].into_iter().for_each(|body| (0..20).for_each(|_| _ = body.step()));
        let off = (simulation.probe("tip").unwrap() - new.probe("tip").unwrap()).norm();
        assert!(off < 1e-7, "{method:?}: {off}");
    }
}

/// In linear theory one solve is exact, also with damping and with the mouse spring below its largest force.
#[test]
fn one_solve_is_exact_in_linear_theory() {
    for kind in IMPLICIT {
        let mut scene = with("swing", kind, 1.0 / 60.0, 1, 1e3).with_method(MethodKind::Linear);
        scene.scale_loads(0.05);
        for (mass, stiffness, spring) in
            [(0.0, 0.0, false), (2.0, 0.0, false), (0.0, 0.02, false), (0.0, 0.0, true), (2.0, 0.02, true)]
        {
            (scene.dynamics.damping.mass, scene.dynamics.damping.stiffness) = (mass, stiffness);
            let mut simulation = Simulation::new(&scene).unwrap();
            if spring {
                grab(&mut simulation, Vector2::new(0.9, 0.01));
            }
            for step in 0..20 {
                let to = Vector2::new(0.9, 0.01) + Vector2::new(-0.1, 0.4) * (f64::from(step) / 200.0);
                simulation.pull_to(to).unwrap();
                simulation.step();
                let left = simulation.residual();
                assert!(left < 1e-11, "{} {mass} {stiffness} {spring} in step {step}: {left:e}", kind.id());
            }
            let pulled = simulation.mouse_spring().map_or(1.0, |(_, force)| force.norm());
            assert!(pulled > 1e-3, "{pulled}");
        }
    }
}

/// Supported unknowns have neither velocity nor displacement, whatever the body is started with.
#[test]
fn supports_stop_the_nodes_that_they_hold() {
    let mut scene = beam(6, 10.0).with_method(MethodKind::Newton);
    (scene.start.velocity, scene.start.spin) = ([1.0, 2.0], 3.0);
    let mut simulation = Simulation::new(&scene).unwrap();
    let moves = |of: &[Vector2<f64>], simulation: &Simulation| {
        let pattern = simulation.system().pattern();
        let held = (0..).zip(of).filter(|&(node, _)| pattern.fixed(node) == [true; 2]);
        (held.map(|(_, v)| v.norm()).fold(0.0, f64::max), of.iter().map(|v| v.norm()).fold(0.0, f64::max))
    };
    let (held, fastest) = moves(simulation.state().velocity(), &simulation);
    assert!(held == 0.0 && fastest > 1.0, "{held} {fastest}");
    simulation.start_from(&vec![Vector2::new(1e-3, -2e-3); simulation.displacement().len()]).unwrap();
    let (held, farthest) = moves(simulation.displacement(), &simulation);
    assert!(held == 0.0 && farthest > 1e-3, "{held} {farthest}");
}
