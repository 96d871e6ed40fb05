//! The arrow of a force: how long it is, where its tip is, and which force a dragged tip asks for.

use egui::{Align, Align2, Color32, Painter, Pos2, Shape, Stroke, Vec2, Visuals, vec2};
use nalgebra::Vector2;

use crate::app::viewport::projection::Projection;
use crate::app::widgets::load_scale::{LoadScale, OpeningLoads};
use crate::app::widgets::text::boxed_text;
use crate::assembly::System;
use crate::mesh::Mesh;
use crate::scene::{Load, Material, Place, Scene};
use crate::words::{engineering, round_down, three_digits};

/// Length of an arrow without force, points: something to take hold of.
const STUB: f64 = 16.0;
/// Length of the arrow of the force that the scene opens with, points, in small views and in large ones: a pixel is 1 to 2 %.
const OPENING: [f64; 2] = [50.0, 72.0];
/// Length of a tenfold force beyond twice that, points, in small views and in large ones.
const DECADE: [f64; 2] = [20.0, 60.0];
/// The same lengths over the shorter side of a view, where that lies between.
const SHARE: [f64; 2] = [0.12, 0.09];
/// Least ratio between the largest force of a slider and the one that the scene opens with.
pub(crate) const LEAST_SPAN: f64 = 4.0;
/// So near to a tip, points, a press takes hold of it.
pub(crate) const NEAR: f32 = 13.0;
/// Directions snap to multiples of this while Shift is down, degrees.
const SNAP: f64 = 15.0;
/// Direction of a force of which none is known, degrees.
pub(crate) const DOWN: f64 = -90.0;

/// Magnitude and direction (degrees) of a vector; the direction is `None` at zero.
pub(crate) fn polar_form([x, y]: [f64; 2]) -> (f64, Option<f64>) {
    let magnitude = x.hypot(y);
    (magnitude, (magnitude > 0.0).then(|| y.atan2(x).to_degrees()))
}

/// The vector of a magnitude and a direction in degrees, exact along the axes.
pub(crate) fn vector(magnitude: f64, degrees: f64) -> [f64; 2] {
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
fn largest_force(material: &Material, system: &System) -> f64 {
    const TIMES: f64 = 1e3;
    let [bending, axial] = bending_force(material, system);
    power_of_ten_above(axial.min(TIMES * bending))
}

/// Force that bends a body by its length under linear theory, and force that strains its section by 1, N.
fn bending_force(material: &Material, system: &System) -> [f64; 2] {
    let [length, height] = system.strip();
    let axial = material.young * material.thickness * height;
    // 3EI/L² with I = t h³/12.
    [0.25 * axial * (height / length).powi(2), axial]
}

/// The power of ten that is not below a value; never too small or too large to count with.
pub(crate) fn power_of_ten_above(value: f64) -> f64 {
    /// What is above a power of ten only by rounding is that.
    const ROUNDING: f64 = 1e-9;
    10f64.powf((value.clamp(1e-6, 1e14).log10() - ROUNDING).ceil())
}

/// Scale of the arrows of a scene that opens with forces up to `usual`, N, in a view of this size, points.
pub(crate) fn scale(usual: f64, view: Vec2) -> LoadScale {
    let side = f64::from(view.min_elem());
    let within = |[low, high]: [f64; 2], share: f64| (share * side).clamp(low, high);
    let [opening, decade] = SHARE;
    LoadScale { usual, stub: STUB, opening: within(OPENING, opening), decade: within(DECADE, decade) }
}

/// Forces, N, that arrows and sliders of a scene are scaled by: the largest it opens with, or, of a scene without forces, one
/// that bends its body by a third of its length under linear theory; and the one they end at.
pub(crate) fn force_range(opening: OpeningLoads, material: &Material, system: &System) -> [f64; 2] {
    let usual = opening.force.unwrap_or_else(|| round_down(0.3 * bending_force(material, system)[0]));
    [usual, largest_force(material, system).max(LEAST_SPAN * usual)]
}

/// Where a load pulls: the middle of its edge, or its node; `None` where there is no such place.
pub(crate) fn load_point(mesh: &Mesh, positions: &[Vector2<f64>], place: &Place) -> Option<Vector2<f64>> {
    let nodes = match place {
        Place::Edge(name) => mesh.edge_nodes(name)?,
        Place::At(at) => vec![mesh.nearest_node((*at).into())],
    };
    let sum = nodes.iter().map(|&n| positions.get(n as usize)).sum::<Option<Vector2<f64>>>()?;
    (!nodes.is_empty()).then(|| sum / nodes.len() as f64)
}

/// The arrow of a force, in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arrow {
    /// The force's number among the scene's loads.
    pub load: usize,
    /// Where it pulls.
    pub from: Pos2,
    /// From there to the tip.
    pub way: Vec2,
    scale: LoadScale,
    /// N.
    magnitude: f64,
    /// Largest force that it can be dragged to, N.
    largest: f64,
}

/// What arrows are of.
#[derive(Clone, Copy)]
pub(crate) struct Forces<'a> {
    pub scene: &'a Scene,
    pub system: &'a System,
    /// Where the nodes are, m.
    pub positions: &'a [Vector2<f64>],
    /// Simulated time, s.
    pub time: f64,
    /// Direction of an arrow without force, degrees.
    pub direction: f64,
    /// Loads that the scene opens with.
    pub opening: OpeningLoads,
}

impl Forces<'_> {
    /// The arrows of all forces that pull at the present time.
    pub(crate) fn arrows(&self, projection: &Projection) -> Vec<Arrow> {
        let mesh = self.system.mesh();
        let [usual, largest] = force_range(self.opening, &self.scene.material, self.system);
        let scale = scale(usual, projection.rect.size());
        let shown = self.scene.loads.iter().enumerate().filter(|(_, load)| is_seen(load, self.time));
        let arrows = shown.filter_map(|(load, of)| {
            let Load::Force { place, force, .. } = of else { return None };
            let from = projection.point(load_point(mesh, self.positions, place)?);
            let (magnitude, degrees) = polar_form(*force);
            let [x, y] = vector(scale.length(magnitude), degrees.unwrap_or(self.direction));
            let arrow = Arrow { load, from, way: vec2(x as f32, -y as f32), scale, magnitude, largest };
            (arrow.from.is_finite() && arrow.way.is_finite()).then_some(arrow)
        });
        arrows.collect()
    }
}

/// Whether a load is drawn: of a pulse only while there is something of it.
pub(crate) fn is_seen(load: &Load, time: f64) -> bool {
    /// Less than this part of a pulse is not drawn.
    const SEEN: f64 = 0.02;
    load.pulse().is_none_or(|pulse| pulse.factor(time) >= SEEN)
}

impl Arrow {
    pub(crate) fn tip(&self) -> Pos2 {
        self.from + self.way
    }

    /// The force, N, and its direction, degrees, of this arrow with its tip moved by so many points. Numbers are round:
    /// a pointer knows no more.
    pub(crate) fn dragged(&self, by: Vec2, snap: bool) -> (f64, f64) {
        let way = self.way + by;
        let degrees = f64::from(-way.y).atan2(f64::from(way.x)).to_degrees();
        let step = if snap { SNAP } else { 1.0 };
        // −0 and −180 are 0 and 180.
        let degrees = (degrees / step).round() * step + 0.0;
        // As far as the slider goes; a force beyond it, which was typed, can be made smaller only.
        let most = self.magnitude.max(self.largest);
        let magnitude = three_digits(self.scale.load(f64::from(way.length()))).min(most);
        (magnitude, if degrees == -180.0 { 180.0 } else { degrees })
    }

    /// Paints it with its force beside it.
    pub(crate) fn paint(&self, painter: &Painter, color: Color32, visuals: &Visuals, is_hot: bool) {
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
    pub(crate) fn paint_handle(&self, painter: &Painter, by: Vec2, color: Color32) {
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
pub(crate) fn paint_arrow(painter: &Painter, from: Pos2, way: Vec2, color: Color32) -> Pos2 {
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

    /// The force that the scene opens with has an arrow whose pixels are 1 to 2 % each, in every view.
    #[test]
    fn a_pixel_is_one_or_two_percent_of_the_force() {
        for side in [120.0, 340.0, 480.0, 700.0, 2000.0] {
            let scale = scale(3e4, vec2(2.0 * side, side));
            let rate = (scale.load(scale.opening + 1.0) - scale.load(scale.opening - 1.0)) / (2.0 * 3e4);
            assert!((0.01..=0.0201).contains(&rate), "{side}: {rate}");
            // The largest force of most sliders leaves room for the body.
            assert!(scale.length(1e6) < 0.35 * f64::from(side).max(400.0), "{side}: {}", scale.length(1e6));
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
        let scale = scale(1e3, LARGE);
        let way = vec2(0.0, scale.length(1e3) as f32);
        let arrow = Arrow { load: 0, from: Pos2::ZERO, way, scale, magnitude: 1e3, largest: 1e6 };
        assert_eq!(arrow.dragged(Vec2::ZERO, false), (1e3, DOWN));
        // Its own length further it is twice the force.
        assert_eq!(arrow.dragged(way, false), (2e3, DOWN));
        assert_eq!(arrow.dragged(vec2(0.0, 10.0), false), (1140.0, DOWN));
        let (_, direction) = arrow.dragged(vec2(20.0, 0.0), true);
        assert_eq!(direction, -75.0);
        assert_eq!(arrow.dragged(-arrow.way, false).0, 0.0);
        // As the slider, it ends at the largest force.
        assert!((arrow.dragged(vec2(0.0, 900.0), false).0 / 1e6 - 1.0).abs() < 1e-9);
        // Straight to the left is +180, whichever side of it the tip is.
        let left = arrow.dragged(-arrow.way + vec2(-60.0, 1e-4), false);
        assert_eq!(left.1, 180.0);
    }
}
