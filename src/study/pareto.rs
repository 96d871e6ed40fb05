//! Which measurements no other beats.

/// For every pair of a time and an error, whether no other pair is less in one and no more in the other. Of equals the
/// first is kept; a pair that is not finite is never kept.
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
    fn the_front_is_what_no_other_beats() {
        let pairs = [(1.0, 9.0), (2.0, 3.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (4.0, 1.0), (0.1, f64::INFINITY)];
        assert_eq!(front(&pairs), [true, true, false, false, false, true, false]);
    }
}
