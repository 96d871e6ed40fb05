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
        .probe("end", "right")
        .moving(IntegratorKind::EnergyMomentum, 0.016666666666666666)
        .starting([0.0, 0.0], 6.0);
    scene.name = "Spin".to_owned();
    scene.about = "A free bar rotates in empty space: its energy and angular momentum should stay constant.".to_owned();
    scene
}
