//! Tests of the limits in the mode Measure: its numbers are those of `warpbeam limits`; its strips set load, method and element.

use crate::common::lab::*;
use warpbeam::study::figure::LoadAxis;
use warpbeam::study::limits::TIME_STEPS;

/// Opens the limits, and waits for its strips.
fn opened(scene: Scene) -> Ui {
    let mut ui = window(SIZE, lab_of("scene", scene));
    ui.key_press(Key::M);
    ui.run_steps(3);
    settle(&mut ui);
    ui
}

fn force(lab: &Lab) -> f64 {
    LoadAxis::of(lab.scene()).full
}

/// Presses at `from`, moves to `to`, and releases there.
fn drag(ui: &mut Ui, from: Pos2, to: Pos2) {
    let moved = |part: f32| Event::PointerMoved(from + part * (to - from));
    for event in [moved(0.0), primary(from, true), moved(0.5), moved(1.0), primary(to, false)] {
        ui.input_mut().events.push(event);
        ui.step();
    }
    ui.run_steps(2);
}

/// Returns the strip with this beginning.
fn strip(ui: &Ui, start: &str) -> Option<(String, Rect)> {
    let node = ui.query_by(|node| node.label().is_some_and(|label| label.starts_with(start)))?;
    Some((node.accesskit_node().label().unwrap(), node.rect()))
}

fn click_strip(ui: &mut Ui, start: &str) {
    let (_, rect) = strip(ui, start).unwrap();
    drag(ui, rect.center(), rect.center());
}

/// Returns the labels of the strips that are complete, and of those that are not.
fn strips(ui: &Ui) -> [Vec<String>; 2] {
    let labels = ui.get_all_by_role(Role::Button).filter_map(|node| node.accesskit_node().label());
    let labels: Vec<String> = labels.collect();
    ["within 1 %: ", "of the loads are solved"]
        .map(|part| labels.iter().filter(|label| label.contains(part)).cloned().collect())
}

/// A change of the method does not start them again, a change of the body does.
#[test]
fn strips_appear_one_after_another() {
    let mut ui = window(SIZE, lab_of("scene", scene("cantilever")));
    ui.key_press(Key::M);
    let count = |ui: &Ui| {
        let found = strips(ui).map(|strips| strips.len());
        assert!(found[0] == 9 || ui.state().is_computing() || found == [0, 0], "{found:?}");
        found
    };
    ui.wait_until("a strip before the others", |ui| count(ui)[0] > 0 && count(ui)[1] > 0);
    let [first, rest] = strips(&ui);
    assert_eq!(first.len() + rest.len(), 9, "{first:?} {rest:?}");
    assert!(!rest.iter().any(|strip| strip.starts_with("t3 warped: 0 %")), "{rest:?}");
    ui.edit(|scene| scene.solver.method = MethodKind::Newton);
    ui.run_steps(2);
    assert!(first.iter().all(|strip| strips(&ui)[0].contains(strip)), "{first:?}");
    ui.edit(|scene| scene.beam.as_mut().unwrap().length *= 0.5);
    ui.run_steps(2);
    assert_eq!(strips(&ui)[0], Vec::<String>::new());
    ui.wait_until("a strip", |ui| count(ui)[0] > 0);
}

/// A strip sets method and element and leaves the line; the line sets the load; one undo takes each back. The limits stay.
#[test]
fn strips_set_method_and_element_and_the_line_the_load() {
    let mut ui = opened(scene_with("article", &["solver.accept_after=2"]));
    let has_own = |ui: &Ui| {
        let strips = ["t3 warped:2: within", "t3 warped: within"].map(|start| strip(ui, start).is_some());
        assert_eq!(strips, [true; 2], "nothing is computed again");
    };
    let used = |ui: &Ui| {
        let solver = &ui.scene().solver;
        (ui.scene().element(), solver.method, solver.accept_after, force(ui.state()))
    };
    let before = used(&ui);
    has_own(&ui);
    click_strip(&mut ui, "q4 newton:");
    assert_eq!(used(&ui), (ElementKind::Q4, MethodKind::Newton, 0, before.3));
    has_own(&ui);
    ui.undo();
    assert_eq!((used(&ui), before.2), (before, 2));
    has_own(&ui);
    // The line sets the load: a drag by a third of the axis is a factor of ten. One undo restores it.
    let before = force(ui.state());
    let area = ui.rect(Role::Slider, "Load");
    let at = |part: f32| Pos2::new(area.left() + area.width() * part, area.top() + 4.0);
    drag(&mut ui, at(2.0 / 3.0), at(1.0 / 3.0));
    let ratio = force(ui.state()) / before;
    assert!((ratio - 0.1).abs() < 0.002, "{ratio}");
    let keeps_limits = |ui: &Ui| strip(ui, "t3 warped: within").is_some_and(|(label, _)| label.contains("49.3 kN"));
    assert!(keeps_limits(&ui), "the limits are those of before");
    let first = force(ui.state());
    drag(&mut ui, at(1.0 / 3.0), at(0.5));
    assert!(force(ui.state()) > 2.0 * first);
    for expected in [first, before] {
        ui.undo();
        assert_eq!(force(ui.state()), expected);
        assert!(keeps_limits(&ui), "nothing is computed again");
    }
    // A load that is set elsewhere moves the line too, but for one out of the range.
    for (factor, keeps) in [(0.5, true), (200.0, false), (0.01, false)] {
        ui.edit(|scene| scene.scale_loads(factor));
        ui.run_steps(2);
        assert!(keeps_limits(&ui) == keeps || factor == 0.01, "{factor}");
    }
    settle(&mut ui);
    assert_eq!(force(ui.state()), before);
    // With the focus on the line, an arrow key changes the load in small steps.
    ui.get_by_role_and_label(Role::Slider, "Load").focus();
    ui.step();
    ui.key_press(Key::ArrowRight);
    ui.run_steps(3);
    let ratio = force(ui.state()) / before;
    assert!((ratio - 1.05).abs() < 0.01, "{ratio}");
}

/// A click on a strip sets the integrator, and the line sets the time step.
#[test]
fn a_motion_has_limits_of_its_integrators() {
    // A coarse mesh keeps the test short.
    let scene = scene_with("swing", &["beam.cells=[6,1]"]);
    let mut ui = opened(scene.clone());
    click_strip(&mut ui, "energy-momentum:");
    let dynamics = |ui: &Ui| (ui.scene().dynamics.integrator, ui.scene().dynamics.time_step);
    assert_eq!(dynamics(&ui), (IntegratorKind::EnergyMomentum, scene.dynamics.time_step));
    // The panel has a slider of this name, too.
    let sliders = ui.get_all_by_role_and_label(Role::Slider, "Time step").map(|slider| slider.rect());
    let area = sliders.max_by(|a, b| a.width().total_cmp(&b.width())).unwrap();
    drag(&mut ui, area.center(), area.right_top() + vec2(0.0, 4.0));
    let factor = dynamics(&ui).1 / scene.dynamics.time_step;
    assert!((factor / TIME_STEPS[1] - 1.0).abs() < 0.01, "{factor}");
    assert!(strips(&ui)[1].is_empty() && strips(&ui)[0].len() == 4, "the limits are those of before");
}
