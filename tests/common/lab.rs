//! Finds and operates the window's controls by their labels.

use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

pub use egui::accesskit::Role;
pub use egui::{Event, Key, Modifiers, Pos2, Rect, vec2};
use egui_kittest::Harness;
pub use egui_kittest::kittest::{NodeT, Queryable};
pub use warpbeam::app::*;
pub use warpbeam::format::*;
use warpbeam::render::Camera;

pub use super::*;

/// Returns a lab with a scene of this name.
pub fn lab_of(name: &str, scene: Scene) -> Lab {
    let simulation = Simulation::new(&scene).unwrap();
    Lab::new(Source { name: name.into(), assignments: Vec::new() }, scene, simulation)
}

/// A window without a display. `run` is called after most actions, so that their effects are complete.
pub struct Ui(pub Harness<'static, Lab>);

impl Deref for Ui {
    type Target = Harness<'static, Lab>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Ui {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

pub const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Size of most windows, points.
pub const SIZE: [f32; 2] = [1280.0, 800.0];

/// Returns a window of this size, points.
pub fn window(size: [f32; 2], lab: Lab) -> Ui {
    window_at([0.25, 400.0], size, lab)
}

/// Returns a window whose frames are this time apart, s. It and `run` show at most this number of frames: a motion has no
/// last one.
pub fn window_at([step, most]: [f32; 2], size: [f32; 2], lab: Lab) -> Ui {
    let builder = Harness::builder().with_size(size).with_max_steps(most as u64).with_step_dt(step);
    Ui(builder.build_ui_state(
        |ui, lab: &mut Lab| {
            lab.advance(ui.input(|i| i.time));
            lab.ui(ui);
        },
        lab,
    ))
}

/// Returns a window with a scene that may not come to rest.
pub fn window_of(id: &str, scene: Scene) -> Ui {
    window(SIZE, lab_of(id, scene))
}

/// Opens a built-in scene in a window whose frames are short enough for double clicks.
pub fn open(id: &str) -> Ui {
    open_of(id, scene(id))
}

pub fn open_of(id: &str, scene: Scene) -> Ui {
    let mut ui = window_at([0.05, 2000.0], SIZE, lab_of(id, scene));
    ui.run();
    ui
}

/// Opens a window of a scene that is solved.
pub fn open_solved(id: &str, scene: Scene) -> Ui {
    open_with(SIZE, id, scene, &|_| {})
}

/// Opens a window of this size of a scene that is solved, after `show`.
pub fn open_with(size: [f32; 2], id: &str, scene: Scene, show: &dyn Fn(&mut Lab)) -> Ui {
    let mut lab = lab_of(id, scene);
    show(&mut lab);
    lab.solve();
    let mut ui = window(size, lab);
    ui.run();
    ui
}

impl Ui {
    pub fn scene(&self) -> &Scene {
        self.state().scene()
    }

    pub fn simulation(&self) -> &Simulation {
        self.state().simulation()
    }

    pub fn camera(&self) -> Camera {
        self.state().camera()
    }

    /// Returns the tip of the first arrow.
    pub fn tip(&self) -> Pos2 {
        self.state().arrow_tips()[0].1
    }

    pub fn force(&self) -> [f64; 2] {
        force(self.scene())
    }

    /// Changes the scene, and runs no frame.
    pub fn edit(&mut self, change: impl FnOnce(&mut Scene)) {
        let mut scene = self.scene().clone();
        change(&mut scene);
        self.state_mut().set_scene(scene).unwrap();
    }

    /// Clicks the control with this label.
    pub fn click(&mut self, label: &str) {
        self.get_by_label(label).click();
        self.run();
    }

    /// Clicks the control with this label, and runs this number of frames: a motion has no last one.
    pub fn click_for(&mut self, label: &str, frames: usize) {
        self.get_by_label(label).click();
        self.run_steps(frames);
    }

    /// Clicks the button with this label, where other controls have it too.
    pub fn push(&mut self, label: &str) {
        self.get_by_role_and_label(Role::Button, label).click();
        self.run();
    }

    /// Opens a list.
    pub fn open(&mut self, picker: &str) {
        self.get_by_role_and_label(Role::ComboBox, picker).click();
        self.run();
    }

    pub fn focus(&mut self, role: Role, label: &str) {
        self.get_by_role_and_label(role, label).focus();
        self.run();
    }

    pub fn key(&mut self, key: Key) {
        self.chord(Modifiers::NONE, key);
    }

    pub fn chord(&mut self, modifiers: Modifiers, key: Key) {
        self.key_press_modifiers(modifiers, key);
        self.run();
    }

    pub fn undo(&mut self) {
        self.chord(Modifiers::COMMAND, Key::Z);
    }

    /// Types text without a further key.
    pub fn text(&mut self, text: &str) {
        self.event(Event::Text(text.to_owned()));
        self.step();
    }

    /// Types text in place of the whole text of the field that has the focus.
    pub fn replace_text(&mut self, text: &str) {
        self.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.step();
        self.text(text);
    }

    /// Opens or closes the fold whose header begins so.
    pub fn fold(&mut self, header: &str) {
        self.get_by_label_contains(header).scroll_to_me();
        self.run_steps(4);
        self.get_by_label_contains(header).click();
        self.run_steps(8);
        self.run_ok();
    }

    /// Puts the cursor into a number field.
    pub fn enter(&mut self, label: &str) {
        self.get_by_role_and_label(Role::SpinButton, label).click();
        self.run();
    }

    pub fn type_into(&mut self, label: &str, text: &str) {
        unfold(self, label);
        self.enter(label);
        self.replace_text(text);
        self.key(Key::Enter);
    }

    /// Types into several fields.
    pub fn type_all(&mut self, fields: &[(&str, &str)]) {
        fields.iter().for_each(|(label, text)| self.type_into(label, text));
    }

    /// Returns `true` if a label contains this text.
    pub fn says(&self, part: &str) -> bool {
        self.query_all_by_label_contains(part).next().is_some()
    }

    /// Asserts that the controls of these labels are within the window.
    pub fn contains(&self, labels: impl IntoIterator<Item = impl AsRef<str>>) {
        let window = self.ctx.content_rect();
        for label in labels {
            let (label, rect) = (label.as_ref(), self.get_by_label(label.as_ref()).rect());
            assert!(window.contains_rect(rect), "{window}: {label} at {rect:?}");
        }
    }

    /// Asserts that each of these texts is within a label.
    pub fn expect(&self, parts: &[impl AsRef<str>]) {
        for part in parts {
            let part = part.as_ref();
            assert!(self.says(part), "no {part:?}: {:?}", self.texts());
        }
    }

    /// Returns `true` if there is a control of this role and label.
    pub fn has(&self, role: Role, label: &str) -> bool {
        self.query_by_role_and_label(role, label).is_some()
    }

    /// Returns the text in the number field of this label.
    pub fn field(&self, label: &str) -> String {
        self.get_by_role_and_label(Role::SpinButton, label).accesskit_node().value().unwrap_or_default()
    }

    pub fn rect(&self, role: Role, label: &str) -> Rect {
        self.get_by_role_and_label(role, label).rect()
    }

    /// Returns the first label or value with this beginning.
    pub fn starting(&self, start: &str) -> String {
        let all = self.texts();
        all.iter().find(|text| text.starts_with(start)).unwrap_or_else(|| panic!("no {start:?}: {all:?}")).clone()
    }

    /// Returns every label and value.
    pub fn texts(&self) -> Vec<String> {
        let nodes = self.get_all_by(|_| true).map(|node| node.accesskit_node());
        nodes.flat_map(|node| [node.label(), node.value()]).flatten().collect()
    }

    /// Returns the places on a slider by their share of its width.
    pub fn slider(&self, label: &str) -> impl Fn(f32) -> Pos2 + use<> {
        let slider = self.get_by_role_and_label(Role::Slider, label).rect();
        move |share| egui::pos2(slider.left() + share * slider.width(), slider.center().y)
    }

    /// Moves the pointer, and runs to the end.
    pub fn hover(&mut self, at: Pos2) {
        self.hover_at(at);
        self.run();
    }

    /// Moves the pointer, and runs one frame.
    pub fn move_to(&mut self, at: Pos2) {
        self.hover_at(at);
        self.step();
    }

    /// Presses the button of the pointer, and keeps it pressed.
    pub fn hold(&mut self, at: Pos2) {
        self.move_to(at);
        self.drag_at(at);
        self.step();
    }

    /// Releases the button of the pointer, and runs to the end.
    pub fn release(&mut self, at: Pos2) {
        self.drop_at(at);
        self.run();
    }

    /// Drags from one position to another through some in between, and releases.
    pub fn drag(&mut self, from: Pos2, to: Pos2) {
        self.drag_with(Modifiers::NONE, from, to);
    }

    pub fn drag_with(&mut self, modifiers: Modifiers, from: Pos2, to: Pos2) {
        let button = egui::PointerButton::Primary;
        let button = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
        self.hover(from);
        self.event(Event::ModifiersChanged(modifiers));
        self.event(button(from, true));
        self.step();
        for i in 1..=4 {
            self.move_to(from + (to - from) * (i as f32 / 4.0));
        }
        self.event(button(to, false));
        self.event(Event::ModifiersChanged(Modifiers::NONE));
        self.run();
    }

    pub fn click_at(&mut self, at: Pos2) {
        self.hover(at);
        self.drag_at(at);
        self.step();
        self.release(at);
    }

    /// Clicks twice in one place, as fast as a double click.
    pub fn double_click(&mut self, at: Pos2) {
        self.hover(at);
        for _ in 0..2 {
            self.drag_at(at);
            self.step();
            self.drop_at(at);
            self.step();
        }
        self.run();
    }

    pub fn drop_file(&mut self, path: &Path) {
        self.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path.to_owned())));
        self.run();
        self.input_mut().dropped_files.clear();
        self.run();
    }

    pub fn secondary_click(&mut self, pos: Pos2) {
        self.hover_at(pos);
        self.run_steps(2);
        for pressed in [true, false] {
            let button = egui::PointerButton::Secondary;
            self.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
            self.step();
        }
        self.run_steps(4);
    }

    /// Selects an entry of the menu at a position.
    pub fn choose(&mut self, at: Pos2, entry: &str) {
        self.secondary_click(at);
        self.click_for(entry, 6);
    }

    pub fn wheel(&mut self, delta: f32) {
        let (unit, phase, source) =
            (egui::MouseWheelUnit::Point, egui::TouchPhase::Move, egui::MouseWheelSource::Wheel);
        let delta = vec2(0.0, delta);
        self.event(Event::MouseWheel { unit, delta, phase, source, modifiers: Modifiers::NONE });
    }

    /// Returns the window position of a material point.
    pub fn on_body(&self, at: impl Into<Vector2<f64>>) -> Pos2 {
        let at = at.into();
        in_view(self.state(), at + displacement_at(self.simulation(), at).unwrap())
    }

    /// Runs frames until a condition holds, with a short sleep after each for background tasks.
    pub fn wait_until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        for _ in 0..12_000 {
            if holds(self) {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
            self.step();
        }
        unreachable!("{what}: never")
    }
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Returns the event of the pointer's first button.
pub fn primary(pos: Pos2, pressed: bool) -> Event {
    let button = egui::PointerButton::Primary;
    Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
}

/// Returns the event of a key without modifiers.
pub fn key_event(key: Key, pressed: bool) -> Event {
    Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
}

/// Returns the first force of a scene.
pub fn force(scene: &Scene) -> [f64; 2] {
    forces(scene)[0]
}

/// Returns the forces of a scene.
pub fn forces(scene: &Scene) -> Vec<[f64; 2]> {
    scene
        .loads
        .iter()
        .filter_map(|load| if let Load::Force { force, .. } = load { Some(*force) } else { None })
        .collect()
}

/// Returns the window position of a point of the plane.
pub fn in_view(lab: &Lab, place: Vector2<f64>) -> Pos2 {
    let [x, y] = lab.camera().to_view(place);
    lab.view_rect().center() + vec2(x as f32, y as f32)
}

/// Returns two texts in the view of which one covers the other.
pub fn covered_text(ui: &Ui) -> Option<[String; 2]> {
    let view = ui.state().view_rect();
    let texts = text_shapes(ui).into_iter();
    let texts = texts.map(|(_, text)| (text.galley.text().to_owned(), text.visual_bounding_rect().shrink(1.0)));
    let texts: Vec<(String, Rect)> = texts.filter(|(_, at)| view.contains_rect(*at)).collect();
    let pairs = texts.iter().enumerate().flat_map(|(i, a)| texts[..i].iter().map(move |b| (a, b)));
    // Semibold texts are drawn twice.
    let mut covered = pairs.filter(|(a, b)| a.1.intersects(b.1) && a.0 != b.0);
    covered.next().map(|(a, b)| [a.0.clone(), b.0.clone()])
}

/// Returns all painted shapes with their clip rectangles, including nested ones.
pub fn shapes(ui: &Ui) -> Vec<(Rect, egui::Shape)> {
    fn flatten(shape: &egui::Shape, clip: Rect, found: &mut Vec<(Rect, egui::Shape)>) {
        match shape {
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| flatten(shape, clip, found)),
            shape => found.push((clip, shape.clone())),
        }
    }
    let mut found = Vec::new();
    ui.output().shapes.iter().for_each(|clipped| flatten(&clipped.shape, clipped.clip_rect, &mut found));
    found
}

/// Returns all painted texts with their clip rectangles.
pub fn text_shapes(ui: &Ui) -> Vec<(Rect, egui::epaint::TextShape)> {
    let texts = shapes(ui).into_iter();
    texts
        .filter_map(|(clip, shape)| if let egui::Shape::Text(text) = shape { Some((clip, text)) } else { None })
        .collect()
}

/// Returns all painted texts with their positions.
pub fn painted(ui: &Ui) -> Vec<(Pos2, String)> {
    text_shapes(ui).into_iter().map(|(_, text)| (text.pos, text.galley.text().to_owned())).collect()
}

/// Runs frames until `done`, with a short sleep after each for background tasks; returns the number of frames.
pub fn wait(ui: &mut Ui, what: &str, done: impl Fn(&Lab) -> bool) {
    ui.wait_until(what, |ui| done(ui.state()));
}

/// Runs frames until every displayed result is known, and shows it.
pub fn settle(ui: &mut Ui) {
    wait(ui, "a displayed result", |lab| !lab.is_computing());
    ui.run_steps(3);
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

/// Opens the fold with the control of this label and closes the others: all of them are taller than the window.
pub fn unfold(ui: &mut Ui, label: &str) {
    if !FOLDS.iter().any(|(_, labels)| labels.contains(&label)) {
        return;
    }
    for (fold, labels) in FOLDS {
        let is_open = ui.query_all_by_label(labels[0]).next().is_some();
        if is_open != labels.contains(&label) {
            ui.fold(fold);
        }
    }
}

/// Selects an entry of a combo box. If the program asks, unsaved edits are discarded.
pub fn pick(ui: &mut Ui, picker: &str, entry: &str) {
    ui.open(picker);
    // The list may be longer than its visible part.
    ui.get_by_role_and_label(Role::Button, entry).scroll_to_me();
    ui.run();
    ui.push(entry);
    if let Some(discard) = ui.query_by_role_and_label(Role::Button, "Discard") {
        discard.click();
        ui.run();
    }
}
