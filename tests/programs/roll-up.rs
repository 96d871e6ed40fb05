// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Material, Scene, Simulation};

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
    let mut scene = Scene::beam(50.0, 1.0)
        .with_cells(40, 1)
        .with_material(Material::new(1e6, 0.0))
        .clamp("left")
        .moment("right", 10471.975511965977)
        .probe("tip", "right");
    scene.name = "Roll-up".to_owned();
    scene.about = "An end moment of 2 pi E I / L, which rotates with its edge, bends the beam into a circle.".to_owned();
    scene
}
