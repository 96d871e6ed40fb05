//! Values to colours: cividis, made for readers with and without colour vision deficiency (Nuñez et al. 2018).

/// The colour of `t` in [0, 1]; outside, the colour of the nearer end.
#[must_use]
pub fn color(t: f64) -> [u8; 3] {
    let c = colorous::CIVIDIS.eval_continuous(t.clamp(0.0, 1.0));
    [c.r, c.g, c.b]
}

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
    fn brightness_grows_with_the_value() {
        let luminance = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
        let samples: Vec<f64> = (0..=20).map(|i| luminance(color(f64::from(i) / 20.0))).collect();
        assert!(samples.windows(2).all(|w| w[1] > w[0]), "{samples:?}");
    }

    #[test]
    fn positions_of_extreme_ranges_are_in_the_unit_interval() {
        assert_eq!(position(5.0, [5.0, 5.0]), 0.5);
        assert_eq!(position(f64::MAX, [-f64::MAX, f64::MAX]), 1.0);
        assert_eq!(position(0.0, [-f64::MAX, f64::MAX]), 0.5);
        assert_eq!(position(-3.0, [0.0, 1.0]), 0.0);
    }
}
