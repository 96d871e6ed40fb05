//! Ranks of measured settings by time and error. Errors are measured against a reference solution with an error of its
//! own.

use super::trade::{Measurement, Study, StudyReference};

/// Requirements for a solve; `None` for no requirement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Largest error, percent of the exact displacement.
    pub max_error_percent: Option<f64>,
    /// Largest computing time of a solve, or of a simulated second, ms.
    pub max_time_ms: Option<f64>,
}

impl Demand {
    pub(super) fn time_is_met(self, measurement: &Measurement) -> bool {
        self.max_time_ms.is_none_or(|most| measurement.milliseconds <= most)
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

impl Study {
    /// Returns the bound of the error of a measurement, percent: its parts, and the error of the reference; infinite
    /// for a motion that did not finish.
    #[must_use]
    pub fn error_bound(&self, measurement: &Measurement) -> f64 {
        measurement.error_percent() + self.own_error_percent
    }

    /// Returns the Pareto-optimal measurements, fastest first.
    #[must_use]
    pub fn front(&self) -> Vec<&Measurement> {
        self.sorted(|m| m.pareto)
    }

    /// Returns `false` if the reference's own error is at least the demanded one, so that it cannot be decided which
    /// settings meet the demand.
    #[must_use]
    pub fn can_decide(&self, demand: Demand) -> bool {
        demand.max_error_percent.is_none_or(|most| self.own_error_percent < most)
    }

    /// Returns `true` if a measurement meets a demand; the reference's own error is added to that of the measurement.
    #[must_use]
    pub fn meets(&self, measurement: &Measurement, demand: Demand) -> bool {
        let error = self.error_bound(measurement);
        demand.max_error_percent.is_none_or(|most| error <= most) && demand.time_is_met(measurement)
    }

    /// Returns the measurements that meet a demand, fastest first.
    #[must_use]
    pub fn meeting(&self, demand: Demand) -> Vec<&Measurement> {
        self.sorted(|m| self.meets(m, demand))
    }

    /// Returns the measurements whose error bound is at most `percent`, fastest first.
    #[must_use]
    pub fn within(&self, percent: f64) -> Vec<&Measurement> {
        self.meeting(Demand { max_error_percent: Some(percent), max_time_ms: None })
    }

    fn sorted(&self, which: impl Fn(&Measurement) -> bool) -> Vec<&Measurement> {
        let mut sorted: Vec<&Measurement> = self.measurements.iter().filter(|m| which(m)).collect();
        sorted.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
        sorted
    }

    /// Returns for every measurement `true` if its rank is undecided: its error and the smallest one of faster settings
    /// differ by less than the reference's own error.
    #[must_use]
    pub fn undecided(&self) -> Vec<bool> {
        undecided(&self.times_and_errors(), self.own_error_percent)
    }

    /// Marks the measurements that no other one beats in time and error; errors of paths below that of the reference
    /// count as equal.
    pub(super) fn mark_pareto(&mut self) {
        let resolution = match self.reference {
            StudyReference::Rest(_) => 0.0,
            StudyReference::Motion(_) => self.own_error_percent,
        };
        // `f64::max` would turn NaN into `resolution`.
        let resolved = |error: f64| if error < resolution { resolution } else { error };
        let pairs: Vec<_> = self.times_and_errors().into_iter().map(|(time, error)| (time, resolved(error))).collect();
        self.measurements.iter_mut().zip(front(&pairs)).for_each(|(m, front)| m.pareto = front);
    }

    fn times_and_errors(&self) -> Vec<(f64, f64)> {
        self.measurements.iter().map(|m| (m.milliseconds, m.error_percent())).collect()
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
