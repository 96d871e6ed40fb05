//! Ranks of measured settings by time and error, and the choice of the cheapest element, mesh and method for a required
//! accuracy and time. Errors are measured against a reference solution with an error of its own.

use super::measure::{begin, measure, meshed, meshes};
use super::prelude::*;
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

/// Setting chosen for a demand, with the measurements behind the choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuning {
    /// Chosen setting with its measured time and error: the fastest that meets the demand; the most accurate if only a
    /// time is demanded, or within the time if the error cannot be met.
    pub chosen: Measurement,
    /// Demand.
    pub demand: Demand,
    /// `true` if the demand is met.
    pub met: bool,
    /// All measurements; partial if the search was cancelled before all meshes were measured.
    pub study: Study,
}

/// Size of a mesh, relative to one that meets the demand, beyond which it cannot be cheaper.
const TOO_FINE: f64 = 3.0;
/// Time of a mesh's fastest setting, relative to the demanded time, beyond which finer meshes are not tried.
const TOO_SLOW: f64 = 2.0;

impl Tuning {
    /// Measures a scene on finer and finer meshes until its demand is met, and chooses among the settings that
    /// converge: results at the iteration limit are not considered.
    ///
    /// A cancelled search returns a choice from the measurements so far.
    ///
    /// # Errors
    /// [`StudyError`]; [`StudyError::NotKnown`] if the reference is not more accurate than demanded.
    pub fn of(scene: &Scene, demand: Demand, observe: Observer<'_>) -> Result<Self, StudyError> {
        let mut meshes = meshes(scene, Extent::Full);
        meshes.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let meshes: Vec<_> = meshes.into_iter().map(|(mesh, weight)| ((mesh, weight), weight)).collect();
        let study = begin(scene, &|progress| observe(Progress { fraction: 0.0, ..progress }))?;
        if let Some(asked_percent) = demand.max_error_percent.filter(|_| !study.can_decide(demand)) {
            return Err(StudyError::NotKnown { own_percent: study.own_error_percent, asked_percent });
        }
        let mut enough = f64::INFINITY;
        let study = study.measure_meshes(0.0, &meshes, observe, &mut |_| {}, |study, (mesh, weight), observe| {
            if weight > enough {
                return Ok(());
            }
            let before = study.measurements.len();
            let meshed = meshed(scene, mesh, &|progress| {
                observe(Progress { now: Some(&sentence!("end state of every method")), ..progress })
            })?;
            measure(study, scene, &meshed, observe)?;
            let added = &study.measurements[before..];
            let met = demand.max_error_percent.is_some() && added.iter().any(|m| m.converged && study.meets(m, demand));
            let fastest = added.iter().map(|m| m.milliseconds).fold(f64::INFINITY, f64::min);
            let slow = demand.max_time_ms.is_some_and(|most| fastest > TOO_SLOW * most);
            if met || slow {
                enough = enough.min(TOO_FINE * weight);
            }
            Ok(())
        })?;
        let least = |value: fn(&Measurement) -> f64, is_considered: &dyn Fn(&Measurement) -> bool| {
            let considered = study.measurements.iter().filter(|m| m.converged && is_considered(m));
            considered.min_by(|a, b| value(a).total_cmp(&value(b))).copied()
        };
        let (time, error): (fn(&Measurement) -> f64, _) = (|m| m.milliseconds, Measurement::error_percent);
        let best = least(if demand.max_error_percent.is_some() { time } else { error }, &|m| study.meets(m, demand));
        let in_time = || least(error, &|m| demand.time_is_met(m));
        let chosen = best.or_else(in_time).or_else(|| least(time, &|_| true)).ok_or(match study.is_partial {
            true => StudyError::Cancelled,
            false => StudyError::NoReference,
        })?;
        Ok(Self { chosen, demand, met: best.is_some(), study })
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
