// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{ElementKind, Material, MethodKind, Plane, Scene, Simulation};

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
    let mut scene = Scene::beam(2.0, 1.0)
        .with_cells(24, 12)
        .with_element(ElementKind::T3)
        .with_material(Material {
            plane: Plane::Strain,
            ..Material::default()
        })
        .with_method(MethodKind::Warped)
        .clamp("bottom")
        .force("top", [200000.0, 0.0])
        .probe("top", "top");
    scene.name = "Sheared block".to_owned();
    scene.about = "A block glued to the floor, its top edge pushed sideways.".to_owned();
    scene
}
