//! Body in rapier2d's world: an independent implementation of the same energy.
#![allow(dead_code, reason = "program, bench and tests each use their part")]

use nalgebra::Vector2;
use rapier2d::prelude::{
    PhysicsWorld, SoftBodyBuilder, SoftBodyCellModel, SoftBodyHandle, SoftBodyMaterial, SoftBodySolver, Vector,
};

use warpbeam::ElementKind;
use warpbeam::assembly::Problem;

/// Time step, s.
const STEP: f32 = 1.0 / 60.0;

/// rapier2d's solvers of soft bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RapierSolver {
    /// Implicit Euler, one linear solve per substep.
    Fem,
    /// Constraints, a few iterations per substep.
    Constraints,
}

impl RapierSolver {
    /// Both solvers.
    pub const ALL: [Self; 2] = [Self::Fem, Self::Constraints];

    /// Returns the name.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Fem => "fem",
            Self::Constraints => "constraints",
        }
    }
}

/// Parameters of the damped oscillation to rest, which the static scene does not determine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Solver.
    pub solver: RapierSolver,
    /// Phase angle of the first mode per step, rad; determines the mass.
    pub frequency_factor: f64,
    /// Damping relative to critical damping.
    pub damping: f64,
    /// Largest number of conjugate gradient iterations per substep of `fem`.
    pub cg_iterations: usize,
}

/// World with one body.
pub struct Rapier<'a> {
    problem: &'a Problem,
    world: PhysicsWorld,
    handle: SoftBodyHandle,
}

impl<'a> Rapier<'a> {
    /// Creates the body at rest under its load; its first probe finally moves by `end`, m. `None` if a node is fixed in
    /// one direction only, a moment rotates with its edge, or elements have more than three nodes, which rapier2d does
    /// not support.
    #[must_use]
    pub fn new(problem: &'a Problem, end: Vector2<f64>, swing: Swing) -> Option<Self> {
        let (mesh, pattern) = (problem.system().mesh(), problem.system().pattern());
        let (lame, dead_force) = (problem.material().lame(), problem.loads().dead_force());
        let half_fixed = |n: u32| pattern.fixed(n)[0] != pattern.fixed(n)[1];
        let nodes = 0..mesh.nodes().len() as u32;
        let has_moments = problem.loads().moments().next().is_some();
        let no_probe = problem.probes().is_empty();
        if mesh.element() != ElementKind::T3 || has_moments || no_probe || nodes.clone().any(half_fixed) {
            return None;
        }
        let vector = |v: &Vector2<f64>| Vector::new(v.x as f32, v.y as f32);
        // A mass on a spring with the stiffness seen by the load, a quarter of a beam's mass.
        let load: Vector2<f64> = dead_force.iter().sum();
        let frequency = swing.frequency_factor / f64::from(STEP);
        let mass = 4.0 * load.norm() / end.norm() / frequency.powi(2);
        let mut masses = vec![0.0; mesh.nodes().len()];
        let mut cells = Vec::new();
        let mut total = 0.0;
        for t in mesh.elements() {
            let [a, b, c] = [t[0], t[1], t[2]].map(|n| mesh.nodes()[n as usize]);
            let area = 0.5 * (b - a).perp(&(c - a));
            total += area;
            t.iter().for_each(|&n| masses[n as usize] += area / 3.0);
            cells.push([t[0], t[1], t[2]]);
        }
        // It supports plane strain only: use the moduli whose plane strain has our Lamé constants.
        let poisson = lame.lambda / (2.0 * (lame.lambda + lame.mu));
        let young = 2.0 * lame.mu * (1.0 + poisson) * problem.material().thickness;
        let body = SoftBodyBuilder::new(mesh.nodes().iter().map(vector).collect())
            .cells(cells)
            .masses(masses.into_iter().map(|m| (m * mass / total) as f32).collect())
            .pinned_particles(nodes.filter(|&n| pattern.fixed(n) == [true, true]))
            .cell_model(SoftBodyCellModel::Corotational)
            .solver(match swing.solver {
                RapierSolver::Fem => SoftBodySolver::Fem,
                RapierSolver::Constraints => SoftBodySolver::Constraints,
            })
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
        let body = world.soft_bodies.get_mut(handle)?;
        for (i, force) in dead_force.iter().enumerate().filter(|(_, f)| f.norm() > 0.0) {
            body.add_particle_force(i, vector(force), true);
        }
        Some(Self { problem, world, handle })
    }

    /// Computes one step of 1/60 s.
    pub fn step(&mut self) {
        self.world.step();
    }

    /// Returns the displacement of the first probe, m.
    #[must_use]
    pub fn displacement(&self) -> Vector2<f64> {
        let Some(body) = self.world.soft_bodies.get(self.handle) else { return Vector2::zeros() };
        let at = |n: u32| {
            let p = body.particle_position(n as usize);
            Vector2::new(f64::from(p.x), f64::from(p.y)) - self.problem.system().mesh().nodes()[n as usize]
        };
        self.problem.probes().iter().take(1).flat_map(|p| &p.weights).map(|&(n, weight)| at(n) * weight).sum()
    }
}
