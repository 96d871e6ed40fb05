//! Text on a box, semibold text, the names of keys, and the sign for an unknown number.

use std::sync::Arc;

use egui::{Align2, Color32, Context, FontId, Galley, Painter, Pos2, Rect, Vec2, Visuals, vec2};

use crate::app::widgets::palette::BODY;

/// Sign in place of an unknown number.
pub(crate) const UNKNOWN: &str = "\u{2013}";

/// Returns a text with the names of keys on this system: Cmd in place of Ctrl on those of Apple.
pub(crate) fn with_keys(ctx: &Context, text: &str) -> String {
    if ctx.os().is_mac() { text.replace("Ctrl+", "Cmd+") } else { text.to_owned() }
}

/// Paints text on a box with the background's colour, moved into the view if it would leave it.
pub(crate) fn boxed_text(
    painter: &Painter,
    at: Pos2,
    anchor: Align2,
    text: &str,
    visuals: &Visuals,
    color: Color32,
    width: f32,
) {
    let galley = painter.layout(text.to_owned(), FontId::proportional(BODY), color, width.max(40.0));
    let view = painter.clip_rect().shrink(8.0);
    let wanted = anchor.anchor_size(at, galley.size());
    let corner = wanted.min.clamp(view.min, (view.max - galley.size()).max(view.min));
    let rect = Rect::from_min_size(corner, galley.size());
    painter.rect_filled(rect.expand(4.0), 4.0, visuals.extreme_bg_color.gamma_multiply(0.85));
    painter.galley(rect.min, galley, color);
}

/// Returns the size of a text on a box in one line.
pub(crate) fn text_size(painter: &Painter, text: &str) -> Vec2 {
    painter.layout_no_wrap(text.to_owned(), FontId::proportional(BODY), Color32::PLACEHOLDER).size()
}

/// Paints semibold text with a font that has only one weight: drawn twice, 0.45 points apart.
pub(crate) fn semibold(painter: &Painter, at: Pos2, galley: &Arc<Galley>, color: Color32) {
    for shift in [0.0, 0.45] {
        painter.galley(at + vec2(shift, 0.0), galley.clone(), color);
    }
}
