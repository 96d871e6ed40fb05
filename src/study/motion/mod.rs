//! Measurement of a motion: error of the first probe's path against computing time, for every integrator, time step,
//! number of solves, method, element and mesh.

use std::time::Duration;

use web_time::Instant;

use self::plan::{MAX_STEPS, TIMING, settings};
pub(super) use self::plan::{REFERENCE_STEPS, Samples, meshes};
pub use self::reference::MotionReference;
use self::reference::run;
pub(super) use self::reference::{fine_path, path};
use super::prelude::*;
use super::timing::median_time;
use super::trade::{Measurement, Meshed, MotionFigures, Study, StudyReference};
use crate::assembly::Mass;
use crate::dynamics::critical_step;

mod plan;
mod reference;

/// Largest computing time per simulated second, ms, for which a motion runs in real time.
pub const REAL_TIME: f64 = 1e3;

/// Number of steps after which the time of a shortened motion is known.
const MIN_STEPS: u32 = 500;

/// Longest time in which a displayed motion is measured, s, and the smallest number of its steps that are measured.
const MAX_TIME_OF_MOTION: f64 = 0.3;
const MIN_STEPS_OF_LARGE: f64 = 4.0;
/// Number of steps after which a measured motion asks if it goes on: to ask takes time, too.
const STEPS_BETWEEN_QUESTIONS: u32 = 16;

/// Approximate fractions of a study's time when the reference solution is known, and the reference motion of every mesh.
pub(super) const SHARES: (f64, f64) = (0.1, 0.2);
/// Approximate fraction of a mesh's time spent before its settings are timed.
const FIRST_RUNS_SHARE: f64 = 0.35;

/// Measures every setting on a mesh. A cancelled measurement keeps its results.
pub(super) fn measure(
    study: &mut Study,
    scene: &Scene,
    extent: Extent,
    meshed: &Meshed,
    observe: Observer<'_>,
) -> Result<()> {
    let StudyReference::Motion(reference) = &study.reference else { return Err(StudyError::AtRest) };
    let (Meshed { mesh, system, .. }, samples) = (meshed, reference.samples());
    let of_mesh = mesh.apply(scene);
    let simulation = Simulation::with_system(&of_mesh, system.clone())?;
    let mass = Mass::new(system, of_mesh.material.area_density());
    let critical = critical_step(simulation.problem(), &mass, of_mesh.dynamics.damping);
    let settings = &settings(*mesh, critical, samples, extent);
    // The untimed part, path, energy and counts, runs first on all cores, so that the timed part runs alone on the machine.
    // A long motion is shortened.
    let now = sentence!("%{mesh}, paths of its settings", mesh = mesh_text(mesh.element, mesh.cells));
    let to = FIRST_RUNS_SHARE;
    let first = parallel::all(settings, observe, [0.0, to], &now, |&(setting, steps_of_sample), observe| {
        let mut simulation = Simulation::with_system(&setting.apply(scene), system.clone())?;
        let steps = u64::from(steps_of_sample) * u64::from(samples.count);
        let is_cut = steps > u64::from(extent.pick(MAX_STEPS));
        let (steps, path) = if is_cut {
            run(&mut simulation, MIN_STEPS);
            (MIN_STEPS, Vec::new())
        } else {
            (steps as u32, path(&mut simulation, samples, steps_of_sample, observe, &mut |_| {})?)
        };
        let is_stopped = matches!(simulation.status(), Status::Stopped(_));
        let (converged, is_cut_short) = (!is_stopped && !is_cut, !is_stopped && is_cut);
        let [_, rms_percent] = study.reference.distance(&path, None);
        let is_linear = setting.method.moves_linearly();
        let of_motion = simulation.motion().map(|motion| {
            let ledger = motion.ledger();
            (motion.counts(), 100.0 * ledger.drift(), 100.0 * ledger.drift_of_input())
        });
        let (counts, drift_percent, drift_of_input_percent) = of_motion.unwrap_or_default();
        let measurement = Measurement {
            setting,
            dofs: system.dofs(),
            converged,
            milliseconds: 0.0,
            error: converged.then(|| meshed.error(&path, is_linear, &study.reference)),
            time: Timings::default(),
            motion: Some(MotionFigures { is_cut_short, rms_percent, drift_percent, drift_of_input_percent, counts }),
            pareto: false,
        };
        Ok((measurement, steps))
    })?;
    for (done, ((_, steps_of_sample), (mut measurement, steps))) in settings.iter().zip(first).enumerate() {
        let part = done as f64 / settings.len() as f64;
        let fraction = FIRST_RUNS_SHARE + (1.0 - FIRST_RUNS_SHARE) * part;
        let now = (&measurement.setting).into();
        check(observe(Progress { fraction, now: Some(&now) }))?;
        let scene = measurement.setting.apply(scene);
        let mut simulation = Simulation::with_system(&scene, system.clone())?;
        let (timing, warm_up) = (extent.pick(TIMING), steps.min(*steps_of_sample));
        measurement.milliseconds = milliseconds_per_second(&mut simulation, warm_up, steps, timing, &|| true);
        study.measurements.push(measurement);
    }
    Ok(())
}

/// Returns the computing time per simulated second of a scene's motion from its start, ms, measured over the time that a
/// quick study simulates, or the beginning of it where it takes long; `None` for a scene at rest, and if the scene cannot
/// be solved or the computation is cancelled.
pub fn time_of_motion(scene: &Scene, observe: Observer<'_>) -> Option<f64> {
    let goes_on = || observe(Progress::at(0.0)).is_continue();
    let mut simulation = Simulation::new(scene).ok().filter(|simulation| simulation.motion().is_some() && goes_on())?;
    let steps = (Samples::of(scene, Extent::Quick).ok()?.duration() / scene.dynamics.time_step).round().max(1.0);
    let steps = if steps > f64::from(Extent::Quick.pick(MAX_STEPS)) { MIN_STEPS } else { steps as u32 };
    let begun = Instant::now();
    run(&mut simulation, 1);
    let of_step = begun.elapsed().as_secs_f64();
    simulation.reset();
    let steps = steps.min((MAX_TIME_OF_MOTION / of_step).max(MIN_STEPS_OF_LARGE) as u32);
    // A window that displays the motion has just opened, and disturbs the first runs.
    let milliseconds = milliseconds_per_second(&mut simulation, steps, steps, Extent::Full.pick(TIMING), &goes_on);
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
    let time = median_time(simulation, timing, |simulation| {
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
