//! Writes a load curve as CSV: the tip deflection of a slender beam under a growing force, by linear theory, with large
//! rotations, and of the exact beam.
//!
//! `cargo run --release --example load_curve --no-default-features -- curve.csv`

use std::error::Error;
use std::fmt::Write as _;

use warpbeam::{Material, MethodKind, Reference, Scene, Simulation, Status};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "curve.csv".to_owned());
    std::fs::write(&path, curve()?)?;
    println!("wrote {path}");
    Ok(())
}

/// Returns the curve as CSV: load in units of E I / L², and deflection of the tip over the length.
pub fn curve() -> Result<String, Box<dyn Error>> {
    let (length, height) = (1.0, 0.02);
    let material = Material { thickness: 0.05, ..Material::new(2.1e11, 0.0) };
    let unit = material.young * material.thickness * f64::powi(height, 3) / 12.0 / (length * length);
    let scene = Scene::beam(length, height)
        .with_cells(40, 1)
        .with_material(material)
        .clamp("left")
        .force("right", [0.0, 0.0])
        .probe("tip", "right");
    let mut linear = Simulation::new(&scene.clone().with_method(MethodKind::Linear))?;
    // Both simulations share one system of equations.
    let mut newton = Simulation::with_system(&scene, linear.system().clone())?;
    let mut csv = String::from("alpha,linear_w_over_l,newton_w_over_l,exact_w_over_l\n");
    for i in 1..=20 {
        let alpha = 0.5 * f64::from(i);
        let mut deflections = Vec::new();
        for beam in [&mut linear, &mut newton] {
            beam.edit(|scene| scene.set_force(0, [0.0, -alpha * unit]))?;
            if *beam.solve() != Status::Converged {
                return Err(format!("α = {alpha}: {:?}", beam.status()).into());
            }
            deflections.push(-beam.probe("tip").unwrap_or_default().y / length);
        }
        let exact = Reference::of(newton.scene())?.first().ok_or("no reference solution")?.displacement;
        writeln!(csv, "{alpha},{:.6},{:.6},{:.6}", deflections[0], deflections[1], -exact.y / length)?;
    }
    Ok(csv)
}
