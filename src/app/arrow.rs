//! The arrow of a force: how long it is, where its tip is, and which force a dragged tip asks for.

use egui::{Align, Align2, Color32, Painter, Pos2, Shape, Stroke, Vec2, Visuals, vec2};
use nalgebra::Vector2;

use super::overlay::{Projection, boxed_text};
use crate::assembly::System;
use crate::mesh::Mesh;
use crate::scene::{Load, Material, Place, Scene};
use crate::words::{engineering, three_digits};

/// Length of an arrow without force, points: something to take hold of.
const STUB: f64 = 22.0;
/// Length of a decade of forces, points, where there is room for it, and in the smallest of views.
const DECADE: [f64; 2] = [26.0, 5.0];
/// The part of a view's shorter side that the arrow of the largest force may take.
const SHARE: f64 = 0.3;
/// Decades between the smallest force and the largest.
const DECADES: f64 = 5.0;
/// The smallest force over the largest that slider and arrow tell from zero.
pub(super) const SMALLEST: f64 = 1e-5;
/// So near to a tip, points, a press takes hold of it.
pub(super) const NEAR: f32 = 13.0;
/// Directions snap to multiples of this while Shift is down, degrees.
const SNAP: f64 = 15.0;
/// Direction of a force of which none is known, degrees.
pub(super) const DOWN: f64 = -90.0;

/// Magnitude and direction (degrees) of a vector; the direction is `None` at zero.
pub(super) fn polar_form([x, y]: [f64; 2]) -> (f64, Option<f64>) {
    let magnitude = x.hypot(y);
    (magnitude, (magnitude > 0.0).then(|| y.atan2(x).to_degrees()))
}

/// The vector of a magnitude and a direction in degrees, exact along the axes.
pub(super) fn vector(magnitude: f64, degrees: f64) -> [f64; 2] {
    let (s, c) = match degrees {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        -90.0 => (-1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        _ => degrees.to_radians().sin_cos(),
    };
    [magnitude * c, magnitude * s]
}

/// As far as anything can be seen, N, rounded up to a power of ten: a force that strains the whole section by 1, or, of
/// what is slender, a thousand times the one that bends it by its length under linear theory.
pub(super) fn largest_force(material: &Material, system: &System) -> f64 {
    const TIMES: f64 = 1e3;
    let [length, height] = system.strip();
    let axial = material.young * material.thickness * height;
    // 3EI/L² with I = t h³/12.
    let bending = 0.25 * axial * (height / length).powi(2);
    power_of_ten_above(axial.min(TIMES * bending))
}

/// The power of ten that is not below a value; never too small or too large to count with.
pub(super) fn power_of_ten_above(value: f64) -> f64 {
    /// What is above a power of ten only by rounding is that.
    const ROUNDING: f64 = 1e-9;
    10f64.powf((value.clamp(1e-6, 1e14).log10() - ROUNDING).ceil())
}

/// Between a force and the length of its arrow: logarithmic, with a stub for no force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// The force, N, from which on lengths are logarithmic.
    smallest: f64,
    /// Length of ten times the force, points.
    decade: f64,
}

impl Scale {
    /// The scale of forces up to `largest`, N, in a view of this size, points; those beyond have longer arrows still.
    pub(super) fn up_to(largest: f64, view: Vec2) -> Self {
        let room = SHARE * f64::from(view.min_elem());
        let [widest, narrowest] = DECADE;
        Self { smallest: SMALLEST * largest, decade: ((room - STUB) / DECADES).clamp(narrowest, widest) }
    }

    /// Length, points, of the arrow of a force, N.
    pub(super) fn length(self, magnitude: f64) -> f64 {
        STUB + self.decade * (magnitude / self.smallest).ln_1p() / std::f64::consts::LN_10
    }

    /// The force, N, of an arrow that is so long, points.
    pub(super) fn magnitude(self, length: f64) -> f64 {
        self.smallest * ((length - STUB).max(0.0) * std::f64::consts::LN_10 / self.decade).exp_m1()
    }
}

/// Where a load pulls: the middle of its edge, or its node; `None` where there is no such place.
pub(super) fn load_point(mesh: &Mesh, positions: &[Vector2<f64>], place: &Place) -> Option<Vector2<f64>> {
    let nodes = match place {
        Place::Edge(name) => mesh.edge_nodes(name)?,
        Place::At(at) => vec![mesh.nearest_node((*at).into())],
    };
    let sum = nodes.iter().map(|&n| positions.get(n as usize)).sum::<Option<Vector2<f64>>>()?;
    (!nodes.is_empty()).then(|| sum / nodes.len() as f64)
}

/// The arrow of a force, in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrow {
    /// The force's number among the scene's loads.
    pub load: usize,
    /// Where it pulls.
    pub from: Pos2,
    /// From there to the tip.
    pub way: Vec2,
    scale: Scale,
    /// N.
    magnitude: f64,
}

/// What arrows are of.
#[derive(Clone, Copy)]
pub(super) struct Forces<'a> {
    pub scene: &'a Scene,
    pub system: &'a System,
    /// Where the nodes are, m.
    pub positions: &'a [Vector2<f64>],
    /// Simulated time, s.
    pub time: f64,
    /// Direction of an arrow without force, degrees.
    pub direction: f64,
}

impl Forces<'_> {
    /// The arrows of all forces that pull at the present time.
    pub(super) fn arrows(&self, projection: &Projection) -> Vec<Arrow> {
        let mesh = self.system.mesh();
        let scale = Scale::up_to(largest_force(&self.scene.material, self.system), projection.rect.size());
        let shown = self.scene.loads.iter().enumerate().filter(|(_, load)| is_seen(load, self.time));
        let arrows = shown.filter_map(|(load, of)| {
            let Load::Force { place, force, .. } = of else { return None };
            let from = projection.point(load_point(mesh, self.positions, place)?);
            let (magnitude, degrees) = polar_form(*force);
            let [x, y] = vector(scale.length(magnitude), degrees.unwrap_or(self.direction));
            let arrow = Arrow { load, from, way: vec2(x as f32, -y as f32), scale, magnitude };
            (arrow.from.is_finite() && arrow.way.is_finite()).then_some(arrow)
        });
        arrows.collect()
    }
}

/// Whether a load is drawn: of a pulse only while there is something of it.
pub(super) fn is_seen(load: &Load, time: f64) -> bool {
    /// Less than this part of a pulse is not drawn.
    const SEEN: f64 = 0.02;
    load.pulse().is_none_or(|pulse| pulse.factor(time) >= SEEN)
}

impl Arrow {
    pub(super) fn tip(&self) -> Pos2 {
        self.from + self.way
    }

    /// The force, N, and its direction, degrees, of this arrow with its tip moved by so many points. Numbers are round:
    /// a pointer knows no more.
    pub(super) fn dragged(&self, by: Vec2, snap: bool) -> (f64, f64) {
        let way = self.way + by;
        let degrees = f64::from(-way.y).atan2(f64::from(way.x)).to_degrees();
        let step = if snap { SNAP } else { 1.0 };
        // −0 and −180 are 0 and 180.
        let degrees = (degrees / step).round() * step + 0.0;
        // As far as the slider goes; a force beyond it, which was typed, can be made smaller only.
        let most = self.magnitude.max(self.scale.smallest / SMALLEST);
        let magnitude = three_digits(self.scale.magnitude(f64::from(way.length()))).min(most);
        (magnitude, if degrees == -180.0 { 180.0 } else { degrees })
    }

    /// Paints it with its force beside it.
    pub(super) fn paint(&self, painter: &Painter, color: Color32, visuals: &Visuals, is_hot: bool) {
        let direction = self.way.normalized();
        let is_stub = self.magnitude == 0.0;
        let faint = if is_stub && !is_hot { color.gamma_multiply(0.55) } else { color };
        let tip = paint_arrow(painter, self.from, self.way, faint);
        // The handle: a ring around the tip says that it can be taken.
        let grip = tip - direction * 6.0;
        if is_hot {
            painter.circle(grip, NEAR, color.gamma_multiply(0.25), Stroke::new(2.0, color));
        } else {
            painter.circle_stroke(grip, 8.5, Stroke::new(1.0, faint.gamma_multiply(0.6)));
        }
        let label = engineering(self.magnitude, "N");
        let (anchor, at) = label_place(tip, direction);
        boxed_text(painter, at, anchor, &label, visuals, faint, 200.0);
    }

    /// Paints, where it was when its tip was taken, what the pointer has made of it.
    pub(super) fn paint_handle(&self, painter: &Painter, by: Vec2, color: Color32) {
        let stroke = Stroke::new(1.5, color.gamma_multiply(0.8));
        let tip = self.tip() + by;
        painter.add(Shape::Vec(Shape::dashed_line(&[self.from, tip], stroke, 5.0, 4.0)));
        painter.circle_stroke(self.from, 3.0, stroke);
        painter.circle(tip, 7.0, color.gamma_multiply(0.35), Stroke::new(2.0, color));
    }
}

/// Where the force of an arrow stands: beyond its tip, or over it where it lies nearly level; never on the arrow.
fn label_place(tip: Pos2, direction: Vec2) -> (Align2, Pos2) {
    /// The sine of 22.5 degrees: less is level, or upright.
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

/// Paints an arrow from a point along a way; returns its tip.
pub(super) fn paint_arrow(painter: &Painter, from: Pos2, way: Vec2, color: Color32) -> Pos2 {
    const HEAD: f32 = 12.0;
    let direction = way.normalized();
    let tip = from + way;
    let side = vec2(-direction.y, direction.x) * (HEAD * 0.42);
    let neck = tip - direction * HEAD;
    painter.line_segment([from, neck], Stroke::new(3.0, color));
    painter.add(Shape::convex_polygon(vec![tip, neck + side, neck - side], color, Stroke::NONE));
    tip
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

    /// One mapping, both ways: every force has a length of its own, and ten times the force is a fixed piece longer.
    #[test]
    fn lengths_tell_forces_logarithmically() {
        let scale = Scale::up_to(1e6, LARGE);
        for magnitude in [0.0, 1e-3, 1.0, 12.0, 500.0, 3e4, 1e6, 1e9, 1e15] {
            let back = scale.magnitude(scale.length(magnitude));
            assert!((back - magnitude).abs() <= 1e-10 * (magnitude + 1.0), "{magnitude} {back}");
        }
        let decade = scale.length(1e5) - scale.length(1e4);
        assert!((decade - DECADE[0]).abs() < 0.1, "{decade}");
        assert_eq!((scale.length(0.0), scale.magnitude(STUB), scale.magnitude(0.0)), (STUB, 0.0, 0.0));
        assert!(
            (1..150).all(
                |i| scale.length(10f64.powf(f64::from(i) * 0.1)) > scale.length(10f64.powf(f64::from(i - 1) * 0.1))
            )
        );
    }

    /// The largest force has an arrow that leaves room for the body, and differences that a pointer can make.
    #[test]
    fn small_views_have_short_arrows() {
        let largest = 1e6;
        for (side, most) in [(700.0, 155.0), (400.0, 121.0), (200.0, 61.0), (60.0, 50.0)] {
            let scale = Scale::up_to(largest, vec2(2.0 * side, side));
            assert!(scale.length(largest) < most, "{side}: {}", scale.length(largest));
            assert!(scale.length(largest) - scale.length(0.1 * largest) > 4.0, "{side}");
        }
    }

    /// Whatever its direction and length, the words are beside the arrow.
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
        let scale = Scale::up_to(1e6, LARGE);
        let arrow =
            Arrow { load: 0, from: Pos2::ZERO, way: vec2(0.0, scale.length(1e3) as f32), scale, magnitude: 1e3 };
        assert_eq!(arrow.dragged(Vec2::ZERO, false), (1e3, DOWN));
        let (more, direction) = arrow.dragged(vec2(0.0, DECADE[0] as f32), false);
        assert!((more / 1e4 - 1.0).abs() < 0.02 && direction == DOWN, "{more} {direction}");
        let (_, direction) = arrow.dragged(vec2(20.0, 0.0), true);
        assert_eq!(direction, -75.0);
        assert_eq!(arrow.dragged(-arrow.way, false).0, 0.0);
        // As the slider, it ends at the largest force.
        assert!((arrow.dragged(vec2(0.0, 500.0), false).0 / 1e6 - 1.0).abs() < 1e-9);
        // Straight to the left is +180, whichever side of it the tip is.
        let left = arrow.dragged(-arrow.way + vec2(-60.0, 1e-4), false);
        assert_eq!(left.1, 180.0);
    }
}
