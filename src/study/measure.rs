//! Measurement of the settings of a body at rest. A solve starts from rest, which is the hardest case; data computed once
//! per mesh (sparsity, ordering, the factor of the stiffness at rest that `auto` keeps) already exist.

use super::fine::finest_element;
use super::motion::{self, MotionReference};
use super::prelude::*;
use super::reference::{Reference, first_probe};
use super::timing::times_from_rest;
use super::trade::{Measurement, Meshed, Study, StudyReference};

/// Fraction of a study's time spent before timing starts.
const ENDS_SHARE: f64 = 0.1;
/// Numbers of iterations that are recorded.
const ITERATIONS: [u32; 8] = [1, 2, 3, 4, 6, 8, 12, Study::MAX_ITERATIONS];

impl Study {
    /// Measures a scene. `observe` receives the progress, and breaks to cancel: the study then has the measurements so far.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use warpbeam::{
    ///     Demand, ErrorSplit, Extent, Measurement, Observer, Progress, Scene, Sentence, Setting, Study, StudyError,
    /// };
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]).probe("tip", "right");
    /// let observe: Observer<'_> = &|Progress { fraction, now }| {
    ///     println!("{:.0} % {}", 100.0 * fraction, now.map(Sentence::to_string).unwrap_or_default());
    ///     ControlFlow::Continue(()) // `Break` cancels
    /// };
    /// let study = Study::new(&scene, Extent::Quick, observe)?;
    /// let demand = Demand { max_error_percent: Some(5.0), max_time_ms: Some(100.0) };
    /// for Measurement { setting, error, .. } in study.meeting(demand) {
    ///     let (Setting { iterations, .. }, Some(ErrorSplit { discretization, iteration, model, .. })) = (setting, error)
    ///     else {
    ///         continue;
    ///     };
    ///     println!("{setting}: mesh {discretization} %, stopped after {iterations}: {iteration} %, theory {model} %");
    ///     assert!(discretization + iteration + model <= 5.0);
    /// }
    /// # Ok::<(), StudyError>(())
    /// ```
    ///
    /// # Errors
    /// [`StudyError`]; [`StudyError::Cancelled`] if nothing has been measured.
    pub fn new(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self, StudyError> {
        Self::with_partial(scene, extent, observe, &mut |_| {})
    }

    /// Measures as [`Self::new`]; `partial` receives the study so far each time a mesh is done.
    ///
    /// # Errors
    /// [`StudyError`]; [`StudyError::Cancelled`] if nothing has been measured.
    pub fn with_partial(
        scene: &Scene,
        extent: Extent,
        observe: Observer<'_>,
        partial: &mut dyn FnMut(&Self),
    ) -> Result<Self, StudyError> {
        let moves = scene.analysis == Analysis::Dynamic;
        // Fractions of the time when the reference is known, and when the timing starts.
        let (known, begun) = if moves { motion::SHARES } else { (0.0, ENDS_SHARE) };
        let (meshes, study) = {
            let observe =
                &|progress: Progress<'_>| observe(Progress { fraction: known * progress.fraction, ..progress });
            match moves {
                true => {
                    let reference = StudyReference::Motion(MotionReference::new(scene, extent, observe)?);
                    (motion::meshes(scene, extent), Self::begin(scene, reference)?)
                }
                false => (meshes(scene, extent), begin(scene, observe)?),
            }
        };
        // Run the untimed part first on all cores, so that the timed part runs alone on the machine.
        let now = if moves { sentence!("the motion on every mesh") } else { sentence!("end state of every method") };
        let meshed =
            parallel::all(&meshes, observe, [known, begun], &now, |(mesh, _), observe| match &study.reference {
                StudyReference::Rest(_) => meshed(scene, *mesh, observe),
                StudyReference::Motion(reference) => Meshed::new(scene, *mesh, |scene, system| {
                    let steps = extent.pick(motion::REFERENCE_STEPS);
                    motion::fine_path(scene, system, reference.samples(), steps, observe)
                }),
            })?;
        let mut order: Vec<_> = meshed.iter().zip(meshes.iter().map(|(_, weight)| *weight)).collect();
        // At rest, start with the element that converges fastest, which is likely to give the best results.
        order.sort_by_key(|(meshed, _)| !moves && meshed.mesh.element != finest_element(scene));
        study.measure_meshes(begun, &order, observe, partial, |study, meshed, observe| {
            match moves {
                true => motion::measure(study, scene, extent, meshed, observe)?,
                false => measure(study, scene, meshed, observe)?,
            }
            study.measurements.sort_by_key(|m| {
                let of = |mesh: &Setting| (mesh.element, mesh.cells) == (m.setting.element, m.setting.cells);
                meshes.iter().position(|(mesh, _)| of(mesh))
            });
            Ok(())
        })
    }
}

/// Returns a study of a scene at rest with its reference solution and no measurements.
pub(super) fn begin(scene: &Scene, observe: Observer<'_>) -> Result<Study> {
    Study::begin(scene, StudyReference::Rest(Reference::find(scene, None, Extent::Quick, observe)?))
}

/// Measures every method on a mesh. A cancelled measurement leaves the study unchanged.
pub(super) fn measure(study: &mut Study, scene: &Scene, meshed: &Meshed, observe: Observer<'_>) -> Result<()> {
    let Meshed { mesh, system, .. } = meshed;
    let text = mesh_text(mesh.element, mesh.cells);
    let mut measurements = Vec::new();
    for (number, method) in METHODS.iter().map(|m| m.kind).enumerate() {
        let now = sentence!("%{mesh}, %{method}", mesh = &text, method = method.id());
        let fraction = number as f64 / METHODS.len() as f64;
        check(observe(Progress { fraction, now: Some(&now) }))?;
        let setting = Setting { method, ..*mesh };
        let mut simulation = Simulation::with_system(&setting.apply(scene), system.clone())?;
        // `auto` decides itself how many iterations it needs.
        let most = if method == MethodKind::Auto { u32::MAX } else { Study::MAX_ITERATIONS };
        let times = times_from_rest(&mut simulation, most, &|_| observe(Progress::at(fraction)));
        let times = times.ok_or(StudyError::Cancelled)?;
        simulation.reset();
        for (iterations, time) in (1..).zip(times) {
            simulation.step();
            let ended = *simulation.status() != Status::Running;
            if !ended && (method == MethodKind::Auto || !ITERATIONS.contains(&iterations)) {
                continue;
            }
            let error = meshed.error(&[first_probe(&simulation)?], simulation.is_linear(), &study.reference);
            measurements.push(Measurement {
                setting: Setting { iterations, ..setting },
                dofs: simulation.system().dofs(),
                converged: *simulation.status() == Status::Converged,
                milliseconds: time.total().as_secs_f64() * 1e3,
                error: Some(error),
                time,
                motion: None,
                pareto: false,
            });
        }
    }
    study.measurements.append(&mut measurements);
    Ok(())
}

/// Meshes a scene, and computes the displacements of its first probe on that mesh, m.
pub(super) fn meshed(scene: &Scene, mesh: Setting, observe: Observer<'_>) -> Result<Meshed> {
    Meshed::new(scene, mesh, |mut scene, system| {
        scene.solver.max_iterations = scene.solver.max_iterations.max(1000);
        let mut simulation = Simulation::with_system(&scene, system.clone())?;
        check(simulation.solve_watched(&mut |_| observe(Progress::at(0.0))))?;
        match *simulation.status() != Status::Converged && scene.solver.method == MethodKind::Newton {
            true => Err(StudyError::NoReference),
            false => Ok(vec![first_probe(&simulation)?]),
        }
    })
}

/// Largest number of rows of cells in meshes that are measured in addition to those with square cells; elements without
/// locking need few rows.
const MAX_ROWS: u32 = 2;
/// Largest ratio of height to length of such cells.
const HIGHEST_CELL: f64 = 4.0;

/// Returns the meshes of a scene, from coarse to fine for each element, each with its approximate cost relative to others.
pub(super) fn meshes(scene: &Scene, extent: Extent) -> Vec<(Setting, f64)> {
    let mut meshes = Vec::new();
    for element in scene.elements() {
        let Some(beam) = &scene.beam else {
            meshes.push((Setting::newton(element, None), 1.0));
            continue;
        };
        // The number of nodes along the beam is about the same for every element; cells are as high as long if
        // possible.
        let pieces = element.entry().degree() as u32;
        for nodes_along in [5_u32, 10, 20, 40, 80, 160].into_iter().take(extent.pick([4, 6])) {
            let along = nodes_along.div_ceil(pieces);
            let pieces = f64::from(pieces);
            let squares = f64::from(along) * beam.height / beam.length;
            let as_high = (squares / pieces).round().max(1.0) as u32;
            let few = |across: u32| across <= MAX_ROWS && squares / f64::from(across) <= HIGHEST_CELL;
            for across in (1..=as_high).filter(|&across| across == as_high || few(across)) {
                let nodes = f64::from(along) * f64::from(across) * pieces * pieces;
                // The cost includes the setup of the mesh.
                meshes.push((Setting::newton(element, Some([along, across])), 30.0 + nodes));
            }
        }
    }
    meshes
}
