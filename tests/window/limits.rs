//! Tests of the mode Limits: its numbers are those of `warpbeam limits`, and its line and strips set load, method and
//! element.

use std::ops::ControlFlow;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::common::lab::{lab_of, settle, window};
use crate::common::{scene, scene_with};
use warpbeam::app::Lab;
use warpbeam::scene::{ElementKind, IntegratorKind, MethodKind, Scene};
use warpbeam::study::figure::LoadAxis;
use warpbeam::study::limits::MethodLimits;

fn harness(scene: Scene) -> Harness<'static, Lab> {
    window([1280.0, 800.0], lab_of("scene", scene))
}

/// Opens Limits, and waits for its strips.
fn opened(scene: Scene) -> Harness<'static, Lab> {
    let mut harness = harness(scene);
    harness.key_press(Key::M);
    harness.run_steps(3);
    settle(&mut harness);
    harness
}

fn force(lab: &Lab) -> f64 {
    LoadAxis::of(lab.scene()).full
}

/// Presses at `from`, moves to `to`, and releases there.
fn drag(harness: &mut Harness<'_, Lab>, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let middle = from + 0.5 * (to - from);
    for event in [
        Event::PointerMoved(from),
        button(from, true),
        Event::PointerMoved(middle),
        Event::PointerMoved(to),
        button(to, false),
    ] {
        harness.input_mut().events.push(event);
        harness.step();
    }
    harness.run_steps(2);
}

/// Every strip has the words of the command, in the window's order.
#[test]
fn strips_are_those_of_the_command() {
    let harness = opened(scene("article"));
    let scene = scene("article");
    let limits = MethodLimits::of(&scene, &|_| ControlFlow::Continue(())).unwrap();
    let axis = LoadAxis::of(&scene);
    assert_eq!(limits.strips.len(), 9);
    for strip in &limits.strips {
        let [good, usable, converges, law] = strip.words(&axis, limits.range).map(|words| words.to_string());
        harness.get_by_label(&format!(
            "{} {}: within 1 %: {good}; within 5 %: {usable}; converges: {converges}; strains above 10 %: {law}",
            strip.element.id(),
            strip.method.id()
        ));
    }
}

/// Returns the labels of the strips that are complete, and of those that are not.
fn strips(harness: &Harness<'_, Lab>) -> [Vec<String>; 2] {
    let labels = harness.get_all_by_role(Role::Button).filter_map(|node| node.accesskit_node().label());
    let labels: Vec<String> = labels.collect();
    ["within 1 %: ", "of the loads are solved"]
        .map(|part| labels.iter().filter(|label| label.contains(part)).cloned().collect())
}

/// Strips are shown as they become complete. A change of the method does not start them again, a change of the body does.
#[test]
fn strips_appear_one_after_another() {
    let mut harness = harness(scene("cantilever"));
    harness.key_press(Key::M);
    let until = |harness: &mut Harness<'_, Lab>, holds: &dyn Fn([usize; 2]) -> bool| {
        for _ in 0..6000 {
            let found = strips(harness).map(|strips| strips.len());
            if holds(found) {
                return;
            }
            assert!(harness.state().is_computing() || found == [0, 0], "{found:?}");
            std::thread::sleep(std::time::Duration::from_millis(10));
            harness.step();
        }
        unreachable!("waited in vain for the strips")
    };
    until(&mut harness, &|[complete, rest]| complete > 0 && rest > 0);
    let [first, rest] = strips(&harness);
    assert_eq!(first.len() + rest.len(), 9, "{first:?} {rest:?}");
    // The scene's own strip is among the first.
    assert!(!rest.iter().any(|strip| strip.starts_with("t3 warped: 0 %")), "{rest:?}");
    let mut newton = harness.state().scene().clone();
    newton.solver.method = MethodKind::Newton;
    harness.state_mut().set_scene(newton.clone()).unwrap();
    harness.run_steps(2);
    assert!(first.iter().all(|strip| strips(&harness)[0].contains(strip)), "{first:?}");
    newton.beam.as_mut().unwrap().length *= 0.5;
    harness.state_mut().set_scene(newton).unwrap();
    harness.run_steps(2);
    assert_eq!(strips(&harness)[0], Vec::<String>::new());
    until(&mut harness, &|[complete, _]| complete > 0);
}

/// A click on a strip sets its method and element; one undo takes both back. The limits stay.
#[test]
fn a_click_on_a_strip_sets_method_and_element() {
    let mut harness = opened(scene("article"));
    let used = |lab: &Lab| (lab.scene().element(), lab.scene().solver.method);
    let before = used(harness.state());
    let row = harness.get_by(|node| node.label().is_some_and(|label| label.starts_with("q4 newton:"))).rect();
    let load = force(harness.state());
    drag(&mut harness, row.center(), row.center());
    assert_eq!(used(harness.state()), (ElementKind::Q4, MethodKind::Newton));
    assert_eq!(force(harness.state()), load, "a click does not move the line");
    assert!(harness.query_by(|node| node.label().is_some_and(|label| label.starts_with("t3 warped:"))).is_some());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert_eq!(used(harness.state()), before);
}

/// The strip of an early stop stays while another strip is used.
#[test]
fn the_strip_of_an_early_stop_stays() {
    let mut harness = opened(scene_with("article", &["solver.accept_after=2"]));
    let has_own = |harness: &Harness<'_, Lab>| {
        harness.query_by(|node| node.label().is_some_and(|label| label.starts_with("t3 warped:2: within"))).is_some()
    };
    assert!(has_own(&harness));
    let row = harness.get_by(|node| node.label().is_some_and(|label| label.starts_with("q4 newton:"))).rect();
    drag(&mut harness, row.center(), row.center());
    assert_eq!(harness.state().scene().solver.accept_after, 0);
    assert!(has_own(&harness), "nothing is computed again");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert_eq!(harness.state().scene().solver.accept_after, 2);
    assert!(has_own(&harness));
}

/// The line follows the pointer, and its load is where the axis has it: a drag by a third of the axis is a factor of
/// ten. The limits are not computed again; one undo restores the load.
#[test]
fn the_line_sets_the_load() {
    let mut harness = opened(scene("article"));
    let before = force(harness.state());
    let area = harness.get_by_role_and_label(Role::Slider, "Load").rect();
    let middle = Pos2::new(area.left() + area.width() * 2.0 / 3.0, area.top() + 4.0);
    drag(&mut harness, middle, middle - egui::vec2(area.width() / 3.0, 0.0));
    let ratio = force(harness.state()) / before;
    assert!((ratio - 0.1).abs() < 0.002, "{ratio}");
    let is_strip = |label: String| label.starts_with("t3 warped:") && label.contains("49.3 kN");
    let keeps_limits =
        |harness: &Harness<'_, Lab>| harness.query_by(|node| node.label().is_some_and(is_strip)).is_some();
    assert!(keeps_limits(&harness), "the limits are those of before");
    let first = force(harness.state());
    let now = Pos2::new(area.left() + area.width() / 3.0, middle.y);
    drag(&mut harness, now, now + egui::vec2(area.width() / 6.0, 0.0));
    assert!(force(harness.state()) > 2.0 * first);
    for expected in [first, before] {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(force(harness.state()), expected);
        assert!(keeps_limits(&harness), "nothing is computed again");
    }
    // A load that is set elsewhere moves the line too, but for one out of the range.
    let typed = |harness: &mut Harness<'_, Lab>, factor: f64| {
        let mut scene = harness.state().scene().clone();
        scene.scale_loads(factor);
        harness.state_mut().set_scene(scene).unwrap();
        harness.run_steps(2);
    };
    typed(&mut harness, 0.5);
    assert!(keeps_limits(&harness));
    typed(&mut harness, 200.0);
    assert!(!keeps_limits(&harness));
    typed(&mut harness, 0.01);
    settle(&mut harness);
    assert_eq!(force(harness.state()), before);
    // With the focus on the line, an arrow key changes the load in small steps.
    harness.get_by_role_and_label(Role::Slider, "Load").focus();
    harness.step();
    harness.key_press(Key::ArrowRight);
    harness.run_steps(3);
    let ratio = force(harness.state()) / before;
    assert!((ratio - 1.05).abs() < 0.01, "{ratio}");
}

/// Another body has other limits, which replace those of the body before.
#[test]
fn an_edit_of_the_body_computes_the_limits_again() {
    let mut harness = opened(scene("article"));
    let mut longer = harness.state().scene().clone();
    longer.beam.as_mut().unwrap().length *= 2.0;
    harness.state_mut().set_scene(longer.clone()).unwrap();
    harness.run_steps(2);
    settle(&mut harness);
    let limits = MethodLimits::of(&longer, &|_| ControlFlow::Continue(())).unwrap();
    let linear = limits.strips.iter().find(|s| (s.element, s.method) == (ElementKind::T6, MethodKind::Linear)).unwrap();
    let usable = linear.words(&LoadAxis::of(&longer), limits.range)[1].to_string();
    let found = |label: String| label.starts_with("t6 linear:") && label.contains(&format!("within 5 %: {usable};"));
    assert!(harness.query_by(|node| node.label().is_some_and(found)).is_some(), "{usable}");
}

/// The strips of a motion are its integrators; a click sets the integrator, and the line sets the time step.
#[test]
fn a_motion_has_limits_of_its_integrators() {
    // A coarse mesh keeps the test short.
    let scene = scene_with("swing", &["beam.cells=[6,1]"]);
    let mut harness = opened(scene.clone());
    let found = MethodLimits::of(&scene, &|_| ControlFlow::Continue(())).unwrap();
    let row = harness.get_by(|node| node.label().is_some_and(|label| label.starts_with("energy-momentum:"))).rect();
    drag(&mut harness, row.center(), row.center());
    let dynamics = |lab: &Lab| lab.scene().dynamics.clone();
    assert_eq!(dynamics(harness.state()).integrator, IntegratorKind::EnergyMomentum);
    assert_eq!(dynamics(harness.state()).time_step, scene.dynamics.time_step);
    // The panel has a slider of this name, too.
    let sliders = harness.get_all_by_role_and_label(Role::Slider, "Time step").map(|slider| slider.rect());
    let area = sliders.max_by(|a, b| a.width().total_cmp(&b.width())).unwrap();
    drag(&mut harness, area.center(), area.right_top() + egui::vec2(0.0, 4.0));
    let factor = dynamics(harness.state()).time_step / scene.dynamics.time_step;
    assert!((factor / found.range[1] - 1.0).abs() < 0.01, "{factor}");
    assert!(strips(&harness)[1].is_empty() && strips(&harness)[0].len() == 4, "the limits are those of before");
}
