//! Measurement of a motion: error of the first probe's path against computing time, for every integrator, time step,
//! number of solves, method, element and mesh.

use std::sync::Arc;
use std::time::Duration;

use nalgebra::Vector2;
use web_time::Instant;

use self::plan::{Job, MeshPlan, Plan, Samples};
pub use self::reference::MotionReference;
use self::reference::{fine_path, path, run};
use super::parallel;
use super::progress::{Extent, StudyError, all_done, check};
use super::reference::system_of;
use super::setting::{Setting, mesh_text};
use super::timing::{Runs, median_time};
use super::trade::{Ending, ErrorSplit, Measurement, MotionFigures, Study, StudyReference};
use crate::assembly::{Mass, System};
use crate::dynamics::critical_step;
use crate::progress::{Observer, Progress};
use crate::scene::{MethodKind, Scene};
use crate::sentence::sentence;
use crate::simulation::{Simulation, Status};
use crate::timings::Timings;

mod plan;
mod reference;
pub(super) mod steps;

/// Largest computing time per simulated second, ms, for which a motion runs in real time.
pub const REAL_TIME: f64 = 1e3;

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

/// Measures a dynamic scene: see [`Study::with_partial`].
pub(super) fn study(
    scene: &Scene,
    extent: Extent,
    observe: Observer<'_>,
    partial: &mut dyn FnMut(&Study),
) -> Result<Study, StudyError> {
    let plan = extent.plan();
    let reference = MotionReference::new(scene, extent, &|progress| {
        observe(Progress { fraction: REFERENCE_SHARE * progress.fraction, ..progress })
    })?;
    let studied = Studied { scene, samples: reference.samples(), plan };
    let meshes = MeshPlan::all(scene, extent);
    let own = |mesh: &MeshPlan, observe: Observer<'_>| Meshed::new(studied, mesh, observe);
    let meshed = all_done(parallel::map(&meshes, own, |done| {
        let fraction = REFERENCE_SHARE + OWN_SHARE * done as f64 / meshes.len() as f64;
        observe(Progress { fraction, now: Some(&sentence!("the motion on every mesh")) })
    }))?;
    let study = Study::begin(scene, StudyReference::Motion(reference.clone()), reference.error_percent);
    let weighted = meshes.iter().zip(&meshed).map(|(mesh, meshed)| ((mesh, meshed), mesh.weight()));
    study.measure_meshes(REFERENCE_SHARE + OWN_SHARE, weighted, observe, partial, |study, (mesh, meshed), observe| {
        measure(study, &reference, studied, mesh, meshed, observe)
    })
}

/// Measures every setting on a mesh. A cancelled measurement keeps its results.
fn measure(
    study: &mut Study,
    reference: &MotionReference,
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
        let converged = first.figures.ending == Ending::Finished;
        let [total, rms_percent] = reference.distance(&first.path, &reference.path);
        let own = if first.setting.method.moves_linearly() { &meshed.linear } else { &meshed.exact };
        study.measurements.push(Measurement {
            setting: first.setting,
            dofs: meshed.system.dofs(),
            converged,
            milliseconds: first.milliseconds(studied, meshed)?,
            error: converged.then(|| ErrorSplit {
                total,
                discretization: reference.distance(&meshed.exact, &reference.path)[0],
                iteration: reference.distance(&first.path, own)[0],
                model: reference.distance(own, &meshed.exact)[0],
            }),
            time: Timings::default(),
            motion: Some(MotionFigures { rms_percent, ..first.figures }),
            pareto: false,
        });
        done += job.weight;
    }
    Ok(())
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
        let scene = Setting { element, cells, method: MethodKind::Newton, iterations: 0, stepping: None }.apply(scene);
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
    setting: Setting,
    /// Number of steps between samples.
    steps_of_sample: u32,
    /// Total number of steps.
    steps: u32,
    /// Displacement of the first probe at the samples, m; empty if the run was shortened.
    path: Vec<Vector2<f64>>,
    /// Figures without the error.
    figures: MotionFigures,
}

impl FirstRun {
    fn new(
        studied: Studied<'_>,
        mesh: &Meshed,
        setting: Setting,
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
            (motion.counts(), 100.0 * ledger.drift(), 100.0 * ledger.drift_of_input())
        });
        let (counts, drift_percent, drift_of_input_percent) = of_motion.unwrap_or_default();
        let figures = MotionFigures { ending, rms_percent: 0.0, drift_percent, drift_of_input_percent, counts };
        Ok(Self { setting, steps_of_sample, steps, path, figures })
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
