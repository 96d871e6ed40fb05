//! Stress and strain at a point by both definitions, and their fields recovered at the nodes.
//!
//! The method computes the strain ε = S − I in the rotated frame of the element, F = R S, and the **Biot stress** T = 2
//! μ ε + λ tr(ε) I in that frame. Other codes and handbooks mean the **Cauchy stress**, the force per deformed area in
//! the spatial frame:
//!
//! σ = J⁻¹ P Fᵀ = J⁻¹ R T S Rᵀ,
//!
//! because the first Piola–Kirchhoff stress of the corotated energy is P = R T. J is the ratio of volumes: det S in
//! plane strain; in plane stress det S (1 + ε₃₃), because the sheet thins by ε₃₃ = −ν/(1 − ν) tr ε. T and S have the
//! same principal axes, so σ is symmetric. Linear theory does not distinguish the two stresses: there σ is T.

use nalgebra::{Matrix2, Vector2};

use crate::assembly::{Kinematics, Problem};
use crate::rotation::{Rotation, polar_or};
use crate::scene::{Material, Plane};
use crate::state::State;

mod estimate;
mod singularity;
#[cfg(feature = "cli")]
mod warning;

pub use estimate::ErrorEstimate;
pub use singularity::Singularity;
#[cfg(feature = "cli")]
pub(crate) use warning::{inversion_warning, strain_warning};

/// Symmetric second-order tensor without shear out of the plane: stress (Pa) or strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneTensor {
    /// Components in the plane.
    pub plane: Matrix2<f64>,
    /// Normal component out of the plane.
    pub zz: f64,
}

impl PlaneTensor {
    /// Returns xx, yy, zz and xy; xy is the tensor component, half of the engineering shear strain.
    pub fn components(&self) -> [f64; 4] {
        [self.plane.m11, self.plane.m22, self.zz, self.plane.m12]
    }

    /// Returns all nine components, row by row.
    pub fn rows(&self) -> [f64; 9] {
        [self.plane.m11, self.plane.m12, 0.0, self.plane.m12, self.plane.m22, 0.0, 0.0, 0.0, self.zz]
    }

    /// Returns the von Mises stress √(3/2 s:s) of a stress with deviator s, Pa.
    pub fn von_mises(&self) -> f64 {
        let [x, y, z, xy] = self.components();
        let (a, b, c) = (x - y, y - z, z - x);
        // Scaled so that squares of very large or small stresses stay in range.
        let scale = a.abs().max(b.abs()).max(c.abs()).max(xy.abs());
        if scale == 0.0 {
            return 0.0;
        }
        let [a, b, c, d] = [a, b, c, xy].map(|v| v / scale);
        scale * (0.5 * (a * a + b * b + c * c) + 3.0 * d * d).sqrt()
    }

    /// Returns `true` if every component is finite.
    pub fn is_finite(&self) -> bool {
        self.components().iter().all(|v| v.is_finite())
    }
}

/// Strain and rotation at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// ε = S − I in the plane, in the rotated frame; in linear theory the symmetric part of the displacement gradient.
    pub strain: Matrix2<f64>,
    /// Rotation of F; in linear theory strain and stress are measured without it, see [`Self::frame`].
    pub rotation: Rotation,
}

impl Local {
    /// Returns ε₁₁, ε₂₂, ε₁₂ and the cosine and sine of the rotation, which are recovered and interpolated.
    pub(crate) fn components(&self) -> [f64; 5] {
        let Self { strain, rotation } = self;
        [strain.m11, strain.m22, strain.m12, rotation.c, rotation.s]
    }

    /// Returns the strain and the rotation of [`Self::components`]; interpolated cosines and sines are normalized.
    pub(crate) fn of_components([xx, yy, xy, c, s]: [f64; 5]) -> Self {
        let length = c.hypot(s);
        let is_normal = length > 0.0 && length.is_finite();
        let rotation = if is_normal { Rotation { c: c / length, s: s / length } } else { Rotation::IDENTITY };
        Self { strain: Matrix2::new(xx, xy, xy, yy), rotation }
    }

    /// Returns the mean strain and rotation of values with weights that sum to 1.
    pub(crate) fn mean(weighted: impl Iterator<Item = (Self, f64)>) -> Self {
        let (mut strain, mut turn) = (Matrix2::zeros(), Vector2::zeros());
        for (local, weight) in weighted {
            strain += local.strain * weight;
            turn += Vector2::new(local.rotation.c, local.rotation.s) * weight;
        }
        let length = turn.norm();
        let rotation =
            if length > 0.0 { Rotation { c: turn.x / length, s: turn.y / length } } else { Rotation::IDENTITY };
        Self { strain, rotation }
    }

    /// Returns the rotation of the frame in which ε is measured: R, in linear theory the identity.
    pub(crate) fn frame(&self, kinematics: Kinematics) -> Rotation {
        match kinematics {
            Kinematics::Linear => Rotation::IDENTITY,
            Kinematics::Corotated => self.rotation,
        }
    }

    /// Returns ε with its component out of the plane: −ν/(1 − ν) tr ε in plane stress, 0 in plane strain.
    pub fn strain(&self, material: &Material) -> PlaneTensor {
        let zz = match material.plane {
            Plane::Stress => -material.poisson / (1.0 - material.poisson) * self.strain.trace(),
            Plane::Strain => 0.0,
        };
        PlaneTensor { plane: self.strain, zz }
    }

    /// Returns the Biot stress T, Pa, in the rotated frame.
    pub fn biot(&self, material: &Material) -> PlaneTensor {
        let plane = material.lame().stress(&self.strain);
        PlaneTensor { plane, zz: material.out_of_plane_stress(plane.trace()) }
    }

    /// Returns the Cauchy stress σ, Pa, in the spatial frame; `None` if the body is crushed or inverted, where the
    /// Cauchy stress is undefined, and if the arithmetic leaves the range of f64.
    pub fn cauchy(&self, material: &Material, kinematics: Kinematics) -> Option<PlaneTensor> {
        let PlaneTensor { plane: t, zz } = self.biot(material);
        let stress = match kinematics {
            Kinematics::Linear => PlaneTensor { plane: t, zz },
            Kinematics::Corotated => {
                let s = Matrix2::identity() + self.strain;
                let z = 1.0 + self.strain(material).zz;
                let area = s.determinant();
                let volume = area * z;
                if !(area > 0.0 && z > 0.0 && volume > 0.0) {
                    return None;
                }
                let r = self.rotation.matrix();
                let turned = r * (t * s) * r.transpose() / volume;
                // Symmetric up to rounding.
                let xy = 0.5 * (turned.m12 + turned.m21);
                PlaneTensor { plane: Matrix2::new(turned.m11, xy, xy, turned.m22), zz: zz * z / volume }
            }
        };
        stress.is_finite().then_some(stress)
    }
}

/// Largest strain for which the linear law between T and ε is realistic.
pub const LAW_HOLDS: f64 = 0.1;

/// Calls `visit` with the index of every quadrature point and its strain and rotation: that of F, also in linear theory,
/// whose strains are measured without it.
pub fn visit_points(problem: &Problem, state: &State, visit: &mut dyn FnMut(usize, Local)) {
    let elements = problem.system().elements();
    let (u, r) = (state.displacement(), state.rotations());
    elements.visit_strains(problem.material().lame(), u, r, &mut |q, h, strain| {
        // Where the polar factor is undefined, the state's rotation is the previous one.
        let rotation = polar_or(&(Matrix2::identity() + h), r[elements.rotation_of(q)]);
        visit(q, Local { strain: *strain, rotation });
    });
}

/// Stress and strain of a state at the nodes of its mesh, recovered by patches (Zienkiewicz and Zhu 1992).
///
/// The components of ε and of R are recovered, because they are smooth wherever the body is; the stresses are computed
/// from the recovered ε and R. So all values at a node belong to one deformation.
#[derive(Clone, Debug)]
pub struct NodalStress {
    material: Material,
    kinematics: Kinematics,
    nodes: Vec<Local>,
}

/// Work memory of the recovery, reused between states.
#[derive(Debug, Default)]
pub struct RecoveryScratch {
    at_points: Vec<[f64; 5]>,
    nodal: Vec<[f64; 5]>,
}

impl NodalStress {
    /// Recovers the stress of a state.
    #[doc(hidden)]
    pub fn of(problem: &Problem, state: &State, kinematics: Kinematics) -> Self {
        let mut result = Self::empty(*problem.material());
        result.update(problem, state, kinematics, &mut RecoveryScratch::default());
        result
    }

    /// Returns an object without nodes.
    pub(crate) fn empty(material: Material) -> Self {
        Self { material, kinematics: Kinematics::Corotated, nodes: Vec::new() }
    }

    /// Recovers another state, without allocating if the mesh is the same.
    #[doc(hidden)]
    pub fn update(
        &mut self,
        problem: &Problem,
        state: &State,
        kinematics: Kinematics,
        RecoveryScratch { at_points, nodal }: &mut RecoveryScratch,
    ) {
        (self.material, self.kinematics) = (*problem.material(), kinematics);
        at_points.clear();
        visit_points(problem, state, &mut |_, local| at_points.push(local.components()));
        problem.system().recovery().recover(at_points, nodal);
        self.nodes.clear();
        self.nodes.extend(nodal.iter().copied().map(Local::of_components));
    }

    /// Returns strain and rotation at every node.
    #[doc(hidden)]
    pub fn nodes(&self) -> &[Local] {
        &self.nodes
    }

    /// Returns the material of the body.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Returns the strain measure of the state.
    #[doc(hidden)]
    pub fn kinematics(&self) -> Kinematics {
        self.kinematics
    }

    /// Returns the Cauchy stress at every node, Pa.
    pub fn cauchy(&self) -> impl ExactSizeIterator<Item = Option<PlaneTensor>> + '_ {
        self.nodes.iter().map(|local| local.cauchy(&self.material, self.kinematics))
    }

    /// Returns the node with the largest von Mises (Cauchy) stress, and this stress, Pa.
    pub fn largest_von_mises(&self) -> Option<(u32, f64)> {
        let values = (0..).zip(self.cauchy()).filter_map(|(node, stress)| Some((node, stress?.von_mises())));
        values.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
    }

    /// Returns the weighted mean of strain and rotation over nodes, with weights that sum to 1.
    #[doc(hidden)]
    pub fn mean(&self, weights: &[(u32, f64)]) -> Local {
        Local::mean(weights.iter().filter_map(|&(node, weight)| Some((*self.nodes.get(node as usize)?, weight))))
    }
}
