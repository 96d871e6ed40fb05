//! Tests of `auto`: it skips work that is not needed, and its result is within the requested error of the equilibrium.

use crate::common::*;

fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.scale_loads(factor);
    scene
}

fn run(scene: &Scene, method: MethodKind) -> Simulation {
    ended(&scene.clone().with_method(method))
}

/// Returns the distance of two results at the first probe, percent of the second's displacement.
fn distance(a: &Simulation, b: &Simulation) -> f64 {
    let [a, b] = [a, b].map(|s| s.problem().probes()[0].mean(s.displacement()));
    100.0 * (a - b).norm() / b.norm()
}

fn report(simulation: &Simulation) -> AutoReport {
    simulation.equilibrium().unwrap().auto_report().unwrap()
}

/// Over five decades of loads. Linear theory is used where it is accurate enough, and nowhere else.
#[test]
fn every_result_is_within_the_requested_error() {
    let mut served = 0;
    let factors = [1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 0.6, 1.0, 1.5];
    let wholes = ids_of(Analysis::Static).into_iter().flat_map(|id| scene(id).elements().map(move |e| (id, e)));
    let cases = sampled(wholes.flat_map(|(id, element)| factors.map(|factor| (id, element, factor))), 3);
    for (id, element, factor) in &cases {
        let mut whole = scene(id);
        whole.set_element(*element);
        let mut scene = scaled(&whole, *factor);
        let exact = run(&scene, MethodKind::Newton);
        let linear = distance(&run(&scene, MethodKind::Linear), &exact);
        for asked in [10.0, 1.0, 0.1] {
            scene.solver.max_error_percent = asked;
            let auto = run(&scene, MethodKind::Auto);
            let what = format!("{id} {element:?} × {factor}, {asked} %: {:?}", report(&auto));
            assert_eq!(*auto.status(), Status::Converged, "{what}");
            let error = distance(&auto, &exact);
            assert!(error <= asked, "{what}: {error} %");
            let is_linear = report(&auto).decision == Decision::Linear;
            assert_eq!(is_linear, auto.is_linear());
            served += usize::from(is_linear);
            // The estimate covers the largest displacement too. Linear theory is not tried where supports move.
            let may_skip = !auto.problem().supports().move_the_body();
            assert!(is_linear || !may_skip || linear > 0.1 * asked, "{what}: linear theory is off by {linear} % only");
        }
    }
    assert!(5 * served > 2 * cases.len(), "{served} of {}", cases.len());
}

/// The load grows and rotates a little in every frame; every frame is within the requested error.
#[test]
fn a_dragged_load_seldom_needs_a_new_factor() {
    for id in ["cantilever", "elastica"] {
        drag(scene(id), 60, 1.0);
        // The load changes so slowly that the length of one step does not show how outdated the factor is.
        drag(scene(id), 300, 0.2);
    }
}

fn drag(mut scene: Scene, frames: u32, asked: f64) {
    scene.solver.method = MethodKind::Auto;
    scene.solver.max_error_percent = asked;
    let Load::Force { force, .. } = scene.loads[0].clone() else { unreachable!("a force") };
    let mut auto: Option<Simulation> = None;
    let (mut factorizations, mut newtons, mut old) = (0, 0, 0);
    for frame in 0..frames {
        let share = f64::from(frame) / f64::from(frames - 1);
        let turned = Rotation::from_angle(0.5 * share).apply(force.into()) * (0.2 + 0.8 * share);
        scene.set_force(0, turned).unwrap();
        let simulation = auto.get_or_insert_with(|| Simulation::new(&scene).unwrap());
        simulation.change_scene(&scene).unwrap();
        simulation.solve();
        let exact = run(&scene, MethodKind::Newton);
        let error = distance(simulation, &exact);
        assert!(error <= asked, "{} frame {frame}: {error} %, {:?}", scene.name, report(simulation));
        factorizations += report(simulation).factorizations;
        newtons += exact.iterations();
        old += u32::from(report(simulation).decision == Decision::OldFactor);
    }
    assert!(old >= frames / 2, "the old factor served {old} of {frames} frames");
    assert!(3 * factorizations <= newtons, "{factorizations} factorizations, newton's {newtons}");
}

#[test]
fn auto_does_not_solve_an_unchanged_scene_again() {
    for factor in [1e-3, 1.0] {
        let mut scene = scaled(&scene("elastica"), factor);
        scene.solver.method = MethodKind::Auto;
        let mut auto = run(&scene, MethodKind::Auto);
        assert!(auto.iterations() > 0);
        let before = auto.displacement().to_vec();
        scene.probes[0].name = "another name".to_owned();
        auto.change_scene(&scene).unwrap();
        assert_eq!((auto.status(), auto.iterations()), (&Status::Converged, 0));
        assert_eq!(report(&auto).decision, Decision::Unchanged);
        assert_eq!((report(&auto).solves, report(&auto).factorizations), (0, 0));
        assert_eq!(auto.displacement(), before);
        // A smaller allowed error requires another solve; a larger one does not.
        for (asked, solves) in [(5.0, false), (1e-4, true)] {
            let estimate = report(&auto).estimated_error;
            scene.solver.max_error_percent = asked;
            auto.change_scene(&scene).unwrap();
            assert_eq!(auto.iterations(), 0);
            auto.solve();
            assert_eq!(auto.iterations() > 0, solves, "{asked}");
            assert!(solves || report(&auto).estimated_error == estimate);
        }
        auto.change_scene(&scaled(&scene, 1.001)).unwrap();
        auto.solve();
        assert!(auto.iterations() > 0 && report(&auto).decision != Decision::Unchanged);
        assert!(auto.displacement() != before);
    }
    // Repeated small loads cost one factorization in total, and three back substitutions per frame.
    let mut scene = scaled(&scene("cantilever"), 1e-3);
    scene.solver.method = MethodKind::Auto;
    let mut auto = run(&scene, MethodKind::Auto);
    for frame in 0..5 {
        scene = scaled(&scene, 0.9);
        auto.change_scene(&scene).unwrap();
        auto.solve();
        let AutoReport { decision, solves, factorizations, .. } = report(&auto);
        assert_eq!((decision, solves, factorizations), (Decision::Linear, 3, 0), "frame {frame}");
    }
}

/// A changed stiffness makes the old factors useless.
#[test]
fn a_new_stiffness_is_factorized_again() {
    for factor in [1e-3, 1.0] {
        let mut scene = scaled(&scene("elastica"), factor);
        scene.solver.method = MethodKind::Auto;
        let mut auto = run(&scene, MethodKind::Auto);
        for change in [|s: &mut Scene| s.material.young *= 1.5, |s: &mut Scene| s.material.thickness *= 0.7] {
            change(&mut scene);
            auto.change_scene(&scene).unwrap();
            auto.solve();
            let error = distance(&auto, &run(&scene, MethodKind::Newton));
            assert!(error <= scene.solver.max_error_percent, "{error}");
        }
    }
}

/// The straight state of a compressed column is its own linear solution; beyond Euler's load it is unstable.
#[test]
fn an_unstable_linear_solution_is_not_taken() {
    let mut column = scene("elastica");
    let beam = column.beam.clone().unwrap();
    let bending = column.material.young * column.material.thickness * beam.height.powi(3) / 12.0;
    let euler = PI.powi(2) * bending / (4.0 * beam.length.powi(2));
    for (share, decides_linear) in [(0.5, true), (0.9, true), (1.1, false), (1.5, false)] {
        column.loads = vec![Load::force("right", [-share * euler, 0.0])];
        let auto = run(&column, MethodKind::Auto);
        assert_eq!(report(&auto).decision == Decision::Linear, decides_linear, "{share}: {:?}", report(&auto));
    }
}
