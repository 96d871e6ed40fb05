//! Pareto front of measurements.

/// Returns for every pair of a time and an error `true` if no other pair is smaller in one and not larger in the other.
/// Of equal pairs the first is kept; pairs that are not finite are not kept.
pub(super) fn front(pairs: &[(f64, f64)]) -> Vec<bool> {
    let is_front = |i: usize, &(time, error): &(f64, f64)| {
        time.is_finite()
            && error.is_finite()
            && !pairs.iter().enumerate().any(|(j, &(t, e))| {
                (t <= time && e < error) || (t < time && e <= error) || (t == time && e == error && j < i)
            })
    };
    pairs.iter().enumerate().map(|(i, pair)| is_front(i, pair)).collect()
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn the_front_has_the_settings_that_no_other_beats() {
        let pairs = [(1.0, 9.0), (2.0, 3.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (4.0, 1.0), (0.1, f64::INFINITY)];
        assert_eq!(front(&pairs), [true, true, false, false, false, true, false]);
    }
}
