//! Ranks of measured settings by time and error. Errors are measured against a reference solution with an error of its
//! own.

use crate::sentence::Sentence;

/// Requirements for a solve; `None` for no requirement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Largest error, percent of the exact displacement.
    pub max_error_percent: Option<f64>,
    /// Largest computing time, ms.
    pub max_time_ms: Option<f64>,
}

impl Demand {
    pub(super) fn time_is_met(self, measurement: &impl Ranked) -> bool {
        self.max_time_ms.is_none_or(|most| measurement.time_ms() <= most)
    }
}

impl std::fmt::Display for Demand {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.max_error_percent, self.max_time_ms) {
            (Some(error), Some(time)) => write!(f, "at most {error} % error and {time} ms"),
            (Some(error), None) => write!(f, "at most {error} % error"),
            (None, Some(time)) => write!(f, "at most {time} ms"),
            (None, None) => write!(f, "no requirement"),
        }
    }
}

/// Measured setting of a study.
pub trait Ranked: Copy {
    /// Describes the setting.
    fn setting_text(&self) -> Sentence;

    /// Returns the computing time of a solve, or of a simulated second, ms.
    fn time_ms(&self) -> f64;

    /// Formats the computing time.
    fn time_text(&self) -> String;

    /// Returns the sum of the error's parts, percent; infinite for a motion that did not finish.
    fn error_percent(&self) -> f64;

    /// Returns `true` if no other measurement is both faster and more accurate.
    fn is_pareto(&self) -> bool;
}

/// Measurements of a study, ranked by time and error.
#[derive(Clone, Copy, Debug)]
pub struct Ranking<'a, M> {
    /// Measurements.
    pub measurements: &'a [M],
    /// Bound of the reference's own error, percent.
    pub own_error_percent: f64,
}

impl<'a, M: Ranked> Ranking<'a, M> {
    /// Returns the bound of the error of a measurement, percent: its parts, and the error of the reference; infinite
    /// for a motion that did not finish.
    #[must_use]
    pub fn error_bound(self, measurement: &M) -> f64 {
        measurement.error_percent() + self.own_error_percent
    }

    /// Returns the Pareto-optimal measurements, fastest first.
    #[must_use]
    pub fn front(self) -> Vec<&'a M> {
        self.sorted(M::is_pareto)
    }

    /// Returns `false` if the reference's own error is at least the demanded one, so that it cannot be decided which
    /// settings meet the demand.
    #[must_use]
    pub fn can_decide(self, demand: Demand) -> bool {
        demand.max_error_percent.is_none_or(|most| self.own_error_percent < most)
    }

    /// Returns `true` if a measurement meets a demand; the reference's own error is added to that of the measurement.
    #[must_use]
    pub fn meets(self, measurement: &M, demand: Demand) -> bool {
        let error = self.error_bound(measurement);
        demand.max_error_percent.is_none_or(|most| error <= most) && demand.time_is_met(measurement)
    }

    /// Returns the measurements that meet a demand, fastest first.
    #[must_use]
    pub fn meeting(self, demand: Demand) -> Vec<&'a M> {
        self.sorted(|m| self.meets(m, demand))
    }

    /// Returns the measurements whose error bound is at most `percent`, fastest first.
    #[must_use]
    pub fn within(self, percent: f64) -> Vec<&'a M> {
        self.meeting(Demand { max_error_percent: Some(percent), max_time_ms: None })
    }

    fn sorted(self, which: impl Fn(&M) -> bool) -> Vec<&'a M> {
        let mut sorted: Vec<&M> = self.measurements.iter().filter(|m| which(m)).collect();
        sorted.sort_by(|a, b| a.time_ms().total_cmp(&b.time_ms()));
        sorted
    }

    /// Returns for every measurement `true` if its rank is undecided: its error and the smallest one of faster settings
    /// differ by less than the reference's own error.
    #[must_use]
    pub fn undecided(self) -> Vec<bool> {
        undecided(&self.times_and_errors(), self.own_error_percent)
    }

    /// Returns for every measurement `true` if no other one is both faster and more accurate; errors below
    /// `resolution`, percent, count as equal.
    pub(super) fn pareto(self, resolution: f64) -> Vec<bool> {
        // `f64::max` would turn NaN into `resolution`.
        let resolved = |error: f64| if error < resolution { resolution } else { error };
        let pairs: Vec<_> = self.times_and_errors().into_iter().map(|(time, error)| (time, resolved(error))).collect();
        front(&pairs)
    }

    fn times_and_errors(self) -> Vec<(f64, f64)> {
        self.measurements.iter().map(|m| (m.time_ms(), m.error_percent())).collect()
    }
}

/// Returns for every pair of a time and an error `true` if no other pair is smaller in one and not larger in the other.
/// Of equal pairs the first is kept; pairs that are not finite are not kept.
fn front(pairs: &[(f64, f64)]) -> Vec<bool> {
    let is_front = |i: usize, &(time, error): &(f64, f64)| {
        time.is_finite()
            && error.is_finite()
            && !pairs.iter().enumerate().any(|(j, &(t, e))| {
                (t <= time && e < error) || (t < time && e <= error) || (t == time && e == error && j < i)
            })
    };
    pairs.iter().enumerate().map(|(i, pair)| is_front(i, pair)).collect()
}

/// Returns for every pair of a time and a measured error `true` if its rank is undecided: its error and the smallest
/// error of the pairs that are not slower differ by less than `own`, the reference's own error.
fn undecided(pairs: &[(f64, f64)], own: f64) -> Vec<bool> {
    let is_undecided = |i: usize, &(time, error): &(f64, f64)| {
        let faster = pairs.iter().enumerate().filter(|&(j, &(t, _))| j != i && t <= time).map(|(_, &(_, e))| e);
        let best = faster.fold(f64::INFINITY, f64::min);
        error.is_finite() && (best - error).abs() < own
    };
    pairs.iter().enumerate().map(|(i, pair)| is_undecided(i, pair)).collect()
}

#[cfg(test)]
mod tests {
    use super::{front, undecided};

    #[test]
    fn the_front_has_the_settings_that_no_other_beats() {
        let pairs = [(1.0, 9.0), (2.0, 3.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (4.0, 1.0), (0.1, f64::INFINITY)];
        assert_eq!(front(&pairs), [true, true, false, false, false, true, false]);
    }

    #[test]
    fn errors_that_the_reference_cannot_tell_apart_are_undecided() {
        let pairs = [(1.0, 9.0), (2.0, 3.0), (3.0, 2.5), (4.0, 3.4), (5.0, 3.6), (6.0, 0.5), (7.0, f64::INFINITY)];
        assert_eq!(undecided(&pairs, 1.0), [false, false, true, true, false, false, false]);
        assert_eq!(undecided(&pairs, 0.0), [false; 7], "an exact reference decides");
    }
}
