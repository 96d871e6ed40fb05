//! Arrows of forces and moments: their size, the position of their tip, and the load that a dragged tip sets.

use std::f64::consts::TAU;

use crate::app::interface::*;
use crate::app::viewport::projection::DrawnBody;
use crate::format::rounded;

/// Smallest length that is drawn, points: long enough to be grabbed.
const STUB: f64 = 16.0;
/// Length of the arrow of the force that the scene opens with, points, in small views and in large ones. Dragging the
/// tip by one pixel changes the force by 1 to 2 %.
const OPENING: [f64; 2] = [50.0, 72.0];
/// Opening length as a fraction of the shorter side of the view, limited by the range above.
const SHARE: f64 = 0.12;
/// Length, in opening lengths, above which an arrow ends at the border of the view.
const WHOLE: f64 = 2.0;
/// Distance of such an arrow's tip from the border at the sides, and above and below, points: room for its label and for
/// the colour bar. In a low view it is at most a quarter of the height.
const BORDER: Vec2 = vec2(40.0, 80.0);
/// Distance of every tip from the border, points: room for its head and its label.
const LABEL: Vec2 = vec2(12.0, 32.0);
/// Largest opening length as a fraction of the shorter side of a low view.
const LOW_SHARE: f64 = 0.25;
/// Length below which a dragged arrow is a force of zero, points.
const NO_LENGTH: f32 = 0.5;
/// Distance from a tip within which a press grabs it, points.
pub(crate) const NEAR: f32 = 13.0;
/// Step of the direction while Shift is down, degrees.
const SNAP: f64 = 15.0;
/// Default direction of a force of zero, degrees.
pub(crate) const DOWN: f64 = -90.0;

/// Radius at the start of the arrow of a moment, points; it grows by the pitch with every revolution, so that revolutions
/// do not overlap.
pub(super) const RADIUS: f64 = 24.0;
pub(super) const PITCH: f64 = 9.0;
/// Angles of the arrow of a zero moment and of the moment that the scene opens with, and additional angle per factor of ten
/// above twice the opening moment, rad. One pixel along the arc of the opening moment is 1.5 % of it.
const ANGLES: [f64; 3] = [TAU / 12.0, 0.375 * TAU, TAU / 4.0];
/// Angle in the plane at which the arrow of a moment starts, rad.
const START: f64 = TAU / 8.0;
/// Radius around the centre, in points, inside which the pointer's angle is ignored.
const MIDDLE: f32 = 5.0;

/// Returns magnitude and direction (degrees) of a vector; the direction is `None` for the zero vector.
pub(crate) fn polar_form([x, y]: [f64; 2]) -> (f64, Option<f64>) {
    let magnitude = x.hypot(y);
    (magnitude, (magnitude > 0.0).then(|| y.atan2(x).to_degrees()))
}

/// Returns the vector with this magnitude and direction in degrees, exact along the axes.
pub(crate) fn vector(magnitude: f64, degrees: f64) -> [f64; 2] {
    let (s, c) = match degrees {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        -90.0 => (-1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        _ => degrees.to_radians().sin_cos(),
    };
    [magnitude * c, magnitude * s].map(|component| rounded(component, 12))
}

/// Returns the scale of the arrows of a scene that opens with forces up to `usual`, N, in a view of size `view`,
/// points.
pub(crate) fn scale(usual: f64, view: Vec2) -> LoadScale {
    let ([low, high], side) = (OPENING, f64::from(view.min_elem()).max(1.0));
    LoadScale::smooth(usual, (SHARE * side).clamp(low, high).min(LOW_SHARE * side))
}

/// Returns the distance along a unit vector from a point to the border of a view without its `margin`, points; infinite for
/// a point outside the view, and for a view of less than its margins.
fn room(view: Rect, margin: Vec2, from: Pos2, direction: Vec2) -> f64 {
    let rect = view.shrink2(margin);
    if !(view.contains(from) && rect.is_positive()) {
        return f64::INFINITY;
    }
    let from = rect.clamp(from);
    let along = |from: f32, direction: f32, [low, high]: [f32; 2]| match direction {
        d if d > 0.0 => f64::from((high - from) / d),
        d if d < 0.0 => f64::from((low - from) / d),
        _ => f64::INFINITY,
    };
    let [x, y] = [[rect.min.x, rect.max.x], [rect.min.y, rect.max.y]];
    along(from.x, direction.x, x).min(along(from.y, direction.y, y))
}

/// Loads that scale the arrows and sliders of a scene: the largest one that it opens with, and the largest one of sliders.
pub(crate) struct LoadRanges {
    /// Forces, N. A scene that opens without forces has in the first place the one that bends its body by about a third of
    /// its length under linear theory. The second is the largest one with a visible effect, rounded up to a power of ten: it
    /// strains the whole section by 1, or, for slender bodies, is a thousand times the force that bends the body by its length.
    pub force: [f64; 2],
    /// Moments, N m. The second rolls the rest shape up once, rounded up to a power of ten. A scene that opens without moments
    /// has in the first place about a tenth of that moment, or of the moment of the largest opening force about the other
    /// end of the body, if that is smaller.
    pub moment: [f64; 2],
}

impl LoadRanges {
    pub(crate) fn new(opening: OpeningLoads, material: &Material, system: &System) -> Self {
        const TIMES: f64 = 1e3;
        /// Smallest ratio of the largest load of a slider to the load that the scene opens with.
        const MIN_SPAN: f64 = 4.0;
        /// A load above a power of ten by rounding only counts as that power.
        const ROUNDING: f64 = 1e-9;
        // The exponent is limited to a range without overflow.
        let power_above = |load: f64| 10f64.powf((load.clamp(1e-6, 1e14).log10() - ROUNDING).ceil());
        let range = |usual: f64, largest| [usual, power_above(largest).max(MIN_SPAN * usual)];
        let [length, height] = system.strip();
        let axial = material.young * material.thickness * height;
        // 3EI/L² and 2πEI/L with I = t h³/12.
        let bending = 0.25 * axial * (height / length).powi(2);
        let rolling = TAU * material.young * material.thickness * height.powi(3) / (12.0 * length);
        let of_force = opening.force.map_or(f64::INFINITY, |force| force * length);
        Self {
            force: range(opening.force.unwrap_or_else(|| round_down(0.3 * bending)), axial.min(TIMES * bending)),
            moment: range(opening.moment.unwrap_or_else(|| round_down(0.1 * rolling.min(of_force))), rolling),
        }
    }
}

impl DrawnBody<'_> {
    /// Returns the arrows of all forces and moments that act at the current time; the tips of forces are in the view if
    /// their bases are.
    pub(crate) fn arrows(&self) -> Vec<LoadArrow> {
        shortened(self.whole_arrows(), |from, direction| room(self.projection.rect, LABEL, from, direction))
    }

    /// Returns the arrows of all forces and moments that act at the current time, each long enough to be dragged, also out
    /// of the view.
    pub(crate) fn whole_arrows(&self) -> Vec<LoadArrow> {
        let ranges = LoadRanges::new(self.opening, &self.scene.material, self.system);
        let ([usual, largest], view) = (ranges.force, self.projection.rect);
        let scale_of_forces = scale(usual, view.size());
        let shown = self.scene.loads.iter().enumerate().filter(|(_, load)| is_seen(load, self.time));
        let arrows = shown.filter_map(|(load, of)| {
            let at = |place: &Place, at_point| Some(self.projection.point(self.applied(place, at_point)?));
            let arrow = match of {
                Load::Force { place, at_point, force, .. } => {
                    let (value, degrees) = polar_form(*force);
                    let [x, y] = vector(1.0, degrees.unwrap_or(self.direction));
                    let direction = vec2(x as f32, -y as f32);
                    let vector = direction * scale_of_forces.length(value).max(STUB) as f32;
                    let shape = ArrowShape::Straight { vector, direction, largest };
                    LoadArrow { load, from: at(place, *at_point)?, value, scale: scale_of_forces, shape }
                }
                Load::Moment { edge, moment, .. } => {
                    let center = at(&Place::from(edge.as_str()), false)?;
                    LoadArrow::of_moment(load, center, *moment, ranges.moment[0])
                }
                Load::Gravity { .. } => return None,
            };
            arrow.tip().is_finite().then_some(arrow)
        });
        let border = BORDER.min(LOW_SHARE as f32 * view.size());
        let longest = WHOLE * scale_of_forces.opening;
        shortened(arrows.collect(), |from, direction| longest.max(room(view, border, from, direction)))
    }
}

/// Shortens the arrows of all forces by the factor of the one that is longest relative to the `room` at its base along its
/// direction, so that the arrow of a larger force stays the longer one.
fn shortened(mut arrows: Vec<LoadArrow>, room: impl Fn(Pos2, Vec2) -> f64) -> Vec<LoadArrow> {
    let factor = arrows.iter().fold(1.0, |factor: f64, arrow| match arrow.shape {
        ArrowShape::Straight { vector, direction, .. } => {
            factor.min(room(arrow.from, direction).max(STUB) / f64::from(vector.length()))
        }
        ArrowShape::Arc => factor,
    });
    for arrow in &mut arrows {
        if let ArrowShape::Straight { vector, direction, .. } = &mut arrow.shape {
            *vector = *direction * (factor as f32 * vector.length()).max(STUB as f32);
        }
    }
    arrows
}

/// Returns `true` if a load is drawn; a pulse is drawn only while it acts.
pub(crate) fn is_seen(load: &Load, time: f64) -> bool {
    /// Smallest fraction of a pulse's peak that is drawn.
    const SEEN: f64 = 0.02;
    load.pulse().is_none_or(|pulse| pulse.factor(time) >= SEEN)
}

/// Returns the arrow that a press at `pointer` grabs at its tip, or else, if `takes_shafts`, at the shaft of a force.
pub(crate) fn under(arrows: &[LoadArrow], pointer: Pos2, takes_shafts: bool) -> Option<&LoadArrow> {
    /// Distance from a shaft within which a press grabs it, points.
    const NEAR_SHAFT: f32 = 5.0;
    let from_shaft = |LoadArrow { from, shape, .. }: &LoadArrow| match *shape {
        ArrowShape::Straight { vector, .. } if takes_shafts => {
            let along = ((pointer - *from).dot(vector) / vector.length_sq()).clamp(0.0, 1.0);
            pointer.distance(*from + along * vector)
        }
        _ => f32::INFINITY,
    };
    let at_tip = nearest(arrows, NEAR, |arrow| arrow.tip().distance(pointer));
    at_tip.or_else(|| nearest(arrows, NEAR_SHAFT, from_shaft))
}

/// Returns the item at the smallest distance from the pointer, if it is at most `near`, points.
pub(crate) fn nearest<T>(items: &[T], near: f32, distance: impl Fn(&T) -> f32) -> Option<&T> {
    let near = items.iter().map(|item| (distance(item), item)).filter(|(d, _)| *d <= near);
    near.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, item)| item)
}

/// Arrow of a force or a moment, in window coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadArrow {
    /// Index among the scene's loads.
    pub load: usize,
    /// Point of application of a force, or centre of the arrow of a moment.
    pub from: Pos2,
    /// Magnitude of a force, N, or moment, N m, counter-clockwise.
    pub(super) value: f64,
    /// Scale of the length, points, or of the angle, rad.
    pub(super) scale: LoadScale,
    pub(super) shape: ArrowShape,
}

/// Shape of the arrow of a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ArrowShape {
    /// Arrow of a force.
    Straight {
        /// Vector from the point of application to the tip, which stays in the view.
        vector: Vec2,
        /// Direction of the force.
        direction: Vec2,
        /// Largest force that it can be dragged to, N.
        largest: f64,
    },
    /// Circular arrow of a moment.
    Arc,
}

/// Movement of a tip since it was grabbed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Drag {
    /// Displacement, points.
    pub by: Vec2,
    /// Rotation about the centre of the arrow of a moment, rad, counter-clockwise.
    pub angle: f64,
}

impl LoadArrow {
    /// Returns the circular arrow of a moment, N m, in a scene that opens with moments up to `usual`, N m.
    pub(crate) fn of_moment(load: usize, from: Pos2, value: f64, usual: f64) -> Self {
        let [stub, opening, decade] = ANGLES;
        let scale = LoadScale { usual, stub, opening, straight: STRAIGHT, decade };
        Self { load, from, value, scale, shape: ArrowShape::Arc }
    }

    pub(crate) fn tip(&self) -> Pos2 {
        match self.shape {
            ArrowShape::Straight { vector, .. } => self.from + vector,
            ArrowShape::Arc => self.at(self.sweep()).0,
        }
    }

    /// Returns the vector from the point of application of a force to the tip; zero for a moment.
    pub(crate) fn vector(&self) -> Vec2 {
        if let ArrowShape::Straight { vector, .. } = self.shape { vector } else { Vec2::ZERO }
    }

    /// Returns the angle of the arrow of a moment, rad, counter-clockwise.
    pub(super) fn sweep(&self) -> f64 {
        let size = self.scale.length(self.value.abs());
        if self.value < 0.0 { -size } else { size }
    }

    /// Returns the point of the arrow of a moment at the angle `sweep`, rad, from its start, and the counter-clockwise
    /// tangent there.
    pub(super) fn at(&self, sweep: f64) -> (Pos2, Vec2) {
        let radius = (RADIUS + PITCH * sweep.abs() / TAU) as f32;
        let (s, c) = (START + sweep).sin_cos();
        // The window's y axis points down.
        let outward = vec2(c as f32, -s as f32);
        (self.from + outward * radius, vec2(outward.y, -outward.x))
    }

    /// Returns the angle by which a pointer that moves between two points rotates about the centre, rad,
    /// counter-clockwise.
    pub(crate) fn angle_between(&self, from: Pos2, to: Pos2) -> f64 {
        let [from, to] = [from, to].map(|p| p - self.from);
        if from.length() < MIDDLE || to.length() < MIDDLE {
            return 0.0;
        }
        f64::from(to.x * from.y - to.y * from.x).atan2(f64::from(from.dot(to)))
    }

    /// Returns the value of the load after a drag of the tip, and the direction of a force, degrees. The numbers are rounded
    /// to the pointer's accuracy; with `snap` a direction to a multiple of 15°, and a moment to 1, 2 or 5 times a power of ten.
    pub(crate) fn dragged(&self, Drag { by, angle }: Drag, snap: bool) -> (f64, Option<f64>) {
        let ArrowShape::Straight { vector: drawn, direction, largest } = self.shape else {
            let sweep = self.sweep() + angle;
            let moment = sweep.signum() * self.scale.load(sweep.abs());
            let size = moment.abs();
            if !snap || size == 0.0 {
                return (three_digits(moment), None);
            }
            // The reciprocals of the series 1, 2, 5 are the same series.
            let (below, above) = (round_down(size), 1.0 / round_down(1.0 / size));
            let nearest = if size * size < below * above { below } else { above };
            return (three_digits(nearest.copysign(moment)), None);
        };
        let whole = self.scale.length(self.value) as f32;
        let vector = if self.is_broken() {
            // The force has the direction of what is drawn. A longer arrow keeps the part of its length that is not drawn.
            let (to, drawn) = (drawn + by, drawn.length());
            to * if to.length() < drawn { whole / drawn } else { 1.0 + (whole - drawn) / to.length() }
        } else {
            direction * whole + by
        };
        let vector = if vector.length() < NO_LENGTH { Vec2::ZERO } else { vector };
        let pointed = if vector == Vec2::ZERO { direction } else { vector };
        let degrees = f64::from(-pointed.y).atan2(f64::from(pointed.x)).to_degrees();
        let step = if snap { SNAP } else { 1.0 };
        // Normalizes −0 to 0 and, below, −180 to 180.
        let degrees = (degrees / step).round() * step + 0.0;
        // Dragging ends at the slider's largest force; a larger force that was typed can only be reduced.
        let most = self.value.max(largest);
        let magnitude = three_digits(self.scale.load(f64::from(vector.length()))).min(most);
        (magnitude, Some(if degrees == -180.0 { 180.0 } else { degrees }))
    }

    /// Returns `true` if the arrow of a force is shorter than its force, because its tip stays in the view.
    pub(super) fn is_broken(&self) -> bool {
        let ArrowShape::Straight { vector, .. } = self.shape else { return false };
        f64::from(vector.length()) < self.scale.length(self.value) - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LARGE: Vec2 = vec2(1000.0, 700.0);

    fn force(value: f64, vector: Vec2) -> LoadArrow {
        let shape = ArrowShape::Straight { vector, direction: vec2(0.0, 1.0), largest: 1e6 };
        LoadArrow { load: 0, from: Pos2::ZERO, value, scale: scale(1e3, LARGE), shape }
    }

    fn moment(value: f64) -> LoadArrow {
        LoadArrow::of_moment(0, pos2(100.0, 100.0), value, 1e4)
    }

    /// Returns the moment, N m, of an arrow whose end is rotated by this angle, rad.
    fn turned(arrow: LoadArrow, angle: f64, snap: bool) -> f64 {
        arrow.dragged(Drag { by: Vec2::ZERO, angle }, snap).0
    }

    #[test]
    fn vectors_go_to_polar_form_and_back() {
        for v in [[3.0, -4.0], [0.0, -40_000.0], [-2.0, 0.0], [1e-3, 1e3]] {
            let (magnitude, direction) = polar_form(v);
            let back = vector(magnitude, direction.unwrap());
            assert!((back[0] - v[0]).hypot(back[1] - v[1]) < 1e-12 * magnitude, "{v:?} {back:?}");
        }
        assert_eq!(vector(5.0, -90.0), [0.0, -5.0]);
        assert_eq!(polar_form([0.0, 0.0]), (0.0, None));
    }

    /// In every view, a pixel of the arrow of the opening force is 1 to 2 % of the force; in a low one, where an arrow of that
    /// length would leave the view, up to 3.4 %. A pixel along the arc of the opening moment is 1 to 2 % of the moment.
    #[test]
    fn a_pixel_is_one_or_two_percent_of_the_load() {
        let low = scale(3e4, vec2(240.0, 120.0));
        assert!(low.opening == 30.0 && low.load(low.opening + 1.0) < 1.034 * 3e4, "{low:?}");
        for side in [200.0, 340.0, 480.0, 700.0, 2000.0] {
            let scale = scale(3e4, vec2(2.0 * side, side));
            let rate = (scale.load(scale.opening + 1.0) - scale.load(scale.opening - 1.0)) / (2.0 * 3e4);
            assert!((0.01..=0.0201).contains(&rate), "{side}: {rate}");
        }
        let arrow = moment(1e4);
        let pixel = 1.0 / (RADIUS + PITCH * arrow.sweep() / TAU);
        let rate = arrow.scale.load(arrow.sweep() + pixel) / 1e4 - 1.0;
        assert!((0.01..=0.02).contains(&rate), "{rate}");
    }

    /// An arrow that has little room shortens the others too.
    #[test]
    fn the_arrow_of_a_larger_force_is_the_longer_one() {
        let arrow = |value: f64| force(value, vec2(0.0, scale(1e3, LARGE).length(value) as f32));
        let [mut large, small] = [arrow(2e3), arrow(1e3)];
        large.from.x = 9.0;
        let arrows = shortened(vec![large, small], |from, _| if from.x > 0.0 { 60.0 } else { 200.0 });
        let [large, small] = [0, 1].map(|i| arrows[i].vector().length());
        assert!((large - 60.0).abs() < 1e-3 && (large / small - 2.0).abs() < 1e-3, "{large} {small}");
        // The force under the tip is that of the whole length.
        assert_eq!(arrows[0].dragged(Drag::default(), false), (2e3, Some(DOWN)));
    }

    #[test]
    fn a_dragged_tip_gives_round_numbers_and_shift_snaps() {
        let vector = vec2(0.0, scale(1e3, LARGE).length(1e3) as f32);
        let arrow = force(1e3, vector);
        let dragged = |arrow: LoadArrow, by: Vec2, snap: bool| {
            let (magnitude, direction) = arrow.dragged(Drag { by, angle: 0.0 }, snap);
            (magnitude, direction.unwrap())
        };
        assert_eq!(dragged(arrow, Vec2::ZERO, false), (1e3, DOWN));
        // Twice the length is twice the force.
        assert_eq!(dragged(arrow, vector, false), (2e3, DOWN));
        assert_eq!(dragged(arrow, vec2(0.0, 10.0), false), (1140.0, DOWN));
        assert_eq!(dragged(arrow, vec2(20.0, 0.0), true).1, -75.0);
        assert_eq!(dragged(arrow, -vector, false).0, 0.0);
        // Dragging ends at the slider's largest force.
        assert!((dragged(arrow, vec2(0.0, 2e4), false).0 / 1e6 - 1.0).abs() < 1e-9);
        // The force of an arrow that ends at the border of the view is that of its whole length.
        let large = force(1e5, 3.0 * vector);
        assert_eq!(dragged(large, Vec2::ZERO, false), (1e5, DOWN));
        // Dragged, it has the direction that is drawn.
        assert_eq!(dragged(large, vec2(3.0 * vector.y, 0.0), false).1, -45.0);
        let zero = force(0.0, vec2(0.0, 16.0));
        assert_eq!((dragged(zero, Vec2::ZERO, false), dragged(zero, vector, false)), ((0.0, DOWN), (1e3, DOWN)));
        // A force exactly to the left has the direction +180, on either side of the axis.
        assert_eq!(dragged(arrow, -vector + vec2(-60.0, 1e-4), false).1, 180.0);
    }

    /// The mapping is its own inverse for both senses of rotation; twice the opening angle is twice the moment.
    #[test]
    fn the_angle_of_the_arrow_is_proportional_to_the_moment() {
        for value in [0.0, 1e-3, -1.0, 12.0, -500.0, 3e4, 1e5, -1e7] {
            let back = moment(value).scale.load(moment(value).sweep().abs()).copysign(moment(value).sweep());
            assert!((back - value).abs() <= 1e-9 * (value.abs() + 1e-3), "{value} {back}");
        }
        assert!((moment(2e4).sweep() - 2.0 * moment(1e4).sweep()).abs() < 1e-12);
        assert!((moment(-1e4).sweep() + moment(1e4).sweep()).abs() < 1e-12);
        assert_eq!(turned(moment(0.0), -moment(0.0).sweep(), false), 0.0);
    }

    #[test]
    fn a_dragged_end_of_an_arc_gives_round_numbers_and_shift_snaps() {
        let arrow = moment(1e4);
        assert_eq!(turned(arrow, 0.0, false), 1e4);
        assert_eq!(turned(arrow, arrow.sweep(), false), 2e4);
        // Dragging back through zero changes the sign.
        assert_eq!(turned(arrow, -arrow.sweep(), false), 0.0);
        assert!((turned(arrow, -2.0 * arrow.sweep(), false) / -1e4 - 1.0).abs() < 0.01);
        for by in [-4.0, -1.0, -0.3, 0.1, 0.4, 0.8] {
            let moment = turned(arrow, by, true);
            let digits = format!("{moment:e}");
            let first = digits.trim_start_matches('-').split('e').next().unwrap();
            assert!(moment == 0.0 || ["1", "2", "5"].contains(&first), "{by}: {moment}");
        }
    }

    /// The window's y axis points down: moving up on the right side is counter-clockwise.
    #[test]
    fn a_pointer_rotates_about_the_centre() {
        let (right, above) = (pos2(130.0, 100.0), pos2(100.0, 70.0));
        assert!((moment(1.0).angle_between(right, above) - TAU / 4.0).abs() < 1e-6);
        assert!((moment(1.0).angle_between(above, right) + TAU / 4.0).abs() < 1e-6);
        assert_eq!(moment(1.0).angle_between(pos2(101.0, 100.0), above), 0.0);
        let by = moment(1e4).angle_between(moment(1e4).tip(), moment(5e4).tip());
        assert_eq!(turned(moment(1e4), by, false), 5e4);
    }
}
