//! Scalar fields to colour a body with.

use nalgebra::Matrix2;

use super::Simulation;
use crate::element::{biot_stress, energy_density};
use crate::rotation::polar;

/// A quantity with one value a quadrature point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
}

/// The eigenvalue of a symmetric 2×2 matrix that is largest in magnitude, without sign.
pub(super) fn largest_principal(m: &Matrix2<f64>) -> f64 {
    let mean = 0.5 * m.trace();
    mean.abs() + (0.5 * (m.m11 - m.m22)).hypot(m.m12)
}

impl Simulation {
    /// The field's value at every quadrature point, element by element. A value whose arithmetic leaves the range of
    /// f64 is reported as the largest number.
    pub fn field(&self, field: Field, values: &mut Vec<f64>) {
        values.clear();
        values.resize(self.system().elements.point_count(), 0.0);
        let (lame, material) = (self.system().lame, &self.system().material);
        self.system().elements.visit_strains(self.displacement(), self.rotations(), &mut |q, h, strain| {
            let value = match field {
                Field::VonMises => {
                    let t = biot_stress(lame, strain);
                    let z = material.out_of_plane_stress(t.trace());
                    let (a, b, c) = (t.m11 - t.m22, t.m22 - z, z - t.m11);
                    let scale = a.abs().max(b.abs()).max(c.abs()).max(t.m12.abs());
                    if scale == 0.0 {
                        0.0
                    } else {
                        let [a, b, c, d] = [a, b, c, t.m12].map(|v| v / scale);
                        scale * (0.5 * (a * a + b * b + c * c) + 3.0 * d * d).sqrt()
                    }
                }
                Field::EnergyDensity => energy_density(lame, strain),
                Field::LargestStrain => largest_principal(strain),
                Field::RotationAngle => polar(&(Matrix2::identity() + h)).map_or(0.0, |r| r.angle().to_degrees()),
            };
            values[q] = if value.is_nan() { 0.0 } else { value.clamp(-f64::MAX, f64::MAX) };
        });
    }
}
