//! Sparsity of the stiffness matrix over the free unknowns, computed once.

use nalgebra::Vector2;

use crate::displacement::Displacement;
use crate::mesh::Mesh;
use crate::solver::elimination_order;

/// Marker of a fixed unknown.
const FIXED: u32 = u32::MAX;

/// Lower triangle of a symmetric matrix over the free unknowns, in compressed columns with sorted rows.
///
/// An unknown is 2 · node + axis. Fixed unknowns are eliminated (in the article's beam, 24 unknowns become 20). The free
/// ones are numbered in the order in which the factorization eliminates them, so that it permutes neither matrix nor
/// vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    column_starts: Vec<usize>,
    row_indices: Vec<usize>,
    free: Vec<u32>,
    /// Free number of each unknown, or [`FIXED`].
    free_of: Vec<u32>,
    /// 1 for free components of nodal vectors, 0 for fixed ones.
    mask: Vec<Vector2<f64>>,
    /// Nodes with two free components, with the free number of the first.
    free_nodes: Vec<(u32, u32)>,
}

impl Pattern {
    /// Returns the pattern of a mesh whose unknowns `fixed` are eliminated. `groups` are sets of nodes that are coupled
    /// although no element contains all of them.
    pub(super) fn new(mesh: &Mesh, fixed: &[bool], groups: &[Vec<u32>]) -> Self {
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); mesh.nodes().len()];
        for coupled in mesh.elements().chain(groups.iter().map(Vec::as_slice)) {
            for &a in coupled {
                neighbours[a as usize].extend(coupled);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut free = Vec::new();
        let mut free_of = vec![FIXED; fixed.len()];
        for node in elimination_order(&neighbours) {
            for unknown in [2 * node, 2 * node + 1] {
                if !fixed[unknown as usize] {
                    free_of[unknown as usize] = free.len() as u32;
                    free.push(unknown);
                }
            }
        }
        let mut column_starts = vec![0];
        let mut row_indices = Vec::new();
        for (column, &unknown) in free.iter().enumerate() {
            let rows = neighbours[unknown as usize / 2].iter().flat_map(|&n| [2 * n, 2 * n + 1]);
            let rows = rows.map(|unknown| free_of[unknown as usize]).filter(|&row| row != FIXED);
            let start = row_indices.len();
            row_indices.extend(rows.map(|row| row as usize).filter(|&row| row >= column));
            row_indices[start..].sort_unstable();
            column_starts.push(row_indices.len());
        }
        let mask = fixed.chunks_exact(2).map(|f| Vector2::new(f[0], f[1]).map(|f| if f { 0.0 } else { 1.0 }));
        let pairs = (0..).zip(free_of.chunks_exact(2));
        let free_nodes = pairs.filter(|(_, pair)| !pair.contains(&FIXED)).map(|(node, pair)| (node, pair[0])).collect();
        Self { column_starts, row_indices, free, free_of, mask: mask.collect(), free_nodes }
    }

    /// Returns the number of free unknowns.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.free.len()
    }

    /// Returns the number of stored entries.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.row_indices.len()
    }

    /// Returns the start of each column in [`Self::row_indices`], and the end of the last.
    #[must_use]
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Returns the row of every entry.
    #[must_use]
    pub fn row_indices(&self) -> &[usize] {
        &self.row_indices
    }

    /// Returns the unknown (2 · node + axis) of each free number.
    #[must_use]
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// Returns 1 for free components of nodal vectors, 0 for fixed ones.
    #[must_use]
    pub fn mask(&self) -> &[Vector2<f64>] {
        &self.mask
    }

    /// Returns the nodes with two free components, with the free number of the first; the second has the next number.
    #[must_use]
    pub fn free_nodes(&self) -> &[(u32, u32)] {
        &self.free_nodes
    }

    /// Returns `true` for each component of a node, x and y, that is fixed.
    #[must_use]
    pub fn fixed(&self, node: u32) -> [bool; 2] {
        [0, 1].map(|axis| self.free_of.get(2 * node as usize + axis).is_none_or(|&f| f == FIXED))
    }

    /// Returns `true` if a displacement is zero at all fixed unknowns.
    #[must_use]
    pub fn are_fixed_at_rest(&self, u: &[Vector2<f64>]) -> bool {
        u.iter().zip(&self.mask).all(|(u, m)| (m.x > 0.0 || u.x == 0.0) && (m.y > 0.0 || u.y == 0.0))
    }

    /// Sets the fixed components of a nodal vector to zero.
    pub fn stop_fixed(&self, nodal: &mut [Vector2<f64>]) {
        nodal.iter_mut().zip(&self.mask).for_each(|(v, m)| v.component_mul_assign(m));
    }

    /// Copies a nodal vector's free components.
    pub fn restrict(&self, nodal: &[Vector2<f64>], free: &mut [f64]) {
        for (value, &unknown) in free.iter_mut().zip(&self.free) {
            *value = nodal[unknown as usize / 2][unknown as usize % 2];
        }
    }

    /// Adds `factor` times a vector over the free unknowns to a nodal vector. Fixed components do not change.
    pub fn add_free(&self, free: &[f64], factor: f64, nodal: &mut [Vector2<f64>]) {
        for (value, &unknown) in free.iter().zip(&self.free) {
            nodal[unknown as usize / 2][unknown as usize % 2] += factor * value;
        }
    }

    /// Adds `factor` times a vector over the free unknowns to the displacement, m. Fixed components do not change.
    pub(crate) fn advance(&self, free: &[f64], factor: f64, u: &mut Displacement) {
        for (value, &unknown) in free.iter().zip(&self.free) {
            u.advance(unknown as usize / 2, unknown as usize % 2, factor * value);
        }
    }

    /// Returns the dot product of a nodal vector and a vector over the free unknowns.
    #[must_use]
    pub fn dot(&self, nodal: &[Vector2<f64>], free: &[f64]) -> f64 {
        free.iter().zip(&self.free).map(|(value, &u)| value * nodal[u as usize / 2][u as usize % 2]).sum()
    }

    /// Returns the Euclidean norm of a nodal vector's free components, without overflow; not finite if one of them is
    /// not.
    #[must_use]
    pub fn norm(&self, nodal: &[Vector2<f64>]) -> f64 {
        let free = || nodal.iter().zip(&self.mask).map(|(v, m)| v.zip_map(m, |v, m| if m > 0.0 { v } else { 0.0 }));
        let squares = |scale: f64| free().map(|v| (v * scale).norm_squared()).sum::<f64>();
        let plain = squares(1.0);
        // Squares of ordinary numbers stay in range; other vectors are scaled first.
        if (1e-200..1e200).contains(&plain) || plain.is_nan() {
            return plain.sqrt();
        }
        let largest = free().map(|v| v.amax()).fold(0.0, f64::max);
        let scale = 1.0 / largest;
        if scale.is_normal() { largest * squares(scale).sqrt() } else { largest }
    }

    /// Returns the indices of the entries of one element's matrix: node blocks (a, b), b ≤ a, row by row; the four
    /// entries of a block, or the three of the lower triangle of a diagonal block.
    pub(super) fn block_slots(&self, nodes: &[u32]) -> Vec<u32> {
        let mut slots = Vec::with_capacity(nodes.len() * (2 * nodes.len() + 1));
        for (i, &a) in nodes.iter().enumerate() {
            for &b in &nodes[..i] {
                for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    slots.push(self.slot(2 * a + row, 2 * b + column));
                }
            }
            for (row, column) in [(0, 0), (1, 0), (1, 1)] {
                slots.push(self.slot(2 * a + row, 2 * a + column));
            }
        }
        slots
    }

    /// Returns the index of the entry of two unknowns; the extra index after the last if one of them is fixed.
    pub(super) fn slot(&self, i: u32, j: u32) -> u32 {
        let (i, j) = (self.free_of[i as usize], self.free_of[j as usize]);
        if i == FIXED || j == FIXED {
            return self.entries() as u32;
        }
        let (row, column) = (i.max(j) as usize, i.min(j) as usize);
        let start = self.column_starts[column];
        let rows = &self.row_indices[start..self.column_starts[column + 1]];
        (start + rows.partition_point(|&r| r < row)) as u32
    }
}
