//! What iterations from rest cost: medians over repetitions, warmed up, stages apart.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use crate::simulation::{Simulation, Status};
use crate::timings::Timings;

/// Repetitions that only warm up caches, branch predictors and clocks.
const WARM_UP: usize = 2;
/// Repetitions measured …
const REPETITIONS: usize = 9;
/// … but no more than this where they take long: long times vary less.
const FEWEST: usize = 3;
/// What is long.
const LONG: Duration = Duration::from_millis(400);

/// The time from rest to the end of each of the first `iterations`, fewer where the solve ends before.
#[must_use]
pub fn times_from_rest(simulation: &mut Simulation, iterations: u32) -> Vec<Timings> {
    let mut runs: Vec<Vec<Timings>> = Vec::new();
    let start = Instant::now();
    for repetition in 0..WARM_UP + REPETITIONS {
        if runs.len() >= FEWEST && start.elapsed() > LONG {
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

/// About how long [`times_from_rest`] takes, where a run takes so long.
#[must_use]
pub fn expected_time(run: Duration) -> Duration {
    let [all, fewest] = [REPETITIONS, FEWEST].map(|repetitions| run * (WARM_UP + repetitions) as u32);
    all.min(fewest.max(LONG))
}

/// How often a run is timed.
#[derive(Clone, Debug)]
pub(super) struct Runs {
    /// Not more often than this, and not less often.
    pub count: RangeInclusive<usize>,
    /// Nor once the runs have taken so long together: long times vary less.
    pub enough: Duration,
}

/// The median time that a run takes, without what prepares it.
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
