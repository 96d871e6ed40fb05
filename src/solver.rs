//! Sparse factorizations with faer: analysed once, refactorized every iteration without allocating. The only file that
//! names faer.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};
use thiserror::Error;

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

/// Which factor is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// L Lᵀ.
    PositiveDefinite,
    /// L B Lᵀ with B of 1×1 and 2×2 blocks.
    Indefinite,
}

/// The order of elimination and the sparsity of the factors of a pattern. Made once and shared: a clone is a pointer.
#[derive(Clone)]
pub struct Symbolic(Arc<Analysis>);

struct Analysis {
    structure: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    price: f64,
}

impl std::fmt::Debug for Symbolic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Symbolic").field("factor_entries", &self.0.symbolic.len_val()).finish_non_exhaustive()
    }
}

impl Symbolic {
    /// Orders and analyses the lower triangle of a symmetric matrix, in compressed columns with sorted rows: the start
    /// of each column and the end of the last, and the row of every entry (AMD, supernodal: faer's automatic choice is
    /// up to 2.6 times slower on these meshes).
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(column_starts: &[usize], row_indices: &[usize]) -> Result<Self, SolverError> {
        let n = column_starts.len().saturating_sub(1);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let structure = SymbolicSparseColMat::new_checked(n, n, column_starts.to_vec(), None, row_indices.to_vec());
        let symbolic = factorize_symbolic_cholesky(structure.as_ref(), Side::Lower, SymmetricOrdering::Amd, params)
            .map_err(|_| SolverError::TooLarge)?;
        let price = price(&symbolic);
        Ok(Self(Arc::new(Analysis { structure, symbolic, price })))
    }

    /// Rows of the matrix.
    #[must_use]
    pub fn size(&self) -> usize {
        self.0.structure.ncols()
    }
}

/// See [`Factor::price`]: from the operations that the sparsity says, not from a clock.
fn price(symbolic: &SymbolicCholesky<usize>) -> f64 {
    /// What small fronts take, and …
    const LEAST: f64 = 1.5;
    /// … operations of a factorization in the time of one of a back substitution, which waits for memory: both fitted to
    /// beams of 40 to 33 000 unknowns.
    const FASTER: f64 = 4.0;
    let SymbolicCholeskyRaw::Supernodal(supernodal) = symbolic.raw() else { return LEAST };
    let (mut factorization, mut substitution) = (0.0, 0.0);
    let columns = supernodal.supernode_begin().iter().zip(supernodal.supernode_end());
    for ((begin, end), rows) in columns.zip(supernodal.col_ptr_for_row_idx().windows(2)) {
        let (width, below) = ((end - begin) as f64, (rows[1] - rows[0]) as f64);
        factorization += width * (width * width / 3.0 + width * below + below * below);
        substitution += 4.0 * width * (0.5 * width + below);
    }
    if substitution > 0.0 { LEAST + factorization / (FASTER * substitution) } else { LEAST }
}

/// A factor of a symmetric matrix with a fixed pattern.
pub struct Factor {
    symbolic: Symbolic,
    values: Vec<f64>,
    /// What the indefinite factor has beside L: B's subdiagonal, and pivots within supernodes.
    subdiagonal: Vec<f64>,
    pivots: Vec<usize>,
    inverse_pivots: Vec<usize>,
    kind: Kind,
    memory: MemBuffer,
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor").field("values", &self.values.len()).finish_non_exhaustive()
    }
}

impl Factor {
    /// Makes room for factors.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(symbolic: &Symbolic) -> Result<Self, SolverError> {
        let n = symbolic.size();
        let analysis = &symbolic.0.symbolic;
        let scratch = StackReq::any_of(&[
            analysis.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
            analysis.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Spec::default()),
            analysis.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        let memory = MemBuffer::try_new(scratch).map_err(|_| SolverError::TooLarge)?;
        let mut values = Vec::new();
        values.try_reserve_exact(analysis.len_val()).map_err(|_| SolverError::TooLarge)?;
        values.resize(analysis.len_val(), 0.0);
        Ok(Self {
            symbolic: symbolic.clone(),
            values,
            subdiagonal: vec![0.0; n],
            pivots: vec![0; n],
            inverse_pivots: vec![0; n],
            kind: Kind::PositiveDefinite,
            memory,
        })
    }

    /// About how many back substitutions take as long as a factorization; the same on every machine.
    #[must_use]
    pub fn price(&self) -> f64 {
        self.symbolic.0.price
    }

    /// Factorizes the positive definite matrix with these lower-triangle values, in the pattern's order.
    ///
    /// # Errors
    /// [`SolverError::NotPositiveDefinite`]; the factor then is of no use until the next success.
    pub fn factorize(&mut self, matrix: &[f64]) -> Result<(), SolverError> {
        let Analysis { structure, symbolic, .. } = &*self.symbolic.0;
        let matrix = SparseColMatRef::new(structure.as_ref(), matrix);
        self.kind = Kind::PositiveDefinite;
        let factorized = symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        factorized.map(|_| ()).map_err(|_| SolverError::NotPositiveDefinite)
    }

    /// Factorizes a symmetric matrix, as positive definite if it is that; says whether it is.
    pub fn factorize_symmetric(&mut self, matrix: &[f64]) -> bool {
        let definite = self.factorize(matrix).is_ok();
        if !definite {
            self.factorize_indefinite(matrix);
        }
        definite
    }

    /// Factorizes a symmetric matrix that need not be definite. One that is singular gives solutions that are not
    /// finite.
    fn factorize_indefinite(&mut self, matrix: &[f64]) {
        let Analysis { structure, symbolic, .. } = &*self.symbolic.0;
        let matrix = SparseColMatRef::new(structure.as_ref(), matrix);
        self.kind = Kind::Indefinite;
        symbolic.factorize_numeric_intranode_lblt(
            &mut self.values,
            &mut self.subdiagonal,
            &mut self.pivots,
            &mut self.inverse_pivots,
            matrix,
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
    }

    /// Replaces `b` by the solution of the system with the last factor.
    pub fn solve_in_place(&mut self, b: &mut [f64]) {
        let rows = b.len();
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        let memory = MemStack::new(&mut self.memory);
        let symbolic = &self.symbolic.0.symbolic;
        match self.kind {
            Kind::PositiveDefinite => {
                LltRef::new(symbolic, &self.values).solve_in_place_with_conj(Conj::No, b, Par::Seq, memory);
            }
            Kind::Indefinite => {
                let pivots = PermRef::new_checked(&self.pivots, &self.inverse_pivots, rows);
                IntranodeLbltRef::new(symbolic, &self.values, &self.subdiagonal, pivots).solve_in_place_with_conj(
                    Conj::No,
                    b,
                    Par::Seq,
                    memory,
                );
            }
        }
    }
}
