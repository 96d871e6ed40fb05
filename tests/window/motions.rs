//! Tests of motions in the window: colours, time line, speed, and self-intersecting bodies.

use crate::common::lab::*;

fn open_of(name: &str, scene: Scene) -> Ui {
    window_at([0.05, 4.0], SIZE, lab_of(name, scene))
}

fn open(id: &str) -> Ui {
    open_of(id, scene(id))
}

fn time(ui: &Ui) -> f64 {
    ui.simulation().state().time()
}

fn key(ui: &mut Ui, key: Key) {
    ui.key_press(key);
    ui.run_steps(2);
}

/// Returns the position on the time line at a fraction of its length.
fn on_line(ui: &Ui, part: f32) -> Pos2 {
    // The control also accepts the pointer beyond the ends of the line.
    let line = ui.rect(Role::Slider, "Timeline").shrink2(vec2(8.0, 0.0));
    egui::pos2(egui::lerp(line.x_range(), part), line.center().y)
}

fn press_line(ui: &mut Ui, part: f32) {
    ui.hold(on_line(ui, part));
    ui.step();
}

/// It returns to the values of the motion: it narrows smoothly, but not while paused.
#[test]
fn the_range_of_colours_relaxes_after_a_hard_pull() {
    let mut ui = open_of("jelly", scene_with("jelly", &["load.0.acceleration=[0, -2]"]));
    let width = |ui: &Ui| ui.state().frame().range[1] - ui.state().frame().range[0];
    ui.run_steps(60);
    let at_first = width(&ui);
    let grip = ui.on_body([0.7, 0.2]);
    ui.drag_at(grip);
    ui.step();
    for part in [0.3, 0.6, 1.0] {
        ui.hover_at(grip + vec2(150.0, -110.0) * part);
        ui.run_steps(4);
    }
    let pulled = width(&ui);
    assert!(pulled > 1.5 * at_first, "it was pulled hard: {pulled} of {at_first} Pa");
    ui.drop_at(grip + vec2(150.0, -110.0));
    ui.run_steps(10);
    key(&mut ui, Key::Space);
    let mut before = width(&ui);
    ui.run_steps(100);
    assert!((width(&ui) - before).abs() < 1e-12 * before, "it is paused");
    key(&mut ui, Key::Space);
    for frame in 0..300 {
        ui.step();
        let now = width(&ui);
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
        let mut ui = open_of(id, scene.clone());
        let state = |ui: &Ui| ui.simulation().state().clone();
        let shown: Vec<State> = (0..60)
            .map(|_| {
                ui.step();
                state(&ui)
            })
            .collect();
        press_line(&mut ui, 0.4);
        let (there, end) = (state(&ui), shown.last().unwrap().time());
        assert!((there.time() / end - 0.4).abs() < 0.05, "{id}: {} of {end} s", there.time());
        assert!(shown.contains(&there), "{id}: another state than was shown at {} s", there.time());
        ui.run_steps(5);
        assert!(state(&ui) == there, "{id}: it is paused");
        ui.hover_at(on_line(&ui, 0.8));
        ui.run_steps(2);
        assert!(time(&ui) > there.time() && shown.contains(&state(&ui)));
        ui.drop_at(on_line(&ui, 0.8));
        ui.step();
        let later = time(&ui);
        key(&mut ui, Key::Comma);
        assert!(time(&ui) < later && shown.contains(&state(&ui)), "{id}: back");
        key(&mut ui, Key::Period);
        assert_eq!(time(&ui), later, "{id}: on");
        key(&mut ui, Key::Period);
        assert!(time(&ui) > later && shown.contains(&state(&ui)), "{id}: on");
        // The energies belong to the displayed time.
        let is_balanced = |ui: &Ui| {
            let ledger = *ui.simulation().motion().unwrap().ledger();
            assert!(ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{id}: {ledger:?}");
        };
        is_balanced(&ui);
        let mut saved = Simulation::new(&scene).unwrap();
        saved.restore(ui.simulation().state()).unwrap();
        key(&mut ui, Key::Space);
        ui.run_steps(10);
        while saved.state().time() < time(&ui) - 1e-9 {
            saved.step();
        }
        let of = |state: &State| (state.time(), state.displacement().to_vec(), state.velocity().to_vec());
        assert!(of(&state(&ui)) == of(saved.state()), "{id}: goes on otherwise");
        is_balanced(&ui);
        // The line ends at the present: later states have been discarded.
        key(&mut ui, Key::Space);
        let present = time(&ui);
        press_line(&mut ui, 1.0);
        assert_eq!(time(&ui), present, "{id}: the line ends elsewhere");
    }
}

/// At the present, the key for the next state takes a time step. An edit and a reset clear the history.
#[test]
fn the_past_ends_at_the_present_and_begins_with_the_scene() {
    let mut ui = open("swing");
    ui.run_steps(20);
    key(&mut ui, Key::Space);
    let paused = time(&ui);
    for (wanted, after) in [(Key::Period, 1.0 / 60.0), (Key::Comma, 0.0)] {
        key(&mut ui, wanted);
        assert!((time(&ui) - paused - after).abs() < 1e-9);
    }
    ui.edit(|scene| scene.material.young *= 2.0);
    ui.run_steps(2);
    key(&mut ui, Key::Comma);
    assert!((time(&ui) - paused).abs() < 1e-9, "what was before is another scene's");
    key(&mut ui, Key::R);
    assert!(!ui.has(Role::Slider, "Timeline"));
    key(&mut ui, Key::Comma);
    assert_eq!(time(&ui), 0.0);
}

/// A body that vibrates fast is slowed down to be followed.
#[test]
fn a_chime_is_slowed_down() {
    let mut ui = open("chime");
    ui.get_by_role_and_label(Role::Button, "1/32").click();
    ui.run_steps(3);
    let before = time(&ui);
    ui.run_steps(20);
    // A machine that cannot keep up takes fewer steps, and reaches a lower speed than 1/32.
    let second = time(&ui) - before;
    assert!(second > 0.0 && second * 32.0 < 1.06, "a second is {second} s");
    ui.wait_until("the speed", |ui| ui.says("SPEED × 1/"));
}

const CROSSES: &str = "The body passes through itself: contact is not modelled";

/// Runs frames, at most `frames`, until the window reports that the body intersects itself.
fn is_said(ui: &mut Ui, frames: u32) -> bool {
    (0..frames).any(|_| {
        ui.step();
        ui.query_by_label(CROSSES).is_some()
    })
}

/// A clip that is pressed into its own base. No other built-in scene intersects itself, at rest or in its result.
#[test]
fn a_body_that_crosses_itself_is_reported_once() {
    let mut clip = open("clip");
    assert!(is_said(&mut clip, 200));
    clip.run_steps(100);
    assert!(clip.query_by_label(CROSSES).is_none(), "it goes away");
    clip.edit(|scene| scene.set_force(0, [0.0, -2.2]).unwrap());
    assert!(!is_said(&mut clip, 100), "it was said before");

    let mut gentle = scene("clip");
    gentle.set_force(0, [0.0, -1.0]).unwrap();
    assert!(!is_said(&mut open_of("clip", gentle), 100));
    for id in scene_ids() {
        let said = is_said(&mut open(id), if ids_of(Analysis::Dynamic).contains(&id) { 100 } else { 60 });
        assert_eq!(said, id == "clip", "{id}");
    }
}

/// The remedy shows the body again as it was seen before.
#[test]
fn the_view_of_an_exploded_motion_comes_back() {
    let mut ui = open("swing");
    ui.run_steps(4);
    let before = ui.camera().scale;
    ui.edit(|scene| scene.dynamics.integrator = IntegratorKind::SymplecticEuler);
    ui.wait_until("an explosion", |ui: &Ui| matches!(ui.simulation().status(), Status::Stopped(_)));
    ui.run_steps(4);
    ui.click_for("Use tr-bdf2", 8);
    assert!(time(&ui) < 2.0, "it starts again");
    let scale = ui.camera().scale;
    assert!(scale > 0.3 * before, "{scale} px/m, before {before}");
}

/// The button stands beside the status, and in the toolbar.
#[test]
fn a_body_inside_out_offers_a_reset() {
    let mut ui = open_of("jelly", scene_with("jelly", &["load.0.acceleration=[0, -400]"]));
    ui.wait_until("an inverted element", |ui: &Ui| ui.says("Inverted elements."));
    assert_eq!((ui.query_all_by_label("Reset").count(), ui.says("· inverted")), (2, false));
}
