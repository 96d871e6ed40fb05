// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Diagonals, ElementKind, MethodKind, Scene, Simulation};

fn main() -> Result<(), Box<dyn Error>> {
    let mut simulation = Simulation::new(&scene())?;
    simulation.solve();
    println!("{}", simulation.status().word());
    for probe in simulation.solution().probes {
        let (name, x, y) = (&probe.name, probe.u.x, probe.u.y);
        println!("{name} moved by ({x:.6}, {y:.6}) m");
    }
    Ok(())
}

fn scene() -> Scene {
    let mut scene = Scene::beam(5.0, 1.0)
        .with_element(ElementKind::T3)
        .with_diagonals(Diagonals::Same)
        .with_method(MethodKind::Warped)
        .clamp("left")
        .force("right", [0.0, -30000.0])
        .probe("tip", "right");
    scene.name = "The article's beam".to_owned();
    scene.about = "The beam of the article, clamped left, pulled down at the tip: linear theory lets its area grow, warped stiffness does not.".to_owned();
    scene
}
