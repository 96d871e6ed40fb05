//! The panel: parameters in, actions out. It never touches the simulation.

use egui::{Button, ComboBox, RichText, ScrollArea, Ui};

use super::action::{Action, ViewOptions};
use super::field::{Messages, NumberField};
use super::playback::Playback;
use super::quality::Quality;
use crate::scene::{Analysis, Scene, registry};
use crate::simulation::Simulation;
use crate::study::Reference;
use crate::timings::Timings;

mod body;
mod loads;
mod motion;
mod result;
mod view;

pub(super) use result::status_words;
pub(super) use view::range_of;

/// What the panel shows.
pub(super) struct PanelInput<'a> {
    pub scene: &'a Scene,
    pub scene_name: &'a str,
    pub simulation: &'a Simulation,
    pub running: bool,
    pub playback: &'a Playback,
    /// Iterations a displayed frame.
    pub iterations: u32,
    /// Time of the last iterations made for one displayed frame.
    pub timings: &'a Timings,
    /// What errors are measured against, once it is known.
    pub truth: Option<&'a Reference>,
    /// How far the result is to be trusted.
    pub quality: &'a Quality,
    pub adapter: &'a str,
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
pub(super) fn show(
    ui: &mut Ui,
    input: &PanelInput<'_>,
    state: &mut PanelState,
    view: &mut ViewOptions,
    actions: &mut Vec<Action>,
) {
    // Always visible: in a low window one must see that there is more.
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysVisible)
        .show(ui, |ui| {
            ui.add_space(4.0);
            scene_picker(ui, input, actions);
            controls(ui, input, actions);
            if input.scene.analysis == Analysis::Dynamic {
                section(ui, "Time");
                motion::show(ui, input, state, actions);
            }
            section(ui, "Load");
            loads::force_and_gravity(ui, input, state, actions);
            loads::moment(ui, input, state, actions);
            section(ui, "Result");
            result::show(ui, input);
            section(ui, "Material");
            body::material(ui, input.scene, state, actions);
            section(ui, "Mesh and method");
            body::mesh_and_method(ui, input, state, actions);
            section(ui, "View");
            view::options(ui, input, state, view, actions);
            ui.separator();
            ui.add(egui::Label::new(RichText::new(input.adapter).small().weak()).wrap());
        });
}

fn section(ui: &mut Ui, title: &str) {
    ui.separator();
    ui.strong(title);
}

/// A row that edits a number of the scene.
fn number_row(
    ui: &mut Ui,
    scene: &Scene,
    state: &mut PanelState,
    actions: &mut Vec<Action>,
    (field, value): (NumberField, f64),
    set: fn(&mut Scene, f64),
) {
    if let Some(new) = field.show(ui, &mut state.messages, value) {
        let mut scene = Box::new(scene.clone());
        set(&mut scene, new);
        actions.push(Action::Edit(field.label, scene));
    }
}

fn scene_picker(ui: &mut Ui, input: &PanelInput<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let label = ui.label("Scene");
        ComboBox::from_id_salt("scene")
            .selected_text(&input.scene.name)
            .width(ui.available_width())
            .height(480.0)
            .show_ui(ui, |ui| {
                for built_in in registry::BUILT_IN {
                    let selected = built_in.id == input.scene_name;
                    if ui.selectable_label(selected, built_in.id).clicked() {
                        actions.push(Action::Open(built_in.id));
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("The built-in scenes; a file opens with `warpbeam run FILE`.");
    });
    ui.add(egui::Label::new(RichText::new(&input.scene.about).small().weak()).wrap());
}

fn controls(ui: &mut Ui, input: &PanelInput<'_>, actions: &mut Vec<Action>) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        let (word, tip) = if input.running { ("Pause", "Stop") } else { ("Run", "Go on") };
        if ui.button(word).on_hover_text(format!("{tip} (Space)")).clicked() {
            actions.push(Action::ToggleRun);
        }
        let can_step = !input.simulation.is_at_rest();
        let step = ui.add_enabled(can_step, Button::new("Step"));
        if step.on_hover_text("Pause, and make one iteration or time step (N)").clicked() {
            actions.push(Action::Step);
        }
        if ui.button("Reset").on_hover_text("Back to rest, or to the start of the motion (R)").clicked() {
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
