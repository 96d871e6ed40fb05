//! Compares one step of rapier2d's soft bodies with one iteration of `newton` on the same meshes: `cargo bench
//! --features rivals --bench rivals`. The program `rivals` reports how accurate such steps are.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

#[path = "../src/bin/rivals/rapier.rs"]
mod rapier;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use rapier::{Rapier, RapierSolver, Swing};
use warpbeam::scene::{Source, open};
use warpbeam::{Simulation, Status};

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("step");
    for [nx, ny] in [[20, 2], [40, 4], [80, 8]] {
        let assignments = vec![format!("beam.cells=[{nx},{ny}]"), "solver.method=newton".to_owned()];
        let scene = open(&Source { name: "cantilever".into(), assignments }).unwrap();
        let mut newton = Simulation::new(&scene).unwrap();
        newton.solve();
        let end = newton.probe("tip").unwrap();
        let ours = Simulation::new(&scene).unwrap();
        let dofs = ours.system().dofs();
        for solver in RapierSolver::ALL {
            let swing = Swing { solver, frequency_factor: 0.02, damping: 1.0, cg_iterations: 20 };
            let mut rapier = Rapier::new(ours.problem(), end, swing).unwrap();
            group.bench_function(BenchmarkId::new(format!("rapier2d {}", solver.id()), dofs), |b| {
                b.iter(|| rapier.step())
            });
        }
        group.bench_function(BenchmarkId::new("newton", dofs), |b| {
            b.iter(|| {
                if *newton.status() != Status::Running {
                    newton.reset();
                }
                newton.step();
            });
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
