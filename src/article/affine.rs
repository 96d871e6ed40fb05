//! Affine maps from corners before and after: triangle, quadrilateral, tetrahedron (article eqs. 4–24).

use nalgebra::{Matrix2, Matrix3, Matrix4, SMatrix, Vector2, Vector3};
use thiserror::Error;

/// Why no affine map can be found.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum AffineError {
    /// The three rest corners lie on a line: the matrix P of eq. (15) is singular.
    #[error(
        "the rest corners are collinear (twice the area is {doubled_area:e} for edges up to {longest_edge:e}): expected a triangle with area"
    )]
    CollinearCorners {
        /// Twice the signed area of the rest triangle.
        doubled_area: f64,
        /// Length of its longest edge.
        longest_edge: f64,
    },
    /// The four rest corners lie in a plane.
    #[error("the rest corners are coplanar: expected a tetrahedron with volume")]
    CoplanarCorners,
    /// A coordinate is NaN or infinite.
    #[error("a corner is not finite: expected finite coordinates")]
    NotFinite,
}

/// Area over squared length (volume over cubed length) below which corners count as degenerate: a few hundred
/// roundings. It trades slivers that could still be solved against maps whose digits are all rounding.
pub const DEGENERATE: f64 = 1e-13;

/// x ↦ M x + d in the plane (eqs. 4–9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine2 {
    /// M: rotation, shear, stretch (eq. 5).
    pub linear: Matrix2<f64>,
    /// d: translation (eq. 7).
    pub translation: Vector2<f64>,
}

impl Affine2 {
    /// The map that takes the corners `rest` to `deformed`: the solution of P a = y, eqs. (12)–(15).
    ///
    /// P is block diagonal, so the six unknowns come from the edge vectors by one 2×2 inverse. The deformed corners may
    /// be collinear (the article's example 3): the map then is singular, but found.
    ///
    /// # Errors
    /// [`AffineError::CollinearCorners`] for a rest triangle without area, [`AffineError::NotFinite`].
    pub fn from_triangle(rest: [Vector2<f64>; 3], deformed: [Vector2<f64>; 3]) -> Result<Self, AffineError> {
        if !rest.iter().chain(&deformed).all(|p| p.iter().all(|v| v.is_finite())) {
            return Err(AffineError::NotFinite);
        }
        let (e1, e2) = (rest[1] - rest[0], rest[2] - rest[0]);
        let longest = e1.norm().max(e2.norm()).max((e2 - e1).norm());
        // Divided by their length, edges of any size neither overflow nor underflow in the product.
        let edges = Matrix2::from_columns(&[e1 / longest, e2 / longest]);
        let doubled = edges.determinant();
        let collinear =
            AffineError::CollinearCorners { doubled_area: doubled * longest * longest, longest_edge: longest };
        if !(longest > 0.0 && doubled.abs() > DEGENERATE) {
            return Err(collinear);
        }
        let moved =
            Matrix2::from_columns(&[(deformed[1] - deformed[0]) / longest, (deformed[2] - deformed[0]) / longest]);
        let linear = moved * edges.try_inverse().ok_or(collinear)?;
        Ok(Self { linear, translation: deformed[0] - linear * rest[0] })
    }

    /// M x + d.
    #[must_use]
    pub fn apply(&self, x: Vector2<f64>) -> Vector2<f64> {
        self.linear * x + self.translation
    }

    /// The homogeneous matrix of eq. (9); it is translation times linear part, eq. (28).
    #[must_use]
    pub fn homogeneous(&self) -> Matrix3<f64> {
        let (m, d) = (&self.linear, &self.translation);
        Matrix3::new(m.m11, m.m12, d.x, m.m21, m.m22, d.y, 0.0, 0.0, 1.0)
    }
}

/// The matrix P of eq. (15): unknowns a₁₁ a₁₂ a₁₃ a₂₁ a₂₂ a₂₃, right-hand side x′₁ x′₂ x′₃ y′₁ y′₂ y′₃.
///
/// [`Affine2::from_triangle`] solves the same system without forming it.
#[must_use]
pub fn triangle_system(rest: [Vector2<f64>; 3]) -> SMatrix<f64, 6, 6> {
    SMatrix::from_fn(|row, column| {
        let p = rest[row % 3];
        if row / 3 == column / 3 { [p.x, p.y, 1.0][column % 3] } else { 0.0 }
    })
}

/// The diagonal that cuts a quadrilateral with corners 1 2 3 4 into two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// Triangles (1, 2, 3) and (1, 3, 4), as in eq. (21).
    OneThree,
    /// Triangles (1, 2, 4) and (2, 3, 4).
    TwoFour,
}

/// The two affine maps of a quadrilateral, one a triangle (eqs. 21–22). They depend on the diagonal unless the
/// deformation is affine.
///
/// # Errors
/// As [`Affine2::from_triangle`], for either triangle.
pub fn quadrilateral_maps(
    rest: [Vector2<f64>; 4],
    deformed: [Vector2<f64>; 4],
    diagonal: Diagonal,
) -> Result<[Affine2; 2], AffineError> {
    let triangles = match diagonal {
        Diagonal::OneThree => [[0, 1, 2], [0, 2, 3]],
        Diagonal::TwoFour => [[0, 1, 3], [1, 2, 3]],
    };
    let map = |t: [usize; 3]| Affine2::from_triangle(t.map(|i| rest[i]), t.map(|i| deformed[i]));
    Ok([map(triangles[0])?, map(triangles[1])?])
}

/// x ↦ M x + d in space (eq. 23).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine3 {
    /// M.
    pub linear: Matrix3<f64>,
    /// d.
    pub translation: Vector3<f64>,
}

impl Affine3 {
    /// The map that takes the corners `rest` of a tetrahedron to `deformed`: the solution of eq. (24), by one 3×3
    /// inverse of the edge vectors instead of a 12×12 solve.
    ///
    /// # Errors
    /// [`AffineError::CoplanarCorners`] for a rest tetrahedron without volume, [`AffineError::NotFinite`].
    pub fn from_tetrahedron(rest: [Vector3<f64>; 4], deformed: [Vector3<f64>; 4]) -> Result<Self, AffineError> {
        if !rest.iter().chain(&deformed).all(|p| p.iter().all(|v| v.is_finite())) {
            return Err(AffineError::NotFinite);
        }
        let edges = |p: &[Vector3<f64>; 4]| Matrix3::from_columns(&[p[1] - p[0], p[2] - p[0], p[3] - p[0]]);
        let (before, after) = (edges(&rest), edges(&deformed));
        let longest = before.column_iter().map(|e| e.norm()).fold(0.0, f64::max);
        let scaled = before / longest;
        if !(longest > 0.0 && scaled.determinant().abs() > DEGENERATE) {
            return Err(AffineError::CoplanarCorners);
        }
        let inverse = scaled.try_inverse().ok_or(AffineError::CoplanarCorners)?;
        let linear = (after / longest) * inverse;
        Ok(Self { linear, translation: deformed[0] - linear * rest[0] })
    }

    /// M x + d.
    #[must_use]
    pub fn apply(&self, x: Vector3<f64>) -> Vector3<f64> {
        self.linear * x + self.translation
    }

    /// The homogeneous matrix of eq. (23).
    #[must_use]
    pub fn homogeneous(&self) -> Matrix4<f64> {
        let mut m = self.linear.to_homogeneous();
        m.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.translation);
        m
    }
}
