//! What is known of a result whatever method found it: stability, and whether the warped iteration could have.

use nalgebra::{DMatrix, Vector2};

use super::frame::Workspace;
use crate::assembly::System;
use crate::element::GeometricShare;
use crate::rotation::Rotation;

/// The values of the exact tangent A + G − λ ∂f_ext/∂u at this state and load factor.
pub(super) fn tangent(system: &System, u: &[Vector2<f64>], r: &[Rotation], load_factor: f64, values: &mut [f64]) {
    system.stiffness(r, values);
    system.add_geometric_stiffness(u, r, GeometricShare::All, values);
    system.add_load_stiffness(u, load_factor, values);
}

/// Whether the exact tangent is positive definite (its Cholesky factorization succeeds): a stable equilibrium, if the
/// state is an equilibrium at this load factor at all. `r` are the polar rotations of `u`.
pub fn is_stable(
    system: &System,
    u: &[Vector2<f64>],
    r: &[Rotation],
    load_factor: f64,
    workspace: &mut Workspace,
) -> bool {
    tangent(system, u, r, load_factor, &mut workspace.values);
    workspace.factor.factorize(&workspace.values).is_ok()
}

/// What ρ means, in words.
#[must_use]
pub fn rho_words(rho: f64) -> String {
    if rho < 1.0 {
        format!("the warped iteration converges near here: ρ = {rho:.3} < 1")
    } else if rho < 1000.0 {
        format!("the warped iteration cannot converge here: ρ = {rho:.3} > 1")
    } else {
        format!("the warped iteration cannot converge here: ρ = {rho:.1e} > 1")
    }
}

/// Lanczos steps: the extreme eigenvalue is right to a few digits long before.
const LANCZOS_STEPS: usize = 24;

/// ρ = |λ|max(A⁻¹ G') at this state and load factor, the error factor of the warped iteration: it converges here if ρ < 1.
///
/// G' is G less the loads' own tangent. Lanczos in the inner product of A, with full reorthogonalization. `None` where A
/// cannot be factorized.
pub fn fixed_point_rho(
    system: &System,
    u: &[Vector2<f64>],
    r: &[Rotation],
    load_factor: f64,
    workspace: &mut Workspace,
) -> Option<f64> {
    let n = system.dofs();
    let mut a = vec![0.0; workspace.values.len()];
    system.stiffness(r, &mut a);
    workspace.factor.factorize(&a).ok()?;
    let mut g = vec![0.0; workspace.values.len()];
    system.add_geometric_stiffness(u, r, GeometricShare::All, &mut g);
    system.add_load_stiffness(u, load_factor, &mut g);

    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    // Any start that is not orthogonal to the mode wanted: here one without symmetry.
    let mut v: Vec<f64> = (0..n).map(|i| ((i as f64 + 1.0) * 0.754_877_666).fract() - 0.3).collect();
    let mut av = vec![0.0; n];
    system.pattern.multiply(&a, &v, &mut av);
    let (mut basis, mut images): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let (mut diagonal, mut off) = (Vec::new(), Vec::new());
    for _ in 0..LANCZOS_STEPS.min(n) {
        let norm = dot(&v, &av).sqrt();
        if !(norm.is_finite() && norm > 0.0) {
            break;
        }
        if let Some(last) = off.last_mut() {
            *last = norm;
        }
        v.iter_mut().chain(&mut av).for_each(|x| *x /= norm);
        // w = A⁻¹ G v, and A w = G v.
        let mut gv = vec![0.0; n];
        system.pattern.multiply(&g, &v, &mut gv);
        diagonal.push(dot(&v, &gv));
        off.push(0.0);
        let mut w = gv.clone();
        workspace.factor.solve_in_place(&mut w);
        basis.push(std::mem::replace(&mut v, w));
        images.push(std::mem::replace(&mut av, gv));
        for _ in 0..2 {
            for (basis, image) in basis.iter().zip(&images) {
                let share = dot(&v, image);
                v.iter_mut().zip(basis).for_each(|(v, b)| *v -= share * b);
                av.iter_mut().zip(image).for_each(|(v, b)| *v -= share * b);
            }
        }
        // A vanishing remainder: the Krylov space is exhausted.
        if dot(&v, &av) <= 1e-24 * diagonal.iter().map(|d| d * d).fold(0.0, f64::max) {
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
    Some(tridiagonal.symmetric_eigenvalues().amax())
}
