//! Random scenes and damaged scene files: no panic, no hang, nothing that is not finite.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::path::Path;

use proptest::prelude::*;
use warpbeam::scene::{Scene, registry};
use warpbeam::simulation::{Field, Simulation, Status};

/// Magnitudes over many decades, and the awkward ones.
fn magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![
        30 => (-3.0..5.0f64).prop_map(|e| 10f64.powf(e)),
        10 => 0.1..10.0f64,
        3 => (-12.0..15.0f64).prop_map(|e| 10f64.powf(e)),
        1 => Just(0.0),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(-1.0),
        1 => Just(5e-324),
        1 => Just(f64::MAX),
    ]
}

/// A scene file with every number drawn from somewhere; most are refused, and must be refused politely.
fn scene_text() -> impl Strategy<Value = String> {
    let numbers = proptest::collection::vec(magnitude(), 12);
    let words = (0..3usize, 0..2usize, 0..2usize, 0..4usize, 0..6usize);
    (numbers, words, 1..12u32, 1..4u32, -0.99..0.5f64).prop_map(
        |(v, (method, element, plane, edge, load), nx, ny, nu)| {
            let method = ["linear", "warped", "newton"][method];
            let element = ["t3", "t6"][element];
            let plane = ["stress", "strain"][plane];
            let edge = ["left", "right", "bottom", "top"][edge];
            let n = |i: usize| if v[i].is_nan() { "nan".to_owned() } else { format!("{:?}", v[i]) };
            let load = match load {
                0 => format!("kind = \"force\"\nedge = \"right\"\nforce = [{}, {}]", n(0), n(1)),
                1 => format!("kind = \"force\"\nat = [{}, {}]\nforce = [0.0, -{:?}]", n(0), n(1), v[2].abs()),
                2 => format!("kind = \"gravity\"\nacceleration = [{}, {}]", n(0), n(1)),
                3 => format!("kind = \"moment\"\nedge = \"top\"\nmoment = {}", n(0)),
                4 => format!("kind = \"moment\"\nedge = \"right\"\nmoment = {}", n(0)),
                _ => format!("kind = \"force\"\nedge = \"{edge}\"\nforce = [{}, -1.0]", n(0)),
            };
            format!(
                "name = \"Random\"\n[beam]\nlength = {}\nheight = {}\ncells = [{nx}, {ny}]\nelement = \"{element}\"\n\
             [material]\nyoung = {}\npoisson = {nu:?}\ndensity = {}\nthickness = {}\nplane = \"{plane}\"\n\
             [[support]]\nedge = \"{edge}\"\nfix = [\"x\", \"y\"]\n[[load]]\n{load}\n\
             [[probe]]\nname = \"p\"\nedge = \"right\"\n[solver]\nmethod = \"{method}\"\nmax_iterations = 40\n",
                n(3),
                n(4),
                n(5),
                n(6),
                n(7)
            )
        },
    )
}

fn check(text: &str) {
    let Ok(scene) = Scene::from_toml(text, Path::new("random.toml")) else { return };
    let Ok(mut simulation) = Simulation::new(&scene) else { return };
    simulation.solve();
    assert_ne!(*simulation.status(), Status::Running);
    assert!(simulation.iterations() <= scene.solver.max_iterations);
    assert!(simulation.displacement().iter().all(|u| u.x.is_finite() && u.y.is_finite()), "{text}");
    assert!(simulation.residual().is_finite(), "{text}");
    let mut values = Vec::new();
    for field in Field::ALL {
        simulation.field(field, &mut values);
        assert!(values.iter().all(|v| v.is_finite()), "{field:?} {text}");
    }
    let certificate = simulation.certificate();
    assert!(certificate.fixed_point_rho.is_none_or(f64::is_finite), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_scenes_are_solved_or_refused(text in scene_text()) {
        check(&text);
    }

    /// A byte of a built-in scene replaced, removed or doubled.
    #[test]
    fn damaged_scene_files_are_read_or_refused(
        which in 0..6usize,
        at in any::<prop::sample::Index>(),
        with in prop_oneof![Just(""), Just("9"), Just("-"), Just("."), Just("\""), Just("\n"), Just("["), Just("é"), Just("1e99")],
        remove in 0..3usize,
    ) {
        let text: Vec<char> = registry::BUILT_IN[which].toml.chars().collect();
        let at = at.index(text.len());
        let end = (at + remove).min(text.len());
        let damaged: String = text[..at].iter().collect::<String>() + with + &text[end..].iter().collect::<String>();
        if let Ok(scene) = Scene::from_toml(&damaged, Path::new("damaged.toml")) {
            prop_assert!(scene.validate().is_ok());
        }
    }
}
