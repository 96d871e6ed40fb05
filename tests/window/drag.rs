//! Every frame of a drag is an equilibrium: body, arrow and numbers belong to the load under the pointer.

use std::time::Duration;

use egui::Vec2;
use egui::accesskit::Role;
use egui_kittest::Harness;

use crate::common::lab::{settle, unfold, wait};
use crate::common::{sampled, scene};
use crate::numbers::{Shown, solve};
use crate::ui_interaction::harness;
use warpbeam::app::Lab;
use warpbeam::format::{engineering, three_digits, two_digits};
use warpbeam::{MethodKind, Simulation, Status};

/// Positions of a drag: there and back on the line of the arrow, through zero, and a circle around its foot.
const POSITIONS: u32 = 200;

/// Returns the arrow at a position, from the one at the start.
fn arrow(start: Vec2, position: u32) -> Vec2 {
    let part = std::f32::consts::TAU * (position % 100) as f32 / 100.0;
    match position {
        0..100 => start * (0.4 + 0.6 * part.cos()),
        _ => Vec2::angled(start.angle() + part) * (0.15 * start.length()),
    }
}

fn shown(harness: &Harness<'_, Lab>) -> Shown {
    Shown::with_role(harness, &|role| role == Role::Label)
}

/// Returns the text that starts with a name.
fn text<'a>(shown: &'a Shown, name: &str) -> &'a str {
    shown.starting_with(name).unwrap_or_else(|| panic!("no {name:?}: {:?}", shown.0))
}

/// Returns the number at the start of a text, percent.
fn number(text: &str) -> f64 {
    text.split_whitespace().find_map(|word| word.parse().ok()).unwrap_or_else(|| panic!("no number in {text:?}"))
}

/// In every frame the status is converged, nothing is grey and no number is a dash; body, arrow, ρ and stress are those of
/// a solve at the load, and the error is, within its "≈".
#[test]
fn every_frame_of_a_drag_is_an_equilibrium() {
    for id in ["article", "cantilever", "bridge", "cook", "incline"] {
        let mut harness = harness(id);
        harness.state_mut().set_frame_work(Duration::from_secs(20));
        unfold(&mut harness, "stable");
        for method in [MethodKind::Warped, MethodKind::Newton, MethodKind::Linear] {
            harness.state_mut().set_scene(scene(id).with_method(method)).unwrap();
            harness.run();
            let is_small = harness.state().simulation().system().dofs() <= 2000;
            settle(&mut harness);
            wait(&mut harness, "the live reference", |lab| !lab.is_following());
            let is_shown = |name: &str| !text(&shown(&harness), name).contains('\u{2013}');
            // The time of a long solve is that of the last rest.
            let (has_error, has_time) = (is_small && is_shown("ERROR "), is_shown("TIME "));
            let (foot, tip) = (harness.state().arrow_feet()[0], harness.state().arrow_tips()[0].1);
            harness.hover_at(tip);
            harness.run();
            harness.drag_at(tip);
            harness.step();
            let mut checked = 0;
            for position in sampled(0..POSITIONS, 10) {
                let what = format!("{id}, {method:?}, position {position}");
                let wanted = arrow(tip - foot, position);
                harness.hover_at(foot + wanted);
                // The window lays out a frame with an edit twice.
                harness.run_steps(2);
                let lab = harness.state();
                let mut alone = Simulation::new(lab.scene()).unwrap();
                if *alone.solve() != Status::Converged {
                    assert_eq!(method, MethodKind::Warped, "{what}: {:?}", alone.status());
                    continue;
                }
                checked += 1;
                assert_eq!(
                    (lab.simulation().scene(), lab.simulation().status()),
                    (lab.scene(), &Status::Converged),
                    "{what}"
                );
                let drawn = lab.arrow_tips()[0].1 - lab.arrow_feet()[0];
                assert!(wanted.length() < 20.0 || (drawn - wanted).length() < 3.0, "{what}: {drawn} {wanted}");
                let u = |body: &Simulation| body.solution().probes[0].u;
                assert!((u(lab.simulation()) - u(&alone)).norm() <= 1e-5 * u(&alone).norm() + 1e-9, "{what}");
                let shown = shown(&harness);
                assert!(shown.starting_with("Converged").is_some(), "{what}: {:?}", shown.0);
                assert!(!shown.0.iter().any(|text| text.contains("not reached")), "{what}");
                assert!(!has_time || !text(&shown, "TIME ").contains('\u{2013}'), "{what}");
                if has_error {
                    assert!(!text(&shown, "ERROR ").contains('\u{2013}'), "{what}: {}", text(&shown, "ERROR "));
                }
                let strain = engineering(three_digits(100.0 * alone.solution().deformation.max_strain), "%");
                assert!(
                    shown.row("Strain").starts_with(&strain) || !is_small,
                    "{what}: {strain}, {}",
                    shown.row("Strain")
                );
                if method == MethodKind::Warped && is_small {
                    let rho = alone.certify().fixed_point_rho.map(|rho| engineering(two_digits(rho), ""));
                    assert_eq!(text(&shown, "ρ "), format!("ρ {} per iteration", rho.unwrap()), "{what}");
                }
                if position % 50 != 20 {
                    continue;
                }
                wait(&mut harness, "the live reference", |lab| !lab.is_following());
                harness.step();
                let (shown, json) = (self::shown(&harness), solve(harness.state().scene()));
                let stress = &json["max_von_mises"];
                if let Some(value) = stress["value"].as_f64().filter(|_| is_small) {
                    // Its place is one of two in a symmetric scene.
                    let words = format!("{} at ", engineering(three_digits(value), "Pa"));
                    assert!(shown.row("Stress").starts_with(&words), "{what}: {words}, {}", shown.row("Stress"));
                }
                if let Some(error) = json["probes"][0]["error_percent"].as_f64().filter(|_| has_error) {
                    let row = shown.row("Error");
                    let (own, bound) = (number(row), number(row.split('±').nth(1).unwrap()));
                    // Errors above 10 % are printed without decimals.
                    let margin = bound
                        + (0.02 * error).max(0.5)
                        + json["probes"][0]["reference"]["own_error_percent"].as_f64().unwrap_or(0.0);
                    assert!((own - error).abs() <= margin, "{what}: {row}, solve {error} %");
                    assert!(
                        text(&shown, "ERROR ").starts_with("ERROR \u{2248} "),
                        "{what}: {}",
                        text(&shown, "ERROR ")
                    );
                }
            }
            assert!(checked >= 8, "{id}, {method:?}: {checked} positions converge");
            harness.drop_at(foot + arrow(tip - foot, POSITIONS - 1));
            harness.run();
        }
    }
}

/// Beyond the limit of the method the last equilibrium is drawn while the load points the same way, and the body at rest
/// when it does not; one message has the remedy.
#[test]
fn beyond_the_limit_the_drawn_body_belongs_to_a_load_of_the_same_direction() {
    let mut harness = harness("article");
    let set = |harness: &mut Harness<'_, Lab>, force: [f64; 2]| {
        let mut scene = harness.state().scene().clone();
        scene.set_force(warpbeam::LoadId::nth(0), force).unwrap();
        harness.state_mut().set_scene(scene).unwrap();
        harness.run();
        shown(harness)
    };
    let label = |shown: &Shown| shown.0.iter().find(|text| text.contains("not reached")).cloned();
    let down = set(&mut harness, [0.0, -176e3]);
    assert_eq!(label(&down).as_deref(), Some("equilibrium at 30 kN; 176 kN not reached"));
    let up = set(&mut harness, [0.0, 176e3]);
    assert_eq!(label(&up).as_deref(), Some("equilibrium at 0 N; 176 kN not reached"));
    assert_eq!(
        up.0.iter().filter(|text| text.contains("iverge") || text.contains("converge")).count(),
        1,
        "{:?}",
        up.0
    );
    // The last equilibrium is not forgotten.
    let back = set(&mut harness, [10e3, -176e3]);
    assert!(label(&back).is_some_and(|text| text.starts_with("equilibrium at 30 kN")), "{back:?}");
}
