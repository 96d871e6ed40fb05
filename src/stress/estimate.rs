//! Estimate of the mesh's error, without a reference solution.

use nalgebra::{Matrix2, Vector2};

use super::{NodalStress, visit_points};
use crate::assembly::{Kinematics, Problem};
use crate::rotation::Rotation;
use crate::state::State;

/// Estimate of the discretisation error (Zienkiewicz and Zhu 1987, *A simple error estimator and adaptive procedure for
/// practical engineering analysis*; with recovered stresses 1992): the distance between the elements' stresses T and
/// the stresses T* recovered at the nodes and interpolated with the shape functions, in the energy norm,
///
/// η² = ∫ (T* − T) : C⁻¹ : (T* − T) t dA = ∫ (ε* − ε) : C : (ε* − ε) t dA,
///
/// relative to the energy of the body, ‖u‖² = 2 U + η².
///
/// Recovery does not detect errors common to neighbouring elements. Elements with one rotation for all of their points
/// have such an error: bent by an angle θ, such an element keeps its height H in its frame, so that its sides, which
/// are inclined by ±θ/2, are H/cos(θ/2) long. A moment M acts on them by forces M cos(θ/2)/H, whose component along the
/// frame is M cos²(θ/2)/H: force and stress are cos²(θ/2) of the correct values. For this error the term ∫ (3 φ²)² ε :
/// C : ε t dA is added to η², φ(X) the angle from the element's rotation to the recovered one: 3 φ² has the mean θ²/4 ≈
/// sin²(θ/2).
///
/// A single row of four-node elements gives no estimate: in bending all elements have the same linear stress over the
/// height, so that none shows the curvature of the exact stress.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// 100 η / ‖u‖; `None` if nothing is deformed, for a single row of four-node elements, and if the arithmetic leaves
    /// the range of f64.
    pub percent: Option<f64>,
    /// Distribution over the elements: the root of each element's η² per area, relative to that of ‖u‖² per area of the
    /// body, percent. Its mean square over the body is the square of [`Self::percent`]. Empty for a single row of
    /// four-node elements.
    pub elements: Vec<f64>,
}

impl ErrorEstimate {
    /// Computes the estimate for a state and its recovered stresses.
    pub fn of(problem: &Problem, state: &State, nodal: &NodalStress) -> Self {
        let mesh = problem.system().mesh();
        let entry = mesh.element().entry();
        let moduli = problem.material().membrane();
        let elements = problem.system().elements();
        let per_element = entry.points.len();
        let one_rotation = elements.rotation_count() < elements.point_count();
        let is_outer = mesh.nodes_on_outline();
        if one_rotation && mesh.connectivity().iter().all(|&node| is_outer[node as usize]) {
            return Self::default();
        }
        let mut strains = Vec::with_capacity(elements.point_count());
        visit_points(problem, state, &mut |_, local| strains.push(local.strain));
        let rule: Vec<_> = entry
            .mass_points
            .iter()
            .map(|p| (p, (entry.shape)(p.at), (entry.local_gradients)(p.at), (entry.point_weights)(p.at)))
            .collect();
        let (mut error, mut energy, mut area) = (0.0, 0.0, 0.0);
        let mut weighted = Vec::new();
        let mut densities = Vec::with_capacity(mesh.element_count());
        for (e, (own, strains)) in mesh.elements().zip(strains.chunks_exact(per_element)).enumerate() {
            let (mut own_error, mut own_area) = (0.0, 0.0);
            // Linear theory turns no stress.
            let turns = one_rotation && nodal.kinematics() == Kinematics::Corotated;
            let rotation = turns.then(|| state.rotations()[elements.rotation_of(e * per_element)]);
            for (point, shape, gradients, weights) in &rule {
                let mut jacobian = Matrix2::zeros();
                for (&n, gradient) in own.iter().zip(gradients) {
                    jacobian += mesh.nodes()[n as usize] * gradient.transpose();
                }
                weighted.clear();
                weighted.extend(own.iter().copied().zip(shape.iter().copied()));
                let recovered = nodal.mean(&weighted);
                let strain: Matrix2<f64> = strains.iter().zip(weights).map(|(s, w)| s * *w).sum();
                let at_point = point.weight * jacobian.determinant();
                let own_energy = at_point * 2.0 * moduli.energy_density(&strain);
                own_error += at_point * 2.0 * moduli.energy_density(&(recovered.strain - strain));
                own_error += rotation.map_or(0.0, |r| missed(r, recovered.rotation).powi(2) * own_energy);
                energy += own_energy;
                own_area += at_point;
            }
            error += own_error;
            area += own_area;
            densities.push(own_error / own_area);
        }
        let whole = energy + error;
        let known = whole > 0.0 && whole.is_finite();
        let percent = |share: f64| if known { 100.0 * (share / whole).sqrt() } else { 0.0 };
        let elements = densities.into_iter().map(|density| percent(density * area)).collect();
        Self { percent: known.then(|| percent(error)), elements }
    }
}

/// Returns the fraction of its stress that an element misses by having one rotation: 3 φ², φ the angle from it to the
/// recovered one.
fn missed(rotation: Rotation, recovered: Rotation) -> f64 {
    let back = rotation.apply_inverse(Vector2::new(recovered.c, recovered.s));
    3.0 * back.y.atan2(back.x).powi(2)
}
