//! Painting of the arrows of loads, with their grips and labels.

use std::f64::consts::TAU;

use crate::app::interface::*;
use crate::app::viewport::arrow::{ArrowShape, Drag, LoadArrow, NEAR, PITCH, RADIUS};

impl LoadArrow {
    /// Paints the arrow with its value next to it; as an outline, or a thin arc, if the body does not have this load.
    pub(crate) fn paint(&self, labels: &mut Labels<'_>, color: Color32, (is_hot, is_outline): (bool, bool)) {
        /// Size of the areas along an arrow that stay free of labels, and distance between them, points.
        const GRIP: Vec2 = Vec2::splat(8.0);
        const STEP: f32 = 12.0;
        let (tip, vector, view) = (self.tip(), self.vector(), labels.painter.clip_rect());
        let color = if self.value == 0.0 && !is_hot { color.gamma_multiply(0.55) } else { color };
        let along = self.paint_shape(labels, color, is_outline);
        let grip = match self.shape {
            ArrowShape::Straight { .. } => tip - along * 6.0,
            ArrowShape::Arc => tip + along * 3.0,
        };
        paint_grip(labels.painter, grip, color, is_hot);
        if !(view.contains(self.from) || view.contains(tip)) {
            return;
        }
        let (anchor, at, unit) = match self.shape {
            ArrowShape::Straight { .. } => {
                let lengths = (0..).map(|i| STEP * i as f32).take_while(|length| *length < vector.length());
                let places = lengths.map(|length| self.from + along * length).chain([grip]);
                labels.taken.extend(places.map(|at| Rect::from_center_size(at, GRIP)));
                let (anchor, at) = label_place(tip, along);
                (anchor, at, "N")
            }
            ArrowShape::Arc => {
                let below = RADIUS + PITCH * (self.sweep().abs() / TAU).ceil() + 12.0;
                (Align2::CENTER_TOP, self.from + vec2(0.0, below as f32), "N m")
            }
        };
        labels.add(at, anchor, &engineering(self.value, unit), color, 200.0);
    }

    /// Paints the arrow alone, and returns its direction at the tip.
    pub(crate) fn paint_shape(&self, labels: &Labels<'_>, color: Color32, is_outline: bool) -> Vec2 {
        /// Length of the head of an arc, points.
        const HEAD: f32 = 11.0;
        let painter = labels.painter;
        match self.shape {
            ArrowShape::Straight { vector, .. } => {
                paint_arrow(painter, self.from, vector, color, is_outline);
                if self.is_broken() {
                    paint_break(labels, self.from, vector, color);
                }
                vector.normalized()
            }
            ArrowShape::Arc => {
                let sweep = self.sweep();
                painter.add(self.arc(sweep, Stroke::new(if is_outline { 1.0 } else { 3.0 }, color)));
                let (end, along) = self.at(sweep);
                let along = along * sweep.signum() as f32;
                let across = vec2(-along.y, along.x) * (HEAD * 0.5);
                let head = vec![end + along * HEAD, end + across, end - across];
                painter.add(Shape::convex_polygon(head, color, Stroke::NONE));
                along
            }
        }
    }

    /// Paints the dragged arrow at the position where its tip was grabbed.
    pub(crate) fn paint_dragged(&self, painter: &Painter, drag: Drag, color: Color32) {
        let stroke = Stroke::new(1.5, color.gamma_multiply(0.8));
        let (line, tip) = match self.shape {
            ArrowShape::Straight { .. } => {
                let tip = self.tip() + drag.by;
                (Shape::Vec(Shape::dashed_line(&[self.from, tip], stroke, 5.0, 4.0)), tip)
            }
            ArrowShape::Arc => {
                let sweep = self.sweep() + drag.angle;
                (self.arc(sweep, stroke), self.at(sweep).0)
            }
        };
        painter.add(line);
        painter.circle_stroke(self.from, 3.0, stroke);
        painter.circle(tip, 7.0, color.gamma_multiply(0.35), Stroke::new(2.0, color));
    }

    /// Returns the line of a circular arrow with the angle `sweep`, rad.
    fn arc(&self, sweep: f64, stroke: Stroke) -> Shape {
        /// Length of a segment of the arc, rad, and largest number of segments.
        const PIECE: f64 = 0.15;
        const MAX_PIECES: f64 = 400.0;
        let pieces = (sweep.abs() / PIECE).ceil().clamp(1.0, MAX_PIECES);
        let points = (0..=pieces as u32).map(|i| self.at(sweep * f64::from(i) / pieces).0);
        Shape::line(points.collect(), stroke)
    }
}

/// Paints the gap of a shaft that is shorter than its force.
fn paint_break(labels: &Labels<'_>, from: Pos2, vector: Vec2, color: Color32) {
    /// Fraction of the vector at which the shaft is broken.
    const AT: f32 = 0.3;
    let direction = vector.normalized();
    let (middle, slanted) = (from + AT * vector, (direction.rot90() + 0.6 * direction) * 7.0);
    let ends = |at: Pos2| [at - slanted, at + slanted];
    labels.painter.line_segment(ends(middle), Stroke::new(5.0, labels.visuals.extreme_bg_color));
    for side in [middle - direction * 2.5, middle + direction * 2.5] {
        labels.painter.line_segment(ends(side), Stroke::new(1.5, color));
    }
}

/// Returns the position of an arrow's label: beyond its tip, or above the tip of a nearly horizontal arrow, so that it
/// does not cover the arrow.
fn label_place(tip: Pos2, direction: Vec2) -> (Align2, Pos2) {
    /// Sine of 22.5 degrees: directions closer to an axis count as horizontal or vertical.
    const SLIGHT: f32 = 0.383;
    if direction.y.abs() < SLIGHT {
        return (Align2::CENTER_BOTTOM, tip - direction * 20.0 - vec2(0.0, 15.0));
    }
    let across = match direction.x {
        x if x.abs() < SLIGHT => Align::Center,
        x if x > 0.0 => Align::Min,
        _ => Align::Max,
    };
    let down = if direction.y > 0.0 { Align::Min } else { Align::Max };
    (Align2([across, down]), tip + vec2(6.0 * direction.x, 11.0 * direction.y.signum()))
}

/// Paints the ring that shows where an arrow can be grabbed; filled while the pointer is over it.
fn paint_grip(painter: &Painter, at: Pos2, color: Color32, is_hot: bool) {
    if is_hot {
        painter.circle(at, NEAR, color.gamma_multiply(0.25), Stroke::new(2.0, color));
    } else {
        painter.circle_stroke(at, 8.5, Stroke::new(1.0, color.gamma_multiply(0.6)));
    }
}

/// Length of the head of an arrow, and its half width, points.
const HEAD: [f32; 2] = [12.0, 5.04];

/// Paints an arrow with the vector `vector` at `from`, or its outline, and returns its tip.
pub(crate) fn paint_arrow(painter: &Painter, from: Pos2, vector: Vec2, color: Color32, is_outline: bool) -> Pos2 {
    /// Half width of the shaft of an outline as a fraction of that of the head.
    const SHAFT: f32 = 0.45;
    let (tip, direction, [length, width]) = (from + vector, vector.normalized(), HEAD);
    let (neck, side) = (tip - direction * length, vec2(-direction.y, direction.x) * width);
    if is_outline {
        let shaft = SHAFT * side;
        let line = [from + shaft, neck + shaft, neck + side, tip, neck - side, neck - shaft, from - shaft];
        painter.add(Shape::closed_line(line.to_vec(), Stroke::new(1.5, color)));
    } else {
        painter.line_segment([from, neck], Stroke::new(3.0, color));
        painter.add(Shape::convex_polygon(vec![tip, neck + side, neck - side], color, Stroke::NONE));
    }
    tip
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The label does not cover the arrow, whatever the direction and length.
    #[test]
    fn labels_do_not_cover_arrows() {
        let size = vec2(48.0, 17.0);
        for degrees in 0..360u16 {
            let direction = Vec2::angled(f32::from(degrees).to_radians());
            for length in [22.0, 60.0, 150.0] {
                let tip = Pos2::ZERO + direction * length;
                let (anchor, at) = label_place(tip, direction);
                let label = anchor.anchor_size(at, size);
                let covers = (0..=100u8).map(|i| Pos2::ZERO + direction * (length * f32::from(i) / 100.0));
                let covers = covers.filter(|p| label.expand(2.0).contains(*p)).count();
                assert_eq!(covers, 0, "{degrees} degrees, {length} points: {label:?}");
            }
        }
    }
}
