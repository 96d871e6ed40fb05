//! Measurement of a motion: error of the first probe's path against computing time, for every integrator, time step,
//! number of solves, method, element and mesh.

use std::ops::ControlFlow;

pub use self::plan::Samples;
use self::plan::{MAX_STEPS, TIMING, settings};
pub(super) use self::plan::{REFERENCE_STEPS, meshes};
use self::reference::run;
pub(super) use self::reference::{fine_path, path};
use super::prelude::*;
use super::timing::milliseconds_per_second;
use super::trade::{Measurement, Meshed, MotionFigures};
use crate::assembly::Mass;
use crate::dynamics::critical_step;

mod plan;
mod reference;

/// Number of steps after which the time of a shortened motion is known.
const MIN_STEPS: u32 = 500;
/// Approximate fraction of a mesh's time spent before its settings are timed.
const FIRST_SHARE: f64 = 0.35;

/// Measures every setting on a mesh. A cancelled measurement keeps its results.
pub(super) fn measure(
    meshed: &Meshed<'_>,
    extent: Extent,
    observe: Observer<'_>,
    measurements: &mut Vec<Measurement>,
) -> Result<()> {
    let Meshed { mesh, scene, system, reference, .. } = meshed;
    let samples = reference.samples;
    let simulation = Simulation::with_system(scene, system.clone())?;
    let mass = Mass::new(system, scene.material.area_density());
    let critical = critical_step(simulation.problem(), &mass, scene.dynamics.damping);
    let settings = settings(*mesh, critical, samples, extent);
    // The untimed part, path, energy and counts, runs first on all cores, so that the timed part runs alone on the machine.
    // A long motion is shortened.
    let now = sentence!("%{mesh}, paths of its settings", mesh = mesh_text(mesh.element, mesh.cells));
    let first = parallel::all(&settings, observe, [0.0, FIRST_SHARE], &now, |&(setting, steps_of_sample), observe| {
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
        let [_, rms_percent] = reference.distance(&path, &reference.path);
        let of_motion = simulation.motion().map(|motion| {
            let ledger = motion.ledger();
            (motion.counts(), 100.0 * ledger.drift(), 100.0 * ledger.drift_of_input())
        });
        let (counts, drift_percent, drift_of_input_percent) = of_motion.unwrap_or_default();
        let is_cut_short = is_cut && !is_stopped;
        let motion = MotionFigures { is_cut_short, rms_percent, drift_percent, drift_of_input_percent, counts };
        let is_linear = setting.method.moves_linearly();
        Ok((meshed.measurement(setting, !is_stopped && !is_cut, &path, is_linear, Some(motion)), steps))
    })?;
    let count = first.len() as f64;
    for (done, (measurement, steps)) in first.into_iter().enumerate() {
        let now = (&measurement.setting).into();
        let progress = Progress { fraction: done as f64 / count, now: Some(&now) };
        check(observe(within(progress, [FIRST_SHARE, 1.0])))?;
        let mut simulation = Simulation::with_system(&measurement.setting.apply(scene), system.clone())?;
        let go_on: Observer<'_> = &|_| ControlFlow::Continue(());
        let milliseconds = milliseconds_per_second(&mut simulation, steps, extent.pick(TIMING), go_on);
        measurements.push(Measurement { milliseconds: milliseconds.ok_or(StudyError::Cancelled)?, ..measurement });
    }
    Ok(())
}
