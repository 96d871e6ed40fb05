//! Tests of the article's formulas: the SVD and its interpretation, the 3×3 iteration, its examples and errata. Tests
//! of its affine maps are in `src/article/affine`.

use crate::common::*;

mod decomposition;

use decomposition::{PolarError, orthogonality_error, polar_from_svd, polar3, proper_rotation3};
use nalgebra::{Matrix3, Vector3};

/// Erratum: with eq. (38) as printed, c = a √(a² + b²), the result is not a rotation.
#[test]
fn erratum_eq_38_lacks_the_reciprocal() {
    let f = Matrix2::<f64>::new(0.552885, -1.019231, 0.875, 0.5);
    let (a, b) = (f.m11 + f.m22, f.m21 - f.m12);
    let root = a.hypot(b);
    assert!(((a * root).hypot(b * root) - 1.0).abs() > 1.0);
    let r = polar(&f).unwrap();
    assert!((r.c - a / root).abs() < 1e-15 && (r.s - b / root).abs() < 1e-15);
    assert!((r.c - 0.485831).abs() < 1e-6 && (r.s - 0.874053).abs() < 1e-6);
}

/// Eq. (26): a shear is a rotation, a stretch and a rotation, with the printed singular values and factors.
#[test]
fn article_eq_26_svd_of_a_shear() {
    let shear = Matrix2::new(1.0, 1.0, 0.0, 1.0);
    let p = polar_from_svd(&shear).unwrap();
    // Eqs. (25), (31), (32): S = V Σ Vᵀ and V = U Σ Uᵀ have the singular values, with the printed vectors.
    let u = Matrix2::new(0.8506, 0.5257, 0.5257, -0.8506);
    let v_t = Matrix2::new(0.5257, 0.8506, 0.8506, -0.5257);
    let sigma = Matrix2::new(1.618, 0.0, 0.0, 0.618);
    assert!((p.right - v_t.transpose() * sigma * v_t).norm() < 1e-3, "{}", p.right);
    assert!((p.left - u * sigma * u.transpose()).norm() < 1e-3, "{}", p.left);
    assert!((p.orthogonal - u * v_t).norm() < 1e-3);
    // Left and right factors share one rotation, which is that of the closed form.
    assert!((p.orthogonal - polar(&shear).unwrap().matrix()).norm() < 1e-14);
    assert!((p.orthogonal * p.right - shear).norm() < 1e-14 && (p.left * p.orthogonal - shear).norm() < 1e-14);
}

/// Eqs. (28), (30): a plane translation as a 3×3 matrix has the printed singular values.
#[test]
fn article_eq_30_svd_of_a_translation() {
    let translation = Matrix3::new_translation(&Vector2::new(6.0, 7.0));
    let p = polar_from_svd(&translation).unwrap();
    let mut stretches = p.right.symmetric_eigenvalues().as_slice().to_vec();
    stretches.sort_by(|a, b| b.total_cmp(a));
    assert!((Vector3::from_vec(stretches) - Vector3::new(9.3268, 1.0, 0.107)).norm() < 1e-3, "{}", p.right);
    assert!((p.orthogonal * p.right - translation).norm() < 1e-12);
}

fn article_matrix() -> Matrix3<f64> {
    Matrix3::new(8.442, 0.559, 2.790, 2.771, 1.936, 4.589, 0.818, 6.158, 5.564)
}

/// The worked example, to its printed digits: seven iterations, R, U and V; and its errata.
#[test]
fn article_example_of_the_3x3_iteration() {
    let f = article_matrix();
    let p = polar3(&f).unwrap();
    assert_eq!(p.iterations, 7);
    let error = orthogonality_error(&p.orthogonal);
    assert!((error - 3.6e-10).abs() < 0.1e-10, "{error:e}");
    let r = Matrix3::new(0.998, 0.058, -0.021, 0.039, -0.332, 0.942, -0.047, 0.941, 0.334);
    let u = Matrix3::new(8.497, 0.341, 2.702, 0.341, 5.184, 3.872, 2.702, 3.872, 6.124);
    let v = Matrix3::new(8.398, 2.779, 1.056, 2.779, 3.790, 3.225, 1.056, 3.225, 7.618);
    // The article prints three decimals, computed from a matrix printed to three decimals.
    for (ours, printed) in [(p.orthogonal, r), (p.right, u), (p.left, v)] {
        assert!((ours - printed).amax() < 1.6e-3, "{ours} {printed}");
    }
    assert!((p.orthogonal * p.right - f).norm() < 1e-8);
    assert!((p.left * p.orthogonal - f).norm() < 1e-8);
    // Erratum: the V printed next to eq. (36) is F Rᵀ; FᵀR, as in the equation, is U transposed.
    let as_printed = f.transpose() * p.orthogonal;
    assert!((as_printed - p.left).norm() > 1.0);
    assert!((as_printed - p.right).norm() < 1e-8);
    // Erratum: the matrix printed as A⁻ᵀ is A⁻¹, which has the transpose of its orthogonal factor.
    let printed = Matrix3::new(0.157, -0.126, 0.025, 0.105, -0.402, 0.279, -0.139, 0.464, -0.133);
    let [of_a, of_printed] = [f, printed].map(|m| polar3(&m).unwrap().orthogonal);
    assert!((of_printed - of_a.transpose()).amax() < 5e-3, "{of_printed} {of_a}");
    assert!((of_printed - of_a).amax() > 0.02, "{of_printed} {of_a}");
    // Erratum: the example's R is a reflection; the proper rotation is a different matrix.
    assert!((f.determinant() + 110.96).abs() < 0.01);
    assert!((p.orthogonal.determinant() + 1.0).abs() < 1e-8);
    let proper = proper_rotation3(&f).unwrap();
    let expected = Matrix3::new(0.8672, -0.3313, 0.3717, 0.4401, 0.8591, -0.2611, -0.2329, 0.3900, 0.8909);
    assert!((proper.orthogonal - expected).amax() < 1e-4, "{}", proper.orthogonal);
    assert!((proper.orthogonal.determinant() - 1.0).abs() < 1e-8);
    assert!((proper.orthogonal * proper.right - f).norm() < 1e-8);
    // Erratum: eq. (31) writes U V⁻¹ for U Vᵀ; both are the same, because the factors of the SVD are orthogonal.
    let q = polar_from_svd(&f).unwrap().orthogonal;
    assert!((q.try_inverse().unwrap() - q.transpose()).norm() < 1e-12);
    assert!((q - p.orthogonal).norm() < 1e-8);
}

#[test]
fn the_3x3_iteration_at_the_extremes() {
    for scale in [1e-300, 1e-100, 1e-3, 1e100, 1e300] {
        let p = polar3(&(article_matrix() * scale)).unwrap();
        assert!((p.orthogonal - polar3(&article_matrix()).unwrap().orthogonal).norm() < 1e-8, "{scale:e}");
    }
    assert_eq!(polar3(&Matrix3::zeros()), Err(PolarError::Singular));
    assert_eq!(polar3(&Matrix3::from_element(f64::NAN)), Err(PolarError::NotFinite));
    assert_eq!(polar_from_svd(&Matrix2::from_element(f64::INFINITY)), Err(PolarError::NotFinite));
    let thin = Matrix3::from_diagonal(&Vector3::new(1.0, 1e-6, 1e3));
    assert!((polar3(&thin).unwrap().orthogonal - Matrix3::identity()).norm() < 1e-8);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        let matrix = Matrix3::repeat(bad);
        assert!(polar3(&matrix).is_err() && proper_rotation3(&matrix).is_err());
        match polar_from_svd(&matrix) {
            Ok(polar) => assert!(bad.is_finite() && orthogonality_error(&polar.orthogonal) < 1e-9, "{bad}: {polar:?}"),
            Err(error) => assert_eq!((error, bad.is_finite()), (PolarError::NotFinite, false), "{bad}"),
        }
    }
}
