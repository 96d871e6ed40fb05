//! The panel: parameters in, actions out. It never touches the simulation.

use egui::{Button, ComboBox, RichText, ScrollArea, Ui};
use nalgebra::Vector2;

use super::field::Messages;
use crate::method::Profile;
use crate::scene::{Scene, registry};
use crate::simulation::{Field, Simulation, Status};

mod body;
mod loads;
mod result;
mod view;

pub(super) use result::status_words;
pub(super) use view::range_of;

/// What the panel shows.
pub(super) struct Shown<'a> {
    pub scene: &'a Scene,
    pub scene_name: &'a str,
    pub simulation: &'a Simulation,
    pub running: bool,
    /// Iterations a frame.
    pub iterations: u32,
    /// Time of the last frame that iterated.
    pub frame_time: &'a Profile,
    /// True displacement of the right edge, m, where one is known.
    pub truth: Option<Vector2<f64>>,
    pub adapter: &'a str,
}

/// What a click or a drag asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Action {
    /// Open a built-in scene.
    Open(&'static str),
    /// Change the scene; a refusal is shown next to the field of this label.
    Edit(&'static str, Box<Scene>),
    /// Iterate, or stop.
    Run(bool),
    /// One iteration.
    Step,
    /// Back to rest.
    Reset,
    /// Show everything.
    Fit,
    /// Light or dark.
    ToggleTheme,
    /// Save a picture.
    Screenshot,
    /// Copy the scene.
    Copy,
    /// So many iterations a frame.
    Iterations(u32),
}

/// What is shown under the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawer {
    /// Load against deflection.
    Curve,
    /// Error against time, and the dial.
    Trade,
}

/// How to look at the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ViewOptions {
    pub field: Field,
    /// Fixed ends of the colour map, or `None` for those of the current values.
    pub fixed_range: Option<[f64; 2]>,
    pub wireframe: bool,
    pub rest_outline: bool,
    pub ghost: bool,
    pub drawer: Option<Drawer>,
    pub panel: bool,
    pub help: bool,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            field: Field::default(),
            fixed_range: None,
            wireframe: true,
            rest_outline: true,
            ghost: true,
            drawer: None,
            panel: true,
            help: false,
        }
    }
}

impl ViewOptions {
    /// Opens a drawer in the place of another, or closes it.
    pub(super) fn toggle(&mut self, drawer: Drawer) {
        self.drawer = if self.drawer == Some(drawer) { None } else { Some(drawer) };
    }
}

/// What the panel remembers from frame to frame.
#[derive(Debug, Default)]
pub(super) struct PanelState {
    pub messages: Messages,
    /// Directions in degrees, kept while a magnitude is zero.
    force_direction: Option<f64>,
    gravity_direction: Option<f64>,
}

impl PanelState {
    /// Forgets what belonged to another scene.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Shows the panel's contents.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, state: &mut PanelState, view: &mut ViewOptions) -> Vec<Action> {
    let mut actions = Vec::new();
    // Always visible: in a low window one must see that there is more.
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysVisible)
        .show(ui, |ui| {
            ui.add_space(4.0);
            scene_picker(ui, shown, &mut actions);
            controls(ui, shown, &mut actions);
            section(ui, "Load");
            loads::force_and_gravity(ui, shown, state, &mut actions);
            loads::moment(ui, shown, state, &mut actions);
            section(ui, "Result");
            result::show(ui, shown);
            section(ui, "Material");
            body::material(ui, shown.scene, state, &mut actions);
            section(ui, "Mesh and method");
            body::mesh_and_method(ui, shown, state, &mut actions);
            section(ui, "View");
            view::options(ui, shown, state, view, &mut actions);
            ui.separator();
            ui.add(egui::Label::new(RichText::new(shown.adapter).small().weak()).wrap());
        });
    actions
}

fn section(ui: &mut Ui, title: &str) {
    ui.separator();
    ui.strong(title);
}

fn scene_picker(ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let label = ui.label("Scene");
        ComboBox::from_id_salt("scene")
            .selected_text(&shown.scene.name)
            .width(ui.available_width())
            .height(480.0)
            .show_ui(ui, |ui| {
                for built_in in registry::BUILT_IN {
                    let selected = built_in.id == shown.scene_name;
                    if ui.selectable_label(selected, built_in.id).clicked() {
                        actions.push(Action::Open(built_in.id));
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("The built-in scenes; a file opens with `warpbeam run FILE`.");
    });
    ui.add(egui::Label::new(RichText::new(&shown.scene.about).small().weak()).wrap());
}

fn controls(ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        let (word, tip) = if shown.running { ("Pause", "Stop iterating") } else { ("Run", "Iterate, once a frame") };
        if ui.button(word).on_hover_text(format!("{tip} (Space)")).clicked() {
            actions.push(Action::Run(!shown.running));
        }
        let can_step = *shown.simulation.status() == Status::Running;
        let step = ui.add_enabled(can_step, Button::new("Step"));
        if step.on_hover_text("Pause, and make one iteration (N)").clicked() {
            actions.push(Action::Step);
        }
        if ui.button("Reset").on_hover_text("Back to rest, and iterate again (R)").clicked() {
            actions.push(Action::Reset);
        }
        if ui.button("Fit").on_hover_text("Show the whole body (F)").clicked() {
            actions.push(Action::Fit);
        }
        if ui.button("Theme").on_hover_text("Light or dark (T)").clicked() {
            actions.push(Action::ToggleTheme);
        }
    });
}
