//! Charts of the library, painted in the window in the colours of its theme.

use egui::epaint::TextShape;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, vec2};

use crate::app::widgets::palette::{Palette, SMALL};
use crate::app::widgets::text::Labels;
use crate::plot::{Anchor, ChartFrame, DrawTarget};
use crate::study::figure::Ink;

/// Paints charts in the window, from an upper left corner.
pub(crate) struct ChartPainter {
    corner: Pos2,
    palette: Palette,
    painter: Painter,
    /// Area to which the painter is clipped by the window.
    whole: Rect,
}

impl ChartPainter {
    pub(crate) fn new(ui: &Ui, corner: Pos2) -> Self {
        let painter = ui.painter().clone();
        Self { corner, palette: Palette::new(ui.visuals()), whole: painter.clip_rect(), painter }
    }

    fn place(&self, [x, y]: [f64; 2]) -> Pos2 {
        self.corner + vec2(x as f32, y as f32)
    }

    fn places(&self, points: &[[f64; 2]]) -> Vec<Pos2> {
        points.iter().map(|point| self.place(*point)).collect()
    }

    fn area(&self, [corner, [width, height]]: [[f64; 2]; 2]) -> Rect {
        Rect::from_min_size(self.place(corner), vec2(width as f32, height as f32))
    }

    fn stroke(&self, ink: Ink, width: f64) -> Stroke {
        Stroke::new(width as f32, self.palette.ink(ink))
    }
}

impl DrawTarget for ChartPainter {
    fn line(&mut self, points: &[[f64; 2]], ink: Ink, width: f64, dashes: &[f64]) {
        let (places, stroke) = (self.places(points), self.stroke(ink, width));
        if let &[dash, gap] = dashes {
            self.painter.extend(Shape::dashed_line(&places, stroke, dash as f32, gap as f32));
            return;
        }
        // The joints of a thick line stick out at sharp corners, so that each segment is painted alone.
        for pair in places.windows(2) {
            self.painter.line_segment([pair[0], pair[1]], stroke);
        }
    }

    fn polygon(&mut self, points: &[[f64; 2]], ink: Ink, opacity: f64) {
        let color = self.palette.ink(ink).gamma_multiply(opacity as f32);
        self.painter.add(Shape::convex_polygon(self.places(points), color, Stroke::NONE));
    }

    fn circle(&mut self, middle: [f64; 2], radius: f64, ink: Ink, outline: Option<f64>) {
        let fill = if outline.is_some() { Color32::TRANSPARENT } else { self.palette.ink(ink) };
        let stroke = outline.map_or(Stroke::NONE, |width| self.stroke(ink, width));
        self.painter.circle(self.place(middle), radius as f32, fill, stroke);
    }

    fn rect(&mut self, corner_and_size: [[f64; 2]; 2], ink: Ink, opacity: f64) {
        let color = self.palette.ink(ink).gamma_multiply(opacity as f32);
        self.painter.rect_filled(self.area(corner_and_size), 0.0, color);
    }

    fn text(&mut self, at: [f64; 2], anchor: Anchor, ink: Ink, text: &str) {
        let (at, color, font) = (self.place(at), self.palette.ink(ink), FontId::proportional(SMALL));
        let galley = self.painter.layout_no_wrap(text.to_owned(), font, color);
        let base = galley.rows.first().and_then(|row| row.glyphs.first()).map_or(0.0, |glyph| glyph.pos.y);
        let width = galley.size().x;
        let (corner, angle) = match anchor {
            Anchor::Start => (at - vec2(0.0, base), 0.0),
            Anchor::Middle => (at - vec2(0.5 * width, base), 0.0),
            Anchor::End => (at - vec2(width, base), 0.0),
            Anchor::Upright => (at + vec2(-base, 0.5 * width), -std::f32::consts::FRAC_PI_2),
        };
        self.painter.add(TextShape::new(corner, galley, color).with_angle(angle));
    }

    fn clip(&mut self, corner_and_size: Option<[[f64; 2]; 2]>) {
        let area = corner_and_size.map_or(self.whole, |area| self.area(area).intersect(self.whole));
        self.painter.set_clip_rect(area);
    }
}

/// Takes the rest of the area for a chart without title and legend; returns its response, frame and painter.
pub(crate) fn area(ui: &mut Ui) -> (Response, ChartFrame, ChartPainter) {
    let response = ui.allocate_response(ui.available_size(), Sense::CLICK);
    let size = [response.rect.width(), response.rect.height()].map(f64::from);
    let frame = ChartFrame { size, across: [68.0, size[0] - 16.0], up: [size[1] - 40.0, 8.0], edge: 0.0 };
    let mut painter = ChartPainter::new(ui, response.rect.min);
    painter.rect(frame.area(), Ink::Paper, 1.0);
    (response, frame, painter)
}

/// Marks the nearest place of a chart to which the pointer points, with a text above it; returns what is there.
pub(crate) fn hover<T>(
    ui: &Ui,
    response: &Response,
    places: impl Iterator<Item = ([f64; 2], T)>,
    text: impl Fn(&T) -> String,
) -> Option<T> {
    /// Largest distance of the pointer, points.
    const NEAR: f32 = 12.0;
    let (pointer, whole) = (response.hover_pos()?, response.rect);
    let places = places.map(|([x, y], value)| (whole.min + vec2(x as f32, y as f32), value));
    let nearest = places.min_by(|a, b| a.0.distance_sq(pointer).total_cmp(&b.0.distance_sq(pointer)));
    let (at, value) = nearest.filter(|(at, _)| at.distance(pointer) <= NEAR)?;
    let (painter, color) = (ui.painter_at(whole), ui.visuals().text_color());
    painter.circle_stroke(at, 5.0, Stroke::new(1.5, color));
    let above = at - vec2(0.0, 10.0);
    Labels::new(&painter, ui.visuals()).add(above, Align2::CENTER_BOTTOM, &text(&value), color, whole.width());
    Some(value)
}
