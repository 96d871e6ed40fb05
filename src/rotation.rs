//! Rotations of the plane: closed-form polar decomposition, computed once per quadrature point in every iteration.
//!
//! Article eqs. (37)–(39), with the reciprocal that is missing in its eq. (38).

use nalgebra::{Matrix2, SimdBool, Vector2};

use crate::simd::Number;

/// Proper rotation of the plane, stored as cosine and sine; with SIMD `T`, one rotation per lane.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Rotation<T = f64> {
    /// Cosine of the angle.
    pub c: T,
    /// Sine of the angle.
    pub s: T,
}

impl Rotation {
    /// The rotation by 0.
    pub const IDENTITY: Self = Self { c: 1.0, s: 0.0 };

    /// Returns the rotation by `angle` (rad, counter-clockwise).
    pub fn from_angle(angle: f64) -> Self {
        let (s, c) = angle.sin_cos();
        Self { c, s }
    }

    /// Returns the angle in (−π, π], rad.
    pub fn angle(self) -> f64 {
        self.s.atan2(self.c)
    }
}

impl<T: Number> Rotation<T> {
    /// Returns the matrix of article eq. (39).
    #[inline(always)]
    pub fn matrix(self) -> Matrix2<T> {
        Matrix2::new(self.c, -self.s, self.s, self.c)
    }

    /// Returns R v.
    #[inline(always)]
    pub fn apply(self, v: Vector2<T>) -> Vector2<T> {
        Vector2::new(self.c * v.x - self.s * v.y, self.s * v.x + self.c * v.y)
    }

    /// Returns Rᵀ v.
    #[inline(always)]
    pub fn apply_inverse(self, v: Vector2<T>) -> Vector2<T> {
        Vector2::new(self.c * v.x + self.s * v.y, self.c * v.y - self.s * v.x)
    }

    /// Returns (a, b) normalised; `None` if a² + b² underflows or overflows f64.
    #[inline(always)]
    fn towards(a: T, b: T) -> Option<Self> {
        let squares = a * a + b * b;
        let ordinary = squares.simd_gt(T::splat(SMALLEST_SQUARE)) & squares.simd_lt(T::splat(LARGEST_SQUARE));
        if !ordinary.all() {
            return None;
        }
        let length = squares.simd_sqrt();
        Some(Self { c: a / length, s: b / length })
    }
}

/// Range of a² + b² inside which underflow of one square does not change the last digit of the sum.
const SMALLEST_SQUARE: f64 = 1e-250;
/// See [`SMALLEST_SQUARE`].
const LARGEST_SQUARE: f64 = 1e300;

/// Returns the rotation R of the polar decomposition F = R S, S symmetric (article eqs. 37–39); `None` where it is
/// undefined.
///
/// R is the proper rotation that maximises tr(RᵀF) = c (F₀₀ + F₁₁) + s (F₁₀ − F₀₁), so (c, s) is that pair of sums,
/// normalised. It is right for every finite F: inverted, singular, subnormal or near the largest number. It never is a
/// reflection. It is undefined where both sums vanish (F zero, or a scaled reflection) and where F is not finite.
///
/// Erratum: the article's eq. (38) multiplies by √(a² + b²); it must divide.
///
/// ```
/// use nalgebra::Matrix2;
/// use warpbeam::rotation::polar;
/// let r = polar(&Matrix2::new(0.0, -3.0, 2.0, 0.0)).unwrap();
/// assert_eq!((r.c, r.s), (0.0, 1.0));
/// assert!(polar(&Matrix2::new(1.0, 0.0, 0.0, -1.0)).is_none());
/// ```
#[inline(always)]
pub fn polar(f: &Matrix2<f64>) -> Option<Rotation> {
    let mut a = f.m11 + f.m22;
    let mut b = f.m21 - f.m12;
    if let Some(rotation) = Rotation::towards(a, b) {
        return Some(rotation);
    }
    if !(a.is_finite() && b.is_finite()) {
        if !f.iter().all(|v| v.is_finite()) {
            return None;
        }
        // Only the sums overflowed. Halving first loses at most what is below the last digit of the larger summand.
        a = 0.5 * f.m11 + 0.5 * f.m22;
        b = 0.5 * f.m21 - 0.5 * f.m12;
    }
    // The rounded sum is zero only if the exact sum is, and otherwise has full relative accuracy: dividing by the
    // larger of the two keeps both digits and range.
    let m = a.abs().max(b.abs());
    if m == 0.0 {
        return None;
    }
    Rotation::towards(a / m, b / m)
}

/// Returns [`polar`] of `f`, or `previous` where it is undefined.
#[inline(always)]
pub fn polar_or<T: Number>(f: &Matrix2<T>, previous: Rotation<T>) -> Rotation<T> {
    polar_or_else(f, || previous)
}

/// Evaluates [`polar_or`] with a previous rotation that is computed only if needed.
#[inline(always)]
pub(crate) fn polar_or_else<T: Number>(f: &Matrix2<T>, previous: impl FnOnce() -> Rotation<T>) -> Rotation<T> {
    Rotation::towards(f.m11 + f.m22, f.m21 - f.m12).unwrap_or_else(|| one_by_one(f, previous()))
}

/// Evaluates [`polar_or`] lane by lane; called if a sum of squares is out of range in any lane.
#[cold]
fn one_by_one<T: Number>(f: &Matrix2<T>, previous: Rotation<T>) -> Rotation<T> {
    let mut result = previous;
    for lane in 0..T::LANES {
        if let Some(Rotation { c, s }) = polar(&f.map(|f| f.extract(lane))) {
            result.c.replace(lane, c);
            result.s.replace(lane, s);
        }
    }
    result
}

#[cfg(test)]
mod tests;
