//! Sparsity of the stiffness matrix over the free unknowns, computed once.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Vector2};

use super::held_points::HeldPoints;
use crate::displacement::Displacement;
use crate::mesh::Mesh;
use crate::solver::elimination_order;

/// Marker of a fixed unknown.
const FIXED: u32 = u32::MAX;

/// Lower triangle of a symmetric matrix over the free unknowns, in compressed columns with sorted rows.
///
/// An unknown is 2 · node + axis. Fixed unknowns are eliminated (in the article's beam, 24 unknowns become 20), and so
/// are those that depend on others because a point between nodes is held: u = T u_free + constant, the matrix over the
/// free unknowns is Tᵀ K T, and forces on them are Tᵀ f. The free ones are numbered in the order in which the
/// factorization eliminates them, so that it permutes neither matrix nor vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Start of each column in [`Self::row_indices`], and the end of the last.
    pub column_starts: Vec<usize>,
    /// Row of every entry.
    pub row_indices: Vec<usize>,
    /// Unknown (2 · node + axis) of each free number.
    pub free: Vec<u32>,
    /// Free number of each unknown, or [`FIXED`].
    free_of: Vec<u32>,
    /// 1 for free components of nodal vectors, 0 for fixed ones.
    pub mask: Vec<Vector2<f64>>,
    /// Nodes with two free components, with the free number of the first.
    free_nodes: Vec<(u32, u32)>,
    /// Rows of T: unknowns that depend on free ones, with the free numbers and coefficients.
    dependent: Vec<(u32, Vec<(u32, f64)>)>,
    pub(super) dependent_entries: Arc<DependentEntries>,
    /// Indices in [`DependentEntries`] of pairs of unknowns, smaller first.
    dependent_slots: BTreeMap<(u32, u32), u32>,
}

/// Entries of the matrix in rows or columns of dependent unknowns, with their contribution to Tᵀ K T.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DependentEntries {
    /// Number of entries; they are summed beside those of the free unknowns.
    pub entries: usize,
    /// Entry, slot of the free unknowns to which it contributes, coefficient.
    pub terms: Vec<(u32, u32, f64)>,
}

impl Pattern {
    /// Returns the pattern of a mesh whose unknowns `fixed` are eliminated, and those that depend on others because
    /// points are held. `groups` are sets of nodes that are coupled although no element contains all of them.
    pub(super) fn new(mesh: &Mesh, fixed: &[bool], held: &HeldPoints, groups: &[Vec<u32>]) -> Self {
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); mesh.nodes().len()];
        for coupled in mesh.elements().chain(groups.iter().map(Vec::as_slice)) {
            for &a in coupled {
                neighbours[a as usize].extend(coupled);
            }
        }
        let sort = |neighbours: &mut Vec<Vec<u32>>| {
            for list in neighbours {
                list.sort_unstable();
                list.dedup();
            }
        };
        sort(&mut neighbours);
        let beside: Vec<Vec<u32>> =
            held.dependent.iter().map(|dependent| neighbours[dependent.unknown as usize / 2].clone()).collect();
        // T couples the nodes on which an unknown depends with its neighbours.
        for beside in &beside {
            let rows = held.dependent.iter().filter(|other| beside.contains(&(other.unknown / 2)));
            let on = rows.flat_map(|other| other.on.terms.keys().map(|unknown| unknown / 2));
            let all: Vec<u32> = beside.iter().copied().chain(on).collect();
            for &a in &all {
                neighbours[a as usize].extend(&all);
            }
        }
        sort(&mut neighbours);
        let mut fixed = fixed.to_vec();
        held.dependent.iter().for_each(|dependent| fixed[dependent.unknown as usize] = true);
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
        let (dependent, dependent_entries) = (Vec::new(), Arc::default());
        let mut pattern = Self {
            column_starts,
            row_indices,
            free,
            free_of,
            mask: mask.collect(),
            free_nodes,
            dependent,
            dependent_entries,
            dependent_slots: BTreeMap::new(),
        };
        pattern.set_dependent(held, &beside);
        pattern
    }

    /// Sets T, and the entries of the matrix that T brings to the free unknowns; `beside` are the neighbours of the node of
    /// each dependent unknown.
    fn set_dependent(&mut self, held: &HeldPoints, beside: &[Vec<u32>]) {
        for dependent in &held.dependent {
            let on = dependent.on.terms.iter().map(|(&unknown, &c)| (self.free_of[unknown as usize], c));
            self.dependent.push((dependent.unknown, on.filter(|(free, _)| *free != FIXED).collect()));
        }
        let row = |unknown: u32| -> Vec<(u32, f64)> {
            match (self.free_of[unknown as usize], self.dependent.iter().find(|(own, _)| *own == unknown)) {
                (_, Some((_, row))) => row.clone(),
                (FIXED, None) => Vec::new(),
                (free, None) => vec![(free, 1.0)],
            }
        };
        let (mut slots, mut terms) = (BTreeMap::new(), Vec::new());
        for ((unknown, _), beside) in self.dependent.iter().zip(beside) {
            for other in beside.iter().flat_map(|node| [2 * node, 2 * node + 1]) {
                let pair = (*unknown.min(&other), *unknown.max(&other));
                let entry = slots.len() as u32;
                if slots.contains_key(&pair) || row(other).is_empty() {
                    continue;
                }
                slots.insert(pair, entry);
                // K_ij u_i u_j + K_ji u_j u_i, one term if i = j, in terms of the free unknowns; an entry off the diagonal
                // stands for two terms there as well.
                let half = if pair.0 == pair.1 { 0.5 } else { 1.0 };
                for (a, c) in row(pair.0) {
                    for &(b, d) in &row(pair.1) {
                        let factor = if a == b { 2.0 * half } else { half };
                        terms.push((entry, self.free_slot(a, b), factor * c * d));
                    }
                }
            }
        }
        self.dependent_entries = Arc::new(DependentEntries { entries: slots.len(), terms });
        self.dependent_slots = slots;
    }

    /// Returns the number of free unknowns.
    pub fn dofs(&self) -> usize {
        self.free.len()
    }

    /// Returns the nodes with two free components, with the free number of the first; the second has the next number.
    pub fn free_nodes(&self) -> &[(u32, u32)] {
        &self.free_nodes
    }

    /// Returns `true` for each component of a node, x and y, that is fixed; `false` for those that depend on others.
    pub fn fixed(&self, node: u32) -> [bool; 2] {
        [0, 1].map(|axis| {
            let unknown = 2 * node + axis;
            let is_free = self.free_of.get(unknown as usize).is_some_and(|&free| free != FIXED);
            !is_free && self.dependent.iter().all(|(own, _)| *own != unknown)
        })
    }

    /// Iterates over the dependent unknowns, with their value for a nodal displacement whose fixed components are zero.
    fn dependent_values<'a>(&'a self, u: &'a [Vector2<f64>]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let value = |free: u32| component(u, self.free[free as usize]);
        self.dependent.iter().map(move |(unknown, row)| (*unknown, row.iter().map(|&(free, c)| c * value(free)).sum()))
    }

    /// Returns `true` if a displacement is zero at all fixed unknowns and held points.
    pub fn are_fixed_at_rest(&self, u: &[Vector2<f64>]) -> bool {
        /// Rounding error relative to the displacement.
        const ROUNDING: f64 = 1e-9;
        let is_dependent = |unknown| self.dependent.iter().any(|(own, _)| *own == unknown);
        let is_zero = |unknown: u32| {
            self.free_of[unknown as usize] != FIXED || component(u, unknown) == 0.0 || is_dependent(unknown)
        };
        let largest = || u.iter().map(|u| u.amax()).fold(0.0, f64::max);
        (0..self.free_of.len().min(2 * u.len()) as u32).all(is_zero)
            && self
                .dependent_values(u)
                .all(|(unknown, value)| (component(u, unknown) - value).abs() <= ROUNDING * largest())
    }

    /// Sets the fixed components of a nodal velocity to zero, and the dependent ones so that held points rest.
    pub fn stop_fixed(&self, nodal: &mut [Vector2<f64>]) {
        nodal.iter_mut().zip(&self.mask).for_each(|(v, m)| v.component_mul_assign(m));
        let values: Vec<(u32, f64)> = self.dependent_values(nodal).collect();
        for (unknown, value) in values {
            nodal[unknown as usize / 2][unknown as usize % 2] = value;
        }
    }

    /// Sets the fixed components of a nodal velocity to zero, and changes the others by the impulses of held points that
    /// stop them: M⁻¹ Cᵀ (C M⁻¹ Cᵀ)⁻¹ C v is subtracted, C v the velocities of the points, M the masses `lumped` at the
    /// nodes.
    pub(crate) fn stop_fixed_by_impulses(&self, velocity: &mut [Vector2<f64>], lumped: &[f64]) {
        let moves: Vec<f64> = self.dependent.iter().map(|(unknown, _)| component(velocity, *unknown)).collect();
        velocity.iter_mut().zip(&self.mask).for_each(|(v, m)| v.component_mul_assign(m));
        if moves.is_empty() {
            return;
        }
        let mass = |unknown: u32| lumped[unknown as usize / 2];
        let held = moves.iter().zip(self.dependent_values(velocity)).map(|(v, (_, value))| v - value);
        let held = DVector::from_iterator(moves.len(), held);
        let count = held.len();
        let mobility = DMatrix::from_fn(count, count, |i, j| {
            let [(unknown, a), (_, b)] = [&self.dependent[i], &self.dependent[j]];
            let own = if i == j { 1.0 / mass(*unknown) } else { 0.0 };
            let common = a.iter().flat_map(|&(free, c)| {
                b.iter().filter(move |(other, _)| *other == free).map(move |(_, d)| (free, c * d))
            });
            own + common.map(|(free, product)| product / mass(self.free[free as usize])).sum::<f64>()
        });
        let Some(impulses) = mobility.cholesky().map(|cholesky| cholesky.solve(&held)) else { return };
        for ((unknown, row), (impulse, v)) in self.dependent.iter().zip(impulses.iter().zip(&moves)) {
            velocity[*unknown as usize / 2][*unknown as usize % 2] = v - impulse / mass(*unknown);
            for &(free, c) in row {
                let unknown = self.free[free as usize];
                velocity[unknown as usize / 2][unknown as usize % 2] += c * impulse / mass(unknown);
            }
        }
    }

    /// Copies the free components of a nodal displacement.
    pub fn select(&self, nodal: &[Vector2<f64>], free: &mut [f64]) {
        for (value, &unknown) in free.iter_mut().zip(&self.free) {
            *value = component(nodal, unknown);
        }
    }

    /// Computes the forces Tᵀ f on the free unknowns from nodal forces.
    pub fn restrict(&self, nodal: &[Vector2<f64>], free: &mut [f64]) {
        self.restrict_with(nodal, free, |c| c);
    }

    fn restrict_with(&self, nodal: &[Vector2<f64>], free: &mut [f64], coefficient: impl Fn(f64) -> f64) {
        self.select(nodal, free);
        for (unknown, row) in &self.dependent {
            let force = component(nodal, *unknown);
            row.iter().for_each(|&(own, c)| free[own as usize] += coefficient(c) * force);
        }
    }

    /// Adds `factor` times the displacement T u of free unknowns to a nodal vector. Fixed components do not change.
    pub fn add_free(&self, free: &[f64], factor: f64, nodal: &mut [Vector2<f64>]) {
        self.each(free, |unknown, value| nodal[unknown / 2][unknown % 2] += factor * value);
    }

    /// Calls `add` for every component of T u that is not zero by construction.
    fn each(&self, free: &[f64], mut add: impl FnMut(usize, f64)) {
        for (value, &unknown) in free.iter().zip(&self.free) {
            add(unknown as usize, *value);
        }
        for (unknown, row) in &self.dependent {
            add(*unknown as usize, row.iter().map(|&(own, c)| c * free[own as usize]).sum());
        }
    }

    /// Adds `factor` times the displacement T u of free unknowns to the displacement, m. Fixed components do not change.
    pub(crate) fn advance(&self, free: &[f64], factor: f64, u: &mut Displacement) {
        self.each(free, |unknown, value| u.advance(unknown / 2, unknown % 2, factor * value));
    }

    /// Returns the work of nodal forces, N, on the displacement T u of free unknowns.
    pub fn dot(&self, nodal: &[Vector2<f64>], free: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each(free, |unknown, value| sum += value * component(nodal, unknown as u32));
        sum
    }

    /// Returns the sum of nodal forces, N, without those of supports.
    pub fn resultant(&self, nodal: &[Vector2<f64>]) -> Vector2<f64> {
        let mut sum: Vector2<f64> = nodal.iter().zip(&self.mask).map(|(f, mask)| f.component_mul(mask)).sum();
        for (unknown, row) in &self.dependent {
            let force = component(nodal, *unknown);
            sum[*unknown as usize % 2] += row.iter().map(|(_, c)| c * force).sum::<f64>();
        }
        sum
    }

    /// Returns the Euclidean norm of the forces Tᵀ f on the free unknowns, without overflow; not finite if one of them is
    /// not.
    pub fn norm(&self, nodal: &[Vector2<f64>]) -> f64 {
        self.norm_with(nodal, |c| c)
    }

    /// Returns a norm as [`Self::norm`] of bounds of forces, which do not cancel each other.
    pub fn norm_of_bounds(&self, nodal: &[Vector2<f64>]) -> f64 {
        self.norm_with(nodal, f64::abs)
    }

    fn norm_with(&self, nodal: &[Vector2<f64>], coefficient: impl Fn(f64) -> f64) -> f64 {
        if !self.dependent.is_empty() {
            let mut free = vec![0.0; self.dofs()];
            self.restrict_with(nodal, &mut free, coefficient);
            let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
            let largest = free.iter().map(|v| v.abs()).fold(0.0, larger);
            let scale = 1.0 / largest;
            let scaled = || free.iter().map(|v| (v * scale).powi(2)).sum::<f64>();
            return if scale.is_normal() { largest * scaled().sqrt() } else { largest };
        }
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

    /// Returns the index of the entry of two unknowns: one after the last if one of them is fixed, a later one if one of
    /// them depends on others.
    pub(super) fn slot(&self, i: u32, j: u32) -> u32 {
        let [a, b] = [i, j].map(|unknown| self.free_of[unknown as usize]);
        if a != FIXED && b != FIXED {
            return self.free_slot(a, b);
        }
        let outside = self.row_indices.len() as u32;
        self.dependent_slots.get(&(i.min(j), i.max(j))).map_or(outside, |slot| outside + 1 + slot)
    }

    /// Returns the index of the entry of two free numbers.
    fn free_slot(&self, i: u32, j: u32) -> u32 {
        let (row, column) = (i.max(j) as usize, i.min(j) as usize);
        let start = self.column_starts[column];
        let rows = &self.row_indices[start..self.column_starts[column + 1]];
        (start + rows.partition_point(|&r| r < row)) as u32
    }
}

/// Returns the component of an unknown, 2 · node + axis.
pub(super) fn component(nodal: &[Vector2<f64>], unknown: u32) -> f64 {
    nodal[unknown as usize / 2][unknown as usize % 2]
}
