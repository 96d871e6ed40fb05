// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Material, Plane, Scene, SceneError, Simulation};

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
    let mut scene = Scene::mesh_file("../meshes/bracket.msh", "")?
        .with_material(Material {
            density: 1100.0,
            thickness: 0.2,
            plane: Plane::Strain,
            ..Material::new(2e6, 0.45)
        })
        .clamp("wall")
        .force("end", [0.0, -8000.0])
        .probe("end", "end");
    scene.name = "Bracket".to_owned();
    scene.about = "An L-shaped rubber part with a rounded corner, from a Gmsh file, pulled down at its end.".to_owned();
    Ok(scene)
}
