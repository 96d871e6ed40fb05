//! Speed–accuracy study: error against time for every element, mesh, method and number of iterations, of a motion also for
//! every integrator and time step, on this machine.

use super::motion::Samples;
use super::prelude::*;
use crate::dynamics::Counts;

/// Error of a result and its parts: distances of the first probe's displacement, percent of the reference's; of a motion,
/// largest distances of its path, percent of the size of the reference's path. The total is at most the sum of the parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ErrorSplit {
    /// Distance from the reference solution.
    pub total: f64,
    /// Error of the mesh (locking): distance of the exact equilibrium, or motion, on this mesh from the reference.
    pub discretization: f64,
    /// Distance from the final result of the same theory on this mesh: the error of stopping early, or of time steps,
    /// solves and lumped masses.
    pub iteration: f64,
    /// Error of the theory: distance between the results of linear and corotated theory on this mesh.
    pub model: f64,
}

/// Mesh of a study with the results of both theories on it, without an error of iterations or time steps.
pub(super) struct Meshed<'a> {
    pub mesh: Setting,
    /// Scene with this mesh.
    pub scene: Scene,
    pub system: Arc<System>,
    pub reference: &'a StudyReference,
    /// Paths of the first probe by corotated and by linear theory, m; at rest its displacements.
    pub theories: Vec<Vec<Vector2<f64>>>,
}

impl Meshed<'_> {
    /// Returns the measurement, without its time, of the result of a setting, which `is_linear` if linear theory has it.
    pub fn measurement(
        &self,
        setting: Setting,
        converged: bool,
        result: &[Vector2<f64>],
        is_linear: bool,
        motion: Option<MotionFigures>,
    ) -> Measurement {
        let (exact, own) = (&self.theories[0], &self.theories[usize::from(is_linear)]);
        let largest = |a: &[Vector2<f64>], b: &[Vector2<f64>]| self.reference.distance(a, b)[0];
        let error = || ErrorSplit {
            total: largest(result, &self.reference.path),
            discretization: largest(exact, &self.reference.path),
            iteration: largest(result, own),
            model: largest(own, exact),
        };
        Measurement {
            setting,
            dofs: self.system.dofs(),
            converged,
            milliseconds: 0.0,
            error: (converged || motion.is_none()).then(error),
            time: Timings::default(),
            motion,
            pareto: false,
            undecided: false,
        }
    }
}

/// Measured time and error of a setting.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Measurement {
    /// Setting.
    pub setting: Setting,
    /// Number of free unknowns.
    pub dofs: usize,
    /// `true` if the method had converged, or the motion ended at the end of the studied time.
    pub converged: bool,
    /// Computing time of a solve, or of a simulated second without the energy ledger, ms: median over repetitions.
    pub milliseconds: f64,
    /// Error; `None` for a motion that did not finish.
    pub error: Option<ErrorSplit>,
    /// Computing time of a solve by stage; zero for a motion.
    pub time: Timings,
    /// Figures of a motion; `None` for a body at rest.
    #[doc(hidden)]
    pub motion: Option<MotionFigures>,
    /// `true` if no other measurement is both faster and, by [`Self::error_percent`], more accurate; errors of paths below
    /// the reference's own error count as equal.
    pub pareto: bool,
    /// `true` if its rank is undecided: its error and the smallest one of faster settings differ by less than the
    /// reference's own error.
    pub undecided: bool,
}

/// Figures of a measured motion.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MotionFigures {
    /// `true` if only the beginning was computed, to measure its time, because the motion has too many steps.
    pub is_cut_short: bool,
    /// Root of the mean square over time of the distance from the reference, percent of the size of its path.
    pub rms_percent: f64,
    /// Energy added by the integrator, percent of the largest kinetic energy.
    pub drift_percent: f64,
    /// The same, percent of the energy put in.
    pub drift_of_input_percent: f64,
    /// Numbers of steps and solves.
    pub counts: Counts,
}

impl Measurement {
    /// Returns the setting of a scene with this measurement: stopped after the same number of iterations, unless the solve
    /// had converged.
    pub fn applied(&self) -> Setting {
        let is_stopped = self.motion.is_some() || !self.converged;
        Setting { iterations: if is_stopped { self.setting.iterations } else { 0 }, ..self.setting }
    }

    /// Returns the sum of the error's parts, percent, an upper bound of the distance from the reference; infinite for a motion
    /// that did not finish. Settings are compared by it: an early stop that happens to compensate the error of a coarse mesh
    /// is luck, not accuracy.
    pub fn error_percent(&self) -> f64 {
        self.error.map_or(f64::INFINITY, |error| error.discretization + error.iteration + error.model)
    }

    pub(super) fn time_text(&self) -> String {
        match self.motion {
            None => format!("{:.4} ms", self.milliseconds),
            Some(_) => format!("{:.3} ms per simulated second", self.milliseconds),
        }
    }
}

/// Reference solution of a study.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct StudyReference {
    /// Displacement of the first probe from rest, m, at each of the sampling times; at rest a single one.
    pub path: Vec<Vector2<f64>>,
    /// Largest displacement, m; errors are relative to it.
    pub size: f64,
    /// Bound of its own error, percent of the size.
    pub error_percent: f64,
    /// Sampling times; their interval is 0 at rest.
    pub samples: Samples,
    /// Origin and own error in words.
    pub text: Sentence,
}

impl StudyReference {
    /// Returns the largest and the root mean square distance between two paths sampled like the reference, percent of
    /// the size.
    pub fn distance(&self, a: &[Vector2<f64>], b: &[Vector2<f64>]) -> [f64; 2] {
        let distances = a.iter().zip(b).map(|(a, b)| 100.0 * (a - b).norm() / self.size);
        let squares: f64 = distances.clone().map(|d| d * d).sum();
        [distances.reduce(f64::max).unwrap_or(0.0), (squares / a.len().min(b.len()).max(1) as f64).sqrt()]
    }
}

/// Speed–accuracy study of a scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Study {
    /// Name of the scene.
    pub scene: String,
    /// Reference solution.
    #[doc(hidden)]
    pub reference: StudyReference,
    /// Bound of the reference's own error, percent.
    pub own_error_percent: f64,
    /// Error requested from `auto`, percent.
    pub asked_percent: f64,
    /// Measurements, sorted by element, mesh, integrator, step, method, iterations.
    pub measurements: Vec<Measurement>,
    /// `true` if the study was cancelled before everything was measured.
    pub is_partial: bool,
}

impl Study {
    /// Largest number of iterations for methods that have not converged before.
    pub(crate) const MAX_ITERATIONS: u32 = 20;

    /// Returns `true` for a motion.
    pub(crate) fn moves(&self) -> bool {
        self.reference.samples.interval > 0.0
    }

    /// Returns `true` if the method of a measurement converged on its mesh, after this or another number of iterations.
    #[cfg(feature = "app")]
    pub(crate) fn converges(&self, measurement: &Measurement) -> bool {
        let of = |m: &Measurement| (m.setting.element, m.setting.cells, m.setting.method);
        measurement.motion.is_some() || self.measurements.iter().any(|m| m.converged && of(m) == of(measurement))
    }
}
