//! What the probes would see on a finer mesh: an estimate of their error where no truth is known.

use nalgebra::Vector2;

use super::StudyError;
use crate::assembly::{Forces, Kinematics, Matrix, Problem, System};
use crate::element::Tangent;
use crate::mesh::Mesh;
use crate::simulation::{Simulation, SimulationError};
use crate::solver::Factor;
use crate::state::largest;

/// Elements beyond which the refined mesh is too dear to be a by-product of a solve.
pub const MOST_ELEMENTS: usize = 40_000;

/// A step this small beside the displacement changes no estimate.
const SMALL_STEP: f64 = 1e-6;
/// Newton's steps on the refined mesh, at most: they start near its equilibrium.
const MOST_STEPS: u32 = 12;

/// The displacement of every probe of an equilibrium, m, estimated from full steps with the exact tangent on the mesh
/// refined once, from the state carried over to it: with h halved, an element whose displacements are complete to degree
/// p leaves 4⁻ᵖ of the energy's error, and as much of that of means of the displacement (Richardson's extrapolation).
///
/// One step is enough while an element turns by little; where a cell spans tens of degrees it is not, so steps are made
/// until the residual is that of a solve. Unlike an estimate from recovered stresses it is one of displacements, and sees
/// what every element gets wrong alike.
///
/// # Errors
/// [`StudyError`]: the body is in motion, the mesh is too large, or the steps do not converge.
pub fn refined_probes(simulation: &Simulation) -> Result<Vec<Vector2<f64>>, StudyError> {
    if simulation.motion().is_some() {
        return Err(StudyError::InMotion);
    }
    let mesh = simulation.system().mesh();
    if mesh.element_count() > MOST_ELEMENTS {
        return Err(StudyError::TooFine { elements: mesh.element_count() });
    }
    let fine = end_on(simulation, mesh.refined(), mesh.prolonged(simulation.displacement()))?;
    let degree = mesh.element().entry().sides.first().map_or(1, |side| side.len() - 1);
    let left = 0.25f64.powi(degree as i32);
    let coarse = simulation.problem().probes().iter().map(|p| p.mean(simulation.displacement()));
    Ok(fine.into_iter().zip(coarse).map(|(fine, coarse)| fine + (fine - coarse) * (left / (1.0 - left))).collect())
}

/// The probes where steps on another mesh end, from a displacement.
fn end_on(simulation: &Simulation, mesh: Mesh, u: Vec<Vector2<f64>>) -> Result<Vec<Vector2<f64>>, StudyError> {
    let (kinematics, tangent) = match simulation.is_linear() {
        true => (Kinematics::Linear, Tangent::WARPED),
        false => (Kinematics::Corotated, Tangent::EXACT),
    };
    let tolerance = simulation.scene().solver.tolerance;
    let system = System::with_mesh(simulation.scene(), mesh).map_err(SimulationError::from)?;
    let problem = Problem::new(simulation.scene(), system.into()).map_err(SimulationError::from)?;
    let probes = |u: &[Vector2<f64>]| problem.probes().iter().map(|p| p.mean(u)).collect();
    let system = problem.system();
    let mut state = system.at_rest();
    state.displacement.overwrite().copy_from_slice(&u);
    system.pattern().stop_fixed(state.displacement.overwrite());
    let (mut forces, mut matrix) = (Forces::new(state.displacement.len()), Matrix::new(system.pattern()));
    let mut factor = Factor::new(system.symbolic()).map_err(SimulationError::from)?;
    let mut free = vec![0.0; system.dofs()];
    for _ in 0..=MOST_STEPS {
        system.follow(&mut state, kinematics);
        problem.linearize(&state, &mut forces, Some((tangent, &mut matrix)));
        problem.add_load_stiffness(&state, tangent, 1.0, &mut matrix);
        let residual = problem.balance(&state, kinematics, 1.0, &mut forces);
        if residual <= tolerance {
            return Ok(probes(&state.displacement));
        }
        factor.factorize_symmetric(matrix.values());
        system.pattern().restrict(forces.residual(), &mut free);
        factor.solve_in_place(&mut free);
        if free.iter().any(|v| !v.is_finite()) {
            break;
        }
        system.pattern().advance(&free, 1.0, &mut state.displacement);
        // Slender bodies have residuals that rounding keeps above a tolerance; their steps vanish all the same.
        let step = free.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        if step <= SMALL_STEP * largest(&state.displacement) {
            return Ok(probes(&state.displacement));
        }
    }
    Err(StudyError::NoTruth)
}
