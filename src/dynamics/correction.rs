//! The linear equations of a stage: from a residual force to a correction of the displacement.
//!
//! `auto` keeps the factor of an earlier matrix while it serves. It preconditions conjugate gradients on the present
//! matrix, turned along with the body: with Q the nodes' rotations since the factor was made, Q L Lᵀ Qᵀ differs from
//! the matrix only by how much elements have bent and stretched (the warp preconditioner of Courtecuisse, Allard,
//! Duriez and Cotin 2010, *Asynchronous preconditioners for efficient solving of non-linear deformations*).

use nalgebra::Vector2;

use crate::assembly::{Matrix, Pattern, System};
use crate::rotation::Rotation;
use crate::solver::{Factor, SolverError};
use crate::state::State;

/// Inertia and stiffness that differ relatively by less than this are the same but for rounding.
const SAME: f64 = 1e-9;

/// A matrix over the free unknowns with its factor.
#[derive(Debug)]
pub(crate) struct Corrector {
    pub matrix: Matrix,
    pub factor: Factor,
    /// A vector over the free unknowns.
    pub free: Vec<f64>,
    /// What the factor is of, where that is a constant matrix.
    pub constant: Option<Weights>,
    kept: Kept,
}

/// The parts of a stage's matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Factor of the mass, 1/s².
    pub inertia: f64,
    /// Factor of the stiffness.
    pub stiffness: f64,
}

impl Weights {
    /// Whether they are the same but for rounding.
    pub fn are_about(&self, other: &Self) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs();
        close(self.inertia, other.inertia) && close(self.stiffness, other.stiffness)
    }
}

/// How exact a correction must be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// Of the norm of the error, to that of the whole correction.
    pub relative: f64,
    /// Whether what is left is seen in the residual of the state it leads to: then what steps with this factor have left
    /// before may be trusted.
    pub is_checked: bool,
}

/// What is known of the factor of an earlier matrix.
#[derive(Debug, Default)]
struct Kept {
    /// What it is of; `None` where there is no factor that could serve.
    weights: Option<Weights>,
    /// Every node's rotation when the factor was made …
    then: Vec<Rotation>,
    /// … and since then.
    since: Vec<Rotation>,
    /// Stages that were solved with this factor, and the back substitutions they took: all, …
    stages: u32,
    solves: u32,
    /// … the last one, …
    last: u32,
    /// … and the present one until now.
    present: u32,
    /// What a step was last seen to leave of the squared norm of the error.
    shrinks: f64,
    vectors: [Vec<f64>; 4],
}

impl Corrector {
    pub fn new(system: &System) -> Result<Self, SolverError> {
        Ok(Self {
            matrix: Matrix::new(system.pattern()),
            factor: Factor::new(system.symbolic())?,
            free: vec![0.0; system.dofs()],
            constant: None,
            kept: Kept::default(),
        })
    }

    /// Forgets a factor of equations that have changed.
    pub fn forget(&mut self) {
        self.constant = None;
        self.kept.weights = None;
    }

    /// Forgets that a factor was of a constant matrix: another one has it now.
    pub fn matrix_changes(&mut self) {
        self.constant = None;
    }

    /// Keeps the factor just made of this state's matrix for later ones.
    pub fn keep(&mut self, weights: Weights, system: &System, state: &State) {
        let Kept { then, .. } = &mut self.kept;
        nodal_rotations(system, state, then);
        self.kept.weights = Some(weights);
        (self.kept.stages, self.kept.solves, self.kept.last, self.kept.present) = (0, 0, 0, 1);
        // A step with the factor of the very matrix leaves nothing.
        self.kept.shrinks = 0.0;
    }

    /// A stage begins: what the one before has taken is known.
    pub fn begin_stage(&mut self) {
        let Kept { stages, solves, last, present, .. } = &mut self.kept;
        if *present > 0 {
            *stages += 1;
            *solves += *present;
            (*last, *present) = (*present, 0);
        }
    }

    /// Whether the factor that is kept is worth another try for a matrix with these weights.
    ///
    /// The price of a stage is least over the factor's life where it is given up once a stage takes more than all have
    /// on average, its making included.
    fn serves(&self, weights: Weights) -> bool {
        let Kept { weights: kept, stages, solves, last, .. } = &self.kept;
        let price = self.factor.price() + f64::from(*solves);
        kept.is_some_and(|kept| kept.are_about(&weights)) && f64::from(*last) * f64::from(*stages) <= price
    }

    /// Replaces the vector over the free unknowns, a residual force, by the correction it needs, to a relative accuracy
    /// in the norm of the matrix, with the factor that is kept. Gives the back substitutions taken, and whether that
    /// was enough: if not, the vector is what it was. Where there is a guess of the correction, m, the accuracy is
    /// relative to what that leaves.
    ///
    /// Preconditioned conjugate gradients (Hestenes and Stiefel 1952); √(r·P⁻¹r) stands for the norm of the error. The
    /// last preconditioned residual is added as it is: it is as good as another iteration where the factor is.
    pub fn correct_with_kept(
        &mut self,
        weights: Weights,
        accuracy: Accuracy,
        guess: Option<&[Vector2<f64>]>,
        system: &System,
        state: &State,
    ) -> (u32, bool) {
        if !self.serves(weights) {
            return (0, false);
        }
        let Self { matrix, factor, free, kept, .. } = self;
        let pattern = system.pattern();
        nodal_rotations(system, state, &mut kept.since);
        for (now, then) in kept.since.iter_mut().zip(&kept.then) {
            *now = Rotation { c: now.c * then.c + now.s * then.s, s: now.s * then.c - now.c * then.s };
        }
        let [x, r, z, p] = &mut kept.vectors;
        [&mut *x, r, z, p].into_iter().for_each(|v| v.resize(free.len(), 0.0));
        r.copy_from_slice(free);
        match guess {
            Some(guess) => {
                pattern.restrict(guess, x);
                matrix.multiply(pattern, x, z);
                r.iter_mut().zip(&*z).for_each(|(r, z)| *r -= z);
            }
            None => x.fill(0.0),
        }
        // More than these and a new factor would have cost less.
        let most = factor.price().ceil() as u32;
        let (mut first, mut before) = (0.0, 0.0);
        for solves in 1..=most {
            z.copy_from_slice(r);
            turn(pattern, &kept.since, -1.0, z);
            factor.solve_in_place(z);
            turn(pattern, &kept.since, 1.0, z);
            let now = dot(r, z);
            if !(now.is_finite() && now >= 0.0) {
                return (solves, false);
            }
            if solves == 1 {
                first = now;
            }
            // What this step leaves is less of it than the step before has left of the one before that.
            let shrinks = if solves > 1 { now / before } else { kept.shrinks };
            if solves == 2 {
                kept.shrinks = shrinks;
            }
            let is_known = solves > 1 || accuracy.is_checked;
            if now == 0.0 || (is_known && now * shrinks <= accuracy.relative.powi(2) * first) {
                free.iter_mut().zip(&*x).zip(&*z).for_each(|((free, x), z)| *free = x + z);
                kept.present += solves;
                return (solves, true);
            }
            if solves == 1 {
                p.copy_from_slice(z);
            } else {
                let beta = now / before;
                p.iter_mut().zip(&*z).for_each(|(p, z)| *p = z + beta * *p);
            }
            matrix.multiply(pattern, p, z);
            let curvature = dot(p, z);
            if curvature.is_nan() || curvature <= 0.0 {
                return (solves, false);
            }
            let alpha = now / curvature;
            x.iter_mut().zip(&*p).for_each(|(x, p)| *x += alpha * p);
            r.iter_mut().zip(&*z).for_each(|(r, z)| *r -= alpha * z);
            before = now;
        }
        (most, false)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Turns the vectors of nodes that are free to move anywhere, forth (1) or back (−1).
fn turn(pattern: &Pattern, rotations: &[Rotation], direction: f64, free: &mut [f64]) {
    for &(node, first) in pattern.free_nodes() {
        let (Some(r), Some([x, y])) = (rotations.get(node as usize), free.get_mut(first as usize..first as usize + 2))
        else {
            continue;
        };
        let s = direction * r.s;
        (*x, *y) = (r.c * *x - s * *y, s * *x + r.c * *y);
    }
}

/// The mean rotation of the elements around every node.
fn nodal_rotations(system: &System, state: &State, rotations: &mut Vec<Rotation>) {
    let (mesh, elements) = (system.mesh(), system.elements());
    rotations.clear();
    rotations.resize(mesh.nodes().len(), Rotation { c: 0.0, s: 0.0 });
    let points = elements.points_per_element();
    for (e, nodes) in mesh.elements().enumerate() {
        let own = (points * e..points * (e + 1)).map(|point| state.rotations[elements.rotation_of(point)]);
        let (c, s) = own.fold((0.0, 0.0), |(c, s), r| (c + r.c, s + r.s));
        for &node in nodes {
            let sum = &mut rotations[node as usize];
            (sum.c, sum.s) = (sum.c + c, sum.s + s);
        }
    }
    for r in rotations {
        let length = (r.c * r.c + r.s * r.s).sqrt();
        // Rotations that cancel have no mean.
        *r = if length > 0.0 { Rotation { c: r.c / length, s: r.s / length } } else { Rotation::IDENTITY };
    }
}
