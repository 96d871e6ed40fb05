//! Affine maps of quadrilaterals and tetrahedra from corners before and after (article eqs. 15–24).

use nalgebra::{Matrix3, Matrix4, SMatrix, Vector2, Vector3};
use thiserror::Error;
use warpbeam::article::affine::{Affine2, AffineError, DEGENERATE};

/// Reason why no affine map of a tetrahedron exists.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Affine3Error {
    /// The four rest corners lie in a plane.
    #[error("the rest corners are coplanar: expected a tetrahedron with volume")]
    CoplanarCorners,
    /// A coordinate is NaN or infinite.
    #[error("a corner is not finite: expected finite coordinates")]
    NotFinite,
}

/// Returns the matrix P of eq. (15): unknowns a₁₁ a₁₂ a₁₃ a₂₁ a₂₂ a₂₃, right-hand side x′₁ x′₂ x′₃ y′₁ y′₂ y′₃.
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

/// Returns the two affine maps of a quadrilateral, one for each triangle (eqs. 21–22). They depend on the diagonal
/// unless the deformation is affine.
///
/// # Errors
/// The errors of [`Affine2::from_triangle`], for either triangle.
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

/// Affine map x ↦ M x + d in space (eq. 23).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine3 {
    /// M.
    pub linear: Matrix3<f64>,
    /// d.
    pub translation: Vector3<f64>,
}

impl Affine3 {
    /// Returns the map that takes the corners `rest` of a tetrahedron to `deformed`. It solves eq. (24) with one
    /// 3×3 inverse of the edge vectors instead of a 12×12 solve.
    ///
    /// # Errors
    /// [`Affine3Error::CoplanarCorners`] for a rest tetrahedron without volume, [`Affine3Error::NotFinite`].
    pub fn from_tetrahedron(rest: [Vector3<f64>; 4], deformed: [Vector3<f64>; 4]) -> Result<Self, Affine3Error> {
        if !rest.iter().chain(&deformed).all(|p| p.iter().all(|v| v.is_finite())) {
            return Err(Affine3Error::NotFinite);
        }
        let edges = |p: &[Vector3<f64>; 4]| Matrix3::from_columns(&[p[1] - p[0], p[2] - p[0], p[3] - p[0]]);
        let (before, after) = (edges(&rest), edges(&deformed));
        let longest = before.column_iter().map(|e| e.norm()).fold(0.0, f64::max);
        let scaled = before / longest;
        if !(longest > 0.0 && scaled.determinant().abs() > DEGENERATE) {
            return Err(Affine3Error::CoplanarCorners);
        }
        let inverse = scaled.try_inverse().ok_or(Affine3Error::CoplanarCorners)?;
        let linear = (after / longest) * inverse;
        Ok(Self { linear, translation: deformed[0] - linear * rest[0] })
    }

    /// Returns the homogeneous matrix of eq. (23).
    #[must_use]
    pub fn homogeneous(&self) -> Matrix4<f64> {
        let mut m = self.linear.to_homogeneous();
        m.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.translation);
        m
    }
}
