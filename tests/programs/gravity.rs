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
    let mut scene = Scene::beam(1.0, 0.15)
        .with_cells(60, 6)
        .with_element(ElementKind::T3)
        .with_material(Material {
            density: 1100.0,
            thickness: 0.3,
            ..Material::new(2e6, 0.45)
        })
        .with_method(MethodKind::Warped)
        .clamp("left")
        .gravity([0.0, -9.81])
        .probe("tip", "right");
    scene.name = "Sagging shelf".to_owned();
    scene.about = "A rubber shelf, clamped at the wall, sags under its own weight alone.".to_owned();
    scene
}
