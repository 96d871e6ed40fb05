//! Reference path of a motion: energy–momentum method with short steps on a fine mesh.

use super::plan::{REFERENCE_MESH, REFERENCE_STEPS, Samples, cells, nodes_of_shape, slenderness};
use crate::study::fine::finest_element;
use crate::study::prelude::*;
use crate::study::reference::{first_probe, system_of};
use crate::study::trade::StudyReference;

/// Number of elements of a mesh file above which motions on the refined mesh take too long.
const MAX_ELEMENTS: usize = 4000;
/// Length of a beam relative to its height from which on its path converges as fast as its mesh.
const SLENDER: f64 = 5.0;

impl StudyReference {
    /// Computes the reference path of a motion for a study of this extent. Its own error is a third, according to second-order
    /// convergence, of the change of the path with steps of twice the length, plus a third of its change with half as many
    /// cells in each direction; of a body that is not slender, the whole of that change, because its corners let it converge
    /// more slowly.
    pub(in crate::study) fn of_motion(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self> {
        scene.validate().map_err(SimulationError::from)?;
        if scene.probes.is_empty() {
            return Err(StudyError::NoProbe);
        }
        let (samples, steps) = (Samples::of(scene, extent)?, extent.pick(REFERENCE_STEPS));
        let [coarse, fine] = meshes(scene, extent)?;
        // Paths on a coarser mesh, with longer steps, and the best one.
        let paths = [(&coarse, steps / 2), (&fine, steps / 2), (&fine, steps)];
        let now = sentence!("the reference solution");
        let paths = parallel::all(&paths, observe, [0.0, 1.0], &now, |((scene, system), steps), observe| {
            fine_path(scene.clone(), system, samples, *steps, observe)
        })?;
        let [coarser, longer, path] = <[_; 3]>::try_from(paths).unwrap_or_default();
        let size = path.iter().map(|u| u.norm()).fold(0.0, f64::max);
        if size == 0.0 {
            return Err(StudyError::NoProbe);
        }
        let (element, cells) = (fine.0.element(), fine.0.beam.as_ref().map(|beam| beam.cells));
        let mut reference = Self { path, size, error_percent: 0.0, samples, text: Sentence::default() };
        let [of_mesh, _] = reference.distance(&coarser, &longer);
        let [of_step, _] = reference.distance(&longer, &reference.path);
        let is_slender = slenderness(scene).is_some_and(|ratio| ratio >= SLENDER);
        let part_of_mesh = if is_slender { 1.0 / 3.0 } else { 1.0 };
        reference.error_percent = part_of_mesh * of_mesh + of_step / 3.0;
        reference.text = sentence!(
            "%{integrator} with steps of %{step} on %{mesh} (its own error about %{own})",
            integrator = IntegratorKind::EnergyMomentum.id(),
            step = step_text(samples.interval / f64::from(steps)),
            mesh = match cells {
                Some(_) => mesh_text(element, cells),
                None => sentence!("%{element} on the refined mesh", element = element.id()),
            },
            own = percent(reference.error_percent)
        );
        Ok(reference)
    }
}

/// Computes the path of the first probe of a scene by the energy–momentum method, with `steps` steps between samples.
pub(in crate::study) fn fine_path(
    mut scene: Scene,
    system: &Arc<System>,
    samples: Samples,
    steps: u32,
    observe: Observer<'_>,
) -> Result<Vec<Vector2<f64>>> {
    let dynamics = &mut scene.dynamics;
    (dynamics.integrator, dynamics.iterations) = (IntegratorKind::EnergyMomentum, 0);
    dynamics.time_step = samples.interval / f64::from(steps);
    let mut simulation = Simulation::with_system(&scene, system.clone())?;
    simulation.keep_ledger(false);
    let path = path(&mut simulation, samples, steps, observe, &mut |_| {})?;
    match simulation.status() {
        Status::Stopped(reason) => Err(StudyError::NoPath(*reason)),
        _ => Ok(path),
    }
}

/// Returns the scene with half as many cells in each direction, and with the fine mesh, each with its equations. A beam has
/// at least as many cells as its shape requires: on one cell across, the path converges to another one.
fn meshes(scene: &Scene, extent: Extent) -> Result<[(Scene, Arc<System>); 2]> {
    /// Smallest number of nodes along per height, and across.
    const PER_HEIGHT: f64 = 8.0;
    const ACROSS: f64 = 4.0;
    let element = finest_element(scene);
    let pieces = element.entry().degree() as f64;
    let least = nodes_of_shape(scene, PER_HEIGHT, ACROSS).map(|nodes| nodes.map(|n| (n / pieces).ceil() as u32));
    let fine = cells(scene, element, extent.pick(REFERENCE_MESH)).zip(least);
    let fine = fine.map(|(own, least)| [0, 1].map(|i| own[i].max(least[i])));
    let with = |cells| {
        let scene = Setting::newton(element, cells).apply(scene);
        let system = system_of(&scene)?;
        Ok::<_, StudyError>((scene, system))
    };
    let (coarse, mut fine) = (with(fine.map(|cells| cells.map(|n| n.div_ceil(2))))?, with(fine)?);
    if scene.beam.is_none() {
        let (scene, system) = &mut fine;
        let elements = system.mesh().element_count();
        if elements > MAX_ELEMENTS {
            return Err(StudyError::TooFine { elements });
        }
        *system = Arc::new(System::with_mesh(scene, system.mesh().refined())?);
    }
    Ok([coarse, fine])
}

/// Computes up to `steps` steps, until the motion stops.
pub(super) fn run(simulation: &mut Simulation, steps: u32) {
    for _ in 0..steps {
        if matches!(simulation.step(), Status::Stopped(_)) {
            break;
        }
    }
}

/// Returns the displacements of the first probe at the samples, m, from the start of a motion until it stops. `each`
/// receives the motion at every sample.
pub(in crate::study) fn path(
    simulation: &mut Simulation,
    samples: Samples,
    steps: u32,
    observe: Observer<'_>,
    each: &mut dyn FnMut(&Simulation),
) -> Result<Vec<Vector2<f64>>> {
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
