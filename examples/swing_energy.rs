//! Lets a beam swing under its weight with each integrator, and prints where the energy goes.
//!
//! `cargo run --release --example swing_energy --no-default-features`

use std::error::Error;

use warpbeam::{IntegratorKind, Ledger, Scene, Simulation};

const INTEGRATORS: [IntegratorKind; 3] =
    [IntegratorKind::ImplicitEuler, IntegratorKind::TrBdf2, IntegratorKind::EnergyMomentum];

fn main() -> Result<(), Box<dyn Error>> {
    println!("integrator              kinetic J  elastic J  potential J  lost J");
    for integrator in INTEGRATORS {
        let Ledger { kinetic, elastic, potential, integrator: lost, .. } = swing(integrator)?;
        println!("{integrator:<22?} {kinetic:>10.3} {elastic:>10.3} {potential:>12.3} {lost:>7.3}");
    }
    Ok(())
}

/// Swings for two seconds and returns the energies at the end.
pub fn swing(integrator: IntegratorKind) -> Result<Ledger, Box<dyn Error>> {
    let mut scene = Scene::beam(1.0, 0.1).clamp("left").gravity([0.0, -9.81]).moving(integrator, 1.0 / 120.0);
    scene.dynamics.iterations = 0; // solve every stage to its tolerance
    let mut beam = Simulation::new(&scene)?;
    for _ in 0..240 {
        beam.step();
    }
    let motion = beam.motion().ok_or("a dynamic scene has a motion")?;
    Ok(*motion.ledger())
}
