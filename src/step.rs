//! The step of the warped stiffness method, which a frame repeats until the forces balance (Müller and Gross 2004).
//!
//! An element maps its nodes from X to x with the gradient F = R S (eqs. 37 to 39 of the article), R a rotation and S
//! the stretch. S − I is the strain, so that a rotation costs no energy. Rotated back by R, the element is one of linear
//! theory (eq. 3) with the stiffness Ke; rotated forward again, its force is R Ke (Rᵀ x − X). With A = Σ R Ke Rᵀ,
//! equilibrium is A x = f_ext + Σ R Ke X (eq. 2). `Iteration::step` moves A x to the right-hand side, where
//! f_int = A x − Σ R Ke X:
//!
//! ```text
//! factorize   A = L Lᵀ                                                    faer
//! solve       A d = f_ext − f_int                                         faer
//! advance     u ← u + d, with u = x − X
//! linearize   F = R S,  f_int = Σ R Ke (Rᵀ x − X),  A = Σ R Ke Rᵀ         in one loop over the elements
//! ```
//!
//! Fixed unknowns have d = 0, so that eliminating them leaves no other term (24 → 20 → 24 in the article), and a small d
//! keeps its digits next to a large x. The linearization is last, so that a state is always shown with its own forces;
//! the next step begins with its matrix.
//!
//! The [methods](crate::method) decide which matrix is factorized, under which part of the load, and when the state is
//! the result. A time step of a motion has stages of its own, which share [`LinearSystem`] and [`Problem::linearize`].

use nalgebra::{Matrix2, Vector2};

use crate::assembly::{Forces, IterationError, Kinematics, LinearSystem, Matrix, Problem, System};
use crate::element::{PointStress, Rotations, Tangent, warped_strain};
use crate::material::Lame;
use crate::rotation::Rotation;
use crate::simd::{LANES, Lanes, product};
use crate::solver::{Factor, SolverError};
use crate::state::State;
use crate::timings::{Timings, timed};

/// Data that a step reads and changes.
#[derive(Debug)]
pub struct Iteration<'a> {
    /// Problem to solve.
    pub problem: &'a Problem,
    /// Displacement u and rotations R.
    pub state: &'a mut State,
    /// f_ext, f_int and their difference, of the state.
    pub forces: &'a mut Forces,
    /// Matrix, factor and correction.
    pub workspace: &'a mut Workspace,
    /// Measured times.
    pub timings: &'a mut Timings,
}

/// Work memory of iterations, allocated once per system.
#[derive(Debug)]
pub struct Workspace {
    /// A, its factor, and the correction d.
    pub(crate) linear: LinearSystem,
    /// Kind of tangent in the matrix, if it is one of the current state at the current load.
    pub(crate) tangent: Option<Tangent>,
    /// Nodal vector.
    pub(crate) nodal: Vec<Vector2<f64>>,
    /// State for trials.
    pub(crate) trial: State,
    /// Forces of trials.
    pub(crate) trial_forces: Forces,
    /// Factor for checks of a result, allocated on first use.
    pub(crate) check_factor: Option<Factor>,
}

impl Workspace {
    /// Allocates the memory.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(system: &System) -> Result<Self, SolverError> {
        let nodes = system.mesh().nodes().len();
        Ok(Self {
            linear: LinearSystem::new(system)?,
            tangent: None,
            nodal: vec![Vector2::zeros(); nodes],
            trial: system.at_rest(),
            trial_forces: Forces::new(nodes),
            check_factor: None,
        })
    }
}

/// Operations of a step, in their order. A step may begin at any of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Operation {
    /// Factorizes the matrix, which must be positive definite.
    Factorize,
    /// Factorizes the matrix, which may be indefinite.
    FactorizeIndefinite,
    /// Solves with the last factor.
    Solve,
    /// Adds the correction that the workspace already holds.
    Advance,
    /// Linearizes a state that has been replaced.
    Linearize,
}

/// Rotations with which a state is linearized.
#[derive(Clone, Copy, Debug)]
pub enum RotationUpdate<'a> {
    /// New rotations: the polar factors of the displacement's gradients.
    Follow,
    /// The rotations that the state already has.
    Keep,
    /// New rotations, but in G the trace of strain of this state, at its rotations.
    FollowStressed(&'a State),
}

/// Strain, matrix and load of a linearization.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization {
    /// Strain measure.
    pub kinematics: Kinematics,
    /// Matrix to compute with the forces; `None` if the next step needs none, or is not known.
    pub tangent: Option<Tangent>,
    /// Fraction of the load.
    pub load_factor: f64,
}

impl Linearization {
    /// Returns a linearization of large rotations.
    pub(crate) fn corotated(tangent: Tangent, load_factor: f64) -> Self {
        Self { kinematics: Kinematics::Corotated, tangent: Some(tangent), load_factor }
    }
}

impl Iteration<'_> {
    /// Performs a step, u ← u + A⁻¹ (f_ext − f_int), from its operation `first` on, and linearizes the new state.
    ///
    /// # Errors
    /// The matrix could not be factorized, or the solution is not finite.
    pub(crate) fn step(&mut self, first: Operation, wanted: Linearization) -> Result<(), IterationError> {
        match first {
            Operation::Factorize => self.factorize()?,
            Operation::FactorizeIndefinite => _ = self.factorize_symmetric(),
            Operation::Solve | Operation::Advance | Operation::Linearize => {}
        }
        if first <= Operation::Solve {
            self.solve()?;
        }
        if first <= Operation::Advance {
            let pattern = self.problem.system().pattern();
            self.workspace.linear.advance(pattern, &mut self.state.displacement, self.timings);
        }
        self.linearize(RotationUpdate::Follow, wanted);
        if self.forces.relative_residual.is_finite() { Ok(()) } else { Err(IterationError::NotFinite) }
    }

    /// See [`LinearSystem::factorize`].
    pub(crate) fn factorize(&mut self) -> Result<(), SolverError> {
        self.workspace.linear.factorize(self.timings)
    }

    /// See [`LinearSystem::factorize_symmetric`].
    pub(crate) fn factorize_symmetric(&mut self) -> bool {
        self.workspace.linear.factorize_symmetric(self.timings)
    }

    /// Solves A d = f_ext − f_int with the last factor.
    pub(crate) fn solve(&mut self) -> Result<(), IterationError> {
        let pattern = self.problem.system().pattern();
        self.workspace.linear.solve(pattern, self.forces.residual(), self.timings)
    }

    /// Computes the rotations R, if they follow the displacement, f_int = Σ R Ke (Rᵀ x − X), A = Σ R Ke Rᵀ, f_ext and the
    /// relative residual.
    pub(crate) fn linearize(&mut self, rotations: RotationUpdate<'_>, wanted: Linearization) {
        let Self { problem, state, forces, workspace, timings } = self;
        let Linearization { kinematics, tangent, load_factor } = wanted;
        let matrix = &mut workspace.linear.matrix;
        timed(&mut timings.linearize, || {
            let sum = tangent.map(|tangent| (tangent, &mut *matrix));
            match rotations {
                RotationUpdate::Follow => problem.update_and_linearize(state, kinematics, forces, sum),
                RotationUpdate::Keep => problem.linearize(state, forces, sum),
                RotationUpdate::FollowStressed(other) => problem.linearize_stressed(state, other, forces, sum),
            }
            if let Some(tangent) = tangent {
                problem.add_load_stiffness(state, tangent, load_factor, matrix);
            }
            problem.balance(state, kinematics, load_factor, forces);
        });
        // Without a tangent the matrix is one of an earlier state; with the strain of another state it is none of this one.
        workspace.tangent = tangent.filter(|_| !matches!(rotations, RotationUpdate::FollowStressed(_)));
    }
}

impl Problem {
    /// Computes f_int at the rotations of a state, its magnitude, and, if requested, a tangent of the elements over the
    /// free unknowns. The force is computed from the strain, so that it vanishes exactly at rest.
    pub fn linearize(&self, state: &State, forces: &mut Forces, tangent: Option<(Tangent, &mut Matrix)>) {
        self.sum(forces, tangent, |elements, lame, sums| {
            let rotations = Rotations::Given(&state.rotations);
            elements.sweep(lame, state.compensated(), warped_stress(lame, rotations), sums);
        });
    }

    /// Performs [`System::update_rotations`] and [`Self::linearize`] in the same loop, for a state with a new
    /// displacement.
    pub fn update_and_linearize(
        &self,
        state: &mut State,
        kinematics: Kinematics,
        forces: &mut Forces,
        tangent: Option<(Tangent, &mut Matrix)>,
    ) {
        self.system().rotate_edges(state, kinematics);
        let State { displacement: u, rotations, .. } = state;
        let rotations = match kinematics {
            Kinematics::Corotated => Rotations::Follow(rotations),
            Kinematics::Linear => {
                rotations.fill(Rotation::IDENTITY);
                Rotations::Given(rotations)
            }
        };
        self.sum(forces, tangent, |elements, lame, sums| {
            elements.sweep(lame, u.view(), warped_stress(lame, rotations), sums);
        });
    }

    /// Performs [`Self::update_and_linearize`] of large rotations with the trace of strain of another state in G.
    ///
    /// A step along tangents stretches what it rotates, to second order. In a slender body this stretch is far larger than
    /// that of the loads, and with it G would hide the bending stiffness. With the stress before the step, then to first
    /// order after each correction, Newton's method converges in long steps, however slender the body (Magisano, Leonetti
    /// and Garcea 2017).
    fn linearize_stressed(
        &self,
        state: &mut State,
        stressed: &State,
        forces: &mut Forces,
        tangent: Option<(Tangent, &mut Matrix)>,
    ) {
        let (elements, State { displacement: u, rotations, .. }) = (self.system().elements(), stressed);
        let mut traces = vec![0.0; rotations.len()];
        // The trace of points with the same rotation is their mean.
        let share = rotations.len() as f64 / elements.point_count() as f64;
        elements.visit_strains(self.material().lame(), u, rotations, &mut |point, _, strain| {
            traces[elements.rotation_of(point)] += share * strain.trace();
        });
        self.system().rotate_edges(state, Kinematics::Corotated);
        let State { displacement: u, rotations, .. } = state;
        self.sum(forces, tangent, |elements, lame, sums| {
            let mut stress = warped_stress(lame, Rotations::Follow(rotations));
            let trace = |points: [usize; LANES]| points.map(|point| traces[point]).into();
            let look = |points: [usize; LANES], h: &_| PointStress { trace: trace(points), ..stress(points, h) };
            elements.sweep(lame, u.view(), look, sums);
        });
    }
}

/// Returns the function of a quadrature point with H = F − I, in four elements at once. From its result the loop over
/// the elements (`sweep` of their type) adds Σ R T ∇N, which is Σ R Ke (Rᵀ x − X), and Σ R Ke Rᵀ (`ElementMatrix::add`).
#[inline(always)]
pub(crate) fn warped_stress(
    lame: Lame,
    mut rotations: Rotations<'_>,
) -> impl FnMut([usize; LANES], &Matrix2<Lanes>) -> PointStress {
    move |points, h| {
        let rotation = rotations.evaluate(points, h); // F = R S, the polar decomposition
        let strain = warped_strain(rotation, h); // S − I = Rᵀ F − I
        let stress = product(&rotation.matrix(), &lame.stress(&strain)); // R T
        PointStress { rotation, trace: strain.m11 + strain.m22, stress }
    }
}
