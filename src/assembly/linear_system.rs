//! The linear equations of a step over the free unknowns.

use nalgebra::Vector2;
use thiserror::Error;

use super::{Matrix, Pattern, System};
use crate::displacement::Displacement;
use crate::sentence::{Sentence, sentence};
use crate::solver::{Factor, SolverError};
use crate::timings::{Timings, timed};

/// Reason why an iteration produced no new state.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum IterationError {
    /// The factorization failed.
    Solver(#[from] SolverError),
    /// The solution is not finite.
    NotFinite,
}

impl From<&IterationError> for Sentence {
    fn from(error: &IterationError) -> Self {
        match error {
            IterationError::Solver(error) => error.into(),
            IterationError::NotFinite => sentence!("the solution is not a finite number: reduce the load"),
        }
    }
}

/// A d = f over the free unknowns, of iterations and of time steps.
#[derive(Debug)]
pub struct LinearSystem {
    /// A.
    pub(crate) matrix: Matrix,
    /// Factor of the last factorized matrix.
    pub(crate) factor: Factor,
    /// d, m.
    pub(crate) correction: Vec<f64>,
}

impl LinearSystem {
    /// Allocates the memory.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub(crate) fn new(system: &System) -> Result<Self, SolverError> {
        let factor = Factor::new(system.symbolic()?)?;
        Ok(Self { matrix: Matrix::new(system.pattern()), factor, correction: vec![0.0; system.dofs()] })
    }

    /// Factorizes A, which must be positive definite: A = L Lᵀ.
    pub(crate) fn factorize(&mut self, timings: &mut Timings) -> Result<(), SolverError> {
        let Self { matrix, factor, .. } = self;
        timed(&mut timings.factorize, || factor.factorize(matrix.values()))
    }

    /// Factorizes A, which may be indefinite; returns `true` if it is positive definite.
    pub(crate) fn factorize_symmetric(&mut self, timings: &mut Timings) -> bool {
        let Self { matrix, factor, .. } = self;
        timed(&mut timings.factorize, || factor.factorize_symmetric(matrix.values()))
    }

    /// Solves A d = f for a nodal force with the last factor.
    pub(crate) fn solve(
        &mut self,
        pattern: &Pattern,
        force: &[Vector2<f64>],
        timings: &mut Timings,
    ) -> Result<(), IterationError> {
        let Self { factor, correction, .. } = self;
        timed(&mut timings.solve, || {
            pattern.restrict(force, correction);
            factor.solve_in_place(correction);
            if correction.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(IterationError::NotFinite) }
        })
    }

    /// Performs u ← u + d.
    pub(crate) fn advance(&self, pattern: &Pattern, u: &mut Displacement, timings: &mut Timings) {
        timed(&mut timings.advance, || pattern.advance(&self.correction, 1.0, u));
    }
}
