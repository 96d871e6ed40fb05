//! Finds and operates the window's controls by their labels.

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use warpbeam::Simulation;
use warpbeam::app::Lab;
use warpbeam::scene::{Scene, Source};

/// Returns a lab with a scene of this name.
pub fn lab_of(name: &str, scene: Scene) -> Lab {
    let simulation = Simulation::new(&scene).unwrap();
    Lab::new(Source { name: name.into(), assignments: Vec::new() }, scene, simulation)
}

/// Returns a window of this size, points.
pub fn window(size: [f32; 2], lab: Lab) -> Harness<'static, Lab> {
    Harness::builder().with_size(size).build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    )
}

/// Runs frames until `done`, with a short sleep after each for background tasks; returns the number of frames.
pub fn wait(harness: &mut Harness<'_, Lab>, what: &str, done: impl Fn(&Lab) -> bool) -> u32 {
    for frame in 0..6000 {
        if done(harness.state()) {
            return frame;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
        harness.step();
    }
    unreachable!("{what}: never")
}

/// Runs frames until every displayed result is known, and shows it.
pub fn settle(harness: &mut Harness<'_, Lab>) {
    wait(harness, "a displayed result", |lab| !lab.is_computing());
    harness.run_steps(3);
}

/// Folds of the panel, with the labels of their controls.
const FOLDS: [(&str, &[&str]); 6] = [
    ("Gravity, moment: ", &["Gravity", "Moment"]),
    ("Loads and supports: ", &["Add", "Force on", "Held at", "Moment on"]),
    ("Beam: ", &["Length", "Height"]),
    ("Material: ", &["Young E", "Poisson ν", "Density", "Thickness t", "strain"]),
    ("Mesh: ", &["Cells along", "Cells across"]),
    ("Details: ", &["stable"]),
];

/// Opens the fold that contains the control of this label and closes the others, because all of them together are
/// taller than the window.
pub fn unfold(harness: &mut Harness<'_, Lab>, label: &str) {
    if !FOLDS.iter().any(|(_, labels)| labels.contains(&label)) {
        return;
    }
    for (fold, labels) in FOLDS {
        let is_open = harness.query_all_by_label(labels[0]).next().is_some();
        if is_open != labels.contains(&label) {
            harness.get_by_label_contains(fold).click();
            harness.run_steps(8);
            harness.run();
        }
    }
}

/// Selects an entry of a combo box. If the program asks, unsaved edits are discarded.
pub fn pick(harness: &mut Harness<'_, Lab>, picker: &str, entry: &str) {
    harness.get_by_role_and_label(Role::ComboBox, picker).click();
    harness.run();
    // The list may be longer than its visible part.
    harness.get_by_role_and_label(Role::Button, entry).scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::Button, entry).click();
    harness.run();
    if let Some(discard) = harness.query_by_role_and_label(Role::Button, "Discard") {
        discard.click();
        harness.run();
    }
}

/// Types text into the number field of this label, and presses Enter.
pub fn type_into(harness: &mut Harness<'_, Lab>, label: &str, text: &str) {
    unfold(harness, label);
    harness.get_by_role_and_label(Role::SpinButton, label).click();
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.event(egui::Event::Text(text.to_owned()));
    harness.step();
    harness.key_press(Key::Enter);
    harness.run();
}
