//! What a body does at one of its material points.

use nalgebra::{Matrix2, Vector2};

use super::Simulation;
use super::field::{Field, largest_principal};
use crate::mesh::{MaterialPoint, Mesh};
use crate::rotation::{Rotation, polar_or};
use crate::stress::{NodalStress, PlaneTensor};

/// Displacement, deformation and stress at a material point. F, R and S are the element's: what it knows at its quadrature
/// points only is interpolated between these. Strain and stress are those recovered at the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PointState {
    /// Position at rest X, m.
    pub rest: Vector2<f64>,
    /// Displacement u = x − X, m.
    pub displacement: Vector2<f64>,
    /// Deformation gradient F = ∂x/∂X.
    pub gradient: Matrix2<f64>,
    /// R of the polar decomposition F = R S (article eqs. 37–39).
    pub rotation: Rotation,
    /// S = RᵀF, symmetric.
    pub stretch: Matrix2<f64>,
    /// The strain ε, recovered, in the frame turned back.
    pub strain: PlaneTensor,
    /// The Cauchy stress, recovered, Pa; `None` where there is none.
    pub cauchy: Option<PlaneTensor>,
}

impl PointState {
    /// The principal strain of largest magnitude, without sign.
    #[must_use]
    pub fn largest_strain(&self) -> f64 {
        largest_principal(&self.strain.plane)
    }
}

impl Field {
    /// The value at a material point of what has been recovered at the nodes of this mesh; `None` where there is no such
    /// point, or no value.
    #[must_use]
    pub fn smooth_at(self, mesh: &Mesh, nodal: &NodalStress, point: MaterialPoint) -> Option<f64> {
        self.of(&nodal.mean(&mesh.weights(point)?), nodal.material(), nodal.kinematics())
    }

    /// The value at a material point of what [`Self::values`] has given for a body on this mesh; `None` where there is
    /// no such point, or no value.
    #[must_use]
    pub fn raw_at(mesh: &Mesh, values: &[Option<f64>], point: MaterialPoint) -> Option<f64> {
        let weights = (mesh.entry().point_weights)(point.at);
        let first = point.element.checked_mul(weights.len())?;
        let own = values.get(first..first.checked_add(weights.len())?)?;
        own.iter().zip(weights).map(|(value, weight)| Some((*value)? * weight)).sum()
    }
}

impl Simulation {
    /// What the body does at a material point; `None` where there is no such point, or its arithmetic leaves the range
    /// of f64. A recovery of the whole body.
    #[must_use]
    pub fn point_state(&self, point: MaterialPoint) -> Option<PointState> {
        let (problem, state) = (self.problem(), self.state());
        let (mesh, elements) = (problem.system().mesh(), problem.system().elements());
        let nodes = mesh.weights(point)?;
        let weights = (mesh.entry().point_weights)(point.at);
        let first = point.element * weights.len();
        let lame = problem.material().lame();
        let mut gradient = Matrix2::identity();
        elements.visit_strains(lame, &state.displacement, &state.rotations, &mut |q, h, _| {
            if let Some(weight) = q.checked_sub(first).and_then(|i| weights.get(i)) {
                gradient += h * *weight;
            }
        });
        let rotation = polar_or(&gradient, state.rotations[elements.rotation_of(first)]);
        let stretch = rotation.matrix().transpose() * gradient;
        let stretch = (stretch + stretch.transpose()) * 0.5;
        let recovered = self.nodal_stress();
        let local = recovered.mean(&nodes);
        let sum = |nodal: &[Vector2<f64>]| nodes.iter().map(|&(n, w)| nodal[n as usize] * w).sum::<Vector2<f64>>();
        let result = PointState {
            rest: sum(mesh.nodes()),
            displacement: sum(&state.displacement),
            gradient,
            rotation,
            stretch,
            strain: local.strain(recovered.material()),
            cauchy: local.cauchy(recovered.material(), recovered.kinematics()),
        };
        let numbers = gradient.iter().chain(&stretch).chain(&result.displacement);
        (numbers.copied().all(f64::is_finite) && result.strain.is_finite()).then_some(result)
    }
}
