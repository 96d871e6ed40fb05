//! The trade in time: error of the first probe's path against the time of computing it, for every integrator, time step,
//! number of solves, method, element and mesh, on this machine.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

use nalgebra::Vector2;

use self::plan::{Job, MeshPlan, Plan, Samples, cells};
pub use self::reference::MotionReference;
use self::reference::fine_path;
use super::fine::finest_element;
use super::parallel::{self, CalledOff};
use super::pareto;
use super::progress::{Extent, Observer, Progress, StudyError, all_done, check};
use super::reference::{first_probe, system_of};
use super::timing::{Runs, median_time};
use super::trade::{Setting, mesh_words};
use crate::assembly::{Mass, System};
use crate::dynamics::{Counts, critical_step};
use crate::scene::{ElementKind, IntegratorKind, MethodKind, Scene};
use crate::simulation::{Simulation, Status};
use crate::words::count;

mod plan;
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
    /// The setting of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let dynamics = &scene.dynamics;
        Self {
            element: scene.element(),
            cells: scene.beam.as_ref().map(|beam| beam.cells),
            integrator: dynamics.integrator,
            method: scene.solver.method,
            time_step: dynamics.time_step,
            iterations: dynamics.iterations,
        }
    }

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
            method if method.moves_linearly() => "linear theory",
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

/// Runs of a setting that are timed, at most.
const RUNS: usize = 5;
/// Steps after which the time of a motion that is cut short is known.
const ENOUGH_STEPS: u32 = 500;

/// About the parts of a study's time that go by before its meshes are measured: for the reference solution …
const REFERENCE_SHARE: f64 = 0.1;
/// … and for every mesh's own motion.
const OWN_SHARE: f64 = 0.1;
/// About the part of a mesh's time that goes by before its settings are timed.
const FIRST_RUNS_SHARE: f64 = 0.35;

impl MotionStudy {
    /// Measures a scene in motion.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(scene: &Scene, extent: Extent, observe: Observer<'_>) -> Result<Self, StudyError> {
        let plan = extent.plan();
        let samples = Samples::of(scene, plan);
        let studied = Studied { scene, samples, plan };
        let reference = MotionReference::new(scene, extent, &mut |progress| {
            observe(Progress { fraction: REFERENCE_SHARE * progress.fraction, ..progress })
        })?;
        let meshes = MeshPlan::all(scene, extent);
        let own = |mesh: &MeshPlan, called_off: &CalledOff| Meshed::new(studied, mesh, called_off);
        let meshed = all_done(parallel::map(&meshes, own, |done| {
            let fraction = REFERENCE_SHARE + OWN_SHARE * done as f64 / meshes.len() as f64;
            observe(Progress { fraction, now: "the meshes' own motions" })
        }))?;
        let mut study = Self {
            scene: scene.name.clone(),
            duration: samples.duration(),
            scene_duration: scene.dynamics.duration,
            own_mesh: cells(scene, finest_element(scene), 1.0),
            reference,
            measurements: Vec::new(),
            is_partial: false,
        };
        let all: f64 = meshes.iter().map(MeshPlan::weight).sum();
        let before = REFERENCE_SHARE + OWN_SHARE;
        let mut done = 0.0;
        for (mesh, meshed) in meshes.iter().zip(&meshed) {
            let fraction = |part: f64| before + (1.0 - before) * (done + part * mesh.weight()) / all;
            let measured = study
                .measure(studied, mesh, meshed, &mut |part, now| observe(Progress { fraction: fraction(part), now }));
            match measured {
                // What has been measured is worth keeping.
                Err(StudyError::Cancelled) if !study.measurements.is_empty() => {
                    study.is_partial = true;
                    break;
                }
                measured => measured?,
            }
            done += mesh.weight();
        }
        study.mark_pareto();
        Ok(study)
    }

    /// Adds every setting of a mesh. `say` is told which part of it is done and what is measured, and calls it off.
    fn measure(
        &mut self,
        studied: Studied<'_>,
        mesh: &MeshPlan,
        meshed: &Meshed,
        say: &mut dyn FnMut(f64, &str) -> ControlFlow<()>,
    ) -> Result<(), StudyError> {
        // What is not timed first, on all cores: the timed part is then alone on the machine.
        let first = |job: &Job, called_off: &CalledOff| {
            let (setting, steps) = job.setting(mesh, meshed.critical, studied.samples);
            FirstRun::new(studied, meshed, setting, steps, called_off)
        };
        let now = format!("{}, its settings' paths", mesh_words(mesh.element, mesh.cells));
        let first = all_done(parallel::map(&mesh.jobs, first, |done| {
            say(FIRST_RUNS_SHARE * done as f64 / mesh.jobs.len() as f64, &now)
        }))?;
        let mut done = 0.0;
        for (job, first) in mesh.jobs.iter().zip(first) {
            let part = FIRST_RUNS_SHARE + (1.0 - FIRST_RUNS_SHARE) * done / mesh.weight();
            check(say(part, &first.setting.to_string()))?;
            self.measurements.push(MotionMeasurement {
                setting: first.setting,
                dofs: meshed.system.dofs(),
                ending: first.ending,
                milliseconds: first.milliseconds(studied, meshed)?,
                error: (first.ending == Ending::Finished).then(|| self.error(&first, meshed)),
                drift_percent: 100.0 * first.drift,
                counts: first.counts,
                pareto: false,
            });
            done += job.weight;
        }
        Ok(())
    }

    fn mark_pareto(&mut self) {
        let pairs = self.measurements.iter().map(|m| {
            let error = m.error.map_or(f64::INFINITY, |e| self.resolved(e.bound()));
            (m.milliseconds, error)
        });
        let front = pareto::front(&pairs.collect::<Vec<_>>());
        for (m, front) in self.measurements.iter_mut().zip(front) {
            m.pareto = front;
        }
    }

    fn error(&self, run: &FirstRun, mesh: &Meshed) -> PathError {
        let (reference, path) = (&self.reference, &run.path);
        let own = if run.setting.method.moves_linearly() { &mesh.linear } else { &mesh.exact };
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

    /// `true` if the error of a measurement is sure to be at most so many percent; the reference's own error is added to it.
    #[must_use]
    pub fn is_within(&self, measurement: &MotionMeasurement, percent: f64) -> bool {
        measurement.error.is_some_and(|e| e.bound() + self.reference.error_percent <= percent)
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
        let surely = |m: &&MotionMeasurement| self.is_within(m, percent) && which(m);
        self.measurements.iter().filter(surely).min_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds))
    }
}

/// A scene and how it is studied.
#[derive(Clone, Copy)]
struct Studied<'a> {
    scene: &'a Scene,
    samples: Samples,
    plan: &'a Plan,
}

/// A mesh with what is found once for it.
struct Meshed {
    system: Arc<System>,
    /// The first probe's path on this mesh with the reference's steps …
    exact: Vec<Vector2<f64>>,
    /// … and under linear theory.
    linear: Vec<Vector2<f64>>,
    /// The explicit integrator's critical step, s.
    critical: Option<f64>,
}

impl Meshed {
    fn new(studied: Studied<'_>, mesh: &MeshPlan, called_off: &CalledOff) -> Result<Self, StudyError> {
        let Studied { scene, samples, plan } = studied;
        let MeshPlan { element, cells, .. } = *mesh;
        let scene = Setting { element, cells, method: MethodKind::Newton, iterations: 0 }.apply(scene);
        let system = system_of(&scene)?;
        let simulation = Simulation::with_system(&scene, system.clone())?;
        let mass = Mass::new(&system, scene.material.area_density());
        let critical = critical_step(simulation.problem(), &mass, scene.dynamics.damping);
        let own = |method| fine_path(&scene, method, &system, samples, plan.reference_steps(), called_off);
        let (exact, linear) = (own(MethodKind::Newton)?, own(MethodKind::Linear)?);
        Ok(Self { system, exact, linear, critical })
    }
}

/// The first run of a setting, for the books and the path; its time is nobody's. What is kept of it is little beside the
/// simulation.
struct FirstRun {
    setting: MotionSetting,
    /// Steps between samples.
    steps_of_sample: u32,
    /// All its steps.
    steps: u32,
    ending: Ending,
    /// Of the first probe at the samples; empty where it is cut short.
    path: Vec<Vector2<f64>>,
    counts: Counts,
    /// Energy that the integrator has added, over the largest kinetic energy.
    drift: f64,
}

impl FirstRun {
    fn new(
        studied: Studied<'_>,
        mesh: &Meshed,
        setting: MotionSetting,
        steps_of_sample: u32,
        called_off: &CalledOff,
    ) -> Result<Self, StudyError> {
        let Studied { scene, samples, plan } = studied;
        let mut simulation = Simulation::with_system(&setting.apply(scene), mesh.system.clone())?;
        let cut = u64::from(steps_of_sample) * u64::from(samples.count) > u64::from(plan.most_steps);
        let (steps, path) = if cut {
            run(&mut simulation, ENOUGH_STEPS);
            (ENOUGH_STEPS, Vec::new())
        } else {
            (steps_of_sample * samples.count, path(&mut simulation, samples, steps_of_sample, called_off)?)
        };
        let stopped = matches!(simulation.status(), Status::Stopped(_));
        let ending = match (stopped, cut) {
            (true, _) => Ending::Stopped,
            (false, true) => Ending::CutShort,
            (false, false) => Ending::Finished,
        };
        let (counts, drift) = simulation.motion().map(|m| (m.counts(), m.ledger().drift())).unwrap_or_default();
        Ok(Self { setting, steps_of_sample, steps, ending, path, counts, drift })
    }

    /// Time of computing a simulated second, ms, timed by runs like this.
    fn milliseconds(&self, studied: Studied<'_>, mesh: &Meshed) -> Result<f64, StudyError> {
        let mut simulation = Simulation::with_system(&self.setting.apply(studied.scene), mesh.system.clone())?;
        simulation.keep_ledger(false);
        // It warms up caches and clocks, and makes what is made once for a simulation.
        run(&mut simulation, self.steps.min(self.steps_of_sample));
        let mut simulated = 0.0;
        let runs = Runs { count: 1..=RUNS, enough: studied.plan.timing };
        let time = median_time(runs, &mut simulation, Simulation::reset, |simulation| {
            run(simulation, self.steps);
            simulated = simulation.state().time();
        });
        // A motion that stops at once is as slow as the step it could not take.
        let seconds = if simulated > 0.0 { simulated } else { self.setting.time_step };
        Ok(time.as_secs_f64().max(Duration::from_nanos(1).as_secs_f64()) * 1e3 / seconds)
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
    called_off: &CalledOff,
) -> Result<Vec<Vector2<f64>>, StudyError> {
    let mut path = Vec::with_capacity(samples.count as usize);
    for _ in 0..samples.count {
        check(called_off.flow())?;
        run(simulation, steps);
        if matches!(simulation.status(), Status::Stopped(_)) {
            break;
        }
        path.push(first_probe(simulation)?);
    }
    Ok(path)
}
