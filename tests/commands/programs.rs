//! Compiles the Rust program of every built-in scene, compares its scene with the original, and runs it.
//! `UPDATE_GOLDEN=1` writes `tests/programs` with the current generator.

use std::path::Path;

use crate::common::scene;
use warpbeam::scene::registry;
use warpbeam::{Axis, Diagonals, ElementKind, IntegratorKind, Material, MethodKind, Plane, Scene, SceneError};

/// Result of a program's `scene`, which can fail only if it reads a mesh file.
trait Built {
    fn built(self) -> Scene;
}

impl Built for Scene {
    fn built(self) -> Scene {
        self
    }
}

impl Built for Result<Scene, SceneError> {
    fn built(self) -> Scene {
        self.unwrap()
    }
}

/// Compares the program in `tests/programs` with the one generated for `scene`, and the scene
/// that it builds with `scene`.
fn check(name: &str, written: &str, built: &Scene, scene: &Scene) {
    let program = scene.to_rust(Path::new(""));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(format!("tests/programs/{name}.rs"), &program).unwrap();
    }
    assert_eq!(written, program, "UPDATE_GOLDEN=1 cargo test --test commands programs");
    assert_eq!(built, scene);
}

macro_rules! programs {
    ($($module:ident $name:literal $scene:expr;)*) => {
        $(mod $module {
            include!(concat!("../programs/", $name, ".rs"));

            #[test]
            fn the_program_builds_the_scene_and_runs() {
                let written = include_str!(concat!("../programs/", $name, ".rs"));
                super::check($name, written, &super::Built::built(scene()), &$scene);
                main().unwrap();
            }
        })*

        const NAMES: &[&str] = &[$($name),*];
    };
}

programs! {
    article "article" super::scene("article");
    cantilever "cantilever" super::scene("cantilever");
    gravity "gravity" super::scene("gravity");
    bridge "bridge" super::scene("bridge");
    stretch "stretch" super::scene("stretch");
    shear "shear" super::scene("shear");
    elastica "elastica" super::scene("elastica");
    roll_up "roll-up" super::scene("roll-up");
    incline "incline" super::scene("incline");
    column "column" super::scene("column");
    cook "cook" super::scene("cook");
    bracket "bracket" super::scene("bracket");
    clip "clip" super::scene("clip");
    snap "snap" super::scene("snap");
    jump "jump" super::scene("jump");
    jelly "jelly" super::scene("jelly");
    swing "swing" super::scene("swing");
    flick "flick" super::scene("flick");
    spin "spin" super::scene("spin");
    sway "sway" super::scene("sway");
    chime "chime" super::scene("chime");
    short "other-short" super::short();
    rest "other-rest" super::at_rest();
    motion "other-motion" super::in_motion();
}

#[test]
fn every_built_in_scene_has_a_program() {
    for built_in in registry::BUILT_IN {
        assert!(NAMES.contains(&built_in.id), "add {} to the list above", built_in.id);
    }
}

/// Returns a scene whose values are mostly defaults, which its program leaves out.
fn short() -> Scene {
    Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1000.0]).probe("tip", "right")
}

/// Returns a static scene with all features that no built-in scene has, and numbers that need all their digits.
fn at_rest() -> Scene {
    let material = Material { plane: Plane::Strain, ..Material::new(1e6 / 3.0, 0.1 + 0.2) };
    let mut scene = Scene::beam(10.0 / 3.0, 0.7)
        .with_cells(7, 2)
        .with_element(ElementKind::Q4)
        .with_material(material)
        .with_method(MethodKind::Auto)
        .support("left", &[Axis::Y, Axis::X])
        .clamp("right")
        .moved([-0.0, 1e-7], 1.0 / 7.0)
        .support([0.0, 0.35], &[Axis::Y])
        .moment("top", 1e-300)
        .force([1.0, 0.1 + 0.2], [2e22, 1.0].map(|f: f64| f.recip()))
        .probe("a \"tip\"\\ of {it}\n", [1.0 / 3.0, -1.0 / 7.0]);
    scene.about = "“Ein Träger”\t\u{200b} */ 梁".to_owned();
    scene.solver.tolerance = 1e-6 / 3.0;
    scene.solver.max_iterations = 7;
    scene.solver.accept_after = 5;
    scene.solver.max_error_percent = 0.3;
    scene
}

/// Returns a dynamic scene with all features that no built-in scene has.
fn in_motion() -> Scene {
    let mut scene = Scene::mesh_file("../meshes/cook.msh", "")
        .unwrap()
        .with_element(ElementKind::T3)
        .with_scale(1e-2)
        .with_material(Material { thickness: 0.1 + 0.2, ..Material::default() })
        .moment("end", 0.01)
        .pulse(1.0 / 3.0, 0.01)
        .gravity([0.0, -9.81])
        .moving(IntegratorKind::ImplicitEuler, 1.0 / 70.0)
        .starting([0.1, -0.2], 1.0 / 3.0);
    scene.dynamics.duration = 0.1;
    scene.dynamics.iterations = 0;
    scene.dynamics.damping.mass = 0.1;
    scene
}

#[test]
fn the_diagonals_of_a_beam_are_set() {
    let same = Scene::beam(2.0, 1.0).with_diagonals(Diagonals::Same);
    assert_eq!(same.beam.unwrap().diagonals, Diagonals::Same);
}

#[test]
fn a_missing_mesh_file_is_refused() {
    let error = Scene::mesh_file("nowhere.msh", "assets/meshes").unwrap_err();
    assert!(error.to_string().contains("nowhere.msh"), "{error}");
}
