//! Panel: reads parameters and emits actions, and never accesses the simulation for writing. Four controls are always
//! visible; the others are in sections whose headers summarize their content.

use egui::collapsing_header::{CollapsingState, paint_default_icon};
use egui::text::{LayoutJob, TextWrapping};

use crate::app::interface::*;
use crate::app::viewport::arrow::{DOWN, LoadRanges};

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
    pub force_direction: Option<f64>,
    gravity_direction: Option<f64>,
    /// Index among the scene's loads of the force that the sliders set; the first force if it is `None` or no force.
    pub force: Option<usize>,
    /// Index of the support that the sliders move.
    support: Option<usize>,
    /// Index of the section that is shown, and the number of sections in the last frame.
    section: Option<(usize, usize)>,
    cells: body::CellsThatFollow,
}

impl PanelState {
    /// Removes messages when the pointer is released after the next press: the fields have their values again. A press
    /// that itself leads to a message keeps it.
    pub(super) fn fade_messages(&mut self, ctx: &Context) {
        let (pressed, released) = ctx.input(|i| (i.pointer.any_pressed(), i.pointer.any_released()));
        if pressed {
            self.has_old_messages = !self.messages.is_empty();
        }
        if released && std::mem::take(&mut self.has_old_messages) && !ctx.text_edit_focused() {
            self.messages.clear();
        }
    }

    /// Returns the direction of a force of zero, degrees.
    pub(super) fn force_direction(&self) -> f64 {
        self.force_direction.unwrap_or(DOWN)
    }
}

/// Shows the content of the panel, and `has_result` the details of the result.
pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>, has_result: bool) {
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    // Set again below by the widget under the pointer.
    panel.view.edge = None;
    let (session, scene) = (panel.session, panel.scene);
    let scroll = ScrollArea::vertical().auto_shrink([false, false]);
    scroll.scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::VisibleWhenNeeded).show(ui, |ui| {
        if !scene.about.is_empty() {
            let about = spaced(RichText::new(tr(&scene.about)), SMALL).small().weak();
            ui.add(Label::new(about).wrap());
        }
        if panel.view.mode == Mode::Compare {
            ui.small(tr("Panes with a method, element or mesh of their own keep it."));
        }
        ui.add_space(4.0);
        solver(ui, panel);
        ui.add_space(2.0);
        loads::force(ui, panel);
        ui.add_space(4.0);
        if scene.analysis == Analysis::Dynamic {
            fold(ui, "Time", &motion::summary(scene), true, |ui| motion::show(ui, panel));
        }
        fold(ui, "Gravity, moment", &loads::summary(scene), false, |ui| loads::gravity_and_moment(ui, panel));
        fold(ui, edges::SECTION, &edges::summary(scene), false, |ui| edges::show(ui, panel));
        if let Some((number, support)) = supports::chosen(panel) {
            fold(ui, "Moved support", &supports::summary(support), true, |ui| {
                supports::show(ui, panel, number, support)
            });
        }
        if let Some(beam) = &scene.beam {
            let summary = format!("{} × {}", engineering(beam.length, "m"), engineering(beam.height, "m"));
            fold(ui, "Beam", &summary, false, |ui| body::size(ui, panel, beam));
        }
        fold(ui, "Material", &body::material_summary(scene), false, |ui| body::material(ui, panel));
        fold(ui, "Mesh", &body::mesh_summary(session), false, |ui| body::mesh(ui, panel));
        if !scene.sections.is_empty() {
            fold(ui, "Sections", &scene.sections.len().to_string(), true, |ui| sections::show(ui, panel));
        }
        fold(ui, "View", &view::summary(panel.view, scene), false, |ui| view::options(ui, panel));
        fold(ui, "File", tr("open, save, picture"), false, |ui| view::keep(ui, panel));
        if has_result {
            fold(ui, "Details", &result::summary(session), false, |ui| result::show(ui, session));
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
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.5, palette.accent), StrokeKind::Inside);
        }
        let icon = Rect::from_center_size(rect.left_center() + vec2(7.0, 0.0), vec2(12.0, 12.0));
        paint_default_icon(ui, state.openness(ui.ctx()), &response.clone().with_new_rect(icon));
        let at = rect.left_center() + vec2(ICON, 0.0);
        let font = FontId::proportional(BODY);
        let title = ui.painter().text(at, Align2::LEFT_CENTER, name, font, palette.text);
        let left = title.right() + 10.0;
        let mut job = LayoutJob::simple_singleline(summary.to_owned(), FontId::proportional(SMALL), palette.secondary);
        job.wrap = TextWrapping::truncate_at_width((rect.right() - left).max(0.0));
        let galley = ui.painter().layout_job(job);
        let at = pos2(rect.right() - galley.size().x, rect.center().y - 0.5 * galley.size().y);
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

/// Input of the panel in a frame, its state, and the actions that it requests.
pub(super) struct Panel<'a> {
    pub session: &'a Session,
    pub scene: &'a Scene,
    /// Range of the displayed field's values in the drawn state.
    pub values: [f64; 2],
    pub state: &'a mut PanelState,
    pub view: &'a mut ViewOptions,
    pub actions: &'a mut Vec<Action>,
}

impl Panel<'_> {
    fn edit(&mut self, label: &'static str, change: impl FnOnce(&mut Scene)) {
        self.actions.push(Action::edit(label, self.scene, change));
    }

    /// Shows a number; returns the one that the user enters.
    fn number(&mut self, ui: &mut Ui, field: &NumberField, value: f64, original: Option<f64>) -> Option<f64> {
        field.show(ui, &mut self.state.messages, value, original)
    }

    /// Shows a number of the scene, which `get` returns if the scene has it.
    fn field(
        &mut self,
        ui: &mut Ui,
        field: &NumberField,
        get: impl Fn(&Scene) -> Option<f64>,
        set: impl FnOnce(&mut Scene, f64),
    ) {
        let Some(value) = get(self.scene) else { return };
        if let Some(new) = self.number(ui, field, value, get(&self.session.document().original)) {
            self.edit(field.label, |scene| set(scene, new));
        }
    }

    fn rows(&mut self, ui: &mut Ui, rows: impl IntoIterator<Item = NumberRow>) {
        for NumberRow { field, get, set } in rows {
            self.field(ui, &field, |scene| Some(get(scene)), set);
        }
    }

    /// Shows a list with name and description of each value, for the change to one of them.
    fn picker<T>(
        &mut self,
        ui: &mut Ui,
        label: &'static str,
        (chosen, about): (&str, &str),
        entries: impl Iterator<Item = (T, &'static str, &'static str)>,
        set: impl Fn(&mut Scene, T),
    ) {
        /// Width of the column of labels, points.
        const LABELS: f32 = 74.0;
        let palette = Palette::new(ui.visuals());
        combo(ui, label, tr(chosen), about, Some(LABELS), |ui| {
            for (value, id, about) in entries {
                if choice(ui, &palette, id == chosen, id, about).clicked() && id != chosen {
                    self.edit(label, |scene| set(scene, value));
                    ui.close();
                }
            }
        });
        show_message(ui, &self.state.messages, label);
    }
}

/// Shows a list that `entries` fills, with its label; beside a column of labels, points, it fills the row.
fn combo(ui: &mut Ui, label: &str, chosen: &str, tip: &str, column: Option<f32>, entries: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let left = ui.cursor().left();
        let name = ui.label(tr(label));
        let mut list = ComboBox::from_id_salt(label).selected_text(chosen).height(560.0);
        if let Some(column) = column {
            ui.add_space((left + column - name.rect.right() - ui.spacing().item_spacing.x).max(0.0));
            list = list.width(ui.available_width()).truncate();
        }
        list.show_ui(ui, entries).response.labelled_by(name.id).on_hover_text(tr(tip));
    });
}

/// Shows method and element, and the number of iterations after which a result is accepted, if the scene asks for that.
fn solver(ui: &mut Ui, panel: &mut Panel<'_>) {
    let scene = panel.scene;
    let (method, element) = (scene.solver.method.entry(), scene.element().entry());
    let methods = METHODS.iter().map(|m| (m.kind, m.id, m.about));
    panel.picker(ui, "Method", (method.id, method.about), methods, |scene, method| scene.solver.method = method);
    let elements = scene.elements().map(|element| (element, element.id(), element.entry().about));
    panel.picker(ui, "Element", (element.id, element.about), elements, Scene::set_element);
    if [scene, &panel.session.document().original].iter().any(|scene| scene.solver.accept_after > 0) {
        panel.rows(ui, [ACCEPT_AFTER]);
    }
}

const ACCEPT_AFTER: NumberRow = NumberField::new("Accept after", keys::range("solver.accept_after"), 1.0..=20.0)
    .whole()
    .tip("Iterations after which a result is accepted although it has not converged; 0: iterate to the tolerance.")
    .row(|s| f64::from(s.solver.accept_after), |s, v| s.solver.accept_after = v as u32);
