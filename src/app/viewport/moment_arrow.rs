//! Circular arrow of a moment: its angle, the position of its end, and the moment that a dragged end sets.

use std::f64::consts::TAU;

use crate::app::interface::*;
use crate::app::viewport::arrow::{Arrow, MIN_SPAN, paint_grip, power_of_ten_above};

/// Radius at the start of the arrow, points; it grows by the pitch with every revolution, so that revolutions do not
/// overlap.
const RADIUS: f64 = 24.0;
const PITCH: f64 = 9.0;
/// Angle of the arrow of a zero moment, rad.
const STUB: f64 = TAU / 12.0;
/// Angle of the arrow of the moment that the scene opens with, rad. One pixel along its arc is 1.5 % of the moment.
const OPENING: f64 = 0.375 * TAU;
/// Additional angle per factor of ten above twice the opening moment, rad.
const DECADE: f64 = TAU / 4.0;
/// Angle in the plane at which the arrow starts, rad.
const START: f64 = TAU / 8.0;
/// Radius around the centre, in points, inside which the pointer's angle is ignored.
const MIDDLE: f32 = 5.0;

/// Returns the moments, N m, that scale the arrows and sliders of a scene: the largest opening moment and the largest
/// moment of sliders. The second rolls the rest shape up once, rounded up to a power of ten. For a scene without moments
/// the first is about a tenth of that moment, or of the moment of the largest opening force about the other end of the
/// body, if that is smaller.
pub(crate) fn moment_range(opening: OpeningLoads, material: &Material, system: &System) -> [f64; 2] {
    let [length, height] = system.strip();
    // 2πEI/L with I = t h³/12.
    let rolling = TAU * material.young * material.thickness * height.powi(3) / (12.0 * length);
    let of_force = opening.force.map_or(f64::INFINITY, |force| force * length);
    let usual = opening.moment.unwrap_or_else(|| round_down(0.1 * rolling.min(of_force)));
    [usual, power_of_ten_above(rolling).max(MIN_SPAN * usual)]
}

/// Circular arrow of a moment, in window coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MomentArrow {
    /// Index of the moment among the scene's loads.
    pub load: usize,
    pub center: Pos2,
    /// Moment, N m, counter-clockwise.
    moment: f64,
    scale: LoadScale,
}

impl MomentArrow {
    /// Creates the arrow of a moment, N m, in a scene that opens with moments up to `usual`, N m.
    pub(crate) fn new(load: usize, center: Pos2, moment: f64, usual: f64) -> Self {
        let scale = LoadScale { usual, stub: STUB, opening: OPENING, straight: STRAIGHT, decade: DECADE };
        Self { load, center, moment, scale }
    }

    /// Returns the angle of the arrow, rad, counter-clockwise.
    fn sweep(&self) -> f64 {
        let size = self.scale.length(self.moment.abs());
        if self.moment < 0.0 { -size } else { size }
    }

    /// Returns the moment, N m, of an arrow with the angle `sweep`, rad.
    fn moment_of(&self, sweep: f64) -> f64 {
        sweep.signum() * self.scale.load(sweep.abs())
    }

    /// Returns the point of the arrow at the angle `sweep`, rad, from its start, and the counter-clockwise tangent
    /// there.
    fn at(&self, sweep: f64) -> (Pos2, Vec2) {
        let radius = (RADIUS + PITCH * sweep.abs() / TAU) as f32;
        let (s, c) = (START + sweep).sin_cos();
        // The window's y axis points down.
        let outward = vec2(c as f32, -s as f32);
        (self.center + outward * radius, vec2(outward.y, -outward.x))
    }

    /// Returns the end of the arrow.
    pub(crate) fn tip(&self) -> Pos2 {
        self.at(self.sweep()).0
    }

    /// Returns the angle by which a pointer that moves between two points rotates about the centre, rad,
    /// counter-clockwise.
    pub(crate) fn angle_between(&self, from: Pos2, to: Pos2) -> f64 {
        let [from, to] = [from, to].map(|p| p - self.center);
        if from.length() < MIDDLE || to.length() < MIDDLE {
            return 0.0;
        }
        f64::from(to.x * from.y - to.y * from.x).atan2(f64::from(from.dot(to)))
    }

    /// Returns the moment, N m, after the end has been rotated by `by`, rad, counter-clockwise. The number is rounded
    /// to the pointer's accuracy, or, with `snap`, to 1, 2 or 5 times a power of ten.
    pub(crate) fn dragged(&self, by: f64, snap: bool) -> f64 {
        let moment = self.moment_of(self.sweep() + by);
        let size = moment.abs();
        if !snap || size == 0.0 {
            return three_digits(moment);
        }
        // The reciprocals of the series 1, 2, 5 are the same series.
        let (below, above) = (round_down(size), 1.0 / round_down(1.0 / size));
        let nearest = if size * size < below * above { below } else { above };
        three_digits(nearest.copysign(moment))
    }

    /// Paints the arrow with its moment below it, or above it if one of these force arrows is below; thin if the body does
    /// not have this load.
    pub(crate) fn paint(
        &self,
        labels: &mut Labels<'_>,
        color: Color32,
        (is_hot, is_outline): (bool, bool),
        forces: &[Arrow],
    ) {
        let (painter, sweep) = (labels.painter, self.sweep());
        let faint = if self.moment == 0.0 && !is_hot { color.gamma_multiply(0.55) } else { color };
        let (end, along) = self.paint_arrow(painter, faint, if is_outline { 1.0 } else { 3.0 });
        paint_grip(painter, end + along * 3.0, faint, is_hot);
        let below = (RADIUS + PITCH * (sweep.abs() / TAU).ceil() + 12.0) as f32;
        let label = engineering(self.moment, "N m");
        let is_crossed = |arrow: &Arrow| (arrow.from - self.center).length() < below && arrow.vector.y > 0.0;
        let (side, anchor) = match forces.iter().any(is_crossed) {
            true => (-1.0, Align2::CENTER_BOTTOM),
            false => (1.0, Align2::CENTER_TOP),
        };
        labels.add(self.center + vec2(0.0, side * below), anchor, &label, faint, 200.0);
    }

    /// Paints the arc with a line of this width, points, and its head; returns the end of the arc and its direction.
    pub(crate) fn paint_arrow(&self, painter: &Painter, color: Color32, width: f32) -> (Pos2, Vec2) {
        const HEAD: f32 = 11.0;
        let sweep = self.sweep();
        self.paint_arc(painter, sweep, Stroke::new(width, color));
        let (end, along) = self.at(sweep);
        let along = along * sweep.signum() as f32;
        let across = vec2(-along.y, along.x) * (HEAD * 0.5);
        painter.add(Shape::convex_polygon(vec![end + along * HEAD, end + across, end - across], color, Stroke::NONE));
        (end, along)
    }

    /// Paints the dragged arrow at the position where its end was grabbed.
    pub(crate) fn paint_handle(&self, painter: &Painter, by: f64, color: Color32) {
        let stroke = Stroke::new(1.5, color.gamma_multiply(0.8));
        let sweep = self.sweep() + by;
        self.paint_arc(painter, sweep, stroke);
        painter.circle_stroke(self.center, 3.0, stroke);
        painter.circle(self.at(sweep).0, 7.0, color.gamma_multiply(0.35), Stroke::new(2.0, color));
    }

    fn paint_arc(&self, painter: &Painter, sweep: f64, stroke: Stroke) {
        /// Length of a segment of the arc, rad, and largest number of segments.
        const PIECE: f64 = 0.15;
        const MAX_PIECES: f64 = 400.0;
        let pieces = (sweep.abs() / PIECE).ceil().clamp(1.0, MAX_PIECES);
        let points = (0..=pieces as u32).map(|i| self.at(sweep * f64::from(i) / pieces).0);
        painter.add(Shape::line(points.collect(), stroke));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrow(moment: f64) -> MomentArrow {
        MomentArrow::new(0, egui::pos2(100.0, 100.0), moment, 1e4)
    }

    /// The mapping is its own inverse for both senses of rotation; twice the opening angle is twice the moment.
    #[test]
    fn the_angle_of_the_arrow_is_proportional_to_the_moment() {
        for moment in [0.0, 1e-3, -1.0, 12.0, -500.0, 3e4, 1e5, -1e7] {
            let back = arrow(moment).moment_of(arrow(moment).sweep());
            assert!((back - moment).abs() <= 1e-9 * (moment.abs() + 1e-3), "{moment} {back}");
        }
        assert!((arrow(2e4).sweep() - 2.0 * arrow(1e4).sweep()).abs() < 1e-12);
        assert!((arrow(-1e4).sweep() + arrow(1e4).sweep()).abs() < 1e-12);
        assert_eq!(arrow(0.0).moment_of(0.0), 0.0);
    }

    /// A drag by one pixel along the arc changes the moment by 1 to 2 % of the moment at which the scene was opened.
    #[test]
    fn a_pixel_is_one_or_two_percent_of_the_moment() {
        let arrow = arrow(1e4);
        let radius = RADIUS + PITCH * arrow.sweep() / TAU;
        let rate = (arrow.moment_of(arrow.sweep() + 1.0 / radius) / 1e4) - 1.0;
        assert!((0.01..=0.02).contains(&rate), "{rate}");
    }

    #[test]
    fn a_dragged_end_gives_round_numbers_and_shift_snaps() {
        let arrow = arrow(1e4);
        assert_eq!(arrow.dragged(0.0, false), 1e4);
        assert_eq!(arrow.dragged(arrow.sweep(), false), 2e4);
        // Dragging back through zero changes the sign.
        assert_eq!(arrow.dragged(-arrow.sweep(), false), 0.0);
        assert!((arrow.dragged(-2.0 * arrow.sweep(), false) / -1e4 - 1.0).abs() < 0.01);
        for by in [-4.0, -1.0, -0.3, 0.1, 0.4, 0.8] {
            let moment = arrow.dragged(by, true);
            let digits = format!("{moment:e}");
            let first = digits.trim_start_matches('-').split('e').next().unwrap();
            assert!(moment == 0.0 || ["1", "2", "5"].contains(&first), "{by}: {moment}");
        }
    }

    /// The window's y axis points down: moving up on the right side is counter-clockwise.
    #[test]
    fn a_pointer_rotates_about_the_centre() {
        let (right, above) = (egui::pos2(130.0, 100.0), egui::pos2(100.0, 70.0));
        assert!((arrow(1.0).angle_between(right, above) - TAU / 4.0).abs() < 1e-6);
        assert!((arrow(1.0).angle_between(above, right) + TAU / 4.0).abs() < 1e-6);
        assert_eq!(arrow(1.0).angle_between(egui::pos2(101.0, 100.0), above), 0.0);
        let end = arrow(1e4).tip();
        let by = arrow(1e4).angle_between(end, arrow(5e4).tip());
        assert_eq!(arrow(1e4).dragged(by, false), 5e4);
    }
}
