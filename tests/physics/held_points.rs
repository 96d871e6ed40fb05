//! Tests of supports and forces at points between nodes: their points stay, and statics, work and motion are those of the
//! points.

use crate::common::*;
use warpbeam::study::moved_points;

/// Returns a beam on two supports at points, a pin and a roller, with a force on its right end.
fn on_two_points([pin, roller]: [[f64; 2]; 2], force: Vector2<f64>) -> Scene {
    let mut scene = Scene::beam(10.0, 1.0).with_cells(9, 2).force("right", force);
    scene = scene.point_support(pin, BOTH).point_support(roller, &[Axis::Y]);
    scene.solver.tolerance = 1e-12;
    scene.probe("pin", pin).probe("roller", roller).probe("tip", "right")
}

/// Points that hold a determinate beam lie in a cell, on a side, two in one cell, or side by side, on every element.
#[test]
fn points_stay_and_their_reactions_are_those_of_statics() {
    let mut random = Random(7);
    for (entry, method) in ELEMENTS.iter().flat_map(|e| [MethodKind::Linear, MethodKind::Newton].map(|m| (e, m))) {
        let mut pairs = vec![
            [[3.0, 0.1], [8.0, -0.3]],
            [[3.4, 0.5], [9.1, -0.5]],
            [[3.5, 0.3], [4.2, 0.1]],
            [[3.2, 0.2], [4.6, 0.2]],
        ];
        pairs.extend((0..3).map(|_| {
            let mut at = |from: f64| [random.between(from, from + 3.0), random.between(-0.5, 0.5)];
            [at(0.5), at(5.0)]
        }));
        for points in pairs {
            let force = Vector2::new(200.0, -300.0) * if method == MethodKind::Linear { 1.0 } else { 3.0 };
            let simulation = solved(&on_two_points(points, force).with_method(method));
            let [pin, roller, tip] = ["pin", "roller", "tip"].map(|name| simulation.probe(name).unwrap());
            let name = format!("{} {method:?} {points:?}", entry.id);
            assert!(pin.norm().max(roller.y.abs()) < 1e-13 * tip.norm(), "{name}: {pin} {roller}");
            let [a, b] = [0, 1].map(|i| simulation.support_reactions()[i].clone());
            assert_eq!((a.moment, b.moment, b.force.x), (0.0, 0.0, 0.0), "{name}");
            assert!((a.force + b.force + force).norm() < 1e-8 * force.norm(), "{name}: {} {}", a.force, b.force);
            let now = |u: Vector2<f64>| if method == MethodKind::Linear { Vector2::zeros() } else { u };
            let [at_pin, at_roller] = points.map(Vector2::from);
            let arm = Vector2::new(10.0, 0.0) + now(tip) - at_pin;
            let expected = -arm.perp(&force) / (at_roller + now(roller) - at_pin).x;
            // The traction on the edge has a moment about its middle where the edge is strained along itself.
            assert!((b.force.y - expected).abs() < 1e-4 * expected.abs(), "{name}: {} {expected}", b.force.y);
            let total = simulation.solution().reaction;
            assert!((total.force + force).norm() < 1e-8 * force.norm(), "{name}: {}", total.force);
        }
    }
}

/// The tangent over the free unknowns is the derivative of the forces on them.
#[test]
fn the_tangent_is_the_derivative_of_the_forces() {
    for entry in ELEMENTS {
        let scene = on_two_points([[3.5, 0.3], [4.2, 0.1]], Vector2::new(1e3, -3e3)).with_element(entry.kind);
        let simulation = Simulation::new(&scene.clamp("left")).unwrap();
        let (problem, system) = (simulation.problem(), simulation.system());
        let mut random = Random(3);
        let place: Vec<f64> = (0..system.dofs()).map(|_| random.between(-0.05, 0.05)).collect();
        let mut u = vec![Vector2::zeros(); system.mesh().nodes().len()];
        system.pattern().add_free(&place, 1.0, &mut u);
        let state = system.state_of(&u).unwrap();
        let (exact, _) = dense(problem, &state, Tangent::EXACT);
        let off = (numeric_stiffness(problem, &state, 1.0, 1e-6) - &exact).amax();
        assert!(off < 1e-6 * exact.amax(), "{}: {off} of {}", entry.id, exact.amax());
    }
}

/// A point outside the body is the nearest node and says so; the reference is of the point itself.
#[test]
fn nodes_and_points_agree_where_they_are_one() {
    let force = [0.0, -2e3];
    let beam = Scene::beam(10.0, 1.0).with_cells(20, 2).clamp("left").probe("tip", "right");
    let bent = beam.clone().force("right", force);
    let tip = |scene: &Scene| solved(scene).probe("tip").unwrap();
    let moved = |scene: &Scene| moved_points(scene, Simulation::new(scene).unwrap().mesh()).len();
    // Puts a support or a force on a scene, at the point itself or at its node.
    type Put<'a> = &'a dyn Fn(Scene, [f64; 2], bool) -> Scene;
    let hold: Put<'_> = &|scene, at, at_point| match at_point {
        true => scene.point_support(at, &[Axis::Y]),
        false => scene.support(at, &[Axis::Y]),
    };
    let pull: Put<'_> =
        &|scene, at, at_point| if at_point { scene.point_force(at, force) } else { scene.force(at, force) };
    for (scene, put, close) in [(bent, hold, 2e-3), (beam, pull, 1e-3)] {
        let at = |place: [f64; 2], at_point: bool| put(scene.clone(), place, at_point);
        let [node, point, outside] = [at([7.5, 0.5], false), at([7.5, 0.5], true), at([7.5, 0.6], true)]
            .map(|scene| (tip(&scene), moved(&scene)));
        for off in [point.0 - node.0, outside.0 - node.0] {
            assert!(off.norm() < 1e-9 * node.0.norm(), "{off}");
        }
        // Between two nodes the nearest one is .2 m away.
        let between = [7.7, 0.25];
        assert_eq!([outside.1, moved(&at(between, true)), moved(&at(between, false))], [1, 0, 1]);
        // The same on a mesh with a node there.
        let fine = put(scene.clone().with_cells(200, 20).with_element(ElementKind::T6), between, false);
        let reference = Reference::of(&at(between, true)).unwrap().first().unwrap();
        let off = (reference.displacement - tip(&fine)).norm() / tip(&fine).norm();
        assert!(off < close, "{off}");
    }
}

/// The work along the path is the elastic energy; with all points moved alike there is none.
#[test]
fn moved_points_do_the_work_that_is_stored() {
    let beam = || Scene::beam(10.0, 1.0).with_cells(9, 2).with_element(ElementKind::Q4);
    let moved = |scene: Scene, at: [f64; 2], by: [f64; 2]| scene.point_support(at, BOTH).moved(by, 0.0);
    let rigid =
        [[1.3, 0.2], [4.4, -0.1], [8.7, 0.3]].into_iter().fold(beam(), |scene, at| moved(scene, at, [0.4, -0.7]));
    let simulation = solved(&rigid);
    assert!(simulation.solution().energy.elastic < 1e-12);
    let far = simulation.displacement().iter().map(|u| (u - Vector2::new(0.4, -0.7)).norm()).fold(0.0, f64::max);
    assert!(far < 1e-9, "{far}");
    const STEPS: u32 = 24;
    let to = Vector2::new(-0.5, -3.0);
    let bent = |factor: f64| {
        let scene = moved(beam().clamp("left"), [8.7, 0.3], (to * factor).into()).probe("point", [8.7, 0.3]);
        let mut scene = scene.with_method(MethodKind::Newton);
        scene.solver.tolerance = 1e-11;
        scene
    };
    let mut simulation = solved(&bent(0.0));
    let mut power = Vec::new();
    for step in 0..=STEPS {
        simulation.change_scene(&bent(f64::from(step) / f64::from(STEPS))).unwrap();
        assert_eq!(*simulation.solve(), Status::Converged);
        power.push(simulation.support_reactions()[1].force.dot(&to));
    }
    assert!((simulation.probe("point").unwrap() - to).norm() < 1e-12);
    let work: f64 = power.windows(3).step_by(2).map(|p| (p[0] + 4.0 * p[1] + p[2]) / (3.0 * f64::from(STEPS))).sum();
    let energy = simulation.solution().energy.elastic;
    assert!((work - energy).abs() < 1e-4 * energy, "{work} {energy}");
    let direct = solved(&bent(1.0)).solution().energy.elastic;
    assert!((direct - energy).abs() < 1e-8 * energy, "{direct} {energy}");
}

/// Supports that hold a point twice agree or are refused, and a single pin does not hold a body.
#[test]
fn points_held_twice_agree_or_are_refused() {
    let beam =
        || Scene::beam(10.0, 1.0).with_cells(9, 2).clamp("left").force("right", [0.0, -1e3]).probe("tip", "right");
    let tip = |scene: &Scene| solved(scene).probe("tip").unwrap();
    let plain = tip(&beam());
    assert!((tip(&beam().point_support([0.0, 0.1], BOTH)) - plain).norm() < 1e-12 * plain.norm());
    let held = beam().point_support([6.1, 0.1], BOTH);
    let twice = held.clone().point_support([6.1, 0.1], BOTH);
    assert!((tip(&held) - tip(&twice)).norm() < 1e-9 * tip(&held).norm());
    let error = |scene: &Scene| Simulation::new(scene).map(drop).unwrap_err().to_string();
    for torn in [beam().point_support([0.0, 0.1], BOTH), twice] {
        let message = error(&torn.moved([0.1, 0.0], 0.0));
        assert!(message.contains("expected the displacement that other supports give this point"), "{message}");
    }
    let loose = error(&Scene::beam(10.0, 1.0).with_cells(9, 2).point_support([5.1, 0.1], BOTH));
    assert!(loose.contains("the body can still move freely"), "{loose}");
}

/// The shear force jumps at the point itself, by its reaction, also inside a cell.
#[test]
fn section_forces_jump_at_the_point() {
    let scene = on_two_points([[3.4, 0.1], [8.1, -0.3]], Vector2::new(0.0, -300.0)).with_method(MethodKind::Newton);
    let simulation = solved(&scene);
    let reactions: Vec<f64> = simulation.support_reactions().iter().map(|reaction| reaction.force.y).collect();
    for (i, x) in [3.4, 8.1].into_iter().enumerate() {
        let force = |x: f64| simulation.section(SectionLine { at: [x, 0.0].into(), angle: 0.0 }).unwrap().force.y;
        let jump = force(x - 1e-4) - force(x + 1e-4);
        assert!((jump - reactions[i]).abs() < 1e-7 * reactions[i].abs(), "{jump} {}", reactions[i]);
    }
    let behind = simulation.section(SectionLine { at: [3.3, 0.0].into(), angle: 0.0 }).unwrap().force;
    assert!(behind.norm() < 1e-7 * 300.0, "{behind}");
}

/// The held point rests, and the motion is that of a physical pendulum, with every integrator.
#[test]
fn a_body_swings_about_its_point() {
    use IntegratorKind::{EnergyMomentum, ImplicitEuler, SymplecticEuler, TrBdf2};
    for integrator in [ImplicitEuler, TrBdf2, EnergyMomentum, SymplecticEuler] {
        let (step, iterations) = if integrator == SymplecticEuler { (2e-5, 1) } else { (1e-3, 0) };
        let mut scene = Scene::beam(2.0, 0.2).with_cells(9, 2).with_element(ElementKind::Q4);
        scene = scene.with_material(Material::new(2e7, 0.3)).point_support([0.13, 0.03], BOTH);
        scene = scene.gravity([0.0, -9.81]).probe("point", [0.13, 0.03]).moving(integrator, step);
        (scene.dynamics.iterations, scene.dynamics.duration) = (iterations, 0.3);
        let simulation = run(&scene);
        let point = simulation.probe("point").unwrap();
        assert!(point.norm() < 1e-9, "{integrator:?}: {point}");
        // A rigid body about the point: φ'' = g × d / (I/m), integrated in small steps.
        let arm = Vector2::new(1.0, 0.0) - Vector2::new(0.13, 0.03);
        let inertia = (4.0 + 0.04) / 12.0 + arm.norm_squared();
        let (mut angle, mut rate, h) = (0.0_f64, 0.0, 1e-5);
        for _ in 0..30_000 {
            let (s, c) = angle.sin_cos();
            rate += h * -9.81 * (c * arm.x - s * arm.y) / inertia;
            angle += h * rate;
        }
        let centre = simulation.positions().sum::<Vector2<f64>>() / simulation.positions().len() as f64;
        let (s, c) = angle.sin_cos();
        let expected = Vector2::new(0.13, 0.03) + Vector2::new(c * arm.x - s * arm.y, s * arm.x + c * arm.y);
        assert!((centre - expected).norm() < 0.01, "{integrator:?}: {centre} {expected}");
    }
}

/// The key `acts_on` of an edge is refused, as `tests/golden/texts.txt` shows.
#[test]
fn scene_files_have_the_point_of_a_support() {
    let scene = on_two_points([[3.4, 0.1], [8.1, -0.3]], Vector2::new(0.0, -300.0));
    let toml = scene.to_toml().unwrap();
    assert_eq!(toml.matches("acts_on = \"point\"").count(), 2, "{toml}");
    assert_eq!(Scene::from_toml(&toml).unwrap().supports, scene.supports);
    assert_eq!(scene.supports[0], Support::point([3.4, 0.1], BOTH));
    assert_eq!(scene.supports[0].place, Place::At([3.4, 0.1]));
    // Scene files have the point of a load, too.
    let [point, node] =
        [Load::point_force([3.3, 0.1], [0.0, -1.0]), Load::force([3.3, 0.1], [0.0, -1.0])].map(|load| {
            let mut scene = Scene::beam(10.0, 1.0).clamp("left");
            scene.loads.push(load);
            scene.to_toml().unwrap()
        });
    assert!(point.contains("acts_on = \"point\"") && !node.contains("acts_on"), "{point} {node}");
}

/// A width of the outline, also at a corner, or of a line in the body has a limit on finer meshes; a point has none.
#[test]
fn widths_have_a_limit_on_finer_meshes() {
    let on_two = |width: f64, at: [[f64; 2]; 3]| {
        let scene = Scene::beam(10.0, 1.0).point_support(at[0], BOTH).point_support(at[1], &[Axis::Y]);
        let scene = scene.point_force(at[2], [0.0, -1000.0]).with_widths(width).probe("middle", [5.0, 0.0]);
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
        scene
    };
    let below = [[0.5, -0.5], [9.5, -0.5], [5.0, 0.5]];
    let steps = [0.0, 0.1].map(|width| {
        let middle = |across: u32| {
            let scene = on_two(width, below).with_element(ElementKind::T6).with_cells(10 * across, across);
            solved(&scene.with_method(MethodKind::Linear)).probe("middle").unwrap().y
        };
        let [a, b, c] = [4, 8, 16].map(middle);
        (c - b) / (b - a)
    });
    assert!(steps[0] > 0.8 && steps[1] < 0.7, "{steps:?}");
    for at in [below, [[0.5, 0.1], [9.5, -0.2], [4.9, 0.3]], [[0.0, -0.5], [10.0, -0.5], [5.0, 0.5]]] {
        let scene = on_two(0.1, at).with_element(ElementKind::Q4).with_cells(20, 2);
        let reference = Reference::of(&scene).unwrap().first().unwrap();
        let u = solved(&scene).probe("middle").unwrap();
        let (error, own) = ((u - reference.displacement).norm() / u.norm(), reference.own_error_percent);
        assert!(error < 0.02 && own < 1.0, "{at:?}: {error}, {own} %");
        let [pin, roller] = [0, 1].map(|i| solved(&scene).support_reactions()[i].force.y);
        assert!((pin + roller - 1000.0).abs() < 1e-6, "{pin} {roller}");
    }
}

/// The moment is taken about the point at rest in linear theory, about the moved one in large rotations.
#[test]
fn a_clamp_balances_the_force_at_its_point() {
    let force = Vector2::new(1.0, -3.0);
    let mut random = Random(14);
    for (entry, method) in ELEMENTS.iter().flat_map(|e| [MethodKind::Linear, MethodKind::Warped].map(|m| (e, m))) {
        let mut points = vec![[3.0, 0.1], [3.4, 0.5], [4.0, 0.0]];
        points.extend((0..5).map(|_| [random.between(0.2, 9.9), random.between(-0.5, 0.5)]));
        for at in points {
            let factor = if method == MethodKind::Linear { 1.0 } else { 200.0 };
            let mut scene = Scene::beam(10.0, 1.0).with_cells(9, 2).with_element(entry.kind).with_method(method);
            scene = scene.clamp("left").point_force(at, force * factor).probe("point", at);
            scene.solver.tolerance = 1e-12;
            let simulation = solved(&scene);
            let reaction = &simulation.support_reactions()[0];
            assert!((reaction.force + force * factor).norm() < 1e-8 * factor, "{at:?}: {}", reaction.force);
            let moved =
                if method == MethodKind::Linear { Vector2::zeros() } else { simulation.probe("point").unwrap() };
            let moment = -(Vector2::from(at) + moved).perp(&(force * factor));
            let off = (reaction.moment - moment).abs();
            assert!(off < 1e-7 * moment.abs().max(factor), "{} at {at:?}: {off} N m off", entry.kind.entry().id);
            let work = force.dot(&simulation.probe("point").unwrap()) * factor;
            let own = simulation.solution().energy.external;
            assert!((work - own).abs() < 1e-9 * work.abs(), "{own} instead of {work} J");
        }
    }
}
