//! After the first few steps nothing is allocated by a time step under every integrator, an iteration of every method,
//! an edit of a force, or a pull of the mouse spring.

use crate::common::motion::grab;
use crate::common::*;
use allocation_counter::measure;

/// Number of first steps that may allocate, because some memory is allocated on first use.
const FIRST: u32 = 3;

fn allocations(mut work: impl FnMut()) -> u64 {
    measure(&mut work).count_total
}

#[test]
fn time_steps_allocate_nothing() {
    for id in ids_of(Analysis::Dynamic) {
        for (integrator, element) in pairs(IntegratorKind::all().map(IntegratorKind::entry), ELEMENTS) {
            for (iterations, method) in [(1, MethodKind::Newton), (0, MethodKind::Newton), (1, MethodKind::Linear)] {
                let mut scene = scene(id);
                scene.set_element(element.kind);
                (scene.dynamics.integrator, scene.dynamics.iterations) = (integrator.kind, iterations);
                scene.solver.method = method;
                if integrator.is_explicit() {
                    scene.dynamics.time_step =
                        0.5 * Simulation::new(&scene).unwrap().motion().unwrap().critical_step().unwrap();
                }
                let mut simulation = Simulation::new(&scene).unwrap();
                (0..FIRST).for_each(|_| drop(simulation.step().clone()));
                let made = allocations(|| (0..20).for_each(|_| drop(simulation.step().clone())));
                assert_eq!(made, 0, "{id} {} {} {iterations} {method:?}", integrator.id, element.id);
                let node = simulation.mesh().nodes()[1];
                grab(&mut simulation, node);
                (0..FIRST).for_each(|_| drop(simulation.step().clone()));
                let mut place = simulation.mouse_spring().unwrap().0.target();
                let made = allocations(|| {
                    for _ in 0..10 {
                        place += Vector2::new(1e-4, 2e-4);
                        simulation.pull_to(place).unwrap();
                        simulation.step();
                    }
                });
                assert_eq!(made, 0, "{id} {} {} with a hand", integrator.id, element.id);
            }
        }
    }
}

#[test]
fn iterations_allocate_nothing() {
    for (method, element) in METHODS.iter().flat_map(|m| ELEMENTS.iter().map(move |e| (m, e))) {
        let mut scene = scene("cantilever");
        scene.set_element(element.kind);
        scene.solver.method = method.kind;
        let mut simulation = ended(&scene);
        for force in [900.0, 920.0, 600.0] {
            simulation.edit(|scene| scene.set_force(0, [0.0, -force])).unwrap();
            simulation.solve();
        }
        simulation.edit(|scene| scene.set_force(0, [0.0, -950.0])).unwrap();
        let made = allocations(|| (0..4).for_each(|_| drop(simulation.step().clone())));
        assert_eq!(made, 0, "{} {}", method.kind.id(), element.id);
    }
}
