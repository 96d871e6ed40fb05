// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Material, Scene, SceneError, Simulation};

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
    let mut scene = Scene::mesh_file("../meshes/clip.msh", "")?
        .with_scale(0.001)
        .with_material(Material {
            density: 1410.0,
            thickness: 0.003,
            ..Material::new(2.8e9, 0.35)
        })
        .clamp("base")
        .force("nose", [0.0, -2.0])
        .probe("nose", "nose")
        .probe("back", [-0.005, 0.0]);
    scene.name = "Spring clip".to_owned();
    scene.about = "A plastic clip from a Gmsh file in millimetres, its nose pressed down by 2 N.".to_owned();
    Ok(scene)
}
