// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{ElementKind, MethodKind, Scene, Simulation};

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
    let mut scene = Scene::beam(10.0, 1.0)
        .with_cells(80, 8)
        .with_element(ElementKind::T3)
        .with_method(MethodKind::Warped)
        .clamp("left")
        .force("right", [0.0, -1000.0])
        .probe("tip", "right");
    scene.name = "Cantilever".to_owned();
    scene.about = "A slender beam clamped at the left, with a force of constant direction at its tip: the classic large-rotation test.".to_owned();
    scene
}
