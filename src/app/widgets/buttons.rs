//! Buttons with icons, option buttons, and entries of pickers.

use egui::text::LayoutJob;
use egui::{
    Align2, Button, FontId, IntoAtoms, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, StrokeKind,
    TextFormat, Ui, WidgetInfo, pos2, vec2,
};

use crate::app::language::tr;
use crate::app::widgets::palette::{BODY, Palette, SMALL};

/// Icon of a button, drawn with lines because the fonts have no such glyphs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Icon {
    Play,
    Pause,
    Step,
    Reset,
    Undo,
    Redo,
    Theme,
    Language,
    Help,
    Panel,
    Open,
    Close,
}

/// Adds a button with an icon, followed by a word if one is given. `name` is its name for screen readers.
pub(crate) fn icon_button(ui: &mut Ui, icon: Icon, name: &str, word: Option<&str>, chosen: bool) -> Response {
    const SIDE: f32 = 28.0;
    const WIDE: f32 = 52.0;
    const GAP: f32 = 5.0;
    const PADDING: f32 = 8.0;
    const WORD: f32 = 38.0; // of Run and Pause, so that nothing moves
    let font = FontId::proportional(BODY);
    let least = if matches!(icon, Icon::Play | Icon::Pause) { WORD } else { 0.0 };
    let side = if icon == Icon::Language { WIDE } else { SIDE };
    let galley = word.map(|word| ui.painter().layout_no_wrap(word.to_owned(), font, egui::Color32::PLACEHOLDER));
    let width = galley.as_ref().map_or(side, |galley| 2.0 * PADDING + 14.0 + GAP + galley.size().x.max(least));
    let (rect, response) = ui.allocate_exact_size(vec2(width, ui.spacing().interact_size.y), Sense::click());
    let style = ui.style().interact_selectable(&response, chosen);
    ui.painter().rect(rect, style.corner_radius, style.weak_bg_fill, style.bg_stroke, StrokeKind::Inside);
    let color = style.fg_stroke.color;
    let center = match &galley {
        Some(_) => rect.left_center() + vec2(PADDING + 7.0, 0.0),
        None => rect.center(),
    };
    paint(ui.painter(), icon, center, color);
    if let Some(galley) = galley {
        let at = pos2(rect.left() + PADDING + 14.0 + GAP, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(at, galley, color);
    }
    response.widget_info(|| WidgetInfo::selected(Role::Button, response.enabled(), chosen, name));
    response
}

fn paint(painter: &Painter, icon: Icon, center: Pos2, color: egui::Color32) {
    let at = |x: f32, y: f32| center + vec2(x, y);
    let stroke = Stroke::new(1.6, color);
    let polygon = |points: Vec<Pos2>| _ = painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
    let bar = |x: f32| _ = painter.rect_filled(Rect::from_center_size(at(x, 0.0), vec2(3.0, 11.0)), 0.5, color);
    let arc = |from: f32, to: f32| -> Vec<Pos2> {
        let angles = (0..=20u8).map(|i| from + (to - from) * f32::from(i) / 20.0);
        angles.map(|a| at(5.5 * a.cos(), 5.5 * a.sin())).collect()
    };
    match icon {
        Icon::Play => polygon(vec![at(-4.0, -6.0), at(6.0, 0.0), at(-4.0, 6.0)]),
        Icon::Pause => [-3.0, 3.0].into_iter().for_each(bar),
        Icon::Step => {
            polygon(vec![at(-6.0, -5.5), at(2.0, 0.0), at(-6.0, 5.5)]);
            bar(4.5);
        }
        Icon::Reset => {
            painter.add(Shape::line(arc(-0.6, 4.6), stroke));
            polygon(vec![at(0.5, -9.0), at(0.5, -2.0), at(-4.5, -5.5)]);
        }
        Icon::Undo | Icon::Redo => {
            let side = if icon == Icon::Undo { 1.0 } else { -1.0 };
            let turn = arc(-2.9, 1.2).into_iter().map(|p| pos2(center.x + side * (p.x - center.x), p.y));
            painter.add(Shape::line(turn.collect(), stroke));
            polygon([(-9.0, -2.0), (-2.0, -2.0), (-6.0, 3.0)].map(|(x, y)| at(side * x, y)).to_vec());
        }
        Icon::Theme => {
            painter.circle_stroke(center, 5.5, stroke);
            polygon(arc(-std::f32::consts::FRAC_PI_2, std::f32::consts::FRAC_PI_2));
        }
        Icon::Language => {
            painter.text(center, Align2::CENTER_CENTER, "中/EN", FontId::proportional(BODY), color);
        }
        Icon::Help => {
            painter.text(center, Align2::CENTER_CENTER, "?", FontId::proportional(BODY), color);
        }
        Icon::Panel => {
            painter.rect_stroke(Rect::from_center_size(center, vec2(14.0, 11.0)), 1.5, stroke, StrokeKind::Middle);
            painter.line_segment([at(2.5, -5.0), at(2.5, 5.0)], stroke);
        }
        Icon::Open => polygon(vec![at(-4.5, 2.5), at(0.0, -3.0), at(4.5, 2.5)]),
        Icon::Close => polygon(vec![at(-4.5, -2.5), at(4.5, -2.5), at(0.0, 3.0)]),
    }
}

/// Adds an entry of a picker: its name, and a description under it.
pub(crate) fn choice(ui: &mut Ui, palette: &Palette, selected: bool, id: &str, about: &str) -> Response {
    let id = tr(id);
    let color = if selected { palette.text } else { palette.secondary };
    let response = ui.add(Button::selectable(selected, described(id, tr(about), palette.text, color)).wrap());
    response.widget_info(|| WidgetInfo::selected(Role::Button, response.enabled(), selected, id));
    response
}

/// Lays out a name with a description under it, each in its colour.
pub(crate) fn described(name: &str, about: &str, color: egui::Color32, about_color: egui::Color32) -> LayoutJob {
    let format = |size: f32, color| TextFormat { font_id: FontId::proportional(size), color, ..Default::default() };
    let mut job = LayoutJob::default();
    job.append(name, 0.0, format(BODY, color));
    job.append("\n", 0.0, format(BODY, color));
    job.append(about, 0.0, format(SMALL, about_color));
    job
}

/// Returns a button for one of several options, or for on and off. It has a frame even if it is not selected.
pub(crate) fn option_button<'a>(chosen: bool, text: impl IntoAtoms<'a>) -> Button<'a> {
    Button::selectable(chosen, text).frame_when_inactive(true)
}

/// Shows a button for each option, with its name and description, in a row; returns the one that was clicked.
pub(crate) fn options<T: PartialEq>(
    ui: &mut Ui,
    offered: impl IntoIterator<Item = (T, impl AsRef<str>, impl AsRef<str>)>,
    shown: Option<T>,
) -> Option<T> {
    let mut clicked = None;
    for (option, word, tip) in offered {
        let button = option_button(shown.as_ref() == Some(&option), tr(word.as_ref()));
        if ui.add(button).on_hover_text(tr(tip.as_ref())).clicked() {
            clicked = Some(option);
        }
    }
    clicked
}

/// Shows controls at the right end of a row, from left to right: Tab goes through them in the order of reading, which a
/// layout from right to left reverses.
pub(crate) fn at_right(ui: &mut Ui, name: &str, show: impl FnOnce(&mut Ui)) {
    let id = egui::Id::unique(("at right", name));
    let width: f32 = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    ui.add_space((ui.available_width() - width).max(0.0));
    let shown = ui.scope(show).response.rect.width();
    if (shown - width).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(id, shown));
        ui.ctx().request_discard("at right");
    }
}
