//! Elements: shape functions, a quadrature rule, and the linear stiffness Ke = ∫ Bᵀ C B t dA they make. Pure.
//!
//! Assembly, methods and drawing see an element only as a list of [`QuadraturePoint`]s: a weight and the gradients of
//! its N shape functions.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use crate::material::Lame;
use crate::rotation::Rotation;
use crate::scene::ElementKind;

mod side;
pub mod t3;
pub mod t6;

pub use side::{side_shape, side_weights};

/// What a mesh, its loads and its picture ask of an element, whichever it is.
impl ElementKind {
    /// One sentence for tooltips.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::T3 => t3::ABOUT,
            Self::T6 => t6::ABOUT,
        }
    }

    /// Nodes a triangle: corners, then the midpoints of sides 12, 23, 31 where there are any.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            Self::T3 => t3::NODES,
            Self::T6 => t6::NODES,
        }
    }

    /// Degree of the shape functions: a side has one node more than this.
    #[must_use]
    pub fn degree(self) -> u32 {
        match self {
            Self::T3 => 1,
            Self::T6 => 2,
        }
    }

    /// Nₐ at the area coordinates `l`.
    #[must_use]
    pub fn shape(self, l: [f64; 3]) -> Vec<f64> {
        match self {
            Self::T3 => t3::shape(l).to_vec(),
            Self::T6 => t6::shape(l).to_vec(),
        }
    }

    /// (∂Nₐ/∂l₂, ∂Nₐ/∂l₃) at the area coordinates `l`, with l₁ = 1 − l₂ − l₃.
    #[must_use]
    pub fn local_gradients(self, l: [f64; 3]) -> Vec<Vector2<f64>> {
        match self {
            Self::T3 => t3::local_gradients().to_vec(),
            Self::T6 => t6::local_gradients(l).to_vec(),
        }
    }

    /// Area coordinates of the quadrature points.
    #[must_use]
    pub fn quadrature_points(self) -> &'static [[f64; 3]] {
        match self {
            Self::T3 => &t3::POINTS,
            Self::T6 => &t6::POINTS,
        }
    }

    /// VTK's number for the element.
    #[must_use]
    pub fn vtk_cell_type(self) -> u8 {
        match self {
            Self::T3 => 5,
            Self::T6 => 22,
        }
    }
}

/// One quadrature point of an element with `N` nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint<const N: usize> {
    /// Nₐ.
    pub shape: [f64; N],
    /// ∇Nₐ with respect to the rest position, 1/m.
    pub gradients: [Vector2<f64>; N],
    /// Quadrature weight times Jacobian times thickness, m³.
    pub volume: f64,
}

impl<const N: usize> QuadraturePoint<N> {
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

    /// The blocks K_ab of R Ke Rᵀ, N/m, for this point's share of Ke, article eq. (2).
    ///
    /// With g = R ∇Nₐ and h = R ∇N_b, K_ab = v (λ g hᵀ + μ (g·h) I + μ h gᵀ): turning the gradients is cheaper than
    /// turning the matrix, and gives the same. `block(a, b, K_ab)` is called for b ≤ a.
    #[inline]
    pub fn warped_stiffness(&self, lame: Lame, r: Rotation, mut block: impl FnMut(usize, usize, Matrix2<f64>)) {
        let g = self.gradients.map(|g| r.apply(g));
        let (lambda, mu) = (self.volume * lame.lambda, self.volume * lame.mu);
        for a in 0..N {
            for b in 0..=a {
                let shear = mu * g[a].dot(&g[b]);
                let k = g[a] * (lambda * g[b]).transpose() + g[b] * (mu * g[a]).transpose();
                block(a, b, Matrix2::new(k.m11 + shear, k.m12, k.m21, k.m22 + shear));
            }
        }
    }

    /// The blocks of G, the geometric part of the exact tangent A + G, N/m.
    ///
    /// The warped force is the exact gradient of the corotated energy; its derivative through R adds, in F-space,
    /// (tr T / tr S) τ τᵀ with τ = vec(R J)/√2, J a quarter turn, T the Biot stress. Tension makes it positive,
    /// compression negative. `share` of tr T / tr S picks the part wanted: all of it, or only what is positive.
    #[inline]
    pub fn geometric_stiffness(
        &self,
        lame: Lame,
        r: Rotation,
        h: &Matrix2<f64>,
        share: GeometricShare,
        mut block: impl FnMut(usize, usize, Matrix2<f64>),
    ) {
        let strain = warped_strain(r, h);
        let trace = 2.0 + strain.trace();
        // Where the body is crushed to nothing tr S vanishes and the term has no bound; the floor keeps the step finite.
        let ratio = (2.0 * (lame.mu + lame.lambda)) * strain.trace() / trace.max(SMALLEST_STRETCH_TRACE);
        let ratio = match share {
            GeometricShare::All => ratio,
            GeometricShare::Tensile => ratio.max(0.0),
        };
        let quarter = Rotation { c: -r.s, s: r.c };
        let scaled = 0.5 * self.volume * ratio;
        let turned = self.gradients.map(|g| quarter.apply(g));
        for a in 0..N {
            for b in 0..=a {
                block(a, b, turned[a] * (scaled * turned[b]).transpose());
            }
        }
    }

    /// The warped element force R Ke (Rᵀ x − X), N, given the displacement gradient.
    #[must_use]
    #[inline]
    pub fn warped_force(&self, lame: Lame, r: Rotation, h: &Matrix2<f64>) -> [Vector2<f64>; N] {
        let stress = r.matrix() * biot_stress(lame, &warped_strain(r, h)) * self.volume;
        self.gradients.map(|g| stress * g)
    }
}

/// Which part of G is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometricShare {
    /// All of it: A + G is the exact Hessian.
    All,
    /// Where it is positive: A + max(G, 0) is positive definite, and its steps descend.
    Tensile,
}

/// Floor of tr S in G: one percent of its value at rest.
const SMALLEST_STRETCH_TRACE: f64 = 0.02;

/// The strain the element sees once turned back, sym(Rᵀ F) − I with F = I + H.
///
/// With R the polar factor of F this is the Biot strain S − I. Written with c − 1 = −s²/(1 + c), so that small strains
/// under small rotations keep their digits.
#[must_use]
#[inline]
pub fn warped_strain(r: Rotation, h: &Matrix2<f64>) -> Matrix2<f64> {
    let (c, s) = (r.c, r.s);
    let c_minus_1 = if c > 0.0 { -s * s / (1.0 + c) } else { c - 1.0 };
    let xx = c_minus_1 + c * h.m11 + s * h.m21;
    let yy = c_minus_1 - s * h.m12 + c * h.m22;
    // The ±s of Rᵀ cancel in the symmetric part.
    let xy = 0.5 * (c * (h.m12 + h.m21) + s * (h.m22 - h.m11));
    Matrix2::new(xx, xy, xy, yy)
}

/// T = 2 μ ε + λ tr(ε) I, Pa.
#[must_use]
#[inline]
pub fn biot_stress(lame: Lame, strain: &Matrix2<f64>) -> Matrix2<f64> {
    strain * (2.0 * lame.mu) + Matrix2::identity() * (lame.lambda * strain.trace())
}

/// ψ = μ ‖ε‖² + λ/2 tr²(ε), J/m³ (corotated linear elasticity).
#[must_use]
#[inline]
pub fn energy_density(lame: Lame, strain: &Matrix2<f64>) -> f64 {
    lame.mu * strain.norm_squared() + 0.5 * lame.lambda * strain.trace().powi(2)
}

/// An element's stiffness written out, as the article does it: Ke, R Ke, R Ke Rᵀ and R Ke X.
///
/// For learning and for tests; the frame itself never forms these matrices one element at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementStiffness {
    /// Ke, 2N×2N, N/m; unknowns x₁ y₁ x₂ y₂ ….
    pub ke: DMatrix<f64>,
}

impl ElementStiffness {
    /// Ke = ∫ Bᵀ C B t dA (eqs. 1, 3), summed over quadrature points.
    #[must_use]
    pub fn new<const N: usize>(points: &[QuadraturePoint<N>], lame: Lame) -> Self {
        let mut ke = DMatrix::zeros(2 * N, 2 * N);
        for point in points {
            point.warped_stiffness(lame, Rotation::IDENTITY, |a, b, k| {
                let sum = ke.fixed_view::<2, 2>(2 * a, 2 * b) + k;
                ke.fixed_view_mut::<2, 2>(2 * a, 2 * b).copy_from(&sum);
                ke.fixed_view_mut::<2, 2>(2 * b, 2 * a).copy_from(&sum.transpose());
            });
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

    /// R Ke, the article's m_cMatRK.
    #[must_use]
    pub fn rk(&self, r: Rotation) -> DMatrix<f64> {
        self.turn(r) * &self.ke
    }

    /// R Ke Rᵀ, the article's m_cMatRKRT.
    #[must_use]
    pub fn rkrt(&self, r: Rotation) -> DMatrix<f64> {
        self.rk(r) * self.turn(r).transpose()
    }

    /// The force offset R Ke X, N, for rest positions X of the element's nodes.
    #[must_use]
    pub fn force_offset(&self, r: Rotation, rest: &DVector<f64>) -> DVector<f64> {
        self.rk(r) * rest
    }
}
