// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Axis, ElementKind, MethodKind, Scene, Simulation};

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
    let mut scene = Scene::beam(4.0, 0.5)
        .with_cells(16, 2)
        .with_element(ElementKind::T3)
        .with_method(MethodKind::Warped)
        .support("left", &[Axis::X])
        .support([0.0, 0.0], &[Axis::Y])
        .force("right", [50000.0, 0.0])
        .probe("end", "right");
    scene.name = "Axial bar".to_owned();
    scene.about = "A bar pulled along its axis, free to contract sideways: its end moves by P L / (E A) on any mesh.".to_owned();
    scene
}
