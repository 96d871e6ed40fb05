//! Figures as drawings: lines and marks over linear axes, and the table beside them.

use std::borrow::Borrow;

use super::axes::{ChartAxis, ChartFrame};
use super::drawing::{Anchor, DrawTarget, Drawing};
use crate::format::{number, prefix, rounded};
use crate::study::figure::{Figure, FigureQuantity, Ink, Mark};

const TABLE: f64 = 330.0;

/// Draws figures one below the other, each with the table beside it.
pub fn figures(figures: impl IntoIterator<Item: Borrow<Figure>>) -> Drawing {
    let ChartFrame { size: [width, height], .. } = ChartFrame::FILE;
    let size = [width + TABLE, height];
    let frame = ChartFrame { size, across: [86.0, width - 30.0], up: [height - 64.0, 56.0], ..ChartFrame::FILE };
    let mut drawing = Drawing::default();
    for figure in figures {
        let figure = figure.borrow();
        drawing.page(size, frame.across[0], &figure.title);
        chart(&mut drawing, figure, figure.corners(), &frame);
        table(&mut drawing, figure, frame.across[1] + 24.0, size[0] - 14.0);
    }
    drawing
}

/// Draws axes between two corners and the series; returns the axes.
pub(crate) fn chart(
    drawing: &mut dyn DrawTarget,
    figure: &Figure,
    [mut low, mut high]: [[f64; 2]; 2],
    frame: &ChartFrame,
) -> [ChartAxis; 2] {
    let (ends, area) = ([frame.across, frame.up], frame.area());
    if figure.has_one_scale() {
        let scale = ((high[0] - low[0]) / area[1][0]).max((high[1] - low[1]) / area[1][1]);
        for (i, size) in area[1].into_iter().enumerate() {
            let missing = 0.5 * (scale * size - (high[i] - low[i]));
            (low[i], high[i]) = (low[i] - missing, high[i] + missing);
        }
    }
    let axes = [0, 1].map(|i| ChartAxis::linear([low[i], high[i]], ends[i]));
    let scale = |i: usize| {
        let FigureQuantity { name, unit } = figure.quantity(i)?;
        let (power, symbol) = prefix(&[low[i], high[i]], unit);
        // Seven digits drop the rounding errors of the steps; adding 0 turns −0 into 0.
        let tick = |(place, v): (f64, f64)| (place, number(rounded(v / 10f64.powi(power), 7) + 0.0));
        let unit = format!("{symbol}{unit}");
        let name = if unit.is_empty() { name.clone() } else { format!("{name}, {unit}") };
        Some((axes[i].ticks().into_iter().map(tick).collect(), name))
    };
    let [(x, x_name), (y, y_name)] = [0, 1].map(|i| scale(i).unwrap_or_default());
    frame.grid(drawing, [x, y], [&x_name, &y_name]);
    drawing.clip(Some(area));
    // Marks in the same place lie in each other.
    let mut size = 6.5;
    for series in figure.series.iter().filter(|series| !series.points.is_empty()) {
        let points = series.points.iter().filter_map(|p| figure.place(p));
        let places: Vec<_> = points.map(|[x, y]| [axes[0].place(x), axes[1].place(y)]).collect();
        draw(drawing, series.ink, series.mark, &places, size);
        if series.mark == Mark::Disc {
            size = (size - 1.2).max(2.0);
        }
    }
    drawing.clip(None);
    axes
}

fn table(drawing: &mut Drawing, figure: &Figure, left: f64, right: f64) {
    const ROW: f64 = 21.0;
    let mut y = 66.0;
    let put = |drawing: &mut Drawing, [name, value]: [&str; 2], y: f64| {
        drawing.text([left + 26.0, y], Anchor::Start, Ink::Text, name);
        drawing.text([right, y], Anchor::End, Ink::Text, value);
    };
    let [name, value] = &figure.head;
    put(drawing, [name, value], y);
    for (series, value) in figure.rows() {
        y += ROW;
        put(drawing, [&series.name, value], y);
        let middle = y - 4.5;
        let ends: &[f64] = if series.mark.is_line() { &[0.0, 20.0] } else { &[10.0] };
        let places: Vec<_> = ends.iter().map(|along| [left + along, middle]).collect();
        draw(drawing, series.ink, series.mark, &places, 4.5);
    }
}

/// Draws a series at its places in the picture.
pub(crate) fn draw(drawing: &mut dyn DrawTarget, ink: Ink, mark: Mark, places: &[[f64; 2]], size: f64) {
    let dashes: &[f64] = match mark {
        Mark::Dashes => &[9.0, 5.0],
        Mark::Dots => &[2.0, 5.0],
        _ => &[],
    };
    if mark.is_line() {
        return drawing.line(places, ink, 2.2, dashes);
    }
    for &[x, y] in places {
        match mark {
            Mark::Ring => drawing.circle([x, y], size, ink, Some(1.5)),
            _ => drawing.circle([x, y], size, ink, None),
        }
    }
}
