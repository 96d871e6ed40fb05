//! Values of a sparse symmetric matrix.

use std::sync::Arc;

use nalgebra::Matrix2;

use super::Pattern;
use super::pattern::DependentEntries;

/// Values of a symmetric matrix over the free unknowns: the lower triangle, in the order of a [`Pattern`].
#[derive(Clone, Debug)]
pub struct Matrix {
    /// One slot more than the pattern: entries of fixed unknowns are added there and never read. Then those of unknowns
    /// that depend on others.
    values: Vec<f64>,
    /// Number of entries of the pattern.
    entries: usize,
    dependent: Arc<DependentEntries>,
}

impl Matrix {
    /// Returns the zero matrix.
    pub fn new(pattern: &Pattern) -> Self {
        let (entries, dependent) = (pattern.row_indices.len(), pattern.dependent_entries.clone());
        Self { values: vec![0.0; entries + 1 + dependent.entries], entries, dependent }
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Returns the stored values.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.entries]
    }

    /// Sums values, indexed by slots as in [`Pattern::slot`].
    pub(crate) fn sum<T>(&mut self, add: impl FnOnce(&mut [f64]) -> T) -> T {
        let result = add(&mut self.values);
        for &(from, to, factor) in &self.dependent.terms {
            self.values[to as usize] += factor * self.values[self.entries + 1 + from as usize];
        }
        self.values[self.entries..].fill(0.0);
        result
    }

    /// Adds wᵢ wⱼ B for weighted nodes i, j at the slots of [`Pattern::block_slots`]; B is symmetric.
    pub(super) fn add_blocks(&mut self, slots: &[u32], weights: &[(u32, f64)], block: &Matrix2<f64>) {
        self.sum(|values| {
            let mut slots = slots.iter();
            let mut add = |value: f64| {
                if let Some(&slot) = slots.next() {
                    values[slot as usize] += value;
                }
            };
            for (i, &(_, a)) in weights.iter().enumerate() {
                for &(_, b) in &weights[..i] {
                    [block.m11, block.m12, block.m21, block.m22].into_iter().for_each(|v| add(v * a * b));
                }
                [block.m11, block.m21, block.m22].into_iter().for_each(|v| add(v * a * a));
            }
        });
    }

    /// Iterates over the diagonal.
    pub(crate) fn diagonal<'a>(&'a self, pattern: &'a Pattern) -> impl Iterator<Item = f64> + 'a {
        // Rows are sorted, so the diagonal is the first entry of every column of the lower triangle.
        pattern.column_starts[..pattern.dofs()].iter().map(|&start| self.values[start])
    }

    /// Computes y = K x.
    pub fn multiply(&self, pattern: &Pattern, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (column, bounds) in pattern.column_starts.windows(2).enumerate() {
            let entries = bounds[0]..bounds[1];
            let mut sum = 0.0;
            for (&row, &value) in pattern.row_indices[entries.clone()].iter().zip(&self.values[entries]) {
                sum += value * x[row];
                if row != column {
                    y[row] += value * x[column];
                }
            }
            y[column] += sum;
        }
    }
}
