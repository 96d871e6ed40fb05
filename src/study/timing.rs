//! Timing of iterations from rest: medians over repetitions after warm-up, by stage.

use std::ops::RangeInclusive;

use web_time::{Duration, Instant};

use crate::simulation::{Simulation, Status};
use crate::timings::Timings;

/// Repetitions that warm up caches, branch predictors and clocks.
const WARM_UP: usize = 2;
/// Number of measured repetitions.
const REPETITIONS: usize = 9;
/// Number of measured repetitions if they take long, because long times vary less.
const MIN_REPETITIONS: usize = 3;
/// Time after which repetitions count as long.
const LONG: Duration = Duration::from_millis(400);

/// Returns the times from rest to the end of each of the first `iterations` iterations; fewer if the solve ends before.
#[must_use]
pub fn times_from_rest(simulation: &mut Simulation, iterations: u32) -> Vec<Timings> {
    let mut runs: Vec<Vec<Timings>> = Vec::new();
    let start = Instant::now();
    for repetition in 0..WARM_UP + REPETITIONS {
        if runs.len() >= MIN_REPETITIONS && start.elapsed() > LONG {
            break;
        }
        simulation.reset();
        let mut run = Vec::new();
        while simulation.iterations() < iterations && *simulation.status() == Status::Running {
            simulation.step();
            run.push(*simulation.timings());
        }
        if repetition >= WARM_UP {
            runs.push(run);
        }
    }
    let count = runs.iter().map(Vec::len).min().unwrap_or(0);
    (0..count)
        .map(|i| {
            let median = |stage: fn(&Timings) -> Duration| {
                let mut times: Vec<Duration> = runs.iter().map(|run| stage(&run[i])).collect();
                times.sort_unstable();
                times[times.len() / 2]
            };
            Timings {
                rotate: median(|p| p.rotate),
                assemble: median(|p| p.assemble),
                factorize: median(|p| p.factorize),
                solve: median(|p| p.solve),
                certify: median(|p| p.certify),
            }
        })
        .collect()
}

/// Returns the approximate time that [`times_from_rest`] takes if a single run takes `run`.
#[must_use]
pub fn expected_time(run: Duration) -> Duration {
    let [all, fewest] = [REPETITIONS, MIN_REPETITIONS].map(|repetitions| run * (WARM_UP + repetitions) as u32);
    all.min(fewest.max(LONG))
}

/// Number of timed runs.
#[derive(Clone, Debug)]
pub(super) struct Runs {
    /// Smallest and largest number of runs.
    pub count: RangeInclusive<usize>,
    /// Total time after which no further run is started, because long times vary less.
    pub enough: Duration,
}

/// Returns the median time of `run`, without `prepare`.
pub(super) fn median_time<T>(
    runs: Runs,
    subject: &mut T,
    prepare: impl Fn(&mut T),
    mut run: impl FnMut(&mut T),
) -> Duration {
    let Runs { count, enough } = runs;
    let mut times = Vec::new();
    while times.len() < *count.start() || (times.len() < *count.end() && times.iter().sum::<Duration>() < enough) {
        prepare(subject);
        let start = Instant::now();
        run(subject);
        times.push(start.elapsed());
    }
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
