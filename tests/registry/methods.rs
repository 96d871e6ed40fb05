//! Tests that every method must pass.

use crate::common::*;
use crate::{Test, has_own_colors, suite};
use libtest_mimic::Trial;

const TESTS: &[Test<MethodKind>] = tests! {
    the_id_is_the_name_in_scene_files its_colour_is_its_own an_axial_bar_stretches_by_pl_over_ea
    without_load_nothing_moves extremes_stay_finite an_edited_load_has_the_solution_of_a_start_at_rest
    a_huge_load_does_not_affect_later_solves a_restored_state_continues_as_the_saved_one
    a_running_state_is_reported_as_running
};

pub fn trials() -> Vec<Trial> {
    suite("method", METHODS.iter().map(|m| (m.id.to_owned(), m.kind)), TESTS)
}

fn the_id_is_the_name_in_scene_files(kind: MethodKind) {
    assert_eq!(toml::Value::try_from(kind).unwrap().as_str(), Some(kind.id()));
    assert_eq!(kind.entry().kind, kind);
}

fn its_colour_is_its_own(kind: MethodKind) {
    has_own_colors(kind.entry().colors);
}

/// The extension is δ = P L / (E A) on every mesh.
fn an_axial_bar_stretches_by_pl_over_ea(method: MethodKind) {
    for cells in ["[1,1]", "[16,2]", "[7,3]"] {
        let simulation = ended(&scene_with("stretch", &[&format!("beam.cells={cells}")]).with_method(method));
        assert_eq!(*simulation.status(), Status::Converged);
        let result = simulation.solution();
        let expected = 50_000.0 * 4.0 / (1e6 * 0.5);
        assert!((result.probes[0].u.x - expected).abs() < 1e-9 * expected, "{cells}: {}", result.probes[0].u.x);
        assert!(result.deformation.max_rotation_deg < 1e-9);
    }
}

fn without_load_nothing_moves(method: MethodKind) {
    let simulation = ended(&scene_with("cantilever", &["load.0.force=[0,0]"]).with_method(method));
    assert_eq!(*simulation.status(), Status::Converged);
    assert!(simulation.displacement().iter().all(|u| *u == Vector2::zeros()));
}

/// With extreme values of every kind there is no panic, all results are finite, and the status has a message.
fn extremes_stay_finite(method: MethodKind) {
    const SETS: &str = "load.0.force=[0,-1e15]|load.0.force=[1e15,0]|load.0.force=[-1e15,0]|load.0.force=[0,0]|\
        material.young=1e15 load.0.force=[0,-1e-9]|material.young=1e-6 load.0.force=[0,-1e15]|\
        material.poisson=0.4999 material.plane=strain|material.poisson=-0.99|beam.length=1e5|\
        beam.length=1e-6 beam.height=1e-6|beam.height=1e-3 beam.cells=[100,1]|solver.tolerance=1e-14|beam.cells=[1,1]";
    for id in ["cantilever", "article"] {
        for set in SETS.split('|') {
            let mut simulation = ended(&scene_with(id, &set.split(' ').collect::<Vec<_>>()).with_method(method));
            assert_ne!(*simulation.status(), Status::Running);
            simulation.certify();
            let s = simulation.solution();
            let rho = s.certificate.and_then(|c| c.fixed_point_rho).unwrap_or_default();
            let numbers = [
                s.residual,
                s.deformation.max_strain,
                s.deformation.max_rotation_deg,
                s.reaction.moment,
                s.reaction.force.x,
                s.energy.external,
                rho,
            ];
            assert!(numbers.iter().all(|v| v.is_finite()), "{id} {set:?}: {s:?}");
            assert!(simulation.state().is_finite(), "{id} {set:?}");
            let mut values = Vec::new();
            for field in Field::ALL.into_iter().filter(|field| *field != Field::ReferenceDistance) {
                simulation.field(field, &mut values);
                // An element that is inverted, or compressed to nothing by its strain, has no Cauchy stress.
                let is_whole = s.deformation.inverted_elements == 0 && s.deformation.max_strain < 1.0;
                let all = field.unit() != "Pa" || is_whole;
                assert!(!all || values.iter().all(Option::is_some), "{id} {set:?} {field:?}");
                assert!(values.iter().flatten().all(|v| v.is_finite()), "{id} {set:?} {field:?}");
            }
        }
    }
}

/// Returns the largest distance between two displacements, relative to the largest displacement of the second.
fn difference(a: &Simulation, b: &Simulation) -> f64 {
    largest_distance(a.displacement(), b.displacement()) / largest(b.displacement())
}

/// After any edit of a solved body, the result is that of a solve from rest.
fn an_edited_load_has_the_solution_of_a_start_at_rest(method: MethodKind) {
    const START: [&str; 2] = ["solver.tolerance=1e-10", "load.0.force=[0,-1000]"];
    let start = scene_with("cantilever", &START).with_method(method);
    let edits: &[&[&str]] = &[
        &["load.0.force=[0,-1300]"],
        &["load.0.force=[200,-700]"],
        &["material.young=1.4e6"],
        &["material.thickness=0.7"],
        &["material.poisson=0.1", "material.plane=strain"],
        &["beam.cells=[30,2]"],
        &["beam.element=q4", "beam.cells=[20,1]"],
        &["support=[{edge=\"left\",fix=[\"x\"]},{at=[0,0],fix=[\"y\"]}]"],
        &["support=[{edge=\"left\",fix=[\"x\",\"y\"]},{at=[5,0],fix=[\"x\",\"y\"]}]"],
        &["load=[{kind=\"gravity\",acceleration=[0,-0.05]},{kind=\"force\",edge=\"right\",force=[0,-100]}]"],
        &["load=[{kind=\"moment\",edge=\"right\",moment=2000}]"],
    ];
    for edit in edits {
        let mut edited = ended(&start);
        let all: Vec<&str> = START.into_iter().chain(edit.iter().copied()).collect();
        let scene = scene_with("cantilever", &all).with_method(method);
        edited.change_scene(&scene).unwrap();
        assert_eq!(edited.scene(), &scene);
        let fresh = ended(&scene);
        assert_eq!((edited.solve(), fresh.status()), (&Status::Converged, &Status::Converged), "{edit:?}");
        assert_eq!(edited.system().dofs(), fresh.system().dofs());
        // `auto` stops within the requested error.
        let close = if method == MethodKind::Auto { 1e-2 } else { 1e-6 };
        assert!(difference(&edited, &fresh) < close, "{edit:?}: {:e}", difference(&edited, &fresh));
    }
}

/// After a hopelessly large load, any edit that can be solved is solved.
fn a_huge_load_does_not_affect_later_solves(method: MethodKind) {
    for id in ["article", "cantilever"] {
        for force in [1e12, -1e12, 1e15] {
            let mut simulation = ended(&scene(id).with_method(method));
            for (horizontal, vertical) in [(0.0, force), (force, 0.0)] {
                simulation.edit(|scene| scene.set_force(0, [horizontal, vertical])).unwrap();
                simulation.solve();
                assert!(simulation.state().is_finite());
            }
            simulation.edit(|scene| scene.set_force(0, [0.0, 0.0])).unwrap();
            assert_eq!(*simulation.solve(), Status::Converged, "{id}: {force:e}, then nothing");
            let left = largest(simulation.displacement());
            assert!(left < 1e-9, "{id}: {force:e}, then nothing: {left:e} m are left");
            simulation.edit(|scene| scene.set_force(0, [0.0, force])).unwrap();
            simulation.solve();
            simulation.edit(|scene| scene.set_force(0, [0.0, -100.0])).unwrap();
            assert_eq!(*simulation.solve(), Status::Converged, "{id}: {force:e}, then 100 N");
            let mut small = scene(id).with_method(method);
            small.set_force(0, [0.0, -100.0]).unwrap();
            let close = if method == MethodKind::Auto { 1e-2 } else { 1e-6 };
            assert!(difference(&simulation, &ended(&small)) < close, "{id}: {force:e}, then 100 N");
        }
    }
}

fn a_restored_state_continues_as_the_saved_one(method: MethodKind) {
    let mut simulation = ended(&scene("cantilever").with_method(method));
    let saved = simulation.state().clone();
    simulation.edit(|scene| scene.set_force(0, [0.0, 500.0])).unwrap();
    simulation.solve();
    assert_ne!(*simulation.state(), saved);
    simulation.edit(|scene| scene.set_force(0, [0.0, -1500.0])).unwrap();
    simulation.restore(&saved).unwrap();
    // Linear theory solves again; for the other methods the restored state is already converged.
    if method != MethodKind::Linear && method != MethodKind::Auto {
        assert_eq!((simulation.status(), simulation.iterations()), (&Status::Converged, 0));
        assert_eq!(*simulation.state(), saved);
    }
    assert_eq!(*simulation.solve(), Status::Converged);
    assert!(simulation.restore(Simulation::new(&scene("article")).unwrap().state()).is_err());
}

fn a_running_state_is_reported_as_running(method: MethodKind) {
    let mut simulation = Simulation::new(&scene("cantilever").with_method(method)).unwrap();
    assert_eq!((simulation.status(), simulation.status().id()), (&Status::Running, "running"));
    assert!(simulation.status().failure().is_none());
    assert_eq!(simulation.certify(), Default::default(), "nothing is certified before the end");
    simulation.solve();
    assert_eq!(simulation.status().id(), "converged");
}
