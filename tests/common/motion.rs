//! Functions shared by tests of dynamics.

use warpbeam::assembly::Mass;

use super::*;

/// Returns a built-in scene with another integrator, time step, number of solves per step and duration.
pub fn with(id: &str, kind: IntegratorKind, time_step: f64, iterations: u32, duration: f64) -> Scene {
    let mut scene = scene(id);
    (scene.dynamics.integrator, scene.dynamics.time_step) = (kind, time_step);
    (scene.dynamics.iterations, scene.dynamics.duration) = (iterations, duration);
    scene
}

/// Holds the body with the mouse spring at a point.
pub fn grab(simulation: &mut Simulation, at: Vector2<f64>) {
    assert!(simulation.grab(simulation.mesh().locate(at).unwrap()));
}

pub fn drift(simulation: &Simulation) -> f64 {
    simulation.motion().unwrap().ledger().drift()
}

pub fn momentum(simulation: &Simulation) -> Momentum {
    simulation.motion().unwrap().momentum()
}

/// Returns a small body at the start of its slowest vibration about rest, from the matrices of linear theory and the
/// integrator's mass matrix, with an amplitude of 1 mm; and the angular frequency, rad/s.
pub fn vibrating(scene: &Scene) -> (Simulation, f64) {
    let mut simulation = Simulation::new(scene).unwrap();
    let system = simulation.system();
    let (n, nodes) = (system.dofs(), system.mesh().nodes().len());
    let mass = Mass::new(system, scene.material.area_density());
    let (stiffness, _) = dense(simulation.problem(), &system.at_rest(), Tangent::WARPED);
    let inertia = columns(simulation.problem(), |unit, image| {
        let (mut nodal, mut moved) = (vec![Vector2::zeros(); nodes], vec![Vector2::zeros(); nodes]);
        system.pattern().add_free(unit, 1.0, &mut nodal);
        // Explicit integrators have lumped masses.
        if scene.dynamics.integrator.entry().is_explicit() {
            moved = nodal.iter().zip(&mass.lumped).map(|(v, m)| v * *m).collect();
        } else {
            mass.multiply(&nodal, &mut moved);
        }
        system.pattern().restrict(&moved, image);
    });
    // Inverse iteration.
    let cholesky = stiffness.cholesky().unwrap();
    let (mut mode, mut growth) = (DVector::from_element(n, 1.0), 1.0);
    for _ in 0..60 {
        mode = cholesky.solve(&(&inertia * mode));
        growth = mode.amax();
        mode /= growth;
    }
    let mut u = vec![Vector2::zeros(); nodes];
    system.pattern().add_free(mode.as_slice(), 1e-3, &mut u);
    simulation.start_from(&u).unwrap();
    (simulation, 1.0 / growth.sqrt())
}

pub fn beam(cells: u32, slenderness: f64) -> Scene {
    let beam = Scene::beam(1.0, 1.0 / slenderness).with_cells(cells, 1).clamp("left").probe("tip", "right");
    beam.moving(IntegratorKind::TrBdf2, 1e-3)
}
