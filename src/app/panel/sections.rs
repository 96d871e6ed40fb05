//! Panel section of the cuts whose section forces are shown.

use std::ops::RangeInclusive;

use egui::{ComboBox, Id, Ui};

use crate::app::diagnosis::state_text;
use crate::app::language::{fill, said, tr};
use crate::app::panel::{Action, PanelState};
use crate::app::readout::Readout;
use crate::app::view_options::{Drawer, Toggle, ViewOptions};
use crate::app::widgets::number_field::{NumberField, SliderScale};
use crate::scene::limits::Limit;
use crate::scene::{Analysis, Scene, SectionLine, limits};
use crate::study::section_chart;

/// Returns a summary: the number of sections.
pub(super) fn summary(input: &Readout<'_>) -> String {
    input.scene.sections.len().to_string()
}

/// Returns the forces of a section of the drawn state, or the reason why there are none.
fn forces(input: &Readout<'_>, line: SectionLine) -> String {
    match input.shown.section_forces(line) {
        Ok(section) => section_chart::text_of(&section, input.shown),
        Err(error) => said(&error),
    }
}

/// Shows the chosen section: its forces, its place and direction, and buttons that show its stress and remove it.
pub(super) fn show(
    ui: &mut Ui,
    input: &Readout<'_>,
    state: &mut PanelState,
    view: &ViewOptions,
    actions: &mut Vec<Action>,
) {
    let scene = input.scene;
    let id = Id::unique(("section", input.scene_name));
    let last = scene.sections.len().saturating_sub(1);
    let (remembered, before) = ui.data(|data| data.get_temp::<(usize, usize)>(id)).unwrap_or((0, last));
    // A new section is chosen.
    let chosen = if last > before { last } else { remembered.min(last) };
    ui.data_mut(|data| data.insert_temp(id, (chosen, last)));
    let Some(&line) = scene.sections.get(chosen) else { return };
    let name = |i: usize| fill!("Section %{n}", n = i + 1);
    if scene.sections.len() > 1 {
        ComboBox::from_id_salt("section").selected_text(name(chosen)).show_ui(ui, |ui| {
            for i in 0..scene.sections.len() {
                if ui.selectable_label(i == chosen, name(i)).clicked() {
                    ui.data_mut(|data| data.insert_temp(id, (i, last)));
                }
            }
        });
    }
    if let Some(state) = state_text(input) {
        ui.weak(state);
    }
    ui.add(egui::Label::new(forces(input, line)).wrap()).on_hover_text(tr(
        "Normal force, shear force and bending moment that the part in front of the section exerts on the part behind",
    ));
    let (low, high) = input.simulation.mesh().bounds();
    let angle = Limit { unit: "°", min: limits::ROTATION.min.to_degrees(), max: limits::ROTATION.max.to_degrees() };
    type LineField = (&'static str, &'static str, Limit, RangeInclusive<f64>, f64, fn(&mut SectionLine, f64));
    let rows: [LineField; 3] = [
        ("Cut x", "Point of the section at rest", limits::COORDINATE, low.x..=high.x, line.at.x, |line, x| {
            line.at.x = x
        }),
        ("Cut y", "Point of the section at rest", limits::COORDINATE, low.y..=high.y, line.at.y, |line, y| {
            line.at.y = y
        }),
        (
            "Normal",
            "Direction of the section's normal, counter-clockwise from the x axis; it points to the part in front",
            angle,
            -180.0..=180.0,
            line.angle.to_degrees(),
            |line, angle| line.angle = angle.to_radians(),
        ),
    ];
    for (label, tooltip, limit, slider, value, set) in rows {
        let field = NumberField { label, tooltip, limit, slider, scale: SliderScale::Linear, whole: false };
        if let Some(new) = field.show(ui, &mut state.messages, value) {
            let mut moved = line;
            set(&mut moved, new);
            if let Err(error) = input.shown.section_forces(moved) {
                state.messages.insert(label, (&error).into());
                continue;
            }
            actions.push(Action::Edit(
                label,
                edited(scene, |lines| lines.iter_mut().skip(chosen).take(1).for_each(|line| set(line, new))),
            ));
        }
    }
    ui.horizontal(|ui| {
        let is_static = scene.analysis == Analysis::Static;
        if is_static && ui.selectable_label(view.plots() == Some(Drawer::Section), tr("Stress")).clicked() {
            actions.push(Action::Toggle(Toggle::Drawer(Drawer::Section)));
        }
        if ui.button(tr("Remove")).clicked() {
            actions.push(Action::Edit("Sections", edited(scene, |lines| _ = lines.remove(chosen))));
        }
    });
}

fn edited(scene: &Scene, edit: impl FnOnce(&mut Vec<SectionLine>)) -> Box<Scene> {
    let mut scene = Box::new(scene.clone());
    edit(&mut scene.sections);
    scene
}
