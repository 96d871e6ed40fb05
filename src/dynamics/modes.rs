//! Natural frequencies of a body at rest, and the critical step of explicit integration.

use nalgebra::Vector2;

use crate::assembly::{Forces, Mass, Matrix, Problem};
use crate::element::Tangent;
use crate::scene::Damping;
use crate::solver::Factor;
use crate::solver::lanczos::extreme_eigenvalues;

/// Lanczos steps for the lowest frequency, which is well separated from the next.
const LOWEST: usize = 24;
/// Lanczos steps for the highest frequency, which is not well separated.
const HIGHEST: usize = 60;
/// Upper bound of the relative error with which [`HIGHEST`] steps underestimate the highest frequency.
const SHORT: f64 = 0.01;

/// Assembles K at rest.
fn stiffness(problem: &Problem) -> Matrix {
    let system = problem.system();
    let mut matrix = Matrix::new(system.pattern());
    let mut forces = Forces::new(system.mesh().nodes().len());
    problem.linearize(&system.at_rest(), &mut forces, Some((Tangent::WARPED, &mut matrix)));
    matrix
}

/// Returns the lowest angular frequency ω₁ of small vibrations about rest without loads, rad/s; `None` for a body that
/// its supports leave free to move.
pub fn lowest_frequency(problem: &Problem, mass: &Mass) -> Option<f64> {
    let system = problem.system();
    let mut factor = Factor::new(system.symbolic().ok()?).ok()?;
    factor.factorize(stiffness(problem).values()).ok()?;
    let mut inertia = Matrix::new(system.pattern());
    mass.add_to(1.0, &mut inertia);
    let multiply = |v: &[f64], mv: &mut [f64]| inertia.multiply(system.pattern(), v, mv);
    let [_, largest] = extreme_eigenvalues(system.dofs(), LOWEST, multiply, |b| factor.solve_in_place(b))?;
    Some(1.0 / largest.sqrt()).filter(|omega| omega.is_finite())
}

/// Returns the step beyond which symplectic Euler is unstable about rest, s: 2 (√(1 + ξ²) − ξ)/ω with ω the highest
/// frequency with lumped masses and ξ its damping ratio. Slightly below the exact value, because ω is known to one
/// percent.
pub fn critical_step(problem: &Problem, mass: &Mass, damping: Damping) -> Option<f64> {
    let system = problem.system();
    let matrix = stiffness(problem);
    let nodal: Vec<Vector2<f64>> = mass.lumped.iter().map(|&m| Vector2::repeat(m)).collect();
    let mut lumped = vec![0.0; system.dofs()];
    // Without the constraints of held points: they only lower the frequencies of lumped masses.
    system.pattern().select(&nodal, &mut lumped);
    let multiply = |v: &[f64], kv: &mut [f64]| matrix.multiply(system.pattern(), v, kv);
    let solve = |b: &mut [f64]| b.iter_mut().zip(&lumped).for_each(|(b, m)| *b /= m);
    let [_, largest] = extreme_eigenvalues(system.dofs(), HIGHEST, multiply, solve)?;
    let omega = largest.sqrt() * (1.0 + SHORT);
    let ratio = 0.5 * (damping.mass / omega + damping.stiffness * omega);
    Some(2.0 * ((1.0 + ratio * ratio).sqrt() - ratio) / omega).filter(|step| step.is_finite())
}
