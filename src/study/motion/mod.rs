//! Speed–accuracy study of motions: error of the first probe's path against computing time, for every integrator, time
//! step, number of solves, method, element and mesh, on this machine.

use std::sync::Arc;
use std::time::Duration;

use nalgebra::Vector2;
use web_time::Instant;

use self::plan::{Job, MeshPlan, Plan, Samples, cells};
pub use self::reference::MotionReference;
use self::reference::fine_path;
use super::fine::finest_element;
use super::parallel;
use super::progress::{Extent, StudyError, all_done, check};
use super::ranking::{Ranked, Ranking};
use super::reference::{first_probe, system_of};
use super::timing::{Runs, median_time};
use super::trade::{Setting, mesh_text};
use crate::assembly::{Mass, System};
use crate::dynamics::{Counts, critical_step};
use crate::progress::{Observer, Progress};
use crate::scene::{ElementKind, IntegratorKind, MethodKind, Scene};
use crate::sentence::{Sentence, displayed, sentence};
use crate::simulation::{Simulation, Status};

mod plan;
mod reference;
mod report;
pub(super) mod steps;

/// Largest computing time per simulated second, ms, for which a motion runs in real time.
pub const REAL_TIME: f64 = 1e3;

/// Parameters varied in the study.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MotionSetting {
    /// Element.
    pub element: ElementKind,
    /// Cells along and across; `None` for the mesh of a file.
    pub cells: Option<[u32; 2]>,
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Method: theory and matrix. For an explicit integrator, which has no matrix, only the theory.
    pub method: MethodKind,
    /// Time step, s.
    pub time_step: f64,
    /// Solves per step, or per stage of one; 0 iterates to the solver's tolerance.
    pub iterations: u32,
}

impl MotionSetting {
    /// Returns the setting of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let dynamics = &scene.dynamics;
        Self {
            element: scene.element(),
            cells: scene.beam.as_ref().map(|beam| beam.cells),
            integrator: dynamics.integrator,
            method: scene.solver.method,
            time_step: dynamics.time_step,
            iterations: dynamics.iterations,
        }
    }

    /// Returns the scene with this setting.
    #[must_use]
    pub fn apply(&self, scene: &Scene) -> Scene {
        let Self { element, cells, method, iterations, .. } = *self;
        let mut scene = Setting { element, cells, method, iterations }.apply(scene);
        let dynamics = &mut scene.dynamics;
        (dynamics.integrator, dynamics.time_step) = (self.integrator, self.time_step);
        dynamics.iterations = self.iterations;
        scene
    }

    /// Describes the number of solves per step, or per stage of one.
    fn solves_text(&self) -> Sentence {
        let entry = self.integrator.entry();
        match (self.iterations, entry.stages > 1) {
            _ if entry.is_explicit() => sentence!("no solve"),
            (0, _) => sentence!("to tolerance"),
            (n @ 1, true) => sentence!("%{n} solve a stage", n),
            (n @ 1, false) => sentence!("%{n} solve a step", n),
            (n, true) => sentence!("%{n} solves a stage", n),
            (n, false) => sentence!("%{n} solves a step", n),
        }
    }
}

displayed!(MotionSetting);

impl From<&MotionSetting> for Sentence {
    fn from(setting: &MotionSetting) -> Self {
        let theory = match setting.method {
            method if method.moves_linearly() => "linear theory",
            _ if setting.integrator.entry().is_explicit() => "corotated",
            method => method.id(),
        };
        sentence!(
            "%{mesh}, %{theory}, %{integrator}, %{step}, %{solves}",
            mesh = mesh_text(setting.element, setting.cells),
            integrator = setting.integrator.id(),
            step = step_text(setting.time_step),
            solves = setting.solves_text(),
            theory
        )
    }
}

/// Describes a time step: `1/60 s` if it is that fraction.
fn step_text(step: f64) -> String {
    let rate = 1.0 / step;
    if rate >= 1.5 && (rate - rate.round()).abs() < 1e-6 * rate {
        format!("1/{} s", rate.round())
    } else {
        format!("{step:.3e} s")
    }
}

/// Error of the first probe's path and its parts: largest distances at common times, percent of the size of the
/// reference's path. The total is at most the sum of the parts.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathError {
    /// Distance from the reference.
    pub total: f64,
    /// Root of the mean square over time of the distance from the reference.
    pub rms: f64,
    /// Error of the mesh: distance of the motion on this mesh, computed with the reference's steps, from the reference.
    pub discretization: f64,
    /// Error of time steps, solves and lumped masses: distance from the motion on this mesh by the same theory.
    pub integration: f64,
    /// Error of the theory: distance between the motions by linear and corotated theory on this mesh.
    pub model: f64,
}

impl PathError {
    /// Returns the sum of the parts. Settings are compared by it: a long step that happens to compensate the error of a
    /// coarse mesh is luck, not accuracy.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.discretization + self.integration + self.model
    }
}

/// End of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Ending {
    /// At the end of the studied time.
    Finished,
    /// Stopped early.
    Stopped,
    /// Too many steps: only the beginning was computed, to measure its time.
    CutShort,
}

impl Ending {
    /// Returns the identifier in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::CutShort => "cut_short",
        }
    }
}

/// Effect of an integrator on the energy of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyBehaviour {
    /// Changes the energy by less than a ten-thousandth of the largest kinetic energy.
    Kept,
    /// Removes energy.
    Lost,
    /// Adds energy.
    Gained,
}

impl EnergyBehaviour {
    /// Classifies a drift, percent of the largest kinetic energy.
    #[must_use]
    pub fn of(drift_percent: f64) -> Self {
        const KEPT: f64 = 0.01;
        match drift_percent {
            d if d.abs() < KEPT => Self::Kept,
            d if d < 0.0 => Self::Lost,
            _ => Self::Gained,
        }
    }

    /// Returns the identifier in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Lost => "lost",
            Self::Gained => "gained",
        }
    }
}

/// Measured time, error and energy drift of a setting.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MotionMeasurement {
    /// Setting.
    pub setting: MotionSetting,
    /// Number of free unknowns.
    pub dofs: usize,
    /// End of the motion.
    pub ending: Ending,
    /// Computing time per simulated second, ms, without the energy ledger: median over repetitions.
    pub milliseconds: f64,
    /// Error; `None` for a motion that did not finish.
    pub error: Option<PathError>,
    /// Energy added by the integrator, percent of the largest kinetic energy.
    pub drift_percent: f64,
    /// The same, percent of the energy put in.
    pub drift_of_input_percent: f64,
    /// Numbers of steps and solves.
    pub counts: Counts,
    /// `true` if no other measurement is both faster and more accurate; errors below the reference's own error count as
    /// equal.
    pub pareto: bool,
}

impl MotionMeasurement {
    /// Returns the effect of the integrator on the energy.
    #[must_use]
    pub fn energy(&self) -> EnergyBehaviour {
        EnergyBehaviour::of(self.drift_percent)
    }
}

impl Ranked for MotionMeasurement {
    fn setting_text(&self) -> Sentence {
        (&self.setting).into()
    }

    fn time_ms(&self) -> f64 {
        self.milliseconds
    }

    fn time_text(&self) -> String {
        format!("{:.3} ms per simulated second", self.milliseconds)
    }

    fn error_percent(&self) -> f64 {
        self.error.map_or(f64::INFINITY, |error| error.bound())
    }

    fn is_pareto(&self) -> bool {
        self.pareto
    }
}

/// Speed–accuracy study of a motion.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MotionStudy {
    /// Name of the scene.
    pub scene: String,
    /// Simulated time, s.
    pub duration: f64,
    /// Duration of the scene, s.
    pub scene_duration: f64,
    /// Cells along and across of the studied mesh that is closest to the scene's own; integrators are compared on it.
    pub own_mesh: Option<[u32; 2]>,
    /// Reference solution.
    pub reference: MotionReference,
    /// Measurements, sorted by element, mesh, integrator, step, method, solves.
    pub measurements: Vec<MotionMeasurement>,
    /// `true` if the study was cancelled before everything was measured.
    pub is_partial: bool,
}

/// Largest number of timed runs per setting.
const RUNS: usize = 5;
/// Number of steps after which the time of a shortened motion is known.
const MIN_STEPS: u32 = 500;

/// Longest time in which a displayed motion is measured, s, and the smallest number of its steps that are measured.
const MAX_TIME_OF_MOTION: f64 = 0.3;
const MIN_STEPS_OF_LARGE: f64 = 4.0;
/// Number of steps after which a measured motion asks if it goes on: to ask takes time, too.
const STEPS_BETWEEN_QUESTIONS: u32 = 16;

/// Approximate fraction of a study's time spent on the reference solution.
const REFERENCE_SHARE: f64 = 0.1;
/// Approximate fraction of a study's time spent on the reference motion of every mesh.
const OWN_SHARE: f64 = 0.1;
/// Approximate fraction of a mesh's time spent before its settings are timed.
const FIRST_RUNS_SHARE: f64 = 0.35;

impl MotionStudy {
    /// Measures a dynamic scene.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self, StudyError> {
        Self::with_partial(scene, extent, observe, &mut |_| {})
    }

    /// Measures as [`Self::new`]; `partial` receives the study so far each time a mesh is done.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn with_partial(
        scene: &Scene,
        extent: Extent,
        observe: Observer<'_>,
        partial: &mut dyn FnMut(&Self),
    ) -> Result<Self, StudyError> {
        let plan = extent.plan();
        MotionReference::check(scene)?;
        let samples = Samples::of(scene, plan)?;
        let studied = Studied { scene, samples, plan };
        let reference = MotionReference::new(scene, extent, &|progress| {
            observe(Progress { fraction: REFERENCE_SHARE * progress.fraction, ..progress })
        })?;
        let meshes = MeshPlan::all(scene, extent);
        let own = |mesh: &MeshPlan, observe: Observer<'_>| Meshed::new(studied, mesh, observe);
        let meshed = all_done(parallel::map(&meshes, own, |done| {
            let fraction = REFERENCE_SHARE + OWN_SHARE * done as f64 / meshes.len() as f64;
            observe(Progress { fraction, now: Some(&sentence!("the motion on every mesh")) })
        }))?;
        let mut study = Self {
            scene: scene.name.clone(),
            duration: samples.duration(),
            scene_duration: scene.dynamics.duration,
            own_mesh: cells(scene, finest_element(scene), 1.0),
            reference,
            measurements: Vec::new(),
            is_partial: false,
        };
        let all: f64 = meshes.iter().map(MeshPlan::weight).sum();
        let before = REFERENCE_SHARE + OWN_SHARE;
        let mut done = 0.0;
        for (mesh, meshed) in meshes.iter().zip(&meshed) {
            let fraction = |part: f64| before + (1.0 - before) * (done + part * mesh.weight()) / all;
            let measured = study.measure(studied, mesh, meshed, &|part| {
                observe(Progress { fraction: fraction(part.fraction), ..part })
            });
            match measured {
                // Keep the measurements made so far.
                Err(StudyError::Cancelled) if !study.measurements.is_empty() => {
                    study.is_partial = true;
                    break;
                }
                measured => measured?,
            }
            let mut so_far = study.clone();
            so_far.is_partial = true;
            so_far.mark_pareto();
            partial(&so_far);
            // A cancellation is seen by the next mesh.
            let _ = observe(Progress::at(fraction(1.0)));
            done += mesh.weight();
        }
        study.mark_pareto();
        Ok(study)
    }

    /// Measures every setting on a mesh. A cancelled measurement keeps its results.
    fn measure(
        &mut self,
        studied: Studied<'_>,
        mesh: &MeshPlan,
        meshed: &Meshed,
        observe: Observer<'_>,
    ) -> Result<(), StudyError> {
        // Run the untimed part first on all cores, so that the timed part runs alone on the machine.
        let first = |job: &Job, observe: Observer<'_>| {
            let (setting, steps) = job.setting(mesh, meshed.critical, studied.samples);
            FirstRun::new(studied, meshed, setting, steps, observe)
        };
        let now = sentence!("%{mesh}, paths of its settings", mesh = mesh_text(mesh.element, mesh.cells));
        let first = all_done(parallel::map(&mesh.jobs, first, |done| {
            observe(Progress { fraction: FIRST_RUNS_SHARE * done as f64 / mesh.jobs.len() as f64, now: Some(&now) })
        }))?;
        let mut done = 0.0;
        for (job, first) in mesh.jobs.iter().zip(first) {
            let part = FIRST_RUNS_SHARE + (1.0 - FIRST_RUNS_SHARE) * done / mesh.weight();
            let now = (&first.setting).into();
            check(observe(Progress { fraction: part, now: Some(&now) }))?;
            self.measurements.push(MotionMeasurement {
                setting: first.setting,
                dofs: meshed.system.dofs(),
                ending: first.ending,
                milliseconds: first.milliseconds(studied, meshed)?,
                error: (first.ending == Ending::Finished).then(|| self.error(&first, meshed)),
                drift_percent: 100.0 * first.drift,
                drift_of_input_percent: 100.0 * first.drift_of_input,
                counts: first.counts,
                pareto: false,
            });
            done += job.weight;
        }
        Ok(())
    }

    fn mark_pareto(&mut self) {
        let front = self.ranking().pareto(self.reference.error_percent);
        self.measurements.iter_mut().zip(front).for_each(|(m, front)| m.pareto = front);
    }

    /// Returns the measurements, ranked by time and error.
    #[must_use]
    pub fn ranking(&self) -> Ranking<'_, MotionMeasurement> {
        Ranking { measurements: &self.measurements, own_error_percent: self.reference.error_percent }
    }

    fn error(&self, run: &FirstRun, mesh: &Meshed) -> PathError {
        let (reference, path) = (&self.reference, &run.path);
        let own = if run.setting.method.moves_linearly() { &mesh.linear } else { &mesh.exact };
        let [total, rms] = reference.distance(path, &reference.path);
        PathError {
            total,
            rms,
            discretization: reference.distance(&mesh.exact, &reference.path)[0],
            integration: reference.distance(path, own)[0],
            model: reference.distance(own, &mesh.exact)[0],
        }
    }
}

/// Scene with the sampling times and extent of the study.
#[derive(Clone, Copy)]
struct Studied<'a> {
    scene: &'a Scene,
    samples: Samples,
    plan: &'a Plan,
}

/// Mesh with data computed once for it.
struct Meshed {
    system: Arc<System>,
    /// Path of the first probe on this mesh with the reference's steps.
    exact: Vec<Vector2<f64>>,
    /// The same path by linear theory.
    linear: Vec<Vector2<f64>>,
    /// Critical step of the explicit integrator, s.
    critical: Option<f64>,
}

impl Meshed {
    fn new(studied: Studied<'_>, mesh: &MeshPlan, observe: Observer<'_>) -> Result<Self, StudyError> {
        let Studied { scene, samples, plan } = studied;
        let MeshPlan { element, cells, .. } = *mesh;
        let scene = Setting { element, cells, method: MethodKind::Newton, iterations: 0 }.apply(scene);
        let system = system_of(&scene)?;
        let simulation = Simulation::with_system(&scene, system.clone())?;
        let mass = Mass::new(&system, scene.material.area_density());
        let critical = critical_step(simulation.problem(), &mass, scene.dynamics.damping);
        let own = |method| fine_path(&scene, method, &system, samples, plan.reference_steps(), observe);
        let (exact, linear) = (own(MethodKind::Newton)?, own(MethodKind::Linear)?);
        Ok(Self { system, exact, linear, critical })
    }
}

/// Untimed first run of a setting: records path, energy and counts. It needs much less memory than the simulation.
struct FirstRun {
    setting: MotionSetting,
    /// Number of steps between samples.
    steps_of_sample: u32,
    /// Total number of steps.
    steps: u32,
    ending: Ending,
    /// Displacement of the first probe at the samples, m; empty if the run was shortened.
    path: Vec<Vector2<f64>>,
    counts: Counts,
    /// Energy added by the integrator, relative to the largest kinetic energy.
    drift: f64,
    /// The same, relative to the energy put in.
    drift_of_input: f64,
}

impl FirstRun {
    fn new(
        studied: Studied<'_>,
        mesh: &Meshed,
        setting: MotionSetting,
        steps_of_sample: u32,
        observe: Observer<'_>,
    ) -> Result<Self, StudyError> {
        let Studied { scene, samples, plan } = studied;
        let mut simulation = Simulation::with_system(&setting.apply(scene), mesh.system.clone())?;
        let cut = u64::from(steps_of_sample) * u64::from(samples.count) > u64::from(plan.most_steps);
        let (steps, path) = if cut {
            run(&mut simulation, MIN_STEPS);
            (MIN_STEPS, Vec::new())
        } else {
            (steps_of_sample * samples.count, path(&mut simulation, samples, steps_of_sample, observe, &mut |_| {})?)
        };
        let stopped = matches!(simulation.status(), Status::Stopped(_));
        let ending = match (stopped, cut) {
            (true, _) => Ending::Stopped,
            (false, true) => Ending::CutShort,
            (false, false) => Ending::Finished,
        };
        let of_motion = simulation.motion().map(|motion| {
            let ledger = motion.ledger();
            (motion.counts(), ledger.drift(), ledger.drift_of_input())
        });
        let (counts, drift, drift_of_input) = of_motion.unwrap_or_default();
        Ok(Self { setting, steps_of_sample, steps, ending, path, counts, drift, drift_of_input })
    }

    /// Returns the computing time per simulated second, ms, measured by repeating the run.
    fn milliseconds(&self, studied: Studied<'_>, mesh: &Meshed) -> Result<f64, StudyError> {
        let mut simulation = Simulation::with_system(&self.setting.apply(studied.scene), mesh.system.clone())?;
        let warm_up = self.steps.min(self.steps_of_sample);
        Ok(milliseconds_per_second(&mut simulation, warm_up, self.steps, studied.plan.timing, &|| true))
    }
}

/// Returns the computing time per simulated second of a scene's motion from its start, ms, measured over the time that a
/// quick study simulates, or the beginning of it where it takes long; `None` for a scene at rest, and if the scene cannot
/// be solved or the computation is cancelled.
#[must_use]
pub fn time_of_motion(scene: &Scene, observe: Observer<'_>) -> Option<f64> {
    let goes_on = || observe(Progress::at(0.0)).is_continue();
    let mut simulation = Simulation::new(scene).ok().filter(|simulation| simulation.motion().is_some() && goes_on())?;
    let plan = Extent::Quick.plan();
    let steps = (Samples::of(scene, plan).ok()?.duration() / scene.dynamics.time_step).round().max(1.0);
    let steps = if steps > f64::from(plan.most_steps) { MIN_STEPS } else { steps as u32 };
    let begun = Instant::now();
    run(&mut simulation, 1);
    let of_step = begun.elapsed().as_secs_f64();
    simulation.reset();
    let steps = steps.min((MAX_TIME_OF_MOTION / of_step).max(MIN_STEPS_OF_LARGE) as u32);
    // A window that displays the motion has just opened, and disturbs the first runs.
    let milliseconds = milliseconds_per_second(&mut simulation, steps, steps, Extent::Full.plan().timing, &goes_on);
    goes_on().then_some(milliseconds)
}

/// Returns the computing time per simulated second of the first `steps` steps of a motion, ms, without the energy
/// ledger, after `warm_up` steps; it repeats them for the time `timing`, and stops when `goes_on` is `false`.
fn milliseconds_per_second(
    simulation: &mut Simulation,
    warm_up: u32,
    steps: u32,
    timing: Duration,
    goes_on: &dyn Fn() -> bool,
) -> f64 {
    simulation.keep_ledger(false);
    // Warms up caches and clocks, and initialises everything that is computed once per simulation.
    run(simulation, warm_up);
    let step = simulation.scene().dynamics.time_step;
    let mut simulated = 0.0;
    let runs = Runs { count: 1..=RUNS, enough: timing };
    let time = median_time(runs, simulation, Simulation::reset, |simulation| {
        let mut left = steps;
        while left > 0 && goes_on() {
            run(simulation, left.min(STEPS_BETWEEN_QUESTIONS));
            left = left.saturating_sub(STEPS_BETWEEN_QUESTIONS);
        }
        simulated = simulation.state().time();
    });
    // A motion that stops in its first step counts as long as that step.
    let seconds = if simulated > 0.0 { simulated } else { step };
    time.as_secs_f64().max(Duration::from_nanos(1).as_secs_f64()) * 1e3 / seconds
}

/// Computes up to `steps` steps, until the motion stops.
fn run(simulation: &mut Simulation, steps: u32) {
    for _ in 0..steps {
        if matches!(simulation.step(), Status::Stopped(_)) {
            break;
        }
    }
}

/// Returns the displacements of the first probe at the samples, m, from the start of a motion until it stops. `each`
/// receives the motion at every sample.
fn path(
    simulation: &mut Simulation,
    samples: Samples,
    steps: u32,
    observe: Observer<'_>,
    each: &mut dyn FnMut(&Simulation),
) -> Result<Vec<Vector2<f64>>, StudyError> {
    let mut path = Vec::with_capacity(samples.count as usize);
    for _ in 0..samples.count {
        check(observe(Progress::at(0.0)))?;
        run(simulation, steps);
        if matches!(simulation.status(), Status::Stopped(_)) {
            break;
        }
        path.push(first_probe(simulation)?);
        each(simulation);
    }
    Ok(path)
}
