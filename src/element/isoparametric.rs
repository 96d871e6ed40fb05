//! Elements whose displacement is Σ uₐ Nₐ and whose energy is a sum over quadrature points, each with a rotation of its
//! own: Müller and Gross 2004, article eq. (2).

use nalgebra::{Matrix2, Vector2};

use super::matrix::{ElementMatrix, PointTangent};
use super::rounding::{Rounded, RoundedPoint};
use super::{
    DiscreteGradient, ElementType, Elements, MatrixSum, Rotations, StrainRate, StrainVisitor, Tangent, warped_strain,
};
use crate::displacement::Compensated;
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

    /// The displacement gradient H = F − I = Σ uₐ ⊗ ∇Nₐ, which is Σ (uₐ − u₁) ⊗ ∇Nₐ.
    ///
    /// From displacements, not positions, and from differences of these: small strains keep their digits however large
    /// the coordinates and however far the element is carried.
    #[must_use]
    #[inline(always)]
    pub fn displacement_gradient(&self, u: &[Vector2<f64>; N]) -> Matrix2<f64> {
        let mut h = Matrix2::zeros();
        for (own, g) in u.iter().zip(&self.gradients).skip(1) {
            h += (own - u[0]) * g.transpose();
        }
        h
    }

    /// The warped element force R Ke (Rᵀ x − X), N, given the displacement gradient: the first Piola–Kirchhoff stress R T
    /// of the corotated energy times the point's area, applied to ∇Nₐ.
    #[must_use]
    pub fn warped_force(&self, moduli: Lame, r: Rotation, h: &Matrix2<f64>) -> [Vector2<f64>; N] {
        let stress = r.matrix() * moduli.stress(&warped_strain(r, h)) * self.area;
        self.gradients.map(|g| stress * g)
    }

    /// The block of nodes a and b in Ke, this point's part, N/m: v (λ g hᵀ + μ (g·h) I + μ h gᵀ) with g = ∇Nₐ, h = ∇N_b.
    #[must_use]
    pub fn stiffness_block(&self, moduli: Lame, a: usize, b: usize) -> Matrix2<f64> {
        let (g, h) = (self.gradients[a], self.gradients[b]);
        let shear = Matrix2::identity() * g.dot(&h) + h * g.transpose();
        (g * h.transpose() * moduli.lambda + shear * moduli.mu) * self.area
    }

    /// What this point's part of a tangent is made of; `trace` is that of the strain.
    ///
    /// With g = R ∇Nₐ and h = R ∇N_b, the block of R Ke Rᵀ is K_ab = v (λ g hᵀ + μ (g·h) I + μ h gᵀ): turning the
    /// gradients is cheaper than turning the matrix, and gives the same.
    ///
    /// G, the derivative of the force through R, adds in F-space (tr T / tr S) τ τᵀ with τ = vec(R J)/√2, J a quarter
    /// turn, T the Biot stress: tension makes it positive, compression negative. In the plane a quarter turn exchanges
    /// the components of g, so that with s = ½ v tr T / tr S it turns μ into μ + s and μ − s, at no further cost.
    #[inline(always)]
    pub(super) fn tangent(&self, moduli: Lame, trace: f64, tangent: Tangent) -> PointTangent {
        let Lame { lambda, mu } = moduli;
        let ratio = (mu + lambda) * trace / (2.0 + trace).max(SMALLEST_STRETCH_TRACE);
        let ratio = if tangent.definite { ratio.max(0.0) } else { ratio };
        let (lambda, mu, s) = (tangent.warped * lambda, tangent.warped * mu, tangent.geometric * ratio);
        let [axial, lambda, plus, minus] = [lambda + 2.0 * mu, lambda, mu + s, mu - s].map(|v| self.area * v);
        PointTangent { axial, lambda, plus, minus }
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

    /// Every element's nodes, points and rotations.
    fn turned<'a>(
        &'a self,
        r: &'a [Rotation],
    ) -> impl Iterator<Item = (&'a [u32; N], &'a [QuadraturePoint<N>; Q], &'a [Rotation])> {
        self.elements().zip(r.chunks_exact(Q)).map(|((nodes, points), r)| (nodes, points, r))
    }

    /// One sweep: `look` finds what is to be known of an element's points, and `seen` makes of it how a point is seen.
    ///
    /// A batch of elements is looked at before the first of them is worked on: the divisions and roots of one rotation
    /// overlap with those of the next, instead of every element waiting for its own.
    #[inline(always)]
    fn sweep<L: Copy>(
        &self,
        (mut look, none): (impl FnMut(usize, &[u32; N], &[QuadraturePoint<N>; Q]) -> [L; Q], L),
        seen: impl Fn(&L) -> Seen,
        moduli: Lame,
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        mut matrix: Option<MatrixSum<'_>>,
    ) {
        let batches = self.nodes.chunks(BATCH).zip(self.points.chunks(BATCH));
        for (first, (nodes, points)) in (0..).step_by(BATCH).zip(batches) {
            let mut looks = [[none; Q]; BATCH];
            for (i, (looks, (nodes, points))) in looks.iter_mut().zip(nodes.iter().zip(points)).enumerate() {
                *looks = look(first + i, nodes, points);
            }
            for (i, (looks, (nodes, points))) in looks.iter().zip(nodes.iter().zip(points)).enumerate() {
                let mut own = [Vector2::zeros(); N];
                let mut sum = ElementMatrix::ZERO;
                for (point, look) in points.iter().zip(looks) {
                    let Seen { rotation, trace, stress } = seen(look);
                    let stress = stress * point.area;
                    own.iter_mut().zip(&point.gradients).for_each(|(own, g)| *own += stress * g);
                    if let Some(MatrixSum { tangent, .. }) = &matrix {
                        sum.add(point, rotation, point.tangent(moduli, trace, *tangent));
                    }
                }
                for (&node, f) in nodes.iter().zip(own) {
                    force[node as usize] += f;
                    magnitude[node as usize] += f.abs();
                }
                if let Some(MatrixSum { slots, values, .. }) = &mut matrix {
                    sum.scatter(first + i, slots, values);
                }
            }
        }
    }
}

/// Elements of a batch; see [`Isoparametric::sweep`].
const BATCH: usize = 8;

/// How a sweep sees a quadrature point.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// R.
    rotation: Rotation,
    /// Trace of the strain.
    trace: f64,
    /// First Piola–Kirchhoff stress, times the thickness, N/m.
    stress: Matrix2<f64>,
}

#[inline(always)]
pub(super) fn gather<const N: usize>(nodes: &[u32; N], u: &[Vector2<f64>]) -> [Vector2<f64>; N] {
    let mut own = [Vector2::zeros(); N];
    own.iter_mut().zip(nodes).for_each(|(own, &node)| *own = u[node as usize]);
    own
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

    fn rotations(&self, u: Compensated<'_>, r: &mut [Rotation]) {
        for ((nodes, points), r) in self.elements().zip(r.chunks_exact_mut(Q)) {
            let u = u.relative(nodes);
            for (point, r) in points.iter().zip(r) {
                *r = polar_or(&(Matrix2::identity() + point.displacement_gradient(&u)), *r);
            }
        }
    }

    fn linearize(
        &self,
        moduli: Lame,
        u: Compensated<'_>,
        mut rotations: Rotations<'_>,
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        matrix: Option<MatrixSum<'_>>,
    ) {
        let none = (Rotation::IDENTITY, Matrix2::zeros());
        let look = |e: usize, nodes: &[u32; N], points: &[QuadraturePoint<N>; Q]| {
            let u = u.relative(nodes);
            let mut looks = [none; Q];
            for (q, (look, point)) in looks.iter_mut().zip(points).enumerate() {
                let h = point.displacement_gradient(&u);
                *look = (rotations.see(e * Q + q, &h), h);
            }
            looks
        };
        let seen = |&(rotation, h): &(Rotation, Matrix2<f64>)| {
            let strain = warped_strain(rotation, &h);
            Seen { rotation, trace: strain.trace(), stress: rotation.matrix() * moduli.stress(&strain) }
        };
        self.sweep((look, none), seen, moduli, force, magnitude, matrix);
    }

    fn add_rounding(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation], bound: &mut [Vector2<f64>]) {
        for (nodes, points, r) in self.turned(r) {
            let own = Rounded::relative(u, nodes);
            for (point, &r) in points.iter().zip(r) {
                let seen = RoundedPoint::new(point, moduli, r, &own);
                for (&node, g) in nodes.iter().zip(&point.gradients) {
                    bound[node as usize] += seen.force(g, Q as f64);
                }
            }
        }
    }

    /// ψ = μ ‖S − I‖² + λ/2 tr²(S − I) depends on ‖F‖² and r = tr S only, and r² is quadratic in F. So with
    /// F̄ = (F₀ + F₁)/2, R̄ = (r₀R₀ + r₁R₁)/(r₀ + r₁) and t̄ = (r₀ + r₁)/2 − 2 the stress P = 2μ (F̄ − R̄) + λ t̄ R̄ has
    /// P : (F₁ − F₀) = ψ₁ − ψ₀ exactly, and P F̄ᵀ is symmetric (the idea of Simo and Tarnow 1992 and Gonzalez 2000, in
    /// closed form for this energy). A is taken at R̄/|R̄|, G at t̄.
    fn linearize_between(
        &self,
        moduli: Lame,
        [(u0, r0), (u1, r1)]: [(Compensated<'_>, &[Rotation]); 2],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        matrix: Option<MatrixSum<'_>>,
    ) {
        let none = DiscreteGradient::new([Matrix2::zeros(); 2], [Rotation::IDENTITY; 2]);
        let look = |e: usize, nodes: &[u32; N], points: &[QuadraturePoint<N>; Q]| {
            let (u0, u1) = (u0.relative(nodes), u1.relative(nodes));
            let mut looks = [none; Q];
            for (q, (look, point)) in looks.iter_mut().zip(points).enumerate() {
                let h = [point.displacement_gradient(&u0), point.displacement_gradient(&u1)];
                *look = DiscreteGradient::new(h, [r0[e * Q + q], r1[e * Q + q]]);
            }
            looks
        };
        let seen = |between: &DiscreteGradient| Seen {
            rotation: between.rotation,
            trace: between.trace,
            stress: between.stress(moduli),
        };
        self.sweep((look, none), seen, moduli, force, magnitude, matrix);
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
        for (e, (nodes, points)) in self.elements().enumerate() {
            let own = gather(nodes, u);
            let mut sum = ElementMatrix::<N>::ZERO;
            for point in points {
                let f = Matrix2::identity() + point.displacement_gradient(&own);
                let left = f * f.transpose();
                // With g = F ∇Nₐ and h = F ∇N_b the block is λ g hᵀ + μ h gᵀ + μ (∇Nₐ·∇N_b) F Fᵀ.
                let turned = point.gradients.map(|g| f * g);
                sum.add_blocks(|a, b| {
                    let (g, h) = (turned[a], turned[b]);
                    let product = mu * point.gradients[a].dot(&point.gradients[b]);
                    let block = g * h.transpose() * lambda + h * g.transpose() * mu + left * product;
                    [block.m11, block.m12, block.m21, block.m22].map(|k| k * point.area)
                });
            }
            sum.scatter(e, slots, values);
        }
    }

    fn energy(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation]) -> f64 {
        let mut energy = 0.0;
        for (nodes, points, r) in self.turned(r) {
            let u = u.relative(nodes);
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
        for (nodes, points, r) in self.turned(r) {
            let u = gather(nodes, u);
            for (point, &r) in points.iter().zip(r) {
                let h = point.displacement_gradient(&u);
                visit(q, &h, &warped_strain(r, &h));
                q += 1;
            }
        }
    }
}
