//! Properties of a result independent of the method: stability, and convergence of the warped iteration.

use crate::assembly::{Forces, Kinematics, Matrix, Problem, System};
use crate::element::Tangent;
use crate::solver::lanczos::extreme_eigenvalues;
use crate::solver::{Factor, SolverError};
use crate::state::State;
use crate::step::Workspace;

/// Properties of a result independent of the method that found it.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Certificate {
    /// `true` if the exact tangent is positive definite; `None` for linear theory and away from equilibria.
    pub stable: Option<bool>,
    /// ρ = |λ|max(A⁻¹G): by this factor a small disturbance of the equilibrium grows or shrinks in each warped iteration.
    /// `None` away from equilibria, for linear theory, and if A cannot be factorized.
    pub fixed_point_rho: Option<f64>,
}

/// Returns `true` if the exact tangent A + G − λ ∂f_ext/∂u is positive definite (its Cholesky factorization succeeds):
/// a state in equilibrium at this load factor is then stable. The state must have the polar rotations of its
/// displacement.
pub fn is_stable(
    problem: &Problem,
    state: &State,
    load_factor: f64,
    forces: &mut Forces,
    workspace: &mut Workspace,
) -> bool {
    compute_tangent(problem, state, forces, workspace, Tangent::EXACT, load_factor);
    check_factor(workspace, problem.system()).is_ok_and(|(matrix, factor)| factor.factorize(matrix.values()).is_ok())
}

/// Computes a tangent of a state, including the loads' part.
fn compute_tangent(
    problem: &Problem,
    state: &State,
    forces: &mut Forces,
    workspace: &mut Workspace,
    tangent: Tangent,
    load_factor: f64,
) {
    problem.linearize(state, forces, Some((tangent, &mut workspace.linear.matrix)));
    problem.add_load_stiffness(state, tangent, load_factor, &mut workspace.linear.matrix);
    workspace.tangent = Some(tangent);
}

/// Returns the matrix, and a factor other than that of the iteration, which `auto` uses again.
fn check_factor<'a>(
    workspace: &'a mut Workspace,
    system: &System,
) -> Result<(&'a Matrix, &'a mut Factor), SolverError> {
    let factor = workspace.check_factor.take().map_or_else(|| system.symbolic().and_then(Factor::new), Ok)?;
    Ok((&workspace.linear.matrix, workspace.check_factor.insert(factor)))
}

/// Returns the stiffness along the supports' prescribed motion at constant loads, J: the derivative of their
/// generalised force g = Σ r · ∂u/∂λ with respect to the fraction λ of the motion. `None` if the body is unstable even
/// with the supports held, or if the value is only rounding error, as where the body follows the supports without strain.
///
/// The value is the Schur complement of the exact tangent when everything but λ is eliminated: if the supports are released
/// and driven by g instead, the body is stable if the tangent is positive definite on the free unknowns and this value
/// is positive.
pub fn support_stiffness(
    problem: &Problem,
    state: &State,
    load_factor: f64,
    forces: &mut Forces,
    workspace: &mut Workspace,
) -> Option<f64> {
    /// Step of the central differences, as a fraction of the support's displacement; their relative error is about H².
    const H: f64 = 1e-4;
    /// Rounding error of a nodal force relative to the sum of the magnitudes of the element forces there.
    const ROUNDING: f64 = 1e-14;
    let (system, supports) = (problem.system(), problem.supports());
    let (mesh, pattern) = (system.mesh(), system.pattern());
    if !is_stable(problem, state, load_factor, forces, workspace) {
        return None;
    }
    let mut free = vec![0.0; system.dofs()];
    let mut trial = state.clone();
    // Derivative of the free unknowns: K du = −∂f_int/∂λ.
    for h in [H, -H] {
        trial.copy_from(state);
        supports.put(mesh, load_factor + h, Kinematics::Corotated, &mut trial.displacement);
        system.update_rotations(&mut trial, Kinematics::Corotated);
        problem.linearize(&trial, forces, None);
        problem.balance(&trial, Kinematics::Corotated, load_factor, forces);
        pattern.restrict(forces.residual(), &mut workspace.linear.correction);
        free.iter_mut().zip(&workspace.linear.correction).for_each(|(sum, f)| *sum += f / (2.0 * h));
    }
    check_factor(workspace, system).ok()?.1.solve_in_place(&mut free);
    let (mut stiffness, mut noise) = (0.0, 0.0);
    for h in [H, -H] {
        trial.copy_from(state);
        let mut ahead = trial.displacement.clone();
        for (sign, u) in [(1.0, &mut ahead), (-1.0, &mut trial.displacement)] {
            supports.put(mesh, load_factor + h + sign * H, Kinematics::Corotated, u);
        }
        let mut increment: Vec<_> = ahead.iter().zip(&trial.displacement).map(|(a, b)| (a - b) / (2.0 * H)).collect();
        supports.put(mesh, load_factor + h, Kinematics::Corotated, &mut trial.displacement);
        pattern.advance(&free, h, &mut trial.displacement);
        system.update_rotations(&mut trial, Kinematics::Corotated);
        problem.linearize(&trial, forces, None);
        problem.balance(&trial, Kinematics::Corotated, load_factor, forces);
        // Along the free unknowns the forces balance up to the error of `free`, which therefore enters quadratically.
        pattern.add_free(&free, 1.0, &mut increment);
        let force: f64 =
            increment.iter().zip(forces.residual()).map(|(increment, residual)| -increment.dot(residual)).sum();
        stiffness += force / (2.0 * h);
        let magnitudes = increment.iter().zip(&forces.magnitude);
        noise += magnitudes.map(|(increment, force)| increment.abs().dot(force)).sum::<f64>() * ROUNDING / (2.0 * H);
    }
    (stiffness.is_finite() && stiffness.abs() > noise).then_some(stiffness)
}

/// Number of Lanczos steps; the extreme eigenvalue has a few correct digits long before.
const LANCZOS_STEPS: usize = 24;

/// Returns ρ = |λ|max(A⁻¹ G') at this state and load factor, the error factor of the warped iteration: it converges
/// here if ρ < 1.
///
/// G' is G plus the derivative of −f_ext. `None` if A cannot be factorized.
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
    check_factor(workspace, system).ok()?.1.factorize(a.values()).ok()?;
    compute_tangent(problem, state, forces, workspace, Tangent::GEOMETRIC, load_factor);
    let (g, factor) = check_factor(workspace, system).ok()?;

    let multiply = |v: &[f64], gv: &mut [f64]| g.multiply(system.pattern(), v, gv);
    let [low, high] = extreme_eigenvalues(system.dofs(), LANCZOS_STEPS, multiply, |b| factor.solve_in_place(b))?;
    Some(low.abs().max(high.abs()))
}
