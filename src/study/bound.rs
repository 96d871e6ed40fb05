//! Bounds and ranks of errors that are measured against a reference solution with an error of its own.

/// Returns the bound of an error, percent, that is measured against a reference whose own error is at most `own`.
pub(super) fn at_most(measured: f64, own: f64) -> f64 {
    measured + own
}

/// Returns for every pair of a time and a measured error `true` if its rank is undecided: its error and the smallest
/// error of the pairs that are not slower differ by less than `own`, the reference's own error.
pub(super) fn undecided(pairs: &[(f64, f64)], own: f64) -> Vec<bool> {
    let is_undecided = |i: usize, &(time, error): &(f64, f64)| {
        let faster = pairs.iter().enumerate().filter(|&(j, &(t, _))| j != i && t <= time).map(|(_, &(_, e))| e);
        let best = faster.fold(f64::INFINITY, f64::min);
        error.is_finite() && (best - error).abs() < own
    };
    pairs.iter().enumerate().map(|(i, pair)| is_undecided(i, pair)).collect()
}

#[cfg(test)]
mod tests {
    use super::undecided;

    #[test]
    fn errors_that_the_reference_cannot_tell_apart_are_undecided() {
        let pairs = [(1.0, 9.0), (2.0, 3.0), (3.0, 2.5), (4.0, 3.4), (5.0, 3.6), (6.0, 0.5), (7.0, f64::INFINITY)];
        assert_eq!(undecided(&pairs, 1.0), [false, false, true, true, false, false, false]);
        assert_eq!(undecided(&pairs, 0.0), [false; 7], "an exact reference decides");
    }
}
