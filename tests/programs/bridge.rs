// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{ElementKind, Material, MethodKind, Scene, Simulation};

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
    let mut scene = Scene::beam(12.0, 0.8)
        .with_cells(90, 6)
        .with_element(ElementKind::T3)
        .with_material(Material::new(2e6, 0.3))
        .with_method(MethodKind::Warped)
        .clamp("left")
        .clamp("right")
        .force([6.0, 0.4], [0.0, -6000.0])
        .probe("middle", [6.0, 0.0]);
    scene.name = "Bridge".to_owned();
    scene.about = "Clamped at both ends with a load in the middle of the top edge: it stiffens as it stretches.".to_owned();
    scene
}
