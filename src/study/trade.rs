//! The trade: error against time, for every element, mesh, method and number of iterations, on this machine.
//!
//! Static scenes are measured. Dynamic ones add a time step and an integrator: further fields of [`Setting`].

use std::fmt::Write as _;
use std::time::Duration;

use nalgebra::Vector2;

use crate::method::{METHODS, Profile};
use crate::scene::{ElementKind, MethodKind, Scene};
use crate::simulation::{Simulation, SimulationError, Status};
use crate::truth::Truth;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Element.
    pub element: ElementKind,
    /// Cells along and across; `None` for the mesh of a file.
    pub cells: Option<[u32; 2]>,
    /// Method.
    pub method: MethodKind,
    /// Iterations from rest.
    pub iterations: u32,
}

/// An error and where it comes from, percent of the true displacement. The parts are lengths of displacements: their sum
/// bounds the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSplit {
    /// Distance from the truth.
    pub total: f64,
    /// Of the mesh: its own exact equilibrium from the truth (locking).
    pub discretization: f64,
    /// Of stopping early: from where the method ends on this mesh.
    pub iteration: f64,
    /// Of the theory: linear theory's end from the exact equilibrium on this mesh.
    pub model: f64,
}

impl ErrorSplit {
    /// The sum of the parts, which the distance from the truth cannot exceed. Settings are compared by it: an iteration
    /// stopped early that happens to make up for a coarse mesh is luck, not accuracy.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.discretization + self.iteration + self.model
    }
}

/// A setting with its price and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// What was measured.
    pub setting: Setting,
    /// Free unknowns.
    pub dofs: usize,
    /// Whether the method had converged by then.
    pub converged: bool,
    /// Time of all iterations: the median iteration, stages apart, times their number.
    pub time: Profile,
    /// Its error.
    pub error: ErrorSplit,
    /// Whether no other measurement is both faster and, by [`ErrorSplit::bound`], closer.
    pub pareto: bool,
}

/// A whole study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The scene's name.
    pub scene: String,
    /// True displacement of the first probe, m, and where it comes from.
    pub truth: Vector2<f64>,
    /// In words.
    pub truth_source: String,
    /// Estimated error of the truth itself, percent; 0 for an analytic one.
    pub truth_error_percent: f64,
    /// By element, mesh, method, iterations.
    pub measurements: Vec<Measurement>,
}

/// Why a scene cannot be studied.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum StudyError {
    /// The scene does not set up.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// Nothing to compare.
    #[error("expected a scene with a probe that moves; errors are measured there")]
    NoProbe,
    /// The fine solution that would be the truth was not found.
    #[error("no truth: the fine solution of the scene does not converge")]
    NoTruth,
}

/// How many frames a time is the median of, after as many to warm up.
const REPETITIONS: usize = 9;
/// The numbers of iterations looked at.
const ITERATIONS: [u32; 8] = [1, 2, 3, 4, 6, 8, 12, 20];

impl Study {
    /// Measures a scene. `quick` leaves the finer meshes out; `progress` is told every mesh.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(scene: &Scene, quick: bool, mut progress: impl FnMut(&str)) -> Result<Self, StudyError> {
        let (truth, truth_source, truth_error_percent) = truth(scene)?;
        if truth.norm() == 0.0 {
            return Err(StudyError::NoProbe);
        }
        let mut measurements = Vec::new();
        for element in ElementKind::ALL {
            for cells in meshes(scene, element, quick) {
                let mut meshed = scene.clone();
                meshed.set_element(element);
                if let (Some(beam), Some(cells)) = (&mut meshed.beam, cells) {
                    beam.cells = cells;
                }
                progress(&mesh_words(element, cells));
                let exact = end(&meshed, MethodKind::Newton)?;
                for method in METHODS.iter().map(|m| m.kind) {
                    let percent = |a: Vector2<f64>, b: Vector2<f64>| 100.0 * (a - b).norm() / truth.norm();
                    meshed.solver.method = method;
                    // Where a warped method converges it is to the exact equilibrium; where not, there is no end.
                    let own_end = if method == MethodKind::Linear { end(&meshed, method)? } else { exact };
                    let mut simulation = Simulation::new(&meshed)?;
                    let iteration_time = median_iteration(&mut simulation);
                    simulation.reset();
                    for iterations in ITERATIONS {
                        while simulation.iterations() < iterations && *simulation.status() == Status::Running {
                            simulation.step();
                        }
                        let tip = probe(&simulation).ok_or(StudyError::NoProbe)?;
                        let finished = *simulation.status() != Status::Running;
                        let iterations = simulation.iterations();
                        measurements.push(Measurement {
                            setting: Setting { element, cells, method, iterations },
                            dofs: simulation.system().dofs(),
                            converged: *simulation.status() == Status::Converged,
                            time: times(&iteration_time, iterations),
                            error: ErrorSplit {
                                total: percent(tip, truth),
                                discretization: percent(exact, truth),
                                iteration: percent(tip, own_end),
                                model: percent(own_end, exact),
                            },
                            pareto: false,
                        });
                        if finished {
                            break;
                        }
                    }
                }
            }
        }
        mark_pareto(&mut measurements);
        let scene = scene.name.clone();
        Ok(Self { scene, truth, truth_source, truth_error_percent, measurements })
    }

    /// The measurements no other beats, cheapest first.
    #[must_use]
    pub fn front(&self) -> Vec<&Measurement> {
        let mut front: Vec<&Measurement> = self.measurements.iter().filter(|m| m.pareto).collect();
        front.sort_by_key(|m| m.time.total());
        front
    }

    /// The cheapest measurement whose error is bounded by so many percent.
    #[must_use]
    pub fn cheapest_within(&self, percent: f64) -> Option<&Measurement> {
        self.front().into_iter().find(|m| m.error.bound() <= percent)
    }

    /// The study as CSV; times in microseconds.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::from(
            "element,cells_along,cells_across,dofs,method,iterations,converged,time_us,rotate_us,assemble_us,factorize_us,solve_us,error_percent,discretization_percent,iteration_percent,model_percent,error_bound_percent,pareto\n",
        );
        for m in &self.measurements {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let us = |d: Duration| d.as_secs_f64() * 1e6;
            let (t, e) = (&m.time, &m.error);
            let _ = writeln!(
                text,
                "{},{along},{across},{},{},{},{},{:.2},{:.2},{:.2},{:.2},{:.2},{:e},{:e},{:e},{:e},{:e},{}",
                m.setting.element.id(),
                m.dofs,
                m.setting.method.id(),
                m.setting.iterations,
                m.converged,
                us(t.total()),
                us(t.rotate),
                us(t.assemble),
                us(t.factorize),
                us(t.solve),
                e.total,
                e.discretization,
                e.iteration,
                e.model,
                e.bound(),
                m.pareto
            );
        }
        text
    }

    /// The study for people: the truth, the front, and what an error costs.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut text = format!(
            "{}: error of the first probe against {} (its own error about {:.1e} %)\n\n",
            self.scene, self.truth_source, self.truth_error_percent
        );
        text.push_str("nothing measured is both faster and surer than these (error: at most the sum of its parts):\n");
        text.push_str("    time, ms    at most, %     measured   mesh error  stopped early  linear theory   setting\n");
        for m in self.front() {
            let e = &m.error;
            let _ = writeln!(
                text,
                "{:12.4} {:12.4} {:12.4} {:12.4} {:14.4} {:14.4}   {}",
                m.time.total().as_secs_f64() * 1e3,
                e.bound(),
                e.total,
                e.discretization,
                e.iteration,
                e.model,
                m.setting
            );
        }
        text.push('\n');
        for percent in [10.0, 1.0, 0.1] {
            let words = self.cheapest_within(percent).map_or_else(
                || "not reached".to_owned(),
                |m| format!("{:.4} ms, {}", m.time.total().as_secs_f64() * 1e3, m.setting),
            );
            let _ = writeln!(text, "an error of {percent} % costs {words}");
            for element in ElementKind::ALL {
                for method in METHODS.iter().map(|m| m.kind) {
                    let own = self.measurements.iter().filter(|m| {
                        (m.setting.element, m.setting.method) == (element, method) && m.error.bound() <= percent
                    });
                    let words = own.min_by_key(|m| m.time.total()).map_or_else(
                        || "not reached".to_owned(),
                        |m| format!("{:.4} ms", m.time.total().as_secs_f64() * 1e3),
                    );
                    let _ = writeln!(text, "    {} {:<7} {words}", element.id(), method.id());
                }
            }
        }
        text
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let plural = if self.iterations == 1 { "" } else { "s" };
        let mesh = mesh_words(self.element, self.cells);
        write!(f, "{mesh}, {}, {} iteration{plural}", self.method.id(), self.iterations)
    }
}

fn mesh_words(element: ElementKind, cells: Option<[u32; 2]>) -> String {
    match cells {
        Some([along, across]) => format!("{} {along}×{across}", element.id()),
        None => format!("{} as meshed", element.id()),
    }
}

/// The meshes of a scene's element, coarse to fine.
fn meshes(scene: &Scene, element: ElementKind, quick: bool) -> Vec<Option<[u32; 2]>> {
    let Some(beam) = &scene.beam else { return vec![None] };
    // As many unknowns for either element; cells as high as long where the beam allows.
    let along: &[u32] = match element.degree() {
        1 => &[5, 10, 20, 40, 80, 160],
        _ => &[3, 5, 10, 20, 40, 80],
    };
    let along = if quick { &along[..4] } else { along };
    along
        .iter()
        .map(|&n| {
            Some([n, (f64::from(n) * beam.height / beam.length / f64::from(element.degree())).round().max(1.0) as u32])
        })
        .collect()
}

/// The truth of a scene: analytic, or a fine T6 solution with its error estimated from one half as fine.
fn truth(scene: &Scene) -> Result<(Vector2<f64>, String, f64), StudyError> {
    let at_right = scene.probes.first().ok_or(StudyError::NoProbe)?.edge.as_deref() == Some("right");
    if let Some(u) = Truth::of(scene).filter(|_| at_right).and_then(|t| t.tip_displacement()) {
        return Ok((u, "the exact beam".to_owned(), 0.0));
    }
    const FINE: u32 = 64;
    let solve = |fine: u32| {
        let mut scene = scene.clone();
        scene.set_element(ElementKind::T6);
        if let Some(beam) = &mut scene.beam {
            beam.cells = [fine, (f64::from(fine) * beam.height / beam.length).round().max(1.0) as u32];
        }
        end(&scene, MethodKind::Newton)
    };
    let (fine, coarse) = (solve(FINE)?, solve(FINE / 2)?);
    // A mesh from a file is as fine as it is: its own error is not known.
    let own = 100.0 * (fine - coarse).norm() / fine.norm().max(f64::MIN_POSITIVE);
    let source = if scene.beam.is_some() { "a fine t6 solution" } else { "the t6 solution of its own mesh" };
    Ok((fine, source.to_owned(), own))
}

/// Displacement of the first probe where a method ends.
fn end(scene: &Scene, method: MethodKind) -> Result<Vector2<f64>, StudyError> {
    let mut scene = scene.clone();
    scene.solver.method = method;
    scene.solver.max_iterations = scene.solver.max_iterations.max(200);
    let mut simulation = Simulation::new(&scene)?;
    if *simulation.solve() != Status::Converged && method == MethodKind::Newton {
        return Err(StudyError::NoTruth);
    }
    probe(&simulation).ok_or(StudyError::NoProbe)
}

fn probe(simulation: &Simulation) -> Option<Vector2<f64>> {
    simulation.system().probes.first().map(|p| p.mean(simulation.displacement()))
}

/// The median time of an iteration, stage by stage: of the first iterations from rest, warmed up.
fn median_iteration(simulation: &mut Simulation) -> Profile {
    let mut frames = Vec::new();
    for repetition in 0..2 * REPETITIONS {
        simulation.reset();
        for _ in 0..2 {
            if *simulation.status() == Status::Running {
                simulation.step();
                if repetition >= REPETITIONS {
                    frames.push(*simulation.last_frame());
                }
            }
        }
    }
    let median = |stage: fn(&Profile) -> Duration| {
        let mut times: Vec<Duration> = frames.iter().map(stage).collect();
        times.sort_unstable();
        times.get(times.len() / 2).copied().unwrap_or_default()
    };
    Profile {
        rotate: median(|p| p.rotate),
        assemble: median(|p| p.assemble),
        factorize: median(|p| p.factorize),
        solve: median(|p| p.solve),
    }
}

fn times(p: &Profile, n: u32) -> Profile {
    Profile { rotate: p.rotate * n, assemble: p.assemble * n, factorize: p.factorize * n, solve: p.solve * n }
}

fn mark_pareto(measurements: &mut [Measurement]) {
    let all: Vec<(Duration, f64)> = measurements.iter().map(|m| (m.time.total(), m.error.bound())).collect();
    for (i, m) in measurements.iter_mut().enumerate() {
        let (time, error) = all[i];
        // Of equals the first is kept.
        m.pareto = !all.iter().enumerate().any(|(j, &(t, e))| {
            (t <= time && e < error) || (t < time && e <= error) || (t == time && e == error && j < i)
        });
    }
}
