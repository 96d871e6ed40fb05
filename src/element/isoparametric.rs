//! Elements whose displacement is Σ uₐ Nₐ and whose energy is a sum over quadrature points, each with a rotation of its
//! own: Müller and Gross 2004, article eq. (2).

use nalgebra::{Matrix2, Vector2};

use super::{DiscreteGradient, ElementType, Elements, MatrixSum, StrainRate, StrainVisitor, Tangent, warped_strain};
use crate::material::Lame;
use crate::rotation::{Rotation, polar_or};

/// One quadrature point of an element with `N` nodes, at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint<const N: usize> {
    /// ∇Nₐ with respect to the rest position, 1/m.
    pub gradients: [Vector2<f64>; N],
    /// Quadrature weight times Jacobian, m².
    pub area: f64,
}

/// Floor of tr S in G: one percent of its value at rest. Where the body is crushed to nothing tr S vanishes and G has no
/// bound; the floor keeps the step finite.
pub(super) const SMALLEST_STRETCH_TRACE: f64 = 0.02;

impl<const N: usize> QuadraturePoint<N> {
    /// The point at `at` of an element with these rest nodes. That the Jacobian there is positive,
    /// [`crate::mesh::Mesh`] has checked.
    #[must_use]
    pub fn new(element: &ElementType, nodes: &[Vector2<f64>], at: [f64; 2], weight: f64) -> Self {
        let jacobian = element.jacobian(nodes, at);
        let inverse = jacobian.try_inverse().unwrap_or_default().transpose();
        let mut gradients = [Vector2::zeros(); N];
        for (g, local) in gradients.iter_mut().zip((element.local_gradients)(at)) {
            *g = inverse * local;
        }
        Self { gradients, area: weight * jacobian.determinant() }
    }

    /// The displacement gradient H = F − I = Σ uₐ ⊗ ∇Nₐ.
    ///
    /// From displacements, not positions: small strains keep their digits however large the coordinates.
    #[must_use]
    #[inline]
    pub fn displacement_gradient(&self, u: &[Vector2<f64>; N]) -> Matrix2<f64> {
        let mut h = Matrix2::zeros();
        for (u, g) in u.iter().zip(&self.gradients) {
            h += u * g.transpose();
        }
        h
    }

    /// The first Piola–Kirchhoff stress R T of the corotated energy times the point's area; its product with ∇Nₐ is the
    /// force on node a, and Σ over points is R Ke (Rᵀ x − X).
    #[must_use]
    #[inline]
    fn weighted_stress(&self, moduli: Lame, r: Rotation, strain: &Matrix2<f64>) -> Matrix2<f64> {
        r.matrix() * moduli.stress(strain) * self.area
    }

    /// The warped element force R Ke (Rᵀ x − X), N, given the displacement gradient.
    #[must_use]
    pub fn warped_force(&self, moduli: Lame, r: Rotation, h: &Matrix2<f64>) -> [Vector2<f64>; N] {
        let stress = self.weighted_stress(moduli, r, &warped_strain(r, h));
        self.gradients.map(|g| stress * g)
    }

    /// Calls `block(a, b, K_ab)` for b ≤ a with the blocks of this point's part of a tangent, N/m, row by row.
    ///
    /// With g = R ∇Nₐ and h = R ∇N_b, the block of R Ke Rᵀ is K_ab = v (λ g hᵀ + μ (g·h) I + μ h gᵀ): turning the
    /// gradients is cheaper than turning the matrix, and gives the same.
    ///
    /// G, the derivative of the force through R, adds in F-space (tr T / tr S) τ τᵀ with τ = vec(R J)/√2, J a quarter
    /// turn, T the Biot stress: tension makes it positive, compression negative. In the plane a quarter turn exchanges
    /// the components of g, so that with s = ½ v tr T / tr S it turns μ into μ + s and μ − s, at no further cost.
    #[inline]
    pub fn tangent_blocks(
        &self,
        moduli: Lame,
        r: Rotation,
        strain: &Matrix2<f64>,
        tangent: Tangent,
        mut block: impl FnMut(usize, usize, [f64; 4]),
    ) {
        let Lame { lambda, mu } = moduli;
        let stretch_trace = (2.0 + strain.trace()).max(SMALLEST_STRETCH_TRACE);
        let ratio = (mu + lambda) * strain.trace() / stretch_trace;
        let ratio = if tangent.definite { ratio.max(0.0) } else { ratio };
        let (lambda, mu, s) = (tangent.warped * lambda, tangent.warped * mu, tangent.geometric * ratio);
        let [axial, lambda, plus, minus] = [lambda + 2.0 * mu, lambda, mu + s, mu - s].map(|v| self.area * v);
        let g = self.gradients.map(|g| r.apply(g));
        for a in 0..N {
            for b in 0..=a {
                let [xx, yy, xy, yx] = [g[a].x * g[b].x, g[a].y * g[b].y, g[a].x * g[b].y, g[a].y * g[b].x];
                let k = [
                    axial * xx + plus * yy,
                    lambda * xy + minus * yx,
                    lambda * yx + minus * xy,
                    axial * yy + plus * xx,
                ];
                block(a, b, k);
            }
        }
    }
}

/// Elements of `N` nodes with `Q` quadrature points.
#[derive(Debug)]
pub struct Isoparametric<const N: usize, const Q: usize> {
    nodes: Vec<[u32; N]>,
    points: Vec<[QuadraturePoint<N>; Q]>,
}

impl<const N: usize, const Q: usize> Isoparametric<N, Q> {
    /// The elements of this kind with these rest nodes and node numbers.
    #[must_use]
    pub fn new(element: &ElementType, nodes: &[Vector2<f64>], connectivity: &[u32]) -> Self {
        let mut numbers = Vec::with_capacity(connectivity.len() / N);
        let mut points = Vec::with_capacity(connectivity.len() / N);
        for own in connectivity.chunks_exact(N) {
            let mut number = [0; N];
            number.copy_from_slice(own);
            let rest = number.map(|n| nodes[n as usize]);
            numbers.push(number);
            points.push(std::array::from_fn(|q| {
                let rule = element.points[q];
                QuadraturePoint::new(element, &rest, rule.at, rule.weight)
            }));
        }
        Self { nodes: numbers, points }
    }

    /// Every element's nodes and quadrature points.
    fn elements(&self) -> impl Iterator<Item = (&[u32; N], &[QuadraturePoint<N>; Q])> {
        self.nodes.iter().zip(&self.points)
    }

    /// Every element's displacements, points and rotations.
    fn turned<'a>(
        &'a self,
        u: &'a [Vector2<f64>],
        r: &'a [Rotation],
    ) -> impl Iterator<Item = ([Vector2<f64>; N], &'a [QuadraturePoint<N>; Q], &'a [Rotation])> {
        self.elements().zip(r.chunks_exact(Q)).map(|((nodes, points), r)| (gather(nodes, u), points, r))
    }

    /// One sweep: `stress` gives every element's first Piola–Kirchhoff stresses times area, and `tangent` its matrix.
    #[inline]
    fn sweep(
        &self,
        mut stress: impl FnMut(usize, &[u32; N], &[QuadraturePoint<N>; Q]) -> [Matrix2<f64>; Q],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
    ) {
        for (e, (nodes, points)) in self.elements().enumerate() {
            let mut sum = [Vector2::zeros(); N];
            for (point, stress) in points.iter().zip(stress(e, nodes, points)) {
                for (sum, g) in sum.iter_mut().zip(&point.gradients) {
                    *sum += stress * g;
                }
            }
            for (&node, f) in nodes.iter().zip(sum) {
                force[node as usize] += f;
                magnitude[node as usize] += f.abs();
            }
        }
    }
}

/// Scatters the tangents of elements one after the other.
struct Scatter<'a, const N: usize> {
    tangent: Tangent,
    slots: std::slice::ChunksExact<'a, u32>,
    values: &'a mut [f64],
}

impl<'a, const N: usize> Scatter<'a, N> {
    fn new(MatrixSum { tangent, slots, values }: MatrixSum<'a>) -> Self {
        Self { tangent, slots: slots.chunks_exact(N * (2 * N + 1)), values }
    }

    /// Adds the next element's: `seen` are the rotation and the strain of every point.
    #[inline]
    fn add(&mut self, points: &[QuadraturePoint<N>], moduli: Lame, seen: &[(Rotation, Matrix2<f64>)]) {
        let mut sum = [[[0.0; 4]; N]; N];
        for (point, (r, strain)) in points.iter().zip(seen) {
            point.tangent_blocks(moduli, *r, strain, self.tangent, |a, b, k| {
                sum[a][b].iter_mut().zip(k).for_each(|(sum, k)| *sum += k);
            });
        }
        scatter(&sum, self.slots.next().unwrap_or_default(), self.values);
    }
}

#[inline]
pub(super) fn gather<const N: usize>(nodes: &[u32; N], u: &[Vector2<f64>]) -> [Vector2<f64>; N] {
    nodes.map(|node| u[node as usize])
}

/// Adds an element's lower node blocks to the entries they belong to.
#[inline]
pub(super) fn scatter<const N: usize>(sum: &[[[f64; 4]; N]; N], slots: &[u32], values: &mut [f64]) {
    let mut slots = slots.iter();
    let mut add = |value: f64| {
        if let Some(&slot) = slots.next() {
            values[slot as usize] += value;
        }
    };
    for (a, row) in sum.iter().enumerate() {
        row[..a].iter().flatten().for_each(|&k| add(k));
        let [xx, _, yx, yy] = row[a];
        [xx, yx, yy].into_iter().for_each(&mut add);
    }
}

impl<const N: usize, const Q: usize> Elements for Isoparametric<N, Q> {
    fn rotation_count(&self) -> usize {
        self.point_count()
    }

    fn point_count(&self) -> usize {
        Q * self.points.len()
    }

    fn points_per_element(&self) -> usize {
        Q
    }

    fn rotation_of(&self, point: usize) -> usize {
        point
    }

    fn point_area(&self, point: usize) -> f64 {
        self.points[point / Q][point % Q].area
    }

    fn rotations(&self, u: &[Vector2<f64>], r: &mut [Rotation]) {
        for ((nodes, points), r) in self.elements().zip(r.chunks_exact_mut(Q)) {
            let u = gather(nodes, u);
            for (point, r) in points.iter().zip(r) {
                *r = polar_or(&(Matrix2::identity() + point.displacement_gradient(&u)), *r);
            }
        }
    }

    fn linearize(
        &self,
        moduli: Lame,
        u: &[Vector2<f64>],
        r: &[Rotation],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        matrix: Option<MatrixSum<'_>>,
    ) {
        let mut scatter = matrix.map(Scatter::<N>::new);
        let mut r = r.chunks_exact(Q);
        let stress = |_, nodes: &[u32; N], points: &[QuadraturePoint<N>; Q]| {
            let (u, r) = (gather(nodes, u), r.next().unwrap_or_default());
            let mut seen = [(Rotation::IDENTITY, Matrix2::zeros()); Q];
            let mut stresses = [Matrix2::zeros(); Q];
            for (((point, &r), seen), stress) in points.iter().zip(r).zip(&mut seen).zip(&mut stresses) {
                *seen = (r, warped_strain(r, &point.displacement_gradient(&u)));
                *stress = point.weighted_stress(moduli, r, &seen.1);
            }
            if let Some(scatter) = &mut scatter {
                scatter.add(points, moduli, &seen);
            }
            stresses
        };
        self.sweep(stress, force, magnitude);
    }

    /// ψ = μ ‖S − I‖² + λ/2 tr²(S − I) depends on ‖F‖² and r = tr S only, and r² is quadratic in F. So with
    /// F̄ = (F₀ + F₁)/2, R̄ = (r₀R₀ + r₁R₁)/(r₀ + r₁) and t̄ = (r₀ + r₁)/2 − 2 the stress P = 2μ (F̄ − R̄) + λ t̄ R̄ has
    /// P : (F₁ − F₀) = ψ₁ − ψ₀ exactly, and P F̄ᵀ is symmetric (the idea of Simo and Tarnow 1992 and Gonzalez 2000, in
    /// closed form for this energy). A is taken at R̄/|R̄|, G at t̄.
    fn linearize_between(
        &self,
        moduli: Lame,
        [(u0, r0), (u1, r1)]: [(&[Vector2<f64>], &[Rotation]); 2],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        matrix: Option<MatrixSum<'_>>,
    ) {
        let mut scatter = matrix.map(Scatter::<N>::new);
        let stress = |e: usize, nodes: &[u32; N], points: &[QuadraturePoint<N>; Q]| {
            let (u0, u1) = (gather(nodes, u0), gather(nodes, u1));
            let mut seen = [(Rotation::IDENTITY, Matrix2::zeros()); Q];
            let mut stresses = [Matrix2::zeros(); Q];
            for (q, point) in points.iter().enumerate() {
                let h = [&u0, &u1].map(|u| point.displacement_gradient(u));
                let between = DiscreteGradient::new(h, [r0[e * Q + q], r1[e * Q + q]]);
                seen[q] = (between.rotation, Matrix2::identity() * (0.5 * between.trace));
                stresses[q] = between.stress(moduli) * point.area;
            }
            if let Some(scatter) = &mut scatter {
                scatter.add(points, moduli, &seen);
            }
            stresses
        };
        self.sweep(stress, force, magnitude);
    }

    fn viscous_force(&self, moduli: Lame, u: &[Vector2<f64>], rate: StrainRate<'_>, force: &mut [Vector2<f64>]) {
        for (nodes, points) in self.elements() {
            let own = gather(nodes, u);
            for point in points {
                let f = Matrix2::identity() + point.displacement_gradient(&own);
                let rate = match rate {
                    StrainRate::Difference(terms) => {
                        let mut sum = Matrix2::zeros();
                        for (factor, u) in terms {
                            let h = point.displacement_gradient(&gather(nodes, u));
                            sum += (h + h.transpose() + h.transpose() * h) * (0.5 * factor);
                        }
                        sum
                    }
                    StrainRate::Velocity(v) => {
                        let rate = f.transpose() * point.displacement_gradient(&gather(nodes, v));
                        (rate + rate.transpose()) * 0.5
                    }
                };
                let stress = f * moduli.stress(&rate) * point.area;
                for (&node, g) in nodes.iter().zip(&point.gradients) {
                    force[node as usize] += stress * g;
                }
            }
        }
    }

    fn viscous_matrix(&self, moduli: Lame, u: &[Vector2<f64>], slots: &[u32], values: &mut [f64]) {
        let Lame { lambda, mu } = moduli;
        for ((nodes, points), slots) in self.elements().zip(slots.chunks_exact(N * (2 * N + 1))) {
            let own = gather(nodes, u);
            let mut sum = [[[0.0; 4]; N]; N];
            for point in points {
                let f = Matrix2::identity() + point.displacement_gradient(&own);
                let left = f * f.transpose();
                // With g = F ∇Nₐ and h = F ∇N_b the block is λ g hᵀ + μ h gᵀ + μ (∇Nₐ·∇N_b) F Fᵀ.
                let turned = point.gradients.map(|g| f * g);
                for a in 0..N {
                    for b in 0..=a {
                        let (g, h) = (turned[a], turned[b]);
                        let product = mu * point.gradients[a].dot(&point.gradients[b]);
                        let block = g * h.transpose() * lambda + h * g.transpose() * mu + left * product;
                        let rows = [block.m11, block.m12, block.m21, block.m22];
                        sum[a][b].iter_mut().zip(rows).for_each(|(sum, k)| *sum += k * point.area);
                    }
                }
            }
            scatter(&sum, slots, values);
        }
    }

    fn energy(&self, moduli: Lame, u: &[Vector2<f64>], r: &[Rotation]) -> f64 {
        let mut energy = 0.0;
        for (u, points, r) in self.turned(u, r) {
            for (point, &r) in points.iter().zip(r) {
                energy += point.area * moduli.energy_density(&warped_strain(r, &point.displacement_gradient(&u)));
            }
        }
        energy
    }

    fn smallest_area_ratio(&self, u: &[Vector2<f64>]) -> f64 {
        let mut smallest = f64::INFINITY;
        for (nodes, points) in self.elements() {
            let u = gather(nodes, u);
            for point in points {
                let h = point.displacement_gradient(&u);
                smallest = smallest.min((1.0 + h.m11) * (1.0 + h.m22) - h.m12 * h.m21);
            }
        }
        smallest
    }

    fn visit_strains(&self, _: Lame, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>) {
        let mut q = 0;
        for (u, points, r) in self.turned(u, r) {
            for (point, &r) in points.iter().zip(r) {
                let h = point.displacement_gradient(&u);
                visit(q, &h, &warped_strain(r, &h));
                q += 1;
            }
        }
    }
}
