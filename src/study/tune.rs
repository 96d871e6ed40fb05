//! Tuning: choice of the cheapest element, mesh and method for a required accuracy and time.

use super::measure::{begin, measure, meshed, meshes};
use super::progress::{Extent, StudyError};
use super::ranking::Demand;
use super::trade::{Measurement, Study};
use crate::progress::{Observer, Progress};
use crate::scene::Scene;
use crate::sentence::sentence;

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
    /// Number of measured settings that converge.
    pub measured: usize,
    /// Number of these settings that meet the demand.
    pub meeting: usize,
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
        let ended: Vec<&Measurement> = study.measurements.iter().filter(|m| m.converged).collect();
        let meeting: Vec<&Measurement> = ended.iter().copied().filter(|m| study.meets(m, demand)).collect();
        let in_time: Vec<&Measurement> = ended.iter().copied().filter(|m| demand.time_is_met(m)).collect();
        let least = |of: &[&Measurement], value: fn(&Measurement) -> f64| {
            of.iter().copied().min_by(|a, b| value(a).total_cmp(&value(b))).copied()
        };
        let fastest = |of: &[&Measurement]| least(of, |m| m.milliseconds);
        let closest = |of: &[&Measurement]| least(of, Measurement::error_percent);
        let best = if demand.max_error_percent.is_some() { fastest(&meeting) } else { closest(&meeting) };
        let chosen = best.or_else(|| closest(&in_time)).or_else(|| fastest(&ended)).ok_or(match study.is_partial {
            true => StudyError::Cancelled,
            false => StudyError::NoReference,
        })?;
        let (measured, meeting) = (ended.len(), meeting.len());
        Ok(Self { chosen, demand, met: best.is_some(), measured, meeting, study })
    }
}
