//! Mass matrix: consistent, and lumped at the nodes.

use nalgebra::Vector2;

use super::pattern::Pattern;
use super::{Matrix, System};
use crate::continuation::dot;

/// Nodal masses of a body, kg.
#[derive(Clone, Debug)]
pub struct Mass {
    /// Σ ∫ ρ t NₐN_b dA for nodes b ≤ a that share an element, sorted.
    entries: Vec<MassEntry>,
    /// Lumped mass of every node, kg: the consistent diagonal of every element, scaled to its whole mass (Hinton, Rock and
    /// Zienkiewicz 1976). Unlike row sums it is positive for every element.
    pub lumped: Vec<f64>,
    /// Mass of the whole body, kg.
    pub total: f64,
}

#[derive(Clone, Copy, Debug)]
struct MassEntry {
    nodes: [u32; 2],
    mass: f64,
    /// Indices of the pair's x and y entries in the stiffness matrix.
    slots: [u32; 2],
}

impl Mass {
    /// Returns the mass of a system's body for a mass per area, kg/m².
    pub fn new(system: &System, area_density: f64) -> Self {
        let mesh = system.mesh();
        let entry = mesh.entry();
        let n = entry.nodes.len();
        let shapes: Vec<Vec<f64>> = entry.mass_points.iter().map(|p| (entry.shape)(p.at)).collect();
        let mut entries = Vec::with_capacity(mesh.element_count() * n * (n + 1) / 2);
        let mut lumped = vec![0.0; mesh.nodes().len()];
        let mut total = 0.0;
        for nodes in mesh.elements() {
            let rest: Vec<Vector2<f64>> = nodes.iter().map(|&n| mesh.node(n)).collect();
            let mut own = vec![vec![0.0; n]; n];
            let mut whole = 0.0;
            for (point, shape) in entry.mass_points.iter().zip(&shapes) {
                let mass = area_density * point.weight * entry.jacobian(&rest, point.at).determinant();
                whole += mass;
                for (a, row) in own.iter_mut().enumerate() {
                    for (b, m) in row.iter_mut().enumerate() {
                        *m += mass * shape[a] * shape[b];
                    }
                }
            }
            let diagonal: f64 = (0..n).map(|a| own[a][a]).sum();
            for (a, &node) in nodes.iter().enumerate() {
                lumped[node as usize] += own[a][a] * whole / diagonal;
                for (b, &other) in nodes[..=a].iter().enumerate() {
                    let pair = [node.max(other), node.min(other)];
                    entries.push(MassEntry { nodes: pair, mass: own[a][b], slots: [0; 2] });
                }
            }
            total += whole;
        }
        entries.sort_by_key(|e| e.nodes);
        entries.dedup_by(|next, kept| {
            let same = next.nodes == kept.nodes;
            if same {
                kept.mass += next.mass;
            }
            same
        });
        let pattern = system.pattern();
        for entry in &mut entries {
            let [a, b] = entry.nodes;
            entry.slots = [0, 1].map(|axis| pattern.slot(2 * a + axis, 2 * b + axis));
        }
        Self { entries, lumped, total }
    }

    /// Computes result = M v over the nodes.
    pub fn multiply(&self, v: &[Vector2<f64>], result: &mut [Vector2<f64>]) {
        result.fill(Vector2::zeros());
        for MassEntry { nodes: [a, b], mass, .. } in &self.entries {
            let (a, b) = (*a as usize, *b as usize);
            result[a] += v[b] * *mass;
            if a != b {
                result[b] += v[a] * *mass;
            }
        }
    }

    /// Returns the acceleration of every node, m/s², under nodal forces, N; fixed unknowns and held points rest.
    pub(crate) fn acceleration(&self, pattern: &Pattern, force: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        // Conjugate gradients, preconditioned by the lumped masses: the condition does not depend on the mesh (Wathen 1987).
        const MAX_ITERATIONS: u32 = 200;
        const TOLERANCE: f64 = 1e-13;
        let scaled = |residual: &[f64]| -> Vec<f64> {
            residual.iter().zip(&pattern.free).map(|(r, &unknown)| r / self.lumped[unknown as usize / 2]).collect()
        };
        let (mut acceleration, mut momentum) = (vec![Vector2::zeros(); force.len()], force.to_vec());
        let mut residual = vec![0.0; pattern.dofs()];
        pattern.restrict(force, &mut residual);
        let mut direction = scaled(&residual);
        let mut norm = dot(&residual, &direction);
        let (goal, mut image) = (TOLERANCE * TOLERANCE * norm, residual.clone());
        for _ in 0..MAX_ITERATIONS {
            if norm.is_nan() || norm <= goal {
                break;
            }
            let mut nodal = vec![Vector2::zeros(); force.len()];
            pattern.add_free(&direction, 1.0, &mut nodal);
            self.multiply(&nodal, &mut momentum);
            pattern.restrict(&momentum, &mut image);
            let length = norm / dot(&direction, &image);
            acceleration.iter_mut().zip(&nodal).for_each(|(a, d)| *a += d * length);
            residual.iter_mut().zip(&image).for_each(|(r, i)| *r -= i * length);
            let next = scaled(&residual);
            let after = dot(&residual, &next);
            direction.iter_mut().zip(&next).for_each(|(d, next)| *d = next + *d * (after / norm));
            norm = after;
        }
        acceleration
    }

    /// Returns v M v.
    pub fn energy_product(&self, v: &[Vector2<f64>]) -> f64 {
        let term = |MassEntry { nodes: [a, b], mass, .. }: &MassEntry| {
            let product = v[*a as usize].dot(&v[*b as usize]) * mass;
            if a == b { product } else { 2.0 * product }
        };
        self.entries.iter().map(term).sum()
    }

    /// Adds `factor` times M to a matrix over the free unknowns.
    pub(crate) fn add_to(&self, factor: f64, matrix: &mut Matrix) {
        matrix.sum(|values| {
            for MassEntry { mass, slots, .. } in &self.entries {
                for &slot in slots {
                    values[slot as usize] += factor * mass;
                }
            }
        });
    }
}
