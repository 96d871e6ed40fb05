//! Quadrature points: gradients, force and tangent.

use nalgebra::{Matrix2, SimdValue, Vector2};

use super::{ElementType, Tangent, warped_strain};
use crate::material::Lame;
use crate::rotation::Rotation;
use crate::simd::{LANES, Lanes, Number, lane, outer, side_by_side, zero_matrix, zero_vector};

/// Quadrature point of an element with `N` nodes, at rest; with SIMD `T`, one point per lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint<const N: usize, T: Number = f64> {
    /// ∇Nₐ with respect to the rest position, 1/m.
    pub gradients: [Vector2<T>; N],
    /// Quadrature weight times Jacobian, m².
    pub area: T,
}

/// Moduli of a point's tangent times its area, N m; see [`QuadraturePoint::tangent`].
#[derive(Clone, Copy, Debug)]
pub(super) struct PointTangent<T> {
    pub axial: T,
    pub lambda: T,
    pub plus: T,
    pub minus: T,
}

/// Lower bound of tr S in G: one percent of its value at rest. In a crushed body tr S vanishes and G is unbounded; the
/// bound keeps the step finite.
pub(super) const SMALLEST_STRETCH_TRACE: f64 = 0.02;

impl<const N: usize> QuadraturePoint<N> {
    /// Returns the point at `at` of an element with these rest nodes. [`crate::mesh::Mesh`] has checked that the
    /// Jacobian there is positive.
    pub fn new(element: &ElementType, nodes: &[Vector2<f64>], at: [f64; 2], weight: f64) -> Self {
        let jacobian = element.jacobian(nodes, at);
        let inverse = jacobian.try_inverse().unwrap_or_default().transpose();
        let mut gradients = [Vector2::zeros(); N];
        for (g, local) in gradients.iter_mut().zip((element.local_gradients)(at)) {
            *g = inverse * local;
        }
        Self { gradients, area: weight * jacobian.determinant() }
    }

    /// Returns the warped element force R Ke (Rᵀ x − X), N, for a displacement gradient: the first Piola–Kirchhoff
    /// stress R T of the corotated energy times the point's area, applied to ∇Nₐ.
    pub fn warped_force(&self, moduli: Lame, r: Rotation, h: &Matrix2<f64>) -> [Vector2<f64>; N] {
        let stress = r.matrix() * moduli.stress(&warped_strain(r, h)) * self.area;
        self.gradients.map(|g| stress * g)
    }

    /// Returns this point's part of the block of nodes a and b in Ke, N/m: v (λ g hᵀ + μ (g·h) I + μ h gᵀ) with g =
    /// ∇Nₐ, h = ∇N_b.
    pub fn stiffness_block(&self, moduli: Lame, a: usize, b: usize) -> Matrix2<f64> {
        let (g, h) = (self.gradients[a], self.gradients[b]);
        let shear = Matrix2::identity() * g.dot(&h) + h * g.transpose();
        (g * h.transpose() * moduli.lambda + shear * moduli.mu) * self.area
    }
}

impl<const N: usize> QuadraturePoint<N, Lanes> {
    /// Packs points of several elements into lanes.
    pub(super) fn side_by_side(own: [QuadraturePoint<N>; LANES]) -> Self {
        Self {
            gradients: std::array::from_fn(|a| side_by_side(own.map(|point| point.gradients[a]))),
            area: own.map(|point| point.area).into(),
        }
    }

    /// Returns the point of the element in one lane.
    #[inline(always)]
    pub(super) fn lane(&self, of: usize) -> QuadraturePoint<N> {
        let mut gradients = [zero_vector(); N];
        gradients.iter_mut().zip(&self.gradients).for_each(|(own, g)| *own = lane(g, of));
        QuadraturePoint { gradients, area: self.area.extract(of) }
    }
}

impl<const N: usize, T: Number> QuadraturePoint<N, T> {
    /// Returns the displacement gradient H = F − I = Σ uₐ ⊗ ∇Nₐ, which is Σ (uₐ − u₁) ⊗ ∇Nₐ.
    ///
    /// Computed from differences of displacements, not from positions: small strains keep their digits however large
    /// the coordinates and the displacement of the element.
    #[inline(always)]
    pub fn displacement_gradient(&self, u: &[Vector2<T>; N]) -> Matrix2<T> {
        let mut h = zero_matrix();
        for (own, g) in u.iter().zip(&self.gradients).skip(1) {
            h += outer(&(own - u[0]), g);
        }
        h
    }

    /// Returns the moduli of this point's part of a tangent; `trace` is the trace of the strain.
    ///
    /// With g = R ∇Nₐ and h = R ∇N_b, the block of R Ke Rᵀ is K_ab = v (λ g hᵀ + μ (g·h) I + μ h gᵀ): rotating the
    /// gradients is cheaper than rotating the matrix and gives the same result.
    ///
    /// G, the derivative of the force through R, adds in F-space (tr T / tr S) τ τᵀ with τ = vec(R J)/√2, J the
    /// rotation by 90°, T the Biot stress: tension makes it positive, compression negative. In the plane J exchanges
    /// the components of g, so that with s = ½ v tr T / tr S it changes μ into μ + s and μ − s, at no further cost.
    #[inline(always)]
    pub(super) fn tangent(&self, moduli: Lame, trace: T, tangent: Tangent) -> PointTangent<T> {
        let Lame { lambda, mu } = moduli;
        let stretch = (T::splat(2.0) + trace).simd_max(T::splat(SMALLEST_STRETCH_TRACE));
        let ratio = T::splat(mu + lambda) * trace / stretch;
        let ratio = if tangent.definite { ratio.simd_max(T::zero()) } else { ratio };
        let s = T::splat(tangent.geometric) * ratio;
        let [axial, lambda, mu] = [lambda + 2.0 * mu, lambda, mu].map(|v| T::splat(tangent.warped * v));
        let [axial, lambda, plus, minus] = [axial, lambda, mu + s, mu - s].map(|v| self.area * v);
        PointTangent { axial, lambda, plus, minus }
    }
}
