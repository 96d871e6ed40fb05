//! Solves and studies a mesh from Gmsh: the error of each element and method on it, and their cost on this machine.
//!
//! `cargo run --release --example mesh_study --no-default-features`

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

use warpbeam::{Extent, Scene, Simulation, Status, Study};

fn main() -> Result<(), Box<dyn Error>> {
    println!("{}", report(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes").as_path())?);
    Ok(())
}

/// Returns a report on the solution and the study of the bracket, whose scene file is in `folder`.
pub fn report(folder: &Path) -> Result<String, Box<dyn Error>> {
    let text = std::fs::read_to_string(folder.join("bracket.toml"))?;
    let scene = Scene::from_toml_in(&text, folder)?;
    let mut bracket = Simulation::new(&scene)?;
    if *bracket.solve() != Status::Converged {
        return Err(format!("{:?}", bracket.status()).into());
    }
    let stable = bracket.certify().stable;
    let largest = bracket.nodal_stress().largest_von_mises().map_or(0.0, |(_, largest)| largest);
    let study = Study::new(&scene, Extent::Quick, &|_| ControlFlow::Continue(()))?;
    Ok(format!(
        "{}: stable {stable:?}, largest von Mises (Cauchy) stress {largest:.0} Pa, end moved by {:.4} m\n\n{}",
        scene.name,
        bracket.probe("end").map_or(0.0, |u| u.norm()),
        study.summary()
    ))
}
