//! Prints the time of an iteration of `newton`, and the peak memory of meshing, setting up and iterating, by the number
//! of unknowns: the table "By size" of `docs/measurements/performance.md`. `cargo bench --bench scaling`.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use std::time::{Duration, Instant};

use peak_alloc::PeakAlloc;
use warpbeam::scene::{Source, open};
use warpbeam::{ElementKind, MethodKind, Simulation};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// Approximate numbers of unknowns.
const UNKNOWNS: [f64; 4] = [1e2, 1e3, 1e4, 1e5];
/// Time spent on the iterations of a mesh.
const ENOUGH: Duration = Duration::from_millis(500);
/// Smallest number of timed iterations of a mesh.
const LEAST: usize = 3;

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let names: Vec<String> = ElementKind::all().map(|element| element.id().to_uppercase()).collect();
    println!("| unknowns | {} | memory, MiB |\n|{}", names.join(" | "), "---|".repeat(names.len() + 2));
    for unknowns in UNKNOWNS {
        let measured: Vec<_> = ElementKind::all().map(|element| measure(element, unknowns)).collect();
        let times: Vec<String> =
            measured.iter().map(|(time, _)| format!("{:.3} ms", 1e3 * time.as_secs_f64())).collect();
        let memory = measured.iter().map(|(_, mib)| *mib);
        let [least, most] = [memory.clone().fold(f32::INFINITY, f32::min), memory.fold(0.0, f32::max)];
        println!("| {unknowns} | {} | {least:.1} to {most:.1} |", times.join(" | "));
    }
}

/// Returns the median time of an iteration of the cantilever with about `unknowns` unknowns, and the peak memory, MiB.
fn measure(element: ElementKind, unknowns: f64) -> (Duration, f32) {
    let mut scene = open(&Source { name: "cantilever".into(), assignments: Vec::new() }).unwrap();
    let beam = scene.beam.clone().unwrap();
    let (slenderness, pieces) = (beam.length / beam.height, element.entry().degree() as f64);
    // There is one more node than pieces across, which matters for few cells.
    let across = (((0.5 * unknowns / slenderness).sqrt() - 0.5) / pieces).round().max(1.0);
    let along = (0.5 * unknowns / (across * pieces + 1.0) / pieces).round().max(1.0);
    scene = scene.with_cells(along as u32, across as u32).with_method(MethodKind::Newton);
    scene.set_element(element);
    let before = HEAP.current_usage_as_mb();
    HEAP.reset_peak_usage();
    let mut simulation = Simulation::new(&scene).unwrap();
    // The first iteration warms up.
    simulation.step();
    let (begun, mut times) = (Instant::now(), Vec::new());
    while times.len() < LEAST || begun.elapsed() < ENOUGH {
        simulation.reset();
        let step = Instant::now();
        simulation.step();
        times.push(step.elapsed());
    }
    times.sort_unstable();
    (times[times.len() / 2], HEAP.peak_usage_as_mb() - before)
}
