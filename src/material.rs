//! Isotropic linear elasticity in the plane: E, ν → Lamé constants, stress, energy.

use nalgebra::{Matrix2, Matrix3};

use crate::model::{Material, Plane};
use crate::simd::Number;

/// Lamé constants of the plane problem, Pa; times a thickness, N/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// λ: Eν/(1−ν²) for plane stress, Eν/((1+ν)(1−2ν)) for plane strain.
    pub lambda: f64,
    /// μ = E/(2(1+ν)), the shear modulus.
    pub mu: f64,
}

impl Lame {
    /// Returns both constants times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { lambda: factor * self.lambda, mu: factor * self.mu }
    }

    /// Returns T = 2 μ ε + λ tr(ε) I, Pa, for a strain ε. With the Biot strain S − I this is the Biot stress.
    #[inline]
    pub fn stress<T: Number>(self, strain: &Matrix2<T>) -> Matrix2<T> {
        let (double, pressure) = (T::splat(2.0 * self.mu), T::splat(self.lambda) * (strain.m11 + strain.m22));
        Matrix2::new(
            double * strain.m11 + pressure,
            double * strain.m12,
            double * strain.m21,
            double * strain.m22 + pressure,
        )
    }

    /// Returns ψ = μ ‖ε‖² + λ/2 tr²(ε), J/m³.
    #[inline]
    pub fn energy_density<T: Number>(self, strain: &Matrix2<T>) -> T {
        let squares =
            strain.m11 * strain.m11 + strain.m12 * strain.m12 + (strain.m21 * strain.m21 + strain.m22 * strain.m22);
        let trace = strain.m11 + strain.m22;
        T::splat(self.mu) * squares + T::splat(0.5 * self.lambda) * (trace * trace)
    }
}

impl Material {
    /// Returns the Lamé constants of this material under its plane assumption.
    #[doc(hidden)]
    pub fn lame(&self) -> Lame {
        let (e, nu) = (self.young, self.poisson);
        let lambda = match self.plane {
            Plane::Stress => e * nu / (1.0 - nu * nu),
            Plane::Strain => e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        };
        Lame { lambda, mu: e / (2.0 * (1.0 + nu)) }
    }

    /// Returns the Lamé constants times the thickness, N/m, which elements integrate over their area.
    #[doc(hidden)]
    pub fn membrane(&self) -> Lame {
        let Lame { lambda, mu } = self.lame();
        Lame { lambda: lambda * self.thickness, mu: mu * self.thickness }
    }

    /// Returns the mass per area of the plane, kg/m².
    pub fn area_density(&self) -> f64 {
        self.density * self.thickness
    }

    /// Returns the matrix C of σ = C ε with ε = (ε_xx, ε_yy, 2 ε_xy), Pa.
    pub fn elasticity_matrix(&self) -> Matrix3<f64> {
        let Lame { lambda, mu } = self.lame();
        let axial = lambda + 2.0 * mu;
        Matrix3::new(axial, lambda, 0.0, lambda, axial, 0.0, 0.0, 0.0, mu)
    }

    /// Returns the stress out of the plane for in-plane stresses of the given sum: 0 in plane stress, ν (σ_xx + σ_yy)
    /// in plane strain, Pa.
    pub fn out_of_plane_stress(&self, in_plane_trace: f64) -> f64 {
        match self.plane {
            Plane::Stress => 0.0,
            Plane::Strain => self.poisson * in_plane_trace,
        }
    }
}
