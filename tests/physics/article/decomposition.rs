//! The polar decomposition in space by iteration, and in the plane and in space from the SVD (article
//! eqs. 25–36 and its worked example).

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, DimMin, DimSub, Matrix3, SMatrix, ToTypenum};

/// Reason why a matrix has no polar decomposition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolarError {
    /// An entry is NaN or infinite.
    NotFinite,
    /// An iterate is singular and cannot be inverted.
    Singular,
    /// The iterates did not become orthogonal within the allowed number of iterations.
    NotConverged(usize),
}

/// Polar decomposition F = Q S = V Q with Q orthogonal and S, V symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polar<const N: usize> {
    /// Q. It is a reflection where det F < 0, unless the proper rotation was requested.
    pub orthogonal: SMatrix<f64, N, N>,
    /// The right factor S = QᵀF, positive definite unless det F < 0 and Q is proper. The article's U.
    pub right: SMatrix<f64, N, N>,
    /// The left factor V = F Qᵀ. Erratum: the article's eq. (36) prints FᵀR next to numbers that are F Rᵀ.
    pub left: SMatrix<f64, N, N>,
    /// Number of iterations; 0 if the input was already orthogonal or the decomposition is direct.
    pub iterations: usize,
}

impl<const N: usize> Polar<N> {
    fn new(f: &SMatrix<f64, N, N>, orthogonal: SMatrix<f64, N, N>, iterations: usize) -> Self {
        let symmetric = |m: SMatrix<f64, N, N>| (m + m.transpose()) * 0.5;
        Self {
            orthogonal,
            right: symmetric(orthogonal.transpose() * f),
            left: symmetric(f * orthogonal.transpose()),
            iterations,
        }
    }
}

/// ‖½(RᵀR − I)‖ (Frobenius) below which the iteration stops. The iteration converges quadratically, so at this value
/// the next iterate is exact to rounding: tighter only costs iterations. The article's example needs seven.
pub const ORTHOGONALITY: f64 = 1e-9;

/// Largest number of iterations, enough for condition numbers up to 1/ε: at first, each iteration halves the distance
/// of the largest singular value.
const MAX_ITERATIONS: usize = 128;

/// Returns F, or F over its largest entry if products of entries would leave the range of f64. Q does not change.
fn of_ordinary_size<const N: usize>(f: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let largest = f.amax();
    if largest == 0.0 || (1e-60..1e60).contains(&largest) { *f } else { f / largest }
}

/// Returns the departure from orthogonality ‖½(RᵀR − I)‖, article eq. (35).
pub fn orthogonality_error(r: &Matrix3<f64>) -> f64 {
    ((r.transpose() * r - Matrix3::identity()) * 0.5).norm()
}

/// Computes the 3×3 polar decomposition by R ← ½(R + R⁻ᵀ), article eqs. (33)–(36).
///
/// Where det F < 0 the iteration ends on a *reflection*, as the article's own example does (det = −110.96, its
/// printed R has det −1). A corotational code needs [`proper_rotation3`]. Erratum: the A⁻ᵀ printed with that
/// example is A⁻¹, untransposed.
pub fn polar3(f: &Matrix3<f64>) -> Result<Polar<3>, PolarError> {
    let largest = f.amax();
    if !f.iter().all(|v| v.is_finite()) {
        return Err(PolarError::NotFinite);
    }
    if largest == 0.0 {
        return Err(PolarError::Singular);
    }
    // Matrices whose entries are neither tiny nor huge are not scaled, so that the numbers of iterations are the
    // article's.
    let mut r = of_ordinary_size(f);
    for iteration in 0..MAX_ITERATIONS {
        if orthogonality_error(&r) < ORTHOGONALITY {
            return Ok(Polar::new(f, r, iteration));
        }
        let inverse = r.try_inverse().ok_or(PolarError::Singular)?;
        r = (r + inverse.transpose()) * 0.5;
        if !r.iter().all(|v| v.is_finite()) {
            return Err(PolarError::Singular);
        }
    }
    Err(PolarError::NotConverged(MAX_ITERATIONS))
}

/// Computes the proper rotation nearest to F: [`polar3`] where det F > 0, else its reflection with the direction of the
/// least stretch reversed, so that det = +1.
pub fn proper_rotation3(f: &Matrix3<f64>) -> Result<Polar<3>, PolarError> {
    let polar = polar3(f)?;
    if polar.orthogonal.determinant() > 0.0 {
        return Ok(polar);
    }
    // Q = U Vᵀ and S = V Σ Vᵀ: flipping the column of V with the smallest σ gives U diag(1, 1, −1) Vᵀ.
    let eigen = polar.right.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let v = eigen.eigenvectors.column(least);
    let flip = Matrix3::identity() - v * v.transpose() * 2.0;
    Ok(Polar::new(f, polar.orthogonal * flip, polar.iterations))
}

/// Computes the polar decomposition from the SVD F = U Σ Vᵀ (article eqs. 25, 31, 32): Q = U Vᵀ, left factor U Σ Uᵀ,
/// right factor V Σ Vᵀ. It exists for singular F too, where it is not unique.
///
/// Erratum: the article's eq. (31) writes U V⁻¹ for U Vᵀ, the same thing for an orthogonal V.
pub fn polar_from_svd<const N: usize>(f: &SMatrix<f64, N, N>) -> Result<Polar<N>, PolarError>
where
    Const<N>: ToTypenum + DimMin<Const<N>, Output = Const<N>> + DimSub<Const<1>>,
    DefaultAllocator: Allocator<<Const<N> as DimSub<Const<1>>>::Output>,
{
    const MAX_SWEEPS: usize = 1000;
    // nalgebra's SVD does not return if an entry is NaN.
    if !f.iter().all(|v| v.is_finite()) {
        return Err(PolarError::NotFinite);
    }
    let svd = of_ordinary_size(f)
        .try_svd(true, true, f64::EPSILON, MAX_SWEEPS)
        .ok_or(PolarError::NotConverged(MAX_SWEEPS))?;
    let (u, v_t) = svd.u.zip(svd.v_t).ok_or(PolarError::NotConverged(MAX_SWEEPS))?;
    Ok(Polar::new(f, u * v_t, 0))
}
