//! Arrow of a force: its length, the position of its tip, and the force that a dragged tip sets.

use crate::app::interface::*;
use crate::app::viewport::probe;
use crate::app::viewport::projection::Projection;
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
/// Smallest ratio of the largest force of a slider to the force that the scene opens with.
pub(crate) const MIN_SPAN: f64 = 4.0;
/// Distance from a tip within which a press grabs it, points.
pub(crate) const NEAR: f32 = 13.0;
/// Step of the direction while Shift is down, degrees.
const SNAP: f64 = 15.0;
/// Default direction of a force of zero, degrees.
pub(crate) const DOWN: f64 = -90.0;

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

/// Returns the smallest power of ten that is not below `value`, limited to a range without overflow.
pub(crate) fn power_of_ten_above(value: f64) -> f64 {
    /// A value above a power of ten by rounding only counts as that power.
    const ROUNDING: f64 = 1e-9;
    10f64.powf((value.clamp(1e-6, 1e14).log10() - ROUNDING).ceil())
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

/// Returns the forces, N, that scale the arrows and sliders of a scene: the largest opening force and the largest force
/// of sliders. For a scene without forces the first is the one that bends its body by about a third of its length under
/// linear theory. The second is the largest one with a visible effect, rounded up to a power of ten: it strains the whole
/// section by 1, or, for slender bodies, is a thousand times the force that bends the body by its length.
pub(crate) fn force_range(opening: OpeningLoads, material: &Material, system: &System) -> [f64; 2] {
    const TIMES: f64 = 1e3;
    let [length, height] = system.strip();
    let axial = material.young * material.thickness * height;
    // 3EI/L² with I = t h³/12.
    let bending = 0.25 * axial * (height / length).powi(2);
    let usual = opening.force.unwrap_or_else(|| round_down(0.3 * bending));
    [usual, power_of_ten_above(axial.min(TIMES * bending)).max(MIN_SPAN * usual)]
}

/// Returns the point of application of a load or a support: the middle of its edge, its node, or its point of the body;
/// `None` if the edge does not exist.
pub(crate) fn point_of_application(
    mesh: &Mesh,
    positions: &[Vector2<f64>],
    place: &Place,
    at_point: bool,
) -> Option<Vector2<f64>> {
    if let (Place::At(at), true) = (place, at_point)
        && let Some(point) = mesh.locate((*at).into())
    {
        return probe::place(mesh, positions, point);
    }
    let nodes = match place {
        Place::Edge(name) => mesh.edge_nodes(name)?,
        Place::At(at) => vec![mesh.nearest_node((*at).into())],
    };
    let sum = nodes.iter().map(|&n| positions.get(n as usize)).sum::<Option<Vector2<f64>>>()?;
    (!nodes.is_empty()).then(|| sum / nodes.len() as f64)
}

/// Arrow of a force, in window coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arrow {
    /// Index of the force among the scene's loads.
    pub load: usize,
    /// Point of application.
    pub from: Pos2,
    /// Vector from the point of application to the tip, which stays in the view.
    pub vector: Vec2,
    /// Direction of the force.
    direction: Vec2,
    scale: LoadScale,
    /// Magnitude of the force, N.
    magnitude: f64,
    /// Largest force that it can be dragged to, N.
    largest: f64,
}

/// Scene and state whose load arrows are drawn.
#[derive(Clone, Copy)]
pub(crate) struct ForceArrows<'a> {
    pub scene: &'a Scene,
    pub system: &'a System,
    /// Positions of the nodes, m.
    pub positions: &'a [Vector2<f64>],
    /// Simulated time, s.
    pub time: f64,
    /// Direction of the arrow of a zero force, degrees.
    pub direction: f64,
    /// Loads that the scene opens with.
    pub opening: OpeningLoads,
}

impl ForceArrows<'_> {
    /// Returns the arrows of all forces that act at the current time; their tips are in the view if their bases are.
    pub(crate) fn arrows(&self, projection: &Projection) -> Vec<Arrow> {
        shortened(self.whole_arrows(projection), |arrow| room(projection.rect, LABEL, arrow.from, arrow.direction))
    }

    /// Returns the arrows of all forces that act at the current time, each long enough to be dragged, also out of the view.
    pub(crate) fn whole_arrows(&self, projection: &Projection) -> Vec<Arrow> {
        let mesh = self.system.mesh();
        let [usual, largest] = force_range(self.opening, &self.scene.material, self.system);
        let scale = scale(usual, projection.rect.size());
        let shown = self.scene.loads.iter().enumerate().filter(|(_, load)| is_seen(load, self.time));
        let arrows = shown.filter_map(|(load, of)| {
            let Load::Force { place, at_point, force, .. } = of else { return None };
            let from = projection.point(point_of_application(mesh, self.positions, place, *at_point)?);
            let (magnitude, degrees) = polar_form(*force);
            let [x, y] = vector(1.0, degrees.unwrap_or(self.direction));
            let direction = vec2(x as f32, -y as f32);
            let vector = direction * scale.length(magnitude).max(STUB) as f32;
            let arrow = Arrow { load, from, vector, direction, scale, magnitude, largest };
            (arrow.from.is_finite() && arrow.vector.is_finite()).then_some(arrow)
        });
        let border = BORDER.min(LOW_SHARE as f32 * projection.rect.size());
        let longest = WHOLE * scale.opening;
        shortened(arrows.collect(), |arrow| longest.max(room(projection.rect, border, arrow.from, arrow.direction)))
    }
}

/// Shortens all arrows by the factor of the one that is longest relative to its `room`, so that the arrow of a larger force
/// stays the longer one.
fn shortened(mut arrows: Vec<Arrow>, room: impl Fn(&Arrow) -> f64) -> Vec<Arrow> {
    let factor = |arrow: &Arrow| room(arrow).max(STUB) / f64::from(arrow.vector.length());
    let factor = arrows.iter().map(factor).fold(1.0, f64::min) as f32;
    for arrow in &mut arrows {
        arrow.vector = arrow.direction * (factor * arrow.vector.length()).max(STUB as f32);
    }
    arrows
}

/// Returns `true` if a load is drawn; a pulse is drawn only while it acts.
pub(crate) fn is_seen(load: &Load, time: f64) -> bool {
    /// Smallest fraction of a pulse's peak that is drawn.
    const SEEN: f64 = 0.02;
    load.pulse().is_none_or(|pulse| pulse.factor(time) >= SEEN)
}

impl Arrow {
    pub(crate) fn tip(&self) -> Pos2 {
        self.from + self.vector
    }

    /// Returns the force, N, and its direction, degrees, after the tip has moved by `by`, points. The numbers are
    /// rounded to the pointer's accuracy.
    pub(crate) fn dragged(&self, by: Vec2, snap: bool) -> (f64, f64) {
        let whole = self.scale.length(self.magnitude) as f32;
        let vector = if self.is_broken() {
            // The force has the direction of what is drawn. A longer arrow keeps the part of its length that is not drawn.
            let (to, drawn) = (self.vector + by, self.vector.length());
            to * if to.length() < drawn { whole / drawn } else { 1.0 + (whole - drawn) / to.length() }
        } else {
            self.direction * whole + by
        };
        let vector = if vector.length() < NO_LENGTH { Vec2::ZERO } else { vector };
        let pointed = if vector == Vec2::ZERO { self.direction } else { vector };
        let degrees = f64::from(-pointed.y).atan2(f64::from(pointed.x)).to_degrees();
        let step = if snap { SNAP } else { 1.0 };
        // Normalizes −0 to 0 and, below, −180 to 180.
        let degrees = (degrees / step).round() * step + 0.0;
        // Dragging ends at the slider's largest force; a larger force that was typed can only be reduced.
        let most = self.magnitude.max(self.largest);
        let magnitude = three_digits(self.scale.load(f64::from(vector.length()))).min(most);
        (magnitude, if degrees == -180.0 { 180.0 } else { degrees })
    }

    /// Paints the arrow of the force on a body that is not in the state that was asked for, without a handle; nothing for a
    /// force of zero.
    pub(crate) fn paint_body_load(&self, painter: &Painter, color: Color32, visuals: &Visuals) {
        if self.magnitude > 0.0 {
            paint_arrow(painter, self.from, self.vector, color);
            self.paint_break(painter, color, visuals);
        }
    }

    /// Returns `true` if the arrow is shorter than its force, because its tip stays in the view.
    fn is_broken(&self) -> bool {
        f64::from(self.vector.length()) < self.scale.length(self.magnitude) - 1.0
    }

    /// Paints the gap of a shaft that is shorter than its force.
    fn paint_break(&self, painter: &Painter, color: Color32, visuals: &Visuals) {
        /// Fraction of the vector at which the shaft is broken.
        const AT: f32 = 0.3;
        if !self.is_broken() {
            return;
        }
        let direction = self.vector.normalized();
        let (middle, slanted) = (self.from + AT * self.vector, (direction.rot90() + 0.6 * direction) * 7.0);
        let ends = |at: Pos2| [at - slanted, at + slanted];
        let sides = [middle - direction * 2.5, middle + direction * 2.5];
        painter.line_segment(ends(middle), Stroke::new(5.0, visuals.extreme_bg_color));
        for side in sides {
            painter.line_segment(ends(side), Stroke::new(1.5, color));
        }
    }

    /// Paints the arrow with its force next to it, as an outline if the body does not have this load.
    pub(crate) fn paint(&self, labels: &mut Labels<'_>, color: Color32, (is_hot, is_outline): (bool, bool)) {
        /// Size of the areas along the arrow that stay free of labels, and distance between them, points.
        const GRIP: Vec2 = Vec2::splat(8.0);
        const STEP: f32 = 12.0;
        let (painter, direction) = (labels.painter, self.vector.normalized());
        let is_stub = self.magnitude == 0.0;
        let faint = if is_stub && !is_hot { color.gamma_multiply(0.55) } else { color };
        let tip = if is_outline {
            paint_outline(painter, self.from, self.vector, faint)
        } else {
            paint_arrow(painter, self.from, self.vector, faint)
        };
        self.paint_break(painter, faint, labels.visuals);
        let grip = tip - direction * 6.0;
        paint_grip(painter, grip, faint, is_hot);
        let view = painter.clip_rect();
        if view.contains(self.from) || view.contains(tip) {
            let along = (0..).map(|i| STEP * i as f32).take_while(|length| *length < self.vector.length());
            let places = along.map(|length| self.from + direction * length).chain([grip]);
            labels.taken.extend(places.map(|at| Rect::from_center_size(at, GRIP)));
            let (anchor, at) = label_place(tip, direction);
            labels.add(at, anchor, &engineering(self.magnitude, "N"), faint, 200.0);
        }
    }

    /// Paints the dragged arrow at the position where its tip was grabbed.
    pub(crate) fn paint_handle(&self, painter: &Painter, by: Vec2, color: Color32) {
        let stroke = Stroke::new(1.5, color.gamma_multiply(0.8));
        let tip = self.tip() + by;
        painter.add(Shape::Vec(Shape::dashed_line(&[self.from, tip], stroke, 5.0, 4.0)));
        painter.circle_stroke(self.from, 3.0, stroke);
        painter.circle(tip, 7.0, color.gamma_multiply(0.35), Stroke::new(2.0, color));
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
pub(crate) fn paint_grip(painter: &Painter, at: Pos2, color: Color32, is_hot: bool) {
    if is_hot {
        painter.circle(at, NEAR, color.gamma_multiply(0.25), Stroke::new(2.0, color));
    } else {
        painter.circle_stroke(at, 8.5, Stroke::new(1.0, color.gamma_multiply(0.6)));
    }
}

/// Length of the head of an arrow, and its half width, points.
const HEAD: [f32; 2] = [12.0, 5.04];

/// Paints an arrow with the vector `vector` at `from`, and returns its tip.
pub(crate) fn paint_arrow(painter: &Painter, from: Pos2, vector: Vec2, color: Color32) -> Pos2 {
    let (tip, neck, side) = head(from, vector);
    painter.line_segment([from, neck], Stroke::new(3.0, color));
    painter.add(Shape::convex_polygon(vec![tip, neck + side, neck - side], color, Stroke::NONE));
    tip
}

/// Paints the outline of an arrow with the vector `vector` at `from`, and returns its tip.
fn paint_outline(painter: &Painter, from: Pos2, vector: Vec2, color: Color32) -> Pos2 {
    /// Half width of the shaft as a fraction of that of the head.
    const SHAFT: f32 = 0.45;
    let (tip, neck, side) = head(from, vector);
    let shaft = SHAFT * side;
    let line = [from + shaft, neck + shaft, neck + side, tip, neck - side, neck - shaft, from - shaft];
    painter.add(Shape::closed_line(line.to_vec(), Stroke::new(1.5, color)));
    tip
}

/// Returns the tip of an arrow, the middle of the head's base, and the vector from there to a corner.
fn head(from: Pos2, vector: Vec2) -> (Pos2, Pos2, Vec2) {
    let direction = vector.normalized();
    let [length, width] = HEAD;
    let tip = from + vector;
    let neck = tip - direction * length;
    (tip, neck, vec2(-direction.y, direction.x) * width)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LARGE: Vec2 = vec2(1000.0, 700.0);

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
    /// length would leave the view, up to 3.4 %.
    #[test]
    fn a_pixel_is_one_or_two_percent_of_the_force() {
        let low = scale(3e4, vec2(240.0, 120.0));
        assert!(low.opening == 30.0 && low.load(low.opening + 1.0) < 1.034 * 3e4, "{low:?}");
        for side in [200.0, 340.0, 480.0, 700.0, 2000.0] {
            let scale = scale(3e4, vec2(2.0 * side, side));
            let rate = (scale.load(scale.opening + 1.0) - scale.load(scale.opening - 1.0)) / (2.0 * 3e4);
            assert!((0.01..=0.0201).contains(&rate), "{side}: {rate}");
        }
    }

    /// An arrow that has little room shortens the others too.
    #[test]
    fn the_arrow_of_a_larger_force_is_the_longer_one() {
        let (from, direction, scale) = (Pos2::ZERO, vec2(0.0, 1.0), scale(1e3, LARGE));
        let arrow = |magnitude: f64| {
            let vector = direction * scale.length(magnitude) as f32;
            Arrow { load: 0, from, vector, direction, scale, magnitude, largest: 1e6 }
        };
        let arrows = shortened(vec![arrow(2e3), arrow(1e3)], |arrow| if arrow.magnitude > 1e3 { 60.0 } else { 200.0 });
        let [large, small] = [0, 1].map(|i| arrows[i].vector.length());
        assert!((large - 60.0).abs() < 1e-3 && (large / small - 2.0).abs() < 1e-3, "{large} {small}");
        // The force under the tip is that of the whole length.
        assert_eq!(arrows[0].dragged(Vec2::ZERO, false), (2e3, DOWN));
    }

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

    #[test]
    fn a_dragged_tip_gives_round_numbers_and_shift_snaps() {
        let scale = scale(1e3, LARGE);
        let vector = vec2(0.0, scale.length(1e3) as f32);
        let (from, direction) = (Pos2::ZERO, vector.normalized());
        let arrow = Arrow { load: 0, from, vector, direction, scale, magnitude: 1e3, largest: 1e6 };
        assert_eq!(arrow.dragged(Vec2::ZERO, false), (1e3, DOWN));
        // Twice the length is twice the force.
        assert_eq!(arrow.dragged(vector, false), (2e3, DOWN));
        assert_eq!(arrow.dragged(vec2(0.0, 10.0), false), (1140.0, DOWN));
        let (_, direction) = arrow.dragged(vec2(20.0, 0.0), true);
        assert_eq!(direction, -75.0);
        assert_eq!(arrow.dragged(-arrow.vector, false).0, 0.0);
        // Dragging ends at the slider's largest force.
        assert!((arrow.dragged(vec2(0.0, 2e4), false).0 / 1e6 - 1.0).abs() < 1e-9);
        // The force of an arrow that ends at the border of the view is that of its whole length.
        let large = Arrow { vector: 3.0 * vector, magnitude: 1e5, ..arrow };
        assert_eq!(large.dragged(Vec2::ZERO, false), (1e5, DOWN));
        // Dragged, it has the direction that is drawn.
        assert_eq!(large.dragged(vec2(3.0 * vector.y, 0.0), false).1, -45.0);
        let zero = Arrow { vector: 16.0 * arrow.direction, magnitude: 0.0, ..arrow };
        assert_eq!((zero.dragged(Vec2::ZERO, false).0, zero.dragged(vector, false)), (0.0, (1e3, DOWN)));
        assert_eq!(zero.dragged(Vec2::ZERO, false).1, DOWN);
        // A force exactly to the left has the direction +180, on either side of the axis.
        let left = arrow.dragged(-arrow.vector + vec2(-60.0, 1e-4), false);
        assert_eq!(left.1, 180.0);
    }
}
