//! Sparse factorizations with faer: analysed once, refactorized every iteration without allocating. No other file uses
//! faer.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, amd};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};
use thiserror::Error;

use crate::sentence::{Sentence, sentence};

pub(crate) mod lanczos;

/// Reason why a matrix could not be factorized.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[error("{}", Sentence::from(self))]
pub enum SolverError {
    /// The matrix is not positive definite, or not finite.
    NotPositiveDefinite,
    /// The factor does not fit in memory or in the index type.
    TooLarge,
}

impl From<&SolverError> for Sentence {
    fn from(error: &SolverError) -> Self {
        match error {
            SolverError::NotPositiveDefinite => sentence!("the stiffness matrix is not positive definite"),
            SolverError::TooLarge => sentence!("the factorization of this mesh does not fit in memory"),
        }
    }
}

/// Type of the current factorization.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FactorKind {
    /// L Lᵀ.
    PositiveDefinite,
    /// L B Lᵀ with B of 1×1 and 2×2 blocks.
    Indefinite,
}

/// Returns an order of elimination with few entries in the factor (AMD: Amestoy, Davis and Duff 1996) for the nodes of a
/// graph, each of which is given by its sorted neighbours. Ordering nodes instead of their two unknowns gives as few
/// entries and takes a quarter of the entries to read.
pub(crate) fn elimination_order(neighbours: &[Vec<u32>]) -> Vec<u32> {
    let n = neighbours.len();
    let mut column_starts = vec![0];
    let mut row_indices = Vec::new();
    for list in neighbours {
        row_indices.extend_from_slice(list);
        column_starts.push(row_indices.len() as u32);
    }
    let entries = row_indices.len();
    let graph = SymbolicSparseColMat::new_checked(n, n, column_starts, None, row_indices);
    let (mut order, mut places) = (vec![0; n], vec![0; n]);
    let memory = MemBuffer::try_new(amd::order_scratch::<u32>(n, entries));
    let ordered = memory.is_ok_and(|mut memory| {
        let memory = MemStack::new(&mut memory);
        amd::order(&mut order, &mut places, graph.as_ref(), amd::Control::default(), memory).is_ok()
    });
    // Any order is valid.
    if ordered { order } else { (0..n as u32).collect() }
}

/// Sparsity of the factors of a pattern. Computed once and shared: a clone copies a pointer.
#[derive(Clone)]
pub struct Symbolic(Arc<SymbolicAnalysis>);

struct SymbolicAnalysis {
    /// Lower triangle of the matrix.
    structure: SymbolicSparseColMat<usize>,
    /// Upper triangle of the matrix, which a simplicial factorization reads.
    upper: Option<UpperTriangle>,
    /// Sparsity of L Lᵀ; simplicial if that is faster.
    definite: SymbolicCholesky<usize>,
    /// Sparsity of L B Lᵀ, if it differs: simplicial factors do not pivot.
    indefinite: Option<SymbolicCholesky<usize>>,
    price: f64,
}

/// Upper triangle of a symmetric matrix.
struct UpperTriangle {
    structure: SymbolicSparseColMat<usize>,
    /// Index of every value in the values of the lower triangle.
    sources: Vec<u32>,
}

impl UpperTriangle {
    fn of(lower: &SymbolicSparseColMat<usize>) -> Result<Self, SolverError> {
        // The columns of the upper triangle are the rows of the lower one, in which faer keeps the order of the columns.
        let structure = lower.as_ref().transpose().to_col_major().map_err(|_| SolverError::TooLarge)?;
        let mut sources = vec![0; lower.row_idx().len()];
        let mut next = structure.col_ptr()[..structure.ncols()].to_vec();
        for (source, &row) in (0..).zip(lower.row_idx()) {
            sources[next[row]] = source;
            next[row] += 1;
        }
        Ok(Self { structure, sources })
    }
}

impl SymbolicAnalysis {
    fn symbolic(&self, kind: FactorKind) -> &SymbolicCholesky<usize> {
        match kind {
            FactorKind::PositiveDefinite => &self.definite,
            FactorKind::Indefinite => self.indefinite.as_ref().unwrap_or(&self.definite),
        }
    }
}

impl std::fmt::Debug for Symbolic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Symbolic").field("factor_entries", &self.0.definite.len_val()).finish_non_exhaustive()
    }
}

impl Symbolic {
    /// Analyses the lower triangle of a symmetric matrix, whose unknowns are eliminated in their order, in compressed
    /// columns with sorted rows: `column_starts` holds the start of each column and the end of the last, `row_indices` the
    /// row of every entry. The factor is simplicial up to 14 entries per unknown (`SPARSE`), supernodal beyond; faer's own
    /// choice is up to 2.6 times slower on these meshes.
    pub fn new(column_starts: &[usize], row_indices: &[usize]) -> Result<Self, SolverError> {
        let n = column_starts.len().saturating_sub(1);
        let structure = SymbolicSparseColMat::new_checked(n, n, column_starts.to_vec(), None, row_indices.to_vec());
        let upper = UpperTriangle::of(&structure)?;
        let cholesky = |threshold| symbolic_cholesky(&upper.structure, threshold);
        let supernodal = cholesky(SupernodalThreshold::FORCE_SUPERNODAL)?;
        let (definite, indefinite) = if n <= MAX_SIMPLICIAL {
            let simplicial = cholesky(SupernodalThreshold::FORCE_SIMPLICIAL)?;
            if simplicial.len_val() <= SPARSE * n { (simplicial, Some(supernodal)) } else { (supernodal, None) }
        } else {
            (supernodal, None)
        };
        let price = price(&definite);
        let upper = indefinite.is_some().then_some(upper);
        Ok(Self(Arc::new(SymbolicAnalysis { structure, upper, definite, indefinite, price })))
    }

    /// Returns the number of rows of the matrix.
    pub fn size(&self) -> usize {
        self.0.structure.ncols()
    }
}

/// Largest number of factor entries per unknown for which a simplicial factor is faster, factorization and solve
/// together. Measured on cantilevers: 6 to 22 % faster on three-node triangles (7 to 13.5 entries), 5 % on six-node
/// triangles (12.5); with 16 and more entries, from about two thousand unknowns on, 10 % slower and more.
const SPARSE: usize = 14;
/// Number of unknowns above which a simplicial factor is not tried, because it has more entries.
const MAX_SIMPLICIAL: usize = 2500;

/// Computes the sparsity of a factor of the matrix with this upper triangle; `threshold` forces it to be simplicial or
/// supernodal.
fn symbolic_cholesky(
    upper: &SymbolicSparseColMat<usize>,
    threshold: SupernodalThreshold,
) -> Result<SymbolicCholesky<usize>, SolverError> {
    let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold: threshold, ..Default::default() };
    let ordering = SymmetricOrdering::Identity;
    factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, ordering, params).map_err(|_| SolverError::TooLarge)
}

/// Returns the numbers of operations of a factorization and of a back substitution.
fn operations(symbolic: &SymbolicCholesky<usize>) -> [f64; 2] {
    let (mut factorization, mut substitution) = (0.0, 0.0);
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(simplicial) => {
            for column in simplicial.col_ptr().windows(2) {
                let entries = (column[1] - column[0]) as f64;
                factorization += entries * entries;
                substitution += 4.0 * entries;
            }
        }
        SymbolicCholeskyRaw::Supernodal(supernodal) => {
            let columns = supernodal.supernode_begin().iter().zip(supernodal.supernode_end());
            for ((begin, end), rows) in columns.zip(supernodal.col_ptr_for_row_idx().windows(2)) {
                let (width, below) = ((end - begin) as f64, (rows[1] - rows[0]) as f64);
                factorization += width * (width * width / 3.0 + width * below + below * below);
                substitution += 4.0 * width * (0.5 * width + below);
            }
        }
    }
    [factorization, substitution]
}

/// Computes [`Factor::price`] from the sparsity, not from measured times.
fn price(symbolic: &SymbolicCholesky<usize>) -> f64 {
    // `least`: fixed cost of a factorization, in multiples of the cost of a back substitution; `operation`: cost of an
    // operation of the factorization relative to one of a back substitution, which is limited by memory bandwidth.
    // Fitted to beams: simplicial with 100 to 1 200 unknowns, supernodal with 40 to 33 000.
    let (least, operation) = match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(_) => (4.2, 0.9),
        SymbolicCholeskyRaw::Supernodal(_) => (1.5, 0.25),
    };
    let [factorization, substitution] = operations(symbolic);
    if substitution > 0.0 { least + operation * factorization / substitution } else { least }
}

/// Factor of a symmetric matrix with a fixed pattern.
pub struct Factor {
    symbolic: Symbolic,
    values: Vec<f64>,
    /// Values of the matrix's upper triangle, for a simplicial factorization.
    upper: Vec<f64>,
    /// Data of the indefinite factor apart from L: B's subdiagonal, and pivots within supernodes.
    subdiagonal: Vec<f64>,
    pivots: Vec<usize>,
    inverse_pivots: Vec<usize>,
    kind: FactorKind,
    memory: MemBuffer,
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor").field("values", &self.values.len()).finish_non_exhaustive()
    }
}

impl Factor {
    /// Allocates memory for factors.
    pub fn new(symbolic: &Symbolic) -> Result<Self, SolverError> {
        let n = symbolic.size();
        let [definite, indefinite] =
            [FactorKind::PositiveDefinite, FactorKind::Indefinite].map(|kind| symbolic.0.symbolic(kind));
        let scratch = StackReq::any_of(&[
            definite.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
            indefinite.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Spec::default()),
            definite.solve_in_place_scratch::<f64>(1, Par::Seq),
            indefinite.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        let entries = definite.len_val().max(indefinite.len_val());
        let memory = MemBuffer::try_new(scratch).map_err(|_| SolverError::TooLarge)?;
        let mut values = Vec::new();
        values.try_reserve_exact(entries).map_err(|_| SolverError::TooLarge)?;
        values.resize(entries, 0.0);
        Ok(Self {
            symbolic: symbolic.clone(),
            values,
            upper: symbolic.0.upper.as_ref().map_or_else(Vec::new, |upper| vec![0.0; upper.sources.len()]),
            subdiagonal: vec![0.0; n],
            pivots: vec![0; n],
            inverse_pivots: vec![0; n],
            kind: FactorKind::PositiveDefinite,
            memory,
        })
    }

    /// Returns the approximate cost of a factorization in back substitutions; the same on every machine.
    pub fn price(&self) -> f64 {
        self.symbolic.0.price
    }

    /// Factorizes the positive definite matrix with these lower-triangle values, in the pattern's order. After a failure
    /// the factor is invalid until the next success.
    pub fn factorize(&mut self, matrix: &[f64]) -> Result<(), SolverError> {
        let analysis = &*self.symbolic.0;
        let (structure, matrix, side) = match &analysis.upper {
            Some(upper) => {
                self.upper.iter_mut().zip(&upper.sources).for_each(|(value, &source)| *value = matrix[source as usize]);
                (&upper.structure, &*self.upper, Side::Upper)
            }
            None => (&analysis.structure, matrix, Side::Lower),
        };
        self.kind = FactorKind::PositiveDefinite;
        let symbolic = analysis.symbolic(self.kind);
        let factorized = symbolic.factorize_numeric_llt(
            &mut self.values[..symbolic.len_val()],
            SparseColMatRef::new(structure.as_ref(), matrix),
            side,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        factorized.map(|_| ()).map_err(|_| SolverError::NotPositiveDefinite)
    }

    /// Factorizes a symmetric matrix, as positive definite if possible; returns `true` if it is positive definite.
    pub fn factorize_symmetric(&mut self, matrix: &[f64]) -> bool {
        let definite = self.factorize(matrix).is_ok();
        if !definite {
            self.factorize_indefinite(matrix);
        }
        definite
    }

    /// Factorizes a symmetric matrix that may be indefinite. A singular matrix gives solutions that are not finite.
    fn factorize_indefinite(&mut self, matrix: &[f64]) {
        let analysis = &*self.symbolic.0;
        let matrix = SparseColMatRef::new(analysis.structure.as_ref(), matrix);
        self.kind = FactorKind::Indefinite;
        let symbolic = analysis.symbolic(self.kind);
        symbolic.factorize_numeric_intranode_lblt(
            &mut self.values[..symbolic.len_val()],
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

    /// Returns the number of negative eigenvalues of the matrix of the last factor (Sylvester's law of inertia: those
    /// of B in L B Lᵀ).
    pub fn negative_eigenvalues(&self) -> usize {
        let symbolic = self.symbolic.0.symbolic(self.kind);
        let SymbolicCholeskyRaw::Supernodal(supernodal) = symbolic.raw() else { return 0 };
        if self.kind == FactorKind::PositiveDefinite {
            return 0;
        }
        let columns = supernodal.supernode_begin().iter().zip(supernodal.supernode_end());
        let rows = supernodal.col_ptr_for_row_idx().windows(2).map(|w| w[1] - w[0]);
        let mut negative = 0;
        for (((&begin, &end), below), &start) in columns.zip(rows).zip(supernodal.col_ptr_for_val()) {
            let width = end - begin;
            let diagonal = |i: usize| self.values[start + i * (width + below + 1)];
            let mut i = 0;
            while i < width {
                let coupling = self.subdiagonal[begin + i];
                if coupling == 0.0 {
                    negative += usize::from(diagonal(i) < 0.0);
                    i += 1;
                    continue;
                }
                let (a, b) = (diagonal(i), diagonal(i + 1));
                // A block with a negative determinant has one positive and one negative eigenvalue.
                negative += match a * b - coupling * coupling < 0.0 {
                    true => 1,
                    false => 2 * usize::from(a < 0.0),
                };
                i += 2;
            }
        }
        negative
    }

    /// Replaces `b` by the solution of the system with the last factor.
    pub fn solve_in_place(&mut self, b: &mut [f64]) {
        let rows = b.len();
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        let memory = MemStack::new(&mut self.memory);
        let symbolic = self.symbolic.0.symbolic(self.kind);
        let values = &self.values[..symbolic.len_val()];
        match self.kind {
            FactorKind::PositiveDefinite => {
                LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, b, Par::Seq, memory);
            }
            FactorKind::Indefinite => {
                let pivots = PermRef::new_checked(&self.pivots, &self.inverse_pivots, rows);
                IntranodeLbltRef::new(symbolic, values, &self.subdiagonal, pivots).solve_in_place_with_conj(
                    Conj::No,
                    b,
                    Par::Seq,
                    memory,
                );
            }
        }
    }
}
