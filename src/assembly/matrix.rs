//! The values of a sparse symmetric matrix.

use super::Pattern;

/// Values of a symmetric matrix over the free unknowns: the lower triangle, in the order of a [`Pattern`].
#[derive(Clone, Debug)]
pub struct Matrix {
    /// One slot longer than the pattern: what belongs to fixed unknowns is added there and never read.
    values: Vec<f64>,
}

impl Matrix {
    /// Zero.
    #[must_use]
    pub fn new(pattern: &Pattern) -> Self {
        Self { values: vec![0.0; pattern.entries() + 1] }
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// The stored values.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.values.len() - 1]
    }

    /// Where sums are made: slots are those of [`Pattern::slot`].
    pub(crate) fn slots(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// y = K x.
    pub fn multiply(&self, pattern: &Pattern, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (column, bounds) in pattern.column_starts().windows(2).enumerate() {
            let entries = bounds[0]..bounds[1];
            let mut sum = 0.0;
            for (&row, &value) in pattern.row_indices()[entries.clone()].iter().zip(&self.values[entries]) {
                sum += value * x[row];
                if row != column {
                    y[row] += value * x[column];
                }
            }
            y[column] += sum;
        }
    }
}
