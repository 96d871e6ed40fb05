//! Tests that every built-in scene must pass.

use std::collections::BTreeSet;

use crate::common::*;
use crate::{Test, suite};
use libtest_mimic::Trial;

const TESTS: &[Test<&'static str>] = tests! {
    the_scene_has_a_description_and_a_probe the_scene_is_unchanged_by_writing_and_reading_toml
};

const STATIC: &[Test<&'static str>] = tests! {
    reactions_balance_the_loads linear_theory_obeys_clapeyron every_element_converges warped_ends_where_newton_does
};

const DYNAMIC: &[Test<&'static str>] = tests! {
    the_scene_runs_to_its_end the_scene_moves_under_every_integrator_and_element
};

pub fn trials() -> Vec<Trial> {
    let named = |ids: Vec<&'static str>| ids.into_iter().map(|id| (id.to_owned(), id));
    let mut trials = suite("scene", named(scene_ids()), TESTS);
    trials.extend(suite("scene", named(ids_of(Analysis::Static)), STATIC));
    trials.extend(suite("scene", named(ids_of(Analysis::Dynamic)), DYNAMIC));
    trials.push(Trial::test("scene::every_file_is_built_in", || {
        every_file_is_built_in();
        Ok(())
    }));
    trials
}

/// Every integrator that is not explicit runs a dynamic scene to its end, and its energy ledger balances.
fn the_scene_runs_to_its_end(id: &'static str) {
    for integrator in IntegratorKind::all().map(IntegratorKind::entry).filter(|i| !i.is_explicit()) {
        let mut scene = scene(id);
        scene.dynamics.integrator = integrator.kind;
        let simulation = run(&scene);
        assert_eq!(simulation.solution().deformation.inverted_elements, 0, "{}", integrator.id);
        let ledger = simulation.motion().unwrap().ledger();
        assert!(ledger.imbalance().abs() < 1e-11 * ledger.throughput, "{}: {ledger:?}", integrator.id);
        // For finite differences, the rounding of the time step in the work of pulses and damping
        // counts as the integrator's.
        let allowed = if integrator.kind == IntegratorKind::EnergyMomentum { 1e-6 } else { 1e-3 };
        assert!(ledger.drift() < allowed, "{} gains energy: {ledger:?}", integrator.id);
    }
}

/// Runs a few steps of every integrator on every element, explicit integrators within their critical step.
fn the_scene_moves_under_every_integrator_and_element(id: &'static str) {
    let elements = scene(id).elements();
    for (integrator, element) in
        IntegratorKind::all().map(IntegratorKind::entry).flat_map(|i| elements.clone().map(move |e| (i, e.entry())))
    {
        let mut scene = scene(id);
        scene.dynamics.integrator = integrator.kind;
        scene.set_element(element.kind);
        let mut simulation = Simulation::new(&scene).unwrap();
        if let Some(critical) = simulation.motion().unwrap().critical_step() {
            scene.dynamics.time_step = 0.9 * critical;
            simulation = Simulation::new(&scene).unwrap();
        }
        (0..20).for_each(|_| _ = simulation.step());
        assert_eq!(*simulation.status(), Status::Running, "{} {}", integrator.id, element.id);
        assert!(simulation.state().is_finite());
        assert!(simulation.state().velocity().iter().any(|v| v.norm() > 0.0), "{} {}", integrator.id, element.id);
    }
}

/// A file that is not in the registry would not appear in any list of scenes.
fn every_file_is_built_in() {
    let files = std::fs::read_dir("assets/scenes").unwrap().map(|file| file.unwrap().path());
    let names: BTreeSet<String> = files.map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    assert_eq!(names, scene_ids().into_iter().map(str::to_owned).collect());
}

fn the_scene_has_a_description_and_a_probe(id: &'static str) {
    assert!(!scene(id).about.is_empty() && !scene(id).probes.is_empty());
}

fn the_scene_is_unchanged_by_writing_and_reading_toml(id: &'static str) {
    let scene = scene(id);
    assert_eq!(scene, Scene::from_toml_in(&scene.to_toml().unwrap(), "assets/scenes".as_ref()).unwrap());
}

/// Reactions and loads are in equilibrium for every method that converges, as forces and as moments about the origin.
fn reactions_balance_the_loads(id: &'static str) {
    for method in METHODS {
        let mut simulation = Simulation::new(&scene(id).with_method(method.kind)).unwrap();
        // Some scenes demonstrate where the warped iteration does not converge.
        if *simulation.solve() != Status::Converged {
            assert_eq!(method.kind, MethodKind::Warped, "{:?}", simulation.status());
            assert!(!["article", "cantilever", "gravity", "bridge", "stretch", "shear"].contains(&id));
            continue;
        }
        let solution = simulation.solution();
        let reaction = solution.reaction;
        let (system, loads) = (simulation.system(), simulation.problem().loads());
        let total: Vector2<f64> = loads.dead_force().iter().sum();
        // A moment loads the body too, though its forces cancel.
        let scale = loads.dead_force().iter().map(|f| f.norm()).sum::<f64>()
            + loads.moments().map(|(_, moment)| moment.abs()).sum::<f64>()
            // Moving supports load the body too.
            + solution.supports.iter().map(|s| s.force.norm()).sum::<f64>();
        // `auto` stops within the requested error, the others at a residual.
        let close = if method.kind == MethodKind::Auto { 1e-2 } else { 1e-6 };
        assert!((reaction.force + total).norm() < close * scale, "{}: {:?}", method.id, reaction.force);
        if simulation.is_linear() {
            // Linear theory balances moments about the rest positions; the reported reaction is about the current ones.
            continue;
        }
        let arms = system.mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u);
        let dead: f64 = arms.zip(loads.dead_force()).map(|(x, f)| x.perp(f)).sum();
        let moment = dead + loads.moments().map(|(_, moment)| moment).sum::<f64>();
        let size = system.mesh().bounds().1.norm();
        assert!((reaction.moment + moment).abs() < close * scale * size, "{}: {}", method.id, reaction.moment);
    }
}

/// Loads at full size and moved supports do twice the work that is stored; along the path it is half of that.
fn linear_theory_obeys_clapeyron(id: &'static str) {
    let simulation = solved(&scene(id).with_method(MethodKind::Linear));
    let energy = simulation.solution().energy;
    assert!(energy.elastic > 0.0);
    let supports = energy.supports.unwrap();
    assert!((energy.external + 2.0 * supports - 2.0 * energy.elastic).abs() < 1e-8 * energy.elastic, "{energy:?}");
}

fn every_element_converges(id: &'static str) {
    for element in scene(id).elements().map(ElementKind::entry) {
        let mut scene = scene(id).with_method(MethodKind::Newton);
        scene.set_element(element.kind);
        let mut simulation = solved(&scene);
        assert_eq!(simulation.certify().stable, Some(true), "{}", element.id);
        assert_eq!(simulation.solution().deformation.inverted_elements, 0, "{}", element.id);
    }
}

/// A converged warped result is an exact equilibrium: Newton's method finds the same from rest.
fn warped_ends_where_newton_does(id: &'static str) {
    let mut scene = scene(id);
    (scene.solver.tolerance, scene.solver.max_iterations) = (1e-10, 500);
    let mut newton = solved(&scene.clone().with_method(MethodKind::Newton));
    let rho = newton.certify().fixed_point_rho.unwrap();
    let warped = ended(&scene.with_method(MethodKind::Warped));
    let status = warped.status().clone();
    if rho < 0.98 {
        assert_eq!(status, Status::Converged, "ρ = {rho}");
        let size = largest(newton.displacement());
        for (a, b) in warped.displacement().iter().zip(newton.displacement()) {
            assert!((a - b).norm() < 1e-7 * size.max(1.0), "{a} {b}");
        }
    } else if id != "stretch" {
        // The bar's rotations are never excited: it converges for every ρ.
        assert!(matches!(status, Status::Diverged(Reason::Stalled(_))), "ρ = {rho}: {status:?}");
    }
}
