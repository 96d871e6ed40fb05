//! Compares the beam theories with the independent reference table, with closed forms, and with each other.

use nalgebra::Vector2;

use super::{ClampedBeam, ExactBeam, error_percent};
use crate::method::Decision;
use crate::scene::{ElementKind, MethodKind, Scene, Source, open};
use crate::simulation::Simulation;
use crate::study::LoadCurve;

impl ClampedBeam {
    /// Returns the same beam without stretch and shear: the elastica.
    fn elastica(self) -> Self {
        Self { stretch_compliance: 0.0, shear_compliance: 0.0, ..self }
    }
}

/// Opens a built-in scene with `--set` assignments.
fn scene(id: &str, set: &[&str]) -> Scene {
    open(&Source { name: id.into(), assignments: set.iter().map(|s| (*s).to_owned()).collect() }).unwrap()
}

/// Returns a beam with ν = 0, unit length and unit bending stiffness.
fn beam(length_over_height: f64) -> ClampedBeam {
    // EA = 12 (L/H)² EI/L², GA = 5/6 · EA/2.
    let axial = 12.0 * length_over_height * length_over_height;
    ClampedBeam {
        length: 1.0,
        bending: 1.0,
        stretch_compliance: 1.0 / axial,
        shear_compliance: 1.0 / (5.0 / 6.0 * 0.5 * axial),
        tip_force: Vector2::zeros(),
        tip_moment: 0.0,
        weight: Vector2::zeros(),
    }
}

#[test]
fn every_row_of_the_reference_table_to_1e_6() {
    let rows = include_str!("../../tests/data/cantilever.csv").lines().filter(|line| !line.starts_with('#')).skip(1);
    assert_eq!(rows.clone().count(), 54);
    for row in rows {
        let (kind, numbers) = row.split_once(',').unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        let [length_over_height, alpha, angle, x, y, reissner_x, reissner_y, reissner_angle] = numbers[..] else {
            panic!("{row}")
        };
        let mut beam = beam(length_over_height);
        let (sin, cos) = angle.to_radians().sin_cos();
        let load = Vector2::new(cos, sin) * alpha;
        if kind == "gravity" {
            beam.weight = load;
        } else {
            beam.tip_force = load;
        }
        let elastica = beam.elastica().tip().unwrap();
        let reissner = beam.tip().unwrap();
        assert!((elastica.x - Vector2::new(x, y)).norm() < 1e-6, "{row} {elastica:?}");
        assert!((reissner.x - Vector2::new(reissner_x, reissner_y)).norm() < 1e-6, "{row} {reissner:?}");
        assert!((reissner.angle - reissner_angle).abs() < 1e-6, "{row} {reissner:?}");
    }
}

/// Values of w/L and u/L of the elastica under a dead tip load (Mattiasson 1981).
#[test]
fn the_elastica_of_the_literature() {
    for (alpha, w, u) in
        [(1.0, 0.301721, 0.056433), (2.0, 0.493457, 0.160642), (5.0, 0.713792, 0.387628), (10.0, 0.810609, 0.554996)]
    {
        let tip = ClampedBeam { tip_force: Vector2::new(0.0, alpha), ..beam(10.0) }.elastica().tip().unwrap();
        assert!((tip.x.y - w).abs() < 1e-6 && (1.0 - tip.x.x - u).abs() < 1e-6, "{alpha}: {tip:?}");
    }
}

/// Under an end moment the beam is an arc of exactly κ = M/EI, also beyond a full circle.
#[test]
fn an_end_moment_makes_an_arc() {
    for turns in [0.1, 0.5, 1.0, 1.7, -1.0] {
        let angle = turns * std::f64::consts::TAU;
        let tip = ClampedBeam { tip_moment: angle, ..beam(50.0) }.tip().unwrap();
        let expected = Vector2::new(angle.sin() / angle, (1.0 - angle.cos()) / angle);
        assert!((tip.x - expected).norm() < 1e-8, "{turns}: {tip:?}");
        assert!((tip.angle - angle).abs() < 1e-8);
    }
}

#[test]
fn small_loads_give_linear_beam_theory() {
    let loads = [
        ClampedBeam { tip_force: Vector2::new(1.0, -2.0), ..beam(8.0) },
        ClampedBeam { weight: Vector2::new(0.5, 1.5), ..beam(8.0) },
        ClampedBeam { tip_moment: 0.7, ..beam(8.0) },
    ];
    for load in loads {
        let small = ClampedBeam {
            tip_force: load.tip_force * 1e-4,
            weight: load.weight * 1e-4,
            tip_moment: load.tip_moment * 1e-4,
            ..load
        };
        let exact = small.tip().unwrap().x - Vector2::new(1.0, 0.0);
        let linear = small.linear_tip_displacement();
        // The second-order term is 1e-4 of the displacement, which is itself about 1e-4.
        assert!((exact - linear).norm() < 2e-8, "{load:?}: {exact} {linear}");
    }
}

/// Under loads far beyond the table, the beam hangs from its clamp like a rope.
#[test]
fn very_large_loads_are_followed() {
    for alpha in [100.0, 1000.0] {
        let tip = ClampedBeam { tip_force: Vector2::new(0.0, -alpha), ..beam(50.0) }.elastica().tip().unwrap();
        // The boundary layer has the length √(EI/P): x is √2 times that, and y is short of L by 2 − √2 times that.
        let layer = 1.0 / f64::sqrt(alpha);
        assert!((tip.x.x - std::f64::consts::SQRT_2 * layer).abs() < 0.02 * layer, "{alpha}: {tip:?}");
        assert!((1.0 + tip.x.y - (2.0 - std::f64::consts::SQRT_2) * layer).abs() < 0.02 * layer, "{alpha}: {tip:?}");
    }
}

#[test]
fn scenes_with_an_exact_solution_are_recognised() {
    for id in ["article", "cantilever", "gravity", "elastica", "roll-up", "incline", "column"] {
        assert!(matches!(ExactBeam::of(&scene(id, &[])), Some(ExactBeam::Cantilever(_))), "{id}");
    }
    let stretch = ExactBeam::of(&scene("stretch", &[])).unwrap().tip_displacement().unwrap();
    assert!((stretch - Vector2::new(0.4, 0.0)).norm() < 1e-15);
    for id in ["bridge", "shear", "cook", "bracket"] {
        assert_eq!(ExactBeam::of(&scene(id, &[])), None, "{id}");
    }
    // The exact beam has its load at the free end; a load at another place has none.
    assert_eq!(ExactBeam::of(&scene("cantilever", &["load.0.edge=top"])), None);
}

/// The strain along a load curve is that of normal force and bending moment at the clamp.
#[test]
fn strains_of_a_curve_count_the_normal_force() {
    let bar = Scene::beam(10.0, 1.0).clamp("left").force("right", [1e3, -1.0]).probe("tip", "right");
    let curve = LoadCurve::new(&bar).unwrap();
    let full = curve.samples.iter().find(|sample| (sample.factor - 1.0).abs() < 1e-9).unwrap();
    // N/EA = 1e-3; M = 10 N m, less what the tension takes.
    let bending = 0.5 * 10.0 / (1e6 / 12.0);
    assert!(full.strain > 1e-3 + 0.5 * bending && full.strain < 1e-3 + bending, "{}", full.strain);
}

/// The exact beam near the critical load: tip displacement by shooting from the tip's angle (fourth-order Runge–Kutta,
/// 400 steps), Reissner beam with shear factor 5/6.
#[test]
fn the_exact_beam_stays_on_the_branch_of_its_load() {
    let column = |force: [f64; 2]| scene("column", &[&format!("load.0.force=[{},{}]", force[0], force[1])]);
    for (force, u) in [
        ([-500.0, 0.001], [-0.0100, 0.001_186_2]),
        ([-514.0, 0.001], [-0.037_115, 0.932_38]),
        ([-520.0, 0.001], [-0.496_69, 3.9405]),
        ([-600.0, 0.001], [-5.6601, 12.281]),
        ([-690.0, 0.0002], [-9.8879, 14.881]),
    ] {
        let tip = ExactBeam::of(&column(force)).unwrap().tip_displacement().unwrap();
        assert!((tip - Vector2::from(u)).norm() < 2e-4 * Vector2::from(u).norm(), "{force:?}: {tip}");
        let mirrored = ExactBeam::of(&column([force[0], -force[1]])).unwrap().tip_displacement().unwrap();
        assert!((mirrored.y + tip.y).abs() < 1e-6, "{force:?}: {mirrored}");
    }
}

/// Results of `auto` are within the requested error of the exact beam on a sufficiently fine mesh.
#[test]
fn results_stay_within_the_requested_error_of_the_reference() {
    for id in ["cantilever", "elastica"] {
        let mut scene = scene(id, &[]);
        scene.set_element(ElementKind::T6);
        scene.beam.as_mut().unwrap().cells = [40, 2];
        scene.solver.method = MethodKind::Auto;
        scene.solver.max_error_percent = 1.0;
        let mut decisions = Vec::new();
        for factor in [1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0] {
            let mut scene = scene.clone();
            scene.scale_loads(factor);
            let mut auto = Simulation::new(&scene).unwrap();
            auto.solve();
            let report = auto.equilibrium().unwrap().auto_report().unwrap();
            let reference = ExactBeam::of(&scene).unwrap().tip_displacement().unwrap();
            let error = error_percent(auto.probe("tip").unwrap(), reference).unwrap();
            assert!(error <= 1.0, "{id} × {factor}: {error} %, {:?}", report);
            decisions.push(report.decision);
        }
        assert!(decisions.contains(&Decision::Linear) && decisions.contains(&Decision::NewFactor), "{decisions:?}");
    }
}

#[test]
fn exact_solutions_take_any_number() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        let beam = ClampedBeam {
            length: bad,
            bending: 1.0,
            stretch_compliance: 0.0,
            shear_compliance: 0.0,
            tip_force: Vector2::new(0.0, 1.0),
            tip_moment: 0.0,
            weight: Vector2::zeros(),
        };
        assert_eq!(beam.tip(), None, "a length of {bad}");
        let beam = ClampedBeam { length: 1.0, bending: bad, ..beam };
        match beam.tip() {
            // A beam with zero compliance, which a load cannot bend.
            Some(tip) => assert!(bad.is_finite() && (tip.x - Vector2::x()).norm() < 1e-12, "{bad}: {tip:?}"),
            None => assert!(!bad.is_finite(), "a bending stiffness of {bad}"),
        }
    }
    assert_eq!(ExactBeam::of(&Scene::named("nothing")), None);
}
