//! State at a material point.

use nalgebra::{Matrix2, Vector2};

use super::Simulation;
use super::field::Field;
use crate::assembly::{Kinematics, weighted_sum};
use crate::mesh::{MaterialPoint, Mesh};
use crate::rotation::Rotation;
use crate::scene::Material;
use crate::stress::{Local, NodalStress, PlaneTensor, visit_points};

/// Source of the deformation at a material point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointValues {
    /// Recovered at the nodes and interpolated.
    Recovered,
    /// Values of the element itself, interpolated between its quadrature points.
    Raw,
}

/// Displacement, deformation and stress at a material point, all of one deformation: F = R S, ε = S − I, and σ follows
/// from ε by the material law. In linear theory ε = sym F − I, R = I and S = I + ε.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PointState {
    /// Source of the deformation.
    pub values: PointValues,
    /// `true` in linear theory.
    pub is_linear: bool,
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
    /// Strain ε, in the rotated frame.
    pub strain: PlaneTensor,
    /// Cauchy stress, Pa; `None` if it is undefined.
    pub cauchy: Option<PlaneTensor>,
    local: Local,
    material: Material,
}

impl PointState {
    /// Returns the value of a field at the point; `None` if it has none, such as fields of elements.
    pub fn field(&self, field: Field) -> Option<f64> {
        let kinematics = if self.is_linear { Kinematics::Linear } else { Kinematics::Corotated };
        let u = Some(self.displacement).filter(|_| field != Field::ReferenceDistance);
        u.and_then(|u| field.of_vector(u)).or_else(|| field.of(&self.local, &self.material, kinematics))
    }
}

impl Field {
    /// Returns the value at a material point, interpolated from values recovered at the nodes of `mesh`; `None` if
    /// there is no such point, or no value, as for fields of elements and of the displacement.
    pub fn smooth_at(self, mesh: &Mesh, nodal: &NodalStress, point: MaterialPoint) -> Option<f64> {
        self.of(&nodal.mean(&mesh.weights(point)?), nodal.material(), nodal.kinematics())
    }
}

impl Simulation {
    /// Computes deformation and stress at a material point; `None` if there is no such point, or the arithmetic leaves
    /// the range of f64. Takes a loop over the whole body.
    ///
    /// ```
    /// use warpbeam::{Field, PlaneTensor, PointState, PointValues, Rotation, Scene, Simulation};
    ///
    /// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]))?;
    /// beam.solve();
    /// let middle = beam.mesh().locate([5.0, 0.4].into()).ok_or("no such point")?;
    /// let state: PointState = beam.point_state(middle, PointValues::Recovered).ok_or("the state is not finite")?;
    /// // The moment of 1 N · 5 m stretches the upper side: M y/I = 24 Pa.
    /// let stress: PlaneTensor = state.cauchy.ok_or("the stress is not defined")?;
    /// assert!((stress.plane.m11 - 24.0).abs() < 1.0);
    /// // The beam has rotated clockwise by P (L x − x²/2)/(E I) = 4.5e-4 rad.
    /// let rotation: Rotation = state.rotation;
    /// assert!((rotation.angle() + 4.5e-4).abs() < 1e-5);
    /// assert_eq!(state.field(Field::RotationAngle), Some(rotation.angle().to_degrees()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn point_state(&self, point: MaterialPoint, values: PointValues) -> Option<PointState> {
        let (problem, state) = (self.problem(), self.state());
        let mesh = problem.system().mesh();
        let (kinematics, material) = (self.kinematics(), *problem.material());
        let nodes = mesh.weights(point)?;
        let local = match values {
            PointValues::Recovered => self.nodal_stress().mean(&nodes),
            PointValues::Raw => {
                let mut own = Vec::new();
                visit_points(problem, state, &mut |q, local| own.extend(weight_of(mesh, point, q).map(|w| (local, w))));
                Local::mean(own.into_iter())
            }
        };
        // The antisymmetric part of the displacement gradient causes no strain in linear theory.
        let spin = || {
            let (mut own, mut at_points) = (0.0, Vec::new());
            let (elements, lame) = (problem.system().elements(), material.lame());
            elements.visit_strains(lame, &state.displacement, &state.rotations, &mut |q, h, _| {
                let spin = 0.5 * (h.m21 - h.m12);
                own += spin * weight_of(mesh, point, q).unwrap_or(0.0);
                at_points.push([spin]);
            });
            if values == PointValues::Recovered {
                let mut nodal = Vec::new();
                problem.system().recovery().recover(&at_points, &mut nodal);
                own = nodes.iter().map(|&(n, w)| nodal[n as usize][0] * w).sum();
            }
            Matrix2::new(0.0, -own, own, 0.0)
        };
        let stretch = Matrix2::identity() + local.strain;
        let gradient = match kinematics {
            Kinematics::Corotated => local.rotation.matrix() * stretch,
            Kinematics::Linear => stretch + spin(),
        };
        let result = PointState {
            values,
            is_linear: kinematics == Kinematics::Linear,
            rest: weighted_sum(mesh.nodes(), &nodes),
            displacement: weighted_sum(&state.displacement, &nodes),
            gradient,
            rotation: local.frame(kinematics),
            stretch,
            strain: local.strain(&material),
            cauchy: local.cauchy(&material, kinematics),
            local,
            material,
        };
        let numbers = gradient.iter().chain(&stretch).chain(&result.displacement);
        (numbers.copied().all(f64::is_finite) && result.strain.is_finite()).then_some(result)
    }
}

/// Returns the weight of a quadrature point, by its index in the mesh, in the interpolation to a material point; `None`
/// for points of other elements.
fn weight_of(mesh: &Mesh, point: MaterialPoint, number: usize) -> Option<f64> {
    let count = mesh.entry().points.len();
    if number / count != point.element {
        return None;
    }
    (mesh.entry().point_weights)(point.at).get(number % count).copied()
}
