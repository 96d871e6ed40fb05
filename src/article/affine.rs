//! Affine maps from the corners of a triangle before and after deformation (article eqs. 4–15).

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

/// Reason why there is no affine map.
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
    /// A coordinate is NaN or infinite.
    #[error("a corner is not finite: expected finite coordinates")]
    NotFinite,
}

/// Lower bound of area over squared length: a few hundred rounding errors. It rejects slivers whose maps would consist
/// of rounding errors, at the cost of some that could still be solved.
const DEGENERATE: f64 = 1e-13;

/// Affine map x ↦ M x + d in the plane (eqs. 4–9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine2 {
    /// M: rotation, shear, stretch (eq. 5).
    pub linear: Matrix2<f64>,
    /// d: translation (eq. 7).
    pub translation: Vector2<f64>,
}

impl Affine2 {
    /// Computes the map of the corners `rest` to `deformed`: the solution of P a = y, eqs. (12)–(15).
    ///
    /// P is block diagonal, so the six unknowns follow from the edge vectors by one 2×2 inverse. The deformed corners
    /// may be collinear (the article's example 3); the map is then singular.
    pub fn from_triangle(rest: [Vector2<f64>; 3], deformed: [Vector2<f64>; 3]) -> Result<Self, AffineError> {
        if !rest.iter().chain(&deformed).all(|p| p.iter().all(|v| v.is_finite())) {
            return Err(AffineError::NotFinite);
        }
        let (e1, e2) = (rest[1] - rest[0], rest[2] - rest[0]);
        let longest = e1.norm().max(e2.norm()).max((e2 - e1).norm());
        // Dividing edges by their length avoids overflow and underflow of the product.
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
}

#[cfg(test)]
mod tests;
