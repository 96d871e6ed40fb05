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
    let mut scene = Scene::beam(0.2, 0.001)
        .with_cells(40, 1)
        .with_rise(0.008)
        .with_material(Material {
            density: 7850.0,
            thickness: 0.02,
            ..Material::new(2.1e11, 0.0)
        })
        .clamp("left")
        .clamp("right")
        .clamp([0.1, 0.0085])
        .moved([0.0, -0.012], 0.0)
        .probe("quarter", [0.05, 0.006])
        .probe("crown", [0.1, 0.008]);
    scene.name = "Snap-through".to_owned();
    scene.about = "A shallow steel arch whose crown is pushed down: beyond the limit load, its reaction decreases. See `warpbeam curve snap`.".to_owned();
    scene
}
