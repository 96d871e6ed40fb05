//! Panel: reads parameters and emits actions, and never accesses the simulation for writing. Four controls are always
//! visible; the others are in sections whose headers summarize their content.

use crate::app::readout::Readout;
use egui::collapsing_header::{CollapsingState, paint_default_icon};
use egui::scroll_area::ScrollBarVisibility;
use egui::{Align2, ComboBox, FontId, RichText, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo, vec2};

use crate::app::action::Action;
use crate::app::diagnosis::Errors;
use crate::app::language::{spaced, tr};
use crate::app::view_options::{Mode, ViewOptions};
use crate::app::viewport::arrow::DOWN;
use crate::app::widgets::buttons::choice;
use crate::app::widgets::number_field::{Messages, NumberField, SliderScale, show_message};
use crate::app::widgets::palette::{BODY, Palette, SMALL};
use crate::method::METHODS;
use crate::scene::{Analysis, Scene, limits};

mod body;
pub(crate) mod edges;
mod loads;
mod motion;
mod result;
mod sections;
mod supports;
mod view;

/// Width of the panel, points.
pub const PANEL_WIDTH: f32 = 284.0;

/// State that the panel keeps between frames.
#[derive(Debug, Default)]
pub(super) struct PanelState {
    pub messages: Messages,
    /// `true` between a press and its release if there were messages before the press.
    has_old_messages: bool,
    /// Last directions, degrees, kept while a magnitude is zero.
    force_direction: Option<f64>,
    gravity_direction: Option<f64>,
    /// Index among the scene's loads of the force that the sliders set; the first force if it is `None` or no force.
    force: Option<usize>,
    cells: body::CellsThatFollow,
}

impl PanelState {
    /// Resets the state for another scene.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Removes messages when the pointer is released after the next press: the fields have their values again. A press
    /// that itself leads to a message keeps it.
    pub(super) fn fade_messages(&mut self, ctx: &egui::Context) {
        let (pressed, released) = ctx.input(|i| (i.pointer.any_pressed(), i.pointer.any_released()));
        if pressed {
            self.has_old_messages = !self.messages.is_empty();
        }
        if released && std::mem::take(&mut self.has_old_messages) && !ctx.text_edit_focused() {
            self.messages.clear();
        }
    }

    /// Makes the sliders set this load of the scene, if it is a force.
    pub(super) fn choose_force(&mut self, load: usize) {
        self.force = Some(load);
    }

    /// Updates the chosen force after the removal of a load: the same force stays chosen if it still exists.
    fn discard_force(&mut self, load: usize) {
        self.force =
            self.force.filter(|force| *force != load).map(|force| if force > load { force - 1 } else { force });
    }

    /// Returns the direction of a force of zero, degrees.
    pub(super) fn force_direction(&self) -> f64 {
        self.force_direction.unwrap_or(DOWN)
    }

    /// Stores the direction of a force that may become zero, degrees.
    pub(super) fn keep_force_direction(&mut self, degrees: f64) {
        self.force_direction = Some(degrees);
    }
}

/// Shows the content of the panel; the details of the result if its `errors` are given.
pub(super) fn show(
    ui: &mut Ui,
    input: &Readout<'_>,
    errors: Option<&Errors>,
    state: &mut PanelState,
    view: &mut ViewOptions,
    actions: &mut Vec<Action>,
) {
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    // Set again below by the widget under the pointer.
    view.edge = None;
    let scroll = ScrollArea::vertical().auto_shrink([false, false]);
    scroll.scroll_bar_visibility(ScrollBarVisibility::VisibleWhenNeeded).show(ui, |ui| {
        let palette = Palette::new(ui.visuals());
        if !input.scene.about.is_empty() {
            let about = spaced(RichText::new(tr(&input.scene.about)), SMALL).small().color(palette.secondary);
            ui.add(egui::Label::new(about).wrap());
        }
        if view.mode == Mode::Compare {
            ui.small(tr("Each pane has its own method, element and mesh."));
        }
        ui.add_space(4.0);
        method(ui, input, state, actions);
        element(ui, input, state, actions);
        accept_after(ui, input, state, actions);
        ui.add_space(2.0);
        loads::force(ui, input, state, actions);
        ui.add_space(4.0);
        if input.scene.analysis == Analysis::Dynamic {
            fold(ui, "Time", &motion::summary(input), true, |ui| motion::show(ui, input, state, actions));
        }
        let summary = loads::summary(input.scene);
        fold(ui, "Gravity, moment", &summary, false, |ui| loads::gravity_and_moment(ui, input, state, actions));
        let summary = edges::summary(input.scene);
        fold(ui, edges::SECTION, &summary, false, |ui| edges::show(ui, input, state, view, actions));
        if let Some(support) = supports::chosen(ui, input) {
            let summary = supports::summary(input.scene, support);
            fold(ui, "Moved support", &summary, true, |ui| supports::show(ui, input, support, state, actions));
        }
        if let Some(beam) = &input.scene.beam {
            fold(ui, "Beam", &body::size_summary(beam), false, |ui| body::size(ui, input, state, actions));
        }
        let summary = body::material_summary(input.scene);
        fold(ui, "Material", &summary, false, |ui| body::material(ui, input, state, actions));
        let summary = body::mesh_summary(input);
        fold(ui, "Mesh", &summary, false, |ui| body::mesh(ui, input, state, actions));
        if !input.scene.sections.is_empty() {
            let summary = sections::summary(input);
            fold(ui, "Sections", &summary, true, |ui| sections::show(ui, input, state, view, actions));
        }
        let summary = view::summary(view, input.scene);
        fold(ui, "View", &summary, false, |ui| view::options(ui, input, state, view, actions));
        fold(ui, "File", tr("open, save, picture"), false, |ui| view::keep(ui, input.scene, actions));
        if let Some(errors) = errors {
            fold(ui, "Details", &result::summary(input), false, |ui| result::show(ui, input, errors));
        }
    });
}

/// Shows a section with a summary in its header; a click on the header opens or closes it.
fn fold(ui: &mut Ui, title: &str, summary: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    const HEIGHT: f32 = 28.0;
    const ICON: f32 = 18.0;
    let palette = Palette::new(ui.visuals());
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), ui.make_persistent_id(("fold", title)), open);
    let name = tr(title);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    if response.clicked() {
        state.toggle(ui);
    }
    if ui.is_rect_visible(rect) {
        ui.painter().hline(rect.x_range(), rect.top(), Stroke::new(1.0, palette.line));
        if response.has_focus() {
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.5, palette.accent), egui::StrokeKind::Inside);
        }
        let icon = egui::Rect::from_center_size(rect.left_center() + vec2(7.0, 0.0), vec2(12.0, 12.0));
        paint_default_icon(ui, state.openness(ui.ctx()), &response.clone().with_new_rect(icon));
        let at = rect.left_center() + vec2(ICON, 0.0);
        let font = FontId::proportional(BODY);
        let title = ui.painter().text(at, Align2::LEFT_CENTER, name, font, palette.text);
        let left = title.right() + 10.0;
        let mut job = egui::text::LayoutJob::simple_singleline(
            summary.to_owned(),
            FontId::proportional(SMALL),
            palette.secondary,
        );
        job.wrap = egui::text::TextWrapping::truncate_at_width((rect.right() - left).max(0.0));
        let galley = ui.painter().layout_job(job);
        let at = egui::pos2(rect.right() - galley.size().x, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(at, galley, palette.secondary);
    }
    let text = format!("{name}: {summary}");
    response.widget_info(|| WidgetInfo::labeled(Role::DisclosureTriangle, true, &text));
    response.on_hover_cursor(egui::CursorIcon::PointingHand);
    state.show_body_unindented(ui, |ui| {
        contents(ui);
        ui.add_space(6.0);
    });
}

/// Row of the panel that edits a number of the scene.
struct NumberRow {
    field: NumberField,
    get: fn(&Scene) -> f64,
    set: fn(&mut Scene, f64),
}

/// Shows the rows of a table.
fn number_rows(
    ui: &mut Ui,
    input: &Readout<'_>,
    state: &mut PanelState,
    actions: &mut Vec<Action>,
    rows: impl IntoIterator<Item = NumberRow>,
) {
    for NumberRow { field, get, set } in rows {
        let original = Some(get(input.original));
        if let Some(new) = field.show_with_original(ui, &mut state.messages, get(input.scene), original) {
            let mut scene = Box::new(input.scene.clone());
            set(&mut scene, new);
            actions.push(Action::Edit(field.label, scene));
        }
    }
}

/// Shows a picker with name and description of each entry. Returns the name of the entry that was picked.
fn picker<'a>(
    ui: &mut Ui,
    label: &str,
    chosen: (&str, &str),
    entries: impl Iterator<Item = (&'a str, &'a str)>,
) -> Option<&'a str> {
    const LABEL_WIDTH: f32 = 74.0;
    let palette = Palette::new(ui.visuals());
    let mut picked = None;
    ui.horizontal(|ui| {
        let left = ui.cursor().left();
        let name = ui.label(tr(label));
        ui.add_space((left + LABEL_WIDTH - name.rect.right() - ui.spacing().item_spacing.x).max(0.0));
        ComboBox::from_id_salt(label)
            .selected_text(tr(chosen.0))
            .width(ui.available_width())
            .height(420.0)
            .show_ui(ui, |ui| {
                for (id, about) in entries {
                    if choice(ui, &palette, id == chosen.0, id, about).clicked() && id != chosen.0 {
                        picked = Some(id);
                        ui.close();
                    }
                }
            })
            .response
            .labelled_by(name.id)
            .on_hover_text(tr(chosen.1));
    });
    picked
}

fn method(ui: &mut Ui, input: &Readout<'_>, state: &PanelState, actions: &mut Vec<Action>) {
    let chosen = input.scene.solver.method.entry();
    let entries = METHODS.iter().map(|entry| (entry.id, entry.about));
    let picked = picker(ui, "Method", (chosen.id, chosen.about), entries);
    if let Some(entry) = METHODS.iter().find(|entry| Some(entry.id) == picked) {
        let mut scene = Box::new(input.scene.clone());
        scene.solver.method = entry.kind;
        actions.push(Action::Edit("Method", scene));
    }
    show_message(ui, &state.messages, "Method");
}

fn element(ui: &mut Ui, input: &Readout<'_>, state: &PanelState, actions: &mut Vec<Action>) {
    let chosen = input.scene.element().entry();
    let entries = input.scene.elements().map(|element| (element.id(), element.entry().about));
    let picked = picker(ui, "Element", (chosen.id, chosen.about), entries);
    if let Some(element) = input.scene.elements().find(|element| Some(element.id()) == picked) {
        let mut scene = Box::new(input.scene.clone());
        scene.set_element(element);
        actions.push(Action::Edit("Element", scene));
    }
    show_message(ui, &state.messages, "Element");
}

/// Shows the number of iterations after which a result is accepted, if the scene asks for that.
fn accept_after(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    if [input.scene, input.original].iter().all(|scene| scene.solver.accept_after == 0) {
        return;
    }
    let field = NumberField {
        label: "Accept after",
        tooltip: "Iterations after which a result is accepted although it has not converged; 0: iterate to the tolerance.",
        limit: limits::ACCEPT_AFTER,
        slider: 0.0..=20.0,
        scale: SliderScale::Linear,
        whole: true,
    };
    let get = |s: &Scene| f64::from(s.solver.accept_after);
    number_rows(ui, input, state, actions, [NumberRow { field, get, set: |s, v| s.solver.accept_after = v as u32 }]);
}
