//! Tests of pointer interaction with the body, its loads and its values, and of edits, without a display or a GPU.

use crate::common::lab::{lab_of, settle, type_into, unfold, wait, window};
use crate::common::{scene, solve_json};
use egui::accesskit::Role;
use egui::os::OperatingSystem;
use egui::{Event, Key, Modifiers, Pos2, Rect, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::Vector2;
use warpbeam::app::{FOCUS_KEYS, Lab, MOUSE};
use warpbeam::format::percent;
use warpbeam::scene::{Analysis, ElementKind, Load, LoadId, MethodKind, Place, Source};
use warpbeam::{Field, PointValues, Simulation, Status};

/// Time between frames, s; short enough for double clicks within a few frames.
const STEP: f32 = 0.05;

pub fn harness(id: &str) -> Harness<'static, Lab> {
    harness_of(id, scene(id))
}

pub fn harness_of(id: &str, scene: warpbeam::Scene) -> Harness<'static, Lab> {
    let lab = lab_of(id, scene);
    let mut harness =
        Harness::builder().with_size([1280.0, 800.0]).with_max_steps(2000).with_step_dt(STEP).build_ui_state(
            |ui, lab: &mut Lab| {
                lab.advance(ui.input(|i| i.time));
                lab.ui(ui);
            },
            lab,
        );
    harness.run();
    harness
}

fn force(lab: &Lab) -> [f64; 2] {
    let forces =
        lab.scene().loads.iter().filter_map(|l| if let Load::Force { force, .. } = l { Some(*force) } else { None });
    forces.into_iter().next().unwrap()
}

fn tip(lab: &Lab) -> Pos2 {
    lab.arrow_tips()[0].1
}

/// Returns the window position of a point of the plane.
fn in_window(lab: &Lab, place: Vector2<f64>) -> Pos2 {
    let [x, y] = lab.camera().to_view(place);
    lab.view_rect().center() + vec2(x as f32, y as f32)
}

/// Returns the window position of a material point.
pub fn on_body(lab: &Lab, at: Vector2<f64>) -> Pos2 {
    let mesh = lab.simulation().system().mesh();
    let weights = mesh.weights(mesh.locate(at).unwrap()).unwrap();
    let u = lab.simulation().displacement();
    in_window(lab, weights.iter().map(|&(n, w)| (mesh.nodes()[n as usize] + u[n as usize]) * w).sum())
}

/// Drags from one position to another through some in between, and releases.
pub fn drag(harness: &mut Harness<'_, Lab>, from: Pos2, to: Pos2, modifiers: Modifiers) {
    let button = |pos, pressed| Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers };
    harness.hover_at(from);
    harness.run();
    harness.event(Event::ModifiersChanged(modifiers));
    harness.event(button(from, true));
    harness.step();
    for i in 1..=4 {
        harness.hover_at(from + (to - from) * (i as f32 / 4.0));
        harness.step();
    }
    harness.event(button(to, false));
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run();
}

/// Returns the text in the number field of this label.
fn shown(harness: &Harness<'_, Lab>, label: &str) -> String {
    harness.get_by_role_and_label(Role::SpinButton, label).accesskit_node().value().unwrap_or_default()
}

/// The dragged tip sets force and direction; arrow, sliders and `solve` agree.
#[test]
fn dragging_the_tip_of_the_arrow_sets_the_force() {
    let mut harness = harness("cantilever");
    let camera = harness.state().camera();
    let before = tip(harness.state());
    let start = on_body(harness.state(), Vector2::new(10.0, 0.0));
    let target = before + vec2(-30.0, -12.0);
    drag(&mut harness, before, target, Modifiers::NONE);
    let lab = harness.state();
    let [fx, fy] = force(lab);
    let vector = target - start;
    let wanted = f64::from(-vector.y).atan2(f64::from(vector.x)).to_degrees();
    let direction = fy.atan2(fx).to_degrees();
    assert!((direction - wanted).abs() < 0.6, "the arrow points to {wanted}°, the force to {direction}°");
    let shorter = f64::from(vector.length() / (before - start).length());
    assert!((fx.hypot(fy) / 1000.0 - shorter).abs() < 0.02, "an arrow of {shorter} times the length: {fx} {fy}");
    assert_eq!(*lab.simulation().status(), Status::Converged);
    let direction_shown = shown(&harness, "Direction");
    assert!(direction_shown.starts_with(&format!("{direction:.0}")), "{direction_shown} {direction}");
    let json = solve_json(&["cantilever", "--set", &format!("load.0.force=[{fx},{fy}]")]);
    let solved = [0, 1].map(|i| json["probes"][0]["u"][i].as_f64().unwrap());
    let u = lab.simulation().solution().probes[0].u;
    assert!((u - Vector2::from(solved)).norm() < 1e-5 * u.norm(), "{u} {solved:?}");
    // The arrow keeps its dragged length, wherever the body has moved.
    let length = (tip(lab) - on_body(lab, Vector2::new(10.0, 0.0))).length();
    assert!((length - vector.length()).abs() < 1.5, "{length} {}", vector.length());
    assert_ne!(lab.camera(), camera, "the view did not follow the body afterwards");
}

/// When a scene has been opened, dragging the tip by the length of its arrow doubles the force. A pixel changes the
/// force by 1 to 2 %, and by a tenth of that with Ctrl. A drag of 10 points bends the article's beam by a small amount.
#[test]
fn an_arrow_of_twice_the_length_is_twice_the_force() {
    for id in ["article", "cantilever", "elastica", "clip", "jump"] {
        let mut harness = harness(id);
        let size = |harness: &Harness<'_, Lab>| {
            let [x, y] = force(harness.state());
            x.hypot(y)
        };
        let own = size(&harness);
        let (from, to) = (harness.state().arrow_feet()[0], tip(harness.state()));
        let vector = to - from;
        drag(&mut harness, to, to + vector, Modifiers::NONE);
        assert!((size(&harness) / (2.0 * own) - 1.0).abs() < 0.02, "{id}: {own} N, then {} N", size(&harness));
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        for (modifiers, part) in [(Modifiers::NONE, 1.0), (Modifiers::CTRL, 0.1)] {
            let to = tip(harness.state());
            drag(&mut harness, to, to + vector.normalized() * 10.0, modifiers);
            let rate = (size(&harness) / own - 1.0) / 10.0;
            assert!((0.01 * part..=0.0205 * part).contains(&rate), "{id}: {rate} a point, {modifiers:?}");
            assert!(harness.state().simulation().status().is_success(), "{id}");
            key(&mut harness, Modifiers::COMMAND, Key::Z);
        }
    }
}

/// Under a load that the method cannot follow, the last equilibrium stays in place, in an unchanged view, and the
/// window reports this. The remedy is one click away.
#[test]
fn a_force_dragged_too_far_keeps_the_last_equilibrium_in_view() {
    let mut harness = harness("article");
    harness.state_mut().set_frame_work(std::time::Duration::from_secs(20));
    let camera = harness.state().camera();
    let to = tip(harness.state());
    harness.hover_at(to);
    harness.run();
    harness.drag_at(to);
    harness.step();
    for i in 1..=40_u8 {
        harness.hover_at(to + vec2(0.0, 5.0 * f32::from(i)));
        for _ in 0..4 {
            harness.step();
            assert_eq!(harness.state().camera(), camera, "the view moved under the pointer");
            let load_point = harness.state().arrow_feet()[0];
            let view = harness.state().view_rect();
            assert!(view.contains(load_point), "{load_point} is not within {view}");
        }
    }
    harness.run();
    assert!(matches!(harness.state().simulation().status(), Status::Diverged(_)));
    assert!(harness.state().view_rect().contains(harness.state().arrow_feet()[0]));
    harness.drop_at(to + vec2(0.0, 200.0));
    harness.run();
    assert!(harness.query_all_by_label_contains("not reached").next().is_some());
    assert!(harness.query_all_by_label_contains("last equilibrium").next().is_none(), "said twice");
    // No error is shown for the hidden state.
    let mut frames = 0;
    while harness.state().is_computing() {
        std::thread::sleep(std::time::Duration::from_millis(10));
        harness.step();
        frames += 1;
        assert!(frames < 6000, "the reference is never known");
    }
    harness.run();
    harness.get_by_label_contains("ERROR \u{2013}");
    harness.get_by_label_contains("TIME \u{2013}");
    harness.get_by_label("Use newton").click();
    harness.run();
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
}

/// In place of a state that diverges everything shown belongs to the last equilibrium: the label on the body names its
/// load, and the details have its displacement and energy.
#[test]
fn numbers_beside_the_last_equilibrium_are_its_own() {
    let mut harness = harness("article");
    unfold(&mut harness, "stable");
    let details = |harness: &Harness<'_, Lab>| {
        let nodes = harness.get_all_by_role(Role::Label);
        let values: Vec<String> = nodes.filter_map(|node| node.accesskit_node().value()).collect();
        let after = |name: &str| {
            let at = values.iter().position(|value| value == name);
            at.map_or_else(String::new, |at| values[at + 1].clone())
        };
        ["tip Δx, Δy", "Energy", "Equilibrium", "Iterations", "ρ"].map(after)
    };
    let quality = |harness: &Harness<'_, Lab>| {
        let nodes = harness.get_all_by_role(Role::Label);
        let values: Vec<String> = nodes.filter_map(|node| node.accesskit_node().value()).collect();
        ["Mesh error", "Stress", "Strain"].map(|name| {
            let at = values.iter().position(|value| value == name).unwrap();
            values[at + 1].clone()
        })
    };
    let (before, quality_before) = (details(&harness), quality(&harness));
    assert!(quality_before[1].contains("797 kPa"), "{quality_before:?}");
    assert!(before[0].ends_with(" m") && before[1].ends_with("kJ"), "{before:?}");
    assert!(
        before[3].starts_with("21 since the last change, residual") && before[4].contains("ρ = 0.47"),
        "{before:?}"
    );
    type_into(&mut harness, "Force", "176000");
    assert!(matches!(harness.state().simulation().status(), Status::Diverged(_)));
    // On the body and in Details.
    assert_eq!(harness.query_all_by_label("equilibrium at 30 kN; 176 kN not reached").count(), 2);
    let mut now = details(&harness);
    now[3] = now[3].replace("to the state that is drawn", "since the last change");
    now[4] = now[4].replace("At 30 kN: ", "");
    assert_eq!(now, before);
    // Stress, strain and mesh error are those of the drawn state too.
    harness.state_mut().solve();
    harness.run();
    assert_eq!(quality(&harness), quality_before);
    harness.get_by_label_contains("ERROR \u{2013}");
    harness.get_by_label_contains("TIME \u{2013}");
    // ρ at the equilibrium that is not reached.
    harness.state_mut().solve();
    harness.run();
    harness.get_by_label_contains("ρ 4.9 at 176 kN");
    harness.get_by_label("Use newton").click();
    harness.run();
    assert!(harness.query_by_label_contains("not reached").is_none());
    assert_ne!(details(&harness), before);
}

/// The pane of Compare with the panel's setting shows the equilibrium that Details describes, also after a load was dragged
/// over several equilibria.
#[test]
fn a_pane_with_the_panels_setting_shows_the_equilibrium_of_the_panel() {
    let mut harness = harness("article");
    unfold(&mut harness, "stable");
    harness.get_by_label("Compare").click();
    harness.run();
    let slider = harness.get_by_role_and_label(Role::Slider, "Force").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.hover_at(at(0.4));
    harness.drag_at(at(0.4));
    harness.run_steps(4);
    for share in [0.42, 0.44, 0.5, 0.55, 0.6, 0.63, 0.66, 0.7, 0.75, 0.8] {
        harness.hover_at(at(share));
        harness.run_steps(4);
    }
    harness.drop_at(at(0.8));
    harness.run();
    let notes: Vec<String> =
        crate::points::painted(&harness).into_iter().filter(|text| text.contains("not reached")).collect();
    let force = force(harness.state());
    assert!(notes.len() >= 2 && notes.iter().all(|note| *note == notes[0]), "{notes:?} {force:?}");
}

/// A scene whose first state diverges shows the body at rest, an equilibrium without load, and no number of the state
/// that diverges.
#[test]
fn a_scene_that_opens_with_too_large_a_load_shows_the_body_at_rest() {
    let mut large = scene("article");
    large.set_force(LoadId::nth(0), [0.0, -176e3]).unwrap();
    let mut harness = harness_of("article", large);
    unfold(&mut harness, "stable");
    assert!(matches!(harness.state().simulation().status(), Status::Diverged(_)));
    assert_eq!(harness.query_all_by_label("equilibrium at 0 N; 176 kN not reached").count(), 2);
    let values: Vec<String> =
        harness.get_all_by_role(Role::Label).filter_map(|node| node.accesskit_node().value()).collect();
    let at = values.iter().position(|value| value == "tip Δx, Δy").unwrap_or_else(|| panic!("{values:?}"));
    assert_eq!(values[at + 1], "(0, 0) m");
    harness.get_by_label_contains("ERROR \u{2013}");
    harness.get_by_label("Use newton").click();
    harness.run();
    assert!(harness.query_by_label_contains("not reached").is_none());
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
}

/// A result that was accepted early has an error, whose source may be the early stop, and an explanation; it is not said
/// to be another equilibrium.
#[test]
fn an_accepted_result_has_an_error_and_an_explanation() {
    let mut early = scene("article");
    early.solver.accept_after = 3;
    let error = solve_json(&["article", "--set", "solver.accept_after=3"])["probes"][0]["error_percent"].as_f64();
    let mut lab = lab_of("article", early);
    lab.solve();
    let mut harness = window([1280.0, 800.0], lab);
    harness.run_steps(4);
    harness.get_by_label(&format!("ERROR {} mesh or iteration · strain 55 %", percent(error.unwrap())));
    harness.get_by_label("Accepted · 3 iterations");
    assert!(harness.query_by_label_contains("another equilibrium").is_none());
    harness.get_by_label("explain").click();
    harness.run();
    harness.get_by_label_contains(
        "Accepted after 3 iterations from rest, as the scene asks: the relative residual is 0.02",
    );
    // The remedy of an early stop is to go on, not a finer mesh.
    harness.get_by_label("47 % error: the iteration is stopped early.");
    harness.get_by_label("Iterate to the tolerance").click();
    harness.step();
    assert_eq!(harness.state().scene().solver.accept_after, 0);
    wait(&mut harness, "equilibrium", |lab| *lab.simulation().status() == Status::Converged);
    // The number can be typed; beyond ρ = 1 a result is said to diverge if it runs on.
    type_into(&mut harness, "Accept after", "3");
    assert_eq!(harness.state().scene().solver.accept_after, 3);
    type_into(&mut harness, "Force", "60000");
    settle(&mut harness);
    harness.get_by_label("Accepted · 3 iterations · diverges if it runs on");
    // Its error depends on the state before; that of a solve from rest, whose time is shown, stands beside it.
    let settings = ["article", "--set", "solver.accept_after=3", "--set", "load.0.force=[0,-60000]"];
    let error = solve_json(&settings)["probes"][0]["error_percent"].as_f64();
    let from_rest = format!("from rest {}", percent(error.unwrap()));
    wait(&mut harness, "a solve from rest", |lab| !lab.is_computing());
    harness.run_steps(2);
    let node = harness.get_by_label_contains(&from_rest).accesskit_node();
    let error = node.label().or_else(|| node.value()).unwrap();
    assert!(error.starts_with("ERROR "), "{error}");
    let error = &from_rest["from rest ".len()..];
    harness.get_by_label(&format!("{error} error from rest: the iteration is stopped early."));
    harness.get_by_label("Use newton").click();
    wait(&mut harness, "equilibrium", |lab| *lab.simulation().status() == Status::Converged);
    assert_eq!(harness.state().scene().solver.accept_after, 0);
}

/// The number of iterations in the status is that of a solve from rest, as TIME is, whatever the load before was, and
/// after an edit that needs no iteration.
#[test]
fn iterations_are_counted_from_rest() {
    let mut harness = harness("article");
    for force in ["32000", "33000", "32000"] {
        type_into(&mut harness, "Force", force);
        settle(&mut harness);
        let load = format!("load.0.force=[0,-{force}]");
        let solved = solve_json(&["article", "--set", &load]);
        harness.get_by_label(&format!("Converged · stable · {} iterations", solved["iterations"]));
        assert_ne!(Some(u64::from(harness.state().simulation().iterations())), solved["iterations"].as_u64());
    }
    unfold(&mut harness, "Held at");
    harness.get_by_role_and_label(Role::Button, "Probe").click();
    harness.run_steps(3);
    settle(&mut harness);
    harness.run_steps(2);
    assert_eq!(harness.state().simulation().iterations(), 0);
    harness.get_by_label_contains("Converged · stable · 24 iterations");
}

/// A body that is held is not said to be at another equilibrium than the one to which loading leads.
#[test]
fn a_held_body_has_no_note_of_another_equilibrium() {
    let mut lab = lab_of("article", scene("article").with_element(ElementKind::T6).with_method(MethodKind::Newton));
    lab.solve();
    let mut harness = window([1280.0, 800.0], lab);
    harness.run_steps(40);
    let pos = on_body(harness.state(), Vector2::new(2.5, 0.0));
    harness.hover_at(pos);
    harness.step();
    harness.drag_at(pos);
    harness.step();
    for step in 1..20 {
        harness.hover_at(pos + vec2(0.0, -6.0 * step as f32));
        harness.step();
    }
    harness.run_steps(60);
    assert!(harness.state().simulation().mouse_spring().is_some());
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    assert!(harness.query_by_label_contains("another equilibrium").is_none());
}

/// A drag moves the object that was pressed, even if the pointer has moved on before the next frame.
#[test]
fn a_press_acts_on_the_target_under_it_in_late_frames_too() {
    let mut harness = harness("cantilever");
    let (camera, pos) = (harness.state().camera(), tip(harness.state()));
    harness.hover_at(pos);
    harness.run();
    let button =
        Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed: true, modifiers: Modifiers::NONE };
    harness.input_mut().events.extend([button, Event::PointerMoved(pos + vec2(-60.0, -45.0))]);
    harness.step();
    harness.step();
    assert_eq!(harness.state().camera(), camera, "the view was taken in the place of the tip");
    assert!(force(harness.state())[0] < 0.0, "{:?}", force(harness.state()));
    harness.drop_at(pos + vec2(-60.0, -45.0));
    harness.run();
}

/// With Shift, the direction is a multiple of 15°. An arrow dragged onto its foot is a zero force,
/// and can be dragged out again.
#[test]
fn shift_snaps_the_direction_and_a_force_can_be_dragged_away_and_back() {
    let mut harness = harness("cantilever");
    let before = tip(harness.state());
    drag(&mut harness, before, before + vec2(31.0, 4.0), Modifiers::SHIFT);
    let [fx, fy] = force(harness.state());
    let direction = fy.atan2(fx).to_degrees();
    assert!((direction / 15.0 - (direction / 15.0).round()).abs() < 1e-9 && direction != -90.0, "{direction}");
    let (from, to) = (tip(harness.state()), on_body(harness.state(), Vector2::new(10.0, 0.0)));
    drag(&mut harness, from, to, Modifiers::NONE);
    assert_eq!(force(harness.state()), [0.0, 0.0]);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    let stub = tip(harness.state());
    drag(&mut harness, stub, stub + vec2(0.0, -90.0), Modifiers::NONE);
    assert!(force(harness.state())[1] > 0.0, "{:?}", force(harness.state()));
}

/// A press selects one object: the tip before the body below it, the body before the background.
#[test]
fn a_press_takes_the_tip_or_the_body_or_the_view_and_never_two() {
    let mut harness = harness("article");
    // An arrow along the beam, inwards, so that its tip is over the body.
    let mut inwards = harness.state().scene().clone();
    inwards.set_force(LoadId::nth(0), [-2_000.0, 0.0]).unwrap();
    harness.state_mut().set_scene(inwards).unwrap();
    harness.run();
    let (camera, tip) = (harness.state().camera(), tip(harness.state()));
    harness.hover_at(tip);
    harness.run();
    assert_eq!(harness.output().platform_output.cursor_icon, egui::CursorIcon::Move);
    let before = force(harness.state());
    harness.drag_at(tip);
    harness.step();
    harness.hover_at(tip + vec2(-25.0, 0.0));
    harness.step();
    assert!(harness.state().simulation().mouse_spring().is_none(), "the body was taken with the tip");
    assert_ne!(force(harness.state()), before);
    assert_eq!(harness.state().camera(), camera, "the view moved with the tip");
    harness.drop_at(tip + vec2(-25.0, 0.0));
    harness.run();
    let (before, camera) = (force(harness.state()), harness.state().camera());
    let body = on_body(harness.state(), Vector2::new(1.0, 0.0));
    harness.hover_at(body);
    harness.run();
    assert_eq!(harness.output().platform_output.cursor_icon, egui::CursorIcon::Grab);
    harness.drag_at(body);
    harness.step();
    harness.hover_at(body + vec2(0.0, 60.0));
    harness.step();
    assert!(harness.state().simulation().mouse_spring().is_some());
    assert_eq!((force(harness.state()), harness.state().camera()), (before, camera));
    harness.drop_at(body + vec2(0.0, 60.0));
    harness.run();
    let space = harness.state().view_rect().center() + vec2(0.0, 290.0);
    let camera = harness.state().camera();
    drag(&mut harness, space, space + vec2(50.0, -30.0), Modifiers::NONE);
    assert_eq!(force(harness.state()), before);
    let moved = camera.to_world([0.0, 0.0]) - harness.state().camera().to_world([50.0, -30.0]);
    assert!(moved.norm() < 1e-2 / camera.scale.min(1.0), "the view did not follow the pointer: {moved}");
}

fn key(harness: &mut Harness<'_, Lab>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Pausing a motion does not pause the static scene that replaces it.
#[test]
fn a_scene_opened_while_another_is_paused_is_solved() {
    let mut harness = harness("article");
    harness.get_by_role_and_label(Role::ComboBox, "Scene").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "swing").scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "swing").click();
    harness.run_steps(4);
    assert!(harness.state().simulation().motion().is_some());
    harness.key_press(Key::Space);
    harness.run();
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().scene().name, "The article's beam");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
}

/// A drag is one undo step, whatever its intermediate values; steps are undone and redone in order.
#[test]
fn edits_are_undone_and_redone() {
    let mut harness = harness("cantilever");
    assert!(!harness.state().can_undo() && !harness.state().can_redo());
    let start = harness.state().scene().clone();
    let tip_now = tip(harness.state());
    drag(&mut harness, tip_now, tip_now + vec2(-30.0, -12.0), Modifiers::NONE);
    let dragged = force(harness.state());
    unfold(&mut harness, "Poisson ν");
    let slider = harness.get_by_role_and_label(Role::Slider, "Poisson ν").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    drag(&mut harness, at(0.3), at(0.6), Modifiers::NONE);
    let poisson = harness.state().scene().material.poisson;
    assert_ne!(poisson, start.material.poisson);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().scene().material.poisson, start.material.poisson);
    assert_eq!(force(harness.state()), dragged);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), start);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    assert!(!harness.state().can_undo() && harness.state().can_redo());
    key(&mut harness, Modifiers::COMMAND, Key::Y);
    key(&mut harness, COMMAND_SHIFT, Key::Z);
    assert_eq!((force(harness.state()), harness.state().scene().material.poisson), (dragged, poisson));
    assert!(!harness.state().can_redo());
    // Opening another scene is a step too; undo restores the previous scene with its edits.
    harness.get_by_role_and_label(Role::ComboBox, "Scene").click();
    harness.run();
    harness.get_by_label("bridge").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Discard").click();
    harness.run();
    assert_eq!(harness.state().scene().name, "Bridge");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!((force(harness.state()), harness.state().scene().material.poisson), (dragged, poisson));
    assert!(harness.state().title().contains("Cantilever*"), "{}", harness.state().title());
    let json = solve_json(&[
        "cantilever",
        "--set",
        &format!("load.0.force={dragged:?}"),
        "--set",
        &format!("material.poisson={poisson}"),
    ]);
    let u = harness.state().simulation().solution().probes[0].u;
    assert!((u.y - json["probes"][0]["u"][1].as_f64().unwrap()).abs() < 1e-5 * u.norm());
}

/// A double click on the tip restores the scene's own force, and does not fit the view.
#[test]
fn a_double_click_on_the_tip_resets_the_force() {
    let mut harness = harness("cantilever");
    let before = force(harness.state());
    let from = tip(harness.state());
    drag(&mut harness, from, from + vec2(-30.0, -12.0), Modifiers::NONE);
    assert_ne!(force(harness.state()), before);
    let from = tip(harness.state());
    harness.hover_at(from);
    for _ in 0..2 {
        harness.drag_at(from);
        harness.step();
        harness.drop_at(from);
        harness.step();
    }
    harness.run();
    assert_eq!(force(harness.state()), before);
}

/// Clicks twice in one place, as fast as a double click.
fn double_click(harness: &mut Harness<'_, Lab>, at: Pos2) {
    harness.hover_at(at);
    harness.run();
    for _ in 0..2 {
        harness.drag_at(at);
        harness.step();
        harness.drop_at(at);
        harness.step();
    }
    harness.run();
}

/// A double click on a slider or its number, or Delete on the slider, restores the scene's own value in one step.
#[test]
fn values_go_back_to_those_of_the_scene() {
    let mut harness = harness("cantilever");
    for (label, text) in
        [("Force", "77"), ("Direction", "-60"), ("Young E", "2e6"), ("Density", "77"), ("Cells along", "40")]
    {
        unfold(&mut harness, label);
        for by in ["slider", "number", "key"] {
            type_into(&mut harness, label, text);
            let edited = harness.state().scene().clone();
            assert_ne!(edited, scene("cantilever"), "{label}");
            match by {
                "slider" => {
                    let place = harness.get_by_role_and_label(Role::Slider, label).rect().center();
                    double_click(&mut harness, place);
                }
                "number" => {
                    let place = harness.get_by_role_and_label(Role::SpinButton, label).rect().center();
                    double_click(&mut harness, place);
                    assert!(!harness.ctx.text_edit_focused(), "{label}: still being typed");
                }
                _ => {
                    harness.get_by_role_and_label(Role::Slider, label).focus();
                    harness.run();
                    key(&mut harness, Modifiers::NONE, Key::Delete);
                }
            }
            assert_eq!(*harness.state().scene(), scene("cantilever"), "{label} by {by}");
            key(&mut harness, Modifiers::COMMAND, Key::Z);
            assert_eq!(*harness.state().scene(), edited, "{label} by {by}: not one step");
            key(&mut harness, Modifiers::COMMAND, Key::Z);
            assert_eq!(*harness.state().scene(), scene("cantilever"), "{label} by {by}");
        }
    }
    // Two drags are two steps.
    let slider = harness.get_by_role_and_label(Role::Slider, "Force").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    drag(&mut harness, at(0.4), at(0.5), Modifiers::NONE);
    let once = harness.state().scene().clone();
    harness.run_steps(10);
    drag(&mut harness, at(0.5), at(0.6), Modifiers::NONE);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), once);
    // The tooltip of the control says so, but not under the pointer that has just dragged it.
    let tip = "Double click, or Delete on the slider: 1 kN";
    harness.hover_at(at(0.3));
    harness.run_steps(60);
    assert!(harness.query_all_by_label_contains(tip).next().is_none());
    harness.hover_at(slider.center() - egui::vec2(400.0, 0.0));
    harness.run_steps(2);
    harness.hover_at(at(0.2));
    harness.run_steps(60);
    assert!(harness.query_all_by_label_contains(tip).next().is_some());
}

fn moment(lab: &Lab) -> f64 {
    let moments = lab.scene().loads.iter();
    moments.filter_map(|l| if let Load::Moment { moment, .. } = l { Some(*moment) } else { None }).next().unwrap()
}

/// Dragging the end of a moment's arrow around its centre changes the moment: further is larger, and back beyond the
/// start is the opposite sense. The body follows as with `solve`, and a drag is one step.
#[test]
fn the_end_of_a_moments_arrow_sets_it() {
    let mut harness = harness("roll-up");
    let before = moment(harness.state());
    let center = |lab: &Lab| {
        let mesh = lab.simulation().system().mesh();
        let (nodes, u) = (mesh.edge_nodes("right").unwrap(), lab.simulation().displacement());
        let sum: Vector2<f64> = nodes.iter().map(|&n| mesh.nodes()[n as usize] + u[n as usize]).sum();
        in_window(lab, sum / nodes.len() as f64)
    };
    // In many small steps; clockwise in the window decreases the moment.
    let turn = |harness: &mut Harness<'_, Lab>, degrees: f32, modifiers: Modifiers| {
        let (middle, from) = (center(harness.state()), tip(harness.state()));
        harness.hover_at(from);
        harness.run();
        harness.drag_at(from);
        harness.step();
        harness.event(Event::ModifiersChanged(modifiers));
        let mut to = from;
        for i in 1..=8_u8 {
            let rotation = egui::emath::Rot2::from_angle(degrees.to_radians() * f32::from(i) / 8.0);
            to = middle + rotation * (from - middle);
            harness.hover_at(to);
            harness.run();
        }
        harness.drop_at(to);
        harness.run();
        harness.event(Event::ModifiersChanged(Modifiers::NONE));
        harness.run();
    };
    turn(&mut harness, 30.0, Modifiers::NONE);
    let less = moment(harness.state());
    assert!((0.75..0.82).contains(&(less / before)), "{before} {less}: 30° of 135° less");
    unfold(&mut harness, "Moment");
    let shown = harness.get_by_role_and_label(Role::SpinButton, "Moment").accesskit_node().value().unwrap();
    assert_eq!(shown, warpbeam::format::editable(less, "N m"));
    let json = solve_json(&["roll-up", "--set", &format!("load.0.moment={less}")]);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    let u = harness.state().simulation().solution().probes[0].u;
    let solved = Vector2::from([0, 1].map(|i| json["probes"][0]["u"][i].as_f64().unwrap()));
    assert!((u - solved).norm() < 1e-5 * solved.norm(), "{u} {solved}");
    // Through zero to the opposite sense: the beam bends down.
    turn(&mut harness, 300.0, Modifiers::NONE);
    assert!(moment(harness.state()) < -0.01 * before, "{}", moment(harness.state()));
    assert!(harness.state().simulation().solution().probes[0].u.y < 0.0);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(moment(harness.state()), less);
    turn(&mut harness, 20.0, Modifiers::SHIFT);
    assert_eq!(moment(harness.state()), 5e3);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), scene("roll-up"));
    // A double click on the end restores the scene's own moment.
    turn(&mut harness, 20.0, Modifiers::NONE);
    assert_ne!(moment(harness.state()), before);
    harness.run_steps(10);
    let end = tip(harness.state());
    double_click(&mut harness, end);
    assert_eq!(moment(harness.state()), before);
}

/// The middle third of the force slider has the scene's own force; small and large forces are within reach.
#[test]
fn the_force_slider_spans_what_a_slender_body_can_bear() {
    for id in ["article", "cantilever", "elastica", "bracket", "clip", "jump"] {
        let mut harness = harness(id);
        let [x, y] = force(harness.state());
        let own = x.hypot(y);
        let slider = harness.get_by_role_and_label(Role::Slider, "Force").rect();
        let mut press = |share: f32| {
            let at = egui::pos2(slider.left() + share * slider.width(), slider.center().y);
            harness.hover_at(at);
            harness.step();
            harness.drag_at(at);
            harness.step();
            harness.drop_at(at);
            harness.step();
            let [x, y] = force(harness.state());
            x.hypot(y)
        };
        let [little, middle, much] = [0.12, 0.5, 0.97].map(&mut press);
        assert!(little < 0.4 * own, "{id}: {own} N is among the first points: {little} N are");
        assert!((1.0..2.0).contains(&(middle / own)), "{id}: {middle} N in the middle, for {own} N");
        assert!(press(1.0 / 3.0) < own && own < press(2.0 / 3.0), "{id}: {own} N is not in the middle third");
        assert!(much > 10.0 * own, "{id}: at most {much} N, for {own} N");
        assert!(press(0.0) == 0.0, "{id}: no force at the left end");
    }
}

/// A wheel that still turns in the gallery when a scene is clicked does not change the new view,
/// which shows the whole body.
#[test]
fn a_wheel_in_the_gallery_does_not_zoom_the_view() {
    let opened = harness;
    let mut harness = opened("article");
    harness.get_by_role_and_label(Role::ComboBox, "Scene").click();
    harness.run();
    let entry = harness.get_by_role_and_label(Role::Button, "cantilever").rect();
    let at = egui::pos2(entry.center().x, entry.center().y.clamp(100.0, 500.0));
    harness.hover_at(at);
    harness.run();
    let wheel = |delta| Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, delta),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    };
    harness.event(wheel(-40.0));
    harness.step();
    // Scrolls back up by a large distance.
    harness.event(wheel(400.0));
    harness.get_by_role_and_label(Role::Button, "cantilever").click();
    harness.step();
    harness.run();
    // The list has scrolled further under the pointer.
    let name = &harness.state().scene().name;
    let id = crate::common::ids_of(Analysis::Static).into_iter().find(|id| *scene(id).name == **name).unwrap();
    assert_ne!(id, "article");
    let (camera, fitted) = (harness.state().camera(), opened(id).state().camera());
    assert!((camera.scale / fitted.scale - 1.0).abs() < 1e-6, "{camera:?} {fitted:?}");
}

/// The gallery lists all scenes with descriptions, fits in a window of any size, and can be operated by keys.
#[test]
fn the_gallery_is_navigated_by_keys() {
    for size in [[640.0, 480.0], [1280.0, 800.0]] {
        let mut harness = harness("cantilever");
        harness.set_size(size.into());
        harness.run();
        harness.get_by_role_and_label(Role::ComboBox, "Scene").focus();
        harness.run();
        key(&mut harness, Modifiers::NONE, Key::Enter);
        harness.run_steps(20);
        for id in crate::common::scene_ids() {
            let entry = harness.get_by_role_and_label(Role::Button, id);
            assert_eq!(entry.accesskit_node().description(), Some(scene(id).about), "{id}");
            let rect = entry.rect();
            assert!(rect.left() >= 0.0 && rect.right() <= size[0], "{size:?}: {id} at {rect:?}");
        }
        let window = egui::Rect::from_min_size(Pos2::ZERO, size.into());
        let present = harness.get_by_role_and_label(Role::Button, "cantilever");
        assert!(present.accesskit_node().is_focused() && window.contains_rect(present.rect()), "{size:?}");
        // Moves down to an entry that is not visible at first, and opens it.
        let mut presses = 0;
        while !harness.get_by_role_and_label(Role::Button, "chime").accesskit_node().is_focused() {
            key(&mut harness, Modifiers::NONE, Key::Tab);
            harness.run_steps(4);
            presses += 1;
            assert!(presses < 60, "{size:?}: the last scene cannot be reached");
        }
        harness.run_steps(20);
        let last = harness.get_by_role_and_label(Role::Button, "chime").rect();
        assert!(window.contains_rect(last), "{size:?}: what has the focus is at {last:?}");
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        assert_eq!(harness.state().scene().name, "Chime");
        assert!(harness.query_by_role_and_label(Role::Button, "cantilever").is_none(), "{size:?}: it stays open");
    }
}

/// Lists and tooltips name the keys of the system: on macOS, Cmd in place of Ctrl.
#[test]
fn shortcuts_have_the_names_of_the_system() {
    for (system, command, other) in [
        (OperatingSystem::Nix, "Ctrl", "Cmd"),
        (OperatingSystem::Windows, "Ctrl", "Cmd"),
        (OperatingSystem::Mac, "Cmd", "Ctrl"),
    ] {
        let mut harness = harness("article");
        harness.ctx.set_os(system);
        let undo = harness.get_by_role_and_label(Role::Button, "Undo").rect().center();
        harness.hover_at(undo);
        harness.run_steps(20);
        harness.get_by_label(&format!("Undo the last edit ({command}+Z)"));
        key(&mut harness, Modifiers::NONE, Key::F1);
        harness.run();
        for key in ["O", "Shift+S"] {
            harness.get_by_label(&format!("{command}+{key}"));
            assert!(harness.query_by_label(&format!("{other}+{key}")).is_none(), "{system:?}: {other}+{key}");
        }
    }
}

/// The list of keys is not wider than a small window.
#[test]
fn the_list_of_keys_fits_a_narrow_window() {
    let mut harness = window([640.0, 480.0], lab_of("article", scene("article")));
    harness.run_steps(40);
    harness.key_press(Key::F1);
    harness.run_steps(10);
    for (gesture, does) in FOCUS_KEYS.iter().chain(MOUSE) {
        for text in [gesture, does] {
            let rect = harness.get_all_by_label(text).last().unwrap().rect();
            assert!(rect.left() >= 0.0 && rect.right() <= 640.0, "{text} at {rect}");
        }
    }
}

/// Clicks with the primary button.
pub fn click(harness: &mut Harness<'_, Lab>, pos: Pos2) {
    harness.hover_at(pos);
    harness.run();
    harness.drag_at(pos);
    harness.step();
    harness.drop_at(pos);
    harness.run();
}

/// The tooltip shows the field's value at the pointer. A click opens a card with the numbers of the point, which has a
/// button that closes it.
#[test]
fn the_values_under_the_pointer_are_shown_and_a_click_keeps_them() {
    let mut harness = harness("article");
    let at = Vector2::new(2.2, 0.3);
    let pos = on_body(harness.state(), at);
    harness.hover_at(pos);
    harness.run();
    assert!(harness.state().probed().is_none());
    let before = harness.state().simulation().displacement().to_vec();
    click(&mut harness, pos);
    let lab = harness.state();
    let away = lab.simulation().displacement().iter().zip(&before).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(away < 1e-6, "a click has moved the body by {away} m");
    let point = lab.simulation().point_state(lab.probed().expect("a kept point"), PointValues::Recovered).unwrap();
    assert!((point.rest - at).norm() < 0.02, "{}", point.rest);
    harness.get_by_label("F, R, S").click();
    harness.run();
    let texts: Vec<String> = harness
        .get_all_by(|_| true)
        .flat_map(|n| [n.accesskit_node().label(), n.accesskit_node().value()])
        .flatten()
        .collect();
    for (what, number) in [("F", point.gradient.m11), ("R", point.rotation.c), ("S", point.stretch.m22)] {
        let number = format!("{number:.4}");
        assert!(texts.iter().any(|text| text.contains(&number)), "{what}: no {number} in {texts:?}");
    }
    // The card follows the material point, not the position in the window.
    harness.state_mut().set_scene(scene("article")).unwrap();
    harness.run();
    assert!(harness.state().probed().is_some());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().probed().is_none());
    click(&mut harness, pos);
    assert!(harness.state().probed().is_some());
    harness.get_by_role_and_label(Role::Button, "Close the card").click();
    harness.run();
    assert!(harness.state().probed().is_none(), "the button does not close the card");
    // A quick click is pressed and released between two frames.
    harness.hover_at(pos);
    harness.run();
    let button = |pressed| Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.input_mut().events.extend([button(true), button(false)]);
    harness.run();
    assert!(harness.state().probed().is_some(), "a quick click is missed");
    key(&mut harness, Modifiers::NONE, Key::Escape);
    // A drag of the body opens no card.
    let pos = on_body(harness.state(), at);
    drag(&mut harness, pos, pos + vec2(0.0, 60.0), Modifiers::NONE);
    assert!(harness.state().probed().is_none());
}

/// The view does not follow a body that has not converged, because it may be anywhere.
#[test]
fn the_view_does_not_follow_unconverged_states() {
    let mut harness = harness("cantilever");
    let camera = harness.state().camera();
    let mut heavy = harness.state().scene().clone();
    heavy.set_force(LoadId::nth(0), [0.0, -9000.0]).unwrap();
    harness.state_mut().set_scene(heavy).unwrap();
    for _ in 0..20 {
        harness.step();
        let now = harness.state().camera();
        assert!((now.scale / camera.scale - 1.0).abs() < 0.2, "{camera:?} {now:?}");
    }
    harness.run();
    assert!(matches!(harness.state().simulation().status(), Status::Diverged(_)));
    let now = harness.state().camera();
    assert!((now.scale / camera.scale - 1.0).abs() < 0.2, "{camera:?} {now:?}");
}

/// An animated view moves for some frames, ends where the view without animation is, and then nothing is redrawn.
#[test]
fn the_eased_view_ends_where_the_other_jumps() {
    let mut jumps = harness("elastica");
    let mut eases = harness("elastica");
    eases.state_mut().set_easing(true);
    let before = eases.state().camera();
    for harness in [&mut jumps, &mut eases] {
        let mut light = harness.state().scene().clone();
        light.set_force(LoadId::nth(0), [0.0, -30.0]).unwrap();
        harness.state_mut().set_scene(light).unwrap();
    }
    jumps.run();
    let goal = jumps.state().camera();
    assert!((goal.scale / before.scale - 1.0).abs() > 0.05);
    let mut between = 0;
    for _ in 0..400 {
        eases.step();
        let now = eases.state().camera();
        between += u32::from(now != before && now != goal);
    }
    assert!(between >= 1, "it jumps");
    assert_eq!(eases.state().camera(), goal);
}

#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Files can be opened by dropping them or in a dialog, and saved to their own path or another. If another program has
/// changed a file, the window offers to reload it.
#[test]
fn files_are_dropped_opened_saved_and_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let mut own = scene("shear");
    own.name = "Mine".to_owned();
    std::fs::write(&path, own.to_toml().unwrap()).unwrap();
    let mut harness = harness("article");
    harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path.clone())));
    harness.run();
    harness.input_mut().dropped_files.clear();
    harness.run();
    assert_eq!(harness.state().scene().name, "Mine");
    assert!(harness.state().can_undo());
    // Edits the scene and saves it.
    let from = tip(harness.state());
    drag(&mut harness, from, from + vec2(-6.0, -6.0), Modifiers::NONE);
    let edited = harness.state().scene().clone();
    assert!(harness.state().title().starts_with("Mine*"));
    key(&mut harness, Modifiers::COMMAND, Key::S);
    assert!(harness.state().title().starts_with("Mine ("), "{}", harness.state().title());
    let file = path.file_name().unwrap().to_string_lossy();
    assert!(harness.state().title().contains(&*file), "{}", harness.state().title());
    let read = |path: &std::path::Path| warpbeam::Scene::from_toml(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(read(&path), edited);
    // Saves to another file in the dialog, which adds the extension.
    key(&mut harness, COMMAND_SHIFT, Key::S);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.event(Event::Text("other".to_owned()));
    harness.step();
    key(&mut harness, Modifiers::NONE, Key::Enter);
    let other = folder.path().join("other.toml");
    assert_eq!(read(&other), edited);
    // No other program has changed the file, so that no reload is offered. Then one does.
    harness.event(Event::WindowFocused(true));
    harness.run();
    assert!(harness.query_by_label("Reload").is_none());
    own.name = "Theirs".to_owned();
    std::fs::write(&other, own.to_toml().unwrap()).unwrap();
    harness.event(Event::WindowFocused(true));
    harness.run();
    assert_eq!(harness.state().scene().name, "Mine");
    harness.get_by_label("Reload").click();
    harness.run();
    assert_eq!(harness.state().scene().name, "Theirs");
    assert!(harness.query_by_label("Reload").is_none());
    // Opens files in the dialog; an invalid scene is refused there, and the dialog stays open.
    std::fs::write(folder.path().join("bad.toml"), "name = 3").unwrap();
    for (name, scene) in [("bad.toml", "Theirs"), ("mine.toml", "Mine")] {
        if harness.query_by_label("Open a scene").is_none() {
            key(&mut harness, Modifiers::COMMAND, Key::O);
        }
        harness.get_by_role_and_label(Role::Button, name).click();
        harness.run();
        harness.get_by_role_and_label(Role::Button, "Open").click();
        harness.run();
        assert_eq!(harness.state().scene().name, scene);
        assert_eq!(harness.query_by_label("Open a scene").is_some(), name == "bad.toml");
    }
    // The folder contains the scene files only, and no temporary files.
    let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["bad.toml", "mine.toml", "other.toml"]);
}

/// A user's settings are the same in another lab that loads them.
#[test]
fn settings_go_from_one_lab_to_the_next() {
    let mut first = harness("article");
    for wanted in [Key::P, Key::Num4, Key::B, Key::T] {
        key(&mut first, Modifiers::NONE, wanted);
    }
    let settings = first.state().settings(&first.ctx);
    let mut second = harness("article");
    assert_ne!(second.state().settings(&second.ctx), settings);
    let ctx = second.ctx.clone();
    second.state_mut().set_settings(&ctx, settings.clone());
    second.run();
    assert_eq!(second.state().settings(&second.ctx), settings);
    assert!(second.query_by_role_and_label(Role::Slider, "Force").is_none());
    assert_eq!(second.ctx.theme(), first.ctx.theme());
}

/// A moment is applied to an edge that can rotate, whatever the names of the edges, and moves the body there.
#[test]
fn a_moment_needs_an_edge_that_can_rotate() {
    for (id, moment, held) in [("bracket", "200", "wall"), ("cook", "1", "clamp"), ("bridge", "500", "right")] {
        let mut harness = harness(id);
        let before = harness.state().simulation().displacement().to_vec();
        type_into(&mut harness, "Moment", moment);
        let edge = harness.state().scene().loads.iter().find_map(|l| match l {
            Load::Moment { edge, .. } => Some(edge.clone()),
            _ => None,
        });
        let edge = edge.unwrap_or_else(|| unreachable!("{id}: no moment"));
        assert_ne!(edge, held, "{id}: a held edge cannot turn");
        let moved = harness.state().simulation().displacement().iter().zip(&before).map(|(a, b)| (a - b).norm());
        assert!(moved.fold(0.0, f64::max) > 1e-6, "{id}: the moment on {edge} does nothing");
    }
}

/// The edge of a load is selected in a list, and is highlighted in the view while the pointer is over its name.
#[test]
fn loads_and_supports_are_put_on_other_edges() {
    let mut harness = harness("cantilever");
    unfold(&mut harness, "Held at");
    harness.get_by_role_and_label(Role::ComboBox, "Force on").click();
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Button, "left").is_none(), "a load on a held edge does nothing");
    harness.get_by_role_and_label(Role::Button, "top").click();
    harness.run();
    assert_eq!(harness.state().scene().loads, [Load::force("top", force(harness.state()))]);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    harness.get_by_role_and_label(Role::ComboBox, "Held at").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "right").click();
    harness.run();
    assert_eq!(harness.state().scene().supports[0].place, "right".into());
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), scene("cantilever"));
    // A force is added with the size of the present ones, a probe at a point, which can be moved and removed.
    harness.get_by_role_and_label(Role::Button, "Force").click();
    harness.run();
    let [Load::Force { force: first, .. }, Load::Force { force: second, .. }] = &harness.state().scene().loads[..]
    else {
        unreachable!("{:?}", harness.state().scene().loads)
    };
    assert_eq!(first, second);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    let button = harness.get_by_role_and_label(Role::Button, "Probe");
    assert!(button.rect().right() < 1270.0, "{:?} widens the panel", button.rect());
    button.click();
    harness.run();
    let place = |harness: &Harness<'_, Lab>| harness.state().scene().probes.get(1).map(|probe| probe.place.clone());
    assert!(matches!(place(&harness), Some(Place::At(_))), "{:?}", harness.state().scene().probes);
    harness.get_by_role_and_label(Role::ComboBox, "Probe p1").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "top").click();
    harness.run();
    assert_eq!(place(&harness), Some("top".into()));
    harness.get_by_label("Remove the probe p1").click();
    harness.run();
    assert_eq!(*harness.state().scene(), scene("cantilever"));
}

/// Unsaved edits are not lost without a question: when another scene is selected, a file is dropped, or the window is
/// closed. Undo restores discarded edits.
#[test]
fn unsaved_edits_are_asked_about() {
    const QUESTION: &str = "Save the changes to \u{201c}Cantilever\u{201d}?";
    let closes = std::rc::Rc::new(std::cell::Cell::new(false));
    let asked = closes.clone();
    let own = scene("cantilever");
    let simulation = Simulation::new(&own).unwrap();
    let lab = Lab::new(Source { name: "cantilever".into(), assignments: Vec::new() }, own, simulation);
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).with_max_steps(2000).build_ui_state(
        move |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            asked.set(asked.get() || lab.ui(ui).contains(&warpbeam::app::Request::Close));
        },
        lab,
    );
    harness.run();
    let ctx = harness.ctx.clone();
    assert!(harness.state_mut().request_close(&ctx), "nothing is edited");
    type_into(&mut harness, "Force", "700");
    let edited = harness.state().scene().clone();
    let folder = tempfile::tempdir().unwrap();
    let dropped = folder.path().join("dropped.toml");
    std::fs::write(&dropped, scene("shear").to_toml().unwrap()).unwrap();
    let drop_it = |harness: &mut Harness<'_, Lab>| {
        harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(dropped.clone())));
        harness.run();
        harness.input_mut().dropped_files.clear();
        harness.run();
    };
    // Cancelled by the button or by Escape, nothing changes.
    for cancel in [0, 1] {
        drop_it(&mut harness);
        harness.get_by_label(QUESTION);
        // Shortcuts of the window are inactive until the question is answered.
        key(&mut harness, Modifiers::NONE, Key::P);
        assert!(harness.query_by_role_and_label(Role::Slider, "Force").is_some());
        match cancel {
            0 => harness.get_by_role_and_label(Role::Button, "Cancel").click(),
            _ => harness.key_press(Key::Escape),
        }
        harness.run();
        assert!(harness.query_by_label(QUESTION).is_none());
        assert_eq!(*harness.state().scene(), edited);
    }
    // Discarded edits can be restored.
    drop_it(&mut harness);
    harness.get_by_role_and_label(Role::Button, "Discard").click();
    harness.run();
    assert_eq!(*harness.state().scene(), scene("shear"));
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), edited);
    // Saves: a built-in scene has no file yet, and the window closes once it has one.
    assert!(!harness.state_mut().request_close(&ctx), "it asks first");
    harness.run();
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.query_by_label("Save the scene").is_some());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Save the scene").is_none(), "a cancelled file cancels the rest");
    assert!(!harness.state_mut().request_close(&ctx), "it is still not saved");
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Save").click();
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    let kept = folder.path().join("kept.toml");
    harness.event(Event::Text(kept.to_str().unwrap().to_owned()));
    harness.step();
    assert!(!closes.get());
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(warpbeam::Scene::from_toml(&std::fs::read_to_string(&kept).unwrap()).unwrap().loads, edited.loads);
    assert!(closes.get(), "it closes once the scene has a file");
    assert!(harness.state_mut().request_close(&ctx), "all is saved");
}

/// Length and height are set in the panel. The size of the cells is kept, supports, loads and probes at points of the
/// beam move with it, and undo restores everything.
#[test]
fn a_beam_gets_another_length_and_height() {
    let mut harness = harness("cantilever");
    let before = harness.state().scene().clone();
    let beam = before.beam.clone().unwrap();
    type_into(&mut harness, "Length", "12");
    type_into(&mut harness, "Height", "1.5");
    let after = harness.state().scene().beam.clone().unwrap();
    assert_eq!((after.length, after.height), (12.0, 1.5));
    let cells = |along: f64, across: f64| {
        [along * f64::from(beam.cells[0]), across * f64::from(beam.cells[1])].map(|n| n.round().max(1.0) as u32)
    };
    assert_eq!(after.cells, cells(12.0 / beam.length, 1.5 / beam.height));
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    harness.get_by_label_contains("Slenderness, length over height: 8");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), before);
    // Many small changes add up to the right number of cells.
    for step in 1..=12 {
        type_into(&mut harness, "Length", &format!("{}", (1.0 + 0.0043 * f64::from(step)) * beam.length));
    }
    assert_eq!(harness.state().scene().beam.as_ref().unwrap().cells, cells(1.0516, 1.0));
}

/// Buttons alone turn a cantilever into a simply supported beam under two loads; every step can be undone.
#[test]
fn loads_and_supports_are_added_and_removed() {
    let mut harness = harness("cantilever");
    let before = harness.state().scene().clone();
    unfold(&mut harness, "Add");
    let press = |harness: &mut Harness<'_, Lab>, name: &str| {
        harness.get_by_role_and_label(Role::Button, name).click();
        harness.run();
    };
    let pick_place = |harness: &mut Harness<'_, Lab>, row: (&str, usize), place: &str| {
        harness.get_all_by_role_and_label(Role::ComboBox, row.0).nth(row.1).unwrap().click();
        harness.run();
        harness.get_by_role_and_label(Role::Button, place).scroll_to_me();
        harness.run();
        harness.get_by_role_and_label(Role::Button, place).click();
        harness.run();
    };
    pick_place(&mut harness, ("Held at", 0), "lower left");
    assert_eq!(*harness.state().scene(), before, "a pin alone holds no body: refused");
    press(&mut harness, "Support");
    assert_eq!(harness.state().scene().supports.len(), 2);
    pick_place(&mut harness, ("Held at", 1), "lower right");
    pick_place(&mut harness, ("Held at", 0), "lower left");
    let scene = harness.state().scene();
    let beam = scene.beam.as_ref().unwrap();
    let [pin, roller] = [&scene.supports[0], &scene.supports[1]];
    assert_eq!((&pin.place, pin.fix.len()), (&[0.0, -0.5 * beam.height].into(), 2));
    assert_eq!((&roller.place, roller.fix.len()), (&[beam.length, -0.5 * beam.height].into(), 1));
    pick_place(&mut harness, ("Force on", 0), "top, middle");
    press(&mut harness, "Force");
    assert_eq!(harness.state().scene().loads.len(), 2);
    // The sliders change the selected force.
    let forces = |lab: &Lab| -> Vec<[f64; 2]> {
        lab.scene()
            .loads
            .iter()
            .filter_map(|l| if let Load::Force { force, .. } = l { Some(*force) } else { None })
            .collect()
    };
    let first = forces(harness.state())[0];
    harness.get_by_role_and_label(Role::ComboBox, "Selected force").click();
    harness.run();
    harness.get_by_label_contains("Force 2:").click();
    harness.run();
    type_into(&mut harness, "Force", "10");
    let [left, second] = <[[f64; 2]; 2]>::try_from(forces(harness.state())).unwrap();
    assert!(left == first && (second[0].hypot(second[1]) - 10.0).abs() < 1e-9, "{left:?} {second:?}");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    // The reactions carry both forces.
    let reactions = harness.state().simulation().support_reactions();
    let up: f64 = reactions.iter().map(|r| r.force.y).sum();
    assert!((up + left[1] + second[1]).abs() < 1e-6 * up, "{up} {left:?} {second:?}");
    unfold(&mut harness, "Add");
    harness.get_by_role_and_label(Role::Button, "Remove load 2").click();
    harness.run();
    assert_eq!(forces(harness.state()), [first]);
    for _ in 0..40 {
        if harness.state().can_undo() {
            key(&mut harness, Modifiers::COMMAND, Key::Z);
        }
    }
    assert_eq!(*harness.state().scene(), before);
}

/// Rows of the card of a point.
const CARD: &[&str] =
    &["u", "θ", "σ_x, σ_y", "τ_xy", "σ_1, σ_2", "von Mises", "ε_X, ε_Y", "γ_XY", "ε_1, ε_2", "ψ", "F", "R", "S"];

/// Returns the values on the card of a point by the names of the rows.
fn card(harness: &Harness<'_, Lab>) -> std::collections::BTreeMap<String, String> {
    let nodes = harness.get_all_by_role(Role::Label).map(|node| node.accesskit_node());
    let texts: Vec<String> = nodes.filter_map(|node| node.value().or_else(|| node.label())).collect();
    let rows = texts.windows(2).filter(|pair| CARD.contains(&pair[0].as_str()));
    rows.map(|pair| (pair[0].clone(), pair[1].clone())).collect()
}

/// F, S, ε and σ on the card of a point agree with each other to the printed digits, and the card names their kind.
#[test]
fn the_card_of_a_point_is_of_one_deformation() {
    for (id, at) in
        [("article", Vector2::new(0.4, 0.45)), ("bracket", Vector2::new(0.1, 0.1)), ("jelly", Vector2::new(0.1, -0.2))]
    {
        let mut harness = harness(id);
        for _ in 0..20 {
            harness.step();
        }
        if harness.state().scene().analysis == Analysis::Dynamic {
            key(&mut harness, Modifiers::NONE, Key::Space);
        }
        let pos = on_body(harness.state(), at);
        harness.hover_at(pos);
        harness.step();
        harness.drag_at(pos);
        harness.step();
        harness.drop_at(pos);
        harness.run_steps(4);
        harness.get_by_label("F, R, S").click();
        harness.run_steps(8);
        let point = harness.state().probed().expect("a kept point");
        harness.hover_at(Pos2::new(5.0, 5.0));
        harness.get_by_label_contains("View: ").scroll_to_me();
        harness.run_steps(4);
        harness.get_by_label_contains("View: ").click();
        harness.run_steps(8);
        for (kind, values) in
            [("recovered at the nodes", PointValues::Recovered), ("element value, not smoothed", PointValues::Raw)]
        {
            assert!(harness.query_by_label(kind).is_some(), "{id}: {kind}");
            let card = card(&harness);
            let numbers = |name: &str| -> Vec<f64> {
                card[name].split([' ', '\n', '(', ')', ',']).filter_map(|word| word.parse().ok()).collect()
            };
            let matrix = |name: &str| nalgebra::Matrix2::from_row_slice(&numbers(name));
            let (f, r, s) = (matrix("F"), matrix("R"), matrix("S"));
            // Four decimals are printed.
            assert!((f - r * s).amax() < 3e-4, "{id} {kind}: {card:?}");
            let strain = s - nalgebra::Matrix2::identity();
            let printed = numbers("ε_1, ε_2");
            let strains = strain.symmetric_eigenvalues() * 100.0;
            for (strain, printed) in [(strains.max(), printed[0]), (strains.min(), printed[1])] {
                assert!((strain - printed).abs() < 0.011 + 0.006 * printed.abs(), "{id} {kind}: {strain} % {card:?}");
            }
            let state = harness.state().simulation().point_state(point, values).unwrap();
            let stress = warpbeam::format::engineering(
                warpbeam::format::three_digits(state.field(Field::VonMises).unwrap()),
                "Pa",
            );
            assert_eq!(card["von Mises"], stress, "{id} {kind}");
            assert!((state.stretch - s).amax() < 6e-5, "{id} {kind}: {card:?}");
            harness.get_by_role_and_label(Role::CheckBox, "Each element alone").scroll_to_me();
            harness.run_steps(4);
            harness.get_by_role_and_label(Role::CheckBox, "Each element alone").click();
            harness.run_steps(4);
        }
    }
}

/// Returns all painted shapes, including nested ones.
pub fn shapes(harness: &Harness<'_, Lab>) -> Vec<egui::Shape> {
    fn flatten(shape: &egui::Shape, found: &mut Vec<egui::Shape>) {
        match shape {
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| flatten(shape, found)),
            shape => found.push(shape.clone()),
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| flatten(&clipped.shape, &mut found));
    found
}

/// The arrow of a weight is beside the colour bar, in low views too.
#[test]
fn the_colour_bar_is_not_on_the_arrow_of_a_weight() {
    for size in [[640.0, 480.0], [1280.0, 800.0]] {
        let mut harness = harness("gravity");
        harness.set_size(size.into());
        harness.run();
        let shapes = shapes(&harness);
        let bar = shapes.iter().find_map(|shape| match shape {
            egui::Shape::Text(text) if text.galley.text().starts_with("von Mises") => {
                Some(Rect::from_min_size(text.pos, vec2(170.0, 46.0)))
            }
            _ => None,
        });
        let bar = bar.unwrap_or_else(|| unreachable!("no colour bar"));
        // The shafts of arrows are three points wide.
        let arrows = shapes.iter().filter_map(|shape| match shape {
            egui::Shape::LineSegment { points, stroke } if stroke.width == 3.0 => {
                Some(Rect::from_two_pos(points[0], points[1]))
            }
            _ => None,
        });
        let arrows: Vec<Rect> = arrows.collect();
        assert_eq!(arrows.len(), 1, "{size:?}");
        assert!(!bar.intersects(arrows[0]), "{size:?}: {bar:?} on {arrows:?}");
    }
}

/// For any force, the tip of the arrow is outside the colour bar in the fitted view.
#[test]
fn the_colour_bar_is_not_on_the_tip_of_an_arrow() {
    let mut met = 0;
    for (id, most) in [("article", 1.6), ("cantilever", 4.0), ("incline", 4.0)] {
        for part in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
            let mut harness = harness(id);
            let mut scene = harness.state().scene().clone();
            let factor = 1.0 + (most - 1.0) * part;
            scene.solver.method = MethodKind::Newton;
            scene.set_force(LoadId::nth(0), force(harness.state()).map(|v| v * factor)).unwrap();
            harness.state_mut().set_scene(scene).unwrap();
            harness.run();
            let view = harness.state().view_rect();
            let bar = Rect::from_min_max(view.right_bottom() - vec2(286.0, 66.0), view.right_bottom());
            let tip = harness.state().arrow_tips()[0].1;
            met += i32::from(bar.x_range().contains(tip.x));
            assert!(!bar.contains(tip), "{id}, {factor}: {tip:?} in {bar:?}");
        }
    }
    assert!(met > 0, "no arrow is over the bar");
}

/// Enter in the gallery opens another scene, and does not also answer the question about unsaved edits.
#[test]
fn enter_in_the_gallery_answers_no_question() {
    let mut harness = harness("cantilever");
    type_into(&mut harness, "Force", "700");
    let edited = harness.state().scene().clone();
    harness.get_by_role_and_label(Role::ComboBox, "Scene").click();
    harness.run();
    harness.get_by_label("bridge").focus();
    harness.step();
    harness.key_press(Key::Enter);
    harness.run();
    harness.get_by_label_contains("Save the changes to");
    assert!(harness.query_by_label("Save the scene").is_none(), "it was taken for an answer");
    assert_eq!(*harness.state().scene(), edited);
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.query_by_label("Save the scene").is_some());
}

/// Ctrl+S asks for another file where another program has changed the own one, and replaces that only if told so.
#[test]
fn a_file_changed_by_another_program_is_not_overwritten_without_a_question() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let own = scene("cantilever").to_toml().unwrap();
    let theirs = scene("shear").to_toml().unwrap();
    std::fs::write(&path, &own).unwrap();
    let mut harness = harness("article");
    let read = |path: &std::path::Path| std::fs::read_to_string(path).unwrap();
    let reload = |harness: &mut Harness<'_, Lab>| {
        harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path.clone())));
        harness.run();
        harness.input_mut().dropped_files.clear();
        harness.run();
    };
    reload(&mut harness);
    type_into(&mut harness, "Force", "700");
    let edited = harness.state().scene().clone();
    std::fs::write(&path, &theirs).unwrap();
    let ask = |harness: &mut Harness<'_, Lab>| {
        key(harness, Modifiers::COMMAND, Key::S);
        harness.get_by_label("Save the scene");
        // The dialog says why, and the row above the body offers to reload.
        assert_eq!(harness.query_all_by_label_contains("mine.toml has changed on disk.").count(), 2);
        assert_eq!(read(&path), theirs);
    };
    // Cancelled, nothing is written. Reloaded; undo restores the edits, which are then saved without a question.
    ask(&mut harness);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Save the scene").is_none());
    harness.get_by_role_and_label(Role::Button, "Reload").click();
    harness.run();
    assert_eq!((read(&path), harness.state().scene()), (theirs.clone(), &scene("shear")));
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().scene(), edited);
    // The user may close the window at the same time.
    let ctx = harness.ctx.clone();
    std::fs::write(&path, &own).unwrap();
    assert!(!harness.state_mut().request_close(&ctx), "it asks first");
    harness.run();
    key(&mut harness, Modifiers::NONE, Key::Enter);
    harness.get_by_role_and_label(Role::Button, "Save").click();
    harness.run();
    assert_eq!(read(&path), own, "the name exists");
    harness.get_by_role_and_label(Role::Button, "Replace").click();
    harness.run();
    assert_eq!(warpbeam::Scene::from_toml(&read(&path)).unwrap(), edited);
    assert!(harness.state_mut().request_close(&ctx), "all is saved");
}

/// A warning is shown until it is closed, and given once.
#[test]
fn a_warning_stays_until_it_is_closed() {
    let mut harness = harness("article");
    for message in ["first", "second", "first"] {
        harness.state_mut().warn(message.to_owned());
    }
    for message in ["first", "second"] {
        harness.run();
        harness.get_by_label(message);
        harness.get_by_role_and_label(Role::Button, "Close").click();
    }
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Button, "Close").is_none());
}

/// Clicks with the secondary button.
fn open_menu(harness: &mut Harness<'_, Lab>, pos: Pos2) {
    harness.hover_at(pos);
    harness.run();
    for pressed in [true, false] {
        let button = egui::PointerButton::Secondary;
        harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        harness.step();
    }
    harness.run();
}

/// The mark of a support on an edge has a menu that removes it.
#[test]
fn the_menu_of_a_clamp_removes_it() {
    let mut harness = harness_of("cantilever", scene("cantilever").clamp("right"));
    let beside = on_body(harness.state(), Vector2::new(1e-6, 0.1)) - vec2(7.0, 0.0);
    open_menu(&mut harness, beside);
    harness.get_by_label("Remove this support").click();
    harness.run();
    let supports = &harness.state().scene().supports;
    assert!(supports.len() == 1 && supports[0].place == Place::from("right"), "{supports:?}");
}

/// The menu of a point adds a force, a support and a probe there, and removes them; undo takes each back.
#[test]
fn the_menu_of_a_point_adds_and_removes_objects() {
    let mut harness = harness("cantilever");
    let before = harness.state().scene().clone();
    // Nearer to the top than to the other edges.
    let at = Vector2::new(5.0, 0.1);
    let count = |lab: &Lab| {
        let scene = lab.scene();
        [scene.loads.len(), scene.supports.len(), scene.probes.len()]
    };
    let start = count(harness.state());
    for (number, add, remove) in [
        (0, "Add a force here", "Remove this force"),
        (0, "Add a moment on top", "Remove the moment on top"),
        (1, "Hold this point", "Remove this support"),
        (2, "Add a probe here", "Remove the probe p1"),
    ] {
        let pos = on_body(harness.state(), at);
        open_menu(&mut harness, pos);
        harness.get_by_label(add).click();
        harness.run();
        let mut more = start;
        more[number] += 1;
        assert_eq!(count(harness.state()), more, "{add}");
        assert_eq!(*harness.state().simulation().status(), Status::Converged, "{add}");
        assert!(harness.query_by_label_contains("acts on the nearest node").is_none(), "it acts at its point");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run();
        assert_eq!(*harness.state().scene(), before, "{add}: undone");
        harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        harness.run();
        let pos = on_body(harness.state(), at);
        open_menu(&mut harness, pos);
        harness.get_by_label(remove).click();
        harness.run();
        assert_eq!(count(harness.state()), start, "{remove}");
    }
    // A probe stays at its material point, and Details has its displacement.
    let pos = on_body(harness.state(), at);
    open_menu(&mut harness, pos);
    harness.get_by_label("Add a probe here").click();
    harness.run();
    unfold(&mut harness, "stable");
    let Load::Force { force, .. } = harness.state().scene().loads[0] else { unreachable!("a force") };
    let [x, y] = [0, 1].map(|i| harness.state().simulation().probe("p1").unwrap()[i]);
    let row = warpbeam::format::engineering_pair([x, y], "m");
    assert!(harness.query_by_label(&row).is_some(), "{row} under {force:?}");
    // Beside the body there is no menu.
    let beside = harness.state().view_rect().left_top() + vec2(40.0, 160.0);
    harness.key_press(Key::Escape);
    open_menu(&mut harness, beside);
    assert!(harness.query_by_label("Add a probe here").is_none());
}

/// In a low view the arrow of a large force ends in the view, with room for its label.
#[test]
fn the_arrow_of_a_large_force_ends_in_a_low_view() {
    for size in [[640.0, 480.0], [900.0, 600.0]] {
        let mut large = scene("cantilever").with_method(MethodKind::Newton);
        large.scale_loads(5.0);
        let mut lab = lab_of("cantilever", large);
        lab.solve();
        lab.show_limits();
        let mut harness = window(size, lab);
        harness.run_steps(8);
        let (view, tip) = (harness.state().view_rect(), harness.state().arrow_tips()[0].1);
        assert!(view.shrink2(vec2(10.0, 20.0)).contains(tip), "{size:?}: {tip:?} in {view:?}");
    }
}

/// A body that is iterated step by step stays in the view, also where it is far larger than the result.
#[test]
fn a_stepped_body_stays_in_view() {
    let mut large = scene("article");
    large.scale_loads(2.06);
    let mut harness = harness_of("article", large);
    settle(&mut harness);
    for steps in 1..4 {
        harness.get_by_label("Step").click();
        harness.run_steps(30);
        let lab = harness.state();
        assert_eq!(lab.simulation().iterations(), steps);
        for &place in lab.frame().positions {
            let seen = in_window(lab, place);
            assert!(lab.view_rect().contains(seen), "after {steps}: {place} at {seen:?}");
        }
    }
}
