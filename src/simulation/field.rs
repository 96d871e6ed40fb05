//! Scalar fields for colouring a body.

use nalgebra::Matrix2;

use crate::assembly::{Kinematics, Problem};
use crate::scene::Material;
use crate::state::State;
use crate::stress::{ErrorEstimate, Local, NodalStress, visit_points};

/// Quantity with a value at every quadrature point, and recovered at every node.
///
/// See [`Simulation::point_state`](crate::Simulation::point_state) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Field {
    /// Von Mises stress of the Cauchy stress, Pa.
    #[default]
    VonMises,
    /// Von Mises stress of the Biot stress, which the method computes, Pa.
    BiotVonMises,
    /// Strain energy density, J/m³.
    EnergyDensity,
    /// Largest magnitude of a principal strain.
    LargestStrain,
    /// Angle of the polar rotation, degrees.
    RotationAngle,
    /// Distribution of the estimated mesh error, percent; one value per element.
    MeshError,
}

impl Field {
    /// All fields.
    pub const ALL: [Self; 6] = [
        Self::VonMises,
        Self::BiotVonMises,
        Self::EnergyDensity,
        Self::LargestStrain,
        Self::RotationAngle,
        Self::MeshError,
    ];

    /// Returns the name for display.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::VonMises => "von Mises (Cauchy)",
            Self::BiotVonMises => "von Mises (Biot)",
            Self::EnergyDensity => "strain energy density",
            Self::LargestStrain => "largest strain",
            Self::RotationAngle => "rotation angle",
            Self::MeshError => "mesh error, estimated",
        }
    }

    /// Returns the unit, empty for pure numbers.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::VonMises | Self::BiotVonMises => "Pa",
            Self::EnergyDensity => "J/m³",
            Self::LargestStrain => "",
            Self::RotationAngle => "°",
            Self::MeshError => "%",
        }
    }

    /// Returns `true` if the field has one value per element and none at nodes.
    #[must_use]
    pub fn is_of_elements(self) -> bool {
        self == Self::MeshError
    }

    /// Computes the field at every quadrature point of a state: element by element in the mesh's order, the points of
    /// an element in the order of [`crate::element::ElementType::points`]. `None` if the arithmetic leaves the range of
    /// f64, and for the Cauchy stress if an element is inverted.
    #[doc(hidden)]
    pub fn values(self, problem: &Problem, state: &State, kinematics: Kinematics, values: &mut Vec<Option<f64>>) {
        values.clear();
        if self.is_of_elements() {
            let error = ErrorEstimate::of(problem, state, &NodalStress::of(problem, state, kinematics));
            let points = problem.system().elements().points_per_element();
            let own = error.elements.iter().flat_map(|&v| std::iter::repeat_n(v.is_finite().then_some(v), points));
            values.extend(own);
            return;
        }
        let material = problem.material();
        visit_points(problem, state, kinematics, &mut |_, local| values.push(self.of(&local, material, kinematics)));
    }

    /// Computes the field at every node; all values are `None` for fields of elements.
    #[doc(hidden)]
    pub fn nodal_values(self, nodal: &NodalStress, values: &mut Vec<Option<f64>>) {
        values.clear();
        let (material, kinematics) = (nodal.material(), nodal.kinematics());
        values.extend(nodal.nodes().iter().map(|local| self.of(local, material, kinematics)));
    }

    pub(crate) fn of(self, local: &Local, material: &Material, kinematics: Kinematics) -> Option<f64> {
        let value = match self {
            Self::VonMises => local.cauchy(material, kinematics)?.von_mises(),
            Self::BiotVonMises => local.biot(material).von_mises(),
            Self::EnergyDensity => material.lame().energy_density(&local.strain),
            Self::LargestStrain => largest_principal(&local.strain),
            Self::RotationAngle => local.rotation.angle().to_degrees(),
            Self::MeshError => return None,
        };
        value.is_finite().then_some(value)
    }
}

/// Returns the largest magnitude of an eigenvalue of a symmetric 2×2 matrix.
pub(super) fn largest_principal(m: &Matrix2<f64>) -> f64 {
    let mean = 0.5 * m.trace();
    mean.abs() + (0.5 * (m.m11 - m.m22)).hypot(m.m12)
}
