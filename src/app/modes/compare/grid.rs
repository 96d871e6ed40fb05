//! Controls of the panes: pickers, layout and the key.

use egui::emath::GuiRounding;
use egui::{Align, Align2, ComboBox, FontId, Layout, Rect, RichText, Role, Ui, Vec2, WidgetInfo, pos2, vec2};

use crate::app::prelude::*;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::overlay;
use crate::app::widgets::buttons::choice;
use crate::app::widgets::palette::{Palette, SMALL};
use crate::format::{engineering, prefix, three_digits};

/// Space between panes, points.
const GAP: f32 = 6.0;
/// Height of a pane's header without probes, and of a line with a probe, points.
const HEADER: f32 = 60.0;
const PROBE: f32 = 18.0;
/// Height of the key under the panes, points.
const KEY: f32 = 26.0;
/// Smallest width of a pane in a row of three, points.
const NARROWEST: f32 = 290.0;

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
    /// Area of every pane.
    pub cells: Vec<Rect>,
    /// Area of the key under the panes.
    pub key: Rect,
    /// Height of the headers, points.
    header: f32,
}

impl Grid {
    /// Divides a rectangle among `panes` panes, whose headers have lines for `probes` probes, side by side or in two rows.
    pub(super) fn new(whole: Rect, panes: usize, probes: usize) -> Self {
        let header = HEADER + PROBE * probes as f32;
        let key = Rect::from_min_max(pos2(whole.left(), whole.bottom() - KEY), whole.max);
        let rest = Rect::from_min_max(whole.min, key.right_top());
        Self { cells: cells(rest, panes), key, header }
    }

    /// Returns the area of the body in a cell, under the header.
    pub(super) fn body_place(&self, cell: Rect) -> Rect {
        let place = Rect::from_min_max(pos2(cell.left(), (cell.top() + self.header).min(cell.bottom())), cell.max);
        // Rounded to pixels, so that the render pass and the painter have the same centre.
        place.round_ui()
    }
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

/// Paints the factor of the drawn displacement at the left end of the key, unless it is 1; returns the left end of the
/// rest.
pub(super) fn magnification_key(ui: &Ui, rect: Rect, magnification: f64) -> f32 {
    let left = rect.left() + 12.0;
    if magnification == 1.0 {
        return left;
    }
    let (at, font) = (pos2(left, rect.center().y), FontId::proportional(SMALL));
    let text = overlay::magnified(magnification);
    let color = Palette::new(ui.visuals()).text;
    ui.painter_at(rect).text(at, Align2::LEFT_CENTER, text, font, color).right() + 16.0
}

/// Paints the common colour bar at the right end of the key, with its title if there is room for it to the right of
/// `left`.
pub(super) fn color_key(ui: &Ui, rect: Rect, left: f32, view: &ViewOptions, range: [f64; 2]) {
    let palette = Palette::new(ui.visuals());
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(SMALL);
    let middle = rect.center().y;
    let bar = if rect.width() < 560.0 { 70.0 } else { 130.0 };
    let (factor, unit) = view.field.display_unit();
    let range = range.map(|end| factor * end);
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
fn first_row(panes: usize, width: f32) -> usize {
    let one_row = panes <= 2 || panes == 3 && (width - 2.0 * GAP) / 3.0 >= NARROWEST;
    if one_row { panes } else { panes.div_ceil(2) }
}

/// Returns the areas of `panes` panes in equal columns, side by side or in two rows.
fn cells(rect: Rect, panes: usize) -> Vec<Rect> {
    let columns = first_row(panes, rect.width()).max(1);
    let part = |length: f32, count: usize| ((length - GAP * (count - 1) as f32) / count as f32).floor().max(0.0);
    let size = vec2(part(rect.width(), columns), part(rect.height(), panes.div_ceil(columns).max(1)));
    let place = |i: usize| vec2((i % columns) as f32, (i / columns) as f32) * (size + Vec2::splat(GAP));
    (0..panes).map(|i| Rect::from_min_size(rect.min + place(i), size)).collect()
}

/// Shows a picker of a pane: a value of its own, or that of the panel.
pub(super) fn pick<T: Copy + PartialEq>(
    ui: &mut Ui,
    palette: &Palette,
    (pane, what): (&str, &str),
    width: f32,
    (value, panels): (&mut Option<T>, &str),
    entries: impl Iterator<Item = (T, &'static str, &'static str)> + Clone,
) {
    let id = value.and_then(|own| entries.clone().find(|entry| entry.0 == own)).map_or(panels, |entry| entry.1);
    let mut menu = |ui: &mut Ui| {
        ui.set_width(280.0);
        for (kind, id, about) in entries.clone() {
            if choice(ui, palette, *value == Some(kind), id, about).clicked() {
                *value = Some(kind);
            }
        }
        let about = fill!("Follows the panel, now %{setting}", setting = tr(panels));
        if choice(ui, palette, value.is_none(), "as in the panel", &about).clicked() {
            *value = None;
        }
    };
    combo(ui, pane, what, id, width, &mut menu);
}

fn combo(ui: &mut Ui, pane: &str, what: &str, text: &str, width: f32, menu: &mut dyn FnMut(&mut Ui)) {
    let (label, text) = (format!("{pane} {}", tr(what)), tr(text));
    let combo = ComboBox::from_id_salt(&label).selected_text(RichText::new(text)).width(width).height(420.0).truncate();
    // The width of a combo box is its least one.
    let size = vec2(width, ui.spacing().interact_size.y);
    let inside = ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| combo.show_ui(ui, menu));
    let response = inside.inner.response;
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, &label);
        info.current_text_value = Some(text.to_owned());
        info
    });
}

/// Shows a picker of meshes that are finer or coarser than the panel's.
pub(super) fn mesh_picker(
    ui: &mut Ui,
    palette: &Palette,
    pane: &str,
    width: f32,
    cells: &mut Option<[u32; 2]>,
    scene: &Scene,
) {
    /// Largest number of cells offered.
    const MAX_CELLS: u64 = 40_000;
    let mesh_text = |[along, across]: [u32; 2]| format!("{along}×{across}");
    let Some(beam) = &scene.beam else {
        return combo(ui, pane, "mesh", "as meshed", width, &mut |ui| {
            ui.label(tr("The mesh is that of the file."));
        });
    };
    let own = beam.cells;
    let text = mesh_text(cells.unwrap_or(own));
    combo(ui, pane, "mesh", &text, width, &mut |ui| {
        ui.set_width(200.0);
        let about = fill!("Follows the panel, now %{setting}", setting = mesh_text(own));
        if choice(ui, palette, cells.is_none(), "as in the panel", &about).clicked() {
            *cells = None;
        }
        let coarser = own.map(|n| n.div_ceil(2));
        let finer = [1, 2, 4, 8, 16].map(|times| own.map(|n| n.saturating_mul(times)));
        let offered = std::iter::once(coarser).filter(|&c| c != own).chain(finer);
        let small = offered.filter(|[a, b]| u64::from(*a) * u64::from(*b) <= MAX_CELLS);
        let other = cells.filter(|own| !small.clone().any(|offered| offered == *own));
        for offered in small.chain(other) {
            let about = match offered {
                _ if offered == own => "as in the panel now; does not follow it later",
                _ if offered[0] < own[0] => "coarser",
                _ => "finer",
            };
            if choice(ui, palette, *cells == Some(offered), &mesh_text(offered), about).clicked() {
                *cells = Some(offered);
            }
        }
    });
}
