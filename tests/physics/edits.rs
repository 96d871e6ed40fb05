//! Tests of edits to a solved body: cached data and state that they keep or discard.

use std::sync::Arc;

use crate::common::*;

/// An edit of loads keeps the state of a loaded body, even if it couples unknowns that were not coupled.
#[test]
fn edits_of_loads_keep_the_state() {
    let start = scene_with("cantilever", &["solver.method=newton", "solver.tolerance=1e-12"]);
    let before = solved(&start);
    let mut idle = start.clone();
    idle.loads.clear();
    let edits: [(&str, Scene); 5] = [
        ("a moment is added", start.clone().moment("right", 100.0)),
        ("a moment on a long edge", start.clone().moment("top", 100.0)),
        ("a weight is added", start.clone().gravity([0.0, -0.01])),
        ("a force elsewhere", start.clone().force("top", [1.0, 0.0])),
        ("loads go", idle),
    ];
    for (what, scene) in edits {
        let mut simulation = solved(&start);
        simulation.change_scene(&scene).unwrap();
        assert_eq!(simulation.displacement(), before.displacement(), "{what}");
        assert_eq!(*simulation.solve(), Status::Converged, "{what}");
        let off = largest_distance(simulation.displacement(), solved(&scene).displacement());
        assert!(off < 1e-6, "{what}: {off}");
        // The reverse edit needs no other couplings.
        let system = simulation.system().clone();
        simulation.change_scene(&start).unwrap();
        assert!(Arc::ptr_eq(&system, simulation.system()), "{what}");
        assert_eq!(*simulation.solve(), Status::Converged);
        assert!((simulation.probe("tip").unwrap() - before.probe("tip").unwrap()).norm() < 1e-6);
    }
}

/// Exactly: near rest the residual shrinks with the forces that it is relative to, so that it never ends the iteration.
#[test]
fn a_body_whose_loads_vanish_returns_to_rest() {
    for (element, method) in ELEMENTS.iter().flat_map(|e| METHODS.iter().map(move |m| (e.kind, m.kind))) {
        for (id, force) in [("cantilever", [0.0, -3000.0]), ("cantilever", [900.0, -1300.0]), ("article", [5e3, 2e4])] {
            let mut body = Simulation::new(&scene(id).with_element(element).with_method(method)).unwrap();
            body.edit(|scene| scene.set_force(0, force)).unwrap();
            body.solve();
            body.edit(|scene| scene.set_force(0, [0.0; 2])).unwrap();
            let what = format!("{id} {element:?} {method:?} {force:?}");
            assert_eq!(*body.solve(), Status::Converged, "{what}");
            assert_eq!((largest(body.displacement()), body.residual()), (0.0, 0.0), "{what}");
        }
    }
}

/// Unchanged parts are not recomputed by an edit, and simulations share one system.
#[test]
fn equations_are_shared_and_kept() {
    let mut body = solved(&scene("cantilever"));
    let system = body.system().clone();
    body.edit(|scene| scene.set_force(0, [0.0, -1200.0])).unwrap();
    let mut material = body.scene().material;
    material.young *= 2.0;
    body.change_scene(&body.scene().clone().with_material(material)).unwrap();
    let mut other = body.scene().clone();
    other.solver.method = MethodKind::Newton;
    other.solver.tolerance = 1e-10;
    body.change_scene(&other).unwrap();
    assert!(Arc::ptr_eq(&system, body.system()));
    let ghost = other.clone().with_method(MethodKind::Linear);
    assert!(Arc::ptr_eq(&system, Simulation::with_system(&ghost, system.clone()).unwrap().system()));
    body.change_scene(&other.clone().with_cells(40, 4)).unwrap();
    assert!(!Arc::ptr_eq(&system, body.system()));
    fn shared_between_threads<T: Send + Sync>(_: &T) {}
    shared_between_threads(&body);
}

/// The next iteration is that of a copy, which has no matrix.
#[test]
fn an_edit_of_the_material_after_load_steps_discards_their_matrix() {
    let start = scene("column").with_method(MethodKind::Auto);
    let mut body = solved(&start);
    assert_eq!(body.equilibrium().unwrap().auto_report().unwrap().decision, Decision::LoadSteps);
    let mut copy = body.equilibrium().unwrap().snapshot();
    let mut material = start.material;
    material.young *= 1.2;
    for body in [&mut body, &mut copy] {
        body.change_scene(&body.scene().clone().with_material(material)).unwrap();
        assert_eq!(*body.step(), Status::Running);
        assert!(!body.is_linear());
    }
    assert!(copy.displacement() == body.displacement(), "the matrix is that of the last load step");
}

/// A mesh given by the caller is kept by every edit and never replaced by the scene's own.
#[test]
fn a_mesh_given_by_the_caller_is_kept_by_every_edit() {
    let scene = scene("elastica");
    let mesh = Mesh::beam(scene.beam.as_ref().unwrap()).unwrap();
    let finer = mesh.refined();
    let mut without_geometry = scene.clone();
    without_geometry.beam = None;
    for own in [scene, without_geometry] {
        let mut simulation = Simulation::with_mesh(&own, finer.clone()).unwrap();
        let dofs = simulation.system().dofs();
        simulation.solve();
        let edits: [&dyn Fn(&mut Scene); 6] = [
            &|s| s.set_force(0, [0.0, -1.0]).unwrap(),
            &|s| s.material.young *= 2.0,
            &|s| s.solver.method = MethodKind::Warped,
            &|s| s.loads.push(Load::moment("right", 5.0)),
            &|s| s.supports.remove(0).fix.clear(),
            &|s| s.beam.iter_mut().for_each(|beam| beam.cells = [2, 1]),
        ];
        for (i, edit) in edits.iter().enumerate() {
            let mut edited = simulation.scene().clone();
            edit(&mut edited);
            match simulation.change_scene(&edited) {
                Ok(()) => assert_ne!(i, 4, "a body that nothing holds"),
                Err(error) => assert_eq!(i, 4, "{error}"),
            }
            assert_eq!(simulation.system().dofs(), dofs, "edit {i}");
            assert_eq!(simulation.system().mesh(), &finer);
            assert_eq!(*simulation.solve(), Status::Converged, "edit {i}");
        }
    }
}

/// A mesh file is read once, when the scene is opened: edits work after the file has been deleted.
#[test]
fn a_mesh_file_is_read_once() {
    let folder = tempfile::tempdir().unwrap();
    let text = write_square(folder.path(), "load = [{ kind = \"force\", at = [1, 0], force = [0, -100] }]");
    let scene = Scene::from_toml_in(&text, folder.path()).unwrap();
    let refused = Simulation::new(&Scene::from_toml(&text).unwrap()).unwrap_err().to_string();
    assert!(refused.contains("square.msh") && refused.contains("open the scene from its folder"), "{refused}");
    let mut simulation = Simulation::new(&scene).unwrap();
    folder.close().unwrap();
    for element in scene.elements() {
        simulation.change_scene(&scene.clone().with_element(element)).unwrap();
        simulation.edit(|scene| scene.set_force(0, [0.0, 50.0])).unwrap();
        assert_eq!(*simulation.solve(), Status::Converged);
        assert!(largest(simulation.displacement()) > 0.0);
    }
}

/// A refused edit changes nothing.
#[test]
fn a_refused_edit_changes_nothing() {
    let mut simulation = solved(&scene("cantilever"));
    let (before, state) = (simulation.scene().clone(), simulation.state().clone());
    assert!(simulation.edit(|scene| scene.set_force(0, [f64::NAN, 0.0])).is_err());
    assert!(simulation.edit(|scene| scene.set_force(0, [0.0, 1e16])).is_err());
    assert!(simulation.edit(|scene| scene.set_force(7, [0.0, 1.0])).is_err());
    assert!(simulation.edit(|scene| scene.set_moment(0, 1.0)).is_err());
    assert!(simulation.edit(|scene| scene.set_gravity(0, [0.0, 1.0])).is_err());
    let mut material = before.material;
    material.poisson = 0.7;
    assert!(simulation.change_scene(&simulation.scene().clone().with_material(material)).is_err());
    assert!(simulation.change_scene(&before.clone().clamp("nowhere")).is_err());
    assert!(simulation.change_scene(&before.clone().with_cells(0, 1)).is_err());
    assert!(simulation.change_scene(&before.clone().probe("p", [99.0, 0.0])).is_err());
    assert_eq!((simulation.scene(), simulation.state(), simulation.status()), (&before, &state, &Status::Converged));
}

/// A snapshot keeps the state of a search at one instant, and can continue by itself to the same end.
#[test]
fn a_snapshot_is_unchanged_and_can_continue() {
    for method in METHODS.iter().map(|method| method.kind) {
        let mut search = Simulation::new(&scene("article").with_method(method)).unwrap();
        search.step();
        let mut copy = search.equilibrium().unwrap().snapshot();
        let seen = search.solution();
        assert_eq!(copy.solution(), seen, "{}", method.id());
        assert_eq!((copy.scene(), copy.state()), (search.scene(), search.state()));
        assert!(Arc::ptr_eq(copy.system(), search.system()));
        search.solve();
        assert_eq!(copy.solution(), seen, "{}: it follows", method.id());
        copy.solve();
        assert_eq!(copy.status(), search.status());
        let off = largest_distance(copy.displacement(), search.displacement());
        assert!(off <= 1e-6 * largest(search.displacement()), "{}: {off}", method.id());
        assert_eq!(copy.certify().stable, search.certify().stable, "{}", method.id());
        copy.edit(|scene| scene.set_force(0, [0.0, -1.0])).unwrap();
        assert_eq!(*copy.solve(), Status::Converged);
    }
    assert!(Simulation::new(&scene("swing")).unwrap().equilibrium().is_none(), "of a motion");
}
