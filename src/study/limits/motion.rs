//! Limits of the integrators of a motion: each with time steps of powers of two, from short to long, compared with the
//! reference.

use super::{LimitPoint, MethodLimits, REFERENCE, TIME_STEPS};
use crate::study::motion::{REFERENCE_STEPS, Samples, fine_path, path};
use crate::study::prelude::*;
use crate::study::reference::system_of;
use crate::study::trade::StudyReference;

/// Largest number of steps of a motion; shorter time steps are not measured.
const MAX_STEPS: f64 = 4000.0;

/// Computes the limits of a motion: see [`MethodLimits::of`].
pub(super) fn limits(
    scene: &Scene,
    observe: Observer<'_>,
    partial: &(dyn Fn(&MethodLimits) + Sync),
) -> Result<MethodLimits> {
    let observe_first = |progress: Progress<'_>| observe(within(progress, [0.0, REFERENCE]));
    let reference = StudyReference::of_motion(scene, Extent::Quick, &observe_first)?;
    let (mut samples, system) = (reference.samples, system_of(scene)?);
    // Path of the first probe on the scene's mesh, with the reference's steps.
    let (newton, steps) = (scene.clone().with_method(MethodKind::Newton), Extent::Quick.pick(REFERENCE_STEPS));
    let exact = fine_path(newton, &system, samples, steps, &observe_first)?;
    // Part of each error that does not depend on the time steps: that of the mesh and of the reference.
    let mesh_error_percent = reference.distance(&exact, &reference.path)[0] + reference.error_percent;
    // Time steps are powers of two of the sampling interval, which is always measured.
    let ratio = samples.interval / scene.dynamics.time_step;
    let [shortest, longest] = TIME_STEPS.map(|part| (part / ratio).log2().round() as i32);
    let steps = |power: i32| f64::from(samples.count) * 2f64.powi(-power);
    let powers = (shortest..=longest.max(0)).filter(|&power| (1.0..=MAX_STEPS).contains(&steps(power)));
    let powers: Vec<i32> = powers.collect();
    let loads: Vec<(f64, bool)> = powers.iter().map(|&power| (ratio * 2f64.powi(power), true)).collect();
    let (Some(&(first, _)), Some(&(last, _))) = (loads.first(), loads.last()) else {
        return Err(StudyError::NoReference);
    };
    // All motions end at the same time.
    samples.count -= samples.count % (1 << powers.last().copied().unwrap_or_default().max(0));
    // Only the path with a step of 2ⁿ sampling intervals has the samples of the reference: its error is the sum of those of
    // the mesh, the time steps and the reference, as in `Measurement::error_percent`. Of others only convergence is found.
    let solve = |setting: &Setting, (factor, is_compared): (f64, bool), observe: Observer<'_>| {
        let power = (factor / ratio).log2().round() as i32;
        let [apart, steps] = [power, -power].map(|exponent| 1_u32 << exponent.max(0));
        let (samples, steps) = if is_compared {
            (Samples { interval: samples.interval * f64::from(apart), count: samples.count / apart }, steps)
        } else {
            let interval = factor * scene.dynamics.time_step;
            (Samples { interval, count: (samples.duration() / interval).ceil() as u32 }, 1)
        };
        let mut scene = setting.apply(scene);
        scene.dynamics.time_step = samples.interval / f64::from(steps);
        let mut simulation = Simulation::with_system(&scene, system.clone())?;
        simulation.keep_ledger(false);
        let (mut max_strain, mut inverted_elements) = (0.0_f64, 0);
        let path = path(&mut simulation, samples, steps, observe, &mut |simulation| {
            if is_compared {
                let deformation = Deformation::of(simulation.problem(), simulation.state(), &simulation.nodal_stress());
                max_strain = max_strain.max(deformation.max_strain);
                inverted_elements = inverted_elements.max(deformation.inverted_elements);
            }
        })?;
        let converges = !matches!(simulation.status(), Status::Stopped(_));
        let point = LimitPoint { factor, converges, ..LimitPoint::default() };
        if !(converges && is_compared) {
            return Ok(point);
        }
        let every = apart as usize;
        let exact: Vec<_> = exact.iter().skip(every - 1).step_by(every).copied().collect();
        let [of_steps, _] = reference.distance(&path, &exact);
        Ok(LimitPoint {
            displacement: path.last().copied().unwrap_or_default(),
            max_strain: Some(max_strain),
            inverted_elements,
            is_compared,
            error_percent: Some(mesh_error_percent + of_steps),
            reference_percent: Some(reference.error_percent),
            ..point
        })
    };
    let stepping = |integrator| Some(Stepping { integrator, time_step: scene.dynamics.time_step });
    let settings =
        IntegratorKind::all().map(|integrator| Setting { stepping: stepping(integrator), ..Setting::of(scene) });
    let limits = MethodLimits {
        range: [first, last],
        duration: Some(samples.duration()),
        mesh_error_percent: Some(mesh_error_percent),
        ..MethodLimits::default()
    };
    limits.followed(scene, settings, &loads, solve, observe, partial)
}
