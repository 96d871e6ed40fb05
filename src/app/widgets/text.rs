//! Text on a box, semibold text, the names of keys, and the sign for an unknown number.

use egui::{Align2, Color32, Context, FontId, Galley, Painter, Pos2, Rect, Vec2, Visuals, pos2, vec2};

use crate::app::prelude::*;
use crate::app::widgets::palette::BODY;

/// Sign in place of an unknown number.
pub(crate) const UNKNOWN: &str = "\u{2013}";

/// Returns a text with the names of keys on this system: Cmd in place of Ctrl on those of Apple.
pub(crate) fn with_keys(ctx: &Context, text: &str) -> String {
    if ctx.os().is_mac() { text.replace("Ctrl+", "Cmd+") } else { text.to_owned() }
}

/// Texts on boxes with the background's colour in the view of a painter; none covers another one or a taken area.
pub(crate) struct Labels<'a> {
    pub painter: &'a Painter,
    pub visuals: &'a Visuals,
    pub taken: Vec<Rect>,
}

impl<'a> Labels<'a> {
    pub(crate) fn new(painter: &'a Painter, visuals: &'a Visuals) -> Self {
        Self { painter, visuals, taken: Vec::new() }
    }

    /// Paints a text, in lines up to this width, at its place, moved into the view if it would leave it, or at the nearest
    /// free one beside what is there.
    pub(crate) fn add(&mut self, at: Pos2, anchor: Align2, text: &str, color: Color32, width: f32) {
        /// Space between a text and the border of its box, and between a text and what is beside it, points.
        const BOX: f32 = 4.0;
        const GAP: f32 = 2.5 * BOX;
        let Self { painter, visuals, taken } = self;
        let galley = painter.layout(text.to_owned(), FontId::proportional(BODY), color, width.max(40.0));
        let (size, view) = (galley.size(), painter.clip_rect().shrink(2.0 * BOX));
        let inside = |corner: Pos2| Rect::from_min_size(corner.clamp(view.min, (view.max - size).max(view.min)), size);
        let own = inside(anchor.anchor_size(at, size).min);
        let beside = taken.iter().flat_map(|other| {
            let [before, after] = [other.min - size - Vec2::splat(GAP), other.max + Vec2::splat(GAP)];
            [before, after].into_iter().flat_map(|to| [pos2(to.x, own.min.y), pos2(own.min.x, to.y)])
        });
        let is_free = |rect: &Rect| taken.iter().all(|other| !other.expand(BOX).intersects(rect.expand(BOX)));
        let distance = |rect: &Rect| rect.min.distance_sq(own.min);
        let nearest = || beside.map(inside).filter(is_free).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let rect = Some(own).filter(is_free).or_else(nearest).unwrap_or(own);
        painter.rect_filled(rect.expand(BOX), BOX, visuals.extreme_bg_color.gamma_multiply(0.85));
        painter.galley(rect.min, galley, color);
        taken.push(rect);
    }
}

/// Paints semibold text with a font that has only one weight: drawn twice, 0.45 points apart.
pub(crate) fn semibold(painter: &Painter, at: Pos2, galley: &Arc<Galley>, color: Color32) {
    for shift in [0.0, 0.45] {
        painter.galley(at + vec2(shift, 0.0), galley.clone(), color);
    }
}
