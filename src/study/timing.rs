//! Timing of iterations from rest: medians over repetitions after warm-up, by stage.

use std::sync::Mutex;

use serde::{Deserialize, Serialize};
use web_time::{Duration, Instant};

use super::prelude::*;
use super::reference::first_probe;

/// Repetitions that warm up caches, branch predictors and clocks.
const WARM_UP: usize = 2;
const REPETITIONS: usize = 9;
/// Number of measured repetitions if they take long, because long times vary less.
const MIN_REPETITIONS: usize = 3;
/// Time after which repetitions count as long.
const LONG: Duration = Duration::from_millis(400);
/// Time after which no further repetition is started, not even after a single one.
const TOO_LONG: Duration = Duration::from_secs(2);
/// Time of the repetitions in a web page, whose clock advances by steps of 0.1 ms: the mean over many repetitions is
/// finer than a step.
const COARSE_CLOCK: Option<Duration> =
    if cfg!(target_arch = "wasm32") { Some(Duration::from_millis(100)) } else { None };
/// Held while solves are timed: two timed at once would slow each other down.
static TIMED: Mutex<()> = Mutex::new(());

/// Time and result of a solve from rest.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct SolveFromRest {
    /// Median times of repeated solves.
    pub timings: Timings,
    /// Number of iterations.
    pub iterations: u32,
    /// `true` if it ends with a result.
    pub is_solved: bool,
    /// Displacement of the first probe at the end, m; `None` if the scene has no probe.
    pub displacement: Option<Vector2<f64>>,
}

/// Times the solve of a scene from rest; returns `None` for a motion, and if the scene cannot be solved or the
/// computation is cancelled.
pub fn time_from_rest(scene: &Scene, observe: Observer<'_>) -> Option<SolveFromRest> {
    let mut simulation = Simulation::new(scene).ok().filter(|simulation| simulation.motion().is_none())?;
    // Without a load there is no iteration.
    let timings = times_from_rest(&mut simulation, u32::MAX, observe)?.pop().unwrap_or_default();
    Some(SolveFromRest { timings, ..SolveFromRest::of(&simulation) })
}

impl SolveFromRest {
    /// Returns time and result of a simulation that has been solved from rest.
    pub(crate) fn of(simulation: &Simulation) -> Self {
        Self {
            timings: *simulation.timings(),
            iterations: simulation.iterations(),
            is_solved: simulation.status().is_success(),
            displacement: first_probe(simulation).ok(),
        }
    }
}

/// Returns the times from rest to the end of each of the first `iterations` iterations; fewer if the solve ends before,
/// `None` if the computation is cancelled. Only one thread of the process measures at a time.
pub fn times_from_rest(simulation: &mut Simulation, iterations: u32, observe: Observer<'_>) -> Option<Vec<Timings>> {
    let _turn = lock(&TIMED);
    let mut runs: Vec<Vec<Timings>> = Vec::new();
    let start = Instant::now();
    let is_enough = |runs: usize, spent: Duration| {
        runs >= WARM_UP + REPETITIONS && COARSE_CLOCK.is_none_or(|time| spent > time)
            || runs >= WARM_UP + MIN_REPETITIONS && spent > LONG
            || runs > 0 && spent > TOO_LONG
    };
    while !is_enough(runs.len(), start.elapsed()) {
        simulation.reset();
        let mut run = Vec::new();
        while simulation.iterations() < iterations && *simulation.status() == Status::Running {
            if observe(Progress::at(0.0)).is_break() {
                return None;
            }
            simulation.step();
            run.push(*simulation.timings());
        }
        runs.push(run);
    }
    runs.drain(..WARM_UP.min(runs.len() - 1));
    let count = runs.iter().map(Vec::len).min().unwrap_or(0);
    let times = (0..count)
        .map(|i| {
            let median = |stage: fn(&Timings) -> Duration| {
                let mut times: Vec<Duration> = runs.iter().map(|run| stage(&run[i])).collect();
                if COARSE_CLOCK.is_some() {
                    return times.iter().sum::<Duration>() / u32::try_from(times.len()).unwrap_or(u32::MAX);
                }
                times.sort_unstable();
                times[times.len() / 2]
            };
            Timings {
                rotate: median(|p| p.rotate),
                linearize: median(|p| p.linearize),
                factorize: median(|p| p.factorize),
                solve: median(|p| p.solve),
                advance: median(|p| p.advance),
                certify: median(|p| p.certify),
            }
        })
        .collect();
    Some(times)
}

/// Returns the median time of `run`, each time after a reset of the simulation. After the time `enough` no further run is
/// started, because long times vary less. Only one thread of the process measures at a time.
pub(super) fn median_time(
    simulation: &mut Simulation,
    enough: Duration,
    mut run: impl FnMut(&mut Simulation),
) -> Duration {
    /// Largest number of runs.
    const RUNS: usize = 5;
    let _turn = lock(&TIMED);
    let mut times: Vec<Duration> = Vec::new();
    while times.is_empty() || (times.len() < RUNS && times.iter().sum::<Duration>() < enough) {
        simulation.reset();
        let start = Instant::now();
        run(simulation);
        times.push(start.elapsed());
    }
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
