// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{IntegratorKind, Material, Scene, Simulation, Status};

fn main() -> Result<(), Box<dyn Error>> {
    let mut simulation = Simulation::new(&scene())?;
    while *simulation.status() == Status::Running {
        simulation.step();
    }
    let time = simulation.state().time();
    println!("{} at {time} s", simulation.status().word());
    for probe in simulation.solution().probes {
        let (name, x, y) = (&probe.name, probe.u.x, probe.u.y);
        println!("{name} moved by ({x:.6}, {y:.6}) m");
    }
    Ok(())
}

fn scene() -> Scene {
    let mut scene = Scene::beam(0.8, 0.6)
        .with_cells(8, 6)
        .with_material(Material::new(25000.0, 0.4))
        .clamp("bottom")
        .gravity([0.0, -9.81])
        .probe("top", "top")
        .moving(IntegratorKind::TrBdf2, 0.008333333333333333);
    scene.name = "Jelly".to_owned();
    scene.dynamics.duration = 5.0;
    scene.dynamics.damping.mass = 0.2;
    scene.dynamics.damping.stiffness = 0.01;
    scene.about = "A soft block on a plate wobbles under its own weight: grab it and pull.".to_owned();
    scene
}
