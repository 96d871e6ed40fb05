//! rapier2d's soft bodies on the same mesh under the same load, as a game would use them: steps of 1/60 s, damped until
//! they rest.
//!
//! Its corotational cells have our energy on three-node triangles (its plane strain made plane stress where the scene
//! says so), so its equilibrium is that of `t3`, in f32. A static answer has to swing in: the mass that the scene leaves
//! open and the damping are looked for, and its fastest combination counts.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::Parser;
use nalgebra::Vector2;
use rapier::{Rapier, RapierSolver, Swing};
use warpbeam::assembly::{Problem, System};
use warpbeam::export::{ExportError, write_text};
use warpbeam::scene::{Source, open};
use warpbeam::study::{Reference, StudyError, times_from_rest};
use warpbeam::timings::Timings;
use warpbeam::{ElementKind, MethodKind, Scene, SceneError, Simulation, SimulationError, Status};

mod rapier;

/// How long rapier2d's soft bodies take for a scene's equilibrium, beside our own method: a table (rivals.csv) and a
/// summary. Takes minutes.
#[derive(Debug, Parser)]
#[command(name = "rivals")]
struct Args {
    /// A built-in scene or a scene file.
    scene: PathBuf,
    /// Change a value of the scene.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    assignments: Vec<String>,
    /// The folder to write to; made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Without the finer meshes.
    #[arg(long)]
    quick: bool,
}

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
enum Error {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error("our own method does not converge on this mesh")]
    NotConverged,
    #[error("rapier2d fixes nodes in both directions and has no follower moments: not measured")]
    NotItsScene,
    #[error("{0}: {1}")]
    Folder(String, std::io::Error),
    #[error(transparent)]
    Export(#[from] ExportError),
}

fn main() -> ExitCode {
    match run(Args::parse()) {
        Ok(summary) => {
            print!("{summary}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("rivals: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(args: Args) -> Result<String, Error> {
    let scene = open(&Source { name: args.scene, assignments: args.assignments })?;
    let rivals = rivals(&scene, args.quick)?;
    std::fs::create_dir_all(&args.out).map_err(|error| Error::Folder(args.out.display().to_string(), error))?;
    write_text(&args.out.join("rivals.csv"), &table(&rivals))?;
    Ok(summary(&rivals))
}

/// A moment of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moment {
    /// Steps so far.
    steps: u32,
    /// Their time.
    time: Duration,
}

/// One of its solvers on one mesh.
#[derive(Clone, Debug, PartialEq)]
struct Rival {
    /// The fastest way found.
    swing: Swing,
    /// Cells along and across; `None` for the mesh of a file.
    cells: Option<[u32; 2]>,
    /// Free unknowns.
    dofs: usize,
    /// Median time of a step.
    step: Duration,
    /// When it comes to stay within 1 % of where this mesh rests.
    own: Option<Moment>,
    /// When it comes to stay within 1 % of the truth.
    truth: Option<Moment>,
    /// Distance from the truth at the end, percent.
    error_percent: f64,
    /// Of the mesh itself: its exact equilibrium from the truth, percent.
    mesh_error_percent: f64,
    /// What `newton` takes for that equilibrium, from rest, on the same mesh.
    ours: Duration,
}

/// A displacement counts as reached if its distance from the target is no more than this fraction of the target.
const WITHIN: f64 = 0.01;
/// What is tried for its fastest answer: paces …
const PACES: [f64; 6] = [0.01, 0.02, 0.05, 0.005, 0.1, 0.0025];
/// … dampings …
const DAMPINGS: [f64; 2] = [0.5, 1.0];
/// … and for `fem` the iterations: its default, and what its manual says that stiff bodies need.
const CG_ITERATIONS: [usize; 2] = [20, 500];
/// Time after which a combination is given up.
const MOST_TIME: Duration = Duration::from_secs(15);
/// Steps after which it is.
const MOST_STEPS: u32 = 6000;
/// It rests where it has stayed within [`WITHIN`] for so many steps.
const RESTS: u32 = 200;

/// Cells along the beam.
const MESHES: [u32; 4] = [20, 40, 80, 160];

/// The scene on three-node meshes, coarse to fine; on its own where that is from a file.
fn meshes(scene: &Scene, quick: bool) -> Vec<Scene> {
    let mut scene = scene.clone();
    scene.set_element(ElementKind::T3);
    scene.solver.method = MethodKind::Newton;
    let Some(beam) = scene.beam.clone() else { return vec![scene] };
    let across = |along: u32| (f64::from(along) * beam.height / beam.length).round().max(1.0) as u32;
    let along = &MESHES[..if quick { 2 } else { MESHES.len() }];
    along.iter().map(|&along| scene.clone().with_cells(along, across(along))).collect()
}

/// Measures both solvers on the scene's three-node meshes.
fn rivals(scene: &Scene, quick: bool) -> Result<Vec<Rival>, Error> {
    let reference = Reference::of(scene)?;
    let reference = reference.first().ok_or(StudyError::NoBound)?;
    let truth = reference.displacement;
    let mut rivals = Vec::new();
    for scene in meshes(scene, quick) {
        let system = Arc::new(System::new(&scene).map_err(SimulationError::from)?);
        let problem = Problem::new(&scene, system.clone()).map_err(SimulationError::from)?;
        let mut newton = Simulation::with_system(&scene, system.clone())?;
        if *newton.solve() != Status::Converged {
            return Err(Error::NotConverged);
        }
        let own = problem.probes().first().ok_or(StudyError::NoProbe)?.mean(newton.displacement());
        let ours = times_from_rest(&mut newton, u32::MAX).last().map(Timings::total).unwrap_or_default();
        for solver in RapierSolver::ALL {
            let mut best: Option<Rival> = None;
            for swing in swings(solver) {
                // What takes longer than the best so far is not the best.
                let limit = best.as_ref().and_then(|b| b.own).map_or(MOST_TIME, |own| own.time);
                let body = Rapier::new(&problem, own, swing).ok_or(Error::NotItsScene)?;
                let run = swing_in(body, [own, truth], limit);
                let rival = Rival {
                    swing,
                    cells: scene.beam.as_ref().map(|b| b.cells),
                    dofs: system.dofs(),
                    step: run.step,
                    own: run.own,
                    truth: run.truth,
                    error_percent: reference.percent(run.end, truth),
                    mesh_error_percent: reference.percent(own, truth),
                    ours,
                };
                let better = best.as_ref().is_none_or(|best| match (rival.own, best.own) {
                    (Some(a), Some(b)) => a.time < b.time,
                    (None, None) => rival.error_percent < best.error_percent,
                    (a, _) => a.is_some(),
                });
                if better {
                    best = Some(rival);
                }
            }
            rivals.extend(best);
        }
    }
    Ok(rivals)
}

/// Every way to try.
fn swings(solver: RapierSolver) -> Vec<Swing> {
    let iterations = if solver == RapierSolver::Fem { &CG_ITERATIONS[..] } else { &CG_ITERATIONS[..1] };
    let mut swings = Vec::new();
    for pace in PACES {
        for damping in DAMPINGS {
            swings.extend(iterations.iter().map(|&cg_iterations| Swing { solver, pace, damping, cg_iterations }));
        }
    }
    swings
}

/// What a run came to.
struct Run {
    step: Duration,
    own: Option<Moment>,
    truth: Option<Moment>,
    end: Vector2<f64>,
}

/// When something came near for good.
#[derive(Default)]
struct Arrival {
    since: Option<Moment>,
}

impl Arrival {
    fn see(&mut self, now: Moment, distance: f64) {
        if distance <= WITHIN {
            self.since.get_or_insert(now);
        } else {
            self.since = None;
        }
    }

    /// When, if it has been there long enough.
    fn rests(&self, steps: u32) -> Option<Moment> {
        self.since.filter(|since| steps - since.steps >= RESTS)
    }
}

/// Steps until it rests at `own` and, if the mesh allows, at the truth, or until it has taken `limit`.
fn swing_in(mut body: Rapier<'_>, [own, truth]: [Vector2<f64>; 2], limit: Duration) -> Run {
    let (mut to_own, mut to_truth) = (Arrival::default(), Arrival::default());
    let reachable = (own - truth).norm() <= WITHIN * truth.norm();
    let mut times = Vec::new();
    let mut now = Moment::default();
    while now.steps < MOST_STEPS {
        let begun = Instant::now();
        body.step();
        let time = begun.elapsed();
        times.push(time);
        now = Moment { steps: now.steps + 1, time: now.time + time };
        let u = body.displacement();
        to_own.see(now, (u - own).norm() / own.norm());
        to_truth.see(now, (u - truth).norm() / truth.norm());
        let done = to_own.rests(now.steps).is_some() && (!reachable || to_truth.rests(now.steps).is_some());
        let late = now.time > limit && to_own.since.is_none_or(|since| since.time > limit);
        if done || late || now.time > MOST_TIME {
            break;
        }
    }
    times.sort_unstable();
    Run {
        step: times.get(times.len() / 2).copied().unwrap_or_default(),
        own: to_own.rests(now.steps),
        truth: to_truth.rests(now.steps),
        end: body.displacement(),
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// The table as CSV.
fn table(rivals: &[Rival]) -> String {
    let mut text = String::from(
        "solver,cells_along,cells_across,dofs,step_ms,steps_to_own,ms_to_own,steps_to_truth,ms_to_truth,error_percent,mesh_error_percent,newton_ms,pace,damping,cg_iterations\n",
    );
    for r in rivals {
        let [along, across] = r.cells.unwrap_or([0, 0]);
        let until = |at: Option<Moment>| {
            at.map_or_else(|| ",".to_owned(), |at| format!("{},{:.4}", at.steps, milliseconds(at.time)))
        };
        let _ = writeln!(
            text,
            "{},{along},{across},{},{:.5},{},{},{:e},{:e},{:.5},{},{},{}",
            r.swing.solver.id(),
            r.dofs,
            milliseconds(r.step),
            until(r.own),
            until(r.truth),
            r.error_percent,
            r.mesh_error_percent,
            milliseconds(r.ours),
            r.swing.pace,
            r.swing.damping,
            r.swing.cg_iterations
        );
    }
    text
}

/// The table for people.
fn summary(rivals: &[Rival]) -> String {
    let mut text = String::from(
        "rapier2d on the same three-node meshes (f32, steps of 1/60 s, the fastest of several masses and dampings), ms:\n\
         mesh      solver         one step   until its mesh's rest within 1 %   until the truth within 1 %   newton t3\n",
    );
    for r in rivals {
        let mesh = r.cells.map_or_else(|| "as meshed".to_owned(), |[along, across]| format!("{along}×{across}"));
        let until = |at: Option<Moment>| {
            let words = |at: Moment| format!("{:.1} ({} steps)", milliseconds(at.time), at.steps);
            at.map_or_else(|| "never".to_owned(), words)
        };
        let _ = writeln!(
            text,
            "{mesh:<9} {:<11} {:>11.4}   {:>32}   {:>26}   {:>9.3}",
            r.swing.solver.id(),
            milliseconds(r.step),
            until(r.own),
            until(r.truth),
            milliseconds(r.ours)
        );
    }
    text
}
