//! The sparsity of the stiffness matrix over the free unknowns: found once, filled every frame.

use crate::mesh::Mesh;

/// Marks a held unknown.
const HELD: u32 = u32::MAX;

/// The lower triangle of a symmetric matrix over the free unknowns, in compressed columns with sorted rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// Start of each column in `row_indices`, and the end of the last.
    pub column_starts: Vec<usize>,
    /// Row of every entry.
    pub row_indices: Vec<usize>,
    /// The unknown (2 · node + axis) behind each free one.
    pub free: Vec<u32>,
    /// The free unknown of each unknown, or [`HELD`].
    free_of: Vec<u32>,
}

impl Pattern {
    /// The pattern of a mesh whose unknowns `held` (2 · node + axis) are eliminated. `groups` are nodes that are coupled
    /// though no element has them all.
    #[must_use]
    pub fn new(mesh: &Mesh, held: &[bool], groups: &[Vec<u32>]) -> Self {
        let mut free = Vec::new();
        let mut free_of = vec![HELD; held.len()];
        for ((unknown, held), slot) in (0..).zip(held).zip(&mut free_of) {
            if !held {
                *slot = free.len() as u32;
                free.push(unknown);
            }
        }
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); mesh.nodes.len()];
        for coupled in mesh.triangles().chain(groups.iter().map(Vec::as_slice)) {
            for &a in coupled {
                neighbours[a as usize].extend(coupled);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut column_starts = vec![0];
        let mut row_indices = Vec::new();
        for (column, &unknown) in free.iter().enumerate() {
            // Sorted neighbours have sorted unknowns, and these sorted free numbers.
            let rows = neighbours[unknown as usize / 2].iter().flat_map(|&n| [2 * n, 2 * n + 1]);
            let rows = rows.map(|unknown| free_of[unknown as usize]).filter(|&row| row != HELD);
            row_indices.extend(rows.map(|row| row as usize).filter(|&row| row >= column));
            column_starts.push(row_indices.len());
        }
        Self { column_starts, row_indices, free, free_of }
    }

    /// Number of free unknowns.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.free.len()
    }

    /// Number of stored entries.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.row_indices.len()
    }

    /// Whether an unknown (2 · node + axis) is held.
    #[must_use]
    pub fn is_held(&self, unknown: usize) -> bool {
        self.free_of[unknown] == HELD
    }

    /// y = K x for the symmetric matrix with these lower-triangle values.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (column, bounds) in self.column_starts.windows(2).enumerate() {
            let entries = bounds[0]..bounds[1];
            let mut sum = 0.0;
            for (&row, &value) in self.row_indices[entries.clone()].iter().zip(&values[entries]) {
                sum += value * x[row];
                if row != column {
                    y[row] += value * x[column];
                }
            }
            y[column] += sum;
        }
    }

    /// Where the entries of one element's matrix go: node blocks (a, b), b ≤ a, row by row; the four entries of a block,
    /// of a diagonal block the three of its lower triangle. Entries of held unknowns go to the slot after the last.
    pub(super) fn element_slots(&self, nodes: &[u32]) -> Vec<u32> {
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

    /// Where the entry of two unknowns (2 · node + axis) is; the slot after the last where one is held.
    pub(super) fn slot(&self, i: u32, j: u32) -> u32 {
        let (i, j) = (self.free_of[i as usize], self.free_of[j as usize]);
        if i == HELD || j == HELD {
            return self.entries() as u32;
        }
        let (row, column) = (i.max(j) as usize, i.min(j) as usize);
        let start = self.column_starts[column];
        let rows = &self.row_indices[start..self.column_starts[column + 1]];
        (start + rows.partition_point(|&r| r < row)) as u32
    }
}
