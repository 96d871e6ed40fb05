//! Parts that the panes of equilibria and the panes of motions have in common: presets, places, headers, bodies and the key.

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
use crate::render::display_geometry::DisplayGeometry;
use crate::render::{Camera, View};
use crate::scene::Scene;
use crate::words::{engineering, prefix, three_digits};

/// Points between panes.
const GAP: f32 = 6.0;
/// Height of what a pane says over its body, points.
const HEADER: f32 = 60.0;
/// Height of the key under the panes, points.
const KEY: f32 = 26.0;
/// A pane is no narrower than this, points, where there is another row for it.
const NARROWEST: f32 = 290.0;

/// Input of every comparison from the lab.
pub(crate) struct PaneInput<'a> {
    pub scene: &'a Scene,
    pub view: &'a ViewOptions,
    /// Direction of a force's arrow without force, degrees.
    pub direction: f64,
    /// Loads that the scene opens with.
    pub opening: OpeningLoads,
    /// `true` if the view takes its time on the way to where it looks.
    pub eases: bool,
}

/// Settings of all panes under one name.
pub(super) struct Preset<S> {
    pub name: String,
    pub settings: Vec<S>,
    pub enabled: bool,
    pub tip: &'static str,
    /// Reason for which it is not enabled.
    pub unless: &'static str,
}

/// Shows a button for every preset; returns the settings of the one that was pressed.
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

/// Shows the button that adds a pane to so many; returns `true` if it was pressed.
pub(super) fn add_button(ui: &mut Ui, panes: usize) -> bool {
    let button = ui.add_enabled(panes < *PANES.end(), egui::Button::new(tr("+ Pane")));
    button.on_hover_text(tr("Another pane")).on_disabled_hover_text(tr("Four are the most")).clicked()
}

/// Shows the button that closes a pane, at the right end of its row; returns `true` if it was pressed.
pub(super) fn close_button(ui: &mut Ui, number: usize) -> bool {
    let close = |ui: &mut Ui| {
        let button = egui::Button::new(RichText::new("×").size(18.0)).frame(false);
        let button = ui.add(button.min_size(vec2(24.0, 24.0)));
        let words = fill!("Close pane %{n}", n = number + 1);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &words));
        button.on_hover_text(words).clicked()
    };
    ui.with_layout(Layout::right_to_left(Align::Center), close).inner
}

/// Places of panes.
pub(super) struct Grid {
    pub cells: Vec<Rect>,
    /// Place of the key under them.
    pub key: Rect,
}

impl Grid {
    /// Divides a rectangle among so many panes: beside each other, or in two rows.
    pub(super) fn new(whole: Rect, panes: usize) -> Self {
        let key = Rect::from_min_max(pos2(whole.left(), whole.bottom() - KEY), whole.max);
        Self { cells: cells(Rect::from_min_max(whole.min, key.right_top()), panes), key }
    }
}

/// Place of the body in a cell, under the header.
pub(super) fn body_place(cell: Rect) -> Rect {
    let place = Rect::from_min_max(pos2(cell.left(), (cell.top() + HEADER).min(cell.bottom())), cell.max);
    // As pixels are cut: the body's pass and the painter have the same middle.
    place.round_ui()
}

/// Shows the header of a pane, over the place of its body.
pub(super) fn header(ui: &mut Ui, number: usize, [cell, place]: [Rect; 2], contents: impl FnOnce(&mut Ui)) {
    let header = Rect::from_min_max(cell.min, place.right_top());
    let inner = header.shrink2(vec2(8.0, 3.0));
    ui.scope_builder(UiBuilder::new().max_rect(inner).id_salt(("pane", number)), |ui| {
        ui.set_clip_rect(header.intersect(ui.clip_rect()));
        contents(ui);
    });
}

/// Width and height, points, that all of these places have.
pub(super) fn common_size(places: impl Iterator<Item = Rect>) -> Option<[f64; 2]> {
    let sizes = places.map(|place| [place.width(), place.height()].map(f64::from));
    sizes.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])])
}

/// Smallest box around a box and a point.
pub(super) fn grow([low, high]: [Vector2<f64>; 2], point: &Vector2<f64>) -> [Vector2<f64>; 2] {
    [low.inf(point), high.sup(point)]
}

/// Smallest range around ranges of colours.
pub(super) fn common_range(ranges: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    ranges.reduce(|[low, high], own| [low.min(own[0]), high.max(own[1])]).unwrap_or_default()
}

/// Turns the camera towards a box, m.
pub(super) fn aim(ui: &Ui, eye: &mut CameraController, fit: impl FnOnce([Vector2<f64>; 2]) -> Camera, eases: bool) {
    let dt = f64::from(ui.input(|i| i.stable_dt));
    if eye.aim(fit(eye.whole()), eases.then_some(dt)) {
        ui.ctx().request_repaint();
    }
}

/// Part of the picture that a pane draws.
pub(super) fn view<'a>(
    place: Option<Rect>,
    (shape, drawing): (&'a BodyMesh, &'a DisplayGeometry),
    camera: Camera,
    wireframe: bool,
    pixels_per_point: f32,
) -> Option<View<'a>> {
    Some(View { viewport: viewport(place?, pixels_per_point), frame: shape.frame(drawing, wireframe), camera })
}

/// Follows the pointer over a pane; a view that it moves is that of all panes.
pub(super) fn follow(
    ui: &Ui,
    (number, place): (usize, Rect),
    pointer: &mut Pointer,
    reach: &HitTargets<'_>,
    eye: &mut CameraController,
) -> Interaction {
    let response = ui.interact(place, ui.scope_id().with(("body", number)), Sense::click_and_drag());
    let wish = pointer.follow(ui, &response, reach, Target::None);
    match wish.camera {
        CameraMove::None => {}
        CameraMove::To(camera) => {
            eye.look(camera);
            ui.ctx().request_repaint();
        }
        CameraMove::Fit => eye.fit(),
    }
    wish
}

/// Body of a pane.
pub(super) struct PaneBody<'a> {
    pub scene: &'a Scene,
    pub system: &'a System,
    pub drawing: &'a DisplayGeometry,
    pub shape: &'a BodyMesh,
    /// Outline of the exact solution, m.
    pub exact: &'a [Vec<Vector2<f64>>],
    /// s.
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
            drawing: self.drawing,
            options: input.view,
            camera,
            positions: &self.shape.nodes,
            ghost: None,
            exact: self.exact,
            errors: Errors::default(),
            time: self.time,
            direction: input.direction,
            opening: input.opening,
            hot: self.hot,
            hand: None,
            reactions: &[],
            playback: still,
            color_range: self.shape.range,
            warning: None,
        };
        overlay::body(&ui.painter_at(place), place, &overlay, ui.visuals());
    }
}

/// Paints the colour bar of all panes at the right end of the key; its title where there is room for it right of `left`.
pub(super) fn color_key(ui: &Ui, rect: Rect, left: f32, view: &ViewOptions, range: [f64; 2]) {
    let palette = Palette::new(ui.visuals());
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(SMALL);
    let middle = rect.center().y;
    let bar = if rect.width() < 560.0 { 70.0 } else { 130.0 };
    let unit = view.field.unit();
    let (power, symbol) = prefix(&range, unit);
    let [low, high] = range.map(|v| engineering(three_digits(v / 10f64.powi(power)), ""));
    let put = |right: f32, words: String| {
        painter.text(pos2(right, middle), Align2::RIGHT_CENTER, words, font.clone(), palette.text).left() - 8.0
    };
    let right = put(rect.right() - 12.0, format!("{high} {symbol}{unit}"));
    let bar = Rect::from_center_size(pos2(right - 0.5 * bar, middle), vec2(bar, 10.0));
    overlay::color_bar(&painter, bar, palette.map(view.field));
    let end = put(bar.left() - 8.0, low);
    if end - left > 140.0 {
        painter.text(pos2(end, middle), Align2::RIGHT_CENTER, tr(view.field.name()), font, palette.secondary);
    }
}

/// Number of panes in the first row, of so many, in a view of this width, points.
pub(super) fn first_row(panes: usize, width: f32) -> usize {
    let one_row = panes <= 2 || panes == 3 && (width - 2.0 * GAP) / 3.0 >= NARROWEST;
    if one_row { panes } else { panes.div_ceil(2) }
}

/// Places of so many panes: beside each other, or in two rows.
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
