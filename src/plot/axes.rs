//! Axes of drawings: their place, scales, grids and the marks of elements.

use super::drawing::{Anchor, DrawTarget};
use crate::format::ticks;
use crate::scene::ElementKind;
use crate::study::figure::Ink;

/// Size of a chart, and the place of its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChartFrame {
    pub size: [f64; 2],
    /// Left and right ends of the horizontal axis.
    pub across: [f64; 2],
    /// Lower and upper ends of the vertical axis.
    pub up: [f64; 2],
    /// Space around everything, beside the names of the axes.
    pub edge: f64,
}

impl ChartFrame {
    /// Frame in a file, with room for a legend on the right.
    pub const FILE: Self = Self { size: [860.0, 560.0], across: [80.0, 670.0], up: [500.0, 48.0], edge: 8.0 };

    /// Upper left corner and size of the area between the axes.
    pub fn area(&self) -> [[f64; 2]; 2] {
        let ([left, right], [bottom, top]) = (self.across, self.up);
        [[left, top], [right - left, bottom - top]]
    }

    /// Draws lines at places of both axes with their numbers, and the names of the axes.
    pub fn grid(&self, drawing: &mut dyn DrawTarget, [x, y]: [Vec<(f64, String)>; 2], [x_name, y_name]: [&str; 2]) {
        let ([left, right], [bottom, top]) = (self.across, self.up);
        for (at, text) in x {
            drawing.line(&[[at, top], [at, bottom]], Ink::Grid, 1.0, &[]);
            drawing.text([at, bottom + 18.0], Anchor::Middle, Ink::Text, &text);
        }
        for (at, text) in y {
            drawing.line(&[[left, at], [right, at]], Ink::Grid, 1.0, &[]);
            drawing.text([left - 8.0, at + 4.0], Anchor::End, Ink::Text, &text);
        }
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        drawing.text([middle[0], self.size[1] - self.edge - 6.0], Anchor::Middle, Ink::Text, x_name);
        drawing.text([self.edge + 14.0, middle[1]], Anchor::Upright, Ink::Text, y_name);
    }
}

/// Axis between two places, linear or logarithmic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChartAxis {
    is_logarithmic: bool,
    /// Values at the ends, or their logarithms.
    range: [f64; 2],
    ends: [f64; 2],
}

impl ChartAxis {
    pub fn linear(range: [f64; 2], ends: [f64; 2]) -> Self {
        Self { is_logarithmic: false, range, ends }
    }

    pub fn logarithmic(range: [f64; 2], ends: [f64; 2]) -> Self {
        Self { is_logarithmic: true, range: range.map(f64::log10), ends }
    }

    /// Decades around these values, between two places.
    pub fn decades(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let range = if low > high { [0.0, 1.0] } else { [low.floor(), high.ceil().max(low.floor() + 1.0)] };
        Self { is_logarithmic: true, range, ends }
    }

    /// Returns the value at a place; the inverse of [`Self::place`].
    #[cfg(feature = "app")]
    pub fn value(&self, place: f64) -> f64 {
        let ([from, to], [start, end]) = (self.range, self.ends);
        let fraction = if end == start { 0.0 } else { (place - start) / (end - start) };
        let at = from + (to - from) * fraction.clamp(0.0, 1.0);
        if self.is_logarithmic { 10f64.powf(at) } else { at }
    }

    pub fn place(&self, value: f64) -> f64 {
        let ([from, to], [start, end]) = (self.range, self.ends);
        let at = if self.is_logarithmic { value.max(f64::MIN_POSITIVE).log10() } else { value };
        start + (end - start) * (at - from) / (to - from)
    }

    /// Returns the places and the values of round numbers, as many as have room: of decades, if fewer than two are in the
    /// range, with those of 2 and 5.
    pub fn ticks(&self) -> Vec<(f64, f64)> {
        const MAX_TICKS: u32 = 8;
        let ([from, to], [start, end]) = (self.range, self.ends);
        // Numbers beside a vertical axis, which ends above its start, need less room.
        let apart = match (self.is_logarithmic, start > end) {
            (_, true) => 22.0,
            (true, false) => 40.0,
            (false, false) => 60.0,
        };
        let room = ((end - start).abs() / apart).max(1.0);
        let values = if self.is_logarithmic {
            let of = |digits: &'static [f64]| {
                let powers = from.floor() as i32..=to.floor() as i32;
                let all = powers.flat_map(|e| digits.iter().map(move |digit| digit * 10f64.powi(e)));
                all.filter(|value| (from..=to).contains(&value.log10())).collect::<Vec<f64>>()
            };
            // One decade alone does not show the scale.
            let decades = of(&[1.0]);
            let step = ((to - from) / room).ceil().max(1.0) as usize;
            if decades.len() > 1 { decades.into_iter().step_by(step).collect() } else { of(&[1.0, 2.0, 5.0]) }
        } else {
            ticks(from, to, (room as u32).clamp(2, MAX_TICKS))
        };
        values.into_iter().map(|value| (self.place(value), value)).collect()
    }
}

/// Returns the corners of the mark of an element: as many as it has nodes.
pub(crate) fn mark([x, y]: [f64; 2], element: ElementKind, size: f64) -> Vec<[f64; 2]> {
    let corners = element.entry().nodes.len();
    let corner = |i: usize| {
        let (s, c) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
        [x + size * s, y - size * c]
    };
    (0..corners).map(corner).collect()
}
