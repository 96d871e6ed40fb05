// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release

use std::error::Error;

use warpbeam::{Axis, ElementKind, Material, MethodKind, Plane, Scene, Simulation};

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
    let mut scene = Scene::beam(3.3333333333333335, 0.7)
        .with_cells(7, 2)
        .with_element(ElementKind::Q4)
        .with_material(Material {
            plane: Plane::Strain,
            ..Material::new(333333.3333333333, 0.30000000000000004)
        })
        .with_method(MethodKind::Auto)
        .support("left", &[Axis::Y, Axis::X])
        .clamp("right")
        .moved([-0.0, 1e-7], 0.14285714285714285)
        .support([0.0, 0.35], &[Axis::Y])
        .moment("top", 1e-300)
        .force([1.0, 0.30000000000000004], [5e-23, 1.0])
        .probe("a \"tip\"\\ of {it}\n", [0.3333333333333333, -0.14285714285714285]);
    scene.solver.tolerance = 3.333333333333333e-7;
    scene.solver.max_iterations = 7;
    scene.solver.accept_after = 5;
    scene.solver.max_error_percent = 0.3;
    scene.about = "“Ein Träger”\t\u{200b} */ 梁".to_owned();
    scene
}
