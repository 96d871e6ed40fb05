//! Measurement of every setting of a scene. A solve starts from rest, which is the hardest case; data computed once per mesh
//! (sparsity, ordering, the factor of the stiffness at rest that `auto` keeps) already exist.

use super::fine::finest_element;
use super::motion;
use super::prelude::*;
use super::reference::{Reference, first_probe, system_of};
use super::timing::times_from_rest;
use super::trade::{Measurement, Meshed, Study, StudyReference};

/// Approximate fraction of a study's time when the reference solution is known.
const REFERENCE_SHARE: f64 = 0.1;
/// Numbers of iterations that are recorded.
const ITERATIONS: [u32; 8] = [1, 2, 3, 4, 6, 8, 12, Study::MAX_ITERATIONS];

impl StudyReference {
    /// Computes the reference of a study of a scene.
    pub fn new(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self, StudyError> {
        if scene.analysis == Analysis::Dynamic {
            return Self::of_motion(scene, extent, observe);
        }
        let reference = Reference::find(scene, None, Extent::Quick, observe)?;
        let first = reference.first().ok_or(StudyError::NoReference)?;
        Ok(Self {
            path: vec![first.displacement],
            size: first.displacement.norm(),
            error_percent: first.own_error_percent,
            samples: motion::Samples { interval: 0.0, count: 1 },
            text: (&reference).into(),
        })
    }
}

impl Study {
    /// Measures a scene. `observe` receives the progress, and breaks to cancel: the study then has the measurements so far.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use warpbeam::{Demand, Extent, Observer, Progress, Scene, Sentence, Study, StudyError};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]).probe("tip", "right");
    /// let observe: Observer<'_> = &|Progress { fraction, now }| {
    ///     println!("{:.0} % {}", 100.0 * fraction, now.map(Sentence::to_string).unwrap_or_default());
    ///     ControlFlow::Continue(()) // `Break` cancels
    /// };
    /// let study = Study::new(&scene, Extent::Quick, observe)?;
    /// let demand = Demand { max_error_percent: Some(5.0), max_time_ms: Some(100.0) };
    /// for m in study.meeting(demand) {
    ///     println!("{}: {} ms, error at most {} %", m.setting, m.milliseconds, study.error_bound(m));
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
        let mut meshes = if moves { motion::meshes(scene, extent) } else { meshes(scene, extent) };
        // At rest, start with the element that converges fastest, which is likely to give the best results.
        meshes.sort_by_key(|(mesh, _)| !moves && mesh.element != finest_element(scene));
        Self::begin(scene, extent, observe)?.measure(scene, extent, &meshes, observe, &mut |study, _, _| {
            partial(study);
            f64::INFINITY
        })
    }

    /// Returns the study of a scene with its reference solution and no measurements.
    pub(super) fn begin(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self> {
        let observe: Observer<'_> = &|progress| observe(within(progress, [0.0, REFERENCE_SHARE]));
        let reference = StudyReference::new(scene, extent, observe)?;
        let (own_error_percent, asked_percent) = (reference.error_percent, scene.solver.max_error_percent);
        let (scene, measurements) = (scene.name.clone(), Vec::new());
        Ok(Self { scene, reference, own_error_percent, asked_percent, measurements, is_partial: true })
    }

    /// Measures every setting on each mesh, which has an approximate cost. `after` receives the study when a mesh is done, and
    /// returns the cost of meshes above which no mesh is measured any more. A cancelled study keeps its measurements.
    pub(super) fn measure(
        mut self,
        scene: &Scene,
        extent: Extent,
        meshes: &[(Setting, f64)],
        observe: Observer<'_>,
        after: &mut dyn FnMut(&Self, Setting, f64) -> f64,
    ) -> Result<Self> {
        let all: f64 = meshes.iter().map(|(_, cost)| cost).sum();
        let (mut done, mut most) = (0.0, f64::INFINITY);
        for &(mesh, cost) in meshes {
            if cost > most {
                break;
            }
            let share = |done: f64| REFERENCE_SHARE + (1.0 - REFERENCE_SHARE) * (done / all);
            let shares = [share(done), share(done + cost)];
            let measured = self.measure_on(mesh, scene, extent, &|progress| observe(within(progress, shares)));
            let place = |m: &Measurement| scene.elements().position(|element| element == m.setting.element);
            self.measurements.sort_by_key(place);
            self.rank();
            match measured {
                Err(StudyError::Cancelled) if !self.measurements.is_empty() => return Ok(self),
                measured => measured?,
            }
            most = most.min(after(&self, mesh, cost));
            // A cancellation is seen by the next mesh.
            let _ = observe(Progress::at(shares[1]));
            done += cost;
        }
        self.is_partial = false;
        Ok(self)
    }

    /// Measures every setting on a mesh. A cancelled measurement keeps its results. The untimed part, the results of both
    /// theories, runs first on all cores, so that the timed part runs alone on the machine.
    fn measure_on(&mut self, mesh: Setting, scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<()> {
        let (scene, reference, moves) = (mesh.apply(scene), &self.reference, self.moves());
        let (system, steps) = (system_of(&scene)?, extent.pick(motion::REFERENCE_STEPS));
        let now = sentence!("%{mesh}, linear and corotated theory", mesh = mesh_text(mesh.element, mesh.cells));
        let theories = [MethodKind::Newton, MethodKind::Linear];
        let theories = parallel::all(&theories, observe, [0.0; 2], &now, |&method, observe| {
            let mut scene = scene.clone().with_method(method);
            if moves {
                return motion::fine_path(scene, &system, reference.samples, steps, observe);
            }
            scene.solver.max_iterations = scene.solver.max_iterations.max(1000);
            let mut simulation = Simulation::with_system(&scene, system.clone())?;
            check(simulation.solve_watched(&mut |_| observe(Progress::at(0.0))))?;
            match *simulation.status() != Status::Converged && method == MethodKind::Newton {
                true => Err(StudyError::NoReference),
                false => Ok(vec![first_probe(&simulation)?]),
            }
        })?;
        let meshed = Meshed { mesh, scene, system, reference, theories };
        match moves {
            true => motion::measure(&meshed, extent, observe, &mut self.measurements),
            false => measure_at_rest(&meshed, observe, &mut self.measurements),
        }
    }
}

/// Measures every method on a mesh.
fn measure_at_rest(meshed: &Meshed<'_>, observe: Observer<'_>, measurements: &mut Vec<Measurement>) -> Result<()> {
    let Meshed { mesh, scene, system, .. } = meshed;
    let text = mesh_text(mesh.element, mesh.cells);
    for (number, method) in METHODS.iter().map(|m| m.kind).enumerate() {
        let now = sentence!("%{mesh}, %{method}", mesh = &text, method = method.id());
        let fraction = number as f64 / METHODS.len() as f64;
        check(observe(Progress { fraction, now: Some(&now) }))?;
        let setting = Setting { method, ..*mesh };
        let mut simulation = Simulation::with_system(&setting.apply(scene), system.clone())?;
        // `auto` decides itself how many iterations it needs.
        let most = if method == MethodKind::Auto { u32::MAX } else { Study::MAX_ITERATIONS };
        let times = times_from_rest(&mut simulation, most, &|_| observe(Progress::at(fraction)));
        simulation.reset();
        for (iterations, time) in (1..).zip(times.ok_or(StudyError::Cancelled)?) {
            simulation.step();
            let ended = *simulation.status() != Status::Running;
            if !ended && (method == MethodKind::Auto || !ITERATIONS.contains(&iterations)) {
                continue;
            }
            let (setting, result) = (Setting { iterations, ..setting }, [first_probe(&simulation)?]);
            let converged = *simulation.status() == Status::Converged;
            measurements.push(Measurement {
                milliseconds: time.total().as_secs_f64() * 1e3,
                time,
                ..meshed.measurement(setting, converged, &result, simulation.is_linear(), None)
            });
        }
    }
    Ok(())
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
