//! Time per simulated half second of the swing at two sizes, under `newton`, which refactorizes in
//! every stage, and under `auto`.
//!
//! The ratio printed at the end compares the fastest rounds of one run.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use warpbeam::scene::{IntegratorKind, Scene, Source, open};
use warpbeam::{MethodKind, Simulation};

const STEPS: u32 = 30;

fn swing(cells: &str, integrator: IntegratorKind, method: MethodKind) -> Scene {
    let source = Source { name: "swing".into(), assignments: vec![format!("beam.cells={cells}")] };
    let mut scene = open(&source).unwrap().with_method(method);
    scene.dynamics.integrator = integrator;
    scene
}

/// Runs [`STEPS`] steps from the start without keeping the ledger, and returns the time.
fn run(simulation: &mut Simulation) -> Duration {
    simulation.reset();
    let start = Instant::now();
    (0..STEPS).for_each(|_| {
        simulation.step();
    });
    start.elapsed()
}

fn motions(c: &mut Criterion) {
    let mut group = c.benchmark_group("swing");
    group.sample_size(10);
    for cells in ["[48,5]", "[144,17]"] {
        for integrator in [IntegratorKind::TrBdf2, IntegratorKind::EnergyMomentum, IntegratorKind::ImplicitEuler] {
            let fastest = [MethodKind::Newton, MethodKind::Auto].map(|method| {
                let mut simulation = Simulation::new(&swing(cells, integrator, method)).unwrap();
                simulation.keep_ledger(false);
                let mut fastest = Duration::MAX;
                let id = format!("{}/{}/{}", integrator.id(), method.id(), simulation.system().dofs());
                group.bench_function(&id, |b| {
                    b.iter_custom(|rounds| {
                        let times = (0..rounds).map(|_| run(&mut simulation));
                        times.inspect(|&time| fastest = fastest.min(time)).sum()
                    });
                });
                fastest.as_secs_f64()
            });
            println!("{} {cells}: auto is {:.2} times as fast as newton\n", integrator.id(), fastest[0] / fastest[1]);
        }
    }
    group.finish();
}

criterion_group!(benches, motions);
criterion_main!(benches);
