// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{IntegratorKind, Scene, Simulation, Status};

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
    let mut scene = Scene::beam(1.0, 0.1)
        .with_cells(20, 1)
        .clamp("left")
        .gravity([0.0, -9.81])
        .probe("tip", "right")
        .moving(IntegratorKind::TrBdf2, 0.016666666666666666);
    scene.name = "Swing".to_owned();
    scene.dynamics.duration = 2.0;
    scene.about = "A slender rubber beam is released from horizontal and swings under its own weight.".to_owned();
    scene
}
