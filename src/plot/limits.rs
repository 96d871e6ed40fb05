//! Limits of methods and elements as a drawing: the load curve above, and a strip for each method and element below it.

use super::axes::ScaledAxis;
use super::drawing::{Anchor, Color, Drawing, GRID, INK, Stroke, Text, solid};
use crate::format::engineering;
use crate::scene::Scene;
use crate::study::figure::LoadAxis;
use crate::study::limits::{MethodLimits, Rating, axis_text, load_text};

/// Left and right ends of the strips, pixels.
const ACROSS: [f64; 2] = [150.0, 760.0];
const WIDTH: f64 = 1010.0;
/// Upper and lower ends of the load curve.
const CURVE: [f64; 2] = [56.0, 216.0];
/// Height of a strip, and with the space below it.
const HEIGHT: f64 = 18.0;
const ROW: f64 = 26.0;
/// Width by which bars overlap, so that no gap shows between those of one colour.
const OVERLAP: f64 = 0.5;

pub(crate) fn rating_color(rating: Rating) -> Color {
    match rating {
        Rating::Good => [0x3a, 0x9d, 0x5d],
        Rating::Usable => [0xe6, 0xc2, 0x3a],
        Rating::Beyond => [0xe0, 0x7b, 0x39],
        Rating::NotConverged => [0xbe, 0x14, 0x1e],
        Rating::Unknown => [0xc4, 0xc8, 0xcc],
    }
}

/// Draws the limits of a scene over the load.
pub fn limits(limits: &MethodLimits, scene: &Scene) -> Drawing {
    let loads = LoadAxis::of(scene);
    let axis = ScaledAxis::of(limits.range, ACROSS);
    // A motion has no load curve.
    let top = 44.0 + if limits.reference.is_empty() { CURVE[0] } else { CURVE[1] };
    let bottom = top + ROW * limits.strips.len() as f64;
    let mut drawing = Drawing::default();
    drawing.page([WIDTH, bottom + 84.0]);
    let title = Text::new([ACROSS[0] - 130.0, 30.0], Anchor::Start, scene.name.as_str());
    drawing.put(Text { size: 16.0, ..title });
    for (x, factor) in axis.values() {
        drawing.line(&[[x, CURVE[0]], [x, bottom]], GRID, solid(1.0));
        drawing.text([x, bottom + 18.0], Anchor::Middle, load_text(&loads, factor));
    }
    // The scene's own load.
    if limits.contains(1.0) {
        let own = axis.place(1.0);
        drawing.line(&[[own, CURVE[0]], [own, bottom]], INK, solid(1.0));
        drawing.text([own, CURVE[0] - 6.0], Anchor::Middle, "the scene");
    }
    if let Some(critical) = limits.critical().filter(|&critical| limits.contains(critical)) {
        let x = axis.place(critical);
        let dashes = Stroke { dashes: &[6.0, 4.0], ..solid(1.5) };
        drawing.line(&[[x, CURVE[0]], [x, bottom]], rating_color(Rating::NotConverged), dashes);
    }
    if !limits.reference.is_empty() {
        curve(&mut drawing, limits, &axis);
    }
    for (row, strip) in limits.strips.iter().enumerate() {
        let y = top + ROW * row as f64;
        drawing.text([ACROSS[0] - 12.0, y + 14.0], Anchor::End, strip.name(str::to_owned));
        let pieces = strip.pieces(limits.range);
        for (i, piece) in pieces.iter().enumerate() {
            let [from, to] = piece.range.map(|factor| axis.place(factor));
            let is_joined = pieces.get(i + 1).is_some_and(|next| next.rating != Rating::NotConverged);
            let overlap = if is_joined { OVERLAP } else { 0.0 };
            drawing.rect([[from, y], [(to - from + overlap).max(0.0), HEIGHT]], rating_color(piece.rating));
            if piece.is_beyond_law {
                hatch(&mut drawing, [from, to], [y, y + HEIGHT]);
            }
        }
        let end = strip.end(&loads, limits.range).map_or_else(String::new, |end| end.to_string());
        drawing.text([ACROSS[1] + 12.0, y + 14.0], Anchor::Start, end);
    }
    legend(&mut drawing, bottom + 46.0, limits.duration.is_some());
    let name = axis_text(limits, &loads).to_string();
    drawing.text([0.5 * (ACROSS[0] + ACROSS[1]), bottom + 38.0], Anchor::Middle, name);
    drawing
}

/// Draws the length of the reference displacement over the load.
fn curve(drawing: &mut Drawing, limits: &MethodLimits, axis: &ScaledAxis) {
    let lengths = limits.reference.iter().map(|(factor, u)| (*factor, u.map(|u| u.norm()).filter(|u| *u > 0.0)));
    let lengths: Vec<(f64, Option<f64>)> = lengths.collect();
    let up = ScaledAxis::decades(lengths.iter().filter_map(|(_, u)| *u), [CURVE[1], CURVE[0]]);
    for (y, length) in up.values() {
        drawing.line(&[[ACROSS[0], y], [ACROSS[1], y]], GRID, solid(1.0));
        drawing.text([ACROSS[0] - 12.0, y + 4.0], Anchor::End, engineering(length, "m"));
    }
    for known in lengths.split(|(_, u)| u.is_none()) {
        let places = known.iter().filter_map(|(factor, u)| Some([axis.place(*factor), up.place((*u)?)]));
        drawing.line(&places.collect::<Vec<_>>(), INK, solid(2.0));
    }
    drawing.text([ACROSS[1] + 12.0, CURVE[0] + 12.0], Anchor::Start, "reference displacement");
    drawing.text([ACROSS[1] + 12.0, CURVE[0] + 30.0], Anchor::Start, "of the first probe");
}

/// Draws slanted lines over a bar.
fn hatch(drawing: &mut Drawing, [from, to]: [f64; 2], [top, bottom]: [f64; 2]) {
    const GAP: f64 = 7.0;
    drawing.clipped([[from, top], [(to - from).max(0.0), bottom - top]], |drawing| {
        // Lines of neighbouring bars meet.
        let mut x = (from / GAP).floor() * GAP - (bottom - top);
        while x < to {
            drawing.line(&[[x, bottom], [x + bottom - top, top]], INK, solid(1.2));
            x += GAP;
        }
    });
}

fn legend(drawing: &mut Drawing, y: f64, moves: bool) {
    const BOX: f64 = 14.0;
    let mut x = 20.0;
    for (rating, name) in Rating::all(moves) {
        let text = name.to_string();
        drawing.rect([[x, y], [BOX, BOX]], rating_color(rating));
        drawing.text([x + BOX + 6.0, y + 12.0], Anchor::Start, text.as_str());
        x += 46.0 + 7.4 * text.chars().count() as f64;
    }
    drawing.rect([[x, y], [BOX, BOX]], [0xff; 3]);
    hatch(drawing, [x, x + BOX], [y, y + BOX]);
    drawing.text([x + BOX + 6.0, y + 12.0], Anchor::Start, "strains above 10 %, or inverted elements");
}
