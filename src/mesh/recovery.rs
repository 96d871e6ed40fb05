//! Recovery of nodal values from values at quadrature points.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::mesh::Mesh;

/// Superconvergent patch recovery (Zienkiewicz and Zhu 1992, *The superconvergent patch recovery and a posteriori error
/// estimates*, part 1): around every corner node a complete polynomial of the degree of the element's displacements is
/// fitted to the values at the quadrature points of the adjacent elements. Its value at the corner is the corner's
/// value; a node between two corners gets the mean of their two polynomials there.
///
/// If a patch hardly determines its polynomial, as at the outline, the surrounding elements are added, or the degree is
/// reduced where the mesh ends. Weights of points decrease with the distance from the corner.
///
/// The fit is linear in the values: it is a sparse matrix, computed once per mesh. Polynomials are complete and scaled
/// by the patch's own spread, so the result does not depend on the body's orientation or the aspect ratio of cells.
#[derive(Debug)]
pub struct Recovery {
    /// Index of each node's first entry, and the end of the last.
    starts: Vec<u32>,
    /// Quadrature points and weights.
    entries: Vec<(u32, f64)>,
}

impl Recovery {
    /// Returns the recovery matrix of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let patches = Patches::new(mesh);
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); mesh.nodes().len()];
        let entry = mesh.entry();
        let corners = entry.cell.corners.len();
        // Non-corner nodes of an element with the corners whose polynomials are averaged there, and the weights.
        let between: Vec<(usize, Vec<(usize, f64)>)> = (corners..entry.nodes.len())
            .map(|node| {
                let weights = (entry.cell.corner_weights)(entry.nodes[node]).into_iter().enumerate();
                (node, weights.filter(|(_, weight)| weight.abs() > 1e-9).collect())
            })
            .collect();
        // For every corner, the nodes that its polynomial contributes to, with weights.
        let mut shares: Vec<Vec<(u32, f64)>> = vec![Vec::new(); mesh.nodes().len()];
        let mut seen = vec![false; mesh.nodes().len()];
        for own in mesh.elements() {
            for &corner in own.iter().take(corners) {
                if !std::mem::replace(&mut seen[corner as usize], true) {
                    shares[corner as usize].push((corner, 1.0));
                }
            }
            for (node, parents) in &between {
                if !std::mem::replace(&mut seen[own[*node] as usize], true) {
                    parents.iter().for_each(|&(p, share)| shares[own[p] as usize].push((own[*node], share)));
                }
            }
        }
        let mut fit = Fit::default();
        for (corner, shares) in (0..).zip(&shares).filter(|(_, shares)| !shares.is_empty()) {
            patches.fit(corner, &mut fit);
            for &(node, share) in shares {
                let weights = fit.weights(mesh.node(node));
                rows[node as usize].extend(fit.points.iter().zip(weights).map(|(&(q, _), w)| (q, share * w)));
            }
        }
        let mut result = Self { starts: vec![0], entries: Vec::new() };
        for mut row in rows {
            row.sort_unstable_by_key(|&(q, _)| q);
            for same in row.chunk_by(|a, b| a.0 == b.0) {
                result.entries.push((same[0].0, same.iter().map(|(_, weight)| weight).sum()));
            }
            result.starts.push(result.entries.len() as u32);
        }
        result
    }

    /// Computes the values at every node from values at every quadrature point. A node without elements gets zeros.
    pub fn recover<const K: usize>(&self, at_points: &[[f64; K]], nodal: &mut Vec<[f64; K]>) {
        nodal.clear();
        nodal.extend(self.starts.windows(2).map(|bounds| {
            let mut sum = [0.0; K];
            for &(q, weight) in &self.entries[bounds[0] as usize..bounds[1] as usize] {
                let value = at_points.get(q as usize).copied().unwrap_or([0.0; K]);
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += weight * value);
            }
            sum
        }));
    }
}

/// Mesh data needed to build patches.
struct Patches<'a> {
    mesh: &'a Mesh,
    /// Elements around every node.
    around: Vec<Vec<u32>>,
    /// `true` for nodes on the outline.
    outer: Vec<bool>,
    /// Position of every quadrature point, m.
    points: Vec<Vector2<f64>>,
    degree: usize,
}

/// Polynomial of a patch, as a linear map from values at its points.
#[derive(Default)]
struct Fit {
    /// Index and position of every point.
    points: Vec<(u32, Vector2<f64>)>,
    centre: Vector2<f64>,
    /// Scales positions relative to the centre to unit covariance.
    scale: Matrix2<f64>,
    /// Polynomial coefficients that a unit value at each point contributes.
    coefficients: Vec<[f64; MAX_TERMS]>,
}

/// Number of terms of a complete polynomial of degree 2, the highest that is fitted.
const MAX_TERMS: usize = 6;
/// Smallest ratio of points to polynomial terms in a patch inside the body.
const MIN_POINTS_PER_TERM: f64 = 1.3;
/// The same for corners on the outline, where all points lie to one side.
const MIN_POINTS_PER_TERM_OUTSIDE: f64 = 1.5;
/// Decay length of the weights of points with the distance from the corner, in standard deviations of the patch. Chosen
/// by the stresses at the hole of Kirsch's plate and inside it: without weights, six-node triangles have 1.5 times the
/// error.
const REACH: f64 = 2.0;
/// Largest number of rings of elements in a patch.
const MAX_RINGS: u32 = 3;

impl<'a> Patches<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let entry = mesh.entry();
        let mut around = vec![Vec::new(); mesh.nodes().len()];
        for (element, own) in (0..).zip(mesh.elements()) {
            own.iter().for_each(|&node| around[node as usize].push(element));
        }
        let shapes: Vec<Vec<f64>> = entry.points.iter().map(|p| (entry.shape)(p.at)).collect();
        let place = |own: &[u32], shape: &[f64]| own.iter().zip(shape).map(|(&n, w)| mesh.node(n) * *w).sum();
        let points = mesh.elements().flat_map(|own| shapes.iter().map(move |shape| place(own, shape))).collect();
        Self { mesh, around, outer: mesh.nodes_on_outline(), points, degree: entry.degree().min(2) }
    }

    /// Adds the elements around a patch to it; returns `false` if there are none.
    fn grow(&self, patch: &mut Vec<u32>) -> bool {
        let stride = self.mesh.entry().nodes.len();
        let corners = self.mesh.entry().cell.corners.len();
        let before = patch.len();
        for i in 0..before {
            let own = &self.mesh.connectivity()[patch[i] as usize * stride..][..corners];
            own.iter().for_each(|&node| patch.extend(&self.around[node as usize]));
        }
        patch.sort_unstable();
        patch.dedup();
        patch.len() > before
    }

    /// Fits the polynomial around a corner.
    fn fit(&self, corner: u32, fit: &mut Fit) {
        let per_element = self.mesh.entry().points.len() as u32;
        let mut patch = self.around[corner as usize].clone();
        let mut rings = 1;
        let spare = if self.outer[corner as usize] { MIN_POINTS_PER_TERM_OUTSIDE } else { MIN_POINTS_PER_TERM };
        let needed = ((self.degree + 1) * (self.degree + 2) / 2) as f64 * spare;
        loop {
            let enough = (patch.len() * per_element as usize) as f64 >= needed;
            if enough && self.solve(self.mesh.node(corner), &patch, self.degree, fit) {
                return;
            }
            if rings == MAX_RINGS || !self.grow(&mut patch) {
                break;
            }
            rings += 1;
        }
        // The fit of degree 0 is the mean, which always exists.
        let _ = (0..=self.degree).rev().any(|degree| self.solve(self.mesh.node(corner), &patch, degree, fit));
    }

    /// Computes the least squares fit of a degree; returns `false` if the points do not determine it.
    fn solve(&self, about: Vector2<f64>, patch: &[u32], degree: usize, fit: &mut Fit) -> bool {
        let per_element = self.mesh.entry().points.len() as u32;
        fit.points.clear();
        let numbers = patch.iter().flat_map(|&e| e * per_element..(e + 1) * per_element);
        fit.points.extend(numbers.map(|q| (q, self.points[q as usize])));
        let count = fit.points.len() as f64;
        fit.centre = fit.points.iter().map(|(_, x)| x).sum::<Vector2<f64>>() / count;
        let mut spread = Matrix2::zeros();
        for (_, x) in &fit.points {
            let d = x - fit.centre;
            spread += d * d.transpose() / count;
        }
        fit.scale = if degree == 0 {
            Matrix2::zeros()
        } else {
            let Some(scale) = spread.cholesky().and_then(|c| c.l().try_inverse()) else { return false };
            scale
        };
        match degree {
            0 => fit.solve::<1>(about),
            1 => fit.solve::<3>(about),
            _ => fit.solve::<6>(about),
        }
    }
}

impl Fit {
    /// Computes the coefficients of the first `T` terms; returns `false` if the points do not determine them.
    fn solve<const T: usize>(&mut self, about: Vector2<f64>) -> bool {
        /// Smallest accepted pivot of the scaled normal equations, whose diagonal is about 1.
        const DETERMINED: f64 = 1e-6;
        let (mut normal, mut total) = (SMatrix::<f64, T, T>::zeros(), 0.0);
        self.coefficients.clear();
        for (_, x) in &self.points {
            let terms = self.terms(*x);
            let basis = SVector::<f64, T>::from_fn(|term, _| terms[term]);
            let weight = (-(self.scale * (x - about)).norm_squared() / (REACH * REACH)).exp();
            normal += weight * basis * basis.transpose();
            total += weight;
            let mut coefficients = [0.0; MAX_TERMS];
            coefficients.iter_mut().zip(&basis).for_each(|(own, term)| *own = weight * term);
            self.coefficients.push(coefficients);
        }
        let Some(factor) = (normal / total).cholesky() else { return false };
        if factor.l_dirty().diagonal().min() < DETERMINED {
            return false;
        }
        for coefficients in &mut self.coefficients {
            let solved = factor.solve(&SVector::<f64, T>::from_fn(|term, _| coefficients[term])) / total;
            coefficients.iter_mut().zip(&solved).for_each(|(own, solved)| *own = *solved);
        }
        true
    }

    /// Returns the weights of the points' values in the polynomial's value at a position.
    fn weights(&self, at: Vector2<f64>) -> impl Iterator<Item = f64> {
        let terms = self.terms(at);
        self.coefficients.iter().map(move |own| own.iter().zip(&terms).map(|(a, b)| a * b).sum())
    }

    /// Evaluates the terms of a complete polynomial of degree 2 at a position.
    fn terms(&self, at: Vector2<f64>) -> [f64; MAX_TERMS] {
        let x = self.scale * (at - self.centre);
        [1.0, x.x, x.y, x.x * x.x, x.x * x.y, x.y * x.y]
    }
}
