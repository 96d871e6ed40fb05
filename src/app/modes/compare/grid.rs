//! Common parts of the panes of equilibria and the panes of motions: presets, layout, headers, bodies and the key.

use egui::emath::GuiRounding;
use egui::{Align, Align2, FontId, Layout, Rect, RichText, Role, Sense, Ui, UiBuilder, WidgetInfo, pos2, vec2};
use nalgebra::Vector2;

use super::setting::PANES;
use crate::app::diagnosis::Errors;
use crate::app::language::{fill, tr};
use crate::app::session::playback::Playback;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::handle::HotHandle;
use crate::app::viewport::overlay::{self, Overlay};
use crate::app::viewport::pointer::{CameraMove, HitTargets, Interaction, Pointer, Target};
use crate::app::viewport::projection::viewport;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::load_scale::OpeningLoads;
use crate::app::widgets::palette::{Palette, SMALL};
use crate::assembly::System;
use crate::format::{engineering, prefix, three_digits};
use crate::render::display_geometry::DisplayGeometry;
use crate::render::{Camera, View};
use crate::scene::Scene;

/// Space between panes, points.
const GAP: f32 = 6.0;
/// Height of a pane's header, points.
const HEADER: f32 = 60.0;
/// Height of the key under the panes, points.
const KEY: f32 = 26.0;
/// Smallest width of a pane in a row of three, points.
const NARROWEST: f32 = 290.0;

/// Common input of the comparisons of equilibria and of motions.
pub(crate) struct PaneInput<'a> {
    pub scene: &'a Scene,
    pub view: &'a ViewOptions,
    /// Direction of the arrow of a zero force, degrees.
    pub direction: f64,
    /// Loads that the scene opens with.
    pub opening: OpeningLoads,
    /// `true` if camera movements are animated.
    pub eases: bool,
}

/// Named settings of all panes.
pub(super) struct Preset<S> {
    pub name: String,
    pub settings: Vec<S>,
    pub enabled: bool,
    pub tip: &'static str,
    /// Reason for which the preset is disabled.
    pub unless: &'static str,
}

/// Shows a button for every preset; returns the settings of the preset that was pressed.
pub(super) fn preset_buttons<S: PartialEq>(
    ui: &mut Ui,
    present: &[S],
    presets: impl IntoIterator<Item = Preset<S>>,
) -> Option<Vec<S>> {
    let mut picked = None;
    for Preset { name, settings, enabled, tip, unless } in presets {
        let button = ui.add_enabled(enabled, option_button(enabled && present == settings, name));
        if button.on_hover_text(tr(tip)).on_disabled_hover_text(tr(unless)).clicked() {
            picked = Some(settings);
        }
    }
    picked
}

/// Shows the button that adds a pane to `panes` existing ones; returns `true` if it was pressed.
pub(super) fn add_button(ui: &mut Ui, panes: usize) -> bool {
    let button = ui.add_enabled(panes < *PANES.end(), egui::Button::new(tr("+ Pane")));
    button.on_hover_text(tr("Add a pane")).on_disabled_hover_text(tr("At most four panes")).clicked()
}

/// Shows the button that closes a pane, at the right end of its row; returns `true` if it was pressed.
pub(super) fn close_button(ui: &mut Ui, number: usize) -> bool {
    let close = |ui: &mut Ui| {
        let button = egui::Button::new(RichText::new("×").size(18.0)).frame(false);
        let button = ui.add(button.min_size(vec2(24.0, 24.0)));
        let text = fill!("Close pane %{n}", n = number + 1);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &text));
        button.on_hover_text(text).clicked()
    };
    ui.with_layout(Layout::right_to_left(Align::Center), close).inner
}

/// Areas of the panes and of the key.
pub(super) struct Grid {
    pub cells: Vec<Rect>,
    /// Area of the key under the panes.
    pub key: Rect,
}

impl Grid {
    /// Divides a rectangle among `panes` panes, side by side or in two rows.
    pub(super) fn new(whole: Rect, panes: usize) -> Self {
        let key = Rect::from_min_max(pos2(whole.left(), whole.bottom() - KEY), whole.max);
        Self { cells: cells(Rect::from_min_max(whole.min, key.right_top()), panes), key }
    }
}

/// Returns the area of the body in a cell, under the header.
pub(super) fn body_place(cell: Rect) -> Rect {
    let place = Rect::from_min_max(pos2(cell.left(), (cell.top() + HEADER).min(cell.bottom())), cell.max);
    // Rounded to pixels, so that the render pass and the painter have the same centre.
    place.round_ui()
}

/// Change of a pane by its header: the pane's number, and its new setting; `None` closes the pane.
pub(super) type PaneChange<S> = Option<(usize, Option<S>)>;

/// Shows the headers and bodies of all panes in their cells; returns the change that a header asks for, and the
/// pointer's interaction with the load of a pane.
pub(super) fn show_panes<C, I, S>(
    ui: &mut Ui,
    cells: &[Rect],
    (comparison, input): (&mut C, &I),
    show_header: fn(&C, &mut Ui, usize, &I, &mut PaneChange<S>),
    show_body: fn(&mut C, &Ui, usize, Rect, &I) -> Interaction,
) -> (PaneChange<S>, Interaction) {
    let (mut change, mut interaction) = (None, Interaction::default());
    for (number, cell) in cells.iter().enumerate() {
        let place = body_place(*cell);
        header(ui, number, [*cell, place], |ui| show_header(comparison, ui, number, input, &mut change));
        let own = show_body(comparison, ui, number, place, input);
        if own.load.is_some() || own.restore.is_some() {
            interaction = own;
        }
    }
    (change, interaction)
}

/// Shows the header of a pane, above the area of its body.
fn header(ui: &mut Ui, number: usize, [cell, place]: [Rect; 2], contents: impl FnOnce(&mut Ui)) {
    let header = Rect::from_min_max(cell.min, place.right_top());
    let inner = header.shrink2(vec2(8.0, 3.0));
    ui.scope_builder(UiBuilder::new().max_rect(inner).id_salt(("pane", number)), |ui| {
        ui.set_clip_rect(header.intersect(ui.clip_rect()));
        contents(ui);
    });
}

/// Returns the width and height, points, that all of these areas have in common.
pub(super) fn common_size(places: impl Iterator<Item = Rect>) -> Option<[f64; 2]> {
    let sizes = places.map(|place| [place.width(), place.height()].map(f64::from));
    sizes.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])])
}

/// Returns the smallest box that contains a box and a point.
pub(super) fn grow([low, high]: [Vector2<f64>; 2], point: &Vector2<f64>) -> [Vector2<f64>; 2] {
    [low.inf(point), high.sup(point)]
}

/// Returns the smallest range that contains all colour ranges.
pub(super) fn common_range(ranges: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    ranges.reduce(|[low, high], own| [low.min(own[0]), high.max(own[1])]).unwrap_or_default()
}

/// Animates the camera towards the box that it fits.
pub(super) fn aim(
    ui: &Ui,
    controller: &mut CameraController,
    fit: impl FnOnce([Vector2<f64>; 2]) -> Camera,
    eases: bool,
) {
    let dt = f64::from(ui.input(|i| i.stable_dt));
    if controller.aim(fit(controller.whole()), eases.then_some(dt)) {
        ui.ctx().request_repaint();
    }
}

/// Returns the area of a pane's body for the render pass.
pub(super) fn view<'a>(
    place: Option<Rect>,
    (body_mesh, geometry): (&'a BodyMesh, &'a DisplayGeometry),
    camera: Camera,
    wireframe: bool,
    pixels_per_point: f32,
) -> Option<View<'a>> {
    Some(View { viewport: viewport(place?, pixels_per_point), frame: body_mesh.frame(geometry, wireframe), camera })
}

/// Processes the pointer over a pane; moving the view moves it in all panes.
pub(super) fn follow(
    ui: &Ui,
    (number, place): (usize, Rect),
    pointer: &mut Pointer,
    reach: &HitTargets<'_>,
    controller: &mut CameraController,
) -> Interaction {
    let response = ui.interact(place, ui.scope_id().with(("body", number)), Sense::click_and_drag());
    let wish = pointer.follow(ui, &response, reach, Target::None);
    match wish.camera {
        CameraMove::None => {}
        CameraMove::To(camera) => {
            controller.look(camera);
            ui.ctx().request_repaint();
        }
        CameraMove::Fit => controller.fit(),
    }
    wish
}

/// Body of a pane.
pub(super) struct PaneBody<'a> {
    pub scene: &'a Scene,
    pub system: &'a System,
    pub geometry: &'a DisplayGeometry,
    pub body_mesh: &'a BodyMesh,
    /// Outline of the reference solution, m.
    pub exact: &'a [Vec<Vector2<f64>>],
    /// Simulated time, s.
    pub time: f64,
    pub hot: Option<HotHandle>,
}

impl PaneBody<'_> {
    /// Paints outlines, supports and loads over the body.
    pub(super) fn paint(&self, ui: &Ui, place: Rect, camera: Camera, input: &PaneInput<'_>, still: &Playback) {
        let overlay = Overlay {
            apart: false,
            scene: self.scene,
            system: self.system,
            geometry: self.geometry,
            options: input.view,
            camera,
            positions: &self.body_mesh.nodes,
            ghost: None,
            exact: self.exact,
            errors: Errors::default(),
            time: self.time,
            direction: input.direction,
            opening: input.opening,
            hot: self.hot,
            mouse_spring: None,
            reactions: &[],
            playback: still,
            color_range: self.body_mesh.range,
            warning: None,
        };
        overlay::body(&ui.painter_at(place), place, &overlay, ui.visuals());
    }
}

/// Paints the common colour bar at the right end of the key, with its title if there is room for it to the right of
/// `left`.
pub(super) fn color_key(ui: &Ui, rect: Rect, left: f32, view: &ViewOptions, range: [f64; 2]) {
    let palette = Palette::new(ui.visuals());
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(SMALL);
    let middle = rect.center().y;
    let bar = if rect.width() < 560.0 { 70.0 } else { 130.0 };
    let unit = view.field.unit();
    let (power, symbol) = prefix(&range, unit);
    let [low, high] = range.map(|v| engineering(three_digits(v / 10f64.powi(power)), ""));
    let put = |right: f32, text: String| {
        painter.text(pos2(right, middle), Align2::RIGHT_CENTER, text, font.clone(), palette.text).left() - 8.0
    };
    let right = put(rect.right() - 12.0, format!("{high} {symbol}{unit}"));
    let bar = Rect::from_center_size(pos2(right - 0.5 * bar, middle), vec2(bar, 10.0));
    overlay::color_bar(&painter, bar, palette.map(view.field));
    let end = put(bar.left() - 8.0, low);
    if end - left > 140.0 {
        painter.text(pos2(end, middle), Align2::RIGHT_CENTER, tr(view.field.name()), font, palette.secondary);
    }
}

/// Returns the number of panes in the first row in a view of this width, points.
pub(super) fn first_row(panes: usize, width: f32) -> usize {
    let one_row = panes <= 2 || panes == 3 && (width - 2.0 * GAP) / 3.0 >= NARROWEST;
    if one_row { panes } else { panes.div_ceil(2) }
}

/// Returns the areas of `panes` panes, side by side or in two rows.
fn cells(rect: Rect, panes: usize) -> Vec<Rect> {
    let first = first_row(panes, rect.width());
    let rows = [first, panes - first];
    let count = if rows[1] > 0 { 2.0 } else { 1.0 };
    let height = ((rect.height() - GAP * (count - 1.0)) / count).floor();
    let mut cells = Vec::with_capacity(panes);
    let mut top = rect.top();
    for row in rows {
        let width = ((rect.width() - GAP * (row.max(1) - 1) as f32) / row.max(1) as f32).floor();
        for column in 0..row {
            let corner = pos2(rect.left() + (width + GAP) * column as f32, top);
            cells.push(Rect::from_min_size(corner, vec2(width, height.max(0.0))));
        }
        top += height + GAP;
    }
    cells
}
