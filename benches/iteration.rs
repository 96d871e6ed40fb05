//! Benchmarks of rotation, assembly, factorization, solve, edits and a whole iteration at four sizes of the same
//! cantilever. Prints the time of a sweep, in nanoseconds per element, and the time of an iteration relative to a plain
//! loop of sweep, factorization and solve.
//!
//! `cargo bench` reports medians of this machine; do not compare them with those of another machine.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix2, Vector2};
use warpbeam::MethodKind;
use warpbeam::assembly::{Forces, Kinematics, Matrix, Problem, System};
use warpbeam::element::{ELEMENTS, Tangent};
use warpbeam::method::METHODS;
use warpbeam::rotation::{Rotation, polar};
use warpbeam::scene::{LoadId, Scene, Source, open, registry};
use warpbeam::simulation::Simulation;
use warpbeam::solver::Factor;

fn scene(id: &str, set: &[String]) -> Scene {
    open(&Source { name: id.into(), assignments: set.to_vec() }).unwrap()
}

/// Returns a cantilever with about 120, 1 440, 5 440 and 20 000 unknowns.
fn sizes() -> Vec<Scene> {
    [[20, 2], [80, 8], [160, 16], [320, 30]]
        .map(|[nx, ny]| scene("cantilever", &[format!("beam.cells=[{nx},{ny}]")]))
        .to_vec()
}

fn stages(c: &mut Criterion) {
    for scene in sizes() {
        let problem = Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap();
        let system = problem.system();
        let dofs = system.dofs();
        // State in which all rotations differ.
        let bent: Vec<Vector2<f64>> =
            system.mesh().nodes().iter().map(|x| Rotation::from_angle(-0.05 * x.x).apply(*x) - x).collect();
        let mut state = system.state_of(&bent).unwrap();
        let mut forces = Forces::new(bent.len());
        let mut matrix = Matrix::new(system.pattern());
        let mut factor = Factor::new(system.symbolic().unwrap()).unwrap();

        c.bench_function(&format!("rotate/{dofs}"), |b| {
            b.iter(|| system.update_rotations(black_box(&mut state), Kinematics::Corotated));
        });
        c.bench_function(&format!("force/{dofs}"), |b| {
            b.iter(|| problem.linearize(black_box(&state), &mut forces, None));
        });
        for (name, tangent) in [("force and A", Tangent::WARPED), ("force and A + G", Tangent::EXACT)] {
            c.bench_function(&format!("{name}/{dofs}"), |b| {
                b.iter(|| problem.linearize(black_box(&state), &mut forces, Some((tangent, &mut matrix))));
            });
        }
        c.bench_function(&format!("factorize/{dofs}"), |b| {
            b.iter(|| factor.factorize(black_box(matrix.values())).unwrap());
        });
        let mut free = vec![1.0; dofs];
        c.bench_function(&format!("solve/{dofs}"), |b| {
            b.iter(|| {
                free.fill(1.0);
                factor.solve_in_place(black_box(&mut free));
            });
        });
    }
}

/// Benchmarks edits. Compare them with one evaluation of the residual (`force` above) and one assembly (`force and A`).
fn edits(c: &mut Criterion) {
    for scene in sizes() {
        let mut simulation = Simulation::new(&scene).unwrap();
        simulation.solve();
        let dofs = simulation.system().dofs();
        let mut force = -1000.0;
        c.bench_function(&format!("edit a force/{dofs}"), |b| {
            b.iter(|| {
                force = -2001.0 - force;
                simulation.set_force(LoadId::nth(0), [0.0, force]).unwrap();
            });
        });
        let mut material = scene.material;
        c.bench_function(&format!("edit the material/{dofs}"), |b| {
            b.iter(|| {
                material.young = 2.1e6 - material.young;
                simulation.set_material(material).unwrap();
            });
        });
    }
}

/// Benchmarks one iteration of every method, from rest.
fn iterations(c: &mut Criterion) {
    for entry in METHODS {
        for mut scene in sizes() {
            scene.solver.method = entry.kind;
            let mut simulation = Simulation::new(&scene).unwrap();
            let id = format!("iteration/{}/{}", entry.kind.id(), simulation.system().dofs());
            c.bench_function(&id, |b| {
                b.iter(|| {
                    simulation.reset();
                    simulation.step();
                });
            });
        }
    }
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}

fn time(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

/// Prints the time of one sweep with rotations and forces, in nanoseconds per element, and the time of the first
/// iteration from rest relative to a plain loop. The plain loop factorizes and solves with the same ordering, sweeps,
/// and does nothing else. The two are timed alternately.
fn sweeps(_: &mut Criterion) {
    println!("one sweep, ns an element; an iteration over a plain loop of factorization, solve and sweep");
    println!("element  unknowns  force only       A   A + G  warped / plain  newton / plain");
    for (element, mut scene) in ELEMENTS.iter().flat_map(|e| sizes().into_iter().map(move |s| (e, s))) {
        scene.set_element(element.kind);
        let problem = Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap();
        let (system, nodes) = (problem.system(), problem.system().mesh().nodes());
        let (dofs, count) = (system.dofs(), system.mesh().element_count() as f64);
        let repetitions = (2_000_000 / dofs).clamp(9, 999);
        let mut forces = Forces::new(nodes.len());
        let mut matrix = Matrix::new(system.pattern());
        let bent: Vec<_> = nodes.iter().map(|x| Rotation::from_angle(-0.05 * x.x).apply(*x) - x).collect();
        let mut state = system.state_of(&bent).unwrap();
        let sweep = [None, Some(Tangent::WARPED), Some(Tangent::EXACT)].map(|tangent| {
            let mut sweep = || {
                let matrix = tangent.map(|tangent| (tangent, &mut matrix));
                problem.update_and_linearize(black_box(&mut state), Kinematics::Corotated, &mut forces, matrix);
            };
            median((0..repetitions).map(|_| time(&mut sweep)).collect()).as_secs_f64() * 1e9 / count
        });
        let mut factor = Factor::new(system.symbolic().unwrap()).unwrap();
        let mut free = vec![0.0; dofs];
        let ratio =
            [(MethodKind::Warped, Tangent::WARPED), (MethodKind::Newton, Tangent::EXACT)].map(|(method, tangent)| {
                scene.solver.method = method;
                let mut simulation = Simulation::new(&scene).unwrap();
                let (mut ours, mut plain) = (Vec::new(), Vec::new());
                for _ in 0..repetitions {
                    simulation.reset();
                    ours.push(time(|| {
                        simulation.step();
                    }));
                    let mut state = system.at_rest();
                    problem.linearize(&state, &mut forces, Some((tangent, &mut matrix)));
                    problem.balance(&state, Kinematics::Corotated, 1.0, &mut forces);
                    let mut u = state.displacement().to_vec();
                    let solve = time(|| {
                        factor.factorize(matrix.values()).unwrap();
                        system.pattern().restrict(forces.residual(), &mut free);
                        factor.solve_in_place(&mut free);
                        system.pattern().add_free(&free, 1.0, &mut u);
                    });
                    state = state.with_displacement(u).unwrap();
                    let matrix = Some((tangent, &mut matrix));
                    let sweep = time(|| {
                        problem.update_and_linearize(&mut state, Kinematics::Corotated, &mut forces, matrix);
                    });
                    plain.push(solve + sweep);
                }
                median(ours).as_secs_f64() / median(plain).as_secs_f64()
            });
        let [force, a, a_and_g] = sweep;
        let [warped, newton] = ratio;
        println!("{:7} {dofs:9} {force:11.1} {a:7.1} {a_and_g:7.1} {warped:15.3} {newton:15.3}", element.id);
    }
}

/// Benchmarks the solution of every built-in scene, from rest.
fn scenes(c: &mut Criterion) {
    for built_in in registry::BUILT_IN {
        let mut simulation = Simulation::new(&scene(built_in.id, &[])).unwrap();
        c.bench_function(&format!("scene/{}", built_in.id), |b| {
            b.iter(|| {
                simulation.reset();
                simulation.solve();
            });
        });
    }
}

fn rotation(c: &mut Criterion) {
    let f = Matrix2::new(0.55, -1.02, 0.875, 0.5);
    c.bench_function("polar", |b| b.iter(|| polar(black_box(&f))));
}

criterion_group!(benches, rotation, sweeps, stages, edits, iterations, scenes);
criterion_main!(benches);
