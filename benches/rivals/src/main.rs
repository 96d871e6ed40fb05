//! Prints the table "Comparison with rapier2d" of `docs/measurements/performance.md`: the cantilever on the same
//! three-node meshes under the same load. Takes minutes. `cargo run --release --manifest-path benches/rivals/Cargo.toml`.
//!
//! rapier2d's corotational cells have our energy, in f32. Its static solution is the end of a damped oscillation with
//! steps of 1/60 s: mass and damping, which the scene does not determine, are varied, and the fastest run counts.

use std::time::{Duration, Instant};

use rapier2d::prelude::{
    PhysicsWorld, SoftBodyBuilder, SoftBodyCellModel, SoftBodyHandle, SoftBodyMaterial, SoftBodySolver, Vector,
};
use warpbeam::assembly::Problem;
use warpbeam::nalgebra::Vector2;
use warpbeam::scene::{Source, open};
use warpbeam::study::{Reference, times_from_rest};
use warpbeam::{Simulation, Timings};

const STEP: f32 = 1.0 / 60.0;
/// Largest distance from the target, as a fraction of the target, that counts as reached.
const WITHIN: f64 = 0.01;
/// Values of [`Swing::frequency_factor`] and [`Swing::damping`] that are tried.
const FREQUENCY_FACTORS: [f64; 6] = [0.01, 0.02, 0.05, 0.005, 0.1, 0.0025];
const DAMPINGS: [f64; 2] = [0.5, 1.0];
/// Computing time and number of steps after which a run is given up.
const MAX_TIME: Duration = Duration::from_secs(15);
const MAX_STEPS: u32 = 6000;
/// Number of steps within [`WITHIN`] after which the body counts as being at rest.
const RESTS: u32 = 200;

/// Parameters of the damped oscillation to rest, which the static scene does not determine.
#[derive(Clone, Copy)]
struct Swing {
    solver: SoftBodySolver,
    /// Phase angle of the first mode per step, rad; determines the mass.
    frequency_factor: f64,
    /// Damping relative to critical damping.
    damping: f64,
    /// Largest number of conjugate gradient iterations per substep of `fem`.
    cg_iterations: usize,
}

struct Rapier<'a> {
    problem: &'a Problem,
    world: PhysicsWorld,
    handle: SoftBodyHandle,
}

impl<'a> Rapier<'a> {
    /// Creates the body at rest under its load; its first probe finally moves by `end`, m.
    fn new(problem: &'a Problem, end: Vector2<f64>, swing: Swing) -> Self {
        let (mesh, pattern) = (problem.system().mesh(), problem.system().pattern());
        let (lame, force) = (problem.material().lame(), problem.loads().dead_force());
        let vector = |v: &Vector2<f64>| Vector::new(v.x as f32, v.y as f32);
        // A mass on a spring with the stiffness seen by the load, a quarter of a beam's mass.
        let frequency = swing.frequency_factor / f64::from(STEP);
        let mass = 4.0 * force.iter().sum::<Vector2<f64>>().norm() / end.norm() / frequency.powi(2);
        let (mut masses, mut cells, mut total) = (vec![0.0; mesh.nodes().len()], Vec::new(), 0.0);
        for t in mesh.elements() {
            let [a, b, c] = [t[0], t[1], t[2]].map(|n| mesh.nodes()[n as usize]);
            let area = 0.5 * (b - a).perp(&(c - a));
            total += area;
            t.iter().for_each(|&n| masses[n as usize] += area / 3.0);
            cells.push([t[0], t[1], t[2]]);
        }
        // It knows plane strain only: the moduli are those whose plane strain has our Lamé constants.
        let poisson = lame.lambda / (2.0 * (lame.lambda + lame.mu));
        let young = 2.0 * lame.mu * (1.0 + poisson) * problem.material().thickness;
        let body = SoftBodyBuilder::new(mesh.nodes().iter().map(vector).collect())
            .cells(cells)
            .masses(masses.into_iter().map(|m| (m * mass / total) as f32).collect())
            .pinned_particles((0..mesh.nodes().len() as u32).filter(|&n| pattern.fixed(n) == [true, true]))
            .cell_model(SoftBodyCellModel::Corotational)
            .solver(swing.solver)
            .material(SoftBodyMaterial {
                young_modulus: young as f32,
                poisson_ratio: poisson as f32,
                ..SoftBodyMaterial::default()
            })
            .linear_damping((2.0 * swing.damping * frequency) as f32)
            .no_surface_collider()
            .can_sleep(false);
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, 0.0);
        world.integration_parameters.dt = STEP;
        world.integration_parameters.soft_bodies.fem.max_linear_iterations = swing.cg_iterations;
        let handle = world.insert_soft_body(body);
        let body = world.soft_bodies.get_mut(handle).unwrap();
        for (i, force) in force.iter().enumerate().filter(|(_, f)| f.norm() > 0.0) {
            body.add_particle_force(i, vector(force), true);
        }
        Self { problem, world, handle }
    }

    /// Returns the displacement of the first probe, m.
    fn displacement(&self) -> Vector2<f64> {
        let body = self.world.soft_bodies.get(self.handle).unwrap();
        let at = |n: u32| {
            let p = body.particle_position(n as usize);
            Vector2::new(f64::from(p.x), f64::from(p.y)) - self.problem.system().mesh().nodes()[n as usize]
        };
        self.problem.probes().iter().take(1).flat_map(|p| &p.weights).map(|&(n, weight)| at(n) * weight).sum()
    }
}

/// Number of steps and computing time, after which a body stays within 1 % of a target.
type Arrival = Option<(u32, Duration)>;

/// Steps until the body stays at every target, or is given up. Returns the median time of a step and the arrivals.
fn run(mut body: Rapier<'_>, targets: &[Vector2<f64>]) -> (Duration, Vec<Arrival>) {
    let (mut arrivals, mut times, mut spent) = (vec![None; targets.len()], Vec::new(), Duration::ZERO);
    let rests = |arrival: &Arrival, now: u32| arrival.is_some_and(|(since, _)| now - since >= RESTS);
    for now in 1..=MAX_STEPS {
        let begun = Instant::now();
        body.world.step();
        times.push(begun.elapsed());
        spent += begun.elapsed();
        for (arrival, target) in arrivals.iter_mut().zip(targets) {
            let is_near = (body.displacement() - target).norm() <= WITHIN * target.norm();
            *arrival = arrival.or(Some((now, spent))).filter(|_| is_near);
        }
        if spent > MAX_TIME || arrivals.iter().all(|arrival| rests(arrival, now)) {
            break;
        }
    }
    let last = times.len() as u32;
    times.sort_unstable();
    (times[times.len() / 2], arrivals.into_iter().map(|arrival| arrival.filter(|_| rests(&arrival, last))).collect())
}

fn cantilever(assignments: &[&str]) -> Simulation {
    let set = [assignments, &["beam.element=t3", "load.0.force=[0,-1000]", "solver.method=newton"]].concat();
    let source = Source { name: "cantilever".into(), assignments: set.iter().map(|&set| set.to_owned()).collect() };
    let mut newton = Simulation::new(&open(&source).unwrap()).unwrap();
    assert!(newton.solve().is_success());
    newton
}

fn main() {
    println!(
        "| mesh, unknowns | solver | one step | within 1 % of its mesh's rest | within 1 % of the reference | `newton`, same mesh |"
    );
    println!("|---|---|---|---|---|---|");
    let exact = Reference::of(cantilever(&[]).scene()).unwrap().first().unwrap().displacement;
    for [along, across] in [[20, 2], [40, 4], [80, 8], [160, 16]] {
        let mut newton = cantilever(&[&format!("beam.cells=[{along},{across}]")]);
        let rest = newton.probe("tip").unwrap();
        let ours = times_from_rest(&mut newton, u32::MAX, &|_| std::ops::ControlFlow::Continue(())).unwrap();
        let ours = ours.last().map(Timings::total).unwrap();
        let is_fine = (rest - exact).norm() <= WITHIN * exact.norm();
        let targets = if is_fine { vec![rest, exact] } else { vec![rest] };
        for (solver, iterations) in [(SoftBodySolver::Fem, &[20, 500][..]), (SoftBodySolver::Constraints, &[20])] {
            let combinations = FREQUENCY_FACTORS.into_iter().flat_map(|frequency_factor| {
                let swing = move |damping, &cg_iterations| Swing { solver, frequency_factor, damping, cg_iterations };
                DAMPINGS.into_iter().flat_map(move |damping| iterations.iter().map(move |cg| swing(damping, cg)))
            });
            let runs = combinations.map(|swing| run(Rapier::new(newton.problem(), rest, swing), &targets));
            let fastest = runs.min_by_key(|(_, arrivals)| arrivals[0].map_or(Duration::MAX, |(_, time)| time));
            let (step, arrivals) = fastest.unwrap();
            let cell = |arrival: Option<&Arrival>| match arrival.copied().flatten() {
                Some((steps, time)) => format!("{:.0} ms, {steps} steps", 1e3 * time.as_secs_f64()),
                None if !is_fine => {
                    format!("never: the mesh is off by {:.1} %", 100.0 * (rest - exact).norm() / exact.norm())
                }
                None => "never".to_owned(),
            };
            let own = arrivals[0].map_or_else(|| "never".to_owned(), |_| cell(Some(&arrivals[0])));
            let (dofs, [step, ours]) = (newton.system().dofs(), [step, ours].map(|time| 1e3 * time.as_secs_f64()));
            println!(
                "| {along}×{across}, {dofs} | `{solver:?}` | {step:.2} ms | {own} | {} | {ours:.2} ms |",
                cell(arrivals.get(1))
            );
        }
    }
}

/// The same energy has the same equilibrium, in plane stress and plane strain.
#[test]
fn rapier_rests_where_we_do() {
    for set in [&["material.plane=stress"][..], &["material.plane=strain", "material.poisson=0.4"]] {
        let ours = cantilever(&[set, &["beam.cells=[20,2]"]].concat());
        let end = ours.probe("tip").unwrap();
        let swing = Swing { solver: SoftBodySolver::Fem, frequency_factor: 0.05, damping: 1.0, cg_iterations: 500 };
        let mut rapier = Rapier::new(ours.problem(), end, swing);
        (0..400).for_each(|_| rapier.world.step());
        let error = (rapier.displacement() - end).norm() / end.norm();
        assert!(error < 2e-3, "{set:?}: {} {end}", rapier.displacement());
    }
}
