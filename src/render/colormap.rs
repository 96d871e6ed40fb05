//! Values to colours. Every colour of a map stands out from its ground by WCAG's 3:1 (`app/palette.rs` computes it), so a
//! map is the part of a scale that does: the higher a value, the farther from the ground.

use std::sync::LazyLock;

/// A map of [0, 1] to colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// From blue to pale yellow (Brewer 2003, `YlGnBu`, without its ends), for values from nothing to much on a dark
    /// ground.
    #[default]
    SequentialOnDark,
    /// From teal to navy, the other part of the same scale, on a light ground.
    SequentialOnLight,
    /// From blue over pale to red (`RdBu`), for values with a sign on a dark ground.
    DivergingOnDark,
    /// From blue over dark grey to red, on a light ground.
    DivergingOnLight,
}

impl ColorMap {
    /// Every map.
    pub const ALL: [Self; 4] =
        [Self::SequentialOnDark, Self::SequentialOnLight, Self::DivergingOnDark, Self::DivergingOnLight];

    /// The colour of `t` in [0, 1]; outside, the colour of the nearer end.
    #[must_use]
    pub fn color(self, t: f64) -> [u8; 3] {
        let t = if t.is_nan() { 0.5 } else { t.clamp(0.0, 1.0) };
        let table = &TABLES[self as usize];
        table[(t * (TABLE - 1) as f64).round() as usize]
    }

    /// What the table is made of.
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

/// Colours of a map.
const TABLE: usize = 256;

/// The colours of every map, evaluated once: a fine mesh asks for 200 000 of them a frame.
static TABLES: LazyLock<[[[u8; 3]; TABLE]; 4]> =
    LazyLock::new(|| ColorMap::ALL.map(|map| std::array::from_fn(|i| map.evaluate(i as f64 / (TABLE - 1) as f64))));

/// Where `value` lies in `range`, in [0, 1]; the middle where the range is empty.
#[must_use]
pub fn position(value: f64, range: [f64; 2]) -> f64 {
    let [low, high] = range;
    // Halved, so that the difference of two large numbers stays finite.
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
