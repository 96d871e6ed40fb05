//! Bounds of the rounding error of element forces by running error analysis (Higham 2002, *Accuracy and stability of
//! numerical algorithms*, 3.3), to first order in the unit roundoff.
//!
//! Every intermediate result has a bound of its error: the error of its operands times the derivative, plus the error
//! of its own operations, each at most half a unit in the last place. Stored values (gradients, areas, moduli,
//! displacements) count as exact. Operation counts are rounded up.

use nalgebra::{Matrix2, Vector2};

use super::point::QuadraturePoint;
use super::warped_strain;
use crate::displacement::Compensated;
use crate::material::Lame;
use crate::rotation::Rotation;

/// Unit roundoff: largest relative error of one operation.
pub(crate) const UNIT: f64 = 0.5 * f64::EPSILON;

/// Vector with a bound of its error, by component.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounded {
    pub value: Vector2<f64>,
    pub error: Vector2<f64>,
}

impl Rounded {
    const ZERO: Self = Self { value: Vector2::new(0.0, 0.0), error: Vector2::new(0.0, 0.0) };

    /// Returns the displacements of an element's nodes relative to its first one.
    pub fn relative<const N: usize>(u: Compensated<'_>, nodes: &[u32; N]) -> [Self; N] {
        let remainder = nodes.map(|node| u.remainder[node as usize].abs());
        let mut own = [Self::ZERO; N];
        for ((own, value), left) in own.iter_mut().zip(u.relative(nodes)).zip(remainder) {
            *own = Self { value, error: (value.abs() + left + remainder[0]) * (2.0 * UNIT) };
        }
        own
    }

    /// Returns Σ wₐ vₐ.
    pub fn sum<const N: usize>(vectors: &[Self; N], weights: &[f64; N]) -> Self {
        let mut sum = Self::ZERO;
        for (v, w) in vectors.iter().zip(weights) {
            sum.value += v.value * *w;
            sum.error += (v.error + v.value.abs() * (N as f64 * UNIT)) * w.abs();
        }
        sum
    }
}

/// Rotation and stress of a quadrature point with bounds of their errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundedPoint {
    /// |R|.
    pub rotation: Matrix2<f64>,
    /// |R J|.
    pub rotated: Matrix2<f64>,
    /// Bound of the error of the angle, rad.
    pub angle: f64,
    /// Bound of the relative error of tr S.
    pub trace: f64,
    /// |P| times the area, and the bound of its error, N.
    pub stress: [Matrix2<f64>; 2],
}

/// Returns |A| |B|.
fn product(a: &Matrix2<f64>, b: &Matrix2<f64>) -> Matrix2<f64> {
    a.abs() * b.abs()
}

impl RoundedPoint {
    /// Returns the point with the polar factor of its F, or with the identity as rotation.
    pub fn new<const N: usize>(point: &QuadraturePoint<N>, moduli: Lame, r: Rotation, u: &[Rounded; N]) -> Self {
        let h = point.displacement_gradient(&u.map(|u| u.value));
        let mut dh = Matrix2::zeros();
        for (u, g) in u.iter().zip(&point.gradients).skip(1) {
            dh += (u.error + u.value.abs() * (N as f64 * UNIT)) * g.abs().transpose();
        }
        let f = Matrix2::identity() + h;
        let (a, b) = (f.m11 + f.m22, f.m21 - f.m12);
        let (c, s) = (r.c.abs(), r.s.abs());
        let (da, db) =
            (dh.m11 + dh.m22 + UNIT * (f.m11.abs() + f.m22.abs() + a.abs()), dh.m21 + dh.m12 + UNIT * b.abs());
        let trace = (r.c * a + r.s * b).abs().max(f64::MIN_POSITIVE);
        let angle = (c * db + s * da) / trace;

        // Strain, with the effect of an error of the angle: the deviator rotated by 45°.
        let strain = warped_strain(r, &h);
        let c_minus_1 = if r.c > 0.0 { s * s / (1.0 + c) } else { 1.0 + c };
        let off = angle * (0.5 * (strain.m11 - strain.m22).abs() + strain.m12.abs() + angle * trace);
        let own = |parts: f64| 12.0 * UNIT * parts + off;
        let (size, h) = (h.abs(), dh);
        let xx = c * h.m11 + s * h.m21 + own(c_minus_1 + c * size.m11 + s * size.m21);
        let yy = s * h.m12 + c * h.m22 + own(c_minus_1 + s * size.m12 + c * size.m22);
        let xy = 0.5 * (c * (h.m12 + h.m21) + s * (h.m22 + h.m11))
            + own(0.5 * (c * (size.m12 + size.m21) + s * (size.m22 + size.m11)));

        // Stress in the rotated frame, then P.
        let (double, lambda) = (2.0 * moduli.mu.abs(), moduli.lambda.abs());
        let size = strain.abs();
        let of = |own: f64, sum: f64| double * own + lambda * sum;
        let sums = (xx + yy, 5.0 * UNIT * (size.m11 + size.m22));
        let t = moduli.stress(&strain);
        let dt = Matrix2::new(
            of(xx + 5.0 * UNIT * size.m11, sums.0 + sums.1),
            double * (xy + 5.0 * UNIT * size.m12),
            double * (xy + 5.0 * UNIT * size.m12),
            of(yy + 5.0 * UNIT * size.m22, sums.0 + sums.1),
        );
        let (rotation, rotated) = (Matrix2::new(c, s, s, c), Matrix2::new(s, c, c, s));
        let value = product(&rotation, &t);
        let error = rotation * dt + value * (8.0 * UNIT) + product(&rotated, &t) * angle;
        Self {
            rotation,
            rotated,
            angle,
            trace: (c * da + s * db + 7.0 * UNIT * (c * a.abs() + s * b.abs())) / trace,
            stress: [value * point.area, error * point.area],
        }
    }

    /// Returns the bound of the error of the stress's force on a node with this gradient, including the summation with
    /// `others` further terms, N.
    pub fn force(&self, gradient: &Vector2<f64>, others: f64) -> Vector2<f64> {
        let [value, error] = self.stress;
        (error + value * ((3.0 + others) * UNIT)) * gradient.abs()
    }
}
