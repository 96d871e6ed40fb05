//! Compares the beam theories with the independent reference table, with closed forms, and with each other.

use crate::common::{scene, scene_with};
use nalgebra::Vector2;
use warpbeam::Scene;
use warpbeam::exact_beam::{ClampedBeam, ExactBeam};
use warpbeam::study::LoadCurve;

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
    let rows = crate::common::cantilever_table();
    assert_eq!(rows.len(), 54);
    for row in rows {
        let mut beam = beam(row.length_over_height);
        let direction = Vector2::new(row.angle.cos(), row.angle.sin());
        if row.gravity {
            beam.weight = direction * row.alpha;
        } else {
            beam.tip_force = direction * row.alpha;
        }
        let elastica = beam.elastica().tip().unwrap();
        let reissner = beam.tip().unwrap();
        assert!((elastica.x - row.elastica).norm() < 1e-6, "{row:?} {elastica:?}");
        assert!((reissner.x - row.reissner).norm() < 1e-6, "{row:?} {reissner:?}");
        assert!((reissner.angle - row.reissner_angle).abs() < 1e-6, "{row:?} {reissner:?}");
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
        assert!(matches!(ExactBeam::of(&scene(id)), Some(ExactBeam::Cantilever(_))), "{id}");
    }
    let stretch = ExactBeam::of(&scene("stretch")).unwrap().tip_displacement().unwrap();
    assert!((stretch - Vector2::new(0.4, 0.0)).norm() < 1e-15);
    for id in ["bridge", "shear", "cook", "bracket"] {
        assert_eq!(ExactBeam::of(&scene(id)), None, "{id}");
    }
    // The exact beam has its load at the free end; a load at another place has none.
    assert_eq!(ExactBeam::of(&scene_with("cantilever", &["load.0.edge=top"])), None);
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
