//! Scalar fields to colour a body with.

use nalgebra::Matrix2;

use crate::assembly::{Kinematics, Problem};
use crate::scene::Material;
use crate::state::State;
use crate::stress::{ErrorEstimate, Local, NodalStress, visit_points};

/// A quantity that is known at every quadrature point, and, recovered, at every node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Field {
    /// Von Mises stress of the Cauchy stress, Pa.
    #[default]
    VonMises,
    /// Von Mises stress of the Biot stress, which the method computes, Pa.
    BiotVonMises,
    /// Strain energy density, J/m³.
    EnergyDensity,
    /// The principal strain of largest magnitude, without sign.
    LargestStrain,
    /// Angle of the polar rotation, degrees.
    RotationAngle,
    /// Where the mesh's own error lies: of elements, not of points; see [`ErrorEstimate::elements`], percent.
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

    /// The name people read.
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

    /// Its unit, empty for pure numbers.
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

    /// Values that differ by this are the same.
    #[must_use]
    pub fn period(self) -> Option<f64> {
        (self == Self::RotationAngle).then_some(360.0)
    }

    /// Whether it has one value an element, and none at nodes.
    #[must_use]
    pub fn is_of_elements(self) -> bool {
        self == Self::MeshError
    }

    /// The field's value at every quadrature point of a state: element by element in the mesh's order, the points of an
    /// element in the order of [`crate::element::ElementType::points`]. `None` where its arithmetic leaves the range of
    /// f64, and of the Cauchy stress where an element is turned inside out.
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

    /// The field's value at every node; of a field of elements none.
    pub fn nodal_values(self, nodal: &NodalStress, values: &mut Vec<Option<f64>>) {
        values.clear();
        let (material, kinematics) = (nodal.material(), nodal.kinematics());
        values.extend(nodal.nodes().iter().map(|local| self.of(local, material, kinematics)));
    }

    pub(super) fn of(self, local: &Local, material: &Material, kinematics: Kinematics) -> Option<f64> {
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

/// The eigenvalue of a symmetric 2×2 matrix that is largest in magnitude, without sign.
pub(super) fn largest_principal(m: &Matrix2<f64>) -> f64 {
    let mean = 0.5 * m.trace();
    mean.abs() + (0.5 * (m.m11 - m.m22)).hypot(m.m12)
}
