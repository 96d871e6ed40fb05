//! The discrete gradient of the corotated energy between two deformation gradients, in closed form.

use nalgebra::Matrix2;

use crate::material::Lame;
use crate::rotation::{Rotation, polar_or};

/// What two deformation gradients F₀ = I + H₀ and F₁ = I + H₁ have between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteGradient {
    /// F̄ − R̄, F̄ = (F₀ + F₁)/2.
    strain: Matrix2<f64>,
    /// R̄ = (r₀R₀ + r₁R₁)/(r₀ + r₁), r = tr S: no rotation in general.
    mean_rotation: Matrix2<f64>,
    /// R̄/|R̄|.
    pub rotation: Rotation,
    /// t̄ = (r₀ + r₁)/2 − 2.
    pub trace: f64,
}

impl DiscreteGradient {
    /// Between the displacement gradients H and rotations of two states. Linear theory's is the stress of the mean
    /// strain, and not this one with no rotation: the skew part of F̄ − R̄ vanishes only with the polar factors.
    #[must_use]
    #[inline]
    pub fn new([h0, h1]: [Matrix2<f64>; 2], [r0, r1]: [Rotation; 2]) -> Self {
        // R − I and r − 2 = tr(RᵀF) − 2, written so that small strains keep their digits.
        let turn = |r: Rotation| {
            let c_minus_1 = if r.c > 0.0 { -r.s * r.s / (1.0 + r.c) } else { r.c - 1.0 };
            Matrix2::new(c_minus_1, -r.s, r.s, c_minus_1)
        };
        let (turn0, turn1) = (turn(r0), turn(r1));
        let stretch = |h: &Matrix2<f64>, r: Rotation, turn: &Matrix2<f64>| {
            turn.trace() + r.c * (h.m11 + h.m22) + r.s * (h.m21 - h.m12)
        };
        let (t0, t1) = (stretch(&h0, r0, &turn0), stretch(&h1, r1, &turn1));
        let sum = 4.0 + t0 + t1;
        // Crushed to nothing in both states: no rotation is better than another.
        let (w0, w1) = if sum.abs() > 0.0 { ((2.0 + t0) / sum, (2.0 + t1) / sum) } else { (0.5, 0.5) };
        let mean_turn = turn0 * w0 + turn1 * w1;
        let mean_rotation = Matrix2::identity() + mean_turn;
        Self {
            strain: (h0 + h1) * 0.5 - mean_turn,
            mean_rotation,
            rotation: polar_or(&mean_rotation, r1),
            trace: 0.5 * (t0 + t1),
        }
    }

    /// P = 2μ (F̄ − R̄) + λ t̄ R̄, Pa.
    #[must_use]
    #[inline]
    pub fn stress(&self, lame: Lame) -> Matrix2<f64> {
        self.strain * (2.0 * lame.mu) + self.mean_rotation * (lame.lambda * self.trace)
    }
}
