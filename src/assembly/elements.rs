//! The loops over a mesh's elements. [`Elements`] hides how many nodes and quadrature points an element has.

use nalgebra::{Matrix2, Vector2};

use super::pattern::Pattern;
use crate::element::{GeometricShare, QuadraturePoint, energy_density, warped_strain};
use crate::material::Lame;
use crate::rotation::{Rotation, polar_or};

/// What every method asks of the elements of a mesh. Slices over quadrature points hold them element by element;
/// slices over nodes hold them in the mesh's order.
pub trait Elements: std::fmt::Debug + Send + Sync {
    /// Quadrature points of the whole mesh.
    fn point_count(&self) -> usize;

    /// Quadrature points of one element.
    fn points_per_element(&self) -> usize;

    /// Sets R to the polar factor of F(x) at every point; where that is undefined R stays.
    fn rotations(&self, u: &[Vector2<f64>], r: &mut [Rotation]);

    /// Adds Σ R Ke Rᵀ, lower triangle, to `values` (one slot longer than the pattern: held unknowns go there).
    fn stiffness(&self, lame: Lame, r: &[Rotation], values: &mut [f64]);

    /// Adds Σ G, the geometric part of the exact tangent, lower triangle, to `values`.
    fn geometric_stiffness(
        &self,
        lame: Lame,
        u: &[Vector2<f64>],
        r: &[Rotation],
        share: GeometricShare,
        values: &mut [f64],
    );

    /// Adds ∫ N b dV to `force`, N, for a uniform force per volume b, N/m³.
    fn body_force(&self, b: Vector2<f64>, force: &mut [Vector2<f64>]);

    /// Adds Σ R Ke (Rᵀ x − X) to `force` and Σ |R Ke (Rᵀ x − X)|, by component, to `magnitude`, N.
    fn internal_force(
        &self,
        lame: Lame,
        u: &[Vector2<f64>],
        r: &[Rotation],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
    );

    /// Elastic energy Σ v ψ, J.
    fn energy(&self, lame: Lame, u: &[Vector2<f64>], r: &[Rotation]) -> f64;

    /// Calls `visit` for every point.
    fn visit_strains(&self, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>);
}

/// Receives a quadrature point's number, its displacement gradient H and its strain sym(RᵀF) − I.
pub type StrainVisitor<'a> = dyn FnMut(usize, &Matrix2<f64>, &Matrix2<f64>) + 'a;

/// Elements of `N` nodes.
#[derive(Debug)]
pub(super) struct ElementSet<const N: usize> {
    nodes: Vec<[u32; N]>,
    points: Vec<QuadraturePoint<N>>,
    points_per_element: usize,
    /// Where each entry of an element's lower triangle goes; see [`Pattern::element_slots`].
    slots: Vec<u32>,
}

impl<const N: usize> ElementSet<N> {
    pub(super) fn new(
        nodes: Vec<[u32; N]>,
        points: Vec<QuadraturePoint<N>>,
        points_per_element: usize,
        pattern: &Pattern,
    ) -> Self {
        let slots = nodes.iter().flat_map(|nodes| pattern.element_slots(nodes)).collect();
        Self { nodes, points, points_per_element, slots }
    }

    /// Every element's places in the matrix.
    fn slots(&self) -> std::slice::ChunksExact<'_, u32> {
        self.slots.chunks_exact(N * (2 * N + 1))
    }

    /// Every element's nodes and points, with the number of its first point.
    fn elements(&self) -> impl Iterator<Item = (&[u32; N], &[QuadraturePoint<N>], usize)> {
        let points = self.points.chunks_exact(self.points_per_element);
        self.nodes.iter().zip(points).enumerate().map(|(e, (n, p))| (n, p, e * self.points_per_element))
    }
}

/// Adds an element's lower node blocks to the entries they belong to.
#[inline]
fn scatter<const N: usize>(sum: &[[Matrix2<f64>; N]; N], slots: &[u32], values: &mut [f64]) {
    let mut slots = slots.iter();
    let mut add = |value: f64| {
        if let Some(&slot) = slots.next() {
            values[slot as usize] += value;
        }
    };
    for (a, row) in sum.iter().enumerate() {
        for k in &row[..a] {
            add(k.m11);
            add(k.m12);
            add(k.m21);
            add(k.m22);
        }
        add(row[a].m11);
        add(row[a].m21);
        add(row[a].m22);
    }
}

#[inline]
fn gather<const N: usize>(nodes: &[u32; N], u: &[Vector2<f64>]) -> [Vector2<f64>; N] {
    nodes.map(|node| u[node as usize])
}

impl<const N: usize> Elements for ElementSet<N> {
    fn point_count(&self) -> usize {
        self.points.len()
    }

    fn points_per_element(&self) -> usize {
        self.points_per_element
    }

    fn rotations(&self, u: &[Vector2<f64>], r: &mut [Rotation]) {
        for (nodes, points, first) in self.elements() {
            let u = gather(nodes, u);
            for (point, r) in points.iter().zip(&mut r[first..]) {
                *r = polar_or(&(Matrix2::identity() + point.displacement_gradient(&u)), *r);
            }
        }
    }

    fn stiffness(&self, lame: Lame, r: &[Rotation], values: &mut [f64]) {
        for ((_, points, first), slots) in self.elements().zip(self.slots()) {
            let mut sum = [[Matrix2::zeros(); N]; N];
            for (point, &r) in points.iter().zip(&r[first..]) {
                point.warped_stiffness(lame, r, |a, b, k| sum[a][b] += k);
            }
            scatter(&sum, slots, values);
        }
    }

    fn geometric_stiffness(
        &self,
        lame: Lame,
        u: &[Vector2<f64>],
        r: &[Rotation],
        share: GeometricShare,
        values: &mut [f64],
    ) {
        for ((nodes, points, first), slots) in self.elements().zip(self.slots()) {
            let u = gather(nodes, u);
            let mut sum = [[Matrix2::zeros(); N]; N];
            for (point, &r) in points.iter().zip(&r[first..]) {
                let h = point.displacement_gradient(&u);
                point.geometric_stiffness(lame, r, &h, share, |a, b, k| sum[a][b] += k);
            }
            scatter(&sum, slots, values);
        }
    }

    fn body_force(&self, b: Vector2<f64>, force: &mut [Vector2<f64>]) {
        for (nodes, points, _) in self.elements() {
            for point in points {
                for (&node, n) in nodes.iter().zip(point.shape) {
                    force[node as usize] += b * (point.volume * n);
                }
            }
        }
    }

    fn internal_force(
        &self,
        lame: Lame,
        u: &[Vector2<f64>],
        r: &[Rotation],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
    ) {
        for (nodes, points, first) in self.elements() {
            let u = gather(nodes, u);
            let mut sum = [Vector2::zeros(); N];
            for (point, &r) in points.iter().zip(&r[first..]) {
                let f = point.warped_force(lame, r, &point.displacement_gradient(&u));
                for (sum, f) in sum.iter_mut().zip(f) {
                    *sum += f;
                }
            }
            for (&node, f) in nodes.iter().zip(sum) {
                force[node as usize] += f;
                magnitude[node as usize] += f.abs();
            }
        }
    }

    fn energy(&self, lame: Lame, u: &[Vector2<f64>], r: &[Rotation]) -> f64 {
        let mut energy = 0.0;
        self.visit_strains(u, r, &mut |q, _, strain| energy += self.points[q].volume * energy_density(lame, strain));
        energy
    }

    fn visit_strains(&self, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>) {
        for (nodes, points, first) in self.elements() {
            let u = gather(nodes, u);
            for ((q, point), &r) in (first..).zip(points).zip(&r[first..]) {
                let h = point.displacement_gradient(&u);
                visit(q, &h, &warped_strain(r, &h));
            }
        }
    }
}
