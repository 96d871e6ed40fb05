//! Time line under a body in motion: the recorded seconds, with a knob at the displayed moment.

use egui::{CursorIcon, EventFilter};

use crate::app::interface::*;
use crate::app::viewport::bars::{LEGEND_WIDTH, SCALE_BAR_LEFT, has_legend, scale};

/// Shortest line, points; a view that has no room for it has none.
const SHORTEST: f32 = 80.0;
/// Distance above and below the line within which it reacts to the pointer, points.
const REACH: f32 = 10.0;

/// Shows the line of a motion with a recorded past; `now` is the displayed simulated time, s.
pub(crate) fn show(ui: &Ui, view: Rect, camera: &Camera, (playback, now): (&Playback, f64), actions: &mut Vec<Action>) {
    // Between the scale bar and the colour bar, if that is at the bottom.
    let left = view.left() + SCALE_BAR_LEFT + scale(camera).1 + 24.0;
    let right = view.right() - if has_legend(view.size()) { LEGEND_WIDTH } else { 18.0 };
    let line = Rect::from_min_max(pos2(left, view.bottom() - 20.0), pos2(right, view.bottom() - 20.0));
    let Some([first, last]) = playback.span().filter(|_| line.width() >= SHORTEST) else { return };
    let last = last.max(now);
    let id = egui::Id::unique("time line");
    let response = ui.interact(line.expand2(vec2(8.0, REACH)), id, Sense::click_and_drag());
    let hint = "The last seconds: drag back to see them again; Run continues from there (keys: comma and full stop)";
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal).on_hover_text(tr(hint));
    if let (true, Some(at)) = (response.is_pointer_button_down_on(), response.interact_pointer_pos()) {
        let part = f64::from((at.x - line.left()) / line.width()).clamp(0.0, 1.0);
        actions.push(Action::Scrub(first + part * (last - first)));
    }
    if response.has_focus() {
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        let pressed = |key| ui.input(|i| i.key_pressed(key));
        actions.extend(pressed(Key::ArrowLeft).then_some(Action::Back));
        actions.extend(pressed(Key::ArrowRight).then_some(Action::Forward));
    }
    response.widget_info(|| WidgetInfo::slider(true, now, tr("Timeline")));

    let palette = Palette::new(ui.visuals());
    let painter = ui.painter_at(view);
    let is_past = playback.shown.is_some();
    let x = line.left() + line.width() * ((now - first) / (last - first)).clamp(0.0, 1.0) as f32;
    let y = line.center().y;
    let hot = response.hovered() || response.has_focus() || response.dragged();
    painter.hline(line.x_range(), y, Stroke::new(1.5, palette.line));
    painter.hline(line.left()..=x, y, Stroke::new(1.5, palette.secondary));
    let color = if hot || is_past { palette.text } else { palette.secondary };
    painter.circle_filled(pos2(x, y), if hot || is_past { 6.0 } else { 4.0 }, color);
    if is_past {
        let text = format!("\u{2212}{:.2} s", last - now);
        let font = FontId::proportional(SMALL);
        let at = pos2(x.clamp(line.left() + 20.0, line.right() - 20.0), y - 9.0);
        painter.text(at, Align2::CENTER_BOTTOM, text, font, palette.text);
    }
}
