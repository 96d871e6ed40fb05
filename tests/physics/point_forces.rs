//! Tests of forces at points inside elements: they have the resultant, the work and the effect of their point.

use nalgebra::Vector2;
use warpbeam::element::ELEMENTS;
use warpbeam::{Load, MethodKind, Place, Scene, Simulation, Status};

use crate::common::random::Random;
use crate::common::solved;

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

/// The key of scene files is read and written; it belongs to a force at a point alone.
#[test]
fn the_key_is_read_and_written() {
    let scene = Scene::beam(10.0, 1.0).clamp("left").point_force([3.3, 0.1], [0.0, -1.0]);
    let toml = scene.to_toml().unwrap();
    assert!(toml.contains("acts_on = \"point\""), "{toml}");
    assert_eq!(Scene::from_toml(&toml).unwrap(), scene);
    let Load::Force { place, at_point, .. } = &scene.loads[0] else { panic!("a force") };
    assert_eq!((place, *at_point), (&Place::At([3.3, 0.1]), true));
    let on_node = Scene::beam(10.0, 1.0).clamp("left").force([3.3, 0.1], [0.0, -1.0]).to_toml().unwrap();
    assert!(!on_node.contains("acts_on"), "{on_node}");
    let edge = toml.replace("at = [3.3, 0.1]", "edge = \"right\"");
    let error = Scene::from_toml(&edge).unwrap_err().to_string();
    assert!(error.contains("expected at = [x, y] with acts_on = \"point\" or a width, got an edge"), "{error}");
    let gravity = toml.replace("force = [0.0, -1.0]", "acceleration = [0.0, -1.0]").replace("\"force\"", "\"gravity\"");
    assert!(Scene::from_toml(&gravity).is_err());
    let mut simulation = Simulation::new(&scene).unwrap();
    assert_eq!(*simulation.solve(), Status::Converged);
}
