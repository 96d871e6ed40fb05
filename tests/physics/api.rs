//! Every public constructor with short, long, empty, non-finite and out-of-range input gives typed errors and no panic.

use crate::common::*;
use warpbeam::element::side_weights;
use warpbeam::format::{count, number};
use warpbeam::scene::open;
use warpbeam::solver::{Factor, Symbolic};
use warpbeam::study::LoadCurve;

const BAD: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];

#[test]
fn states_of_other_bodies_are_refused() {
    let mut simulation = solved(&scene("cantilever"));
    let nodes = simulation.displacement().len();
    let before = simulation.state().clone();
    for length in [0, 1, nodes - 1, nodes + 1] {
        let u = vec![Vector2::new(0.1, 0.1); length];
        let expected = StateError::Length { what: "displacements", expected: nodes, got: length };
        assert_eq!(simulation.start_from(&u), Err(expected));
        assert!(simulation.system().state_of(&u).is_err());
        assert!(before.with_displacement(u).is_err());
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let mut u = vec![Vector2::zeros(); nodes];
        u[3].x = bad;
        assert!(matches!(simulation.start_from(&u), Err(StateError::NotFinite { .. })));
        assert!(simulation.system().state_of(&u).is_err());
    }
    assert_eq!(*simulation.state(), before, "a refused state changes nothing");
    assert!(simulation.restore(Simulation::new(&scene("article")).unwrap().state()).is_err());
    // Huge, but finite: the solve ends with a status.
    simulation.start_from(&vec![Vector2::new(1e300, -1e300); nodes]).unwrap();
    simulation.solve();
    assert!(simulation.state().is_finite() && *simulation.status() != Status::Running);
}

#[test]
fn scenes_in_code_are_checked_where_they_are_simulated() {
    let good = || Scene::beam(4.0, 1.0).clamp("left").force("right", [0.0, -1.0]).probe("tip", "right");
    assert!(Simulation::new(&good()).is_ok());
    let mut wrong: Vec<Scene> = vec![
        Scene::named("no mesh").clamp("left"),
        Scene::named(" "),
        Scene::beam(4.0, 1.0),
        Scene::beam(4.0, 1.0).support("left", &[]),
        Scene::beam(4.0, 1.0).support("left", &[Axis::X]),
        Scene::beam(4.0, 1.0).support([0.0, 0.0], &[Axis::X, Axis::Y]),
        Scene::beam(0.0, 1.0).clamp("left"),
        Scene::beam(1.0, -1.0).clamp("left"),
        good().force("nowhere", [1.0, 0.0]),
        good().probe("p", "nowhere"),
        good().probe("p", [5.0, 0.0]),
        good().with_material(Material::new(0.0, 0.3)),
        good().with_material(Material::new(1e6, 0.51)),
        good().with_material(Material { thickness: 0.0, ..Material::default() }),
        good().with_material(Material { density: -1.0, ..Material::default() }),
    ];
    wrong.extend(["nowhere", ""].into_iter().flat_map(|edge| [good().clamp(edge), good().moment(edge, 1.0)]));
    wrong.extend(
        [[0, 1], [1, 0], [u32::MAX, 1], [100_000, 100_000]].map(|[along, across]| good().with_cells(along, across)),
    );
    let edges = ["left", "right", "top", "bottom"];
    let all = edges.iter().fold(Scene::beam(1.0, 1.0).with_cells(1, 1), |scene, edge| scene.clamp(*edge));
    wrong.push(all.with_element(ElementKind::T3));
    for bad in BAD {
        wrong.extend([
            Scene::beam(bad, 1.0).clamp("left"),
            Scene::beam(1.0, bad).clamp("left"),
            good().force("right", [bad, 0.0]),
            good().force([bad, 0.0], [1.0, 0.0]),
            good().gravity([0.0, bad]),
            good().moment("right", bad),
            good().probe("p", [0.0, bad]),
            good().support([bad, 0.0], &[Axis::X]),
            good().with_material(Material::new(bad, 0.3)),
            good().with_material(Material::new(1e6, bad)),
        ]);
    }
    let mesh = Mesh::beam(good().beam.as_ref().unwrap()).unwrap();
    let system = solved(&good()).system().clone();
    for scene in wrong {
        let error = Simulation::new(&scene).map(|_| ()).unwrap_err();
        let SimulationError::Scene(invalid) = &error else { panic!("{scene:?}: {error}") };
        assert!(invalid.message().starts_with("expected "), "{scene:?}: {error}");
        assert_eq!(error.to_string(), format!("{}: {}", invalid.key, invalid.message()));
        assert!(Simulation::with_system(&scene, system.clone()).is_err());
        assert!(Problem::new(&scene, system.clone()).is_err());
        assert!(Reference::of(&scene).is_err());
        assert!(LoadCurve::new(&scene).is_none(), "{scene:?}");
        // With another mesh, the scene's own geometry is not used; everything else is validated.
        if scene.validate().is_err() && Simulation::with_mesh(&scene, mesh.clone()).is_ok() {
            let of_geometry = |e: String| e.starts_with("beam") || e.starts_with("mesh");
            assert!(of_geometry(scene.validate().unwrap_err().to_string()), "{scene:?}");
        }
        assert!(solved(&good()).change_scene(&scene).is_err(), "{scene:?}");
    }
}

/// A scene of builder calls is the scene of the file that sets the same keys.
#[test]
fn builders_set_what_a_file_sets() {
    let material = Material { plane: Plane::Strain, thickness: 0.2, density: 7.0, ..Material::new(1e5, 0.2) };
    let mut rest = Scene::beam(10.0, 0.7)
        .with_cells(7, 2)
        .with_rise(0.5)
        .with_element(ElementKind::T3)
        .with_diagonals(Diagonals::Same)
        .with_material(material)
        .with_method(MethodKind::Auto)
        .clamp("left")
        .moved([-0.1, 0.2], 0.3)
        .support("right", &[Axis::Y])
        .point_support([5.1, 0.8], &[Axis::X])
        .force("top", [1.0, 2.0])
        .point_force([2.3, 0.1], [3.0, 4.0])
        .moment("right", 5.0)
        .gravity([0.0, -6.0])
        .probe("tip", "right")
        .section([4.0, 0.5], 0.1);
    rest.name = "all".to_owned();
    assert_eq!(rest, Scene::from_toml(include_str!("../data/files/all-keys.toml")).unwrap());
    let mut moving = Scene::mesh_file("../meshes/cook.msh", "").unwrap().with_scale(0.01).gravity([0.0, -1.0]);
    moving = moving.pulse(0.1, 0.2).moving(IntegratorKind::ImplicitEuler, 0.05).starting([0.3, 0.4], 0.5);
    let file = format!(
        "name = '{}'\nanalysis = 'dynamic'\n[mesh]\nfile = '../meshes/cook.msh'\nscale = 0.01\n[material]\nyoung = {}\npoisson = {}\n\
         [[load]]\nkind = 'gravity'\nacceleration = [0, -1]\npulse = {{ start = 0.1, duration = 0.2 }}\n\
         [dynamics]\nintegrator = 'implicit-euler'\ntime_step = 0.05\n[start]\nvelocity = [0.3, 0.4]\nspin = 0.5\n",
        moving.name, moving.material.young, moving.material.poisson
    );
    assert_eq!(moving, Scene::from_toml_in(&file, "".as_ref()).unwrap());
    assert!(Scene::mesh_file("nowhere.msh", "").unwrap_err().to_string().contains("nowhere.msh"));
}

#[test]
fn setters_name_missing_loads() {
    let mut scene = Scene::beam(4.0, 1.0).clamp("left").force("right", [0.0, -1.0]).moment("right", 2.0);
    scene.set_force(0, [1.0, 2.0]).unwrap();
    scene.set_moment(1, 3.0).unwrap();
    for (error, words) in [
        (scene.set_force(1, [0.0; 2]), "load.1: expected a load of kind \"force\", got a moment"),
        (scene.set_force(2, [0.0; 2]), "load.2: expected a load of kind \"force\", got no load"),
        (scene.set_moment(0, 0.0), "load.0: expected a load of kind \"moment\", got a force"),
        (scene.set_gravity(usize::MAX, [0.0; 2]), "got no load"),
    ] {
        let text = error.unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn invalid_sources_and_assignments_are_refused() {
    for name in ["", "no-such-scene", "/", "\0", "assets"] {
        assert!(open(&Source { name: name.into(), assignments: Vec::new() }).is_err(), "{name:?}");
    }
    for assignment in ["", "=", "a", "a=", ".=1", "load.0=1", "load.-1.force=[0,1]", "load.99999999999999999999.x=1"] {
        let source = Source { name: "article".into(), assignments: vec![assignment.to_owned()] };
        assert!(open(&source).is_err(), "{assignment:?}");
    }
    for text in ["", "name", "[beam]", "name = 1", "\u{0}", "name = \"x\""] {
        assert!(Scene::from_toml(text).is_err() && Scene::from_toml_in(text, "/nowhere".as_ref()).is_err());
    }
}

#[test]
fn meshes_solvers_rotations_and_formats_take_any_number() {
    let mesh = Mesh::beam(Scene::beam(2.0, 1.0).beam.as_ref().unwrap()).unwrap();
    for bad in BAD {
        assert_eq!(mesh.locate(Vector2::new(bad, 0.0)), None);
        assert!((mesh.nearest_node(Vector2::new(bad, 0.0)) as usize) < mesh.nodes().len());
    }
    assert_eq!(mesh.weights(MaterialPoint { element: usize::MAX, at: [0.0; 2] }), None);
    assert_eq!(mesh.edge_nodes(""), None);
    assert!(matches!(mesh.clone().moved(|_| Vector2::zeros()), Err(MeshError::Degenerate { element: 0, .. })));
    assert_eq!(side_weights(&[]), Vec::<f64>::new());
    assert_eq!(side_weights(&[Vector2::zeros()]), [0.0]);
    for element in ELEMENTS {
        assert_eq!(element.nodal_areas(&[]), Vec::<f64>::new());
        assert_eq!(element.jacobian(&[], [0.1, 0.1]), Matrix2::zeros());
        assert!(matches!(Mesh::from_gmsh("", element.kind), Err(GmshError::Syntax { line: 1, .. })));
    }
    let empty = Symbolic::new(&[0], &[]).unwrap();
    assert_eq!(empty.size(), 0);
    let mut factor = Factor::new(&empty).unwrap();
    assert!(factor.factorize(&[]).is_ok());
    factor.solve_in_place(&mut []);
    let mut factor = Factor::new(&Symbolic::new(&[0, 1], &[0]).unwrap()).unwrap();
    for singular in [0.0, -1.0, f64::NAN] {
        assert!(factor.factorize(&[singular]).is_err(), "{singular}");
    }
    assert!(!factor.factorize_symmetric(&[-4.0]));
    let mut b = [2.0];
    factor.solve_in_place(&mut b);
    assert_eq!(b, [-0.5]);
    for (bad, word) in BAD.into_iter().zip(["NaN", "inf", "-inf", "1e300", "-1e300"]) {
        let rotation = polar(&Matrix2::new(bad, 0.0, 0.0, 1.0));
        assert_eq!(rotation, bad.is_finite().then_some(Rotation { c: bad.signum(), s: 0.0 }), "{bad}");
        assert_eq!(Rotation::from_angle(bad).angle().is_finite(), bad.is_finite(), "{bad}");
        assert_eq!(number(bad), word);
    }
    assert_eq!([0_u32, 1, 2].map(|n| count(n, "step").to_string()), ["0 steps", "1 step", "2 steps"]);
}

#[test]
fn a_scene_without_probes_has_a_result_and_no_reference() {
    let scene = Scene::beam(4.0, 1.0).clamp("left").force("right", [0.0, -1.0]).with_method(MethodKind::Auto);
    assert!(solved(&scene).solution().probes.is_empty());
    assert!(Reference::of(&scene).is_err());
}
