//! Tests of motions in the window: colours, time line, speed, and self-intersecting bodies.

use crate::common::{ids_of, scene};
use crate::ui_interaction::on_body;
use egui::accesskit::Role;
use egui::{Key, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use nalgebra::Vector2;
use warpbeam::app::Lab;
use warpbeam::scene::{Analysis, Source};
use warpbeam::{IntegratorKind, LoadId, Scene, Simulation, State, Status};

fn harness_of(name: &str, scene: Scene) -> Harness<'static, Lab> {
    let simulation = Simulation::new(&scene).unwrap();
    let lab = Lab::new(Source { name: name.into(), assignments: Vec::new() }, scene, simulation);
    Harness::builder().with_size([1280.0, 800.0]).with_max_steps(4).with_step_dt(0.05).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    )
}

fn harness(id: &str) -> Harness<'static, Lab> {
    harness_of(id, scene(id))
}

fn time(harness: &Harness<'_, Lab>) -> f64 {
    harness.state().simulation().state().time()
}

fn key(harness: &mut Harness<'_, Lab>, key: Key) {
    harness.key_press(key);
    harness.step();
    harness.step();
}

/// Returns the position on the time line at a fraction of its length.
fn on_line(harness: &Harness<'_, Lab>, part: f32) -> Pos2 {
    // The control also accepts the pointer beyond the ends of the line.
    let line = harness.get_by_role_and_label(Role::Slider, "Timeline").rect().shrink2(vec2(8.0, 0.0));
    egui::pos2(egui::lerp(line.x_range(), part), line.center().y)
}

/// Presses on the time line at a fraction of its length.
fn press_line(harness: &mut Harness<'_, Lab>, part: f32) {
    let at = on_line(harness, part);
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.step();
}

/// Runs frames of a motion, and returns the state of each.
fn states(harness: &mut Harness<'_, Lab>, frames: usize) -> Vec<State> {
    let mut states = Vec::new();
    for _ in 0..frames {
        harness.step();
        states.push(harness.state().simulation().state().clone());
    }
    states
}

/// After a hard pull the colour range returns to the values of the motion: it narrows smoothly, but not while paused.
#[test]
fn the_range_of_colours_relaxes_after_a_hard_pull() {
    let mut harness = harness("jelly");
    let width = |harness: &Harness<'_, Lab>| {
        let [low, high] = harness.state().frame().range;
        high - low
    };
    harness.run_steps(60);
    let at_first = width(&harness);
    let grip = on_body(harness.state(), Vector2::new(0.7, 0.2));
    harness.drag_at(grip);
    harness.step();
    for part in [0.3, 0.6, 1.0] {
        harness.hover_at(grip + vec2(150.0, -110.0) * part);
        harness.run_steps(4);
    }
    let pulled = width(&harness);
    assert!(pulled > 1.5 * at_first, "it was pulled hard: {pulled} of {at_first} Pa");
    harness.drop_at(grip + vec2(150.0, -110.0));
    harness.run_steps(10);
    key(&mut harness, Key::Space);
    let mut before = width(&harness);
    harness.run_steps(100);
    assert!((width(&harness) - before).abs() < 1e-12 * before, "it is paused");
    key(&mut harness, Key::Space);
    for frame in 0..300 {
        harness.step();
        let now = width(&harness);
        assert!(now > 0.9 * before, "frame {frame}: the range jumps from {before} to {now} Pa");
        before = now;
    }
    assert!(before < 0.7 * pulled && before < 1.3 * at_first, "{before} Pa of {pulled}; the motion shows {at_first}");
}

/// The time line shows earlier states exactly, by dragging and by keys. Run continues from the displayed state.
#[test]
fn the_last_seconds_can_be_shown_again() {
    for (id, integrator) in [
        ("jelly", IntegratorKind::TrBdf2),
        ("swing", IntegratorKind::EnergyMomentum),
        ("flick", IntegratorKind::ImplicitEuler),
    ] {
        let mut scene = scene(id);
        scene.dynamics.integrator = integrator;
        let mut harness = harness_of(id, scene.clone());
        let shown = states(&mut harness, 60);
        press_line(&mut harness, 0.4);
        let there = harness.state().simulation().state().clone();
        let end = shown.last().unwrap().time();
        assert!((there.time() / end - 0.4).abs() < 0.05, "{id}: {} of {end} s", there.time());
        assert!(shown.contains(&there), "{id}: another state than was shown at {} s", there.time());
        harness.run_steps(5);
        assert!(*harness.state().simulation().state() == there, "{id}: it is paused");
        // Dragged further, and moved by keys.
        harness.hover_at(on_line(&harness, 0.8));
        harness.run_steps(2);
        assert!(time(&harness) > there.time() && shown.contains(harness.state().simulation().state()));
        harness.drop_at(on_line(&harness, 0.8));
        harness.step();
        let later = time(&harness);
        key(&mut harness, Key::Comma);
        assert!(time(&harness) < later && shown.contains(harness.state().simulation().state()), "{id}: back");
        key(&mut harness, Key::Period);
        assert_eq!(time(&harness), later, "{id}: on");
        key(&mut harness, Key::Period);
        assert!(time(&harness) > later && shown.contains(harness.state().simulation().state()), "{id}: on");
        // The energies belong to the displayed time.
        let ledger = *harness.state().simulation().motion().unwrap().ledger();
        assert!(ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{id}: {ledger:?}");

        let mut saved = Simulation::new(&scene).unwrap();
        saved.restore(harness.state().simulation().state()).unwrap();
        key(&mut harness, Key::Space);
        harness.run_steps(10);
        while saved.state().time() < time(&harness) - 1e-9 {
            saved.step();
        }
        let (own, other) = (harness.state().simulation().state(), saved.state());
        assert_eq!(own.time(), other.time());
        assert!(
            own.displacement() == other.displacement() && own.velocity() == other.velocity(),
            "{id}: goes on otherwise"
        );
        let ledger = *harness.state().simulation().motion().unwrap().ledger();
        assert!(ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{id}: {ledger:?}");
        // The line ends at the present: later states have been discarded.
        key(&mut harness, Key::Space);
        let present = time(&harness);
        press_line(&mut harness, 1.0);
        assert_eq!(time(&harness), present, "{id}: the line ends elsewhere");
    }
}

/// At the present, the key for the next state takes a time step. An edit and a reset clear the history.
#[test]
fn the_past_ends_at_the_present_and_begins_with_the_scene() {
    let mut harness = harness("swing");
    harness.run_steps(20);
    key(&mut harness, Key::Space);
    let paused = time(&harness);
    key(&mut harness, Key::Period);
    assert!((time(&harness) - paused - 1.0 / 60.0).abs() < 1e-9);
    key(&mut harness, Key::Comma);
    assert!((time(&harness) - paused).abs() < 1e-9);
    let mut stiffer = harness.state().scene().clone();
    stiffer.material.young *= 2.0;
    harness.state_mut().set_scene(stiffer).unwrap();
    harness.run_steps(2);
    key(&mut harness, Key::Comma);
    assert!((time(&harness) - paused).abs() < 1e-9, "what was before is another scene's");
    key(&mut harness, Key::R);
    assert!(harness.query_by_role_and_label(Role::Slider, "Timeline").is_none());
    key(&mut harness, Key::Comma);
    assert_eq!(time(&harness), 0.0);
}

/// Other integrators go back together with the body to the displayed time. One that did not run then
/// starts from the body's state.
#[test]
fn companions_return_to_the_same_moment() {
    let mut harness = harness("swing");
    harness.state_mut().compare_with(IntegratorKind::ImplicitEuler);
    harness.run_steps(20);
    harness.state_mut().compare_with(IntegratorKind::EnergyMomentum);
    harness.run_steps(20);
    key(&mut harness, Key::E);
    press_line(&mut harness, 0.25);
    harness.drop_at(on_line(&harness, 0.25));
    harness.run_steps(2);
    key(&mut harness, Key::Space);
    harness.run_steps(10);
    assert!(harness.state().simulation().state().is_finite());
    press_line(&mut harness, 0.0);
    assert_eq!(time(&harness), 0.0);
}

/// A body that vibrates fast offers a speed of one period per second, and shows the motion at this speed.
#[test]
fn a_chime_is_slowed_to_a_period_a_second() {
    let mut harness = harness("chime");
    let mut frames = 0;
    while harness.query_by_role_and_label(Role::Button, "1/40").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(10));
        harness.step();
        frames += 1;
        assert!(frames < 2000, "no such speed is offered");
    }
    harness.get_by_role_and_label(Role::Button, "1/40").click();
    harness.run_steps(3);
    let before = time(&harness);
    harness.run_steps(20);
    // A machine that cannot keep up takes fewer steps.
    let second = time(&harness) - before;
    assert!(second > 0.0 && second * 40.0 < 1.06, "a second is {second} s");
    // A busy machine reaches a lower speed than 1/40.
    let mut frames = 0;
    while harness.query_by_label_contains("SPEED × 1/").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(10));
        harness.step();
        frames += 1;
        assert!(frames < 2000, "the speed is not shown");
    }
    // A slow body offers no speed below 1/8.
    let swing = harness_of("swing", scene("swing"));
    let slowest = swing.query_all_by_role_and_label(Role::Button, "1/8").count();
    assert_eq!((slowest, swing.query_all_by_label_contains("1/1").count()), (1, 0));
}

const CROSSES: &str = "The body passes through itself: contact is not modelled";

/// Runs frames, at most `frames`, until the window reports that the body intersects itself. Returns `true` if it does.
fn is_said(harness: &mut Harness<'_, Lab>, frames: u32) -> bool {
    (0..frames).any(|_| {
        harness.step();
        harness.query_by_label(CROSSES).is_some()
    })
}

/// A clip that is pressed into its own base is reported once. No other built-in scene intersects
/// itself, at rest or in its result.
#[test]
fn a_body_that_crosses_itself_is_reported_once() {
    let mut clip = harness("clip");
    assert!(is_said(&mut clip, 200));
    clip.run_steps(100);
    assert!(clip.query_by_label(CROSSES).is_none(), "it goes away");
    let mut scene = clip.state().scene().clone();
    scene.set_force(LoadId::nth(0), [0.0, -2.2]).unwrap();
    clip.state_mut().set_scene(scene).unwrap();
    assert!(!is_said(&mut clip, 100), "it was said before");

    let mut gentle = scene_of_clip();
    gentle.set_force(LoadId::nth(0), [0.0, -1.0]).unwrap();
    assert!(!is_said(&mut harness_of("clip", gentle), 100));
    for id in crate::common::scene_ids() {
        let moves = ids_of(Analysis::Dynamic).contains(&id);
        let said = is_said(&mut harness(id), if moves { 100 } else { 60 });
        assert_eq!(said, id == "clip", "{id}");
    }
}

fn scene_of_clip() -> Scene {
    scene("clip")
}

/// After an explosion, the remedy shows the body again as it was seen before.
#[test]
fn the_view_of_an_exploded_motion_comes_back() {
    let mut harness = harness("swing");
    harness.run_steps(4);
    let before = harness.state().camera().scale;
    let mut scene = harness.state().scene().clone();
    scene.dynamics.integrator = IntegratorKind::SymplecticEuler;
    harness.state_mut().set_scene(scene).unwrap();
    for _ in 0..400 {
        harness.step();
        if matches!(harness.state().simulation().status(), Status::Stopped(_)) {
            break;
        }
    }
    assert!(matches!(harness.state().simulation().status(), Status::Stopped(_)));
    harness.run_steps(4);
    harness.get_by_label("Use tr-bdf2").click();
    harness.run_steps(8);
    assert!(time(&harness) < 2.0, "it starts again");
    let scale = harness.state().camera().scale;
    assert!(scale > 0.3 * before, "{scale} px/m, before {before}");
}
