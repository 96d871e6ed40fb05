//! Every frame of a drag is an equilibrium: body, arrow and numbers belong to the load under the pointer.

use std::time::Duration;

use crate::common::lab::*;
use crate::numbers::{Shown, solve};
use egui::Vec2;

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

/// Returns the text that starts with a name.
fn text<'a>(shown: &'a Shown, name: &str) -> &'a str {
    shown.starting_with(name).unwrap_or_else(|| panic!("no {name:?}: {:?}", shown.0))
}

/// Returns the number at the start of a text, percent.
fn number(text: &str) -> f64 {
    text.split_whitespace().find_map(|word| word.parse().ok()).unwrap_or_else(|| panic!("no number in {text:?}"))
}

/// Its numbers are those of a solve at the load, and the error is, within its "≈"; nothing is grey or a dash.
#[test]
fn every_frame_of_a_drag_is_an_equilibrium() {
    for id in ["article", "cantilever", "bridge", "cook", "incline"] {
        let mut ui = open(id);
        ui.state_mut().desk.session.frame.limit = Duration::from_secs(20);
        unfold(&mut ui, "stable");
        for method in [MethodKind::Warped, MethodKind::Newton, MethodKind::Linear] {
            ui.state_mut().set_scene(scene(id).with_method(method)).unwrap();
            ui.run();
            let is_small = ui.simulation().system().dofs() <= 2000;
            settle(&mut ui);
            wait(&mut ui, "the live reference", |lab| !lab.desk.session.is_following());
            let is_shown = |name: &str| !text(&Shown::labels(&ui), name).contains('\u{2013}');
            // The time of a long solve is that of the last rest.
            let (has_error, has_time) = (is_small && is_shown("ERROR "), is_shown("TIME "));
            let (foot, tip) = (ui.state().arrow_feet()[0], ui.tip());
            ui.hold(tip);
            let mut checked = 0;
            for position in sampled(0..POSITIONS, 10) {
                let what = format!("{id}, {method:?}, position {position}");
                let wanted = arrow(tip - foot, position);
                ui.hover_at(foot + wanted);
                // The window lays out a frame with an edit twice.
                ui.run_steps(2);
                let lab = ui.state();
                let mut alone = Simulation::new(lab.scene()).unwrap();
                if *alone.solve() != Status::Converged {
                    assert_eq!(method, MethodKind::Warped, "{what}: {:?}", alone.status());
                    continue;
                }
                checked += 1;
                let drawn = (lab.simulation().scene(), lab.simulation().status());
                assert_eq!(drawn, (lab.scene(), &Status::Converged), "{what}");
                let drawn = lab.arrow_tips()[0].1 - lab.arrow_feet()[0];
                assert!(wanted.length() < 20.0 || (drawn - wanted).length() < 3.0, "{what}: {drawn} {wanted}");
                let u = |body: &Simulation| body.solution().probes[0].u;
                assert!((u(lab.simulation()) - u(&alone)).norm() <= 1e-5 * u(&alone).norm() + 1e-9, "{what}");
                let shown = Shown::labels(&ui);
                assert!(shown.starting_with("Converged").is_some(), "{what}: {:?}", shown.0);
                assert!(!shown.0.iter().any(|text| text.contains("not reached")), "{what}");
                assert!(!has_time || !text(&shown, "TIME ").contains('\u{2013}'), "{what}");
                if has_error {
                    assert!(!text(&shown, "ERROR ").contains('\u{2013}'), "{what}: {}", text(&shown, "ERROR "));
                }
                let strain = engineering(three_digits(100.0 * alone.solution().deformation.max_strain), "%");
                let row = shown.row("Strain");
                assert!(row.starts_with(&strain) || !is_small, "{what}: {strain}, {row}");
                if method == MethodKind::Warped && is_small {
                    let rho = alone.certify().fixed_point_rho.map(|rho| engineering(two_digits(rho), ""));
                    assert_eq!(text(&shown, "ρ "), format!("ρ {} per iteration", rho.unwrap()), "{what}");
                }
                if position % 50 != 20 {
                    continue;
                }
                wait(&mut ui, "the live reference", |lab| !lab.desk.session.is_following());
                ui.step();
                let (shown, json) = (Shown::labels(&ui), solve(ui.scene()));
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
                    let references = json["probes"][0]["reference_error_percent"].as_f64().unwrap_or(0.0);
                    let margin = bound + (0.02 * error).max(0.5) + references;
                    assert!((own - error).abs() <= margin, "{what}: {row}, solve {error} %");
                    let bar = text(&shown, "ERROR ");
                    assert!(bar.starts_with("ERROR ≈ ") || bar.starts_with("ERROR ≤ "), "{what}: {bar}");
                }
            }
            assert!(checked >= 8, "{id}, {method:?}: {checked} positions converge");
            ui.release(foot + arrow(tip - foot, POSITIONS - 1));
        }
    }
}

/// To the border and back, body and arrow are in view, no label covers another, and the force is that of the pointer.
#[test]
fn a_dragged_body_stays_in_view() {
    let sizes = [[1280.0, 800.0], [960.0, 600.0], [800.0, 900.0], [640.0, 480.0]];
    let ids = ["article", "cantilever", "bridge", "cook", "incline"];
    let cases = (0..320).map(|case| (ids[case % 5], sizes[case / 5 % 4], case / 20));
    for case @ (id, size, direction) in sampled(cases, 19) {
        let mut lab = lab_of(id, scene(id));
        lab.desk.session.frame.limit = Duration::from_secs(20);
        let mut ui = window(size, lab);
        ui.run();
        let (tip, way) = (ui.tip(), Vec2::angled(std::f32::consts::TAU * direction as f32 / 16.0));
        let view = ui.state().view_rect().expand(1.0);
        let to_border = (0..2000).take_while(|step| view.contains(tip + way * *step as f32)).count();
        let mut forces = std::collections::BTreeMap::from([(0, ui.force())]);
        ui.hold(tip);
        for step in (1..=6).chain((0..6).rev()) {
            let scale = ui.camera().scale;
            ui.move_to(tip + way * (to_border * step / 6) as f32);
            ui.step();
            assert!(ui.camera().scale <= scale, "{case:?}, {step}: it moves nearer");
            let places = ui.state().frame().positions.iter().map(|place| in_view(ui.state(), *place));
            let outside = places.chain([ui.tip()]).map(|at| view.signed_distance_to_pos(at)).fold(-1e9, f32::max);
            assert!(outside <= 0.0, "{case:?}, {step}: body or arrow leave the view by {outside}");
            assert_eq!(covered_text(&ui), None, "{case:?}, {step}");
            let [before, now] = [*forces.entry(step).or_insert(ui.force()), ui.force()].map(Vector2::from);
            assert!((now - before).norm() <= 1e-3 * now.norm(), "{case:?}, {step}: {now} {before}");
        }
        ui.release(tip);
    }
}

/// Beyond the limit the body is at rest, or in an equilibrium of the same direction; one message has the remedy.
#[test]
fn beyond_the_limit_the_drawn_body_belongs_to_a_load_of_the_same_direction() {
    let mut ui = open("article");
    let set = |ui: &mut Ui, force: [f64; 2]| {
        ui.edit(|scene| scene.set_force(0, force).unwrap());
        ui.run();
        Shown::labels(ui)
    };
    let label = |shown: &Shown| shown.0.iter().find(|text| text.contains("not reached")).cloned();
    assert_eq!(label(&set(&mut ui, [0.0, -176e3])).as_deref(), Some("equilibrium at 30 kN; 176 kN not reached"));
    let up = set(&mut ui, [0.0, 176e3]);
    assert_eq!(label(&up).as_deref(), Some("equilibrium at 0 N; 176 kN not reached"));
    let about = up.0.iter().filter(|text| text.contains("iverge") || text.contains("converge"));
    assert_eq!(about.count(), 1, "{:?}", up.0);
    // The last equilibrium is not forgotten.
    let back = set(&mut ui, [10e3, -176e3]);
    assert!(label(&back).is_some_and(|text| text.starts_with("equilibrium at 30 kN")), "{back:?}");
}

/// Beyond the limit the reference under the load of the hand is drawn, and has its name.
#[test]
fn beyond_the_limit_the_reference_follows_the_hand() {
    let mut ui = open("cantilever");
    settle(&mut ui);
    let (foot, tip) = (ui.state().arrow_feet()[0], ui.tip());
    ui.hold(tip);
    for part in [1.8, 2.6] {
        ui.hover_at(foot + part * (tip - foot));
        ui.run_steps(2);
        let name = format!("reference at {}", engineering(three_digits(Vector2::from(ui.force()).norm()), "N"));
        ui.wait_until("the reference", |ui| painted(ui).iter().any(|(_, text)| *text == name));
        assert_ne!(*ui.state().simulation().status(), Status::Converged, "{part}");
    }
}

/// A press in the middle of the shaft drags the arrow as one on its tip does, and does not move the view.
#[test]
fn a_shaft_is_dragged_as_its_tip() {
    let force = |at: f32| {
        let mut ui = open("cantilever");
        settle(&mut ui);
        let (foot, tip) = (ui.state().arrow_feet()[0], ui.tip());
        let pressed = foot + at * (tip - foot);
        ui.hold(pressed);
        ui.hover_at(pressed + Vec2::new(30.0, 20.0));
        ui.run_steps(2);
        ui.force()
    };
    assert_eq!(force(0.5), force(1.0));
    assert!(force(0.5)[0] > 0.0);
}
