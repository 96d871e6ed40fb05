//! Tests of the panel, operated by labels, pointer and keys, without a display or a GPU.

use crate::common::lab::{pick, type_into, unfold, wait};
use crate::common::{scene, scene_with, solve_json};
use crate::ui_interaction::{click, on_body};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::Vector2;
use warpbeam::app::Lab;
use warpbeam::format::percent;
use warpbeam::scene::{Analysis, ElementKind, IntegratorKind, Load, MethodKind, Plane, Source};
use warpbeam::study::motion::{MotionMeasurement, MotionSetting};
use warpbeam::study::{Demand, Reference};
use warpbeam::{Scene, Simulation, Status};

fn harness(id: &str) -> Harness<'static, Lab> {
    let mut harness = harness_of(id);
    harness.run();
    harness
}

/// Returns a window with a scene that may not come to rest.
fn harness_of(id: &str) -> Harness<'static, Lab> {
    harness_with(id, scene(id))
}

fn harness_with(id: &str, scene: Scene) -> Harness<'static, Lab> {
    let simulation = Simulation::new(&scene).unwrap();
    let lab = Lab::new(Source { name: id.into(), assignments: Vec::new() }, scene, simulation);
    Harness::builder().with_size([1280.0, 800.0]).with_max_steps(400).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    )
}

fn force(lab: &Lab) -> [f64; 2] {
    lab.scene()
        .loads
        .iter()
        .find_map(|l| match l {
            Load::Force { force, .. } => Some(*force),
            _ => None,
        })
        .unwrap()
}

fn tip(lab: &Lab) -> [f64; 2] {
    lab.simulation().solution().probes[0].u.into()
}

/// Dragging the force slider gives the deflection that `solve` gives for that force.
#[test]
fn dragging_the_force_slider_bends_the_beam_as_solve_does() {
    let mut harness = harness("cantilever");
    let before = (force(harness.state()), tip(harness.state()));
    let slider = harness.get_by_role_and_label(Role::Slider, "Force").rect();
    let below = harness.get_by_label_contains("Material: ").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.hover_at(at(0.4));
    harness.drag_at(at(0.4));
    harness.run();
    harness.hover_at(at(0.46));
    harness.step();
    assert!(harness.state().iterates(), "the beam did not start to move");
    let moving = harness.get_by_role_and_label(Role::Slider, "Force").rect();
    assert_eq!(moving, slider, "the slider moves away under the pointer");
    let moving = harness.get_by_label_contains("Material: ").rect();
    assert_eq!(moving, below, "the layout changes while the beam moves");
    harness.run();
    harness.drop_at(at(0.46));
    harness.run();
    let lab = harness.state();
    let [fx, fy] = force(lab);
    assert_ne!([fx, fy], before.0, "the slider did not move the force");
    assert_eq!(fx, 0.0);
    assert_eq!(*lab.simulation().status(), Status::Converged);
    let json = solve_json(&["cantilever", "--set", &format!("load.0.force=[{fx},{fy}]")]);
    let solved = [0, 1].map(|i| json["probes"][0]["u"][i].as_f64().unwrap());
    let shown = tip(lab);
    // Both are within the solver's tolerance of the equilibrium, from different starts.
    let error = (shown[0] - solved[0]).hypot(shown[1] - solved[1]);
    assert!(error < 1e-5 * solved[1].abs(), "{shown:?} {solved:?}");
    assert!((shown[1] - before.1[1]).abs() > 1e-3);
}

#[test]
fn typed_values_take_effect_also_beyond_the_slider() {
    let mut harness = harness("cantilever");
    type_into(&mut harness, "Force", "0.5 kN");
    assert_eq!(force(harness.state()), [0.0, -500.0]);
    type_into(&mut harness, "Direction", "270");
    assert!((force(harness.state())[1] + 500.0).abs() < 1e-9 && force(harness.state())[0].abs() < 1e-9);
    type_into(&mut harness, "Direction", "0");
    assert_eq!(force(harness.state()), [500.0, 0.0]);
    type_into(&mut harness, "Force", "0");
    type_into(&mut harness, "Direction", "90");
    type_into(&mut harness, "Force", "2e7");
    assert_eq!(force(harness.state()), [0.0, 2e7]);
    type_into(&mut harness, "Gravity", "9.81");
    assert!(harness.state().scene().loads.contains(&Load::gravity([0.0, -9.81])));
    type_into(&mut harness, "Young E", "2 MPa");
    type_into(&mut harness, "Poisson ν", "0.45");
    type_into(&mut harness, "Density", "1200");
    type_into(&mut harness, "Thickness t", "0.2");
    let m = harness.state().scene().material;
    assert_eq!((m.young, m.poisson, m.density, m.thickness), (2e6, 0.45, 1200.0, 0.2));
    type_into(&mut harness, "Cells along", "40");
    type_into(&mut harness, "Cells across", "3");
    assert_eq!(harness.state().scene().beam.as_ref().unwrap().cells, [40, 3]);
    assert_eq!(harness.state().simulation().system().mesh().element_count(), 240);
    // A part in other units keeps its number of cells, and a coordinate its digits.
    type_into(&mut harness, "Length", "6 in");
    type_into(&mut harness, "Height", "0.5 in");
    let beam = harness.state().scene().beam.clone().unwrap();
    assert_eq!((beam.length, beam.height, beam.cells), (0.1524, 0.0127, [40, 3]));
}

/// A value out of range is refused with a message about the expected range. It is neither clamped nor accepted.
#[test]
fn values_out_of_range_are_refused_with_a_message() {
    let cases = [
        ("Force", "-5", "expected 0 to 1e15 N, got -5"),
        ("Force", "lots", "got \u{201c}lots\u{201d}"),
        ("Force", "0,5", "is not a number: numbers look like"),
        ("Force", "30,000", "can be read in two ways: write 30000 or 30.000"),
        ("Force", "12 Pa", "is a pressure (Pa); expected a force (N)"),
        ("Direction", "400", "expected -360 to 360 °, got 400"),
        ("Gravity", "1e9", "m/s², got 1e9"),
        ("Moment", "1e30", "N m, got 1e30"),
        ("Young E", "0", "Pa, got 0"),
        ("Young E", "nan", "got \u{201c}nan\u{201d}"),
        ("Poisson ν", "0.7", "expected -0.99 to 0.5, got 0.7"),
        ("Density", "-1", "kg/m³, got -1"),
        ("Thickness t", "0", "m, got 0"),
        ("Cells along", "0", "expected 1 to 100000, got 0"),
        ("Cells along", "2.5", "expected a whole number, got 2.5"),
        ("Cells across", "90000", "cells in all"),
    ];
    for (label, text, message) in cases {
        let mut harness = harness("cantilever");
        unfold(&mut harness, label);
        let before = harness.state().scene().clone();
        assert!(harness.query_by_label_contains(message).is_none());
        type_into(&mut harness, label, text);
        assert_eq!(*harness.state().scene(), before, "{label} {text}");
        let shown = harness.query_by_label_contains(message).map(|node| node.rect());
        let shown = shown.unwrap_or_else(|| unreachable!("{label} {text}: no message {message:?}"));
        let field = harness.get_by_role_and_label(Role::SpinButton, label).rect();
        assert!(
            shown.top() >= field.bottom() - 1.0 && shown.top() < field.bottom() + 48.0,
            "{label}: not next to the field"
        );
        // A valid value removes the message.
        let good = if label.starts_with("Cells") { "4" } else { "0.25" };
        type_into(&mut harness, label, good);
        assert!(harness.query_by_label_contains(message).is_none(), "{label}: the message stays");
    }
    // So does the present value.
    let mut harness = harness("cantilever");
    type_into(&mut harness, "Force", "12 Pa");
    assert!(harness.query_by_label_contains("is a pressure").is_some());
    type_into(&mut harness, "Force", "1 kN");
    assert!(harness.query_by_label_contains("is a pressure").is_none(), "the message stays");
    // A value that the scene refuses keeps its message, whatever was refused before.
    unfold(&mut harness, "Cells across");
    for text in ["lots", "4", "90000"] {
        type_into(&mut harness, "Cells across", text);
    }
    assert!(harness.query_by_label_contains("cells in all").is_some(), "no message");
}

/// A refused text stays in its field, where it can be corrected; Escape restores the value.
#[test]
fn a_refused_text_stays_for_correction() {
    let mut harness = harness("cantilever");
    let before = force(harness.state());
    for refused in ["12 kg", "-5"] {
        type_into(&mut harness, "Force", refused);
        let field = harness.get_by_role_and_label(Role::SpinButton, "Force").accesskit_node().value();
        assert_eq!(field.as_deref(), Some(refused));
        assert!(harness.query_by_label_contains("expected").is_some());
        // A space is part of the text, not a shortcut.
        harness.event(egui::Event::Text(" ".to_owned()));
        harness.key_press(Key::Space);
        harness.run();
        let field = harness.get_by_role_and_label(Role::SpinButton, "Force").accesskit_node().value();
        assert_eq!(field.as_deref(), Some(format!("{refused} ").as_str()));
        harness.key_press(Key::Escape);
        harness.run();
        assert!(harness.query_by_label_contains("expected").is_none(), "{refused}: the message stays");
        assert_eq!(force(harness.state()), before);
    }
    // Escape discards a valid text as well.
    harness.get_by_role_and_label(Role::SpinButton, "Force").click();
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(egui::Event::Text("7 kN".to_owned()));
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(force(harness.state()), before);
    type_into(&mut harness, "Force", "12");
    type_into(&mut harness, "Force", "12 kg");
    harness.key_press(Key::Backspace);
    harness.key_press(Key::Backspace);
    harness.event(egui::Event::Text("kN".to_owned()));
    harness.step();
    harness.key_press(Key::Enter);
    harness.run();
    assert!((force(harness.state())[1] + 12e3).abs() < 1e-6, "{:?}", force(harness.state()));
    // Undo in the field ends at the text that the edit begins with.
    type_into(&mut harness, "Force", "4 kN");
    harness.get_by_role_and_label(Role::SpinButton, "Force").click();
    harness.run();
    for _ in 0..3 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.step();
    }
    let field = harness.get_by_role_and_label(Role::SpinButton, "Force").accesskit_node().value();
    assert_eq!(field.as_deref(), Some("4 kN"));
    // A click elsewhere restores the value, and the next one removes the message.
    type_into(&mut harness, "Force", "12 kg");
    let pos = harness.state().view_rect().left_center() + egui::vec2(8.0, 0.0);
    harness.hover_at(pos);
    for pressed in [true, false, true, false] {
        assert!(harness.query_by_label_contains("expected").is_some(), "{pressed}");
        let button = egui::PointerButton::Primary;
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        harness.run();
    }
    assert!(harness.query_by_label_contains("expected").is_none());
    assert!((force(harness.state())[1] + 4e3).abs() < 1e-6);
}

/// A body with inverted elements is reported, even if its equations are solved.
#[test]
fn an_inside_out_body_is_reported() {
    let mut harness = harness("cantilever");
    let words = "inverted elements";
    assert!(harness.query_by_label_contains(words).is_none());
    pick(&mut harness, "Method", "linear");
    type_into(&mut harness, "Force", "1e13");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    assert!(harness.query_by_label_contains(words).is_some(), "{:?}", texts(&harness));
    harness.get_by_label("explain").click();
    harness.run();
    assert!(harness.query_by_label_contains("no real body can have").is_some());
}

#[test]
fn every_number_has_a_unit_and_a_tooltip() {
    for (label, unit, tip) in [
        ("Force", " kN", "12 kN"),
        ("Direction", "°", "90° up"),
        ("Gravity", "m/s²", "9.81 on Earth"),
        ("Moment", "N m", "bends a beam into a circle"),
        ("Young E", " MPa", "stiffness"),
        ("Poisson ν", "", "lateral contraction"),
        ("Density", "kg/m³", "inertia in motion"),
        ("Thickness t", " m", "out of the plane"),
        ("Cells along", "", "two triangles"),
        ("Cells across", "", "two triangles"),
    ] {
        let mut harness = harness("article");
        unfold(&mut harness, label);
        let node = harness.get_by_role_and_label(Role::SpinButton, label);
        let value = node.accesskit_node().value().unwrap_or_default();
        let center = harness.get_by_role_and_label(Role::Slider, label).rect().center();
        assert!(value.contains(unit), "{label}: {value}");
        harness.hover_at(center);
        harness.run_steps(60);
        assert!(harness.query_all_by_label_contains(tip).next().is_some(), "{label}: no tooltip with {tip:?}");
        harness.hover_at(egui::pos2(900.0, 400.0));
        harness.run_steps(5);
    }
}

#[test]
fn run_pause_step_and_reset() {
    let mut harness = harness("article");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    let converged = harness.state().simulation().iterations();
    // A converged body has nothing to pause, by button or by key.
    assert!(harness.query_by_label("Pause").is_none());
    assert!(harness.get_by_label("Run").accesskit_node().is_disabled());
    harness.key_press(Key::Space);
    harness.run();
    assert!(harness.query_by_label_contains("Paused").is_none());
    // Another step starts again at rest.
    harness.get_by_label("Step").click();
    harness.run();
    assert_eq!(harness.state().simulation().iterations(), 1);
    // The first warped iteration is the linear solution.
    let linear = solve_json(&["article", "--set", "solver.method=linear"]);
    assert!((tip(harness.state())[1] - linear["probes"][0]["u"][1].as_f64().unwrap()).abs() < 1e-9);
    harness.key_press(Key::N);
    harness.run();
    assert_eq!(harness.state().simulation().iterations(), 2);
    harness.get_by_label("Reset").click();
    harness.run();
    assert_eq!(harness.state().simulation().iterations(), 0);
    assert_eq!(tip(harness.state()), [0.0, 0.0]);
    harness.get_by_label("Run").click();
    harness.run();
    assert_eq!(harness.state().simulation().iterations(), converged);
}

/// A step shows an iterate with its number and residual; an edit goes on to the equilibrium, in slow motion too.
#[test]
fn a_step_shows_an_iterate_and_an_edit_goes_on() {
    let mut harness = harness("article");
    harness.get_by_label("Step").click();
    harness.run();
    let residual = format!("residual {:.1e}", harness.state().simulation().residual());
    assert!(harness.query_by_label(&format!("Paused \u{b7} 1 iteration \u{b7} {residual}")).is_some(), "{residual}");
    assert!(harness.query_by_label_contains("not reached").is_none(), "an iterate that was asked for is not grey");
    type_into(&mut harness, "Force", "20 kN");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    harness.get_by_label("One iteration a frame").click();
    harness.run();
    harness.key_press(Key::R);
    harness.step();
    let mut frames = 1;
    while *harness.state().simulation().status() != Status::Converged {
        harness.step();
        frames += 1;
        assert!(harness.state().simulation().iterations() <= frames, "more than one iteration in a frame");
    }
    assert!(frames > 5, "{frames} frames");
}

/// The key Space goes to the control that has the focus.
#[test]
fn space_on_a_focused_button_is_the_buttons() {
    let mut harness = harness("article");
    harness.get_by_label("Step").click();
    harness.run();
    assert!(!harness.state().iterates());
    harness.get_by_label("Help").focus();
    harness.run();
    harness.key_press(Key::Space);
    harness.run();
    assert!(harness.query_by_label_contains("Run or pause").is_some(), "the list of keys opens");
    assert_eq!(harness.state().simulation().iterations(), 1, "and nothing runs");
}

/// Text typed into a number field goes to the field, even if it is completed within one frame.
#[test]
fn keys_that_end_a_text_edit_do_not_act_on_the_window() {
    let mut harness = harness("article");
    let converged = harness.state().simulation().iterations();
    harness.get_by_role_and_label(Role::SpinButton, "Force").click();
    harness.run();
    let key = |key, text: &str| {
        let press =
            egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE };
        [press, egui::Event::Text(text.to_owned())]
    };
    // Outside the field, Space pauses and N steps.
    let typed = [key(Key::Num3, "30"), key(Key::Space, " "), key(Key::N, "kN")].into_iter().flatten();
    let [enter, _] = key(Key::Enter, "");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.input_mut().events.extend(typed.chain([enter]));
    harness.run();
    assert_eq!(force(harness.state()), [0.0, -30_000.0]);
    assert_eq!(harness.state().simulation().iterations(), converged, "a key has stepped or reset the beam");
    assert!(harness.query_by_label_contains("Paused").is_none());
}

/// The message about a refused value moves no other row.
#[test]
fn a_refused_value_moves_nothing() {
    let mut harness = harness("article");
    let place = |harness: &Harness<'_, Lab>| harness.get_by_role_and_label(Role::SpinButton, "Direction").rect();
    let before = place(&harness);
    type_into(&mut harness, "Force", "45 mm");
    assert!(harness.query_by_label_contains("is a length").is_some(), "{:?}", texts(&harness));
    assert_eq!(place(&harness), before);
}

/// The ends of a fixed colour range accept any value, including negative ones. The scale does not
/// move while an end is dragged.
#[test]
fn a_fixed_range_of_colours_is_set() {
    let mut harness = harness("article");
    harness.key_press(Key::Num4);
    harness.run();
    harness.get_by_label_contains("View: ").click();
    harness.run_steps(8);
    harness.run();
    harness.get_by_label("Fixed colour range").click();
    harness.run();
    type_into(&mut harness, "Lowest", "-200");
    let shown = |harness: &Harness<'_, Lab>, end: &str| {
        let node = harness.get_by_role_and_label(Role::SpinButton, end);
        node.accesskit_node().value().unwrap_or_default()
    };
    assert!(harness.query_by_label_contains("expected").is_none(), "{:?}", texts(&harness));
    let (low, high) = (shown(&harness, "Lowest"), shown(&harness, "Highest"));
    let range = harness.state().frame().range;
    assert!(range[0] == -range[1] && range[1] > 0.0, "the middle colour of a field with a sign is 0: {range:?}");
    type_into(&mut harness, "Highest", "-100 MPa");
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!((shown(&harness, "Lowest"), shown(&harness, "Highest")), (low, high), "a refused value is shown");
    let slider = harness.get_by_role_and_label(Role::Slider, "Highest").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.hover_at(at(0.7));
    harness.drag_at(at(0.7));
    harness.run();
    let first = shown(&harness, "Highest");
    for share in [0.9, 0.98, 0.7] {
        harness.hover_at(at(share));
        harness.run();
    }
    harness.drop_at(at(0.7));
    harness.run();
    assert_eq!(shown(&harness, "Highest"), first, "the scale has moved under the pointer");
}

/// Arrow keys change a value by one hundredth.
#[test]
fn arrow_keys_step_a_slider_finely() {
    let mut harness = harness("article");
    harness.get_by_role_and_label(Role::Slider, "Force").focus();
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    assert_eq!(force(harness.state()), [0.0, -30_300.0]);
    harness.get_by_role_and_label(Role::Slider, "Direction").focus();
    harness.run();
    harness.key_press(Key::ArrowLeft);
    harness.run();
    let [fx, fy] = force(harness.state());
    assert!((fy.atan2(fx).to_degrees() + 91.0).abs() < 1e-9, "{fx} {fy}");
}

/// An inaccurate result gives the reason, and one click improves it.
#[test]
fn remedies_are_one_click_away() {
    let mut harness = harness("article");
    wait(&mut harness, "the truth", |lab| !lab.is_computing());
    harness.run();
    let error = solve_json(&["article"])["probes"][0]["error_percent"].as_f64().unwrap();
    let shown = format!("ERROR {} mesh · strain 56 %", percent(error));
    assert!(harness.query_by_label(&shown).is_some(), "{shown}: {:?}", texts(&harness));
    let words = format!("{} error: three-node triangles lock in bending.", percent(error));
    assert!(harness.query_by_label(&words).is_some(), "{words}");
    harness.get_by_label("Try t6 with newton").click();
    harness.run();
    assert_eq!(harness.state().scene().element().id(), "t6");
    wait(&mut harness, "the truth", |lab| !lab.is_computing());
    harness.run();
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    assert!(harness.query_by_label("ERROR 1.5 % strain 48 %").is_some(), "{:?}", texts(&harness));
    assert!(harness.query_by_label_contains("lock in bending").is_none());

    let mut harness = self::harness("cantilever");
    type_into(&mut harness, "Force", "9000");
    assert!(harness.query_by_label_contains("The warped iteration does not converge").is_some());
    harness.get_by_label("Use newton").click();
    harness.run();
    assert_eq!(harness.state().scene().solver.method, MethodKind::Newton);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);

    let mut harness = self::harness("cook");
    wait(&mut harness, "the truth", |lab| !lab.is_computing());
    harness.run();
    assert!(harness.query_by_label_contains("error of linear theory").is_some(), "{:?}", texts(&harness));
}

/// The window says that a force acts on another point than the one of the scene, and that an error is unknown; an
/// outline whose error is unknown is not drawn as a reference.
#[test]
fn the_window_says_which_force_is_moved_and_which_error_is_unknown() {
    let moved = scene("article").force([2.5, 0.0], [0.0, -20e3]);
    let mut harness = harness_with("article", moved);
    harness.run();
    let note = "Load 2 at (2.5, 0) m acts on the nearest node, 707.1 mm away";
    assert!(harness.query_by_label_contains(note).is_some(), "{:?}", texts(&harness));

    // The displacement under a point load grows without limit on finer meshes.
    let place = [1.5, -0.5];
    let scene = Scene::beam(5.0, 1.0).with_cells(10, 2).with_element(ElementKind::Q4).clamp("left");
    let scene = scene.force(place, [60e3, 0.0]).probe("there", place).with_method(MethodKind::Newton);
    let reference = Reference::of(&scene).unwrap();
    assert_eq!((reference.first(), reference.outline.len()), (None, 0));
    let mut harness = harness_with("article", scene);
    wait(&mut harness, "the reference", |lab| !lab.is_computing());
    harness.run();
    let mut bar = texts(&harness).into_iter().filter(|text| text.starts_with("ERROR"));
    assert!(bar.next().is_some_and(|text| text.ends_with("no reference · strain 21 %")), "{:?}", texts(&harness));
}

/// If ρ is above 1 although the result has converged, the window explains why.
#[test]
fn rho_above_one_with_a_converged_bar_is_explained() {
    let mut harness = harness("article");
    harness.get_by_label("explain").click();
    harness.run();
    assert!(harness.query_by_label_contains("The forces balance").is_some());
    assert!(harness.query_by_label_contains("Stable: after a small push").is_some());
    pick(&mut harness, "Scene", "stretch");
    assert!(harness.query_by_label_contains("The forces balance").is_none(), "it explains the scene before");
    harness.get_by_label("explain").click();
    type_into(&mut harness, "Force", "500 kN");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    let rho = harness.state().simulation().equilibrium().unwrap().certificate().and_then(|c| c.fixed_point_rho);
    assert!(rho.is_some_and(|rho| rho > 1.0), "{rho:?}");
    assert!(harness.query_by_label_contains("it converged because").is_some());
}

#[test]
fn presets_set_the_material_and_the_collapsed_header_names_it() {
    let mut harness = harness("article");
    assert!(harness.query_by_label("Material: rubber, 1 MPa").is_some());
    unfold(&mut harness, "Young E");
    harness.get_by_label("Steel").click();
    harness.run();
    let m = harness.state().scene().material;
    assert_eq!((m.young, m.poisson, m.density, m.thickness), (2.1e11, 0.3, 7850.0, 1.0));
    assert!(harness.query_by_label("Material: steel, 210 GPa").is_some());
}

/// In a window of any size, every control is inside, has a name, and can be reached.
#[test]
fn a_narrow_window_has_a_sheet_and_everything_is_within_it() {
    for size in [[640.0, 480.0], [959.0, 600.0], [960.0, 600.0], [1280.0, 800.0]] {
        let mut harness = harness("article");
        harness.set_size(size.into());
        harness.run();
        let narrow = size[0] < 960.0;
        assert_eq!(harness.query_by_role_and_label(Role::Slider, "Force").is_none(), narrow);
        if narrow {
            harness.get_by_label("Panel").click();
            harness.run();
            assert!(harness.state().view_rect().right() > size[0] - 20.0, "the sheet is over the body");
        }
        let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for name in [
            "Pause", "Run", "Step", "Reset", "Explore", "Learn", "Compare", "Budget", "Help", "Theme", "Panel",
            "Limits", "Sections", "explain",
        ] {
            let node = harness.query_by_label(name);
            assert!(node.is_some() || ["Pause"].contains(&name), "{size:?}: no {name}");
            assert!(node.is_none_or(|n| window.contains_rect(n.rect())), "{size:?}: {name} is clipped");
        }
        let controls = [Role::Button, Role::ComboBox, Role::Slider, Role::SpinButton, Role::CheckBox];
        for node in harness.get_all_by(|node| controls.contains(&node.role())) {
            let rect = node.rect();
            assert!(node.accesskit_node().label().is_some_and(|l| !l.is_empty()), "{size:?}: no name at {rect:?}");
            assert!(
                rect.left() >= 0.0 && rect.right() <= size[0],
                "{size:?}: {:?} at {rect:?}",
                node.accesskit_node().label()
            );
        }
        if narrow {
            harness.key_press(Key::P);
            harness.run();
            assert!(harness.query_by_role_and_label(Role::Slider, "Force").is_none());
        }
    }
}

#[test]
fn a_diverging_iteration_is_reported_and_the_panel_keeps_working() {
    let mut harness = harness("cantilever");
    type_into(&mut harness, "Force", "9000");
    assert!(matches!(harness.state().simulation().status(), Status::Diverged(_)));
    assert!(harness.query_by_label_contains("Diverged").is_none(), "one message has the remedy");
    assert!(harness.query_by_label("Use newton").is_some());
    harness.get_by_label("explain").click();
    harness.run();
    assert!(harness.query_all_by_label_contains("Diverged: the residual has not fallen").next().is_some());
    assert!(harness.query_all_by_label_contains("not reached").next().is_some());
    type_into(&mut harness, "Force", "1000");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    assert!(harness.query_by_label_contains("Diverged").is_none());
}

#[test]
fn scene_method_and_plane_can_be_chosen() {
    let mut harness = harness("article");
    pick(&mut harness, "Scene", "bridge");
    assert_eq!(harness.state().scene().name, "Bridge");
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    pick(&mut harness, "Method", "linear");
    assert_eq!(harness.state().scene().solver.method, MethodKind::Linear);
    unfold(&mut harness, "strain");
    harness.get_by_label("strain").click();
    harness.run();
    assert_eq!(harness.state().scene().material.plane, Plane::Strain);
}

#[test]
fn keys_are_listed_and_work() {
    let mut harness = harness("article");
    harness.key_press(Key::F1);
    harness.run();
    for words in [
        "Run or pause",
        "Save a screenshot",
        "Copy the scene as TOML",
        "Zoom at the pointer",
        "the previous or next card",
    ] {
        assert!(harness.query_by_label_contains(words).is_some(), "{words}");
    }
    harness.key_press(Key::Escape);
    harness.run();
    assert!(harness.query_by_label_contains("Run or pause").is_none());
    harness.key_press(Key::P);
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Slider, "Force").is_none());
    harness.key_press(Key::P);
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Slider, "Force").is_some());
    // Only pressed: a release would be another frame with its own output.
    harness.key_down(Key::C);
    harness.step();
    let copied = harness.output().platform_output.commands.iter().find_map(|c| match c {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let text = copied.unwrap();
    assert!(text.starts_with("# Save as scene.toml, then: warpbeam solve scene.toml"), "{text}");
    // The copied scene gives the displayed result.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let json = solve_json(&[path.to_str().unwrap()]);
    assert_eq!(json["probes"][0]["u"][1].as_f64().unwrap(), tip(harness.state())[1]);
}

#[test]
fn scrolling_zooms_to_the_pointer_and_f_fits() {
    let mut harness = harness("article");
    // The view is also fitted to the outline of the reference solution.
    wait(&mut harness, "the truth", |lab| !lab.is_computing());
    harness.run();
    let rect = harness.state().view_rect();
    let pointer = rect.center() + egui::vec2(150.0, -80.0);
    let offset = [150.0, -80.0];
    let fitted = harness.state().camera();
    let under = fitted.to_world(offset);
    harness.hover_at(pointer);
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run();
    let zoomed = harness.state().camera();
    assert!(zoomed.scale > 1.2 * fitted.scale, "{zoomed:?}");
    assert!((zoomed.to_world(offset) - under).norm() < 1e-6);
    harness.drag_at(pointer);
    harness.step();
    harness.hover_at(pointer + egui::vec2(40.0, 25.0));
    harness.step();
    harness.drop_at(pointer + egui::vec2(40.0, 25.0));
    harness.run();
    let panned = harness.state().camera();
    assert!((panned.to_world([190.0, -55.0]) - under).norm() < 1e-2, "the body did not follow the pointer");
    harness.key_press(Key::F);
    harness.run();
    assert_eq!(harness.state().camera(), fitted);
}

/// At rest, no further frame is requested.
#[test]
fn at_rest_nothing_is_redrawn() {
    let mut harness = harness("article");
    wait(&mut harness, "the reference", |lab| !(lab.is_computing() || lab.is_following()));
    harness.run_steps(3);
    assert!(!harness.state().iterates());
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay > std::time::Duration::from_secs(3600), "{delay:?}");
}

/// The slider of a moving support drags the body. The window shows the reaction, and the slider still exists at 0.
#[test]
fn a_support_is_dragged_and_its_reaction_is_shown() {
    let crown = |lab: &Lab| lab.simulation().probe("crown").unwrap();
    let mut harness = harness("snap");
    type_into(&mut harness, "Move y", "-3 mm");
    assert_eq!(harness.state().scene().supports[2].displacement, [0.0, -0.003]);
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    unfold(&mut harness, "stable");
    assert!(harness.query_by_label("(0, -80.53) N").is_some());
    harness.get_by_label_contains("Details: ").click();
    harness.run_steps(8);
    harness.run();
    let slider = harness.get_by_role_and_label(Role::Slider, "Move y").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.hover_at(at(0.4));
    harness.drag_at(at(0.4));
    harness.run();
    harness.hover_at(at(0.3));
    harness.run();
    assert_eq!(harness.get_by_role_and_label(Role::Slider, "Move y").rect(), slider, "the slider moves away");
    harness.drop_at(at(0.3));
    harness.run();
    let lab = harness.state();
    let increment = lab.scene().supports[2].displacement[1];
    assert!((-0.012..-0.004).contains(&increment), "{increment}");
    assert!((crown(lab)[1] - increment).abs() < 1e-4, "{:?} {increment}", crown(lab));
    type_into(&mut harness, "Move y", "0");
    assert!(crown(harness.state())[1].abs() < 1e-9);
    type_into(&mut harness, "Move y", "-1 mm");
    assert!((crown(harness.state())[1] + 0.001).abs() < 1e-5);
    // Scenes with fixed supports have no such slider.
    let harness = harness_of("cantilever");
    assert!(harness.query_by_label("Move y").is_none());
}

/// The window shows for a result: certificate, for the warped iteration ρ with an explanation, the error relative to the
/// exact beam, and the load curve.
#[test]
fn results_are_certified_and_compared_with_the_reference() {
    let mut harness = harness("elastica");
    let json = solve_json(&["elastica"]);
    unfold(&mut harness, "stable");
    assert!(harness.query_by_label("stable").is_some());
    assert!(harness.query_by_label("ρ").is_none(), "newton does not iterate so");
    assert!((json["fixed_point_rho"].as_f64().unwrap() - 4.039).abs() < 1e-3);
    wait(&mut harness, "the truth", |lab| !lab.is_computing());
    harness.run();
    let error = json["probes"][0]["error_percent"].as_f64().unwrap();
    let shown = format!("{} ± ", percent(error));
    assert!(harness.query_by_label_contains(&shown).is_some(), "{shown}");
    let before = harness.state().view_rect();
    harness.key_press(Key::L);
    harness.run();
    assert!(harness.state().view_rect().height() < before.height() - 200.0, "no room for the load curve");
    type_into(&mut harness, "Moment", "500");
    assert!(harness.state().scene().loads.contains(&Load::moment("right", 500.0)));
    assert_eq!(*harness.state().simulation().status(), Status::Converged);
    pick(&mut harness, "Scene", "article");
    unfold(&mut harness, "stable");
    let rho = solve_json(&["article"])["fixed_point_rho"].as_f64().unwrap();
    assert!(harness.query_by_label_contains(&format!("multiplies a disturbance by ρ = {rho:.3}")).is_some());
}

#[test]
fn every_scene_and_element_can_be_chosen() {
    let mut harness = harness("article");
    for id in crate::common::ids_of(Analysis::Static) {
        pick(&mut harness, "Scene", id);
        assert_eq!(harness.state().scene().name, scene(id).name);
        assert_eq!(*harness.state().simulation().status(), Status::Converged, "{id}");
        for element in ["t3", "t6"] {
            pick(&mut harness, "Element", element);
            assert_eq!(harness.state().scene().element().id(), element, "{id}");
            assert_ne!(*harness.state().simulation().status(), Status::Running, "{id} {element}");
        }
    }
}

/// A pointer over the view does not stop the view from following the body.
#[test]
fn the_view_follows_the_body_under_a_resting_pointer() {
    let mut harness = harness("elastica");
    let rect = harness.state().view_rect();
    for step in 0..5 {
        harness.hover_at(rect.center() + egui::vec2(13.7 * step as f32, 31.3));
        harness.step();
    }
    let before = harness.state().camera();
    type_into(&mut harness, "Force", "30");
    harness.hover_at(rect.center());
    harness.run();
    let after = harness.state().camera();
    assert!(after.scale > 1.1 * before.scale, "{before:?} {after:?}");
}

fn measured(lab: &Lab) -> usize {
    lab.study().0.map_or(0, |s| s.measurements.len())
}

/// The study runs in the background: results appear while the panel stays usable, and it can be cancelled. Measurements
/// taken so far are kept and can be applied with a click.
#[test]
fn the_study_runs_in_the_background_and_its_best_setting_is_applied() {
    let mut harness = harness("cantilever");
    harness.key_press(Key::B);
    harness.run();
    assert!(harness.query_by_label_contains("Not measured yet").is_some());
    assert!(harness.get_by_label("Apply the fastest").accesskit_node().is_disabled());
    harness.get_by_label("Measure").click();
    harness.step();
    harness.step();
    assert!(harness.state().study().1, "no study runs");
    wait(&mut harness, "a first mesh", |lab| measured(lab) > 0);
    // Meanwhile the body follows its sliders.
    let before = force(harness.state());
    let slider = harness.get_by_role_and_label(Role::Slider, "Force").rect();
    let at = |share: f32| egui::pos2(slider.left() + share * slider.width(), slider.center().y);
    harness.hover_at(at(0.4));
    harness.drag_at(at(0.4));
    harness.step();
    harness.hover_at(at(0.45));
    harness.step();
    wait(&mut harness, "the body at rest", |lab| !lab.iterates());
    harness.drop_at(at(0.45));
    harness.step();
    assert_ne!(force(harness.state()), before);
    assert!(harness.state().study().1, "the study stopped");
    wait(&mut harness, "six-node meshes", |lab| {
        lab.study().0.is_some_and(|s| s.measurements.iter().any(|m| m.error.bound() < 5.0)) || !lab.study().1
    });
    harness.get_by_label("Cancel").click();
    wait(&mut harness, "the cancelled study to end", |lab| !lab.study().1);
    harness.run();
    let study = harness.state().study().0.unwrap().clone();
    // A study of another load has no setting for this one.
    assert!(harness.query_by_label_contains("The body or its load has changed since").is_some());
    type_into(&mut harness, "Error ≤", "5");
    type_into(&mut harness, "Time ≤", "1e5");
    assert!(harness.get_by_label("Apply the fastest").accesskit_node().is_disabled());
    let is_offered_in_compare = |harness: &mut Harness<'_, Lab>| {
        harness.key_press(Key::K);
        harness.run_steps(2);
        let is_disabled = harness.get_by_label("current | budget").accesskit_node().is_disabled();
        harness.key_press(Key::B);
        harness.run_steps(2);
        !is_disabled
    };
    assert!(!is_offered_in_compare(&mut harness), "Compare offers the setting of another load");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::Z);
    harness.run();
    assert_eq!(force(harness.state()), before);
    assert!(harness.query_by_label_contains("The body or its load has changed since").is_none());
    assert!(is_offered_in_compare(&mut harness));

    let demand = Demand { max_error_percent: Some(5.0), max_time_ms: Some(1e5) };
    let meeting = study.ranking().meeting(demand);
    assert!(!meeting.is_empty() && meeting.len() < study.measurements.len());
    let words = format!("{} of {} settings meet both", meeting.len(), study.measurements.len());
    assert!(harness.query_by_label(&words).is_some(), "{words}");
    harness.get_by_label("Apply the fastest").click();
    harness.run();
    let best = meeting[0].setting;
    let lab = harness.state();
    assert_eq!(lab.scene().element(), best.element);
    assert_eq!(lab.scene().beam.as_ref().map(|b| b.cells), best.cells);
    assert_eq!(lab.scene().solver.method, best.method);
    // The scene stops after as many iterations as the measurement, and so does a copy of it.
    let accepts = if meeting[0].converged { 0 } else { best.iterations };
    assert_eq!(lab.scene().solver.accept_after, accepts);
    assert!(lab.simulation().iterations() <= best.iterations, "{best}: {} iterations", lab.simulation().iterations());
    assert!(meeting.iter().all(|m| m.time.total() >= meeting[0].time.total()));

    // The list scrolls to a setting that is applied elsewhere.
    type_into(&mut harness, "Error ≤", "1000");
    let wheel = |harness: &mut Harness<'_, Lab>, delta: f32| {
        harness.hover_at(harness.get_by_label_contains(" settings meet both").rect().center() + egui::vec2(0.0, 40.0));
        let delta = egui::vec2(0.0, delta);
        let (unit, phase, source) =
            (egui::MouseWheelUnit::Point, egui::TouchPhase::Move, egui::MouseWheelSource::Wheel);
        harness.event(egui::Event::MouseWheel { unit, delta, phase, source, modifiers: Modifiers::NONE });
        harness.run();
    };
    let listed = |harness: &Harness<'_, Lab>| -> Vec<String> {
        let rows = harness.query_all_by_role(Role::Button).filter_map(|row| row.accesskit_node().label());
        rows.filter(|label| label.contains('≤')).collect()
    };
    wheel(&mut harness, -1e5);
    let last = listed(&harness).pop().unwrap();
    harness.get_by_label(&last).click();
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    wheel(&mut harness, 1e5);
    assert!(!listed(&harness).contains(&last), "the list is shorter than its area");
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.run();
    assert!(listed(&harness).contains(&last), "{last} was applied, and {:?} are shown", listed(&harness));

    // A click on a setting in the plot applies it.
    let is_setting = |lab: &Lab| {
        let of = |m: &&warpbeam::study::Measurement| m.is_applied_to(lab.scene());
        lab.study().0.is_some_and(|study| study.measurements.iter().any(|m| of(&m)))
    };
    let applied = harness.state().scene().clone();
    let right = harness.get_by_label("Panel").rect().left() - 320.0;
    let under = |harness: &mut Harness<'_, Lab>, at: egui::Pos2| {
        harness.hover_at(at);
        harness.step();
        harness.output().platform_output.cursor_icon == egui::CursorIcon::PointingHand
    };
    let mut places =
        (0..60).flat_map(|i| (0..30).map(move |j| egui::pos2(right - 6.0 * i as f32, 560.0 + 6.0 * j as f32)));
    let is_applied = places.any(|at| {
        if under(&mut harness, at) {
            click(&mut harness, at);
            harness.run();
        }
        *harness.state().scene() != applied
    });
    assert!(is_applied && is_setting(harness.state()), "{:?}", harness.state().scene().solver);
    // Another scene starts another study.
    pick(&mut harness, "Scene", "bridge");
    assert!(harness.state().study().0.is_none());
}

/// The decisions of `auto` are shown in every frame.
#[test]
fn decisions_are_shown() {
    let mut harness = harness("elastica");
    pick(&mut harness, "Method", "auto");
    unfold(&mut harness, "stable");
    assert!(harness.query_by_label("New factorization.").is_some());
    type_into(&mut harness, "Force", "0.1");
    // From the state under the large load it iterates; from the next one it uses linear theory.
    type_into(&mut harness, "Force", "0.09");
    assert!(harness.query_by_label("Linear theory suffices.").is_some());
    // A density without gravity changes no load.
    type_into(&mut harness, "Density", "1234");
    assert!(harness.query_by_label("Nothing changed: no solve.").is_some());
    assert_eq!(harness.state().simulation().iterations(), 0);
}

/// The window's fonts have every letter of its texts.
#[test]
fn the_fonts_have_every_letter_of_the_texts() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut texts = Vec::new();
    for folder in ["app", "method", "element", "model", "scene", "simulation"] {
        for file in crate::common::files::rust_files(&root.join("src").join(folder)) {
            let text = std::fs::read_to_string(file).unwrap();
            texts.extend(text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned()));
        }
    }
    let about = crate::common::scene_ids().into_iter().map(|id| scene(id).about);
    texts.extend(about);
    texts.push("\u{2013}\u{201c}\u{201d}\u{2212}".to_owned());
    let letters: std::collections::BTreeSet<char> =
        texts.iter().flat_map(|t| t.chars()).filter(|c| !c.is_ascii()).collect();
    assert!(letters.contains(&'≤') && letters.contains(&'ρ'));
    let harness = harness("article");
    let lacks = |font: egui::FontId| -> Vec<char> {
        harness.ctx.fonts_mut(|fonts| letters.iter().copied().filter(|&c| !fonts.has_glyph(&font, c)).collect())
    };
    assert_eq!(lacks(egui::FontId::proportional(14.0)), Vec::<char>::new());
    assert_eq!(lacks(egui::FontId::monospace(14.0)), Vec::<char>::new());
}

/// Returns every text in the window.
fn texts(harness: &Harness<'_, Lab>) -> Vec<String> {
    let labels = harness.get_all_by(|_| true).map(|node| node.accesskit_node());
    labels.flat_map(|node| [node.label(), node.value()]).flatten().collect()
}

/// A beam at rest that is pressed and pulled settles in equilibrium with the mouse spring; after release, it
/// returns to its previous state.
#[test]
fn a_beam_is_pulled_and_springs_back() {
    let mut harness = harness("article");
    let before = harness.state().simulation().displacement().to_vec();
    let camera = harness.state().camera();
    let grip = on_body(harness.state(), Vector2::new(4.9, 0.1));
    harness.drag_at(grip);
    harness.run();
    for near in [egui::Vec2::ZERO, egui::vec2(2.0, -2.0)] {
        harness.hover_at(grip + near);
        harness.run();
        assert!(harness.state().simulation().mouse_spring().is_none(), "a press is no drag");
    }
    let pointer = grip + egui::vec2(30.0, -160.0);
    harness.hover_at(pointer);
    harness.run();
    let lab = harness.state();
    let (simulation, rect) = (lab.simulation(), lab.view_rect());
    assert_eq!(*simulation.status(), Status::Converged);
    let (spring, force) = simulation.mouse_spring().unwrap();
    let held = spring.position(simulation.displacement());
    let place = lab.camera().to_world([pointer.x - rect.center().x, pointer.y - rect.center().y].map(f64::from));
    assert!((spring.target() - place).norm() < 1e-6, "the hand is at {}, the pointer at {place}", spring.target());
    // The spring is stiff, so that the point is near the pointer, and its force is its stretch times its stiffness.
    assert!((held - place).norm() < 0.1 * (place - Vector2::new(4.9, 0.1)).norm(), "{held} is pulled to {place}");
    assert!((force - (place - held) * spring.stiffness()).norm() < 1e-9 * force.norm());
    assert_eq!(lab.camera(), camera, "the view moved with the body");
    harness.drop_at(pointer);
    harness.run();
    let simulation = harness.state().simulation();
    assert!(simulation.mouse_spring().is_none());
    assert_eq!(*simulation.status(), Status::Converged);
    assert_eq!(simulation.displacement(), before);
}

/// A motion runs in real time, can be paused and stepped, pulled and released, and is reset to its start or to a mark.
#[test]
fn a_motion_is_run_paused_stepped_pulled_and_reset() {
    let mut harness = harness_of("swing");
    let time = |harness: &Harness<'_, Lab>| harness.state().simulation().state().time();
    wait(&mut harness, "half a second of motion", |lab| lab.simulation().state().time() > 0.5);
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    let paused = time(&harness);
    harness.run_steps(3);
    assert!((time(&harness) - paused).abs() < 1e-12, "it is paused");
    harness.get_by_label("Step").click();
    harness.run_steps(2);
    assert!((time(&harness) - paused - 1.0 / 60.0).abs() < 1e-9, "one step is one time step");
    harness.get_by_label("Run").click();
    wait(&mut harness, "the motion to go on", |lab| lab.simulation().state().time() > paused + 0.3);
    // Pulled at the tip while the motion runs, the mouse spring does work.
    let grip = on_body(harness.state(), Vector2::new(0.98, 0.0));
    harness.drag_at(grip);
    harness.run_steps(2);
    harness.hover_at(grip + egui::vec2(60.0, -80.0));
    harness.run_steps(4);
    let force = harness.state().simulation().mouse_spring().expect("the tip is held").1;
    assert!(force.norm() > 0.0);
    harness.drop_at(grip + egui::vec2(60.0, -80.0));
    harness.run_steps(2);
    assert!(harness.state().simulation().mouse_spring().is_none());
    let ledger = *harness.state().simulation().motion().unwrap().ledger();
    assert!(ledger.mouse_spring != 0.0 && ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{ledger:?}");
    harness.get_by_label("Pause").click();
    harness.get_by_label("Reset").click();
    harness.run_steps(2);
    assert!(time(&harness) == 0.0, "at the start");
}

/// The panel of every dynamic scene works with every integrator and every plot, and shows finite values only.
#[test]
fn every_motion_is_shown_with_every_integrator_and_plot() {
    for id in crate::common::ids_of(Analysis::Dynamic) {
        let mut harness = harness_of(id);
        harness.key_press(Key::E);
        harness.run_steps(2);
        let plots = ["Energy", "Tip"].into_iter().cycle();
        for (integrator, plot) in IntegratorKind::all().map(IntegratorKind::entry).zip(plots) {
            let mut scene = harness.state().scene().clone();
            scene.dynamics.integrator = integrator.kind;
            harness.state_mut().set_scene(scene).unwrap();
            // The other integrators are shown beside the first one, and hidden again.
            if plot == "Tip" {
                IntegratorKind::all().for_each(|other| harness.state_mut().compare_with(other));
            }
            harness.get_by_role_and_label(Role::Button, plot).click();
            harness.run_steps(2);
            assert!(harness.state().simulation().state().is_finite(), "{id} {}", integrator.id);
            let said = texts(&harness);
            assert!(said.iter().all(|t| !t.contains("NaN") && !t.contains("inf")), "{id} {}: {said:?}", integrator.id);
        }
    }
}

/// An integrator that becomes unstable leaves the comparison and the plots with a message; the others continue.
#[test]
fn an_unstable_integrator_leaves_the_comparison() {
    let mut harness = harness_of("swing");
    harness.state_mut().compare_with(IntegratorKind::SymplecticEuler);
    harness.state_mut().compare_with(IntegratorKind::EnergyMomentum);
    let words = "symplectic-euler is unstable: its critical time step is";
    let mut steps = 0;
    while harness.query_all_by_label_contains(words).next().is_none() {
        harness.step();
        steps += 1;
        assert!(steps < 2000, "nothing is said of it");
    }
    assert!(!matches!(harness.state().simulation().status(), Status::Stopped(_)));
}

/// Budget measures motions too: the time of a displayed frame against the error of the path. A click applies a setting.
#[test]
fn a_motions_settings_are_measured_and_applied() {
    // The motion is shortened for the test.
    let mut harness = harness_with("swing", scene_with("swing", &["dynamics.duration=0.1"]));
    harness.key_press(Key::Space);
    harness.key_press(Key::B);
    harness.run_steps(4);
    harness.get_by_label("Measure").click();
    harness.step();
    harness.step();
    wait(&mut harness, "the study of the motion", |lab| !lab.study().1);
    let study = harness.state().motion_study().unwrap().clone();
    assert!(!study.is_partial && study.measurements.len() > 20);
    type_into(&mut harness, "Error ≤", "20");
    type_into(&mut harness, "Time ≤", "100");
    harness.run_steps(4);
    let is_met = |m: &&MotionMeasurement| study.ranking().error_bound(m) <= 20.0 && m.milliseconds / 60.0 <= 100.0;
    let meeting: Vec<_> = study.measurements.iter().filter(is_met).collect();
    let all = study.measurements.iter().filter(|m| m.error.is_some()).count();
    harness.get_by_label(&format!("{} of {all} settings meet both", meeting.len()));
    let best = meeting.iter().min_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds)).unwrap().setting;
    harness.get_by_label("Apply the fastest").click();
    harness.step();
    assert_eq!(MotionSetting::of(harness.state().scene()), best);
    assert_eq!(harness.state().scene().analysis, Analysis::Dynamic);
    // A cancelled study keeps the measurements that it has, or none.
    harness.get_by_label("Measure").click();
    harness.step();
    harness.step();
    harness.get_by_label("Cancel").click();
    wait(&mut harness, "the end of a cancelled study", |lab| !lab.study().1);
    assert!(harness.state().motion_study().is_none_or(|study| study.is_partial));
}

/// Motions are compared in panes with one clock. Each integrator has its characteristic energy drift. A pane can use
/// another element, after which all motions restart.
#[test]
fn integrators_are_compared_in_panes() {
    // A coarse mesh keeps a busy machine near real time.
    let mut harness = harness_with("swing", scene_with("swing", &["beam.cells=[6,1]"]));
    harness.key_press(Key::K);
    harness.run_steps(4);
    let times = |lab: &Lab| -> Vec<f64> {
        lab.motion_panes().iter().map(|pane| pane.simulation().unwrap().state().time()).collect()
    };
    assert_eq!(harness.state().motion_panes().len(), 3);
    let before = harness.state().simulation().state().time();
    wait(&mut harness, "a second of motion", |lab| times(lab).iter().all(|t| *t > 1.0));
    let all = times(harness.state());
    assert!(all.iter().all(|t| (t - all[0]).abs() < 1e-9), "one clock: {all:?}");
    // The motions wait while their times are measured.
    assert!(harness.state().motion_panes().iter().all(|pane| pane.frame_seconds().is_some_and(|time| time > 0.0)));
    let drift = |lab: &Lab, kind: IntegratorKind| {
        let pane = lab.motion_panes().iter().find(|pane| pane.setting().integrator == Some(kind)).unwrap();
        let motion = pane.simulation().unwrap().motion().unwrap();
        motion.ledger().drift()
    };
    let kept = drift(harness.state(), IntegratorKind::EnergyMomentum);
    let lost = drift(harness.state(), IntegratorKind::ImplicitEuler);
    assert!(kept.abs() < 1e-3 && lost < -0.02, "{kept} {lost}");
    // The key Space pauses all motions.
    harness.key_press(Key::Space);
    harness.run_steps(3);
    let paused = times(harness.state());
    harness.run_steps(3);
    assert_eq!(times(harness.state()), paused);
    harness.get_by_role_and_label(Role::Button, "t3 | t6 | q4").click();
    harness.run_steps(4);
    let elements: Vec<_> = harness.state().motion_panes().iter().map(|p| p.setting().element).collect();
    assert_eq!(elements.len(), 3);
    assert!(times(harness.state()).iter().all(|t| *t == 0.0), "another mesh starts over");
    let explored = harness.state().simulation().state().time();
    assert!((explored - before).abs() < 1e-12, "the body of Explore waits");
}

/// While the reference solution is computed, the error field says so and shows the progress.
#[test]
fn the_error_shows_that_the_reference_is_being_computed() {
    let mut harness = harness_of("cook");
    let says = |harness: &Harness<'_, Lab>| harness.query_by_label_contains("computing the reference: ").is_some();
    let mut frames = 0;
    while !says(&harness) {
        frames += 1;
        assert!(frames < 400, "it is never said");
        harness.step();
    }
    wait(&mut harness, "the reference solution", |lab| !lab.is_computing());
    harness.run();
    assert!(!says(&harness));
}

/// A straight column above its buckling load has no error, in the window as in `solve`: its equilibrium is unstable.
#[test]
fn an_unstable_equilibrium_has_no_error() {
    let mut harness = harness("column");
    let set = ["load.0.force=[-520,0]", "solver.method=\"newton\""];
    harness.state_mut().set_scene(crate::common::scene_with("column", &set)).unwrap();
    harness.run();
    harness.state_mut().solve();
    harness.run();
    assert!(harness.query_by_label_contains("ERROR \u{2013} no reference").is_some(), "{:?}", texts(&harness));
}
