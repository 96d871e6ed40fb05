//! Stiffness of an element as in the article: Ke, R Ke and R Ke Rᵀ (eqs. 1–3).

use nalgebra::DMatrix;

use crate::element::QuadraturePoint;
use crate::material::Lame;
use crate::rotation::Rotation;

/// Matrices of one element. The solver never forms them one element at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementStiffness {
    /// Ke, 2N×2N, N/m; unknowns x₁ y₁ x₂ y₂ ….
    pub ke: DMatrix<f64>,
}

impl ElementStiffness {
    /// Computes Ke = ∫ Bᵀ C B t dA (eqs. 1, 3), summed over quadrature points; the moduli are times the thickness t,
    /// N/m.
    pub fn new<const N: usize>(points: &[QuadraturePoint<N>], moduli: Lame) -> Self {
        let mut ke = DMatrix::zeros(2 * N, 2 * N);
        for (point, a, b) in points.iter().flat_map(|p| (0..N).flat_map(move |a| (0..N).map(move |b| (p, a, b)))) {
            let mut block = ke.fixed_view_mut::<2, 2>(2 * a, 2 * b);
            block += point.stiffness_block(moduli, a, b);
        }
        Self { ke }
    }

    fn turn(&self, r: Rotation) -> DMatrix<f64> {
        let mut turn = DMatrix::zeros(self.ke.nrows(), self.ke.nrows());
        for a in 0..self.ke.nrows() / 2 {
            turn.fixed_view_mut::<2, 2>(2 * a, 2 * a).copy_from(&r.matrix());
        }
        turn
    }

    /// Returns R Ke, the article's m_cMatRK.
    pub fn rk(&self, r: Rotation) -> DMatrix<f64> {
        self.turn(r) * &self.ke
    }

    /// Returns R Ke Rᵀ, the article's m_cMatRKRT.
    pub fn rkrt(&self, r: Rotation) -> DMatrix<f64> {
        self.rk(r) * self.turn(r).transpose()
    }
}

#[cfg(test)]
mod tests;
