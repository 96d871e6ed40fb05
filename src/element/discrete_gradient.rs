//! The discrete gradient of the corotated energy between two deformation gradients, in closed form.

use nalgebra::Matrix2;

use super::cosine_minus_1;
use crate::material::Lame;
use crate::rotation::{Rotation, polar_or};
use crate::simd::{Number, one_plus};

/// Discrete gradient between two deformation gradients F₀ = I + H₀ and F₁ = I + H₁.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteGradient<T: Number = f64> {
    /// Mean strain F̄ − R̄, where F̄ = (F₀ + F₁)/2 and R̄ is the mean rotation.
    strain: Matrix2<T>,
    /// R̄ = (r₀R₀ + r₁R₁)/(r₀ + r₁), r = tr S: not a rotation in general.
    mean_rotation: Matrix2<T>,
    /// R̄/|R̄|.
    pub rotation: Rotation<T>,
    /// t̄ = (r₀ + r₁)/2 − 2.
    pub trace: T,
}

impl<T: Number> DiscreteGradient<T> {
    /// Returns the discrete gradient between the displacement gradients H and rotations of two states. Zero rotations
    /// do not give that of linear theory, which is the stress of the mean strain: the skew part of F̄ − R̄ vanishes
    /// only for the polar factors.
    #[inline(always)]
    pub fn new([h0, h1]: [Matrix2<T>; 2], [r0, r1]: [Rotation<T>; 2]) -> Self {
        let half = T::splat(0.5);
        // R − I and r − 2 = tr(RᵀF) − 2, written so that small strains keep their digits.
        let turn = |r: Rotation<T>| {
            let c_minus_1 = cosine_minus_1(r);
            Matrix2::new(c_minus_1, -r.s, r.s, c_minus_1)
        };
        let (turn0, turn1) = (turn(r0), turn(r1));
        let stretch = |h: &Matrix2<T>, r: Rotation<T>, turn: &Matrix2<T>| {
            turn.m11 + turn.m22 + r.c * (h.m11 + h.m22) + r.s * (h.m21 - h.m12)
        };
        let (t0, t1) = (stretch(&h0, r0, &turn0), stretch(&h1, r1, &turn1));
        let two = T::splat(2.0);
        let sum = two + two + t0 + t1;
        // If tr S vanishes in both states, both rotations get the weight ½.
        let stands = sum.simd_abs().simd_gt(T::zero());
        let weight = |t: T| ((two + t) / sum).select(stands, half);
        let mean_turn = turn0 * weight(t0) + turn1 * weight(t1);
        let mean_rotation = one_plus(&mean_turn);
        Self {
            strain: (h0 + h1) * half - mean_turn,
            mean_rotation,
            rotation: polar_or(&mean_rotation, r1),
            trace: half * (t0 + t1),
        }
    }

    /// Returns P = 2μ (F̄ − R̄) + λ t̄ R̄, Pa.
    #[inline(always)]
    pub fn stress(&self, lame: Lame) -> Matrix2<T> {
        self.strain * T::splat(2.0 * lame.mu) + self.mean_rotation * (T::splat(lame.lambda) * self.trace)
    }
}
