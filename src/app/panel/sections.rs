//! Panel section of the cuts whose section forces are shown.

use super::*;
use crate::app::diagnosis::state_text;
use crate::app::viewport::objects::add_middle_section;
use crate::study::section_chart;

/// Shows the chosen section: its forces, its place and direction, and buttons that show its stress and remove it.
pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let (session, scene) = (panel.session, panel.scene);
    let last = scene.sections.len().saturating_sub(1);
    let (remembered, before) = panel.state.section.unwrap_or((0, last));
    // A new section is chosen.
    let chosen = if last > before { last } else { remembered.min(last) };
    panel.state.section = Some((chosen, last));
    let Some(&line) = scene.sections.get(chosen) else { return };
    let name = |i: usize| fill!("Section %{n}", n = i + 1);
    if scene.sections.len() > 1 {
        ComboBox::from_id_salt("section").selected_text(name(chosen)).show_ui(ui, |ui| {
            for i in 0..scene.sections.len() {
                if ui.selectable_label(i == chosen, name(i)).clicked() {
                    panel.state.section = Some((i, last));
                }
            }
        });
    }
    if let Some(state) = state_text(session) {
        ui.weak(state);
    }
    let forces = match session.drawn().section_forces(line) {
        Ok(section) => section_chart::text_of(&section, session.drawn()),
        Err(error) => said(&error),
    };
    ui.add(Label::new(forces).wrap()).on_hover_text(tr(
        "Normal force, shear force and bending moment that the part in front of the section exerts on the part behind",
    ));
    let (low, high) = session.simulation().mesh().bounds();
    let mut row = |field: &NumberField, value: f64, set: &dyn Fn(&mut SectionLine, f64)| {
        let Some(new) = panel.number(ui, field, value, None) else { return };
        let mut moved = line;
        set(&mut moved, new);
        match session.drawn().section_forces(moved) {
            Ok(_) => panel
                .edit(field.label, |scene| scene.sections.get_mut(chosen).into_iter().for_each(|line| *line = moved)),
            Err(error) => _ = panel.state.messages.insert(field.label, (&error).into()),
        }
    };
    for (axis, label) in ["Cut x", "Cut y"].into_iter().enumerate() {
        let field =
            NumberField::new(label, limits::COORDINATE, low[axis]..=high[axis]).tip("Point of the section at rest");
        row(&field, line.at[axis], &|line, at| line.at[axis] = at);
    }
    row(&NORMAL, line.angle.to_degrees(), &|line, angle| line.angle = angle.to_radians());
    ui.horizontal(|ui| {
        let is_open = panel.view.plots() == Some(Drawer::Section);
        if scene.analysis == Analysis::Static && ui.selectable_label(is_open, tr("Stress")).clicked() {
            panel.actions.push(Action::Toggle(Toggle::Drawer(Drawer::Section)));
        }
        if ui.button(tr("Remove")).clicked() {
            panel.edit("Sections", |scene| _ = scene.sections.remove(chosen));
        }
        if ui.button(tr("Add a section")).clicked() {
            panel.edit("Sections", |scene| add_middle_section(scene, session.simulation().system()));
        }
    });
}

const NORMAL: NumberField = NumberField::new("Normal", supports::TURNS, -180.0..=180.0)
    .tip("Direction of the section's normal, counter-clockwise from the x axis; it points to the part in front");
