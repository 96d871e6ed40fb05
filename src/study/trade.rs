//! Speed–accuracy study: error against time for every element, mesh, method and number of iterations, of a motion also for
//! every integrator and time step, on this machine.

use super::motion::MotionReference;
use super::prelude::*;
use super::reference::{Reference, system_of};
use crate::dynamics::Counts;

/// Error of a result and its parts: distances of the first probe's displacement, percent of the reference's; of a motion,
/// largest distances of its path, percent of the size of the reference's path. The total is at most the sum of the parts.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
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

impl ErrorSplit {
    /// Returns the sum of the parts, an upper bound of the distance from the reference. Settings are compared by it: an
    /// early stop that happens to compensate the error of a coarse mesh is luck, not accuracy.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.discretization + self.iteration + self.model
    }
}

/// Path of the first probe, m; at rest its displacement alone.
pub(super) type ProbePath = Vec<Vector2<f64>>;

/// Mesh with the results of both theories on it, without an error of iterations or time steps.
#[derive(Clone, Debug)]
pub(super) struct Meshed {
    pub mesh: Setting,
    pub system: Arc<System>,
    /// Result of corotated theory.
    exact: ProbePath,
    linear: ProbePath,
}

impl Meshed {
    /// Meshes a scene; `result` computes the result of the scene's method on this mesh.
    pub fn new(
        scene: &Scene,
        mesh: Setting,
        result: impl Fn(Scene, &Arc<System>) -> Result<ProbePath>,
    ) -> Result<Self> {
        let scene = mesh.apply(scene);
        let system = system_of(&scene)?;
        let of = |method| result(scene.clone().with_method(method), &system);
        let (exact, linear) = (of(MethodKind::Newton)?, of(MethodKind::Linear)?);
        Ok(Self { mesh, system, exact, linear })
    }

    /// Splits the error of a result of one of the theories.
    pub fn error(&self, result: &[Vector2<f64>], is_linear: bool, reference: &StudyReference) -> ErrorSplit {
        let own = if is_linear { &self.linear } else { &self.exact };
        let largest = |path: &[Vector2<f64>], from| reference.distance(path, from)[0];
        ErrorSplit {
            total: largest(result, None),
            discretization: largest(&self.exact, None),
            iteration: largest(result, Some(own)),
            model: largest(own, Some(&self.exact)),
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
    /// `true` if no other measurement is both faster and, by [`ErrorSplit::bound`], more accurate; errors of paths below
    /// the reference's own error count as equal.
    pub pareto: bool,
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

impl MotionFigures {
    /// Returns the effect of the integrator on the energy: `kept` if it changes by less than a ten-thousandth of the largest
    /// kinetic energy, else `lost` or `gained`.
    pub fn energy(&self) -> &'static str {
        const KEPT: f64 = 0.01;
        match self.drift_percent {
            d if d.abs() < KEPT => "kept",
            d if d < 0.0 => "lost",
            _ => "gained",
        }
    }
}

impl Measurement {
    /// Returns the scene as measured: on the setting's mesh, with its method, stopped after the same number of
    /// iterations.
    #[must_use]
    pub fn apply(&self, scene: &Scene) -> Scene {
        self.applied().apply(scene)
    }

    /// Returns `true` if a scene is the result of [`Self::apply`].
    #[must_use]
    pub fn is_applied_to(&self, scene: &Scene) -> bool {
        Setting::of(scene) == self.applied()
    }

    /// Returns the setting of a scene with this measurement: a solve that had converged is not stopped.
    fn applied(&self) -> Setting {
        let is_stopped = self.motion.is_some() || !self.converged;
        Setting { iterations: if is_stopped { self.setting.iterations } else { 0 }, ..self.setting }
    }

    /// Returns the sum of the error's parts, percent; infinite for a motion that did not finish.
    #[must_use]
    pub fn error_percent(&self) -> f64 {
        self.error.map_or(f64::INFINITY, |error| error.bound())
    }

    /// Returns the identifier of a motion's end in tables.
    pub(super) fn ending(&self) -> &'static str {
        match self.motion {
            _ if self.converged => "finished",
            Some(MotionFigures { is_cut_short: true, .. }) => "cut_short",
            _ => "stopped",
        }
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
pub enum StudyReference {
    /// Displacements of a body at rest; errors are measured at the first probe.
    Rest(Reference),
    /// Path of a motion.
    Motion(MotionReference),
}

impl StudyReference {
    /// Returns the largest and the root mean square distance of a path from another one, or from the reference, percent of
    /// the size of the reference.
    pub(super) fn distance(&self, path: &[Vector2<f64>], from: Option<&[Vector2<f64>]>) -> [f64; 2] {
        match self {
            Self::Rest(reference) => reference.first().zip(path.first()).map_or([f64::NAN; 2], |(own, end)| {
                [own.percent(*end, from.and_then(<[_]>::first).copied().unwrap_or(own.displacement)); 2]
            }),
            Self::Motion(reference) => reference.distance(path, from.unwrap_or(&reference.path)),
        }
    }
}

displayed!(StudyReference);

impl From<&StudyReference> for Sentence {
    fn from(reference: &StudyReference) -> Self {
        match reference {
            StudyReference::Rest(reference) => reference.into(),
            StudyReference::Motion(reference) => reference.into(),
        }
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

    /// Returns a study without measurements.
    pub(super) fn begin(scene: &Scene, reference: StudyReference) -> Result<Self> {
        let own_error_percent = match &reference {
            StudyReference::Rest(reference) => reference.first().ok_or(StudyError::NoBound)?.own_error_percent,
            StudyReference::Motion(reference) => reference.error_percent,
        };
        let (scene, asked_percent) = (scene.name.clone(), scene.solver.max_error_percent);
        Ok(Self { scene, reference, own_error_percent, asked_percent, measurements: Vec::new(), is_partial: true })
    }

    /// Calls `measure` with each mesh, and `partial` with the study so far; a cancelled study keeps its measurements.
    /// Each mesh has its approximate cost; `begun` is the fraction of the work done before.
    pub(super) fn measure_meshes<M: Copy>(
        mut self,
        begun: f64,
        meshes: &[(M, f64)],
        observe: Observer<'_>,
        partial: &mut dyn FnMut(&Self),
        mut measure: impl FnMut(&mut Self, M, Observer<'_>) -> Result<()>,
    ) -> Result<Self> {
        let all: f64 = meshes.iter().map(|(_, weight)| weight).sum();
        let mut done = 0.0;
        for &(mesh, weight) in meshes {
            let fraction = |part: f64| begun + (1.0 - begun) * ((done + part * weight) / all);
            let measured =
                measure(&mut self, mesh, &|part| observe(Progress { fraction: fraction(part.fraction), ..part }));
            self.mark_pareto();
            match measured {
                Err(StudyError::Cancelled) if !self.measurements.is_empty() => return Ok(self),
                measured => measured?,
            }
            partial(&self);
            // A cancellation is seen by the next mesh.
            let _ = observe(Progress::at(fraction(1.0)));
            done += weight;
        }
        self.is_partial = false;
        Ok(self)
    }

    /// Returns `true` if the method of a measurement converged on its mesh, after this or another number of iterations.
    #[cfg(feature = "app")]
    pub(crate) fn converges(&self, measurement: &Measurement) -> bool {
        let of = |m: &Measurement| (m.setting.element, m.setting.cells, m.setting.method);
        measurement.motion.is_some() || self.measurements.iter().any(|m| m.converged && of(m) == of(measurement))
    }
}
