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
        .with_cells(20, 1)
        .with_material(Material::new(1e6, 0.0))
        .clamp("left")
        .force("right", [0.0, -333.3333333333333])
        .probe("tip", "right");
    scene.name = "Elastica".to_owned();
    scene.about = "A ribbon fifty times as long as high under a large tip force: within a fraction of a percent of Euler's elastica.".to_owned();
    scene
}
