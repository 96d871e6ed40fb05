//! Functions shared by tests of dynamics.

use nalgebra::{DMatrix, DVector, Vector2};
use warpbeam::assembly::{Forces, Mass, Matrix};
use warpbeam::element::Tangent;
use warpbeam::{IntegratorKind, Momentum, Scene, Simulation, Status};

use super::scene;

/// Returns a built-in scene with another integrator, time step, number of solves per step and duration.
pub fn with(id: &str, kind: IntegratorKind, time_step: f64, iterations: u32, duration: f64) -> Scene {
    let mut scene = scene(id);
    (scene.dynamics.integrator, scene.dynamics.time_step) = (kind, time_step);
    (scene.dynamics.iterations, scene.dynamics.duration) = (iterations, duration);
    scene
}

pub fn run(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(scene).unwrap();
    assert_eq!(*simulation.solve(), Status::Finished);
    simulation
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
    let mut sparse = Matrix::new(system.pattern());
    let mut forces = Forces::new(nodes);
    simulation.problem().linearize(&system.at_rest(), &mut forces, Some((Tangent::WARPED, &mut sparse)));
    let mass = Mass::new(system, simulation.scene().material.area_density());
    let (mut stiffness, mut inertia) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    let (mut column, mut nodal, mut moved) =
        (vec![0.0; n], vec![Vector2::zeros(); nodes], vec![Vector2::zeros(); nodes]);
    for i in 0..n {
        let mut unit = vec![0.0; n];
        unit[i] = 1.0;
        sparse.multiply(system.pattern(), &unit, &mut column);
        stiffness.set_column(i, &DVector::from_column_slice(&column));
        nodal.fill(Vector2::zeros());
        system.pattern().add_free(&unit, 1.0, &mut nodal);
        // Explicit integrators have lumped masses.
        if simulation.scene().dynamics.integrator.entry().is_explicit() {
            moved = nodal.iter().zip(mass.lumped()).map(|(v, m)| v * *m).collect();
        } else {
            mass.multiply(&nodal, &mut moved);
        }
        system.pattern().restrict(&moved, &mut column);
        inertia.set_column(i, &DVector::from_column_slice(&column));
    }
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
