//! Legend marks, which show how each line over the body is drawn, and entries of the keys of plots.

use egui::{Color32, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2};

use crate::app::widgets::palette::SMALL;

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
        let (ends, stroke) = ([left, left + vec2(Self::WIDTH, 0.0)], Stroke::new(2.5, color));
        match self {
            Self::Line => _ = painter.line_segment(ends, stroke),
            Self::Dashes => painter.extend(Shape::dashed_line(&ends, stroke, 4.5, 2.5)),
            Self::Outline => {
                let swatch = Rect::from_min_max(left - vec2(0.0, 4.0), left + vec2(Self::WIDTH, 4.0));
                painter.rect_stroke(swatch, 0.0, Stroke::new(1.0, color), StrokeKind::Inside);
            }
        }
    }
}

/// Shows an entry of a key: a mark of this size, which `paint` paints in its area, and a name after it. A line breaks
/// between entries.
pub(crate) fn entry(ui: &mut Ui, name: &str, mark: Vec2, paint: &dyn Fn(&Ui, Rect)) {
    const GAP: f32 = 5.0;
    /// Height of an entry, points.
    const LINE: f32 = 18.0;
    let (font, ink) = (FontId::proportional(SMALL), ui.visuals().text_color());
    let galley = ui.painter().layout_no_wrap(name.to_owned(), font, ink);
    let (rect, response) = ui.allocate_exact_size(vec2(mark.x + GAP + galley.size().x, LINE), Sense::hover());
    paint(ui, Rect::from_center_size(rect.left_center() + vec2(0.5 * mark.x, 0.0), mark));
    ui.painter().galley(rect.left_center() + vec2(mark.x + GAP, -0.5 * galley.size().y), galley, ink);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, name));
}
