//! Scalar fields for colouring a body.

use nalgebra::{Matrix2, Vector2};

use crate::assembly::{Kinematics, Problem};
use crate::mesh::MaterialPoint;
use crate::rotation::Rotation;
use crate::scene::Material;
use crate::state::State;
use crate::stress::{ErrorEstimate, Local, NodalStress, visit_points};

/// Quantity with a value at every quadrature point, and at every node except for fields of elements.
///
/// Stresses are Cauchy stresses. Strains are Biot strains ε = S − I, in the axes of the material: x and y of the body at
/// rest, which rotate with R.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Field {
    /// Von Mises stress, Pa.
    #[default]
    VonMises,
    /// Normal stress σ_x in the axes of space, Pa.
    StressX,
    /// Normal stress σ_y in the axes of space, Pa.
    StressY,
    /// Shear stress τ_xy in the axes of space, Pa.
    ShearStress,
    /// Normal stress σ_x in the axes of the material, Pa.
    MaterialStressX,
    /// Normal stress σ_y in the axes of the material, Pa.
    MaterialStressY,
    /// Shear stress τ_xy in the axes of the material, Pa.
    MaterialShearStress,
    /// Larger principal stress in the plane, Pa.
    LargerPrincipalStress,
    /// Smaller principal stress in the plane, Pa.
    SmallerPrincipalStress,
    /// Largest magnitude of a principal strain.
    LargestStrain,
    /// Normal strain ε_x.
    StrainX,
    /// Normal strain ε_y.
    StrainY,
    /// Engineering shear strain γ_xy = 2 ε_xy.
    ShearStrain,
    /// Larger principal strain in the plane.
    LargerPrincipalStrain,
    /// Smaller principal strain in the plane.
    SmallerPrincipalStrain,
    /// Magnitude of the displacement, m.
    Displacement,
    /// Displacement u_x, m.
    DisplacementX,
    /// Displacement u_y, m.
    DisplacementY,
    /// Distance of a point from its place in the reference solution, m. A simulation does not know its reference, so
    /// that this field has no value in it; the window and pictures show it.
    ReferenceDistance,
    /// Angle of the polar rotation, degrees.
    RotationAngle,
    /// Strain energy density, J/m³.
    EnergyDensity,
    /// Distribution of the estimated mesh error, percent; one value per element.
    MeshError,
}

impl Field {
    /// Identifier, name and unit of every field in their order, and `true` if values of both signs occur. Those of one
    /// kind follow each other.
    const TABLE: [(Self, &str, &str, &str, bool); 22] = [
        (Self::VonMises, "von-mises", "von Mises (Cauchy)", "Pa", false),
        (Self::StressX, "stress-x", "stress σ_x", "Pa", true),
        (Self::StressY, "stress-y", "stress σ_y", "Pa", true),
        (Self::ShearStress, "shear-stress", "shear stress τ_xy", "Pa", true),
        (Self::MaterialStressX, "material-stress-x", "stress σ_x, material axes", "Pa", true),
        (Self::MaterialStressY, "material-stress-y", "stress σ_y, material axes", "Pa", true),
        (Self::MaterialShearStress, "material-shear-stress", "shear stress τ_xy, material axes", "Pa", true),
        (Self::LargerPrincipalStress, "principal-stress-1", "principal stress σ_1", "Pa", true),
        (Self::SmallerPrincipalStress, "principal-stress-2", "principal stress σ_2", "Pa", true),
        (Self::LargestStrain, "largest-strain", "largest strain", "", false),
        (Self::StrainX, "strain-x", "strain ε_x, material axes", "", true),
        (Self::StrainY, "strain-y", "strain ε_y, material axes", "", true),
        (Self::ShearStrain, "shear-strain", "shear strain γ_xy, material axes", "", true),
        (Self::LargerPrincipalStrain, "principal-strain-1", "principal strain ε_1", "", true),
        (Self::SmallerPrincipalStrain, "principal-strain-2", "principal strain ε_2", "", true),
        (Self::Displacement, "displacement", "displacement", "m", false),
        (Self::DisplacementX, "displacement-x", "displacement u_x", "m", true),
        (Self::DisplacementY, "displacement-y", "displacement u_y", "m", true),
        (Self::ReferenceDistance, "reference-distance", "distance to the reference", "m", false),
        (Self::RotationAngle, "rotation", "rotation angle", "°", true),
        (Self::EnergyDensity, "energy-density", "strain energy density", "J/m³", false),
        (Self::MeshError, "mesh-error", "mesh error, estimated", "%", false),
    ];
    /// All fields.
    pub const ALL: [Self; 22] = {
        let (mut all, mut i) = ([Self::VonMises; 22], 0);
        while i < all.len() {
            all[i] = Self::TABLE[i].0;
            assert!(all[i] as usize == i, "the table is in the order of the fields");
            i += 1;
        }
        all
    };

    /// Returns the identifier.
    pub fn id(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// Returns the name for display.
    pub fn name(self) -> &'static str {
        Self::TABLE[self as usize].2
    }

    /// Returns the unit, empty for pure numbers.
    pub fn unit(self) -> &'static str {
        Self::TABLE[self as usize].3
    }

    /// Returns `true` if values of both signs occur.
    pub fn has_sign(self) -> bool {
        Self::TABLE[self as usize].4
    }

    /// Returns `true` if the field has one value per element and none at nodes.
    pub fn is_of_elements(self) -> bool {
        self == Self::MeshError
    }

    /// Returns `true` if the field follows from the displacement at a point alone.
    pub fn is_of_displacement(self) -> bool {
        matches!(self, Self::Displacement | Self::DisplacementX | Self::DisplacementY | Self::ReferenceDistance)
    }

    /// Computes the field at every quadrature point of a state: element by element in the mesh's order, the points of
    /// an element in the order of [`crate::element::ElementType::points`]. `None` if the arithmetic leaves the range of
    /// f64, and for the Cauchy stress if an element is inverted.
    #[doc(hidden)]
    pub fn values(self, problem: &Problem, state: &State, kinematics: Kinematics, values: &mut Vec<Option<f64>>) {
        values.clear();
        let (mesh, elements) = (problem.system().mesh(), problem.system().elements());
        if self.is_of_elements() {
            let error = ErrorEstimate::of(problem, state, &NodalStress::of(problem, state, kinematics));
            let of_points = |&v: &f64| std::iter::repeat_n(v.is_finite().then_some(v), elements.points_per_element());
            values.extend(error.elements.iter().flat_map(of_points));
        } else if self.is_of_displacement() && self != Self::ReferenceDistance {
            let points = (0..mesh.element_count()).flat_map(|element| {
                mesh.entry().points.iter().map(move |point| MaterialPoint { element, at: point.at })
            });
            let at = |(node, weight): &(u32, f64)| state.displacement.get(*node as usize).map(|u| u * *weight);
            values.extend(points.map(|point| self.of_vector(mesh.weights(point)?.iter().map(at).sum::<Option<_>>()?)));
        } else if !self.is_of_displacement() {
            visit_points(problem, state, &mut |_, local| values.push(self.of(&local, problem.material(), kinematics)));
        }
        // The reference is not known here, and a mesh may be too coarse for an estimate of its error.
        values.resize(elements.point_count(), None);
    }

    /// Returns the value for a displacement, m, or for its distance from that of the reference; `None` for other fields.
    pub(crate) fn of_vector(self, u: Vector2<f64>) -> Option<f64> {
        let value = match self {
            Self::Displacement | Self::ReferenceDistance => u.x.hypot(u.y),
            Self::DisplacementX => u.x,
            Self::DisplacementY => u.y,
            _ => return None,
        };
        value.is_finite().then_some(value)
    }

    /// Returns the value for strain and rotation at a point; `None` for fields of elements and of the displacement.
    pub(crate) fn of(self, local: &Local, material: &Material, kinematics: Kinematics) -> Option<f64> {
        let strain = &local.strain;
        let spatial = || Some(local.cauchy(material, kinematics)?.plane);
        // Without rotation, σ is that of the axes of the material.
        let own = || Some(Local { strain: *strain, rotation: Rotation::IDENTITY }.cauchy(material, kinematics)?.plane);
        let value = match self {
            Self::VonMises => local.cauchy(material, kinematics)?.von_mises(),
            Self::StressX => spatial()?.m11,
            Self::StressY => spatial()?.m22,
            Self::ShearStress => spatial()?.m12,
            Self::MaterialStressX => own()?.m11,
            Self::MaterialStressY => own()?.m22,
            Self::MaterialShearStress => own()?.m12,
            Self::LargerPrincipalStress => principal(&own()?)[0],
            Self::SmallerPrincipalStress => principal(&own()?)[1],
            Self::LargestStrain => largest_principal(strain),
            Self::StrainX => strain.m11,
            Self::StrainY => strain.m22,
            Self::ShearStrain => 2.0 * strain.m12,
            Self::LargerPrincipalStrain => principal(strain)[0],
            Self::SmallerPrincipalStrain => principal(strain)[1],
            Self::EnergyDensity => material.lame().energy_density(strain),
            Self::RotationAngle => local.rotation.angle().to_degrees(),
            Self::Displacement
            | Self::DisplacementX
            | Self::DisplacementY
            | Self::ReferenceDistance
            | Self::MeshError => return None,
        };
        value.is_finite().then_some(value)
    }
}

/// Returns both eigenvalues of a symmetric 2×2 matrix, the larger one first.
pub(crate) fn principal(m: &Matrix2<f64>) -> [f64; 2] {
    let (mean, radius) = (0.5 * m.trace(), (0.5 * (m.m11 - m.m22)).hypot(m.m12));
    [mean + radius, mean - radius]
}

/// Returns the largest magnitude of an eigenvalue of a symmetric 2×2 matrix.
pub(super) fn largest_principal(m: &Matrix2<f64>) -> f64 {
    let [larger, smaller] = principal(m);
    larger.abs().max(smaller.abs())
}
