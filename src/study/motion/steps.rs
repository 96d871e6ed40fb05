//! Motions of a scene on its own mesh with other integrators and time steps, compared with the reference.

use std::sync::Arc;

use nalgebra::Vector2;

use super::plan::Samples;
use super::reference::{MotionReference, fine_path, path};
use crate::assembly::System;
use crate::progress::Observer;
use crate::scene::{IntegratorKind, MethodKind, Scene};
use crate::simulation::{Deformation, Simulation, Status};
use crate::study::progress::{Extent, StudyError};
use crate::study::reference::system_of;

/// Powers of two of the shortest and the longest time step, relative to the scene's.
pub(in crate::study) const POWERS: [i32; 2] = [-4, 3];
/// Largest number of steps of a motion; shorter time steps are not measured.
const MAX_STEPS: f64 = 4000.0;

/// Motions of a scene, and their reference.
pub(in crate::study) struct StepStudy {
    scene: Scene,
    system: Arc<System>,
    samples: Samples,
    reference: MotionReference,
    /// Path of the first probe on the scene's mesh, with the reference's steps.
    exact: Vec<Vector2<f64>>,
    /// Distance of that path from the reference, percent of the size of the reference's path.
    mesh_error_percent: f64,
}

/// Motion with a time step.
pub(in crate::study) struct StepResult {
    /// Displacement of the first probe at the end, m.
    pub displacement: Vector2<f64>,
    /// Sum of the errors of the mesh and of the time steps, as in [`ErrorSplit::bound`](crate::study::ErrorSplit::bound), percent
    /// of the size of the reference's path, the reference's own error included.
    pub error_percent: f64,
    /// Largest strain at the samples.
    pub max_strain: f64,
    /// Largest number of inverted elements at the samples.
    pub inverted_elements: usize,
}

impl StepStudy {
    /// Computes the reference of a quick study of a motion.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(scene: &Scene, observe: Observer<'_>) -> Result<Self, StudyError> {
        let reference = MotionReference::new(scene, Extent::Quick, observe)?;
        let samples = reference.samples();
        let system = system_of(scene)?;
        let steps = Extent::Quick.plan().reference_steps();
        let exact = fine_path(scene, MethodKind::Newton, &system, samples, steps, observe)?;
        let [mesh_error_percent, _] = reference.distance(&exact, &reference.path);
        let mut study = Self { scene: scene.clone(), system, samples, reference, exact, mesh_error_percent };
        // All motions end at the same time.
        let longest = study.steps().iter().map(|(power, _)| 1_u32 << (*power).max(0)).max().unwrap_or(1);
        study.samples.count -= study.samples.count % longest;
        Ok(study)
    }

    /// Returns the simulated time, s.
    pub fn duration(&self) -> f64 {
        self.samples.duration()
    }

    /// Returns the error of the reference, percent of the size of its path.
    pub fn reference_error_percent(&self) -> f64 {
        self.reference.error_percent
    }

    /// Returns the part of each error that does not depend on the time steps: that of the mesh and of the reference, percent
    /// of the size of the reference's path.
    pub fn mesh_error_percent(&self) -> f64 {
        self.mesh_error_percent + self.reference.error_percent
    }

    /// Returns the time steps, each as a power of two of the sampling interval, and relative to the scene's.
    pub fn steps(&self) -> Vec<(i32, f64)> {
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

    /// Computes the motion with a time step of 2ⁿ sampling intervals, `n` being the power; `None` if it stops early.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn solve(
        &self,
        integrator: IntegratorKind,
        power: i32,
        observe: Observer<'_>,
    ) -> Result<Option<StepResult>, StudyError> {
        let [apart, steps] = [power, -power].map(|power| 1_u32 << power.max(0));
        let Samples { interval, count } = self.samples;
        let samples = Samples { interval: interval * f64::from(apart), count: count / apart };
        let mut simulation = self.simulation(integrator, samples.interval / f64::from(steps))?;
        let (mut max_strain, mut inverted_elements) = (0.0_f64, 0);
        let path = path(&mut simulation, samples, steps, observe, &mut |simulation| {
            let deformation = Deformation::of(simulation.problem(), simulation.state(), &simulation.nodal_stress());
            max_strain = max_strain.max(deformation.max_strain);
            inverted_elements = inverted_elements.max(deformation.inverted_elements);
        })?;
        if matches!(simulation.status(), Status::Stopped(_)) {
            return Ok(None);
        }
        let every = apart as usize;
        let exact: Vec<_> = self.exact.iter().skip(every - 1).step_by(every).copied().collect();
        let [of_steps, _] = self.reference.distance(&path, &exact);
        let displacement = path.last().copied().unwrap_or_default();
        let error_percent = self.mesh_error_percent() + of_steps;
        Ok(Some(StepResult { displacement, error_percent, max_strain, inverted_elements }))
    }

    /// Returns `true` if the motion with a time step, relative to the scene's, does not stop early.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn finishes(&self, integrator: IntegratorKind, factor: f64, observe: Observer<'_>) -> Result<bool, StudyError> {
        let step = factor * self.scene.dynamics.time_step;
        let mut simulation = self.simulation(integrator, step)?;
        let samples = Samples { interval: step, count: (self.duration() / step).ceil() as u32 };
        path(&mut simulation, samples, 1, observe, &mut |_| {})?;
        Ok(!matches!(simulation.status(), Status::Stopped(_)))
    }

    fn simulation(&self, integrator: IntegratorKind, step: f64) -> Result<Simulation, StudyError> {
        let mut scene = self.scene.clone();
        (scene.dynamics.integrator, scene.dynamics.time_step) = (integrator, step);
        let mut simulation = Simulation::with_system(&scene, self.system.clone())?;
        simulation.keep_ledger(false);
        Ok(simulation)
    }
}
