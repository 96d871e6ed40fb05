//! Figures as drawings: lines and marks over linear axes, and the table beside them.

use super::axes::{PlotMargins, SIZE};
use super::drawing::{Anchor, Drawing, Stroke, solid};
use crate::format::{number, prefix, rounded, ticks};
use crate::study::color;
use crate::study::figure::{Figure, Ink, Mark};

const TABLE: f64 = 330.0;
const MARGINS: PlotMargins =
    PlotMargins { width: SIZE[0] + TABLE, left: 86.0, right: TABLE + 30.0, top: 56.0, bottom: 64.0 };

/// Draws figures one below the other, each with the table beside it.
pub fn figures<'a>(figures: impl IntoIterator<Item = &'a Figure>) -> Drawing {
    let mut drawing = Drawing::default();
    figures.into_iter().for_each(|figure| add(&mut drawing, figure));
    drawing
}

fn add(drawing: &mut Drawing, figure: &Figure) {
    let ends = [MARGINS.across(), MARGINS.up()];
    let [mut low, mut high] = figure.corners();
    if figure.has_one_scale() {
        let sizes = [ends[0][1] - ends[0][0], ends[1][0] - ends[1][1]];
        let scale = ((high[0] - low[0]) / sizes[0]).max((high[1] - low[1]) / sizes[1]);
        for (i, size) in sizes.into_iter().enumerate() {
            let missing = 0.5 * (scale * size - (high[i] - low[i]));
            (low[i], high[i]) = (low[i] - missing, high[i] + missing);
        }
    }
    let place = |value: f64, i: usize| {
        let [from, to] = ends[i];
        from + (to - from) * (value - low[i]) / (high[i] - low[i])
    };
    MARGINS.start(drawing, figure.title.as_str());
    let mut labels = [String::new(), String::new()];
    let mut numbers = [Vec::new(), Vec::new()];
    for i in 0..2 {
        let Some(quantity) = figure.quantity(i) else { continue };
        let (power, symbol) = prefix(&[low[i], high[i]], quantity.unit);
        let unit = format!("{symbol}{}", quantity.unit);
        labels[i] = if unit.is_empty() { quantity.name.clone() } else { format!("{}, {unit}", quantity.name) };
        let values = ticks(low[i], high[i], 8);
        // Seven digits drop the rounding errors of the steps; adding 0 turns −0 into 0.
        let tick = |v: f64| number(rounded(v / 10f64.powi(power), 7) + 0.0);
        numbers[i] = values.into_iter().map(|v| (place(v, i), tick(v))).collect();
    }
    MARGINS.grid(drawing, numbers, [&labels[0], &labels[1]]);
    let [[left, right], [bottom, top]] = ends;
    drawing.clipped([[left, top], [right - left, bottom - top]], |drawing| {
        // Marks in the same place lie in each other.
        let mut size = 6.5;
        for series in figure.series.iter().filter(|series| !series.points.is_empty()) {
            let points = series.points.iter().filter_map(|p| figure.place(p));
            draw(
                drawing,
                series.ink,
                series.mark,
                &points.map(|[x, y]| [place(x, 0), place(y, 1)]).collect::<Vec<_>>(),
                size,
            );
            if series.mark == Mark::Disc {
                size = (size - 1.2).max(2.0);
            }
        }
    });
    table(drawing, figure, right + 24.0, MARGINS.width - 14.0);
}

fn table(drawing: &mut Drawing, figure: &Figure, left: f64, right: f64) {
    const ROW: f64 = 21.0;
    let mut y = 66.0;
    let put = |drawing: &mut Drawing, [name, value]: [&str; 2], y: f64| {
        drawing.text([left + 26.0, y], Anchor::Start, name);
        drawing.text([right, y], Anchor::End, value);
    };
    let [name, value] = &figure.head;
    put(drawing, [name, value], y);
    for (series, value) in figure.rows() {
        y += ROW;
        put(drawing, [&series.name, value], y);
        let middle = y - 4.5;
        let line = || vec![[left, middle], [left + 20.0, middle]];
        let places = if series.mark.is_line() { line() } else { vec![[left + 10.0, middle]] };
        draw(drawing, series.ink, series.mark, &places, 4.5);
    }
}

/// Draws a series at its places in the picture.
fn draw(drawing: &mut Drawing, ink: Ink, mark: Mark, places: &[[f64; 2]], size: f64) {
    let color = match ink {
        Ink::Method(method) => color(method.id(), false),
        Ink::Unstable => [0xbe, 0x14, 0x1e],
        Ink::BeamTheory | Ink::Scene => [0x1c, 0x21, 0x28],
    };
    let dashes: &[f64] = match mark {
        Mark::Dashes => &[9.0, 5.0],
        Mark::Dots => &[2.0, 5.0],
        _ => &[],
    };
    if mark.is_line() {
        return drawing.line(places, color, Stroke { width: 2.2, dashes });
    }
    for &[x, y] in places {
        let mut cross = |ends: [[f64; 2]; 2]| {
            drawing.line(&ends.map(|[u, v]| [x + size * u, y + size * v]), color, solid(2.0));
        };
        match mark {
            Mark::Cross => [[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]].into_iter().for_each(&mut cross),
            Mark::Ring => drawing.circle([x, y], size, color, Some(solid(1.5))),
            _ => drawing.circle([x, y], size, color, None),
        }
    }
}
