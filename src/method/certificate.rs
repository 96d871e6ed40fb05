//! What is known of a result whatever method found it: stability, and whether the warped iteration could have.

use super::iteration::{Workspace, assemble};
use crate::assembly::{Forces, Kinematics, Matrix, Problem};
use crate::element::Tangent;
use crate::solver::lanczos::extreme_eigenvalues;
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
    assemble(problem, state, forces, workspace, Tangent::EXACT, load_factor);
    workspace.factor.factorize(workspace.matrix.values()).is_ok()
}

/// How much harder the supports push along their way the farther they are on it, with the loads as they are, J: the
/// derivative of their generalised force g = Σ r · ∂u/∂λ with respect to the part λ of their way. `None` where the body is
/// unstable even as they hold it.
///
/// It is what is left of the exact tangent when everything but λ is eliminated (its Schur complement): let go, and
/// pushed by g instead, the body is stable if the tangent is positive definite on the free unknowns and this is positive.
pub fn support_stiffness(
    problem: &Problem,
    state: &State,
    load_factor: f64,
    forces: &mut Forces,
    workspace: &mut Workspace,
) -> Option<f64> {
    /// Part of the way by which derivatives are taken: central differences, right to about its square.
    const H: f64 = 1e-4;
    let (system, supports) = (problem.system(), problem.supports());
    let (mesh, pattern) = (system.mesh(), system.pattern());
    if !is_stable(problem, state, load_factor, forces, workspace) {
        return None;
    }
    let mut free = vec![0.0; system.dofs()];
    let mut trial = state.clone();
    // How the free unknowns follow: K du = −∂f_int/∂λ.
    for h in [H, -H] {
        trial.copy_from(state);
        supports.put(mesh, load_factor + h, Kinematics::Corotated, &mut trial.displacement);
        system.follow(&mut trial, Kinematics::Corotated);
        problem.linearize(&trial, forces, None);
        problem.balance(&trial, Kinematics::Corotated, load_factor, forces);
        pattern.restrict(forces.residual(), &mut workspace.free);
        free.iter_mut().zip(&workspace.free).for_each(|(sum, f)| *sum += f / (2.0 * h));
    }
    workspace.factor.solve_in_place(&mut free);
    let mut stiffness = 0.0;
    for h in [H, -H] {
        trial.copy_from(state);
        let mut ahead = trial.displacement.clone();
        for (sign, u) in [(1.0, &mut ahead), (-1.0, &mut trial.displacement)] {
            supports.put(mesh, load_factor + h + sign * H, Kinematics::Corotated, u);
        }
        let mut way: Vec<_> = ahead.iter().zip(&trial.displacement).map(|(a, b)| (a - b) / (2.0 * H)).collect();
        supports.put(mesh, load_factor + h, Kinematics::Corotated, &mut trial.displacement);
        pattern.advance(&free, h, &mut trial.displacement);
        system.follow(&mut trial, Kinematics::Corotated);
        problem.linearize(&trial, forces, None);
        problem.balance(&trial, Kinematics::Corotated, load_factor, forces);
        // Along the free unknowns it is in balance but for the error of `free`, which then counts by its square only.
        pattern.add_free(&free, 1.0, &mut way);
        let force: f64 = way.iter().zip(forces.residual()).map(|(way, residual)| -way.dot(residual)).sum();
        stiffness += force / (2.0 * h);
    }
    stiffness.is_finite().then_some(stiffness)
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
/// G' is G with the derivative of −f_ext added. `None` where A cannot be factorized.
pub fn fixed_point_rho(
    problem: &Problem,
    state: &State,
    load_factor: f64,
    forces: &mut Forces,
    workspace: &mut Workspace,
) -> Option<f64> {
    let system = problem.system();
    let mut a = Matrix::new(system.pattern());
    problem.linearize(state, forces, Some((Tangent::WARPED, &mut a)));
    problem.add_load_stiffness(state, Tangent::WARPED, load_factor, &mut a);
    workspace.factor.factorize(a.values()).ok()?;
    assemble(problem, state, forces, workspace, Tangent::GEOMETRIC, load_factor);
    let Workspace { matrix: g, factor, .. } = workspace;

    let multiply = |v: &[f64], gv: &mut [f64]| g.multiply(system.pattern(), v, gv);
    let [low, high] = extreme_eigenvalues(system.dofs(), LANCZOS_STEPS, multiply, |b| factor.solve_in_place(b))?;
    Some(low.abs().max(high.abs()))
}
