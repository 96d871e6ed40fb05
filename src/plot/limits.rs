//! Limits of methods and elements as a drawing: the load curve above, and a strip for each method and element below it.

use super::axes::Decades;
use super::drawing::{Anchor, Color, Drawing, GRID, INK, Item, Outline, Shape, Text, solid};
use crate::format::engineering;
use crate::study::limits::{GOOD, MethodLimits, Strip, USABLE};

/// Left and right ends of the strips, pixels.
const ACROSS: [f64; 2] = [150.0, 760.0];
/// Width of the drawing.
const WIDTH: f64 = 1010.0;
/// Upper and lower ends of the load curve.
const CURVE: [f64; 2] = [56.0, 216.0];
/// Height of a strip with the space below it.
const ROW: f64 = 26.0;

const WITHIN_GOOD: Color = [0x3a, 0x9d, 0x5d];
const WITHIN_USABLE: Color = [0xe6, 0xc2, 0x3a];
const BEYOND: Color = [0xe0, 0x7b, 0x39];
const FAILED: Color = [0xbe, 0x14, 0x1e];
const UNKNOWN: Color = [0xc4, 0xc8, 0xcc];

/// Draws the limits over the logarithm of the load.
#[must_use]
pub fn limits(limits: &MethodLimits) -> Drawing {
    let axis = Decades::new(limits.reference.iter().map(|(factor, _)| *factor), ACROSS);
    let top = CURVE[1] + 44.0;
    let bottom = top + ROW * limits.strips.len() as f64;
    let mut drawing = Drawing::new([WIDTH, bottom + 84.0]);
    let title = Text::new([ACROSS[0] - 130.0, 30.0], Anchor::Start, limits.scene.as_str());
    drawing.items.push(Item::Text(Text { size: 16.0, ..title }));
    let load = |factor: f64| engineering(factor * limits.axis.full, limits.axis.unit);
    for (x, factor) in axis.values() {
        drawing.line(vec![[x, CURVE[0]], [x, bottom]], GRID, solid(1.0));
        drawing.text([x, bottom + 18.0], Anchor::Middle, load(factor));
    }
    // The scene's own load.
    let own = axis.place(1.0);
    drawing.line(vec![[own, CURVE[0]], [own, bottom]], INK, solid(1.0));
    drawing.text([own, CURVE[0] - 6.0], Anchor::Middle, "the scene");
    curve(&mut drawing, limits, &axis);
    for (row, strip) in limits.strips.iter().enumerate() {
        let y = top + ROW * row as f64;
        drawing.text(
            [ACROSS[0] - 12.0, y + 14.0],
            Anchor::End,
            format!("{} {}", strip.element.id(), strip.method.id()),
        );
        bars(&mut drawing, limits, strip, &axis, y);
        let end = match (strip.ends_at, strip.within(GOOD)) {
            (_, Some(0.0)) => format!("not within {GOOD} %"),
            (_, Some(factor)) => format!("{GOOD} % to {}", load(factor)),
            (Some(factor), None) => format!("converges to {}", load(factor)),
            (None, None) => String::new(),
        };
        drawing.text([ACROSS[1] + 12.0, y + 14.0], Anchor::Start, end);
    }
    legend(&mut drawing, bottom + 46.0);
    drawing.text([0.5 * (ACROSS[0] + ACROSS[1]), bottom + 38.0], Anchor::Middle, limits.axis.name.to_string());
    drawing
}

/// Draws the length of the reference displacement over the load, both logarithmic.
fn curve(drawing: &mut Drawing, limits: &MethodLimits, axis: &Decades) {
    let lengths = limits.reference.iter().map(|(factor, u)| (*factor, u.map(|u| u.norm()).filter(|u| *u > 0.0)));
    let lengths: Vec<(f64, Option<f64>)> = lengths.collect();
    let up = Decades::new(lengths.iter().filter_map(|(_, u)| *u), [CURVE[1], CURVE[0]]);
    for (y, length) in up.values() {
        drawing.line(vec![[ACROSS[0], y], [ACROSS[1], y]], GRID, solid(1.0));
        drawing.text([ACROSS[0] - 12.0, y + 4.0], Anchor::End, engineering(length, "m"));
    }
    for known in lengths.split(|(_, u)| u.is_none()) {
        let places = known.iter().filter_map(|(factor, u)| Some([axis.place(*factor), up.place((*u)?)]));
        drawing.line(places.collect(), INK, solid(2.0));
    }
    drawing.text([ACROSS[1] + 12.0, CURVE[0] + 12.0], Anchor::Start, "reference displacement");
    drawing.text([ACROSS[1] + 12.0, CURVE[0] + 30.0], Anchor::Start, "of the first probe");
}

/// Draws the bars of a strip, from each load to half way to the next one.
fn bars(drawing: &mut Drawing, limits: &MethodLimits, strip: &Strip, axis: &Decades, y: f64) {
    const HEIGHT: f64 = 18.0;
    let loads: Vec<f64> = limits.reference.iter().map(|(factor, _)| axis.place(*factor)).collect();
    let edge = |i: usize| match (i.checked_sub(1).and_then(|before| loads.get(before)), loads.get(i)) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        (None, _) => ACROSS[0],
        (_, None) => ACROSS[1],
    };
    let end = strip.ends_at.map_or(ACROSS[1], |factor| axis.place(factor.max(f64::MIN_POSITIVE)));
    for (i, point) in strip.points.iter().enumerate() {
        let color = match point.error_percent {
            None => UNKNOWN,
            Some(error) if error <= GOOD => WITHIN_GOOD,
            Some(error) if error <= USABLE => WITHIN_USABLE,
            Some(_) => BEYOND,
        };
        let is_last = i + 1 == strip.points.len();
        let (from, to) = (edge(i), if is_last { end } else { edge(i + 1) });
        // No gap shows between bars of one colour.
        let overlap = if is_last { 0.0 } else { 0.5 };
        drawing.rect([[from, y], [(to - from + overlap).max(0.0), HEIGHT]], color);
        if point.is_beyond_law() {
            hatch(drawing, [from, to], [y, y + HEIGHT]);
        }
    }
    if strip.ends_at.is_some() {
        drawing.rect([[end, y], [ACROSS[1] - end, HEIGHT]], FAILED);
    }
}

/// Draws slanted lines over a bar.
fn hatch(drawing: &mut Drawing, [from, to]: [f64; 2], [top, bottom]: [f64; 2]) {
    const GAP: f64 = 7.0;
    drawing.clipped([[from, top], [(to - from).max(0.0), bottom - top]], |drawing| {
        // Lines of neighbouring bars meet.
        let mut x = (from / GAP).floor() * GAP - (bottom - top);
        while x < to {
            let line = vec![[x, bottom], [x + bottom - top, top]];
            drawing.add(Shape::stroked(Outline::Line(line), INK, solid(1.2)));
            x += GAP;
        }
    });
}

fn legend(drawing: &mut Drawing, y: f64) {
    const BOX: f64 = 14.0;
    let entries = [
        (WITHIN_GOOD, format!("within {GOOD} %")),
        (WITHIN_USABLE, format!("within {USABLE} %")),
        (BEYOND, format!("above {USABLE} %")),
        (FAILED, "does not converge".to_owned()),
        (UNKNOWN, "error not known".to_owned()),
    ];
    let mut x = 20.0;
    for (color, text) in entries {
        drawing.rect([[x, y], [BOX, BOX]], color);
        drawing.text([x + BOX + 6.0, y + 12.0], Anchor::Start, text.as_str());
        x += 46.0 + 7.4 * text.chars().count() as f64;
    }
    drawing.rect([[x, y], [BOX, BOX]], [0xff; 3]);
    hatch(drawing, [x, x + BOX], [y, y + BOX]);
    drawing.text([x + BOX + 6.0, y + 12.0], Anchor::Start, "strains above 10 %, or inverted elements");
}
