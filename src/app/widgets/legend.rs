//! Legend marks, which show how each line over the body is drawn.

use egui::{Color32, Painter, Pos2, Rect, Stroke, StrokeKind, vec2};

/// Line style of a solution.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum LegendMark {
    Line,
    Dashes,
    Outline,
}

impl LegendMark {
    /// Width of every mark, points.
    pub(crate) const WIDTH: f32 = 18.0;

    /// Paints the mark to the right of the point `left`.
    pub(crate) fn paint(self, painter: &Painter, left: Pos2, color: Color32) {
        let stroke = Stroke::new(2.5, color);
        match self {
            Self::Line => _ = painter.line_segment([left, left + vec2(Self::WIDTH, 0.0)], stroke),
            Self::Dashes => {
                for x in [0.0, 7.0, 14.0] {
                    painter.line_segment([left + vec2(x, 0.0), left + vec2((x + 4.5).min(Self::WIDTH), 0.0)], stroke);
                }
            }
            Self::Outline => {
                let swatch = Rect::from_min_max(left - vec2(0.0, 4.0), left + vec2(Self::WIDTH, 4.0));
                painter.rect_stroke(swatch, 0.0, Stroke::new(1.0, color), StrokeKind::Inside);
            }
        }
    }
}
