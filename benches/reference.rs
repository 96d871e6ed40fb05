//! Computes the reference solution of every built-in scene and prints its source, its own error, and its time relative
//! to one solve of the scene. This is the table of `docs/measurements/accuracy.md`: `cargo bench --bench reference`.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use warpbeam::Simulation;
use warpbeam::format;
use warpbeam::scene::{Analysis, Source, open, registry};
use warpbeam::study::StudyReference;
use warpbeam::study::{Extent, Reference, StudyError};

/// Number of timed rounds; the median is printed.
const ROUNDS: usize = 5;

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    println!("| scene | unknowns | reference | its own error | its time | one solve | ratio |");
    println!("|---|---|---|---|---|---|---|");
    for built_in in registry::BUILT_IN {
        let scene = open(&Source { name: built_in.id.into(), assignments: Vec::new() }).unwrap();
        let mut simulation = Simulation::new(&scene).unwrap();
        let solve = median(|| {
            simulation.reset();
            simulation.solve();
        });
        let start = Instant::now();
        let go_on = &|_: warpbeam::Progress<'_>| ControlFlow::Continue(());
        let (source, own_error) = match scene.analysis {
            Analysis::Dynamic => match StudyReference::new(&scene, Extent::Quick, go_on) {
                Ok(found) => {
                    let text = found.text.to_string();
                    // The error has a column.
                    (text.split(" (").next().unwrap_or_default().to_owned(), Some(found.error_percent))
                }
                Err(error) => (error.to_string(), None),
            },
            _ => match Reference::find(&scene, Some(&simulation), Extent::Quick, go_on) {
                Ok(found) => match found.first() {
                    Some(first) => {
                        (format!("{}, {} unknowns", first.source, found.unknowns), Some(first.own_error_percent))
                    }
                    None => ("not known".to_owned(), None),
                },
                Err(StudyError::Unstable) => ("none: the equilibrium is unstable".to_owned(), None),
                Err(error) => (error.to_string(), None),
            },
        };
        let taken = start.elapsed();
        println!(
            "| `{}` | {} | {source} | {} | {} | {} | {} |",
            built_in.id,
            simulation.system().dofs(),
            own_error
                .map_or_else(|| "—".to_owned(), |percent| format!("{} %", format::number(format::two_digits(percent)))),
            format::engineering(format::two_digits(taken.as_secs_f64()), "s"),
            format::engineering(format::two_digits(solve.as_secs_f64()), "s"),
            format::number(format::two_digits(taken.as_secs_f64() / solve.as_secs_f64())),
        );
    }
}

fn median(mut run: impl FnMut()) -> Duration {
    let mut times: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed()
        })
        .collect();
    times.sort();
    times[ROUNDS / 2]
}
