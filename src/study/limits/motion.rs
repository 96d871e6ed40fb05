//! Limits of the integrators of a motion: each with time steps of powers of two, from short to long, compared with the
//! reference.

use std::sync::Mutex;

use super::{LimitPoint, MethodLimits, Property, Strip, Sweep};
use crate::study::motion::{MotionReference, REFERENCE_STEPS, Samples, fine_path, path};
use crate::study::prelude::*;
use crate::study::reference::system_of;

/// Powers of two of the shortest and the longest time step, relative to the scene's.
const POWERS: [i32; 2] = [-4, 3];
/// Largest number of steps of a motion; shorter time steps are not measured.
const MAX_STEPS: f64 = 4000.0;

/// Computes the limits of a motion: see [`MethodLimits::of`].
pub(super) fn limits(
    scene: &Scene,
    observe: Observer<'_>,
    partial: &(dyn Fn(&MethodLimits) + Sync),
) -> Result<MethodLimits> {
    /// Approximate fraction of the time spent on the reference solution.
    const REFERENCE: f64 = 0.3;
    let motions =
        Motions::new(scene, &|progress| observe(Progress { fraction: REFERENCE * progress.fraction, ..progress }))?;
    let factors: Vec<(f64, bool)> = motions.steps().into_iter().map(|(_, factor)| (factor, true)).collect();
    let (Some(&(first, _)), Some(&(last, _))) = (factors.first(), factors.last()) else {
        return Err(StudyError::NoReference);
    };
    let stepping = |integrator| Some(Stepping { integrator, time_step: scene.dynamics.time_step });
    let strip = |integrator| Strip::new(Setting { stepping: stepping(integrator), ..Setting::of(scene) });
    let limits = MethodLimits {
        range: [first, last],
        duration: Some(motions.samples.duration()),
        mesh_error_percent: Some(motions.mesh_error_percent),
        criticals: Vec::new(),
        reference: Vec::new(),
        strips: IntegratorKind::all().map(strip).collect(),
    };
    let sweep = Sweep { scene, limits: Mutex::new(limits), references: Mutex::default(), partial };
    let mut rows: Vec<(usize, IntegratorKind)> = IntegratorKind::all().enumerate().collect();
    rows.sort_by_key(|(_, integrator)| *integrator != scene.dynamics.integrator);
    let now = sentence!("following each integrator");
    parallel::all(&rows, observe, [REFERENCE, 1.0], &now, |&(row, integrator), observe| {
        let point = |factor: f64, _| motions.solve(integrator, factor, observe);
        sweep.follow(row, &factors, &point, &|property, _| property == Property::Converges)
    })?;
    Ok(lock(&sweep.limits).clone())
}

/// Motions of a scene on its own mesh, and their reference.
struct Motions<'a> {
    scene: &'a Scene,
    system: Arc<System>,
    samples: Samples,
    reference: MotionReference,
    /// Path of the first probe on the scene's mesh, with the reference's steps.
    exact: Vec<Vector2<f64>>,
    /// Part of each error that does not depend on the time steps: that of the mesh and of the reference, percent of the size
    /// of the reference's path.
    mesh_error_percent: f64,
}

impl<'a> Motions<'a> {
    /// Computes the reference of a quick study of a motion.
    fn new(scene: &'a Scene, observe: Observer<'_>) -> Result<Self> {
        let reference = MotionReference::new(scene, Extent::Quick, observe)?;
        let (samples, system) = (reference.samples(), system_of(scene)?);
        let steps = Extent::Quick.pick(REFERENCE_STEPS);
        let exact = fine_path(scene.clone().with_method(MethodKind::Newton), &system, samples, steps, observe)?;
        let mesh_error_percent = reference.distance(&exact, &reference.path)[0] + reference.error_percent;
        let mut motions = Self { scene, system, samples, reference, exact, mesh_error_percent };
        // All motions end at the same time.
        let longest = motions.steps().iter().map(|(power, _)| 1_u32 << (*power).max(0)).max().unwrap_or(1);
        motions.samples.count -= motions.samples.count % longest;
        Ok(motions)
    }

    /// Returns the time steps, each as a power of two of the sampling interval, and relative to the scene's.
    fn steps(&self) -> Vec<(i32, f64)> {
        let ratio = self.samples.interval / self.scene.dynamics.time_step;
        let own = ratio.log2().round() as i32;
        let fits = |power: &i32| {
            let steps = f64::from(self.samples.count) * 2f64.powi(-power);
            (1.0..=MAX_STEPS).contains(&steps)
        };
        // A step of the sampling interval is always measured.
        let powers = (POWERS[0] - own..=(POWERS[1] - own).max(0)).filter(fits);
        powers.map(|power| (power, ratio * 2f64.powi(power))).collect()
    }

    /// Computes the motion with a time step that is `factor` times the scene's. Only the path with a step of 2ⁿ sampling
    /// intervals has the samples of the reference: its error is the sum of those of the mesh, the time steps and the
    /// reference, as in [`ErrorSplit::bound`](crate::study::ErrorSplit::bound). Of others only convergence is found.
    fn solve(&self, integrator: IntegratorKind, factor: f64, observe: Observer<'_>) -> Result<LimitPoint> {
        let run = |samples: Samples, steps: u32, each: &mut dyn FnMut(&Simulation)| {
            let mut scene = self.scene.clone();
            (scene.dynamics.integrator, scene.dynamics.time_step) = (integrator, samples.interval / f64::from(steps));
            let mut simulation = Simulation::with_system(&scene, self.system.clone())?;
            simulation.keep_ledger(false);
            let path = path(&mut simulation, samples, steps, observe, each)?;
            Ok::<_, StudyError>((path, !matches!(simulation.status(), Status::Stopped(_))))
        };
        let Some((power, _)) = self.steps().into_iter().find(|(_, own)| *own == factor) else {
            let interval = factor * self.scene.dynamics.time_step;
            let count = (self.samples.duration() / interval).ceil() as u32;
            let (_, converges) = run(Samples { interval, count }, 1, &mut |_| {})?;
            return Ok(LimitPoint { factor, converges, ..LimitPoint::default() });
        };
        let [apart, steps] = [power, -power].map(|exponent| 1_u32 << exponent.max(0));
        let Samples { interval, count } = self.samples;
        let samples = Samples { interval: interval * f64::from(apart), count: count / apart };
        let (mut max_strain, mut inverted_elements) = (0.0_f64, 0);
        let (path, converges) = run(samples, steps, &mut |simulation| {
            let deformation = Deformation::of(simulation.problem(), simulation.state(), &simulation.nodal_stress());
            max_strain = max_strain.max(deformation.max_strain);
            inverted_elements = inverted_elements.max(deformation.inverted_elements);
        })?;
        if !converges {
            return Ok(LimitPoint { factor, ..LimitPoint::default() });
        }
        let every = apart as usize;
        let exact: Vec<_> = self.exact.iter().skip(every - 1).step_by(every).copied().collect();
        let [of_steps, _] = self.reference.distance(&path, &exact);
        Ok(LimitPoint {
            factor,
            converges,
            displacement: path.last().copied().unwrap_or_default(),
            max_strain: Some(max_strain),
            inverted_elements,
            is_compared: true,
            error_percent: Some(self.mesh_error_percent + of_steps),
            reference_percent: Some(self.reference.error_percent),
        })
    }
}
