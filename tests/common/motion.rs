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

/// Returns the first mode of a small body, scaled to 1 mm.
pub fn first_mode(simulation: &Simulation) -> Vec<Vector2<f64>> {
    let mut u = vec![Vector2::zeros(); simulation.system().mesh().nodes().len()];
    simulation.system().pattern().add_free(vibration(simulation).0.as_slice(), 1e-3, &mut u);
    u
}

/// Returns the lowest angular frequency of a small body, rad/s.
pub fn lowest_frequency(simulation: &Simulation) -> f64 {
    vibration(simulation).1
}

/// Returns the slowest vibration about rest of a small body, from the matrices of linear theory and the integrator's
/// mass matrix: the amplitudes of the free unknowns, at most 1, and the angular frequency, rad/s.
fn vibration(simulation: &Simulation) -> (DVector<f64>, f64) {
    let system = simulation.system();
    let (n, nodes) = (system.dofs(), system.mesh().nodes().len());
    let mass = Mass::new(system, simulation.scene().material.area_density());
    let (stiffness, _) = dense(simulation.problem(), &system.at_rest(), Tangent::WARPED);
    let inertia = columns(simulation.problem(), |unit, image| {
        let (mut nodal, mut moved) = (vec![Vector2::zeros(); nodes], vec![Vector2::zeros(); nodes]);
        system.pattern().add_free(unit, 1.0, &mut nodal);
        // Explicit integrators have lumped masses.
        if simulation.scene().dynamics.integrator.entry().is_explicit() {
            moved = nodal.iter().zip(mass.lumped()).map(|(v, m)| v * *m).collect();
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
    (mode, 1.0 / growth.sqrt())
}

pub fn beam(cells: u32, slenderness: f64) -> Scene {
    let beam = Scene::beam(1.0, 1.0 / slenderness).with_cells(cells, 1).clamp("left").probe("tip", "right");
    beam.moving(IntegratorKind::TrBdf2, 1e-3)
}
