//! Benchmarks of setting up, rotation, assembly, factorization, solve, edits and a whole iteration at four sizes of the same
//! cantilever. Prints the time of a sweep, in nanoseconds per element, and the time of an iteration relative to a plain
//! loop of sweep, factorization and solve, and to faer's own factorization and solve of the same matrix.
//!
//! `cargo bench` reports medians of this machine; do not compare them with those of another machine.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};
use nalgebra::{Matrix2, Vector2};
use warpbeam::assembly::{Forces, Kinematics, Matrix, Pattern, Problem, System};
use warpbeam::element::{ELEMENTS, Tangent};
use warpbeam::method::METHODS;
use warpbeam::rotation::{Rotation, polar};
use warpbeam::scene::{Scene, Source, open, registry};
use warpbeam::solver::Factor;
use warpbeam::{MethodKind, Simulation};

fn scene(id: &str, set: &[String]) -> Scene {
    open(&Source { name: id.into(), assignments: set.to_vec() }).unwrap()
}

/// Returns a cantilever with about 120, 1 440, 5 440 and 20 000 unknowns.
fn sizes() -> Vec<Scene> {
    [[20, 2], [80, 8], [160, 16], [320, 30]]
        .map(|[nx, ny]| {
            let cells = format!("beam.cells=[{nx},{ny}]");
            scene("cantilever", &[cells, "beam.element=t3".to_owned(), "load.0.force=[0,-1000]".to_owned()])
        })
        .to_vec()
}

fn stages(c: &mut Criterion) {
    for scene in sizes() {
        c.bench_function(&format!("set up/{}", System::new(&scene).unwrap().dofs()), |b| {
            b.iter(|| System::new(black_box(&scene)).unwrap());
        });
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
                simulation.edit(|scene| scene.set_force(0, [0.0, force])).unwrap();
            });
        });
        let mut material = scene.material;
        c.bench_function(&format!("edit the material/{dofs}"), |b| {
            b.iter(|| {
                material.young = 2.1e6 - material.young;
                simulation.change_scene(&simulation.scene().clone().with_material(material)).unwrap();
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

/// faer's Cholesky factorization with its own choices of ordering and kind of factor, of a matrix in the numbering of
/// the mesh.
struct Faer {
    symbolic: SymbolicCholesky<usize>,
    structure: SymbolicSparseColMat<usize>,
    /// Index of every value in the values of our matrix.
    source: Vec<usize>,
    values: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl Faer {
    fn new(pattern: &Pattern) -> Self {
        let mut place = vec![0; pattern.dofs()];
        let mut order: Vec<usize> = (0..pattern.dofs()).collect();
        order.sort_unstable_by_key(|&free| pattern.free[free]);
        order.iter().enumerate().for_each(|(i, &free)| place[free] = i);
        let mut entries = Vec::new();
        for (column, bounds) in pattern.column_starts.windows(2).enumerate() {
            for i in bounds[0]..bounds[1] {
                let (a, b) = (place[pattern.row_indices[i]], place[column]);
                entries.push((a.min(b), a.max(b), i));
            }
        }
        entries.sort_unstable();
        let n = pattern.dofs();
        let starts = (0..=n).map(|column| entries.partition_point(|&(c, ..)| c < column)).collect();
        let rows = entries.iter().map(|&(_, row, _)| row).collect();
        let structure = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        let (lower, amd) = (Side::Lower, SymmetricOrdering::Amd);
        let symbolic = factorize_symbolic_cholesky(structure.as_ref(), lower, amd, Default::default()).unwrap();
        let memory = MemBuffer::new(StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]));
        let (source, factor) = (entries.iter().map(|&(.., i)| i).collect(), vec![0.0; symbolic.len_val()]);
        Self { symbolic, values: vec![0.0; entries.len()], structure, source, factor, memory }
    }

    fn set(&mut self, matrix: &Matrix) {
        self.values.iter_mut().zip(&self.source).for_each(|(value, &i)| *value = matrix.values()[i]);
    }

    fn factorize_and_solve(&mut self, b: &mut [f64]) {
        let matrix = SparseColMatRef::new(self.structure.as_ref(), &self.values);
        let (memory, options) = (MemStack::new(&mut self.memory), Default::default());
        let factor = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix,
            Side::Lower,
            options,
            Par::Seq,
            memory,
            Default::default(),
        );
        let (n, memory) = (b.len(), MemStack::new(&mut self.memory));
        let b = MatMut::from_column_major_slice_mut(b, n, 1);
        factor.unwrap().solve_in_place_with_conj(Conj::No, b, Par::Seq, memory);
    }
}

/// Prints the time of one sweep with rotations and forces, in nanoseconds per element, and the time of the first
/// iteration from rest relative to a plain loop and to faer's own factorization and solve. The plain loop factorizes
/// and solves with the same ordering, sweeps, and does nothing else. The three are timed alternately.
fn sweeps(_: &mut Criterion) {
    println!("one sweep, ns an element; an iteration over a plain loop of factorization, solve and sweep, and over");
    println!("faer's own factorization and solve of the same matrix, without a sweep");
    println!(
        "element  unknowns  force only       A   A + G  warped / plain  newton / plain  warped / faer  newton / faer"
    );
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
        let mut faer = Faer::new(system.pattern());
        let ratio =
            [(MethodKind::Warped, Tangent::WARPED), (MethodKind::Newton, Tangent::EXACT)].map(|(method, tangent)| {
                scene.solver.method = method;
                let mut simulation = Simulation::new(&scene).unwrap();
                let (mut ours, mut plain, mut faers) = (Vec::new(), Vec::new(), Vec::new());
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
                    faer.set(&matrix);
                    faers.push(time(|| faer.factorize_and_solve(&mut free)));
                    state = state.with_displacement(u).unwrap();
                    let matrix = Some((tangent, &mut matrix));
                    let sweep = time(|| {
                        problem.update_and_linearize(&mut state, Kinematics::Corotated, &mut forces, matrix);
                    });
                    plain.push(solve + sweep);
                }
                let ours = median(ours).as_secs_f64();
                [plain, faers].map(|times| ours / median(times).as_secs_f64())
            });
        let [force, a, a_and_g] = sweep;
        let [[warped, warped_faer], [newton, newton_faer]] = ratio;
        println!(
            "{:7} {dofs:9} {force:11.1} {a:7.1} {a_and_g:7.1} {warped:15.3} {newton:15.3} {warped_faer:14.3} \
             {newton_faer:14.3}",
            element.id
        );
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
