//! Axes of drawings: margins, scales, grids and the marks of elements.

use super::drawing::{Anchor, Drawing, GRID, Text, solid};
use crate::scene::ElementKind;

pub(super) const SIZE: [f64; 2] = [860.0, 560.0];
/// Height of a row of a legend.
pub(super) const ROW: f64 = 22.0;

/// Place of the axes in a drawing: the space around them.
pub(super) struct PlotMargins {
    pub width: f64,
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

/// Room for a legend on the right.
pub(super) const MARGINS: PlotMargins =
    PlotMargins { width: SIZE[0], left: 80.0, right: 190.0, top: 48.0, bottom: 60.0 };

/// Logarithmic axis of positive values.
pub(crate) struct ScaledAxis {
    /// Logarithms of the values at the ends.
    from: f64,
    to: f64,
    ends: [f64; 2],
}

impl ScaledAxis {
    /// Returns an axis between two places that shows a range of values.
    pub fn of([low, high]: [f64; 2], ends: [f64; 2]) -> Self {
        Self { from: low.log10(), to: high.log10(), ends }
    }

    /// Decades around these values, between two places.
    pub fn decades(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let [from, to] = if low > high { [0.0, 1.0] } else { [low.floor(), high.ceil().max(low.floor() + 1.0)] };
        Self { from, to, ends }
    }

    /// Returns the value at a place; the inverse of [`Self::place`].
    #[cfg(feature = "app")]
    pub fn value(&self, place: f64) -> f64 {
        let [start, end] = self.ends;
        let fraction = if end == start { 0.0 } else { (place - start) / (end - start) };
        let at = self.from + (self.to - self.from) * fraction.clamp(0.0, 1.0);
        10f64.powf(at)
    }

    pub fn place(&self, value: f64) -> f64 {
        let fraction = (value.max(f64::MIN_POSITIVE).log10() - self.from) / (self.to - self.from);
        let [start, end] = self.ends;
        start + (end - start) * fraction.clamp(0.0, 1.0)
    }

    /// Returns the positions and the values of the decades, with those of 2 and 5 if there are fewer than two decades.
    pub fn values(&self) -> Vec<(f64, f64)> {
        let [from, to] = [self.from.floor() as i32, self.to.floor() as i32];
        let of = |digits: &'static [f64]| {
            let all = (from..=to).flat_map(|e| digits.iter().map(move |digit| digit * 10f64.powi(e)));
            all.filter(|value| (self.from..=self.to).contains(&value.log10())).collect::<Vec<f64>>()
        };
        // One decade alone does not show the scale.
        let decades = of(&[1.0]);
        let values = if decades.len() > 1 { decades } else { of(&[1.0, 2.0, 5.0]) };
        values.into_iter().map(|value| (self.place(value), value)).collect()
    }
}

impl PlotMargins {
    /// Left and right ends of the horizontal axis.
    pub fn across(&self) -> [f64; 2] {
        [self.left, self.width - self.right]
    }

    /// Lower and upper ends of the vertical axis.
    pub fn up(&self) -> [f64; 2] {
        [SIZE[1] - self.bottom, self.top]
    }

    /// Adds a page with its title.
    pub fn start(&self, drawing: &mut Drawing, title: impl Into<String>) {
        drawing.page([self.width, SIZE[1]]);
        drawing.put(Text { size: 16.0, ..Text::new([self.left, 28.0], Anchor::Start, title) });
    }

    /// Draws lines at places of both axes with their numbers, and the labels of the axes.
    pub fn grid(&self, drawing: &mut Drawing, [x, y]: [Vec<(f64, String)>; 2], [x_label, y_label]: [&str; 2]) {
        let ([left, right], [bottom, top]) = (self.across(), self.up());
        for (at, text) in x {
            drawing.line(&[[at, top], [at, bottom]], GRID, solid(1.0));
            drawing.text([at, bottom + 18.0], Anchor::Middle, text);
        }
        for (at, text) in y {
            drawing.line(&[[left, at], [right, at]], GRID, solid(1.0));
            drawing.text([left - 8.0, at + 4.0], Anchor::End, text);
        }
        drawing.text([0.5 * (left + right), SIZE[1] - 14.0], Anchor::Middle, x_label);
        let label = Text::new([22.0, 0.5 * (top + bottom)], Anchor::Middle, y_label);
        drawing.put(Text { is_upright: true, ..label });
    }
}

/// Returns the corners of the mark of an element: as many as it has nodes.
pub(super) fn mark([x, y]: [f64; 2], element: ElementKind, size: f64) -> Vec<[f64; 2]> {
    let corners = element.entry().nodes.len();
    let corner = |i: usize| {
        let (s, c) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
        [x + size * s, y - size * c]
    };
    (0..corners).map(corner).collect()
}
