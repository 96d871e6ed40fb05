//! Sparse Cholesky with faer: analysed once, refactorized every frame without allocating. The only file that names
//! faer.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};
use thiserror::Error;

use crate::assembly::Pattern;

/// Why there is no factor.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SolverError {
    /// The matrix is not positive definite, or not finite.
    #[error("the stiffness matrix is not positive definite")]
    NotPositiveDefinite,
    /// The factor does not fit in memory or in the index type.
    #[error("the factor of this mesh does not fit in memory")]
    TooLarge,
}

/// A Cholesky factor of a symmetric positive definite matrix with a fixed pattern.
pub struct Cholesky {
    structure: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky").field("factor", &self.factor.len()).finish_non_exhaustive()
    }
}

impl Cholesky {
    /// Orders and analyses the pattern (AMD, supernodal: faer's automatic choice is up to 2.6 times slower on these
    /// meshes).
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(pattern: &Pattern) -> Result<Self, SolverError> {
        let (column_starts, row_indices) = (pattern.column_starts.clone(), pattern.row_indices.clone());
        let n = pattern.dofs();
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let structure = SymbolicSparseColMat::new_checked(n, n, column_starts, None, row_indices);
        let symbolic = factorize_symbolic_cholesky(structure.as_ref(), Side::Lower, SymmetricOrdering::Amd, params)
            .map_err(|_| SolverError::TooLarge)?;
        let scratch = StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        let memory = MemBuffer::try_new(scratch).map_err(|_| SolverError::TooLarge)?;
        let mut factor = Vec::new();
        factor.try_reserve_exact(symbolic.len_val()).map_err(|_| SolverError::TooLarge)?;
        factor.resize(symbolic.len_val(), 0.0);
        Ok(Self { structure, symbolic, factor, memory })
    }

    /// Factorizes the matrix with these lower-triangle values, in the pattern's order.
    ///
    /// # Errors
    /// [`SolverError::NotPositiveDefinite`]; the factor then is of no use until the next success.
    pub fn factorize(&mut self, values: &[f64]) -> Result<(), SolverError> {
        let matrix = SparseColMatRef::new(self.structure.as_ref(), &values[..self.structure.row_idx().len()]);
        let factorized = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        factorized.map(|_| ()).map_err(|_| SolverError::NotPositiveDefinite)
    }

    /// Replaces `b` by A⁻¹ b, with the last factor.
    pub fn solve_in_place(&mut self, b: &mut [f64]) {
        let rows = b.len();
        let factor = LltRef::new(&self.symbolic, &self.factor);
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        factor.solve_in_place_with_conj(Conj::No, b, Par::Seq, MemStack::new(&mut self.memory));
    }
}
