// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{ElementKind, IntegratorKind, Material, Scene, SceneError, Simulation, Status};

fn main() -> Result<(), Box<dyn Error>> {
    let mut simulation = Simulation::new(&scene()?)?;
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

fn scene() -> Result<Scene, SceneError> {
    let mut scene = Scene::mesh_file("../meshes/cook.msh", "")?
        .with_element(ElementKind::T3)
        .with_scale(0.01)
        .with_material(Material {
            thickness: 0.30000000000000004,
            ..Material::default()
        })
        .moment("end", 0.01)
        .pulse(0.3333333333333333, 0.01)
        .gravity([0.0, -9.81])
        .moving(IntegratorKind::ImplicitEuler, 0.014285714285714285)
        .starting([0.1, -0.2], 0.3333333333333333);
    scene.dynamics.duration = 0.1;
    scene.dynamics.iterations = 0;
    scene.dynamics.damping.mass = 0.1;
    Ok(scene)
}
