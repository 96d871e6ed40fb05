//! Elements whose displacement is Σ uₐ Nₐ and whose energy is a sum over quadrature points with one rotation each:
//! Müller and Gross 2004, article eq. (2).

use nalgebra::{Matrix2, SimdPartialOrd, SimdValue, Vector2};

use super::connectivity::Connectivity;
use super::matrix::ElementMatrix;
use super::point::QuadraturePoint;
use super::rounding::{Rounded, RoundedPoint};
use super::{
    DiscreteGradient, ElementType, Elements, MatrixSum, PointStress, Rotations, StrainRate, StrainVisitor, Sums,
    rotations_at, warped_strain,
};
use crate::displacement::Compensated;
use crate::material::Lame;
use crate::rotation::Rotation;
use crate::simd::{LANES, Lanes, apply, gather_nodes, lane, matrix_lane, one_plus, sum_of_lanes, zero_vector};

/// Elements with `N` nodes and `Q` quadrature points.
#[derive(Debug)]
pub struct Isoparametric<const N: usize, const Q: usize> {
    nodes: Connectivity<N>,
    /// Quadrature points in SIMD batches.
    points: Vec<[QuadraturePoint<N, Lanes>; Q]>,
}

impl<const N: usize, const Q: usize> Isoparametric<N, Q> {
    /// Builds the elements from rest nodes and node numbers.
    pub fn new(element: &ElementType, nodes: &[Vector2<f64>], connectivity: &[u32]) -> Self {
        let numbers = Connectivity::new(connectivity);
        let points = numbers.batches().map(|(_, own)| {
            std::array::from_fn(|q| {
                let rule = element.points[q];
                let point = |lane: usize| {
                    let rest = own.map(|node| nodes[node[lane] as usize]);
                    QuadraturePoint::new(element, &rest, rule.at, rule.weight)
                };
                QuadraturePoint::side_by_side(std::array::from_fn(point))
            })
        });
        Self { points: points.collect(), nodes: numbers }
    }

    /// Iterates over the elements: nodes and quadrature points.
    fn elements(&self) -> impl Iterator<Item = (&[u32; N], impl Iterator<Item = QuadraturePoint<N>>)> {
        let points = self.points.iter().flat_map(|points| (0..LANES).map(move |lane| (points, lane)));
        self.nodes.elements.iter().zip(points.map(|(points, lane)| points.iter().map(move |point| point.lane(lane))))
    }

    /// See [`super::ElementLoops::sweep`]. Not inlined: the loops of all elements in one function are slower.
    #[inline(never)]
    pub(super) fn sweep(
        &self,
        moduli: Lame,
        u: Compensated<'_>,
        mut point_stress: impl FnMut([usize; LANES], &Matrix2<Lanes>) -> PointStress,
        sums: Sums<'_>,
    ) {
        let gather = |nodes: &[[u32; LANES]; N]| u.relative_side_by_side(nodes);
        let look =
            |u: &_, numbers, point: &QuadraturePoint<N, Lanes>| point_stress(numbers, &point.displacement_gradient(u));
        self.sweep_with(gather, look, moduli, sums);
    }

    /// Loops over all elements: `gather` collects nodal values of a batch, `look` computes rotation, strain trace and
    /// stress of a quadrature point from them. Adds nodal forces, their absolute values, and the tangent to `matrix` if
    /// given.
    #[inline(always)]
    fn sweep_with<D>(
        &self,
        gather: impl Fn(&[[u32; LANES]; N]) -> D,
        mut look: impl FnMut(&D, [usize; LANES], &QuadraturePoint<N, Lanes>) -> PointStress,
        moduli: Lame,
        Sums { force, magnitude, mut matrix }: Sums<'_>,
    ) {
        let mut sum = ElementMatrix::zero();
        for ((numbers, nodes), points) in self.nodes.batches().zip(&self.points) {
            let gathered = gather(nodes);
            let mut own = [zero_vector(); N];
            for (q, point) in points.iter().enumerate() {
                let PointStress { rotation, trace, stress } = look(&gathered, numbers.points(Q, q), point);
                let stress = stress * point.area;
                own.iter_mut().zip(&point.gradients).for_each(|(own, g)| *own += apply(&stress, g));
                if let Some(MatrixSum { tangent, .. }) = &matrix {
                    sum.add(point, rotation, point.tangent(moduli, trace, *tangent));
                }
            }
            add_forces(numbers.count, nodes, &own, force, magnitude);
            if let Some(MatrixSum { slots, values, .. }) = &mut matrix {
                sum.scatter(numbers.first, numbers.count, slots, values);
                sum = ElementMatrix::zero();
            }
        }
    }
}

/// Adds the nodal forces of `count` elements and their absolute values.
#[inline(always)]
pub(super) fn add_forces<const N: usize>(
    count: usize,
    nodes: &[[u32; LANES]; N],
    own: &[Vector2<Lanes>; N],
    force: &mut [Vector2<f64>],
    magnitude: &mut [Vector2<f64>],
) {
    for l in 0..count {
        for (node, own) in nodes.iter().zip(own) {
            let (node, f) = (node[l] as usize, lane(own, l));
            force[node] += f;
            magnitude[node] += f.abs();
        }
    }
}

/// Gathers the values of an element's nodes.
#[inline(always)]
pub(super) fn at_nodes<const N: usize>(nodes: &[u32; N], u: &[Vector2<f64>]) -> [Vector2<f64>; N] {
    let mut own = [Vector2::zeros(); N];
    own.iter_mut().zip(nodes).for_each(|(own, &node)| *own = u[node as usize]);
    own
}

impl<const N: usize, const Q: usize> Elements for Isoparametric<N, Q> {
    fn rotation_count(&self) -> usize {
        self.point_count()
    }

    fn point_count(&self) -> usize {
        Q * self.nodes.elements.len()
    }

    fn points_per_element(&self) -> usize {
        Q
    }

    fn rotation_of(&self, point: usize) -> usize {
        point
    }

    fn point_area(&self, point: usize) -> f64 {
        self.points[point / Q / LANES][point % Q].area.extract(point / Q % LANES)
    }

    fn rotations(&self, u: Compensated<'_>, r: &mut [Rotation]) {
        let mut rotations = Rotations::Follow(r);
        for ((numbers, nodes), points) in self.nodes.batches().zip(&self.points) {
            let u = u.relative_side_by_side(nodes);
            for (q, point) in points.iter().enumerate() {
                rotations.evaluate(numbers.points(Q, q), &point.displacement_gradient(&u));
            }
        }
    }

    fn add_rounding(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation], bound: &mut [Vector2<f64>]) {
        for ((nodes, points), r) in self.elements().zip(r.chunks_exact(Q)) {
            let own = Rounded::relative(u, nodes);
            for (point, &r) in points.zip(r) {
                let seen = RoundedPoint::new(&point, moduli, r, &own);
                for (&node, g) in nodes.iter().zip(&point.gradients) {
                    bound[node as usize] += seen.force(g, Q as f64);
                }
            }
        }
    }

    /// Uses the discrete gradient in closed form. ψ = μ ‖S − I‖² + λ/2 tr²(S − I) depends on ‖F‖² and r = tr S only,
    /// and r² is quadratic in F. So with F̄ = (F₀ + F₁)/2, R̄ = (r₀R₀ + r₁R₁)/(r₀ + r₁) and t̄ = (r₀ + r₁)/2 − 2 the
    /// stress P = 2μ (F̄ − R̄) + λ t̄ R̄ satisfies P : (F₁ − F₀) = ψ₁ − ψ₀ exactly, and P F̄ᵀ is symmetric (the idea of
    /// Simo and Tarnow 1992 and Gonzalez 2000, in closed form for this energy). A is evaluated at R̄/|R̄|, G at t̄.
    fn linearize_between(
        &self,
        moduli: Lame,
        [(u0, r0), (u1, r1)]: [(Compensated<'_>, &[Rotation]); 2],
        sums: Sums<'_>,
    ) {
        let gather = |nodes: &[[u32; LANES]; N]| [u0, u1].map(|u| u.relative_side_by_side(nodes));
        let look = |u: &[[Vector2<Lanes>; N]; 2], numbers, point: &QuadraturePoint<N, Lanes>| {
            let h = [point.displacement_gradient(&u[0]), point.displacement_gradient(&u[1])];
            let between = DiscreteGradient::new(h, [rotations_at(r0, numbers), rotations_at(r1, numbers)]);
            PointStress { rotation: between.rotation, trace: between.trace, stress: between.stress(moduli) }
        };
        self.sweep_with(gather, look, moduli, sums);
    }

    fn viscous_force(&self, moduli: Lame, u: &[Vector2<f64>], rate: StrainRate<'_>, force: &mut [Vector2<f64>]) {
        for (nodes, points) in self.elements() {
            let own = at_nodes(nodes, u);
            for point in points {
                let f = Matrix2::identity() + point.displacement_gradient(&own);
                let rate = match rate {
                    StrainRate::Difference(terms) => {
                        let mut sum = Matrix2::zeros();
                        for (factor, u) in terms {
                            let h = point.displacement_gradient(&at_nodes(nodes, u));
                            sum += (h + h.transpose() + h.transpose() * h) * (0.5 * factor);
                        }
                        sum
                    }
                    StrainRate::Velocity(v) => {
                        let rate = f.transpose() * point.displacement_gradient(&at_nodes(nodes, v));
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

    fn viscous_matrix(&self, Lame { lambda, mu }: Lame, u: &[Vector2<f64>], slots: &[u32], values: &mut [f64]) {
        for (e, (nodes, points)) in self.elements().enumerate() {
            let own = at_nodes(nodes, u);
            let mut sum = ElementMatrix::<N, f64>::zero();
            for point in points {
                let f = Matrix2::identity() + point.displacement_gradient(&own);
                let left = f * f.transpose();
                // With g = F ∇Nₐ and h = F ∇N_b the block is λ g hᵀ + μ h gᵀ + μ (∇Nₐ·∇N_b) F Fᵀ.
                let rotated = point.gradients.map(|g| f * g);
                sum.add_blocks(|a, b| {
                    let (g, h) = (rotated[a], rotated[b]);
                    let product = mu * point.gradients[a].dot(&point.gradients[b]);
                    let block = g * h.transpose() * lambda + h * g.transpose() * mu + left * product;
                    [block.m11, block.m12, block.m21, block.m22].map(|k| k * point.area)
                });
            }
            sum.scatter(e, 1, slots, values);
        }
    }

    fn energy(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation]) -> f64 {
        let mut energy = 0.0;
        for ((numbers, nodes), points) in self.nodes.batches().zip(&self.points) {
            let u = u.relative_side_by_side(nodes);
            for (q, point) in points.iter().enumerate() {
                let rotation = rotations_at(r, numbers.points(Q, q));
                let strain = warped_strain(rotation, &point.displacement_gradient(&u));
                energy += sum_of_lanes(point.area * moduli.energy_density(&strain), numbers.count);
            }
        }
        energy
    }

    fn smallest_area_ratio(&self, u: &[Vector2<f64>]) -> f64 {
        let mut smallest = Lanes::splat(f64::INFINITY);
        for ((_, nodes), points) in self.nodes.batches().zip(&self.points) {
            let u = gather_nodes(u, nodes);
            for point in points {
                let f = one_plus(&point.displacement_gradient(&u));
                smallest = smallest.simd_min(f.m11 * f.m22 - f.m12 * f.m21);
            }
        }
        smallest.simd_horizontal_min()
    }

    fn visit_strains(&self, _: Lame, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>) {
        for ((numbers, nodes), points) in self.nodes.batches().zip(&self.points) {
            let u = gather_nodes(u, nodes);
            let seen: [_; Q] = std::array::from_fn(|q| {
                let h = points[q].displacement_gradient(&u);
                (h, warped_strain(rotations_at(r, numbers.points(Q, q)), &h))
            });
            for lane in 0..numbers.count {
                for (q, (h, strain)) in seen.iter().enumerate() {
                    visit((numbers.first + lane) * Q + q, &matrix_lane(h, lane), &matrix_lane(strain, lane));
                }
            }
        }
    }
}
