//! Solution of the linear equations of a stage: from a residual force to a correction of the displacement.
//!
//! `auto` keeps the factor of an earlier matrix while it converges fast. The factor preconditions conjugate gradients
//! on the current matrix, rotated with the body: with Q the nodes' rotations since the factorization, Q L Lᵀ Qᵀ differs
//! from the matrix only by the bending and stretching of elements (the warp preconditioner of Courtecuisse, Allard,
//! Duriez and Cotin 2010, *Asynchronous preconditioners for efficient solving of non-linear deformations*).

use nalgebra::Vector2;

use crate::assembly::{LinearSystem, Pattern, System};
use crate::continuation::dot;
use crate::rotation::Rotation;
use crate::solver::SolverError;
use crate::state::State;

/// Range of the step length of conjugate gradients in which a kept factor is used. The step length is the ratio of the
/// factorized matrix to the current one in the search direction. In a wider range more stages keep their factor, but
/// stiff bodies then explode in long time steps, during which their stresses change much.
const SIMILAR: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Relative difference of inertia or stiffness that counts as rounding error.
const SAME: f64 = 1e-9;

/// Matrix over the free unknowns with a factor.
#[derive(Debug)]
pub(crate) struct Corrector {
    pub linear: LinearSystem,
    /// Weights of the factorized matrix, if it is constant.
    pub constant: Option<Weights>,
    kept: Kept,
}

/// Weights of mass and stiffness in a stage's matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Factor of the mass, 1/s².
    pub inertia: f64,
    /// Factor of the stiffness.
    pub stiffness: f64,
}

impl Weights {
    /// Returns `true` if both are equal up to rounding.
    pub fn are_about(&self, other: &Self) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs();
        close(self.inertia, other.inertia) && close(self.stiffness, other.stiffness)
    }
}

/// Required accuracy of a correction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// Norm of the error relative to that of the whole correction.
    pub relative: f64,
    /// `true` if the residual of the resulting state is computed later: the reduction observed in earlier steps with
    /// this factor may then be relied on.
    pub is_checked: bool,
}

/// Factor of an earlier matrix, and the convergence observed with it.
#[derive(Debug, Default)]
struct Kept {
    /// Weights of its matrix; `None` if there is no usable factor.
    weights: Option<Weights>,
    /// Rotation of every node at the factorization.
    then: Vec<Rotation>,
    /// Rotation of every node since the factorization.
    since: Vec<Rotation>,
    /// Number of stages solved with this factor (`stages`) and of their back substitutions (`solves`).
    stages: u32,
    solves: u32,
    /// Back substitutions of the last stage.
    last: u32,
    /// Back substitutions of the current stage so far.
    present: u32,
    /// Last observed ratio of the squared error norms after and before a step.
    shrinks: f64,
    vectors: [Vec<f64>; 4],
}

impl Corrector {
    pub fn new(system: &System) -> Result<Self, SolverError> {
        Ok(Self { linear: LinearSystem::new(system)?, constant: None, kept: Kept::default() })
    }

    /// Discards factors of equations that have changed.
    pub fn invalidate(&mut self) {
        self.constant = None;
        self.kept.weights = None;
    }

    /// Keeps the factor just computed for this state's matrix for later stages.
    pub fn keep(&mut self, weights: Weights, system: &System, state: &State) {
        let Kept { then, .. } = &mut self.kept;
        nodal_rotations(system, state, then);
        self.kept.weights = Some(weights);
        (self.kept.stages, self.kept.solves, self.kept.last, self.kept.present) = (0, 0, 0, 1);
        // A step with the factor of the matrix itself leaves no error.
        self.kept.shrinks = 0.0;
    }

    /// Begins a stage: adds the back substitutions of the previous one to the statistics.
    pub fn begin_stage(&mut self) {
        let Kept { stages, solves, last, present, .. } = &mut self.kept;
        if *present > 0 {
            *stages += 1;
            *solves += *present;
            (*last, *present) = (*present, 0);
        }
    }

    /// Returns `true` if the kept factor should be tried for a matrix with these weights.
    ///
    /// The cost per stage is minimal if a factor is given up once a stage costs more than the average of its stages,
    /// including the factorization.
    fn serves(&self, weights: Weights) -> bool {
        let Kept { weights: kept, stages, solves, last, .. } = &self.kept;
        let price = self.linear.factor.price() + f64::from(*solves);
        kept.is_some_and(|kept| kept.are_about(&weights)) && f64::from(*last) * f64::from(*stages) <= price
    }

    /// Solves for the correction under a residual force, to a relative accuracy in the norm of the matrix, with the kept
    /// factor. Returns the number of back substitutions, and `true` if the accuracy was reached; if not, there is no
    /// correction. If a guess of the correction, m, is given, the accuracy is relative to the remaining correction.
    ///
    /// Preconditioned conjugate gradients (Hestenes and Stiefel 1952); √(r·P⁻¹r) is used as the norm of the error. The
    /// last preconditioned residual is added without a further step length: with a good factor this is as good as
    /// another iteration.
    pub fn correct_with_kept(
        &mut self,
        force: &[Vector2<f64>],
        weights: Weights,
        accuracy: Accuracy,
        guess: Option<&[Vector2<f64>]>,
        system: &System,
        state: &State,
    ) -> (u32, bool) {
        if !self.serves(weights) {
            return (0, false);
        }
        let Self { linear: LinearSystem { matrix, factor, correction: free }, kept, .. } = self;
        let pattern = system.pattern();
        pattern.restrict(force, free);
        nodal_rotations(system, state, &mut kept.since);
        for (now, then) in kept.since.iter_mut().zip(&kept.then) {
            *now = Rotation { c: now.c * then.c + now.s * then.s, s: now.s * then.c - now.c * then.s };
        }
        let [x, r, z, p] = &mut kept.vectors;
        [&mut *x, r, z, p].into_iter().for_each(|v| v.resize(free.len(), 0.0));
        r.copy_from_slice(free);
        match guess {
            Some(guess) => {
                pattern.select(guess, x);
                matrix.multiply(pattern, x, z);
                r.iter_mut().zip(&*z).for_each(|(r, z)| *r -= z);
            }
            None => x.fill(0.0),
        }
        // With more back substitutions a new factor would be cheaper.
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
            // The previous step's ratio of errors is taken as an upper bound for this step.
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
            // The preconditioned residual is no measure of the error if the matrix has changed this much.
            if !SIMILAR.contains(&alpha) {
                return (solves, false);
            }
            x.iter_mut().zip(&*p).for_each(|(x, p)| *x += alpha * p);
            r.iter_mut().zip(&*z).for_each(|(r, z)| *r -= alpha * z);
            before = now;
        }
        (most, false)
    }
}

/// Rotates the vectors of nodes with two free components, forwards (1) or back (−1).
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

/// Computes the mean rotation of the elements around every node.
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
        // Rotations that cancel have no mean; the identity is used.
        *r = if length > 0.0 { Rotation { c: r.c / length, s: r.s / length } } else { Rotation::IDENTITY };
    }
}
