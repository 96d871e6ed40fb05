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
    let mut scene = Scene::beam(0.25, 0.003)
        .with_cells(25, 1)
        .with_material(Material {
            density: 7800.0,
            thickness: 0.01,
            ..Material::new(2.1e11, 0.3)
        })
        .clamp("left")
        .force("right", [0.0, -20.0])
        .pulse(0.0, 0.005)
        .probe("tip", "right")
        .moving(IntegratorKind::TrBdf2, 0.0005);
    scene.name = "Chime".to_owned();
    scene.dynamics.duration = 0.5;
    scene.about = "A thin steel tine is struck and rings at about 40 Hz: time steps longer than a few milliseconds cannot resolve it.".to_owned();
    scene
}
