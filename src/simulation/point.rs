//! What a body does at one of its material points.

use nalgebra::{Matrix2, Vector2};

use super::Simulation;
use super::field::{Field, largest_principal, von_mises};
use crate::mesh::{MaterialPoint, Mesh};
use crate::rotation::{Rotation, polar_or};

/// Displacement, deformation and stress at a material point, as the elements see them: what an element knows at its
/// quadrature points only is interpolated between these.
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
    /// The strain that makes the stress: S − I; under linear theory the symmetric part of F − I.
    pub strain: Matrix2<f64>,
    /// Stress in the plane, in the axes of the turned element, Pa.
    pub stress: Matrix2<f64>,
    /// Von Mises stress of these and of the normal stress out of the plane, Pa.
    pub von_mises: f64,
}

impl PointState {
    /// The principal strain of largest magnitude, without sign.
    #[must_use]
    pub fn largest_strain(&self) -> f64 {
        largest_principal(&self.strain)
    }
}

impl Field {
    /// The value at a material point of what [`Self::values`] has given for a body on this mesh; `None` where there is
    /// no such point, or no value.
    #[must_use]
    pub fn at(mesh: &Mesh, values: &[Option<f64>], point: MaterialPoint) -> Option<f64> {
        let weights = (mesh.entry().point_weights)(point.at);
        let first = point.element.checked_mul(weights.len())?;
        let own = values.get(first..first.checked_add(weights.len())?)?;
        own.iter().zip(weights).map(|(value, weight)| Some((*value)? * weight)).sum()
    }
}

impl Simulation {
    /// What the body does at a material point; `None` where there is no such point, or its arithmetic leaves the range
    /// of f64. One sweep over the elements.
    #[must_use]
    pub fn point_state(&self, point: MaterialPoint) -> Option<PointState> {
        let (problem, state) = (self.problem(), self.state());
        let (mesh, elements) = (problem.system().mesh(), problem.system().elements());
        let nodes = mesh.weights(point)?;
        let weights = (mesh.entry().point_weights)(point.at);
        let first = point.element * weights.len();
        let (lame, material) = (problem.material().lame(), problem.material());
        let (mut gradient, mut strain) = (Matrix2::identity(), Matrix2::zeros());
        elements.visit_strains(lame, &state.displacement, &state.rotations, &mut |q, h, own| {
            if let Some(weight) = q.checked_sub(first).and_then(|i| weights.get(i)) {
                gradient += h * *weight;
                strain += own * *weight;
            }
        });
        let rotation = polar_or(&gradient, state.rotations[elements.rotation_of(first)]);
        let stretch = rotation.matrix().transpose() * gradient;
        let stretch = (stretch + stretch.transpose()) * 0.5;
        let stress = lame.stress(&strain);
        let sum = |nodal: &[Vector2<f64>]| nodes.iter().map(|&(n, w)| nodal[n as usize] * w).sum::<Vector2<f64>>();
        let result = PointState {
            rest: sum(mesh.nodes()),
            displacement: sum(&state.displacement),
            gradient,
            rotation,
            stretch,
            strain,
            stress,
            von_mises: von_mises(&stress, material.out_of_plane_stress(stress.trace())),
        };
        let numbers = gradient.iter().chain(&stretch).chain(&strain).chain(&stress).chain(&result.displacement);
        (numbers.copied().all(f64::is_finite) && result.von_mises.is_finite()).then_some(result)
    }
}
