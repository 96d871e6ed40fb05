//! Tests of moving supports: their effect on the body, their reactions and work, and their errors.

use crate::common::*;
use warpbeam::method::{Workspace, is_stable};

/// Returns a beam clamped at both ends.
fn clamped() -> Scene {
    let mut scene = Scene::beam(10.0, 1.0).with_cells(16, 2).clamp("left").clamp("right").probe("middle", [5.0, 0.0]);
    scene.solver.tolerance = 1e-11;
    scene
}

/// Edges that are moved apart along x and together along y strain all elements equally, whatever their shape.
#[test]
fn moved_edges_strain_a_patch_uniformly() {
    let (a, b) = (0.03, -0.05);
    for (element, method) in pairs(ELEMENTS, METHODS) {
        let scene = Scene::beam(2.0, 1.0).with_cells(4, 3).with_element(element.kind).with_method(method.kind);
        let scene = scene.support("left", &[Axis::X]).support("bottom", &[Axis::Y]);
        let scene = scene.support("right", &[Axis::X]).moved([2.0 * a, 0.0], 0.0);
        let scene = scene.support("top", &[Axis::Y]).moved([0.0, b], 0.0);
        let mesh = Mesh::beam(scene.beam.as_ref().unwrap()).unwrap();
        // The cells have irregular shapes; the sides of the rectangle are unchanged.
        let mesh = mesh.moved(|x| {
            x + Vector2::new(0.06, 0.04) * ((PI * x.x / 2.0).sin() * (PI * (x.y + 0.5)).sin() * (1.0 + x.x * x.y))
        });
        let simulation = solved_on(&scene, mesh.unwrap());
        let (problem, state) = (simulation.problem(), simulation.state());
        let lame = problem.material().lame();
        let expected = Matrix2::new(a, 0.0, 0.0, b);
        let mut points = 0;
        let (u, rotations) = (state.displacement(), state.rotations());
        problem.system().elements().visit_strains(lame, u, rotations, &mut |_, _, strain| {
            assert!((strain - expected).amax() < 1e-9, "{} {}: {strain}", element.id, method.id);
            points += 1;
        });
        assert!(points >= 12);
        // Reactions are σ t times the length of the side.
        let stress = lame.stress(&expected);
        let [left, bottom, right, top] = [0, 1, 2, 3].map(|i| simulation.support_reactions()[i].force);
        assert!((right.x - stress.m11).abs() < 1e-8 * stress.m11.abs(), "{}: {right}", element.id);
        assert!((top.y - 2.0 * stress.m22).abs() < 1e-8 * stress.m22.abs(), "{}: {top}", element.id);
        assert!((left + right).norm() < 1e-8 * right.norm() && (bottom + top).norm() < 1e-8 * top.norm());
    }
}

/// If all supports rotate about one point, the body rotates with them without stress, by any angle.
#[test]
fn a_rigid_rotation_of_all_supports_leaves_no_stress() {
    let centre = Vector2::new(3.0, 2.0);
    for (element, method) in pairs(ELEMENTS, METHODS) {
        for angle in [0.4, 3.0, -7.0] {
            let mut scene = clamped().with_element(element.kind).with_method(method.kind);
            for (support, middle) in [Vector2::new(0.0, 0.0), Vector2::new(10.0, 0.0)].into_iter().enumerate() {
                let arm = middle - centre;
                let increment = match method.kind {
                    MethodKind::Linear => Vector2::new(-arm.y, arm.x) * angle,
                    _ => Rotation::from_angle(angle).apply(arm) - arm,
                };
                scene.move_support(support, increment, angle).unwrap();
            }
            let simulation = solved(&scene);
            let solution = simulation.solution();
            // Forces and energies are compared with those that a strain of about 1 would need.
            let scale = 1e6 * 10.0;
            assert!(solution.energy.elastic < 1e-18 * scale, "{} {}: {:?}", element.id, method.id, solution.energy);
            assert!(solution.supports.iter().all(|s| s.force.norm() < 1e-7 * scale), "{:?}", solution.supports);
            if method.kind == MethodKind::Linear {
                continue;
            }
            for (x, u) in simulation.system().mesh().nodes().iter().zip(simulation.displacement()) {
                let expected = Rotation::from_angle(angle).apply(x - centre) + centre - x;
                assert!((u - expected).norm() < 1e-9, "{} {} {angle}: {u} {expected}", element.id, method.id);
            }
            // The clamps move straight, so that the line through them makes no full turn, and the edges along it make none.
            let angles = simulation.state().edge_angles();
            assert!(angles.iter().all(|t| (0.5 * (t - angle)).sin().abs() < 1e-9), "{angles:?}");
        }
    }
}

/// A rotating clamp carries a cantilever along. Its weight then bends it like a cantilever built in that direction.
#[test]
fn a_rotated_clamp_equals_a_rotated_gravity() {
    for method in METHODS.iter().filter(|m| m.kind != MethodKind::Linear) {
        let mut straight = Scene::beam(10.0, 1.0).with_method(method.kind).clamp("left").probe("tip", "right");
        straight.solver.max_error_percent = 1e-6;
        let angle = 2.5;
        let weight = Vector2::new(0.0, -0.15);
        let turned = solved(&straight.clone().gravity(weight).moved([0.5, 0.25], angle));
        let built = solved(&straight.gravity(Rotation::from_angle(-angle).apply(weight)));
        let [turned, built] = [&turned, &built].map(|s| Vector2::new(10.0, 0.0) + s.probe("tip").unwrap());
        let expected = Rotation::from_angle(angle).apply(built) + Vector2::new(0.5, 0.25);
        assert!((turned - expected).norm() < 1e-5, "{}: {turned} {expected}", method.id);
    }
}

/// It winds up the beam, although the supports are where they are at rest.
#[test]
fn a_full_rotation_of_one_end_is_not_rest() {
    let mut scene = Scene::beam(20.0, 0.5).with_cells(40, 1).clamp("left").clamp("right");
    scene.move_support(1, [-8.0, 0.0], TAU).unwrap();
    let mut simulation = solved(&scene);
    let right = simulation.system().edges().iter().position(|e| e.name() == "right").unwrap();
    let turn = simulation.state().edge_angles()[right];
    assert!((turn - TAU).abs() < 1e-9, "{turn}");
    assert!(simulation.solution().energy.elastic > 10.0, "{:?}", simulation.solution().energy);
    assert!(simulation.equilibrium().unwrap().load_steps() > 6);
    let mut angle = TAU;
    while angle > 0.0 {
        angle = f64::max(angle - 0.4, 0.0);
        simulation.edit(|scene| scene.move_support(1, [-8.0 * angle / TAU, 0.0], angle)).unwrap();
        assert_eq!(*simulation.solve(), Status::Converged, "{angle}");
    }
    assert!(simulation.solution().energy.elastic < 1e-9);
}

/// The supports carry the loads, as forces and as moments.
#[test]
fn reactions_balance_the_loads() {
    for element in ELEMENTS {
        let mut scene = clamped().with_element(element.kind).gravity([0.0, -0.1]).force("top", [40.0, -30.0]);
        // A moment on a supported edge goes into its support.
        scene = scene.moment("right", 20.0);
        scene.move_support(1, [-0.3, 0.8], 0.4).unwrap();
        let simulation = solved(&scene);
        let solution = simulation.solution();
        let dead = simulation.problem().loads().dead_force();
        let nodes = simulation.system().mesh().nodes().iter().zip(simulation.displacement());
        let (mut force, mut moment) = (Vector2::zeros(), 20.0);
        for ((x, u), f) in nodes.zip(dead) {
            force += f;
            moment += (x + u).perp(f);
        }
        for support in &solution.supports {
            force += support.force;
            moment += support.middle.perp(&support.force) + support.moment;
        }
        let scale = solution.supports.iter().map(|s| s.force.norm()).sum::<f64>();
        assert!(force.norm() < 1e-7 * scale, "{}: {force}", element.id);
        assert!(moment.abs() < 1e-6 * scale, "{}: {moment}", element.id);
        let sum: Vector2<f64> = solution.supports.iter().map(|s| s.force).sum();
        assert!((sum - solution.reaction.force).norm() < 1e-9 * scale);
    }
}

/// The reaction force of a moved support displaces the free body by the same distance.
#[test]
fn displacement_control_agrees_with_force_control() {
    for (element, method) in pairs(ELEMENTS, [MethodKind::Linear, MethodKind::Newton, MethodKind::Auto]) {
        let tip = [10.0, 0.0];
        let mut beam = Scene::beam(10.0, 1.0).with_cells(10, 2).with_element(element.kind).with_method(method);
        (beam.solver.tolerance, beam.solver.max_error_percent) = (1e-12, 1e-6);
        let beam = beam.clamp("left").probe("tip", tip);
        let driven = solved(&beam.clone().support(tip, &[Axis::Y]).moved([0.0, -4.0], 0.0));
        let reaction = driven.support_reactions()[1].force;
        assert!(reaction.x == 0.0 && reaction.y < -100.0, "{reaction}");
        let [a, b] = [&driven, &solved(&beam.force(tip, reaction))].map(|s| s.probe("tip").unwrap());
        assert!((a.y + 4.0).abs() < 1e-12);
        assert!((a - b).norm() < 1e-6, "{} {}: {a} {b}", element.id, method.id());
    }
}

/// Returns a scene in which the right end is displaced and rotated at once.
fn wrenched(factor: f64) -> Scene {
    let mut scene = clamped();
    scene.move_support(1, [-2.0 * factor, 3.0 * factor], 1.2 * factor).unwrap();
    scene
}

/// Force and moment of a support are the derivatives of the energy with respect to its displacement and rotation.
#[test]
fn reactions_are_derivatives_of_the_energy() {
    const H: f64 = 1e-4;
    let at = |d: [f64; 2], turn: f64| {
        let mut scene = clamped();
        scene.move_support(1, d, turn).unwrap();
        solved(&scene).solution()
    };
    let ([x, y], turn) = ([-0.4, 1.5], 0.7);
    let reaction = &at([x, y], turn).supports[1];
    for (value, [dx, dy, dt]) in
        [(reaction.force.x, [H, 0.0, 0.0]), (reaction.force.y, [0.0, H, 0.0]), (reaction.moment, [0.0, 0.0, H])]
    {
        let [plus, minus] = [1.0, -1.0].map(|s| at([x + s * dx, y + s * dy], turn + s * dt).energy.elastic);
        let slope = (plus - minus) / (2.0 * H);
        assert!((value - slope).abs() < 1e-5 * reaction.force.norm(), "{value} {slope}");
    }
}

/// A dragged support gives the same result as a solve from rest; dragged back, the body is at rest again.
#[test]
fn dragged_supports_end_where_they_would_from_rest() {
    for method in METHODS {
        let scene = |y: f64| {
            let mut scene = clamped().with_method(method.kind);
            scene.solver.max_error_percent = 1e-6;
            scene.move_support(1, [0.0, y], 0.0).unwrap();
            scene
        };
        let mut dragged = solved(&scene(0.0));
        for y in [0.1, 0.4, 0.9, 0.3] {
            dragged.edit(|scene| scene.move_support(1, [0.0, y], 0.0)).unwrap();
            assert_eq!(*dragged.solve(), Status::Converged, "{} {y}", method.id);
            let [a, b] = [&dragged, &solved(&scene(y))].map(|s| s.probe("middle").unwrap());
            assert!((a - b).norm() < 1e-6, "{} {y}: {a} {b}", method.id);
        }
        dragged.edit(|scene| scene.move_support(1, [0.0, 0.0], 0.0)).unwrap();
        assert_eq!(*dragged.solve(), Status::Converged, "{}", method.id);
        assert!(dragged.displacement().iter().all(|u| u.norm() < 1e-7), "{}", method.id);
    }
}

/// `start_from` and a change of stiffness begin with the supports in their prescribed positions.
#[test]
fn other_starts_and_stiffnesses_end_in_the_same_place() {
    let mut simulation = solved(&wrenched(0.5));
    let expected = simulation.probe("middle").unwrap();
    simulation.change_scene(&simulation.scene().clone().with_material(Material::new(3e6, 0.3))).unwrap();
    assert_eq!(*simulation.solve(), Status::Converged);
    assert!((simulation.probe("middle").unwrap() - expected).norm() < 1e-6);
    let near: Vec<_> = simulation.displacement().iter().map(|u| u * 0.9).collect();
    simulation.start_from(&near).unwrap();
    assert_eq!(*simulation.solve(), Status::Converged);
    assert!((simulation.probe("middle").unwrap() - expected).norm() < 1e-6);
    let mut values = Vec::new();
    simulation.field(Field::VonMises, &mut values);
    assert!(values.iter().all(Option::is_some));
}

/// The limit load is that of beam theory. Beyond it the arch is unstable with a free crown, stable with a held one.
#[test]
fn the_arch_passes_its_limit_load() {
    let scene = scene("snap");
    let path = LoadPath::of(&scene, &go_on).unwrap();
    assert!(path.end.is_none() && path.jump.is_none());
    let pairs: Vec<[f64; 2]> = path.states.iter().map(|s| path.driven_pair(&scene, s).unwrap()).collect();
    // A parabola through the three highest points.
    let top = pairs[..30].iter().enumerate().max_by(|a, b| a.1[1].total_cmp(&b.1[1])).unwrap().0;
    let [a, b, c] = [0, 1, 2].map(|i| pairs[top - 1 + i][1]);
    let limit = b + (c - a).powi(2) / (8.0 * (2.0 * b - a - c));
    // Beam theory of small slopes, computed by `tests/data/shallow_arch.py`.
    let [expected, increment] = [80.765_927, 0.002_703_16];
    assert!((limit - expected).abs() < 0.005 * expected, "{limit} {expected}");
    assert!((pairs[top][0] - increment).abs() < 3e-4, "{} {increment}", pairs[top][0]);
    // The same scene with the crown free along its path.
    let mut free = scene.clone();
    free.supports[2] = Support::new(free.supports[2].place.clone(), &[Axis::X]);
    let free = Simulation::new(&free).unwrap();
    let (mut unstable, mut agree) = (0, 0);
    for state in &path.states {
        let mut part = scene.clone();
        part.scale_loads(state.factor);
        let held = solved(&part);
        let mut forces = Forces::new(held.displacement().len());
        let mut workspace = Workspace::new(free.system()).unwrap();
        let stable = is_stable(free.problem(), held.state(), 1.0, &mut forces, &mut workspace);
        agree += u32::from(state.stable == Some(stable));
        unstable += u32::from(!stable);
    }
    assert_eq!(agree as usize, path.states.len());
    assert!((20..50).contains(&unstable), "{unstable}");
}

/// Refusals of supports in scene files are in `tests/golden/texts.txt`.
#[test]
fn a_support_that_does_not_exist_cannot_move() {
    let mut beam = Scene::beam(10.0, 1.0).clamp("left");
    let missing = beam.move_support(3, [0.0, 0.0], 0.0);
    assert!(missing.is_err_and(|e| e.to_string().contains("support.3")));
    assert!(Simulation::new(&beam.force([10.4, 0.0], [0.0, 1.0])).is_ok(), "near a node");
    assert!(!Support::new("left", BOTH).moves());
}
