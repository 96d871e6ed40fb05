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
    let mut scene = Scene::beam(1.0, 0.05)
        .with_cells(40, 1)
        .with_material(Material::new(5e6, 0.3))
        .clamp("left")
        .force("right", [0.0, -250.0])
        .pulse(0.0, 0.1)
        .probe("tip", "right")
        .moving(IntegratorKind::TrBdf2, 0.004166666666666667);
    scene.name = "Flick".to_owned();
    scene.dynamics.duration = 2.0;
    scene.about = "A short push at the tip of a clamped beam: the wave runs to the clamp and back, and the beam rings.".to_owned();
    scene
}
