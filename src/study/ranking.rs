//! Ranks of measured settings by time and error, and the choice of the cheapest element, mesh and method for a required
//! accuracy and time. Errors are measured against a reference solution with an error of its own.

use super::measure::meshes;
use super::prelude::*;
use super::trade::{Measurement, Study};

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
    pub fn error_bound(&self, measurement: &Measurement) -> f64 {
        measurement.error_percent() + self.own_error_percent
    }

    /// Returns the Pareto-optimal measurements, fastest first.
    pub fn front(&self) -> Vec<&Measurement> {
        self.sorted(|m| m.pareto)
    }

    /// Returns `false` if the reference's own error is at least the demanded one, so that it cannot be decided which
    /// settings meet the demand.
    pub fn can_decide(&self, demand: Demand) -> bool {
        demand.max_error_percent.is_none_or(|most| self.own_error_percent < most)
    }

    /// Returns `true` if a measurement meets a demand; the reference's own error is added to that of the measurement.
    pub fn meets(&self, measurement: &Measurement, demand: Demand) -> bool {
        let error = self.error_bound(measurement);
        demand.max_error_percent.is_none_or(|most| error <= most) && demand.time_is_met(measurement)
    }

    /// Returns the measurements that meet a demand, fastest first.
    pub fn meeting(&self, demand: Demand) -> Vec<&Measurement> {
        self.sorted(|m| self.meets(m, demand))
    }

    /// Returns the measurements whose error bound is at most `percent`, fastest first.
    pub fn within(&self, percent: f64) -> Vec<&Measurement> {
        self.meeting(Demand { max_error_percent: Some(percent), max_time_ms: None })
    }

    fn sorted(&self, which: impl Fn(&Measurement) -> bool) -> Vec<&Measurement> {
        let mut sorted: Vec<&Measurement> = self.measurements.iter().filter(|m| which(m)).collect();
        sorted.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
        sorted
    }

    /// Marks the measurements that no other one beats in time and error, of equal ones the first, and those whose rank is
    /// undecided; errors of paths below that of the reference count as equal.
    pub(super) fn rank(&mut self) {
        let own = self.own_error_percent;
        let resolution = if self.moves() { own } else { 0.0 };
        // `f64::max` would turn NaN into `resolution`.
        let resolved = |error: f64| if error < resolution { resolution } else { error };
        let pairs: Vec<_> = self.measurements.iter().map(|m| (m.milliseconds, m.error_percent())).collect();
        for (i, m) in self.measurements.iter_mut().enumerate() {
            let (time, error) = pairs[i];
            let not_slower = pairs.iter().enumerate().filter(|(j, (t, _))| *j != i && *t <= time);
            let best = not_slower.clone().map(|(_, (_, e))| *e).fold(f64::INFINITY, f64::min);
            let beats = |(j, &(t, e)): (usize, &(f64, f64))| {
                let (e, error) = (resolved(e), resolved(error));
                e < error || e == error && (t < time || j < i)
            };
            m.pareto = time.is_finite() && error.is_finite() && !not_slower.clone().any(beats);
            m.undecided = error.is_finite() && (best - error).abs() < own;
        }
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
        if scene.analysis == Analysis::Dynamic {
            return Err(StudyError::InMotion);
        }
        let mut meshes = meshes(scene, Extent::Full);
        meshes.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let study = Study::begin(scene, Extent::Full, observe)?;
        if let Some(asked_percent) = demand.max_error_percent.filter(|_| !study.can_decide(demand)) {
            return Err(StudyError::NotKnown { own_percent: study.own_error_percent, asked_percent });
        }
        let study = study.measure(scene, Extent::Full, &meshes, observe, &mut |study, mesh, cost| {
            let is_added = |m: &&Measurement| (m.setting.element, m.setting.cells) == (mesh.element, mesh.cells);
            let added = study.measurements.iter().filter(is_added);
            let fastest = added.clone().map(|m| m.milliseconds).fold(f64::INFINITY, f64::min);
            let is_met =
                demand.max_error_percent.is_some() && added.clone().any(|m| m.converged && study.meets(m, demand));
            let is_slow = demand.max_time_ms.is_some_and(|most| fastest > TOO_SLOW * most);
            if is_met || is_slow { TOO_FINE * cost } else { f64::INFINITY }
        })?;
        // Settings that meet the demand come first, then those within the time.
        let rank = |m: &Measurement| match (study.meets(m, demand), demand.time_is_met(m)) {
            (true, _) if demand.max_error_percent.is_some() => (0, m.milliseconds),
            (true, _) => (0, m.error_percent()),
            (false, true) => (1, m.error_percent()),
            (false, false) => (2, m.milliseconds),
        };
        let converged = study.measurements.iter().filter(|m| m.converged).map(|m| (rank(m), *m));
        let first = converged.min_by(|((a, x), _), ((b, y), _)| a.cmp(b).then(x.total_cmp(y)));
        let ((class, _), chosen) = first.ok_or(match study.is_partial {
            true => StudyError::Cancelled,
            false => StudyError::NoReference,
        })?;
        Ok(Self { chosen, demand, met: class == 0, study })
    }
}
