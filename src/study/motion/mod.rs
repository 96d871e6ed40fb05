//! The trade in time: error of the first probe's path against the time of computing it, for every integrator, time step,
//! number of solves, method, element and mesh, on this machine.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

use nalgebra::Vector2;

pub use self::reference::MotionReference;
use self::reference::fine_path;
use super::pareto;
use super::reference::{finest_element, first_probe, system_of};
use super::timing::{Runs, median_time};
use super::trade::{Extent, Observer, Progress, Setting, StudyError, check, mesh_words};
use crate::assembly::{Mass, System};
use crate::dynamics::{Counts, INTEGRATORS, IntegratorEntry, critical_step};
use crate::method::METHODS;
use crate::scene::{ElementKind, IntegratorKind, MethodKind, Scene};
use crate::simulation::{Simulation, Status};
use crate::words::count;

mod reference;
mod report;

/// Milliseconds that a simulated second may take where it is to be seen as it happens.
pub const REAL_TIME: f64 = 1e3;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionSetting {
    /// Element.
    pub element: ElementKind,
    /// Cells along and across; `None` for the mesh of a file.
    pub cells: Option<[u32; 2]>,
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Theory and matrix. Of an explicit integrator, which has no matrix, only the theory.
    pub method: MethodKind,
    /// Time step, s.
    pub time_step: f64,
    /// Solves a step, or a stage of one; 0: as many as the solver's tolerance takes.
    pub iterations: u32,
}

impl MotionSetting {
    /// The scene with this setting.
    #[must_use]
    pub fn apply(&self, scene: &Scene) -> Scene {
        let Self { element, cells, method, iterations, .. } = *self;
        let mut scene = Setting { element, cells, method, iterations }.apply(scene);
        let dynamics = &mut scene.dynamics;
        (dynamics.integrator, dynamics.time_step) = (self.integrator, self.time_step);
        dynamics.iterations = self.iterations;
        scene
    }

    /// How often a step, or a stage of one, is solved, in words.
    fn solves_words(&self) -> String {
        let entry = self.integrator.entry();
        match self.iterations {
            _ if entry.is_explicit() => "no solve".to_owned(),
            0 => "to tolerance".to_owned(),
            n if entry.stages > 1 => format!("{} a stage", count(n, "solve")),
            n => format!("{} a step", count(n, "solve")),
        }
    }
}

impl std::fmt::Display for MotionSetting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mesh = mesh_words(self.element, self.cells);
        let (step, solves) = (step_words(self.time_step), self.solves_words());
        let theory = match self.method {
            MethodKind::Linear => "linear theory",
            _ if self.integrator.entry().is_explicit() => "corotated",
            method => method.id(),
        };
        write!(f, "{mesh}, {}, {step}, {solves}, {theory}", self.integrator.id())
    }
}

/// A time step in words: `1/60 s` where that is what it is.
fn step_words(step: f64) -> String {
    let rate = 1.0 / step;
    if rate >= 1.5 && (rate - rate.round()).abs() < 1e-6 * rate {
        format!("1/{} s", rate.round())
    } else {
        format!("{step:.3e} s")
    }
}

/// How far the first probe's path is from the reference's, and where that comes from: largest distances at common times,
/// percent of how far the reference's path leads. The whole is no larger than the sum of the parts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PathError {
    /// From the reference.
    pub total: f64,
    /// The same, the root of the mean square over time.
    pub rms: f64,
    /// Of the mesh: its own motion, with the reference's steps, from the reference.
    pub discretization: f64,
    /// Of time steps, solves and lumped masses: from the mesh's own motion under the same theory.
    pub integration: f64,
    /// Of the theory: linear theory's own motion on the mesh from the corotated one.
    pub model: f64,
}

impl PathError {
    /// The sum of the parts. Settings are compared by it: a long step that happens to make up for a coarse mesh is luck,
    /// not accuracy.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.discretization + self.integration + self.model
    }
}

/// How a motion came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// At the end of the time that is studied.
    Finished,
    /// It could not go on.
    Stopped,
    /// It would have taken too many steps: only its beginning was run, for its time.
    CutShort,
}

impl Ending {
    /// The word in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::CutShort => "cut_short",
        }
    }
}

/// What an integrator does to the energy of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyBehaviour {
    /// Neither: no more than a ten-thousandth of the largest kinetic energy.
    Kept,
    /// Takes.
    Lost,
    /// Adds.
    Gained,
}

impl EnergyBehaviour {
    /// Of a drift, percent of the largest kinetic energy.
    #[must_use]
    pub fn of(drift_percent: f64) -> Self {
        const KEPT: f64 = 0.01;
        match drift_percent {
            d if d.abs() < KEPT => Self::Kept,
            d if d < 0.0 => Self::Lost,
            _ => Self::Gained,
        }
    }

    /// The word in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Lost => "lost",
            Self::Gained => "gained",
        }
    }
}

/// A setting with its price, its error and what it does to energy.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionMeasurement {
    /// What was measured.
    pub setting: MotionSetting,
    /// Free unknowns.
    pub dofs: usize,
    /// How it ended.
    pub ending: Ending,
    /// Time of computing a simulated second, ms, without the energy ledger: median over repetitions.
    pub milliseconds: f64,
    /// Its error; `None` of a motion that did not finish.
    pub error: Option<PathError>,
    /// Energy that the integrator has added by the end, percent of the largest kinetic energy.
    pub drift_percent: f64,
    /// Steps and solves.
    pub counts: Counts,
    /// Whether no other measurement is both faster and closer; errors below the reference's own are alike.
    pub pareto: bool,
}

impl MotionMeasurement {
    /// What the integrator does to energy.
    #[must_use]
    pub fn energy(&self) -> EnergyBehaviour {
        EnergyBehaviour::of(self.drift_percent)
    }
}

/// A whole study of a motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionStudy {
    /// The scene's name.
    pub scene: String,
    /// Time that is simulated, s.
    pub duration: f64,
    /// Time that the scene has, s.
    pub scene_duration: f64,
    /// The mesh nearest to the scene's own, by which integrators are compared.
    pub own_mesh: Option<[u32; 2]>,
    /// What errors are measured against.
    pub reference: MotionReference,
    /// By element, mesh, integrator, step, method, solves.
    pub measurements: Vec<MotionMeasurement>,
    /// Whether it was called off before everything was measured.
    pub is_partial: bool,
}

/// How much is looked at.
struct Plan {
    /// The longest time that is simulated, s, and in time steps of the scene.
    longest: (f64, f64),
    /// The longest time step over the scene's.
    coarsest: f64,
    /// Steps in the longest one.
    steps: &'static [u32],
    /// Solves a step.
    solves: &'static [u32],
    /// Nodes along the beam over those of the scene's mesh.
    meshes: &'static [f64],
    /// The same of the reference.
    reference_mesh: f64,
    /// More steps than these are not run to their end.
    most_steps: u32,
    /// Time that is given to timing a setting.
    timing: Duration,
}

const QUICK: Plan = Plan {
    longest: (1.0, 60.0),
    coarsest: 1.0,
    steps: &[1, 2, 4],
    solves: &[1, 0],
    meshes: &[0.5, 1.0],
    reference_mesh: 2.0,
    most_steps: 20_000,
    timing: Duration::from_millis(20),
};

const FULL: Plan = Plan {
    longest: (2.0, 240.0),
    coarsest: 2.0,
    steps: &[1, 2, 4, 8, 16],
    solves: &[1, 2, 0],
    meshes: &[0.25, 0.5, 1.0, 1.5],
    reference_mesh: 3.0,
    most_steps: 100_000,
    timing: Duration::from_millis(200),
};

/// Runs of a setting that are timed, at most.
const RUNS: usize = 5;

/// Steps of the reference in the shortest of the others.
const REFERENCE_STEPS: u32 = 4;

impl Plan {
    /// Steps of the reference between samples.
    fn reference_steps(&self) -> u32 {
        self.steps.iter().copied().max().unwrap_or(1) * REFERENCE_STEPS
    }
}

/// The explicit integrator's step over its critical one.
const BELOW_CRITICAL: f64 = 0.9;
/// Steps after which the time of a motion that is cut short is known.
const ENOUGH_STEPS: u32 = 500;
/// A scene shorter than so many of its steps is studied with shorter ones.
const FEWEST_STEPS: f64 = 8.0;
/// The finest mesh of the settings has no more nodes along and across than this.
const MOST_NODES: f64 = 1000.0;

/// Times at which paths are compared: multiples of the longest time step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Samples {
    /// Time between two, s.
    interval: f64,
    /// How many, without the start.
    count: u32,
}

impl Samples {
    fn of(scene: &Scene, plan: &Plan) -> Self {
        let (seconds, steps) = plan.longest;
        let own = scene.dynamics.time_step;
        let duration = scene.dynamics.duration.min(seconds).min(steps * own);
        let interval = (plan.coarsest * own).min(duration / FEWEST_STEPS);
        Self { interval, count: (duration / interval * (1.0 + 1e-9)).floor().max(1.0) as u32 }
    }

    fn duration(self) -> f64 {
        self.interval * f64::from(self.count)
    }
}

/// Cells of a mesh whose nodes along and across are `factor` times the scene's; `None` where the mesh is a file's.
fn cells(scene: &Scene, element: ElementKind, factor: f64) -> Option<[u32; 2]> {
    let beam = scene.beam.as_ref()?;
    let pieces = |element: ElementKind| element.entry().sides[0].len() as f64 - 1.0;
    let own = beam.cells.map(|n| f64::from(n) * pieces(beam.element));
    // A scene of a very fine mesh is studied on coarser ones.
    let factor = factor * (MOST_NODES / (own[0] * own[1])).sqrt().min(1.0);
    Some(own.map(|n| (n * factor / pieces(element)).round().max(1.0) as u32))
}

/// What is measured on a mesh.
#[derive(Clone, Copy)]
struct Job {
    element: ElementKind,
    cells: Option<[u32; 2]>,
    integrator: &'static IntegratorEntry,
    /// Steps between samples; `None`: what stability asks for.
    steps: Option<u32>,
    method: MethodKind,
    iterations: u32,
    /// About how long it takes, over others.
    weight: f64,
}

/// Everything that is measured, mesh by mesh.
fn jobs(scene: &Scene, extent: Extent) -> Vec<Job> {
    let plan = extent.plan();
    let mut jobs = Vec::new();
    for element in scene.elements() {
        let mut meshes: Vec<_> = plan.meshes.iter().map(|&factor| cells(scene, element, factor)).collect();
        meshes.dedup();
        for cells in meshes {
            let nodes = cells.map_or(1.0, |[along, across]| f64::from(along * across));
            for integrator in INTEGRATORS {
                let explicit = integrator.is_explicit();
                let steps: Vec<_> = if explicit { vec![None] } else { plan.steps.iter().map(|&n| Some(n)).collect() };
                for steps in steps {
                    for method in methods(integrator, extent) {
                        for &iterations in solves(integrator, method, plan) {
                            let weight = nodes * f64::from(steps.unwrap_or(1) * integrator.stages.max(1));
                            jobs.push(Job { element, cells, integrator, steps, method, iterations, weight });
                        }
                    }
                }
            }
        }
    }
    jobs
}

/// The methods that make a difference.
fn methods(integrator: &IntegratorEntry, extent: Extent) -> Vec<MethodKind> {
    let all = METHODS.iter().map(|m| m.kind);
    if integrator.is_explicit() {
        // Without a matrix there are two theories.
        return vec![MethodKind::Linear, MethodKind::Newton];
    }
    all.filter(|&m| extent == Extent::Full || m != MethodKind::Warped).collect()
}

/// The numbers of solves that make a difference.
fn solves(integrator: &IntegratorEntry, method: MethodKind, plan: &Plan) -> &'static [u32] {
    if integrator.is_explicit() || integrator.always_iterates {
        &[0]
    } else if method == MethodKind::Linear {
        // One solve is exact.
        &[1]
    } else {
        plan.solves
    }
}

impl Extent {
    fn plan(self) -> &'static Plan {
        match self {
            Self::Quick => &QUICK,
            Self::Full => &FULL,
        }
    }
}

impl MotionStudy {
    /// Measures a scene in motion. [`Progress::so_far`] is `None` throughout.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self, StudyError> {
        let plan = extent.plan();
        let samples = Samples::of(scene, plan);
        let reference = MotionReference::new(scene, extent, observe)?;
        let mut study = Self {
            scene: scene.name.clone(),
            duration: samples.duration(),
            scene_duration: scene.dynamics.duration,
            own_mesh: cells(scene, finest_element(scene), 1.0),
            reference,
            measurements: Vec::new(),
            is_partial: false,
        };
        let jobs = jobs(scene, extent);
        let all: f64 = jobs.iter().map(|j| j.weight).sum();
        let mut done = 0.0;
        let mut mesh: Option<Meshed> = None;
        for job in jobs {
            let meshed = match mesh.take() {
                Some(meshed) if (meshed.element, meshed.cells) == (job.element, job.cells) => Ok(meshed),
                _ => Meshed::new(scene, job, samples, plan, &mut |now| {
                    observe(Progress { fraction: done / all, now, so_far: None })
                }),
            };
            let meshed = match meshed {
                // What has been measured is worth keeping.
                Err(StudyError::Cancelled) if !study.measurements.is_empty() => {
                    study.is_partial = true;
                    break;
                }
                meshed => meshed?,
            };
            let (setting, steps) = meshed.setting(job, samples);
            if observe(Progress { fraction: done / all, now: &setting.to_string(), so_far: None }).is_break() {
                study.is_partial = true;
                break;
            }
            study.measurements.push(study.measure(scene, setting, &meshed, samples, steps, plan)?);
            done += job.weight;
            mesh = Some(meshed);
        }
        if study.measurements.is_empty() {
            return Err(StudyError::Cancelled);
        }
        let pairs = study.measurements.iter().map(|m| {
            let error = m.error.map_or(f64::INFINITY, |e| study.resolved(e.bound()));
            (m.milliseconds, error)
        });
        let front = pareto::front(&pairs.collect::<Vec<_>>());
        for (m, front) in study.measurements.iter_mut().zip(front) {
            m.pareto = front;
        }
        Ok(study)
    }

    /// One setting, of so many steps between samples.
    fn measure(
        &self,
        scene: &Scene,
        setting: MotionSetting,
        mesh: &Meshed,
        samples: Samples,
        steps: u32,
        plan: &Plan,
    ) -> Result<MotionMeasurement, StudyError> {
        let mut simulation = Simulation::with_system(&setting.apply(scene), mesh.system.clone())?;
        let cut = u64::from(steps) * u64::from(samples.count) > u64::from(plan.most_steps);
        let steps_of_run = if cut { ENOUGH_STEPS } else { steps * samples.count };
        // The first run is for the books and the path; its time is nobody's.
        let path = if cut {
            run(&mut simulation, ENOUGH_STEPS);
            Vec::new()
        } else {
            path(&mut simulation, samples, steps, &mut || ControlFlow::Continue(()))?
        };
        let stopped = matches!(simulation.status(), Status::Stopped(_));
        let ending = match (stopped, cut) {
            (true, _) => Ending::Stopped,
            (false, true) => Ending::CutShort,
            (false, false) => Ending::Finished,
        };
        let (counts, drift) = simulation.motion().map(|m| (m.counts(), m.ledger().drift())).unwrap_or_default();
        simulation.keep_ledger(false);
        let mut simulated = 0.0;
        let runs = Runs { count: 1..=RUNS, enough: plan.timing };
        let time = median_time(runs, &mut simulation, Simulation::reset, |simulation| {
            run(simulation, steps_of_run);
            simulated = simulation.state().time();
        });
        // A motion that stops at once is as slow as the step it could not take.
        let seconds = if simulated > 0.0 { simulated } else { setting.time_step };
        Ok(MotionMeasurement {
            setting,
            dofs: mesh.system.dofs(),
            ending,
            milliseconds: time.as_secs_f64().max(Duration::from_nanos(1).as_secs_f64()) * 1e3 / seconds,
            error: (ending == Ending::Finished).then(|| self.error(&path, setting.method, mesh)),
            drift_percent: 100.0 * drift,
            counts,
            pareto: false,
        })
    }

    fn error(&self, path: &[Vector2<f64>], method: MethodKind, mesh: &Meshed) -> PathError {
        let reference = &self.reference;
        let own = if method == MethodKind::Linear { &mesh.linear } else { &mesh.exact };
        let [total, rms] = reference.distance(path, &reference.path);
        PathError {
            total,
            rms,
            discretization: reference.distance(&mesh.exact, &reference.path)[0],
            integration: reference.distance(path, own)[0],
            model: reference.distance(own, &mesh.exact)[0],
        }
    }

    /// An error as far as the reference can tell, percent.
    #[must_use]
    pub fn resolved(&self, percent: f64) -> f64 {
        percent.max(self.reference.error_percent)
    }

    /// The measurements no other beats, fastest first.
    #[must_use]
    pub fn front(&self) -> Vec<&MotionMeasurement> {
        let mut front: Vec<_> = self.measurements.iter().filter(|m| m.pareto).collect();
        front.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
        front
    }

    /// The fastest measurement whose error is at most so many percent; the reference's own error is added to it.
    #[must_use]
    pub fn fastest_within(&self, percent: f64) -> Option<&MotionMeasurement> {
        self.fastest_of(percent, |_| true)
    }

    fn fastest_of(&self, percent: f64, which: impl Fn(&MotionMeasurement) -> bool) -> Option<&MotionMeasurement> {
        let surely = |m: &&MotionMeasurement| {
            m.error.is_some_and(|e| e.bound() + self.reference.error_percent <= percent) && which(m)
        };
        self.measurements.iter().filter(surely).min_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds))
    }
}

/// A mesh with what is found once for it.
struct Meshed {
    element: ElementKind,
    cells: Option<[u32; 2]>,
    system: Arc<System>,
    /// The first probe's path on this mesh with the reference's steps …
    exact: Vec<Vector2<f64>>,
    /// … and under linear theory.
    linear: Vec<Vector2<f64>>,
    /// The explicit integrator's critical step, s.
    critical: Option<f64>,
}

impl Meshed {
    fn new(
        scene: &Scene,
        job: Job,
        samples: Samples,
        plan: &Plan,
        say: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Self, StudyError> {
        let Job { element, cells, integrator, method, iterations, .. } = job;
        let time_step = scene.dynamics.time_step;
        let setting = MotionSetting { element, cells, integrator: integrator.kind, method, time_step, iterations };
        let scene = setting.apply(scene);
        let system = system_of(&scene)?;
        let simulation = Simulation::with_system(&scene, system.clone())?;
        let mass = Mass::new(&system, scene.material.area_density());
        let critical = critical_step(simulation.problem(), &mass, scene.dynamics.damping);
        let words = mesh_words(element, cells);
        let mut own = |method| fine_path(&scene, method, &system, samples, plan.reference_steps(), &mut || say(&words));
        let (exact, linear) = (own(MethodKind::Newton)?, own(MethodKind::Linear)?);
        Ok(Self { element, cells, system, exact, linear, critical })
    }

    /// A job as a setting, and its steps between samples.
    fn setting(&self, job: Job, samples: Samples) -> (MotionSetting, u32) {
        let Job { element, cells, integrator, method, iterations, .. } = job;
        let stable = || {
            let longest = self.critical.map_or(samples.interval, |critical| BELOW_CRITICAL * critical);
            (samples.interval / longest).ceil().max(1.0) as u32
        };
        let steps = job.steps.unwrap_or_else(stable);
        let time_step = samples.interval / f64::from(steps);
        (MotionSetting { element, cells, integrator: integrator.kind, method, time_step, iterations }, steps)
    }
}

/// Takes so many steps, or as many as there are.
fn run(simulation: &mut Simulation, steps: u32) {
    for _ in 0..steps {
        if matches!(simulation.step(), Status::Stopped(_)) {
            break;
        }
    }
}

/// Displacements of the first probe at the samples, m, from the start of a motion, as far as it goes.
fn path(
    simulation: &mut Simulation,
    samples: Samples,
    steps: u32,
    observe: &mut dyn FnMut() -> ControlFlow<()>,
) -> Result<Vec<Vector2<f64>>, StudyError> {
    let mut path = Vec::with_capacity(samples.count as usize);
    for _ in 0..samples.count {
        check(observe())?;
        run(simulation, steps);
        if matches!(simulation.status(), Status::Stopped(_)) {
            break;
        }
        path.push(first_probe(simulation)?);
    }
    Ok(path)
}
