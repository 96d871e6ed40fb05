//! Tests of the panel, operated by labels, pointer and keys, without a display or a GPU.

use crate::common::lab::*;
use crate::ui_interaction::is_solved;

fn open(id: &str) -> Ui {
    let mut ui = window_of(id, scene(id));
    ui.run();
    ui
}

#[test]
fn dragging_the_force_slider_bends_the_beam_as_solve_does() {
    let mut ui = open("cantilever");
    let tip = |ui: &Ui| ui.simulation().solution().probes[0].u;
    let places = |ui: &Ui| [ui.rect(Role::Slider, "Force"), ui.get_by_label_contains("Material: ").rect()];
    let (before, laid_out, at) = ((ui.force(), tip(&ui)), places(&ui), ui.slider("Force"));
    // However fast the machine is, the beam still moves after a frame.
    ui.state_mut().desk.session.frame.limit = std::time::Duration::ZERO;
    ui.hold(at(0.4));
    ui.run();
    ui.move_to(at(0.46));
    assert!(ui.state().iterates(), "the beam did not start to move");
    assert_eq!(places(&ui), laid_out, "the layout changes while the beam moves");
    ui.run();
    ui.release(at(0.46));
    let [fx, fy] = ui.force();
    assert!(fx == 0.0 && [fx, fy] != before.0 && (tip(&ui).y - before.1.y).abs() > 1e-3, "{fx} {fy}");
    is_solved(&ui, &["cantilever", "--set", &format!("load.0.force=[{fx},{fy}]")]);
}

#[test]
fn typed_values_take_effect_also_beyond_the_slider() {
    let mut ui = open("cantilever");
    for (fields, force) in [
        (&[("Force", "3k")][..], [0.0, -3000.0]),
        (&[("Force", "0.5 kN")], [0.0, -500.0]),
        (&[("Direction", "270")], [0.0, -500.0]),
        (&[("Direction", "0")], [500.0, 0.0]),
        (&[("Force", "0 N"), ("Direction", "90"), ("Force", "2e7 N")], [0.0, 2e7]),
    ] {
        ui.type_all(fields);
        let off = Vector2::from(ui.force()) - Vector2::from(force);
        assert!(off.norm() < 1e-9, "{fields:?}: {off}");
    }
    ui.type_into("Gravity", "9.81");
    ui.type_into("Moment", "500 N m");
    assert_eq!(ui.scene().loads[1..], [Load::gravity([0.0, -9.81]), Load::moment("right", 500.0)]);
    ui.type_all(&[("Young E", "2 MPa"), ("Poisson ν", "0.45"), ("Density", "1200"), ("Thickness t", "0.2")]);
    let m = ui.scene().material;
    assert_eq!((m.young, m.poisson, m.density, m.thickness), (2e6, 0.45, 1200.0, 0.2));
    ui.type_all(&[("Cells along", "40"), ("Cells across", "3")]);
    assert_eq!(ui.scene().beam.as_ref().unwrap().cells, [40, 3]);
    assert_eq!(ui.simulation().system().mesh().element_count(), 240);
    // A part in other units keeps its number of cells, and a coordinate its digits.
    ui.type_all(&[("Length", "6 in"), ("Height", "0.5 in")]);
    let beam = ui.scene().beam.clone().unwrap();
    assert_eq!((beam.length, beam.height, beam.cells), (0.1524, 0.0127, [40, 3]));
}

/// The message has the expected range. The value is neither clamped nor accepted.
#[test]
fn values_out_of_range_are_refused_with_a_message() {
    let cases = [
        ("Force", "1e16 N", "expected -1e15 to 1e15 N, got 1e16"),
        ("Force", "lots", "got \u{201c}lots\u{201d}"),
        ("Force", "0,5", "is not a number: numbers look like"),
        ("Force", "30,000 N", "can be read in two ways: write 30000"),
        ("Force", "12 Pa", "is a pressure (Pa); expected a force (N)"),
        ("Direction", "400", "expected -360 to 360 °, got 400"),
        ("Gravity", "1e9 m/s²", "m/s², got 1e9"),
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
    let mut ui = open("cantilever");
    for (label, text, message) in cases {
        unfold(&mut ui, label);
        let before = ui.scene().clone();
        assert!(!ui.says(message));
        ui.type_into(label, text);
        assert_eq!(*ui.scene(), before, "{label} {text}");
        let below = ui.get_by_label_contains(message).rect().top() - ui.rect(Role::SpinButton, label).bottom();
        assert!((-1.0..48.0).contains(&below), "{label}: not next to the field");
        ui.type_into(label, if label.starts_with("Cells") { "4" } else { "0.25" });
        assert!(!ui.says(message), "{label}: the message stays");
        ui.undo();
    }
    // So does the present value. A value that the scene refuses keeps its message, whatever was refused before.
    ui.type_all(&[("Force", "12 Pa"), ("Force", "1 kN")]);
    assert!(!ui.says("is a pressure"), "the message stays");
    ui.type_all(&["lots", "4", "90000"].map(|text| ("Cells across", text)));
    ui.expect(&["cells in all"]);
}

/// A refused text stays in its field; Escape restores the value.
#[test]
fn a_refused_text_stays_for_correction() {
    let mut ui = open("cantilever");
    let (before, below) = (ui.force(), ui.rect(Role::SpinButton, "Direction"));
    for refused in ["12 kg", "1e16"] {
        ui.type_into("Force", refused);
        assert!(ui.field("Force") == refused && ui.says("expected"), "{refused}");
        assert_eq!(ui.rect(Role::SpinButton, "Direction"), below, "a refused value moves nothing");
        ui.event(Event::Text(" ".to_owned()));
        ui.key(Key::Space);
        assert_eq!(ui.field("Force"), format!("{refused} "));
        ui.key(Key::Escape);
        assert!(!ui.says("expected"), "{refused}: the message stays");
        assert_eq!(ui.force(), before);
    }
    ui.enter("Force");
    ui.replace_text("7 kN");
    ui.key(Key::Escape);
    assert_eq!(ui.force(), before);
    ui.type_all(&[("Force", "12 N"), ("Force", "12 kg")]);
    ui.key_press(Key::Backspace);
    ui.key_press(Key::Backspace);
    ui.text("kN");
    ui.key(Key::Enter);
    assert!((ui.force()[1] + 12e3).abs() < 1e-6, "{:?}", ui.force());
    // Undo in the field ends at the text that the edit begins with.
    ui.type_into("Force", "4 kN");
    ui.enter("Force");
    for _ in 0..3 {
        ui.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        ui.step();
    }
    assert_eq!(ui.field("Force"), "4 kN");
    ui.type_into("Force", "12 kg");
    let pos = ui.state().view_rect().left_center() + vec2(8.0, 0.0);
    ui.hover_at(pos);
    for pressed in [true, false, true, false] {
        assert!(ui.says("expected"), "{pressed}");
        ui.event(primary(pos, pressed));
        ui.run();
    }
    assert!(!ui.says("expected") && (ui.force()[1] + 4e3).abs() < 1e-6);
    // A negative force is one in the opposite direction.
    ui.type_into("Force", "-5 N");
    assert_eq!(ui.force(), [0.0, 5.0]);
}

#[test]
fn every_number_has_a_unit_and_a_tooltip() {
    let mut ui = open("article");
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
        unfold(&mut ui, label);
        assert!(ui.field(label).contains(unit), "{label}: {}", ui.field(label));
        ui.hover_at(ui.rect(Role::Slider, label).center());
        ui.run_steps(60);
        ui.expect(&[tip]);
    }
}

#[test]
fn run_pause_step_and_reset() {
    let mut ui = open("article");
    assert_eq!(*ui.simulation().status(), Status::Converged);
    let iterations = |ui: &Ui| ui.simulation().iterations();
    let (converged, tip) = (iterations(&ui), |ui: &Ui| ui.simulation().solution().probes[0].u);
    assert!(ui.query_by_label("Pause").is_none() && ui.get_by_label("Run").accesskit_node().is_disabled());
    ui.key(Key::Space);
    assert!(!ui.says("Paused"));
    // Another step starts again at rest. The first warped iteration is the linear solution.
    ui.click("Step");
    assert_eq!(iterations(&ui), 1);
    ui.get_by_label(&format!("Paused \u{b7} 1 iteration \u{b7} residual {:.1e}", ui.simulation().residual()));
    assert!(!ui.says("not reached"), "an iterate that was asked for is not grey");
    assert!((tip(&ui).y - solve_u(&["article", "--set", "solver.method=linear"]).y).abs() < 1e-9);
    ui.key(Key::N);
    assert_eq!(iterations(&ui), 2);
    ui.click("Reset");
    assert_eq!((iterations(&ui), tip(&ui)), (0, Vector2::zeros()));
    ui.click("Run");
    assert_eq!(iterations(&ui), converged);
    // An edit goes on to the equilibrium. Space on a focused button is the button's.
    ui.click("Step");
    ui.type_into("Force", "20 kN");
    assert_eq!(*ui.simulation().status(), Status::Converged);
    ui.click("Step");
    ui.get_by_label("Help").focus();
    ui.run();
    ui.key(Key::Space);
    assert!(ui.says("Run or pause") && iterations(&ui) == 1, "the list of keys opens, and nothing runs");
}

/// Text typed into a number field goes to the field, even if it is completed within one frame.
#[test]
fn keys_that_end_a_text_edit_do_not_act_on_the_window() {
    let mut ui = open("article");
    let converged = ui.simulation().iterations();
    ui.enter("Force");
    let key = |key, text: &str| [key_event(key, true), Event::Text(text.to_owned())];
    // Outside the field, Space pauses and N steps.
    let typed = [key(Key::Num3, "30"), key(Key::Space, " "), key(Key::N, "kN")].into_iter().flatten();
    let [enter, _] = key(Key::Enter, "");
    ui.key_press_modifiers(Modifiers::COMMAND, Key::A);
    ui.step();
    ui.input_mut().events.extend(typed.chain([enter]));
    ui.run();
    assert_eq!(ui.force(), [0.0, -30_000.0]);
    assert_eq!(ui.simulation().iterations(), converged, "a key has stepped or reset the beam");
    assert!(!ui.says("Paused"));
}

/// The ends accept any value, including negative ones. The scale does not move while an end is dragged.
#[test]
fn a_fixed_range_of_colours_is_set() {
    let mut ui = open("article");
    ui.state_mut().desk.view.color_with(Field::RotationAngle);
    ui.fold("View: ");
    ui.click("Fixed colour range");
    ui.type_into("Lowest", "-200");
    assert!(!ui.says("expected"), "{:?}", ui.texts());
    let ends = |ui: &Ui| ["Lowest", "Highest"].map(|end| ui.field(end));
    let (before, range) = (ends(&ui), ui.state().frame().range);
    assert!(range[0] == -range[1] && range[1] > 0.0, "the middle colour of a field with a sign is 0: {range:?}");
    ui.type_into("Highest", "-100 MPa");
    ui.key(Key::Escape);
    assert_eq!(ends(&ui), before, "a refused value is shown");
    let at = ui.slider("Highest");
    ui.hold(at(0.7));
    ui.run();
    let first = ends(&ui);
    [0.9, 0.98, 0.7].into_iter().for_each(|share| ui.hover(at(share)));
    ui.release(at(0.7));
    assert_eq!(ends(&ui), first, "the scale has moved under the pointer");
}

/// An arrow key changes the value of a slider by one hundredth.
#[test]
fn arrow_keys_step_a_slider_finely() {
    let mut ui = open("article");
    ui.focus(Role::Slider, "Force");
    ui.key(Key::ArrowRight);
    assert_eq!(ui.force(), [0.0, -30_300.0]);
    ui.focus(Role::Slider, "Direction");
    ui.key(Key::ArrowLeft);
    let [fx, fy] = ui.force();
    assert!((fy.atan2(fx).to_degrees() + 91.0).abs() < 1e-9, "{fx} {fy}");
}

/// An inaccurate result gives the reason, too.
#[test]
fn remedies_are_one_click_away() {
    let mut ui = open("article");
    settle(&mut ui);
    let error = percent(solve_error(&["article"]));
    ui.get_by_label(&format!("ERROR {error} mesh · nodal strain 56 %"));
    ui.get_by_label(&format!("{error} error: three-node triangles lock in bending."));
    ui.click("Try t6 with newton");
    assert_eq!(ui.scene().element().id(), "t6");
    settle(&mut ui);
    assert_eq!(*ui.simulation().status(), Status::Converged);
    ui.get_by_label("ERROR 1.5 % nodal strain 48 %");
    assert!(!ui.says("lock in bending"));

    let mut ui = open("cantilever");
    ui.type_into("Force", "9000 N");
    assert!(matches!(ui.simulation().status(), Status::Diverged(_)));
    ui.wait_until("the reason", |ui| ui.says("Does not converge: \u{3c1} = 4.5 > 1"));
    assert!(!ui.says("Diverged"), "one message has the remedy");
    ui.click("explain");
    ui.expect(&["Diverged: the residual has not fallen", "not reached"]);
    ui.click("Use newton");
    assert_eq!((ui.scene().solver.method, ui.simulation().status()), (MethodKind::Newton, &Status::Converged));

    // The slot of the error has the progress of the reference solution.
    let mut ui = window_of("cook", scene("cook"));
    ui.wait_until("it is said", |ui| ui.says("computing the reference: "));
    settle(&mut ui);
    assert!(!ui.says("computing the reference: "));
    ui.expect(&["error of linear theory"]);
}

/// An outline whose error is unknown is not drawn as a reference.
#[test]
fn the_window_says_which_force_is_moved_and_which_error_is_unknown() {
    let mut ui = window_of("article", scene("article").force([2.5, 0.0], [0.0, -20e3]));
    ui.run();
    ui.expect(&["Load 2 at (2.5, 0) m acts on the nearest node, 707.1 mm away"]);

    // The displacement under a point load grows without limit on finer meshes.
    let place = [1.5, -0.5];
    let scene = Scene::beam(5.0, 1.0).with_cells(10, 2).with_element(ElementKind::Q4).clamp("left");
    let scene = scene.force(place, [60e3, 0.0]).probe("there", place).with_method(MethodKind::Newton);
    let reference = Reference::of(&scene).unwrap();
    assert_eq!((reference.first(), reference.outline(1.0).len()), (None, 0));
    let mut ui = window_of("article", scene);
    settle(&mut ui);
    ui.expect(&["no reference · nodal strain 21 %"]);

    // The equilibrium of a straight column above its buckling load is unstable, and has no error either.
    let set = ["load.0.force=[-520,0]", "solver.method=\"newton\""];
    let ui = open_solved("column", scene_with("column", &set));
    ui.expect(&["ERROR \u{2013} no reference"]);
}

/// The window explains a bar that converges with ρ above one, and a body that is inside out although its equations are
/// solved.
#[test]
fn odd_results_are_explained() {
    let mut ui = open("article");
    ui.click("explain");
    ui.expect(&["The forces balance", "Stable: after a small push"]);
    pick(&mut ui, "Scene", "stretch");
    assert!(!ui.says("The forces balance"), "it explains the scene before");
    ui.get_by_label("explain").click();
    ui.type_into("Force", "500 kN");
    assert_eq!(*ui.simulation().status(), Status::Converged);
    let rho = ui.simulation().equilibrium().unwrap().certificate().and_then(|c| c.fixed_point_rho);
    assert!(rho.is_some_and(|rho| rho > 1.0), "{rho:?}");
    ui.expect(&["it converged because"]);
    let mut ui = open("cantilever");
    ui.edit(|scene| *scene = scene.clone().with_element(ElementKind::T3).with_cells(80, 8));
    assert!(!ui.says("inverted elements"));
    pick(&mut ui, "Method", "linear");
    ui.type_into("Force", "1e13 N");
    assert_eq!(*ui.simulation().status(), Status::Converged);
    ui.expect(&["inverted elements"]);
    ui.click("explain");
    ui.expect(&["no real body can have"]);
}

#[test]
fn presets_set_the_material_and_the_collapsed_header_names_it() {
    let mut ui = open("article");
    ui.get_by_label("Material: rubber, 1 MPa");
    unfold(&mut ui, "Young E");
    ui.click("Steel");
    let m = ui.scene().material;
    assert_eq!((m.young, m.poisson, m.density, m.thickness), (2.1e11, 0.3, 7850.0, 1.0));
    ui.get_by_label("Material: steel, 210 GPa");
    ui.click("strain");
    assert_eq!(ui.scene().material.plane, Plane::Strain);
}

/// Asserts that every control has a name and is within the width of the window.
pub fn controls_are_inside(ui: &Ui) {
    let window = ui.ctx.content_rect();
    let controls = [Role::Button, Role::ComboBox, Role::Slider, Role::SpinButton, Role::CheckBox];
    for node in ui.get_all_by(|node| controls.contains(&node.role())) {
        let (rect, label) = (node.rect(), node.accesskit_node().label());
        assert!(label.as_ref().is_some_and(|label| !label.is_empty()), "{window}: no name at {rect:?}");
        assert!(rect.left() >= 0.0 && rect.right() <= window.right(), "{window}: {label:?} at {rect:?}");
    }
}

#[test]
fn keys_are_listed_and_work() {
    let mut ui = open("article");
    ui.key(Key::F1);
    ui.expect(&["Run or pause", "Save a screenshot", "Copy the scene as TOML", "Zoom at the pointer"]);
    ui.expect(&["the previous or next card"]);
    ui.key(Key::Escape);
    assert!(!ui.says("Run or pause"));
    for is_shown in [false, true] {
        ui.key(Key::P);
        assert_eq!(ui.has(Role::Slider, "Force"), is_shown);
    }
    ui.set_size([640.0, 480.0].into());
    ui.run_steps(40);
    ui.key(Key::F1);
    ui.run_steps(10);
    for text in FOCUS_KEYS.iter().chain(MOUSE).flat_map(|(gesture, does)| [gesture, does]) {
        let rect = ui.get_all_by_label(text).last().unwrap().rect();
        assert!(rect.left() >= 0.0 && rect.right() <= 640.0, "{text} at {rect}");
    }
    ui.key(Key::Escape);
    // Only pressed: a release would be another frame with its own output.
    ui.key_down(Key::C);
    ui.step();
    let [egui::OutputCommand::CopyText(text)] = &ui.output().platform_output.commands[..] else { panic!("no text") };
    assert!(text.starts_with("# Save as scene.toml, then: warpbeam solve scene.toml"), "{text}");
    let path = tempfile::NamedTempFile::with_suffix(".toml").unwrap();
    std::fs::write(&path, text).unwrap();
    assert_eq!(solve_u(&[path.path().to_str().unwrap()]).y, ui.simulation().solution().probes[0].u.y);
}

#[test]
fn scrolling_zooms_to_the_pointer_and_f_fits() {
    let mut ui = open("article");
    // The view is also fitted to the outline of the reference solution.
    settle(&mut ui);
    let pointer = ui.state().view_rect().center() + vec2(150.0, -80.0);
    let (fitted, offset) = (ui.camera(), [150.0, -80.0]);
    let under = fitted.to_world(offset);
    ui.move_to(pointer);
    ui.wheel(120.0);
    ui.run();
    let zoomed = ui.camera();
    assert!(zoomed.scale > 1.2 * fitted.scale && (zoomed.to_world(offset) - under).norm() < 1e-6, "{zoomed:?}");
    ui.drag(pointer, pointer + vec2(40.0, 25.0));
    assert!((ui.camera().to_world([190.0, -55.0]) - under).norm() < 1e-2, "the body did not follow the pointer");
    ui.key(Key::F);
    assert_eq!(ui.camera(), fitted);
    // The view follows the body under a resting pointer.
    let mut ui = open("elastica");
    let center = ui.state().view_rect().center();
    (0..5_u8).for_each(|step| ui.move_to(center + vec2(13.7 * f32::from(step), 31.3)));
    let before = ui.camera();
    ui.type_into("Force", "30 N");
    ui.hover(center);
    assert!(ui.camera().scale > 1.1 * before.scale, "{before:?} {:?}", ui.camera());
}

/// At rest, no further frame is requested.
#[test]
fn at_rest_nothing_is_redrawn() {
    let mut ui = open("article");
    wait(&mut ui, "the reference", |lab| !(lab.is_computing() || lab.desk.session.is_following()));
    ui.run_steps(3);
    assert!(!ui.state().iterates());
    let delay = ui.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay > std::time::Duration::from_secs(3600), "{delay:?}");
}

/// The slider of a moving support drags the body, and still exists at 0.
#[test]
fn a_support_is_dragged_and_its_reaction_is_shown() {
    let crown = |ui: &Ui| ui.simulation().probe("crown").unwrap().y;
    let mut ui = open("snap");
    ui.type_into("Move y", "-3 mm");
    assert_eq!(ui.scene().supports[2].displacement, [0.0, -0.003]);
    assert_eq!(*ui.simulation().status(), Status::Converged);
    unfold(&mut ui, "stable");
    ui.get_by_label("(0, -80.53) N");
    ui.fold("Details: ");
    let (before, at) = (ui.rect(Role::Slider, "Move y"), ui.slider("Move y"));
    ui.hold(at(0.4));
    ui.run();
    ui.hover(at(0.3));
    assert_eq!(ui.rect(Role::Slider, "Move y"), before, "the slider moves away");
    ui.release(at(0.3));
    let moved = ui.scene().supports[2].displacement[1];
    assert!((-0.012..-0.004).contains(&moved) && (crown(&ui) - moved).abs() < 1e-4, "{} {moved}", crown(&ui));
    for (text, y, within) in [("0", 0.0, 1e-9), ("-1 mm", -0.001, 1e-5)] {
        ui.type_into("Move y", text);
        assert!((crown(&ui) - y).abs() < within, "{text}");
    }
    assert!(window_of("cantilever", scene("cantilever")).query_by_label("Move y").is_none(), "its supports are fixed");
}

/// A built-in scene has its edits when the user returns to it, and opens without them when it is chosen once more.
#[test]
fn a_built_in_scene_keeps_its_edits() {
    let mut ui = open("article");
    ui.type_into("Force", "20 kN");
    let edited = ui.scene().clone();
    pick(&mut ui, "Scene", "bridge");
    pick(&mut ui, "Scene", "article");
    assert_eq!(*ui.scene(), edited);
    (0..3).for_each(|_| ui.undo());
    assert_eq!(*ui.scene(), scene("article"));
    (0..3).for_each(|_| ui.chord(Modifiers::COMMAND, Key::Y));
    assert_eq!(*ui.scene(), edited);
    pick(&mut ui, "Scene", "article");
    assert_eq!(*ui.scene(), scene("article"));
}

#[test]
fn every_scene_and_element_can_be_chosen() {
    let mut ui = open("article");
    for id in ids_of(Analysis::Static) {
        pick(&mut ui, "Scene", id);
        assert_eq!((&ui.scene().name, ui.simulation().status()), (&scene(id).name, &Status::Converged), "{id}");
        for element in ["t3", "t6"] {
            pick(&mut ui, "Element", element);
            assert_eq!(ui.scene().element().id(), element, "{id}");
            assert_ne!(*ui.simulation().status(), Status::Running, "{id} {element}");
        }
    }
    let before = ui.state().view_rect();
    ui.key(Key::L);
    assert!(ui.state().view_rect().height() < before.height() - 200.0, "no room for the load curve");
}

/// Results appear while the panel stays usable. A study can be cancelled; its measurements are kept and can be applied.
#[test]
fn the_study_runs_in_the_background_and_its_best_setting_is_applied() {
    let measurements = |lab: &Lab| lab.study().0.map_or_else(Vec::new, |s| s.measurements.clone());
    let mut ui = open("cantilever");
    ui.key(Key::B);
    ui.expect(&["Not measured yet"]);
    assert!(ui.get_by_label("Apply the fastest").accesskit_node().is_disabled());
    ui.click_for("Measure on this machine", 2);
    assert!(ui.state().study().1, "no study runs");
    wait(&mut ui, "a first mesh", |lab| !measurements(lab).is_empty());
    let (before, at) = (ui.force(), ui.slider("Force"));
    ui.hold(at(0.4));
    ui.move_to(at(0.45));
    wait(&mut ui, "the body at rest", |lab| !lab.iterates());
    ui.drop_at(at(0.45));
    ui.step();
    assert_ne!(ui.force(), before);
    assert!(ui.state().study().1, "the study stopped");
    wait(&mut ui, "six-node meshes", |lab| measurements(lab).iter().any(|m| m.error_percent() < 5.0) || !lab.study().1);
    ui.get_by_label("Cancel").click();
    wait(&mut ui, "the cancelled study to end", |lab| !lab.study().1);
    ui.run();
    let study = ui.state().study().0.unwrap().clone();
    // A study of another load has no setting for this one, nor for Compare.
    const CHANGED: &str = "The body or its load has changed since";
    ui.expect(&[CHANGED]);
    ui.type_all(&[("Error ≤", "5"), ("Time ≤", "1e5")]);
    assert!(ui.get_by_label("Apply the fastest").accesskit_node().is_disabled());
    let is_offered_in_compare = |ui: &mut Ui| {
        ui.key_press(Key::K);
        ui.run_steps(2);
        let is_disabled = ui.get_by_label("current | fastest").accesskit_node().is_disabled();
        ui.key_press(Key::B);
        ui.run_steps(2);
        !is_disabled
    };
    assert!(!is_offered_in_compare(&mut ui), "Compare offers the setting of another load");
    ui.undo();
    assert_eq!(ui.force(), before);
    assert!(!ui.says(CHANGED) && is_offered_in_compare(&mut ui));

    let meeting = study.meeting(Demand { max_error_percent: Some(5.0), max_time_ms: Some(1e5) });
    assert!(!meeting.is_empty() && meeting.len() < study.measurements.len());
    ui.expect(&[&format!("{} of {} settings meet both", meeting.len(), study.measurements.len())]);
    ui.click("Apply the fastest");
    let of = |m: &Measurement| (m.setting.element, m.setting.cells, m.setting.method);
    let converging: Vec<_> = study.measurements.iter().filter(|m| m.converged).map(of).collect();
    let fastest = meeting.iter().find(|m| converging.contains(&of(m))).unwrap();
    let (best, scene) = (fastest.setting, ui.scene());
    assert_eq!(Setting { iterations: best.iterations, ..Setting::of(scene) }, best);
    // The scene stops after as many iterations as the measurement, and so does a copy of it.
    assert_eq!(scene.solver.accept_after, if fastest.converged { 0 } else { best.iterations });
    assert!(ui.simulation().iterations() <= best.iterations, "{best}: {} iterations", ui.simulation().iterations());
    assert!(meeting.iter().all(|m| m.milliseconds >= meeting[0].milliseconds));

    // The list scrolls to a setting that is applied elsewhere.
    ui.type_into("Error ≤", "1000");
    let wheel = |ui: &mut Ui, delta: f32| {
        ui.hover_at(ui.get_by_label_contains(" settings meet both").rect().center() + vec2(0.0, 40.0));
        ui.wheel(delta);
        ui.run();
    };
    let listed = |ui: &Ui| -> Vec<String> {
        let rows = ui.query_all_by_role(Role::Button).filter_map(|row| row.accesskit_node().label());
        rows.filter(|label| label.contains('≤')).collect()
    };
    wheel(&mut ui, -1e5);
    let last = listed(&ui).pop().unwrap();
    ui.click(&last);
    ui.undo();
    wheel(&mut ui, 1e5);
    assert!(!listed(&ui).contains(&last), "the list is shorter than its area");
    ui.chord(COMMAND_SHIFT, Key::Z);
    assert!(listed(&ui).contains(&last), "{last} was applied, and {:?} are shown", listed(&ui));

    let applied = ui.scene().clone();
    let right = ui.get_by_label("Panel").rect().left() - 320.0;
    let mut places =
        (0..60).flat_map(|i| (0..30).map(move |j| egui::pos2(right - 6.0 * i as f32, 560.0 + 6.0 * j as f32)));
    let is_applied = places.any(|at| {
        ui.move_to(at);
        if ui.output().platform_output.cursor_icon == egui::CursorIcon::PointingHand {
            ui.click_at(at);
            ui.run();
        }
        *ui.scene() != applied
    });
    let is_setting = |m: &Measurement| m.applied() == Setting::of(ui.scene());
    assert!(is_applied && measurements(ui.state()).iter().any(is_setting), "{:?}", ui.scene().solver);
    pick(&mut ui, "Scene", "bridge");
    assert!(ui.state().study().0.is_none());
}

/// The decisions of `auto` are displayed in every frame.
#[test]
fn decisions_are_shown() {
    let mut ui = open("elastica");
    pick(&mut ui, "Method", "auto");
    unfold(&mut ui, "stable");
    ui.get_by_label("New factorization.");
    // From the state under the large load it iterates; from the next one it uses linear theory.
    ui.type_all(&[("Force", "0.1 N"), ("Force", "0.09 N")]);
    ui.get_by_label("Linear theory suffices.");
    ui.type_into("Density", "1234");
    ui.get_by_label("Nothing changed: no solve.");
    assert_eq!(ui.simulation().iterations(), 0);
}

/// A beam that is pressed and pulled settles in equilibrium with the mouse spring; released, it returns.
#[test]
fn a_beam_is_pulled_and_springs_back() {
    let mut ui = open("article");
    let (before, camera) = (ui.simulation().displacement().to_vec(), ui.camera());
    let grip = ui.on_body([4.9, 0.1]);
    ui.drag_at(grip);
    ui.run();
    for near in [egui::Vec2::ZERO, vec2(2.0, -2.0)] {
        ui.hover(grip + near);
        assert!(ui.simulation().mouse_spring().is_none(), "a press is no drag");
    }
    let pointer = grip + vec2(30.0, -160.0);
    ui.hover(pointer);
    let simulation = ui.simulation();
    assert_eq!(*simulation.status(), Status::Converged);
    let (spring, force) = simulation.mouse_spring().unwrap();
    let held = spring.position(simulation.displacement());
    let offset = pointer - ui.state().view_rect().center();
    let place = ui.camera().to_world([offset.x, offset.y].map(f64::from));
    assert!((spring.target() - place).norm() < 1e-6, "the hand is at {}, the pointer at {place}", spring.target());
    // The spring is stiff, so that the point is near the pointer, and its force is its stretch times its stiffness.
    assert!((held - place).norm() < 0.1 * (place - Vector2::new(4.9, 0.1)).norm(), "{held} is pulled to {place}");
    assert!((force - (place - held) * spring.stiffness()).norm() < 1e-9 * force.norm());
    assert_eq!(ui.camera(), camera, "the view moved with the body");
    ui.release(pointer);
    assert_eq!((ui.simulation().status(), ui.simulation().displacement()), (&Status::Converged, &before[..]));
    assert!(ui.simulation().mouse_spring().is_none());
}

/// A motion runs in real time; a reset returns to its start.
#[test]
fn a_motion_is_run_paused_stepped_pulled_and_reset() {
    let mut ui = window_of("swing", scene("swing"));
    let time = |ui: &Ui| ui.simulation().state().time();
    wait(&mut ui, "half a second of motion", |lab| lab.simulation().state().time() > 0.5);
    ui.click_for("Pause", 3);
    let paused = time(&ui);
    ui.run_steps(3);
    assert!((time(&ui) - paused).abs() < 1e-12, "it is paused");
    ui.click_for("Step", 2);
    assert!((time(&ui) - paused - 1.0 / 60.0).abs() < 1e-9, "one step is one time step");
    ui.get_by_label("Run").click();
    wait(&mut ui, "the motion to go on", |lab| lab.simulation().state().time() > paused + 0.3);
    // Pulled at the tip while the motion runs, the mouse spring does work.
    let grip = ui.on_body([0.98, 0.0]);
    ui.drag_at(grip);
    ui.run_steps(2);
    ui.hover_at(grip + vec2(60.0, -80.0));
    ui.run_steps(4);
    assert!(ui.simulation().mouse_spring().is_some_and(|(_, force)| force.norm() > 0.0));
    ui.drop_at(grip + vec2(60.0, -80.0));
    ui.run_steps(2);
    assert!(ui.simulation().mouse_spring().is_none());
    let ledger = *ui.simulation().motion().unwrap().ledger();
    assert!(ledger.mouse_spring != 0.0 && ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{ledger:?}");
    ui.get_by_label("Pause").click();
    ui.click_for("Reset", 2);
    assert_eq!(time(&ui), 0.0, "at the start");
}

/// The panel shows finite values only.
#[test]
fn every_motion_is_shown_with_every_integrator_and_plot() {
    let plots = IntegratorKind::all().zip(["Energy", "Tip"].into_iter().cycle()).collect::<Vec<_>>();
    for (id, (kind, plot)) in sampled(pairs(ids_of(Analysis::Dynamic), plots), 3) {
        let mut ui = window_of(id, scene(id));
        ui.key_press(Key::E);
        ui.run_steps(2);
        ui.edit(|scene| scene.dynamics.integrator = kind);
        ui.get_by_role_and_label(Role::Button, plot).click();
        ui.run_steps(2);
        assert!(ui.simulation().state().is_finite(), "{id} {kind:?}");
        let said = ui.texts();
        assert!(said.iter().all(|t| !t.contains("NaN") && !t.contains("inf")), "{id} {kind:?}: {said:?}");
    }
}

/// The study measures the time of a displayed frame against the error of the path. A click applies a setting.
#[test]
fn a_motions_settings_are_measured_and_applied() {
    // The motion is shortened for the test.
    let mut ui = window_of("swing", scene_with("swing", &["dynamics.duration=0.1"]));
    ui.key_press(Key::Space);
    ui.key_press(Key::B);
    ui.run_steps(4);
    ui.click_for("Measure on this machine", 2);
    wait(&mut ui, "the study of the motion", |lab| !lab.study().1);
    let study = ui.state().study().0.unwrap().clone();
    assert!(!study.is_partial && study.measurements.len() > 20);
    ui.type_all(&[("Error ≤", "20"), ("Time ≤", "100")]);
    ui.run_steps(4);
    let is_met = |m: &&Measurement| study.error_bound(m) <= 20.0 && m.milliseconds / 60.0 <= 100.0;
    let meeting: Vec<_> = study.measurements.iter().filter(is_met).collect();
    let all = study.measurements.iter().filter(|m| m.error.is_some()).count();
    ui.get_by_label(&format!("{} of {all} settings meet both", meeting.len()));
    let best = meeting.iter().min_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds)).unwrap().setting;
    ui.click_for("Apply the fastest", 1);
    assert_eq!((Setting::of(ui.scene()), ui.scene().analysis), (best, Analysis::Dynamic));
    // A cancelled study keeps the measurements that it has, or none.
    ui.click_for("Measure on this machine", 2);
    ui.click_for("Cancel", 1);
    wait(&mut ui, "the end of a cancelled study", |lab| !lab.study().1);
    assert!(ui.state().study().0.is_none_or(|study| study.is_partial));
}

/// The panes of integrators have one clock, and each its energy drift. With another element all motions restart.
#[test]
fn integrators_are_compared_in_panes() {
    // A coarse mesh keeps a busy machine near real time.
    let mut ui = window_of("swing", scene_with("swing", &["beam.cells=[6,1]"]));
    ui.key_press(Key::K);
    ui.run_steps(4);
    assert!(ui.state().panes().iter().all(|pane| pane.place().is_positive()));
    let times =
        |lab: &Lab| -> Vec<f64> { lab.panes().iter().map(|pane| pane.simulation().unwrap().state().time()).collect() };
    let before = ui.simulation().state().time();
    wait(&mut ui, "a second of motion", |lab| times(lab).iter().all(|t| *t > 1.0));
    let all = times(ui.state());
    assert!(all.len() == 3 && all.iter().all(|t| (t - all[0]).abs() < 1e-9), "one clock: {all:?}");
    // The motions wait while their times are measured.
    assert!(ui.state().panes().iter().all(|pane| pane.seconds().is_some_and(|time| time > 0.0)));
    let drift = |kind: IntegratorKind| {
        let pane = ui.state().panes().iter().find(|pane| pane.setting.integrator == Some(kind)).unwrap();
        pane.simulation().unwrap().motion().unwrap().ledger().drift()
    };
    let (kept, lost) = (drift(IntegratorKind::EnergyMomentum), drift(IntegratorKind::ImplicitEuler));
    assert!(kept.abs() < 1e-3 && lost < -0.02, "{kept} {lost}");
    ui.key_press(Key::Space);
    ui.run_steps(3);
    let paused = times(ui.state());
    ui.run_steps(3);
    assert_eq!(times(ui.state()), paused);
    ui.get_by_role_and_label(Role::Button, "t3 | t6 | q4").click();
    ui.run_steps(4);
    assert_eq!(times(ui.state()), [0.0; 3], "another mesh starts over");
    assert!((ui.simulation().state().time() - before).abs() < 1e-12, "the body of Explore waits");
}
