//! Timing of solves from rest and of motions: medians over repetitions after warm-up, by stage.

use std::sync::Mutex;

use web_time::{Duration, Instant};

use super::motion::Samples;
use super::prelude::*;

/// Repetitions that warm up caches, branch predictors and clocks.
const WARM_UP: usize = 2;
const REPETITIONS: usize = 9;
/// Number of measured repetitions if they take long, because long times vary less.
const MIN_REPETITIONS: usize = 3;
/// Part of the longest time of all repetitions after which they count as long.
const LONG: u32 = 5;
/// Longest time of the repetitions of a solve.
const TIME_OF_SOLVE: Duration = Duration::from_secs(2);
/// Time of the repetitions in a web page, whose clock advances by 0.1 ms: the mean over many repetitions is finer.
const COARSE_CLOCK: Option<Duration> =
    if cfg!(target_arch = "wasm32") { Some(Duration::from_millis(100)) } else { None };
/// Held while solves are timed: two timed at once would slow each other down.
static TIMED: Mutex<()> = Mutex::new(());

/// Returns the times from rest to the end of each of the first `iterations` iterations; fewer if the solve ends before,
/// `None` if the computation is cancelled.
pub fn times_from_rest(simulation: &mut Simulation, iterations: u32, observe: Observer<'_>) -> Option<Vec<Timings>> {
    medians(simulation, TIME_OF_SOLVE, |simulation| {
        let mut times = Vec::new();
        while simulation.iterations() < iterations && *simulation.status() == Status::Running {
            check(observe(Progress::at(0.0))).ok()?;
            simulation.step();
            times.push(*simulation.timings());
        }
        Some(times)
    })
}

/// Returns the computing time per simulated second of a scene's motion from its start, ms, measured over the time that a
/// quick study simulates, or the beginning of it where it takes long; `None` for a scene at rest, and if the scene cannot
/// be solved or the computation is cancelled.
pub fn time_of_motion(scene: &Scene, observe: Observer<'_>) -> Option<f64> {
    /// Longest measured time, s, the smallest number of steps that are measured, and longest time of all repetitions.
    const LONGEST: f64 = 0.1;
    const MIN_STEPS: f64 = 4.0;
    const TIME: Duration = Duration::from_millis(500);
    let mut simulation = Simulation::new(scene).ok().filter(|simulation| simulation.motion().is_some())?;
    let steps = (Samples::of(scene, Extent::Quick).ok()?.duration() / scene.dynamics.time_step).round().max(1.0);
    let begun = Instant::now();
    simulation.step();
    let fitting = (LONGEST / begun.elapsed().as_secs_f64()).max(MIN_STEPS);
    milliseconds_per_second(&mut simulation, steps.min(fitting) as u32, TIME, observe)
}

/// Returns the computing time per simulated second of the first `steps` steps of a motion, ms, without the energy
/// ledger; `None` if the computation is cancelled. Repetitions take up to the time `most`.
pub(super) fn milliseconds_per_second(
    simulation: &mut Simulation,
    steps: u32,
    most: Duration,
    observe: Observer<'_>,
) -> Option<f64> {
    /// Number of steps after which a motion reports its progress, which takes time, too.
    const REPORT: u32 = 16;
    simulation.keep_ledger(false);
    let mut simulated = 0.0;
    let times = medians(simulation, most, |simulation| {
        let start = Instant::now();
        for step in 0..steps {
            if step % REPORT == 0 {
                check(observe(Progress::at(0.0))).ok()?;
            }
            if matches!(simulation.step(), Status::Stopped(_)) {
                break;
            }
        }
        let advance = start.elapsed();
        simulated = simulation.state().time();
        Some(vec![Timings { advance, ..Timings::default() }])
    })?;
    let time = times.iter().map(Timings::total).sum::<Duration>().max(Duration::from_nanos(1));
    // A motion that stops in its first step counts as long as that step.
    let seconds = if simulated > 0.0 { simulated } else { simulation.scene().dynamics.time_step };
    Some(time.as_secs_f64() * 1e3 / seconds)
}

/// Returns the medians of the times that a run measures, which is repeated, each time after a reset; `None` once it returns
/// `None`. After the time `most` no further repetition is started, not even after a single one. Only one thread of the
/// process measures at a time.
fn medians(
    simulation: &mut Simulation,
    most: Duration,
    mut run: impl FnMut(&mut Simulation) -> Option<Vec<Timings>>,
) -> Option<Vec<Timings>> {
    let _turn = lock(&TIMED);
    let mut runs: Vec<Vec<Timings>> = Vec::new();
    let start = Instant::now();
    loop {
        simulation.reset();
        runs.push(run(simulation)?);
        let (count, spent) = (runs.len(), start.elapsed());
        if spent > most
            || count >= WARM_UP + MIN_REPETITIONS && spent > most / LONG
            || count >= WARM_UP + REPETITIONS && COARSE_CLOCK.is_none_or(|time| spent > time)
        {
            break;
        }
    }
    runs.drain(..WARM_UP.min(runs.len() - 1));
    let count = runs.iter().map(Vec::len).min().unwrap_or(0);
    let medians = (0..count).map(|i| {
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
    });
    Some(medians.collect())
}
