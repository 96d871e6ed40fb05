//! Comparison with rapier2d's soft bodies on the same mesh under the same load, as in a game: steps of 1/60 s, damped
//! until they are at rest.
//!
//! Its corotational cells have our energy on three-node triangles (its plane strain is converted to plane stress if the
//! scene requires it), so its equilibrium is that of `t3`, in f32. The static solution is the end of a damped
//! oscillation: the mass, which the scene does not determine, and the damping are varied, and the fastest combination
//! counts.

use std::fmt::Write as _;
use std::ops::ControlFlow;
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
use warpbeam::{ElementKind, MethodKind, Scene, SceneError, Simulation, SimulationError, Status, Timings};

mod rapier;

/// Measure the time rapier2d's soft bodies need for a scene's equilibrium, compared with our own method: a table
/// (rivals.csv) and a summary. Takes minutes.
#[derive(Debug, Parser)]
#[command(name = "rivals")]
struct Args {
    /// Built-in scene or scene file.
    scene: PathBuf,
    /// Change a value of the scene.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    assignments: Vec<String>,
    /// Folder to write to; created if necessary.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Omit the finer meshes.
    #[arg(long)]
    quick: bool,
}

/// Reason why nothing was measured.
#[derive(Debug, thiserror::Error)]
enum RivalsError {
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

fn run(args: Args) -> Result<String, RivalsError> {
    let scene = open(&Source { name: args.scene, assignments: args.assignments })?;
    let rivals = rivals(&scene, args.quick)?;
    std::fs::create_dir_all(&args.out).map_err(|error| RivalsError::Folder(args.out.display().to_string(), error))?;
    write_text(&args.out.join("rivals.csv"), &table(&rivals))?;
    Ok(summary(&rivals))
}

/// Point in time of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct RivalTime {
    /// Number of steps so far.
    steps: u32,
    /// Computing time so far.
    time: Duration,
}

/// Result of one of rapier2d's solvers on one mesh.
#[derive(Clone, Debug, PartialEq)]
struct Rival {
    /// Fastest combination of parameters.
    swing: Swing,
    /// Cells along and across; `None` for a mesh file.
    cells: Option<[u32; 2]>,
    /// Number of free unknowns.
    dofs: usize,
    /// Median computing time of a step.
    step: Duration,
    /// Start of the time in which it stays within 1 % of the equilibrium on this mesh.
    own: Option<RivalTime>,
    /// Start of the time in which it stays within 1 % of the reference.
    reference: Option<RivalTime>,
    /// Distance from the reference at the end of the run, percent of the reference displacement.
    error_percent: f64,
    /// Error of the mesh: distance of its exact equilibrium from the reference, percent.
    mesh_error_percent: f64,
    /// Computing time of `newton` for this equilibrium, from rest, on the same mesh.
    ours: Duration,
}

/// Largest distance from the target, as a fraction of the target, that counts as reached.
const WITHIN: f64 = 0.01;
/// Values of [`Swing::frequency_factor`] that are tried.
const FREQUENCY_FACTORS: [f64; 6] = [0.01, 0.02, 0.05, 0.005, 0.1, 0.0025];
/// Values of [`Swing::damping`] that are tried.
const DAMPINGS: [f64; 2] = [0.5, 1.0];
/// Iteration numbers of `fem` that are tried: the default, and the manual's value for stiff bodies.
const CG_ITERATIONS: [usize; 2] = [20, 500];
/// Computing time after which a combination is given up.
const MAX_TIME: Duration = Duration::from_secs(15);
/// Number of steps after which a combination is given up.
const MAX_STEPS: u32 = 6000;
/// Number of steps within [`WITHIN`] after which it counts as being at rest.
const RESTS: u32 = 200;

/// Numbers of cells along the beam.
const MESHES: [u32; 4] = [20, 40, 80, 160];

/// Returns the scene on three-node meshes, coarse to fine; for a mesh file, on this mesh only.
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
fn rivals(scene: &Scene, quick: bool) -> Result<Vec<Rival>, RivalsError> {
    let reference = Reference::of(scene)?;
    let reference = reference.first().ok_or(StudyError::NoBound)?;
    let exact = reference.displacement;
    let mut rivals = Vec::new();
    for scene in meshes(scene, quick) {
        let system = Arc::new(System::new(&scene).map_err(SimulationError::from)?);
        let problem = Problem::new(&scene, system.clone()).map_err(SimulationError::from)?;
        let mut newton = Simulation::with_system(&scene, system.clone())?;
        if *newton.solve() != Status::Converged {
            return Err(RivalsError::NotConverged);
        }
        let own = problem.probes().first().ok_or(StudyError::NoProbe)?.mean(newton.displacement());
        let ours = times_from_rest(&mut newton, u32::MAX, &|_| ControlFlow::Continue(()))
            .unwrap_or_default()
            .last()
            .map(Timings::total)
            .unwrap_or_default();
        for solver in RapierSolver::ALL {
            let mut best: Option<Rival> = None;
            for swing in swings(solver) {
                // A combination slower than the best one is not needed.
                let limit = best.as_ref().and_then(|b| b.own).map_or(MAX_TIME, |own| own.time);
                let body = Rapier::new(&problem, own, swing).ok_or(RivalsError::NotItsScene)?;
                let run = swing_in(body, [own, exact], limit);
                let rival = Rival {
                    swing,
                    cells: scene.beam.as_ref().map(|b| b.cells),
                    dofs: system.dofs(),
                    step: run.step,
                    own: run.own,
                    reference: run.reference,
                    error_percent: reference.percent(run.end, exact),
                    mesh_error_percent: reference.percent(own, exact),
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

/// Returns all combinations of parameters.
fn swings(solver: RapierSolver) -> Vec<Swing> {
    let iterations = if solver == RapierSolver::Fem { &CG_ITERATIONS[..] } else { &CG_ITERATIONS[..1] };
    let mut swings = Vec::new();
    for frequency_factor in FREQUENCY_FACTORS {
        for damping in DAMPINGS {
            swings.extend(iterations.iter().map(|&cg_iterations| Swing {
                solver,
                frequency_factor,
                damping,
                cg_iterations,
            }));
        }
    }
    swings
}

/// Result of a run.
struct Run {
    step: Duration,
    own: Option<RivalTime>,
    reference: Option<RivalTime>,
    end: Vector2<f64>,
}

/// Detector of a lasting arrival at a target.
#[derive(Default)]
struct Arrival {
    since: Option<RivalTime>,
}

impl Arrival {
    fn record(&mut self, now: RivalTime, distance: f64) {
        if distance <= WITHIN {
            self.since.get_or_insert(now);
        } else {
            self.since = None;
        }
    }

    /// Returns the time of arrival, if the target was kept long enough.
    fn rests(&self, steps: u32) -> Option<RivalTime> {
        self.since.filter(|since| steps - since.steps >= RESTS)
    }
}

/// Steps until the body is at rest at `own` and, if the mesh is accurate enough, at the reference, or until `limit` is
/// exceeded.
fn swing_in(mut body: Rapier<'_>, [own, reference]: [Vector2<f64>; 2], limit: Duration) -> Run {
    let (mut to_own, mut to_reference) = (Arrival::default(), Arrival::default());
    let reachable = (own - reference).norm() <= WITHIN * reference.norm();
    let mut times = Vec::new();
    let mut now = RivalTime::default();
    while now.steps < MAX_STEPS {
        let begun = Instant::now();
        body.step();
        let time = begun.elapsed();
        times.push(time);
        now = RivalTime { steps: now.steps + 1, time: now.time + time };
        let u = body.displacement();
        to_own.record(now, (u - own).norm() / own.norm());
        to_reference.record(now, (u - reference).norm() / reference.norm());
        let done = to_own.rests(now.steps).is_some() && (!reachable || to_reference.rests(now.steps).is_some());
        let late = now.time > limit && to_own.since.is_none_or(|since| since.time > limit);
        if done || late || now.time > MAX_TIME {
            break;
        }
    }
    times.sort_unstable();
    Run {
        step: times.get(times.len() / 2).copied().unwrap_or_default(),
        own: to_own.rests(now.steps),
        reference: to_reference.rests(now.steps),
        end: body.displacement(),
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Formats the table as CSV.
fn table(rivals: &[Rival]) -> String {
    let mut text = String::from(
        "solver,cells_along,cells_across,dofs,step_ms,steps_to_own,ms_to_own,steps_to_truth,ms_to_truth,error_percent,mesh_error_percent,newton_ms,pace,damping,cg_iterations\n",
    );
    for r in rivals {
        let [along, across] = r.cells.unwrap_or([0, 0]);
        let until = |at: Option<RivalTime>| {
            at.map_or_else(|| ",".to_owned(), |at| format!("{},{:.4}", at.steps, milliseconds(at.time)))
        };
        let _ = writeln!(
            text,
            "{},{along},{across},{},{:.5},{},{},{:e},{:e},{:.5},{},{},{}",
            r.swing.solver.id(),
            r.dofs,
            milliseconds(r.step),
            until(r.own),
            until(r.reference),
            r.error_percent,
            r.mesh_error_percent,
            milliseconds(r.ours),
            r.swing.frequency_factor,
            r.swing.damping,
            r.swing.cg_iterations
        );
    }
    text
}

/// Formats the table for display.
fn summary(rivals: &[Rival]) -> String {
    let mut text = String::from(
        "rapier2d on the same three-node meshes (f32, steps of 1/60 s, the fastest of several masses and dampings), ms:\n\
         mesh      solver         one step   until its mesh's rest within 1 %   until 1 % of the reference   newton t3\n",
    );
    for r in rivals {
        let mesh = r.cells.map_or_else(|| "as meshed".to_owned(), |[along, across]| format!("{along}×{across}"));
        let until = |at: Option<RivalTime>| {
            let text = |at: RivalTime| format!("{:.1} ({} steps)", milliseconds(at.time), at.steps);
            at.map_or_else(|| "never".to_owned(), text)
        };
        let _ = writeln!(
            text,
            "{mesh:<9} {:<11} {:>11.4}   {:>32}   {:>26}   {:>9.3}",
            r.swing.solver.id(),
            milliseconds(r.step),
            until(r.own),
            until(r.reference),
            milliseconds(r.ours)
        );
    }
    text
}
