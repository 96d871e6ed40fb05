//! Buttons with icons, option buttons, and entries of pickers.

use egui::text::LayoutJob;
use egui::{Button, Color32, FontId, IntoAtoms, Response, Role, Sense, StrokeKind, TextFormat, Ui, WidgetInfo, vec2};

use crate::app::language::tr;
use crate::app::widgets::palette::{BODY, Palette, SMALL};

/// Icon of a button: a text in a font, painted with its middle in the middle of the icon's place.
pub(crate) type Icon = (&'static str, FontId);

/// Icons of buttons. Only egui's monospaced font has arrows and geometric shapes: they are escaped here, because letters in
/// the sources have to be in both fonts.
pub(crate) mod icon {
    use super::{BODY, FontId, Icon};

    pub(crate) const RUN: Icon = ("\u{25b6}", FontId::monospace(18.0)); // ▶
    pub(crate) const PAUSE: Icon = ("\u{25ae}\u{25ae}", FontId::monospace(14.0)); // ▮▮
    pub(crate) const STEP: Icon = ("\u{25b6}\u{25ae}", FontId::monospace(13.0)); // ▶▮
    pub(crate) const RESET: Icon = ("\u{21ba}", FontId::monospace(24.0)); // ↺
    pub(crate) const UNDO: Icon = ("\u{21a9}", FontId::monospace(26.0)); // ↩
    pub(crate) const REDO: Icon = ("\u{21aa}", FontId::monospace(26.0)); // ↪
    pub(crate) const PANEL: Icon = ("\u{25e8}", FontId::monospace(22.0)); // ◨
    pub(crate) const LANGUAGE: Icon = ("中/EN", FontId::proportional(BODY));
    pub(crate) const THEME: Icon = ("\u{25d1}", FontId::monospace(22.0)); // ◑
    pub(crate) const HELP: Icon = ("?", FontId::proportional(BODY));
    pub(crate) const OPEN: Icon = ("\u{25b2}", FontId::monospace(14.0)); // ▲
    pub(crate) const CLOSE: Icon = ("\u{25bc}", FontId::monospace(14.0)); // ▼
}

/// Adds a button with an icon, followed by a word if one is given. `name` is its name for screen readers.
pub(crate) fn icon_button(ui: &mut Ui, icon: Icon, name: &str, word: Option<&str>, chosen: bool) -> Response {
    const SIDE: f32 = 28.0;
    const WIDE: f32 = 52.0;
    const GAP: f32 = 5.0;
    const PADDING: f32 = 8.0;
    const ICON: f32 = 14.0;
    const WORD: f32 = 38.0; // of Run and Pause, so that nothing moves
    let layout = |text: &str, font| ui.painter().layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER);
    let least = if [icon::RUN, icon::PAUSE].contains(&icon) { WORD } else { 0.0 };
    let side = if icon == icon::LANGUAGE { WIDE } else { SIDE };
    let word = word.map(|word| layout(word, FontId::proportional(BODY)));
    let mark = layout(icon.0, icon.1);
    let width = word.as_ref().map_or(side, |word| 2.0 * PADDING + ICON + GAP + word.size().x.max(least));
    let (rect, response) = ui.allocate_exact_size(vec2(width, ui.spacing().interact_size.y), Sense::click());
    let style = ui.style().interact_selectable(&response, chosen);
    ui.painter().rect(rect, style.corner_radius, style.weak_bg_fill, style.bg_stroke, StrokeKind::Inside);
    let (color, left) = (style.fg_stroke.color, rect.left_center() + vec2(PADDING, 0.0));
    let middle = if word.is_some() { left + vec2(0.5 * ICON, 0.0) } else { rect.center() };
    ui.painter().galley(middle - mark.mesh_bounds.center().to_vec2(), mark, color);
    if let Some(word) = word {
        ui.painter().galley(left + vec2(ICON + GAP, -0.5 * word.size().y), word, color);
    }
    response.widget_info(|| WidgetInfo::selected(Role::Button, response.enabled(), chosen, name));
    response
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
pub(crate) fn described(name: &str, about: &str, color: Color32, about_color: Color32) -> LayoutJob {
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
