//! Speed–accuracy study: error against time for every element, mesh, method and number of iterations, on this machine.
//!
//! A solve starts from rest, which is the hardest case; data computed once per mesh (sparsity, ordering, the factor of
//! the stiffness at rest that `auto` keeps) already exist.

use std::sync::Arc;

use nalgebra::Vector2;
use web_time::{Duration, Instant};

use super::fine::{Effort, finest_element};
use super::parallel;
use super::progress::{Extent, StudyError, all_done, check};
use super::ranking::{Ranked, Ranking};
use super::reference::{ProbeReference, Reference, end, first_probe, system_of};
use super::timing::{expected_time, times_from_rest};
use crate::assembly::System;
use crate::method::METHODS;
use crate::progress::{Observer, Progress};
use crate::scene::{ElementKind, MethodKind, Scene};
use crate::sentence::{Sentence, displayed, sentence};
use crate::simulation::{Simulation, Status};
use crate::timings::Timings;

/// Parameters varied in the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Setting {
    /// Element.
    pub element: ElementKind,
    /// Cells along and across; `None` for the mesh of a file.
    pub cells: Option<[u32; 2]>,
    /// Method.
    pub method: MethodKind,
    /// Number of iterations of a solve.
    pub iterations: u32,
}

impl Setting {
    /// Returns the scene's own setting with `iterations` iterations.
    #[must_use]
    pub fn of(scene: &Scene, iterations: u32) -> Self {
        let cells = scene.beam.as_ref().map(|b| b.cells);
        Self { element: scene.element(), cells, method: scene.solver.method, iterations }
    }

    /// Returns the scene with this mesh and method and `accept_after = 0`, so that a solve ends at convergence.
    /// [`Measurement::apply`] also limits the iterations.
    #[must_use]
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.set_element(self.element);
        if let (Some(beam), Some(cells)) = (&mut scene.beam, self.cells) {
            beam.cells = cells;
        }
        scene.solver.method = self.method;
        scene.solver.accept_after = 0;
        scene
    }
}

displayed!(Setting);

impl From<&Setting> for Sentence {
    fn from(setting: &Setting) -> Self {
        sentence!(
            "%{mesh}, %{method}, %{count}",
            mesh = mesh_text(setting.element, setting.cells),
            method = setting.method.id(),
            count = Self::count(setting.iterations, "iteration")
        )
    }
}

pub(super) fn mesh_text(element: ElementKind, cells: Option<[u32; 2]>) -> Sentence {
    match cells {
        Some([along, across]) => format!("{} {along}×{across}", element.id()).into(),
        None => sentence!("%{element} as meshed", element = element.id()),
    }
}

/// Error of a result and its parts, percent of the reference's displacement. The parts are lengths of displacements:
/// their sum is an upper bound of the total.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ErrorSplit {
    /// Distance from the reference solution.
    pub total: f64,
    /// Error of the mesh (locking): distance of the exact equilibrium on this mesh from the reference.
    pub discretization: f64,
    /// Error of stopping early: distance from the method's final result on this mesh.
    pub iteration: f64,
    /// Error of the theory: distance of linear theory's final result from the exact equilibrium on this mesh.
    pub model: f64,
}

impl ErrorSplit {
    /// Returns the sum of the parts, an upper bound of the distance from the reference. Settings are compared by it: an
    /// early stop that happens to compensate the error of a coarse mesh is luck, not accuracy.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.discretization + self.iteration + self.model
    }
}

/// Measured time and error of a setting.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Measurement {
    /// Setting.
    pub setting: Setting,
    /// Number of free unknowns.
    pub dofs: usize,
    /// `true` if the method had converged.
    pub converged: bool,
    /// Computing time of a solve, by stage: median over repetitions.
    pub time: Timings,
    /// Error.
    pub error: ErrorSplit,
    /// `true` if no other measurement is both faster and, by [`ErrorSplit::bound`], more accurate.
    pub pareto: bool,
}

impl Measurement {
    /// Returns the scene as measured: on the setting's mesh, with its method, stopped after the same number of
    /// iterations.
    #[must_use]
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut scene = self.setting.apply(scene);
        scene.solver.accept_after = self.accept_after();
        scene
    }

    /// Returns `true` if a scene is the result of [`Self::apply`].
    #[must_use]
    pub fn is_applied_to(&self, scene: &Scene) -> bool {
        Setting::of(scene, self.setting.iterations) == self.setting && scene.solver.accept_after == self.accept_after()
    }

    /// Returns the number of iterations after which the result was taken; 0 if the method had converged.
    fn accept_after(&self) -> u32 {
        if self.converged { 0 } else { self.setting.iterations }
    }

    /// Returns the computing time of a solve, ms.
    #[must_use]
    pub fn milliseconds(&self) -> f64 {
        self.time.total().as_secs_f64() * 1e3
    }
}

impl Ranked for Measurement {
    fn setting_text(&self) -> Sentence {
        (&self.setting).into()
    }

    fn time_ms(&self) -> f64 {
        self.milliseconds()
    }

    fn time_text(&self) -> String {
        format!("{:.4} ms", self.milliseconds())
    }

    fn error_percent(&self) -> f64 {
        self.error.bound()
    }

    fn is_pareto(&self) -> bool {
        self.pareto
    }
}

/// Speed–accuracy study of a scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Study {
    /// Name of the scene.
    pub scene: String,
    /// Reference solution.
    pub reference: Reference,
    /// Reference of the first probe, at which errors are measured.
    pub against: ProbeReference,
    /// Error requested from `auto`, percent.
    pub asked_percent: f64,
    /// Measurements, sorted by element, mesh, method, iterations.
    pub measurements: Vec<Measurement>,
}

/// Fraction of a study's time spent before timing starts.
const ENDS_SHARE: f64 = 0.1;
/// Numbers of iterations that are recorded.
const ITERATIONS: [u32; 8] = [1, 2, 3, 4, 6, 8, 12, Study::MAX_ITERATIONS];

impl Study {
    /// Largest number of iterations for methods that have not converged before.
    pub(crate) const MAX_ITERATIONS: u32 = 20;

    /// Measures a scene. `observe` receives the progress, and breaks to cancel.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use warpbeam::{
    ///     Demand, ErrorSplit, Extent, Measurement, Observer, Progress, Ranking, Scene, Sentence, Setting, Study, StudyError,
    /// };
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]).probe("tip", "right");
    /// let observe: Observer<'_> = &|Progress { fraction, now }| {
    ///     println!("{:.0} % {}", 100.0 * fraction, now.map(Sentence::to_string).unwrap_or_default());
    ///     ControlFlow::Continue(()) // `Break` cancels
    /// };
    /// let study = Study::new(&scene, Extent::Quick, observe)?;
    /// let demand = Demand { max_error_percent: Some(5.0), max_time_ms: Some(100.0) };
    /// let ranking: Ranking<'_, Measurement> = study.ranking();
    /// for Measurement { setting, error, .. } in ranking.meeting(demand) {
    ///     let (Setting { iterations, .. }, ErrorSplit { discretization, iteration, model, .. }) = (setting, error);
    ///     println!("{setting}: mesh {discretization} %, stopped after {iterations}: {iteration} %, theory {model} %");
    ///     assert!(discretization + iteration + model <= 5.0);
    /// }
    /// # Ok::<(), StudyError>(())
    /// ```
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
        let meshes = meshes(scene, extent);
        let mut study = Self::begin(scene, observe)?;
        // Run the untimed part first on all cores, so that the timed part runs alone on the machine.
        let ends = |mesh: &MeshChoice, observe: Observer<'_>| MeshEnds::find(scene, mesh, observe);
        let ends = all_done(parallel::map(&meshes, ends, |done| {
            let fraction = ENDS_SHARE * done as f64 / meshes.len() as f64;
            observe(Progress { fraction, now: Some(&sentence!("end state of every method")) })
        }))?;
        let all: f64 = ends.iter().map(MeshEnds::expected_time).sum();
        // Start with the element that converges fastest, which is likely to give the best results.
        let mut order: Vec<_> = meshes.iter().zip(&ends).collect();
        order.sort_by_key(|(mesh, _)| mesh.element != finest_element(scene));
        let mut done = 0.0;
        for (mesh, ends) in order {
            let time = ends.expected_time();
            let fraction = |part: f64| ENDS_SHARE + (1.0 - ENDS_SHARE) * (done + part * time) / all;
            study
                .measure(scene, mesh, ends, &|part| observe(Progress { fraction: fraction(part.fraction), ..part }))?;
            study.measurements.sort_by_key(|m| {
                let of = |mesh: &MeshChoice| (mesh.element, mesh.cells) == (m.setting.element, m.setting.cells);
                meshes.iter().position(of)
            });
            partial(&study);
            check(observe(Progress::at(fraction(1.0))))?;
            done += time;
        }
        Ok(study)
    }

    /// Measures as [`Self::new`], but if cancelled returns the measurements so far; the flag is `true` then.
    ///
    /// # Errors
    /// [`StudyError`]; [`StudyError::Cancelled`] if nothing has been measured.
    pub fn until_cancelled(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<(Self, bool), StudyError> {
        let mut partial = None;
        let whole = Self::with_partial(scene, extent, observe, &mut |so_far| partial = Some(so_far.clone()));
        match (whole, partial) {
            (Err(StudyError::Cancelled), Some(partial)) => Ok((partial, true)),
            (whole, _) => whole.map(|study| (study, false)),
        }
    }

    /// Returns a study with its reference solution and no measurements.
    pub(super) fn begin(scene: &Scene, observe: Observer<'_>) -> Result<Self, StudyError> {
        let begin = &|progress: Progress<'_>| observe(Progress { fraction: 0.0, ..progress });
        let reference = Reference::find(scene, None, Effort::Bounded, begin)?;
        let against = reference.first().ok_or(StudyError::NoBound)?;
        Ok(Self {
            scene: scene.name.clone(),
            reference,
            against,
            asked_percent: scene.solver.max_error_percent,
            measurements: Vec::new(),
        })
    }

    /// Measures every method on a mesh, and marks the Pareto front. A cancelled measurement leaves the
    /// study unchanged.
    pub(super) fn measure(
        &mut self,
        scene: &Scene,
        mesh: &MeshChoice,
        ends: &MeshEnds,
        observe: Observer<'_>,
    ) -> Result<(), StudyError> {
        let MeshChoice { element, cells, .. } = *mesh;
        let text = mesh_text(element, cells);
        let reference = self.against;
        let percent = |a, b| reference.percent(a, b);
        let MeshEnds { system, exact, linear, .. } = ends;
        let mut measurements = Vec::new();
        for (number, method) in METHODS.iter().map(|m| m.kind).enumerate() {
            let now = sentence!("%{mesh}, %{method}", mesh = &text, method = method.id());
            let fraction = number as f64 / METHODS.len() as f64;
            check(observe(Progress { fraction, now: Some(&now) }))?;
            let mut simulation = Simulation::with_system(&mesh.with(method).apply(scene), system.clone())?;
            // `auto` decides itself how many iterations it needs.
            let most = if method == MethodKind::Auto { u32::MAX } else { Self::MAX_ITERATIONS };
            let times = times_from_rest(&mut simulation, most, &|_| observe(Progress::at(fraction)));
            let times = times.ok_or(StudyError::Cancelled)?;
            simulation.reset();
            for (iterations, time) in (1..).zip(times) {
                simulation.step();
                let ended = *simulation.status() != Status::Running;
                if !ended && (method == MethodKind::Auto || !ITERATIONS.contains(&iterations)) {
                    continue;
                }
                let tip = first_probe(&simulation)?;
                // Converged corotated methods end at the exact equilibrium.
                let own_end = *if simulation.is_linear() { linear } else { exact };
                measurements.push(Measurement {
                    setting: Setting { element, cells, method, iterations },
                    dofs: simulation.system().dofs(),
                    converged: *simulation.status() == Status::Converged,
                    time,
                    error: ErrorSplit {
                        total: percent(tip, reference.displacement),
                        discretization: percent(*exact, reference.displacement),
                        iteration: percent(tip, own_end),
                        model: percent(own_end, *exact),
                    },
                    pareto: false,
                });
            }
        }
        self.measurements.append(&mut measurements);
        self.mark_pareto();
        Ok(())
    }

    fn mark_pareto(&mut self) {
        let front = self.ranking().pareto(0.0);
        self.measurements.iter_mut().zip(front).for_each(|(m, front)| m.pareto = front);
    }

    /// Returns `true` if the method of a measurement converged on its mesh, after this or another number of iterations.
    #[cfg(feature = "app")]
    pub(crate) fn converges(&self, measurement: &Measurement) -> bool {
        let of = |m: &Measurement| (m.setting.element, m.setting.cells, m.setting.method);
        self.measurements.iter().any(|m| m.converged && of(m) == of(measurement))
    }

    /// Returns the measurements, ranked by time and error.
    #[must_use]
    pub fn ranking(&self) -> Ranking<'_, Measurement> {
        Ranking { measurements: &self.measurements, own_error_percent: self.against.own_error_percent }
    }
}

/// Mesh of a study.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshChoice {
    pub element: ElementKind,
    pub cells: Option<[u32; 2]>,
    /// Approximate cost relative to other meshes.
    pub weight: f64,
}

impl MeshChoice {
    fn with(&self, method: MethodKind) -> Setting {
        Setting { element: self.element, cells: self.cells, method, iterations: 1 }
    }
}

/// Mesh with the final results of methods on it: displacements of the first probe, m.
#[derive(Clone, Debug)]
pub(super) struct MeshEnds {
    system: Arc<System>,
    /// Displacement in the exact equilibrium.
    exact: Vector2<f64>,
    /// Displacement by linear theory.
    linear: Vector2<f64>,
    /// Time needed to compute them.
    time: Duration,
}

impl MeshEnds {
    /// Computes the results on a mesh.
    pub fn find(scene: &Scene, mesh: &MeshChoice, observe: Observer<'_>) -> Result<Self, StudyError> {
        let meshed = mesh.with(MethodKind::Newton).apply(scene);
        let system = system_of(&meshed)?;
        let start = Instant::now();
        let first_end = |method| -> Result<_, StudyError> {
            Ok(end(&meshed, method, &system, observe)?.first().copied().unwrap_or_default())
        };
        let (exact, linear) = (first_end(MethodKind::Newton)?, first_end(MethodKind::Linear)?);
        Ok(Self { system, exact, linear, time: start.elapsed() })
    }

    /// Returns the approximate time of its measurement, s.
    fn expected_time(&self) -> f64 {
        METHODS.len() as f64 * expected_time(self.time).as_secs_f64()
    }
}

/// Largest number of rows of cells in meshes that are measured in addition to those with square cells; elements without
/// locking need few rows.
const MAX_ROWS: u32 = 2;
/// Largest ratio of height to length of such cells.
const HIGHEST_CELL: f64 = 4.0;

/// Returns the meshes of a scene, from coarse to fine for each element.
pub(super) fn meshes(scene: &Scene, extent: Extent) -> Vec<MeshChoice> {
    let mut meshes = Vec::new();
    for element in scene.elements() {
        let Some(beam) = &scene.beam else {
            meshes.push(MeshChoice { element, cells: None, weight: 1.0 });
            continue;
        };
        // The number of nodes along the beam is about the same for every element; cells are as high as long if
        // possible.
        let pieces = element.entry().degree() as u32;
        let nodes_along: &[u32] = &[5, 10, 20, 40, 80, 160];
        let nodes_along = if extent == Extent::Quick { &nodes_along[..4] } else { nodes_along };
        for &nodes_along in nodes_along {
            let along = nodes_along.div_ceil(pieces);
            let pieces = f64::from(pieces);
            let squares = f64::from(along) * beam.height / beam.length;
            let as_high = (squares / pieces).round().max(1.0) as u32;
            let few = |across: u32| across <= MAX_ROWS && squares / f64::from(across) <= HIGHEST_CELL;
            for across in (1..=as_high).filter(|&across| across == as_high || few(across)) {
                let nodes = f64::from(along) * f64::from(across) * pieces * pieces;
                // The weight includes the setup of the mesh.
                meshes.push(MeshChoice { element, cells: Some([along, across]), weight: 30.0 + nodes });
            }
        }
    }
    meshes
}
