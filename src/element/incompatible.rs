//! Four-node quadrilaterals with incompatible modes and one rotation per element.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Matrix2, Matrix4, Matrix4x2, SimdPartialOrd, SimdValue, Vector2};

use super::connectivity::Connectivity;
use super::isoparametric::{add_forces, at_nodes};
use super::matrix::ElementMatrix;
use super::point::{QuadraturePoint, SMALLEST_STRETCH_TRACE};
use super::rounding::{Rounded, RoundedPoint, UNIT};
use super::{
    DiscreteGradient, ElementType, Elements, MatrixSum, PointStress, Rotations, StrainRate, StrainVisitor, Sums,
    Tangent, rotations_at, warped_strain,
};
use crate::displacement::Compensated;
use crate::material::Lame;
use crate::rotation::{Rotation, polar_or};
use crate::simd::{LANES, Lanes, Number, apply, filled, one_plus, product, sum_of_lanes, zero_vector};

/// Values at the corners of ξη, the bilinear function that is not linear.
const TWIST: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// Bilinear quadrilaterals with the incompatible modes 1 − ξ² and 1 − η² (Wilson, Taylor, Doherty and Ghaboussi 1973,
/// *Incompatible displacement models*) in the form that passes the patch test on any convex quadrilateral (Taylor,
/// Beresford and Wilson 1976, *A non-conforming element for stress analysis*: the modes' gradients are those at the
/// centre, times the ratio of the Jacobians), condensed at rest, and rotated by the polar factor R of F at the centre.
///
/// Displacements are u = linear + q ξη, with q = Σ γₐ uₐ (γ: Flanagan and Belytschko 1981). The modes do no work on
/// uniform stress, and the mean of ∇Nₐ is its value at the centre. So the condensed 8 × 8 stiffness splits into
///
/// Ke = A B₀ᵀ C B₀ + γ γᵀ ⊗ K,
///
/// the stiffness of a single point at the centre and a 2 × 2 matrix K that contains the whole effect of the modes. The
/// energy of d = Rᵀ(x − x̄) − (X − X̄), ½ d Ke d, is then A ψ(S) + ½ q̃ K q̃ with q̃ = Rᵀ q. R makes the first term
/// stationary, but not the second: with w = ½ q̃ K q̃, θ the angle of R, f = K q̃ and J the rotation by 90°, ∂w/∂θ =
/// −f·J q̃, and the force and the Hessian need θ_x = R J ∇Nₐ / tr S and θ_xx = −(θ_x R∇Nᵀ + R∇N θ_xᵀ) / tr S.
#[derive(Debug)]
pub struct IncompatibleQuads {
    nodes: Connectivity<4>,
    /// Rest geometry of the elements, one SIMD batch per entry.
    quads: Vec<Quad<Lanes>>,
    /// Gradients of ξη and of the two modes at the quadrature points.
    points: Vec<[QuadraturePoint<3>; 4]>,
    /// Cache of condensed modes for the ratios λ/μ used last.
    condensed: Mutex<Vec<Arc<Condensed>>>,
}

/// Rest geometry of an element; with SIMD `T`, of one element per lane.
#[derive(Clone, Copy, Debug)]
struct Quad<T: Number = f64> {
    /// ∇Nₐ at the centre, 1/m, and the element's area, m².
    centre: QuadraturePoint<4, T>,
    /// Weights γₐ of q = Σ γₐ uₐ.
    gamma: [T; 4],
}

/// Quantities that depend on λ/μ.
#[derive(Debug)]
struct Condensed {
    ratio: f64,
    /// K_xx, K_xy, K_yy over μ, in SIMD batches like the elements.
    stiffness: Vec<[Lanes; 3]>,
    /// Amplitudes of the modes over q̃: 1 − ξ² along x and y, 1 − η² along x and y.
    modes: Vec<Matrix4x2<f64>>,
}

/// Capacity of the cache: the ratios of a few materials on one mesh and of their viscosities, which may differ by
/// rounding.
const REMEMBERED: usize = 4;

/// Returns J v, v rotated by 90° counter-clockwise.
#[inline(always)]
fn quarter<T: Number>(v: Vector2<T>) -> Vector2<T> {
    Vector2::new(-v.y, v.x)
}

/// Returns the symmetric matrix with the entries xx, xy and yy.
#[inline(always)]
fn symmetric<T: Number>([xx, xy, yy]: [T; 3]) -> Matrix2<T> {
    Matrix2::new(xx, xy, xy, yy)
}

/// Returns the entries of a matrix, row by row.
#[inline(always)]
fn rows<T: Number>(m: &Matrix2<T>) -> [T; 4] {
    [m.m11, m.m12, m.m21, m.m22]
}

impl Quad {
    fn new(element: &ElementType, rest: &[Vector2<f64>; 4]) -> Self {
        let centre = QuadraturePoint::<4>::new(element, rest, [0.0; 2], element.cell.area);
        let twisted = (rest[0] - rest[1]) + (rest[2] - rest[3]);
        let mut gamma = TWIST;
        gamma.iter_mut().zip(&centre.gradients).for_each(|(gamma, g)| *gamma = 0.25 * (*gamma - twisted.dot(g)));
        Self { centre, gamma }
    }
}

impl Quad<Lanes> {
    /// Packs elements into lanes, one per lane.
    fn side_by_side(own: [Quad; LANES]) -> Self {
        Self {
            centre: QuadraturePoint::side_by_side(own.map(|quad| quad.centre)),
            gamma: std::array::from_fn(|a| own.map(|quad| quad.gamma[a]).into()),
        }
    }

    /// Returns the element in one lane.
    #[inline(always)]
    fn lane(&self, of: usize) -> Quad {
        Quad { centre: self.centre.lane(of), gamma: self.gamma.map(|gamma| gamma.extract(of)) }
    }
}

impl<T: Number> Quad<T> {
    /// Returns q, computed from differences of displacements, because the γₐ sum to zero.
    #[inline(always)]
    fn twist(&self, u: &[Vector2<T>; 4]) -> Vector2<T> {
        let mut q = zero_vector();
        for (own, gamma) in u.iter().zip(&self.gamma).skip(1) {
            q += (own - u[0]) * *gamma;
        }
        q
    }
}

/// Returns tr S, and in each lane `true` if R is bitwise the polar factor of I + H. There R depends on x; elsewhere it
/// is held constant.
#[inline(always)]
fn following<T: Number>(r: Rotation<T>, h: &Matrix2<T>) -> (T, T::SimdBool) {
    let f = one_plus(h);
    let own = polar_or(&f, Rotation { c: T::zero(), s: T::zero() });
    (r.c * (f.m11 + f.m22) + r.s * (f.m21 - f.m12), own.c.simd_eq(r.c) & own.s.simd_eq(r.s))
}

/// Returns 1 / tr S, bounded for crushed elements; zero where R is held constant.
#[inline(always)]
fn inverse_trace<T: Number>(r: Rotation<T>, h: &Matrix2<T>) -> T {
    let (trace, follows) = following(r, h);
    (T::one() / trace.simd_max(T::splat(SMALLEST_STRETCH_TRACE))).select(follows, T::zero())
}

/// Returns the gradients of ξη and of the modes at a point, 1/m.
fn bending_point(
    element: &ElementType,
    rest: &[Vector2<f64>; 4],
    [xi, eta]: [f64; 2],
    weight: f64,
) -> QuadraturePoint<3> {
    let (jacobian, centre) = (element.jacobian(rest, [xi, eta]), element.jacobian(rest, [0.0; 2]));
    // The mesh has checked that both Jacobians can be inverted.
    let [inverse, inverse_at_centre] = [jacobian, centre].map(|j| j.try_inverse().unwrap_or_default().transpose());
    let shrink = centre.determinant() / jacobian.determinant();
    QuadraturePoint {
        gradients: [
            inverse * Vector2::new(eta, xi),
            inverse_at_centre * Vector2::new(-2.0 * xi * shrink, 0.0),
            inverse_at_centre * Vector2::new(0.0, -2.0 * eta * shrink),
        ],
        area: weight * jacobian.determinant(),
    }
}

impl Condensed {
    fn new(ratio: f64, points: &[[QuadraturePoint<3>; 4]]) -> Self {
        let moduli = Lame { lambda: ratio, mu: 1.0 };
        let mut stiffness = Vec::with_capacity(points.len());
        let mut modes = Vec::with_capacity(points.len());
        for points in points {
            // Stiffness of ξη (0) and the two modes (1, 2).
            let block = |a, b| points.iter().map(|p| p.stiffness_block(moduli, a, b)).sum::<Matrix2<f64>>();
            let (twist, inner, cross, last) = (block(0, 0), block(1, 1), block(2, 1), block(2, 2));
            let (first, second) = (block(1, 0), block(2, 0));
            let mut own = Matrix4::zeros();
            own.fixed_view_mut::<2, 2>(0, 0).copy_from(&inner);
            own.fixed_view_mut::<2, 2>(2, 0).copy_from(&cross);
            own.fixed_view_mut::<2, 2>(0, 2).copy_from(&cross.transpose());
            own.fixed_view_mut::<2, 2>(2, 2).copy_from(&last);
            let mut coupling = Matrix4x2::zeros();
            coupling.fixed_view_mut::<2, 2>(0, 0).copy_from(&first);
            coupling.fixed_view_mut::<2, 2>(2, 0).copy_from(&second);
            // Positive definite, because no combination of the modes is free of strain. If rounding makes the
            // factorization fail, the element has no modes.
            let size = own.cholesky().map_or_else(Matrix4x2::zeros, |factor| -factor.solve(&coupling));
            let k = twist + coupling.transpose() * size;
            stiffness.push([k.m11, 0.5 * (k.m12 + k.m21), k.m22]);
            modes.push(size);
        }
        let stiffness = stiffness.chunks(LANES).map(|own| {
            let own = filled(own);
            std::array::from_fn(|i| own.map(|k| k[i]).into())
        });
        Self { ratio, stiffness: stiffness.collect(), modes }
    }
}

/// Part of an element's energy in q, in the rotated frame, and its derivatives in one state.
#[derive(Clone, Copy, Debug)]
struct Twisted<T> {
    /// K q̃, N.
    force: Vector2<T>,
    /// ∂w/∂θ, J.
    moment: T,
    /// ∂²w/∂q̃∂θ, N.
    cross: Vector2<T>,
    /// ∂²w/∂θ², J.
    second: T,
}

impl<T: Number> Twisted<T> {
    #[inline(always)]
    fn new(k: &Matrix2<T>, q: Vector2<T>) -> Self {
        let (force, rotated) = (apply(k, &q), quarter(q));
        let of_rotated = apply(k, &rotated);
        Self {
            force,
            moment: -force.dot(&rotated),
            cross: quarter(force) - of_rotated,
            second: rotated.dot(&of_rotated) - force.dot(&q),
        }
    }
}

/// Adds the parts of A and G in q; `k` is K, N/m.
///
/// G is θ_x zᵀ + z θ_xᵀ, with eigenvalues θ_x·z ± |θ_x||z|. Its positive part is ½ v vᵀ with v = s θ_x + z/s and s² =
/// |z|/|θ_x|.
#[inline(always)]
fn add_twist<T: Number>(
    sum: &mut ElementMatrix<4, T>,
    quad: &Quad<T>,
    k: &Matrix2<T>,
    r: Rotation<T>,
    twisted: &Twisted<T>,
    inverse_trace: T,
    tangent: Tangent,
) {
    let rotation_matrix = r.matrix();
    let rotated = product(&product(&rotation_matrix, k), &rotation_matrix.transpose());
    let rotated = rows(&rotated).map(|k| T::splat(tangent.warped) * k);
    sum.add_blocks(|a, b| {
        let product = quad.gamma[a] * quad.gamma[b];
        rotated.map(|k| product * k)
    });
    if tangent.geometric == 0.0 {
        return;
    }
    let half = T::splat(0.5);
    let mut follow = [zero_vector(); 4];
    let mut other = [zero_vector(); 4];
    for (a, g) in quad.centre.gradients.iter().enumerate() {
        let g = g * inverse_trace;
        follow[a] = r.apply(quarter(g));
        other[a] = r.apply(twisted.cross * quad.gamma[a] + quarter(g) * (half * twisted.second) - g * twisted.moment);
    }
    if tangent.definite {
        let norm = |v: &[Vector2<T>; 4]| v.iter().fold(T::zero(), |sum, v| sum + v.dot(v)).simd_sqrt();
        let ratio = (norm(&other) / norm(&follow)).simd_sqrt();
        let stands = ratio.simd_gt(T::zero()) & ratio.simd_lt(T::splat(f64::INFINITY));
        for (follow, other) in follow.iter_mut().zip(&mut other) {
            *follow = (*follow * ratio + *other / ratio).map(|v| v.select(stands, T::zero()));
            *other = *follow * T::splat(0.25);
        }
    }
    follow.iter_mut().for_each(|follow| *follow *= T::splat(tangent.geometric));
    sum.add_blocks(|a, b| {
        let (fa, fb, oa, ob) = (follow[a], follow[b], other[a], other[b]);
        [fa.x * ob.x + oa.x * fb.x, fa.x * ob.y + oa.x * fb.y, fa.y * ob.x + oa.y * fb.x, fa.y * ob.y + oa.y * fb.y]
    });
}

impl IncompatibleQuads {
    /// Builds the elements from rest nodes (m) and node numbers; `element` is the registry entry of the quadrilateral.
    pub fn new(element: &ElementType, nodes: &[Vector2<f64>], connectivity: &[u32]) -> Self {
        let numbers = Connectivity::new(connectivity);
        let points = numbers.elements.iter().map(|own| {
            let rest = own.map(|n| nodes[n as usize]);
            std::array::from_fn(|i| {
                let rule = element.points[i];
                bending_point(element, &rest, rule.at, rule.weight)
            })
        });
        let quads = numbers.batches().map(|(_, own)| {
            let quad = |lane: usize| Quad::new(element, &own.map(|node| nodes[node[lane] as usize]));
            Quad::side_by_side(std::array::from_fn(quad))
        });
        let condensed = Mutex::new(Vec::with_capacity(REMEMBERED));
        Self { points: points.collect(), quads: quads.collect(), nodes: numbers, condensed }
    }

    /// Returns the modes condensed for these moduli, computed only if their ratio is not in the cache.
    fn condensed(&self, moduli: Lame) -> Arc<Condensed> {
        // Without stiffness the ratio has no influence.
        let ratio = if moduli.mu == 0.0 { 0.0 } else { moduli.lambda / moduli.mu };
        let mut known = self.condensed.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known.iter().find(|c| c.ratio.to_bits() == ratio.to_bits()) {
            return found.clone();
        }
        let new = Arc::new(Condensed::new(ratio, &self.points));
        if known.len() == REMEMBERED {
            known.remove(0);
        }
        known.push(new.clone());
        new
    }

    /// See [`super::ElementLoops::sweep`]. Not inlined: the loops of all elements in one function are slower.
    #[inline(never)]
    pub(super) fn sweep(
        &self,
        moduli: Lame,
        u: Compensated<'_>,
        mut point_stress: impl FnMut([usize; LANES], &Matrix2<Lanes>) -> PointStress,
        Sums { force, magnitude, mut matrix }: Sums<'_>,
    ) {
        let condensed = self.condensed(moduli);
        let mu = Lanes::splat(moduli.mu);
        let batches = self.nodes.batches().zip(self.quads.iter().zip(&condensed.stiffness));
        for ((numbers, nodes), (quad, k)) in batches {
            let u = u.relative_side_by_side(nodes);
            let h = quad.centre.displacement_gradient(&u);
            let PointStress { rotation: r, trace, stress } = point_stress(numbers.all(), &h);
            let inverse_trace = inverse_trace(r, &h);
            let k = symmetric(*k) * mu;
            let twisted = Twisted::new(&k, r.apply_inverse(quad.twist(&u)));
            let stress = stress * quad.centre.area;
            let (twist, couple) = (r.apply(twisted.force), twisted.moment * inverse_trace);
            let mut own = [zero_vector(); 4];
            for ((own, g), gamma) in own.iter_mut().zip(&quad.centre.gradients).zip(&quad.gamma) {
                *own = apply(&stress, g) + twist * *gamma + r.apply(quarter(*g)) * couple;
            }
            add_forces(numbers.count, nodes, &own, force, magnitude);
            if let Some(MatrixSum { tangent, slots, values }) = &mut matrix {
                let mut sum = ElementMatrix::zero();
                sum.add(&quad.centre, r, quad.centre.tangent(moduli, trace, *tangent));
                add_twist(&mut sum, quad, &k, r, &twisted, inverse_trace, *tangent);
                sum.scatter(numbers.first, numbers.count, slots, values);
            }
        }
    }

    fn elements(&self) -> impl Iterator<Item = (&[u32; 4], Quad)> {
        let quads = self.quads.iter().flat_map(|quad| (0..LANES).map(move |lane| quad.lane(lane)));
        self.nodes.elements.iter().zip(quads)
    }

    /// Iterates over the elements: nodes, rest geometry, and K over μ.
    fn with_twist<'a>(&'a self, condensed: &'a Condensed) -> impl Iterator<Item = (&'a [u32; 4], Quad, [f64; 3])> {
        let stiffness = condensed.stiffness.iter().flat_map(|k| (0..LANES).map(|l| k.map(|k| k.extract(l))));
        self.elements().zip(stiffness).map(|((nodes, quad), k)| (nodes, quad, k))
    }
}

/// Returns cosine and sine of half the angle from the first rotation to the second, for an angle of at most 180°.
#[inline(always)]
fn half_rotation<T: Number>([r0, r1]: [Rotation<T>; 2]) -> Rotation<T> {
    let (c, s) = (r0.c * r1.c + r0.s * r1.s, r0.c * r1.s - r0.s * r1.c);
    let half = T::splat(0.5);
    // Compute the larger of cosine and sine first and the other from it, so that no digits cancel.
    let larger = (half * (T::one() + c.simd_abs())).simd_sqrt();
    let smaller = half * s / larger;
    let ahead = c.simd_ge(T::zero());
    Rotation { c: larger.select(ahead, smaller.simd_abs()), s: smaller.select(ahead, larger.simd_copysign(s)) }
}

impl Elements for IncompatibleQuads {
    fn rotation_count(&self) -> usize {
        self.nodes.elements.len()
    }

    fn point_count(&self) -> usize {
        4 * self.nodes.elements.len()
    }

    fn points_per_element(&self) -> usize {
        4
    }

    fn rotation_of(&self, point: usize) -> usize {
        point / 4
    }

    fn point_area(&self, point: usize) -> f64 {
        self.points[point / 4][point % 4].area
    }

    fn rotations(&self, u: Compensated<'_>, r: &mut [Rotation]) {
        let mut rotations = Rotations::Follow(r);
        for ((numbers, nodes), quad) in self.nodes.batches().zip(&self.quads) {
            rotations.evaluate(numbers.all(), &quad.centre.displacement_gradient(&u.relative_side_by_side(nodes)));
        }
    }

    fn add_rounding(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation], bound: &mut [Vector2<f64>]) {
        let condensed = self.condensed(moduli);
        for ((nodes, quad, k), &r) in self.with_twist(&condensed).zip(r) {
            let own = Rounded::relative(u, nodes);
            let seen = RoundedPoint::new(&quad.centre, moduli, r, &own);
            let h = quad.centre.displacement_gradient(&own.map(|own| own.value));
            let k = symmetric(k) * moduli.mu;
            let q = Rounded::sum(&own, &quad.gamma);
            let twisted = Twisted::new(&k, r.apply_inverse(q.value));
            let inverse_trace = inverse_trace(r, &h);
            // In the rotated frame |R| is its own transpose.
            let size = seen.rotation * q.value.abs();
            let dq = seen.rotation * q.error + size * (8.0 * UNIT) + seen.rotated * q.value.abs() * seen.angle;
            let (force, across) = (twisted.force.abs(), Vector2::new(size.y, size.x));
            let dforce = k.abs() * (dq + size * (5.0 * UNIT));
            let dmoment = (dforce + force * (4.0 * UNIT)).dot(&across) + force.dot(&Vector2::new(dq.y, dq.x));
            let moment = force.dot(&across);
            let couple = moment * inverse_trace;
            let dcouple = dmoment * inverse_trace + couple * (seen.trace + 4.0 * UNIT);
            let twist = seen.rotation * force;
            let dtwist = seen.rotation * dforce + twist * (10.0 * UNIT) + seen.rotated * force * seen.angle;
            for ((&node, g), gamma) in nodes.iter().zip(&quad.centre.gradients).zip(&quad.gamma) {
                let g_across = Vector2::new(g.y.abs(), g.x.abs());
                let rotated = seen.rotation * g_across * (dcouple + couple * 10.0 * UNIT)
                    + seen.rotated * g_across * (couple * seen.angle);
                bound[node as usize] += seen.force(g, 3.0) + dtwist * gamma.abs() + rotated;
            }
        }
    }

    /// Uses [`DiscreteGradient`] for the part at the centre. The difference of ½ q̃ K q̃ is K q̃ₘ·(q̃₁ − q̃₀), q̃ₘ
    /// their mean. With R̄ half way between R₀ and R₁, δ the angle between these, q̂ = R̄ᵀq and b̂ = tr((R̄ J)ᵀF),
    ///
    /// q̃₁ − q̃₀ = cos(δ/2) (q̂₁ − q̂₀) − sin(δ/2) J (q̂₀ + q̂₁), and sin(δ/2) = (b̂₁ − b̂₀)/(tr S₀ + tr S₁):
    ///
    /// linear in x₁ − x₀ with factors that rotate with the body. So the force cos(δ/2) γₐ R̄ K q̃ₘ − (K q̃ₘ·J(q̂₀ +
    /// q̂₁)) R̄ J ∇Nₐ/(tr S₀ + tr S₁) does work equal to the exact difference of the energies, and has no moment about
    /// the mean of both states (a discrete gradient as required by Gonzalez 2000, without his division by |x₁ − x₀|²).
    fn linearize_between(
        &self,
        moduli: Lame,
        [(u0, r0), (u1, r1)]: [(Compensated<'_>, &[Rotation]); 2],
        Sums { force, magnitude, mut matrix }: Sums<'_>,
    ) {
        let condensed = self.condensed(moduli);
        let (half, mu) = (Lanes::splat(0.5), Lanes::splat(moduli.mu));
        let batches = self.nodes.batches().zip(self.quads.iter().zip(&condensed.stiffness));
        for ((numbers, nodes), (quad, k)) in batches {
            let u = [u0, u1].map(|u| u.relative_side_by_side(nodes));
            let r = [r0, r1].map(|r| rotations_at(r, numbers.all()));
            let h = u.map(|u| quad.centre.displacement_gradient(&u));
            let q = u.map(|u| quad.twist(&u));
            let between = DiscreteGradient::new(h, r);
            let stress = between.stress(moduli) * quad.centre.area;
            let k = symmetric(*k) * mu;
            let half_rotation = half_rotation(r);
            // R̄ is R₁ rotated back by δ/2.
            let middle = Rotation {
                c: r[1].c * half_rotation.c + r[1].s * half_rotation.s,
                s: r[1].s * half_rotation.c - r[1].c * half_rotation.s,
            };
            let mean = apply(&k, &((r[0].apply_inverse(q[0]) + r[1].apply_inverse(q[1])) * half));
            let sum_of_q = middle.apply_inverse(q[0] + q[1]);
            // Where a rotation is undefined (crushed element), the rotation term is zero. Clamping 1 / tr S would break
            // energy conservation.
            let [(t0, follows0), (t1, follows1)] = [following(r[0], &h[0]), following(r[1], &h[1])];
            let inverse_sum = Lanes::ONE / (t0 + t1).simd_max(Lanes::splat(f64::MIN_POSITIVE));
            let inverse_sum = inverse_sum.select(follows0 & follows1, Lanes::ZERO);
            let (twist, couple) = (middle.apply(mean) * half_rotation.c, -mean.dot(&quarter(sum_of_q)) * inverse_sum);
            let mut own = [zero_vector(); 4];
            for ((own, g), gamma) in own.iter_mut().zip(&quad.centre.gradients).zip(&quad.gamma) {
                *own = apply(&stress, g) + twist * *gamma + middle.apply(quarter(*g)) * couple;
            }
            add_forces(numbers.count, nodes, &own, force, magnitude);
            if let Some(MatrixSum { tangent, slots, values }) = &mut matrix {
                let mut sum = ElementMatrix::zero();
                sum.add(&quad.centre, between.rotation, quad.centre.tangent(moduli, between.trace, *tangent));
                let twisted = Twisted::new(&k, sum_of_q * half);
                let twice = inverse_sum + inverse_sum;
                add_twist(&mut sum, quad, &k, middle, &twisted, twice, *tangent);
                sum.scatter(numbers.first, numbers.count, slots, values);
            }
        }
    }

    /// Adds two parts. The part at the centre is that of one quadrature point. The part in q uses F₀ᵀ q, which is q in
    /// the body's frame, its rate and K. Like Green's strain, F₀ᵀ q is quadratic in x and does not change under rigid
    /// motion: it is the ξη part of Green's strain.
    fn viscous_force(&self, moduli: Lame, u: &[Vector2<f64>], rate: StrainRate<'_>, force: &mut [Vector2<f64>]) {
        let condensed = self.condensed(moduli);
        for (nodes, quad, k) in self.with_twist(&condensed) {
            let own = at_nodes(nodes, u);
            let (f, q) = (Matrix2::identity() + quad.centre.displacement_gradient(&own), quad.twist(&own));
            let (mut strain_rate, mut twist_rate) = (Matrix2::zeros(), Vector2::zeros());
            match rate {
                StrainRate::Difference(terms) => {
                    for (factor, u) in terms {
                        let u = at_nodes(nodes, u);
                        let (h, q) = (quad.centre.displacement_gradient(&u), quad.twist(&u));
                        strain_rate += (h + h.transpose() + h.transpose() * h) * (0.5 * factor);
                        twist_rate += (q + h.transpose() * q) * *factor;
                    }
                }
                StrainRate::Velocity(v) => {
                    let v = at_nodes(nodes, v);
                    let gradient = quad.centre.displacement_gradient(&v);
                    let rate = f.transpose() * gradient;
                    strain_rate = (rate + rate.transpose()) * 0.5;
                    twist_rate = gradient.transpose() * q + f.transpose() * quad.twist(&v);
                }
            }
            let stress = f * moduli.stress(&strain_rate) * quad.centre.area;
            let twist = symmetric(k) * twist_rate * moduli.mu;
            let rotated = f * twist;
            for ((&node, g), gamma) in nodes.iter().zip(&quad.centre.gradients).zip(&quad.gamma) {
                force[node as usize] += stress * g + q * g.dot(&twist) + rotated * *gamma;
            }
        }
    }

    fn viscous_matrix(&self, moduli: Lame, u: &[Vector2<f64>], slots: &[u32], values: &mut [f64]) {
        let Lame { lambda, mu } = moduli;
        let condensed = self.condensed(moduli);
        for (e, (nodes, quad, k)) in self.with_twist(&condensed).enumerate() {
            let own = at_nodes(nodes, u);
            let (f, q) = (Matrix2::identity() + quad.centre.displacement_gradient(&own), quad.twist(&own));
            let k = symmetric(k) * mu;
            let left = f * f.transpose() * mu;
            let gradients = &quad.centre.gradients;
            let rotated = gradients.map(|g| f * g);
            // The derivative of F₀ᵀ q with respect to every node.
            let mut twist = [Matrix2::zeros(); 4];
            for ((twist, g), gamma) in twist.iter_mut().zip(gradients).zip(&quad.gamma) {
                *twist = g * q.transpose() + f.transpose() * *gamma;
            }
            let stiff = twist.map(|twist| twist.transpose() * k);
            let mut sum = ElementMatrix::<4, f64>::zero();
            sum.add_blocks(|a, b| {
                let (g, h) = (rotated[a], rotated[b]);
                let plane =
                    g * h.transpose() * lambda + h * g.transpose() * mu + left * gradients[a].dot(&gradients[b]);
                rows(&(plane * quad.centre.area + stiff[a] * twist[b]))
            });
            sum.scatter(e, 1, slots, values);
        }
    }

    fn energy(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation]) -> f64 {
        let condensed = self.condensed(moduli);
        let mut energy = 0.0;
        let half_mu = Lanes::splat(0.5 * moduli.mu);
        for ((numbers, nodes), (quad, k)) in self.nodes.batches().zip(self.quads.iter().zip(&condensed.stiffness)) {
            let (u, r) = (u.relative_side_by_side(nodes), rotations_at(r, numbers.all()));
            let strain = warped_strain(r, &quad.centre.displacement_gradient(&u));
            let q = r.apply_inverse(quad.twist(&u));
            let of_twist = half_mu * q.dot(&apply(&symmetric(*k), &q));
            energy += sum_of_lanes(quad.centre.area * moduli.energy_density(&strain) + of_twist, numbers.count);
        }
        energy
    }

    fn smallest_area_ratio(&self, u: &[Vector2<f64>]) -> f64 {
        let mut smallest = f64::INFINITY;
        for ((nodes, quad), points) in self.elements().zip(&self.points) {
            let u = at_nodes(nodes, u);
            let (h, q) = (quad.centre.displacement_gradient(&u), quad.twist(&u));
            for point in points {
                let h = h + q * point.gradients[0].transpose();
                smallest = smallest.min((1.0 + h.m11) * (1.0 + h.m22) - h.m12 * h.m21);
            }
        }
        smallest
    }

    /// Computes H from the shape functions; the strain also contains the modes.
    fn visit_strains(&self, moduli: Lame, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>) {
        let condensed = self.condensed(moduli);
        let modes = self.points.iter().zip(&condensed.modes);
        let mut number = 0;
        for (((nodes, quad), (points, modes)), &r) in self.elements().zip(modes).zip(r) {
            let u = at_nodes(nodes, u);
            let (h, q) = (quad.centre.displacement_gradient(&u), quad.twist(&u));
            let size = modes * r.apply_inverse(q);
            let (first, second) = (Vector2::new(size[0], size[1]), Vector2::new(size[2], size[3]));
            for point in points {
                let [twist, a, b] = point.gradients;
                let h = h + q * twist.transpose();
                let inner = first * a.transpose() + second * b.transpose();
                visit(number, &h, &(warped_strain(r, &h) + (inner + inner.transpose()) * 0.5));
                number += 1;
            }
        }
    }
}
