//! The linear equations of a stage: from a residual force to a correction of the displacement.

use crate::assembly::{Matrix, System};
use crate::solver::{Factor, SolverError};

/// A matrix over the free unknowns with its factor.
#[derive(Debug)]
pub(crate) struct Corrector {
    pub matrix: Matrix,
    pub factor: Factor,
    /// A vector over the free unknowns.
    pub free: Vec<f64>,
    /// What the factor is of, where that is a constant matrix.
    pub constant: Option<Constant>,
}

/// What the matrix of linear theory depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Constant {
    /// Factor of the mass, 1/s².
    pub inertia: f64,
    /// Factor of the stiffness.
    pub stiffness: f64,
}

impl Corrector {
    pub fn new(system: &System) -> Result<Self, SolverError> {
        Ok(Self {
            matrix: Matrix::new(system.pattern()),
            factor: Factor::new(system.symbolic())?,
            free: vec![0.0; system.dofs()],
            constant: None,
        })
    }

    /// Forgets a factor of equations that have changed.
    pub fn forget(&mut self) {
        self.constant = None;
    }
}
