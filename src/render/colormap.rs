//! Colour maps. Every colour of a map has a contrast of at least 3:1 with its background (WCAG; tested in
//! `app/widgets/palette.rs`), so a map is the part of a published scale that satisfies this: the higher the value, the
//! higher the contrast.

use std::sync::LazyLock;

/// Colour map of [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// From blue to pale yellow (Brewer 2003, `YlGnBu`, without its ends), for non-negative values on a dark
    /// background.
    #[default]
    SequentialOnDark,
    /// From teal to navy, the other part of the same scale, on a light background.
    SequentialOnLight,
    /// From blue through pale to red (`RdBu`), for signed values on a dark background.
    DivergingOnDark,
    /// From blue through dark grey to red, on a light background.
    DivergingOnLight,
}

impl ColorMap {
    /// All colour maps.
    pub const ALL: [Self; 4] =
        [Self::SequentialOnDark, Self::SequentialOnLight, Self::DivergingOnDark, Self::DivergingOnLight];

    /// Returns the colour of `t` in [0, 1]; values outside get the colour of the nearer end.
    pub fn color(self, t: f64) -> [u8; 3] {
        let t = if t.is_nan() { 0.5 } else { t.clamp(0.0, 1.0) };
        let table = &TABLES[self as usize];
        table[(t * (TABLE - 1) as f64).round() as usize]
    }

    /// Computes a colour for the table.
    fn evaluate(self, t: f64) -> [u8; 3] {
        let part = |scale: colorous::Gradient, from: f64, to: f64| {
            let c = scale.eval_continuous(from + (to - from) * t);
            [c.r, c.g, c.b]
        };
        match self {
            Self::SequentialOnDark => part(colorous::YELLOW_GREEN_BLUE, 0.69, 0.03),
            Self::SequentialOnLight => part(colorous::YELLOW_GREEN_BLUE, 0.63, 1.0),
            Self::DivergingOnDark => part(colorous::RED_BLUE, 0.84, 0.16),
            Self::DivergingOnLight => {
                const STOPS: [[f64; 3]; 3] = [[0.0, 124.0, 190.0], [52.0, 54.0, 60.0], [214.0, 66.0, 30.0]];
                let (from, to, s) =
                    if t < 0.5 { (STOPS[0], STOPS[1], 2.0 * t) } else { (STOPS[1], STOPS[2], 2.0 * t - 1.0) };
                [0, 1, 2].map(|i| (from[i] + (to[i] - from[i]) * s).round() as u8)
            }
        }
    }
}

/// Number of colours of a table.
const TABLE: usize = 256;

/// Tables of all maps, computed once: a fine mesh looks up 200 000 colours per frame.
static TABLES: LazyLock<[[[u8; 3]; TABLE]; 4]> =
    LazyLock::new(|| ColorMap::ALL.map(|map| std::array::from_fn(|i| map.evaluate(i as f64 / (TABLE - 1) as f64))));

/// Returns the position of `value` in `range`, in [0, 1]; 0.5 if the range is empty.
pub fn position(value: f64, range: [f64; 2]) -> f64 {
    let [low, high] = range;
    // Halved so that the difference of two large numbers does not overflow.
    let (span, above) = (0.5 * high - 0.5 * low, 0.5 * value - 0.5 * low);
    if span > 0.0 { (above / span).clamp(0.0, 1.0) } else { 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn higher_values_are_farther_from_the_ground() {
        let luminance = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
        let samples =
            |map: ColorMap| -> Vec<f64> { (0..=20).map(|i| luminance(map.color(f64::from(i) / 20.0))).collect() };
        let (dark, light) = (samples(ColorMap::SequentialOnDark), samples(ColorMap::SequentialOnLight));
        assert!(dark.windows(2).all(|w| w[1] > w[0]), "{dark:?}");
        assert!(light.windows(2).all(|w| w[1] < w[0]), "{light:?}");
    }

    #[test]
    fn the_two_signs_of_a_diverging_map_differ_in_hue() {
        for map in [ColorMap::DivergingOnDark, ColorMap::DivergingOnLight] {
            let ([low, _, low_blue], [high, _, high_blue]) = (map.color(0.0), map.color(1.0));
            assert!(low_blue > low && high > high_blue, "{map:?}");
            let middle = map.color(0.5).map(f64::from);
            let spread = middle.iter().fold(0.0_f64, |m, v| m.max((v - middle[1]).abs()));
            assert!(spread < 24.0, "{map:?}: zero is {middle:?}");
        }
    }

    #[test]
    fn positions_of_extreme_ranges_are_in_the_unit_interval() {
        assert_eq!(position(5.0, [5.0, 5.0]), 0.5);
        assert_eq!(position(f64::MAX, [-f64::MAX, f64::MAX]), 1.0);
        assert_eq!(position(0.0, [-f64::MAX, f64::MAX]), 0.5);
        assert_eq!(position(-3.0, [0.0, 1.0]), 0.0);
    }
}
