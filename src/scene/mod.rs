//! Scenes: TOML descriptions of a beam, its material, supports, loads and probes.
//!
//! Unknown keys are rejected with their line. [`Scene::validate`] checks every number against [`keys::KEYS`] and every name
//! against the existing ones; its errors contain the expected value.

#[cfg(feature = "cli")]
mod edit;
mod mesh;
mod open;
pub mod registry;

#[cfg(feature = "cli")]
pub use edit::edited;
#[cfg(any(feature = "app", all(feature = "cli", not(target_arch = "wasm32"))))]
pub(crate) use mesh::built_in_mesh;
pub use open::{STANDARD_INPUT, Source, locate, open};

pub use crate::model::{
    Analysis, Axis, Beam, Damping, Diagonals, DynamicsSettings, ElementKind, IntegratorKind, Invalid, Load, Material,
    MeshFile, MethodKind, Place, Plane, Probe, Pulse, Scene, SceneError, SectionLine, SolverSettings, Start, Support,
    keys, limits, units,
};
