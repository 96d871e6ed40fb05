//! Bound of the remaining error of solutions on uniformly refined meshes.

use nalgebra::Vector2;

/// Slowest rate at which a mean displacement with finite energy converges when elements are halved: at the tip of a
/// crack, where the error is proportional to the element size. Clamped and re-entrant corners are faster (Szabó and
/// Babuška 1991, *Finite Element Analysis*, chapter 10).
const SLOWEST: f64 = 0.5;
/// Rate without singularities: the error is proportional to the square of the element size.
const ORDINARY: f64 = 0.25;
/// Safety factor of the bound relative to the estimate.
const SAFETY: f64 = 2.0;
/// Largest ratio of two changes for which a sequence counts as converging.
const STALLED: f64 = 0.85;
/// Ratio used if the previous change was small by chance, because errors of two kinds cancelled.
const ERRATIC: f64 = 0.75;
/// Changes below this fraction of a displacement are rounding errors.
const ROUNDING: f64 = 1e-7;
/// Number of further halvings covered by the bound if each changes the displacement by the same amount.
const HALVINGS: f64 = 8.0;
/// Smallest part of the last change, relative to it, that may recur with every halving beside a point.
const HIDDEN: f64 = 0.25;

/// Returns the bound of the distance from the last of these displacements, m, to their limit on finer and finer meshes,
/// m. `None` for a single displacement.
///
/// The changes d₁, d₂, … of a converging sequence decrease by a ratio q, and the remaining ones sum to d q/(1 − q). A
/// single change does not show the ratio: the slowest is assumed.
///
/// If the changes do not decrease, there may be no limit. The bound then holds for meshes with elements down to 1/256 of
/// the size. Beside forces and supports on points (`has_point`) see [`error_beside_points`].
pub(super) fn remaining_error(displacements: &[Vector2<f64>], has_point: bool) -> Option<f64> {
    let size = displacements.last()?.norm();
    let steps: Vec<Vector2<f64>> = displacements.windows(2).map(|w| w[1] - w[0]).collect();
    let changes: Vec<f64> = steps.iter().map(Vector2::norm).collect();
    let (last, before, earlier) = match *changes.as_slice() {
        [] => return None,
        [only] => (only, only / SLOWEST, only / SLOWEST),
        [before, last] => (last, before, before),
        [.., earlier, before, last] => (last, before, earlier),
    };
    if last.max(before) <= ROUNDING * size {
        return Some(SAFETY * ROUNDING * size);
    }
    if has_point {
        return Some(SAFETY * error_beside_points(&steps));
    }
    // A change that is small by chance does not predict the next one.
    let change = last.max(ORDINARY * before);
    let ratio = last / before;
    let (ratio, constant) = if ratio <= STALLED {
        (ratio.max(ORDINARY), 0.0)
    } else if last <= SLOWEST * earlier {
        (ERRATIC, 0.0)
    } else {
        (SLOWEST, last)
    };
    Some(SAFETY * (change * ratio / (1.0 - ratio) + HALVINGS * constant))
}

/// Returns the remaining changes, m, after these ones beside forces and supports on points.
///
/// Under a force on a point each halving adds the same displacement c (Flamant 1892). A support at a point lets the whole
/// body move by it, and where strains become large around a point, everything moves. As c may be opposite to the part
/// a qᵏ that converges, two changes a qᵏ + c show neither: all of the last one may recur. Three changes, as vectors, show
/// q and c; their directions then agree.
fn error_beside_points(steps: &[Vector2<f64>]) -> f64 {
    // A change that is small by chance does not predict the next one.
    let scaled = steps.iter().rev().zip([1.0, ORDINARY, ORDINARY * ORDINARY]);
    let change = scaled.map(|(step, part)| part * step.norm()).fold(0.0, f64::max);
    let shown = match *steps {
        [.., earlier, before, last] => {
            let [first, second] = [before - earlier, last - before];
            let ratio = second.dot(&first) / first.norm_squared();
            let across = second - first * ratio;
            let is_shown = (-ORDINARY..=STALLED).contains(&ratio) && across.norm() <= ORDINARY * first.norm();
            let ratio = ratio.clamp(ORDINARY, SLOWEST);
            is_shown.then(|| ((last - before * ratio) / (1.0 - ratio)).norm())
        }
        _ => None,
    };
    let constant = shown.map_or(change, |constant| constant.max(HIDDEN * change));
    change * SLOWEST / (1.0 - SLOWEST) + HALVINGS * constant
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the bound of the last of these displacements.
    fn bound(displacements: impl IntoIterator<Item = f64>, has_point: bool) -> Option<f64> {
        let along_x: Vec<_> = displacements.into_iter().map(|u| Vector2::new(u, 0.0)).collect();
        remaining_error(&along_x, has_point)
    }

    /// Returns the displacements 1 + 0.1 qᵏ for k = 0, 1, ….
    fn sequence(q: f64, count: i32) -> impl Iterator<Item = f64> {
        (0..count).map(move |k| 1.0 + 0.1 * q.powi(k))
    }

    #[test]
    fn the_bound_holds_and_is_not_much_larger_than_the_error() {
        let cases =
            [0.0625, 0.25, 0.4, 0.5, 0.7].into_iter().flat_map(|q| (3..6).map(move |count| (q, count, false, 50.0)));
        // Beside a point, three changes show that there is no logarithm.
        for (q, count, has_point, most) in cases.chain([(0.25, 4, true, 20.0)]) {
            let (bound, error) = (bound(sequence(q, count), has_point).unwrap(), 0.1 * q.powi(count - 1));
            assert!(bound >= error && bound <= most * error, "{q}, {count}: {bound} for {error}");
        }
    }

    #[test]
    fn sequences_that_show_no_rate_have_a_large_bound_or_none() {
        assert_eq!(bound(sequence(0.5, 1), false), None);
        for q in [0.95, 1.0, 1.1] {
            let (bound, change) = (bound(sequence(q, 4), false).unwrap(), 0.1 * q - 0.1 * q * q);
            assert!(bound > 8.0 * change.abs(), "{q}: {bound}");
        }
        let logarithm = &[1.0, 1.01, 1.02, 1.03];
        let cases: [(&str, &[f64], bool, std::ops::Range<f64>); 6] = [
            ("two meshes", &[1.1, 1.05], false, SAFETY * 0.05 - 1e-12..SAFETY * 0.05 + 1e-12),
            ("a change that is small by chance", &[1.0, 1.1, 1.1 + 1e-6], false, 0.015..f64::INFINITY),
            ("a change that was small by chance", &[1.0, 1.1, 1.105, 1.11], false, 0.02..0.05),
            ("rounding errors", &[1.0, 1.0 + 1e-12, 1.0 - 3e-12], false, 0.0..1e-6),
            // Under a point force each halving adds the same; the bound covers eight more halvings.
            ("a logarithm", logarithm, false, 0.08..0.25),
            ("a logarithm beside a point", logarithm, true, 0.08..0.25),
        ];
        for (what, u, has_point, range) in cases {
            let bound = bound(u.iter().copied(), has_point).unwrap();
            assert!(range.contains(&bound), "{what}: {bound}");
        }
    }

    /// A logarithm beside a part that converges, in any direction to it: hidden in the last change or in two of them.
    #[test]
    fn a_hidden_logarithm_is_bounded() {
        for (converging, angle) in (0..400).map(|i| (10f64.powf(0.01 * f64::from(i) - 2.0), 0.9 * f64::from(i))) {
            for (q, count) in [(0.25, 3), (0.25, 4), (0.25, 5), (0.35, 4), (0.35, 5), (0.5, 4), (0.5, 5)] {
                let constant = Vector2::new(angle.cos(), angle.sin()) * 1e-3;
                let at = |k: f64| Vector2::new(1.0 + 1e-2 * converging * f64::powf(q, k), 0.0) + constant * k;
                let u: Vec<_> = (0..count).map(|k| at(f64::from(k))).collect();
                let after = at(f64::from(count) + 7.0);
                let (bound, error) = (remaining_error(&u, true).unwrap(), (after - u[u.len() - 1]).norm());
                assert!(bound >= error, "{converging} {angle} {q} {count}: {bound} for {error}");
            }
        }
    }
}
