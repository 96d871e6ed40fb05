//! Stiffness of an element as in the article: Ke, R Ke, R Ke Rᵀ and R Ke X (eqs. 1–3).
//!
//! The triangle of `docs/theory/warped-stiffness.md`, rotated by 90° and stretched by a tenth along its first side, under
//! E = 1 Pa, ν = 0 and t = 1 m: the force at corner 1 is (0, 0.05) N.
//!
//! ```
//! use nalgebra::{DVector, Matrix2, Vector2};
//! use warpbeam::ElementKind;
//! use warpbeam::article::stiffness::ElementStiffness;
//! use warpbeam::element::QuadraturePoint;
//! use warpbeam::element::Lame;
//! use warpbeam::rotation::polar;
//!
//! let rest = [Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)];
//! let element = ElementKind::T3.entry();
//! let point = QuadraturePoint::<3>::new(element, &rest, element.points[0].at, element.points[0].weight);
//! let stiffness = ElementStiffness::new(&[point], Lame { lambda: 0.0, mu: 0.5 });
//!
//! let r = polar(&Matrix2::new(0.0, -1.0, 1.1, 0.0)).unwrap();
//! let x = DVector::from_row_slice(&[0.0, 0.0, 0.0, 1.1, -1.0, 0.0]);
//! let at_rest = DVector::from_row_slice(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
//! let force = stiffness.rkrt(r) * x - stiffness.force_offset(r, &at_rest);
//! assert!((force - DVector::from_row_slice(&[0.0, -0.05, 0.0, 0.05, 0.0, 0.0])).norm() < 1e-12);
//! ```

use nalgebra::{DMatrix, DVector};

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
    #[must_use]
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
    #[must_use]
    pub fn rk(&self, r: Rotation) -> DMatrix<f64> {
        self.turn(r) * &self.ke
    }

    /// Returns R Ke Rᵀ, the article's m_cMatRKRT.
    #[must_use]
    pub fn rkrt(&self, r: Rotation) -> DMatrix<f64> {
        self.rk(r) * self.turn(r).transpose()
    }

    /// Returns the force offset R Ke X, N, for rest positions X of the element's nodes.
    #[must_use]
    pub fn force_offset(&self, r: Rotation, rest: &DVector<f64>) -> DVector<f64> {
        self.rk(r) * rest
    }
}
