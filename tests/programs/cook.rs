// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Material, MethodKind, Scene, SceneError, Simulation};

fn main() -> Result<(), Box<dyn Error>> {
    let mut simulation = Simulation::new(&scene()?)?;
    simulation.solve();
    println!("{}", simulation.status().word());
    for probe in simulation.solution().probes {
        let (name, x, y) = (&probe.name, probe.u.x, probe.u.y);
        println!("{name} moved by ({x:.6}, {y:.6}) m");
    }
    Ok(())
}

fn scene() -> Result<Scene, SceneError> {
    let mut scene = Scene::mesh_file("../meshes/cook.msh", "")?
        .with_material(Material {
            density: 1.0,
            ..Material::new(1.0, 0.3333333333333333)
        })
        .with_method(MethodKind::Linear)
        .clamp("clamp")
        .force("end", [0.0, 1.0])
        .probe("middle", [48.0, 52.0])
        .probe("corner", [48.0, 60.0]);
    scene.name = "Cook's membrane".to_owned();
    scene.about = "A tapered, clamped panel under shear at its end: the end's middle rises by 23.96 in linear theory, the classic answer, and by 15.86 with large rotations.".to_owned();
    Ok(scene)
}
