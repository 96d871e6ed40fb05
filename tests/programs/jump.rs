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
        .force([0.1, 0.0085], [0.0, -90.0])
        .probe("crown", [0.1, 0.008]);
    scene.name = "Jump".to_owned();
    scene.about = "The arch of the scene snap under a force beyond its limit load of about 80 N: it snaps through to the other side.".to_owned();
    scene
}
