//! Extreme eigenvalues of large symmetric pencils.

use nalgebra::DMatrix;

/// Estimates the smallest and the largest eigenvalue of B⁻¹C by `steps` steps of Lanczos' method, C symmetric and B
/// positive definite, both n × n: `multiply` computes C v from v, `solve` computes B⁻¹ b from b. The eigenvalue that is
/// largest in magnitude is accurate to a few digits after about twenty steps if it is well separated. `None` if a
/// number is not finite.
///
/// The method uses the inner product of B and full reorthogonalization.
pub(crate) fn extreme_eigenvalues(
    n: usize,
    steps: usize,
    mut multiply: impl FnMut(&[f64], &mut [f64]),
    mut solve: impl FnMut(&mut [f64]),
) -> Option<[f64; 2]> {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    // Start vector: any that is not orthogonal to the eigenvector; this one has no symmetry.
    let mut image: Vec<f64> = (0..n).map(|i| ((i as f64 + 1.0) * 0.754_877_666).fract() - 0.3).collect();
    let mut v = image.clone();
    solve(&mut v);
    let (mut basis, mut images): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let (mut diagonal, mut off) = (Vec::new(), Vec::new());
    for _ in 0..steps.min(n) {
        let norm = dot(&v, &image).sqrt();
        if !(norm.is_finite() && norm > 0.0) {
            break;
        }
        if let Some(last) = off.last_mut() {
            *last = norm;
        }
        v.iter_mut().chain(&mut image).for_each(|x| *x /= norm);
        // Compute w = B⁻¹C v, with B w = C v.
        let mut product = vec![0.0; n];
        multiply(&v, &mut product);
        diagonal.push(dot(&v, &product));
        off.push(0.0);
        let mut w = product.clone();
        solve(&mut w);
        basis.push(std::mem::replace(&mut v, w));
        images.push(std::mem::replace(&mut image, product));
        for _ in 0..2 {
            for (basis, basis_image) in basis.iter().zip(&images) {
                let along = dot(&v, basis_image);
                v.iter_mut().zip(basis).for_each(|(v, b)| *v -= along * b);
                image.iter_mut().zip(basis_image).for_each(|(v, b)| *v -= along * b);
            }
        }
        // If the remainder vanishes, the Krylov space is exhausted.
        if dot(&v, &image) <= 1e-24 * diagonal.iter().map(|d| d * d).fold(0.0, f64::max) {
            break;
        }
    }
    let m = diagonal.len();
    let tridiagonal = DMatrix::from_fn(m, m, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off[i.min(j)],
        _ => 0.0,
    });
    if m == 0 || !tridiagonal.iter().all(|v| v.is_finite()) {
        return None;
    }
    let eigenvalues = tridiagonal.symmetric_eigenvalues();
    Some([eigenvalues.min(), eigenvalues.max()])
}
