//! The mesh's own error, without a truth to compare with.

use nalgebra::{Matrix2, Vector2};

use super::{NodalStress, visit_points};
use crate::assembly::Problem;
use crate::state::State;

/// An estimate of what the mesh does wrong (Zienkiewicz and Zhu 1987, *A simple error estimator and adaptive procedure
/// for practical engineering analysis*; with recovered stresses 1992): the distance of the stresses that the elements
/// have, T, from those recovered at the nodes and interpolated with the shape functions, T*, in the energy norm,
///
/// η² = ∫ (T* − T) : C⁻¹ : (T* − T) t dA = ∫ (ε* − ε) : C : (ε* − ε) t dA,
///
/// relative to the energy of the body, ‖u‖² = 2 U + η².
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshError {
    /// 100 η / ‖u‖; `None` where nothing is deformed, or the arithmetic leaves the range of f64.
    pub percent: Option<f64>,
    /// Where it lies: of every element the root of its η² over its area, over that of ‖u‖² over the body's area, percent.
    /// The mean square of it over the body is the square of the whole.
    pub elements: Vec<f64>,
}

impl MeshError {
    /// Of a state and what has been recovered of it.
    #[must_use]
    pub fn of(problem: &Problem, state: &State, nodal: &NodalStress) -> Self {
        let mut result = Self::default();
        result.follow(problem, state, nodal);
        result
    }

    fn follow(&mut self, problem: &Problem, state: &State, nodal: &NodalStress) {
        let mesh = problem.system().mesh();
        let entry = mesh.element().entry();
        let moduli = problem.material().membrane();
        let mut strains = Vec::with_capacity(problem.system().elements().point_count());
        visit_points(problem, state, nodal.kinematics(), &mut |_, local| strains.push(local.strain));
        let rule: Vec<_> = entry
            .mass_points
            .iter()
            .map(|p| (p, (entry.shape)(p.at), (entry.local_gradients)(p.at), (entry.point_weights)(p.at)))
            .collect();
        let (mut error, mut energy, mut area) = (0.0, 0.0, 0.0);
        self.elements.clear();
        for (own, strains) in mesh.elements().zip(strains.chunks_exact(entry.points.len())) {
            let (mut own_error, mut own_area) = (0.0, 0.0);
            for (point, shape, gradients, weights) in &rule {
                let (mut jacobian, mut recovered) = (Matrix2::zeros(), Matrix2::zeros());
                for ((&n, shape), gradient) in own.iter().zip(shape).zip(gradients) {
                    let x: &Vector2<f64> = &mesh.nodes()[n as usize];
                    jacobian += x * gradient.transpose();
                    recovered += nodal.nodes()[n as usize].strain * *shape;
                }
                let strain: Matrix2<f64> = strains.iter().zip(weights).map(|(s, w)| s * *w).sum();
                let at_point = point.weight * jacobian.determinant();
                own_error += at_point * 2.0 * moduli.energy_density(&(recovered - strain));
                energy += at_point * 2.0 * moduli.energy_density(&strain);
                own_area += at_point;
            }
            error += own_error;
            area += own_area;
            self.elements.push(own_error / own_area);
        }
        let whole = energy + error;
        let known = whole > 0.0 && whole.is_finite();
        let percent = |share: f64| if known { 100.0 * (share / whole).sqrt() } else { 0.0 };
        self.percent = known.then(|| percent(error));
        self.elements.iter_mut().for_each(|density| *density = percent(*density * area));
    }
}
