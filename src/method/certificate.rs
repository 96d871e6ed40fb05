//! What is known of a result whatever method found it: stability, and whether the warped iteration could have.

use nalgebra::DMatrix;

use super::iteration::{Workspace, assemble};
use crate::assembly::{Forces, Matrix, Problem};
use crate::element::Tangent;
use crate::state::State;

/// What is known of a result whatever method found it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Certificate {
    /// Whether the exact tangent is positive definite there; `None` for linear theory and before the end.
    pub stable: Option<bool>,
    /// ρ = |λ|max(A⁻¹G): the warped iteration converges here if it is below 1. `None` for linear theory, before the
    /// end, and where A cannot be factorized.
    pub fixed_point_rho: Option<f64>,
}

/// Whether the exact tangent A + G − λ ∂f_ext/∂u is positive definite (its Cholesky factorization succeeds): a stable
/// equilibrium, if the state is an equilibrium at this load factor at all. The state has the polar rotations of its
/// displacement.
pub fn is_stable(
    problem: &Problem,
    state: &State,
    load_factor: f64,
    forces: &mut Forces,
    workspace: &mut Workspace,
) -> bool {
    assemble(problem, state, forces, workspace, Tangent::Exact, load_factor);
    workspace.factor.factorize(workspace.matrix.values()).is_ok()
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
/// G' is G with the derivative of −f_ext added. Lanczos in the inner product of A, with full reorthogonalization. `None` where A
/// cannot be factorized.
pub fn fixed_point_rho(
    problem: &Problem,
    state: &State,
    load_factor: f64,
    forces: &mut Forces,
    workspace: &mut Workspace,
) -> Option<f64> {
    let system = problem.system();
    let n = system.dofs();
    let mut a = Matrix::new(system.pattern());
    problem.linearize(state, forces, Some((Tangent::Warped, &mut a)));
    workspace.factor.factorize(a.values()).ok()?;
    assemble(problem, state, forces, workspace, Tangent::Geometric, load_factor);
    let Workspace { matrix: g, factor, .. } = workspace;

    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    // Any start that is not orthogonal to the mode wanted: here one without symmetry.
    let mut v: Vec<f64> = (0..n).map(|i| ((i as f64 + 1.0) * 0.754_877_666).fract() - 0.3).collect();
    let mut av = vec![0.0; n];
    a.multiply(system.pattern(), &v, &mut av);
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
        g.multiply(system.pattern(), &v, &mut gv);
        diagonal.push(dot(&v, &gv));
        off.push(0.0);
        let mut w = gv.clone();
        factor.solve_in_place(&mut w);
        basis.push(std::mem::replace(&mut v, w));
        images.push(std::mem::replace(&mut av, gv));
        for _ in 0..2 {
            for (basis, image) in basis.iter().zip(&images) {
                let along = dot(&v, image);
                v.iter_mut().zip(basis).for_each(|(v, b)| *v -= along * b);
                av.iter_mut().zip(image).for_each(|(v, b)| *v -= along * b);
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
