//! The cheapest setting that is good enough and fast enough.

use super::trade::{Extent, Measurement, MeshChoice, Progress, Study, StudyError, Watch, check, meshes};
use crate::scene::{Scene, SolverSettings};

/// What is asked of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Error, percent of the true displacement.
    pub max_error_percent: f64,
    /// Time, ms.
    pub budget_ms: f64,
}

impl From<&SolverSettings> for Demand {
    fn from(settings: &SolverSettings) -> Self {
        Self { max_error_percent: settings.max_error_percent, budget_ms: settings.budget_ms }
    }
}

impl Study {
    /// Whether a measurement meets a demand; its error and the truth's own count together.
    #[must_use]
    pub fn meets(&self, measurement: &Measurement, demand: Demand) -> bool {
        measurement.error.bound() + self.reference.error_percent <= demand.max_error_percent
            && measurement.milliseconds() <= demand.budget_ms
    }

    /// The measurements that meet a demand, cheapest first.
    #[must_use]
    pub fn meeting(&self, demand: Demand) -> Vec<&Measurement> {
        let mut meeting: Vec<&Measurement> = self.measurements.iter().filter(|m| self.meets(m, demand)).collect();
        meeting.sort_by_key(|m| m.time.total());
        meeting
    }
}

/// What `auto` chose, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The setting, with what it was measured to cost and to be wrong by.
    pub chosen: Measurement,
    /// What was asked.
    pub demand: Demand,
    /// Whether the demand is met. If not, the choice is the closest within the budget, or else the fastest.
    pub met: bool,
    /// Settings measured, and how many of them meet the demand.
    pub measured: usize,
    /// See [`Self::measured`].
    pub meeting: usize,
    /// Estimated error of the truth itself, percent.
    pub truth_error_percent: f64,
}

/// Meshes this many times the size of one that meets the demand cannot be cheaper.
const TOO_FINE: f64 = 3.0;
/// Nor can finer meshes where the fastest setting of this one takes so many budgets.
const TOO_SLOW: f64 = 2.0;

impl Choice {
    /// Measures a scene on finer and finer meshes until its demand is met, and chooses among the settings that end by
    /// themselves: a result that merely ran out of iterations is not called converged.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn of(scene: &Scene, watch: Watch<'_>) -> Result<Self, StudyError> {
        let demand = Demand::from(&scene.solver);
        let mut meshes = meshes(scene, Extent::Full);
        meshes.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        let mut study = Study::begin(scene, watch)?;
        let mut enough = f64::INFINITY;
        for mesh in &meshes {
            if mesh.weight > enough {
                break;
            }
            let MeshChoice { weight, .. } = *mesh;
            let before = study.measurements.len();
            study.measure(scene, mesh, &mut |now| check(watch(Progress { share: 0.0, now, so_far: None })))?;
            let added = &study.measurements[before..];
            let met = added.iter().any(|m| m.converged && study.meets(m, demand));
            let fastest = added.iter().map(Measurement::milliseconds).fold(f64::INFINITY, f64::min);
            if met || fastest > TOO_SLOW * demand.budget_ms {
                enough = enough.min(TOO_FINE * weight);
            }
        }
        let ended = || study.measurements.iter().filter(|m| m.converged);
        let by_time = |a: &&Measurement, b: &&Measurement| a.time.total().cmp(&b.time.total());
        let by_error = |a: &&Measurement, b: &&Measurement| a.error.bound().total_cmp(&b.error.bound());
        let meeting = ended().filter(|m| study.meets(m, demand)).count();
        let best = ended().filter(|m| study.meets(m, demand)).min_by(by_time);
        let closest = ended().filter(|m| m.milliseconds() <= demand.budget_ms).min_by(by_error);
        let chosen = best.or(closest).or_else(|| ended().min_by(by_time)).ok_or(StudyError::NoTruth)?;
        Ok(Self {
            chosen: *chosen,
            demand,
            met: best.is_some(),
            measured: study.measurements.len(),
            meeting,
            truth_error_percent: study.reference.error_percent,
        })
    }
}

impl std::fmt::Display for Choice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Demand { max_error_percent, budget_ms } = self.demand;
        let (setting, ms, e) = (&self.chosen.setting, self.chosen.milliseconds(), &self.chosen.error);
        let asked = format!("at most {max_error_percent} % error and {budget_ms} ms a frame");
        let word = match (self.met, ms <= budget_ms) {
            (true, _) => {
                format!("{} of {} settings measured here meet {asked}; the fastest", self.meeting, self.measured)
            }
            (false, true) => {
                format!("none of {} settings measured here meets {asked}; the closest within the time", self.measured)
            }
            (false, false) => {
                format!("none of {} settings measured here meets {asked}; the fastest of all", self.measured)
            }
        };
        writeln!(f, "auto: {word}:")?;
        writeln!(f, "  {setting}: {ms:.4} ms, error at most {:.4} %", e.bound() + self.truth_error_percent)?;
        write!(
            f,
            "  of which mesh {:.4} %, stopped early {:.4} %, linear theory {:.4} %, the truth's own {:.4} %",
            e.discretization, e.iteration, e.model, self.truth_error_percent
        )
    }
}
