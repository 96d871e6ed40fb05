//! Scalar fields to colour a body with.

use nalgebra::Matrix2;

use crate::assembly::Problem;
use crate::rotation::polar_or;
use crate::state::State;

/// A quantity with one value a quadrature point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Field {
    /// Von Mises stress, Pa.
    #[default]
    VonMises,
    /// Strain energy density, J/m³.
    EnergyDensity,
    /// The principal strain of largest magnitude, without sign.
    LargestStrain,
    /// Angle of the polar rotation, degrees.
    RotationAngle,
}

impl Field {
    /// All fields.
    pub const ALL: [Self; 4] = [Self::VonMises, Self::EnergyDensity, Self::LargestStrain, Self::RotationAngle];

    /// The name people read.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::VonMises => "von Mises stress",
            Self::EnergyDensity => "strain energy density",
            Self::LargestStrain => "largest strain",
            Self::RotationAngle => "rotation angle",
        }
    }

    /// Its unit, empty for pure numbers.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::VonMises => "Pa",
            Self::EnergyDensity => "J/m³",
            Self::LargestStrain => "",
            Self::RotationAngle => "°",
        }
    }

    /// The field's value at every quadrature point of a state: element by element in the mesh's order, the points of an
    /// element in the order of [`crate::element::ElementType::points`]. `None` where its arithmetic leaves the range of
    /// f64.
    pub fn values(self, problem: &Problem, state: &State, values: &mut Vec<Option<f64>>) {
        values.clear();
        let elements = problem.system().elements();
        let (lame, material) = (problem.material().lame(), problem.material());
        elements.visit_strains(lame, &state.displacement, &state.rotations, &mut |q, h, strain| {
            let value = match self {
                Self::VonMises => {
                    let stress = lame.stress(strain);
                    von_mises(&stress, material.out_of_plane_stress(stress.trace()))
                }
                Self::EnergyDensity => lame.energy_density(strain),
                Self::LargestStrain => largest_principal(strain),
                Self::RotationAngle => {
                    // Where the polar factor is undefined the state has the one before.
                    let own = state.rotations[elements.rotation_of(q)];
                    polar_or(&(Matrix2::identity() + h), own).angle().to_degrees()
                }
            };
            values.push(value.is_finite().then_some(value));
        });
    }
}

/// The eigenvalue of a symmetric 2×2 matrix that is largest in magnitude, without sign.
pub(super) fn largest_principal(m: &Matrix2<f64>) -> f64 {
    let mean = 0.5 * m.trace();
    mean.abs() + (0.5 * (m.m11 - m.m22)).hypot(m.m12)
}

/// The von Mises stress of in-plane stresses and the normal stress out of the plane, Pa.
pub(super) fn von_mises(stress: &Matrix2<f64>, z: f64) -> f64 {
    let (a, b, c) = (stress.m11 - stress.m22, stress.m22 - z, z - stress.m11);
    // Scaled, so that squares of very large or small stresses stay in range.
    let scale = a.abs().max(b.abs()).max(c.abs()).max(stress.m12.abs());
    if scale == 0.0 {
        return 0.0;
    }
    let [a, b, c, d] = [a, b, c, stress.m12].map(|v| v / scale);
    scale * (0.5 * (a * a + b * b + c * c) + 3.0 * d * d).sqrt()
}
