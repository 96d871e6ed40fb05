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
    let mut scene = Scene::beam(0.12, 3.0)
        .with_cells(1, 30)
        .with_material(Material {
            density: 800.0,
            thickness: 0.1,
            ..Material::new(3e7, 0.3)
        })
        .clamp("bottom")
        .gravity([0.0, -9.81])
        .gravity([8.0, 0.0])
        .pulse(0.2, 0.5)
        .gravity([-8.0, 0.0])
        .pulse(0.7, 0.5)
        .probe("top", "top")
        .moving(IntegratorKind::TrBdf2, 0.008333333333333333);
    scene.name = "Sway".to_owned();
    scene.dynamics.duration = 8.0;
    scene.dynamics.damping.mass = 0.1;
    scene.dynamics.damping.stiffness = 0.001;
    scene.about = "The ground under a mast jerks sideways and back: in the ground's frame, a pulse of inertial force that makes the mast sway.".to_owned();
    scene
}
