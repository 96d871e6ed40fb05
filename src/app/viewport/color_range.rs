//! Value range of the colour map of a field.

/// Returns the smallest and the largest value; the range is never empty. If the values differ by rounding only, the
/// range is widened so that they get the same colour.
pub(crate) fn range_of(values: &[Option<f64>]) -> [f64; 2] {
    const SAME: f64 = 1e-6;
    const WIDENED: f64 = 1e-2;
    let [low, high] =
        values.iter().flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &v| [low.min(v), high.max(v)]);
    let size = low.abs().max(high.abs());
    if !size.is_finite() || size == 0.0 {
        [0.0, 1.0]
    } else if 0.5 * high - 0.5 * low > 0.5 * SAME * size {
        [low, high]
    } else {
        [low - WIDENED * size, high + WIDENED * size].map(|v| v.clamp(-f64::MAX, f64::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_never_empty() {
        for values in [&[][..], &[0.0], &[5.0, 5.0], &[-2.0], &[1.0, 3.0], &[f64::MAX; 2], &[5.0, 5.0 + 1e-12]] {
            let values: Vec<Option<f64>> = values.iter().copied().map(Some).chain([None]).collect();
            let [low, high] = range_of(&values);
            assert!(low < high, "{values:?}");
        }
    }
}
