//! Strain measures.

/// Strain measure of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Kinematics {
    /// Strains in the rotated frames of the elements.
    Corotated,
    /// Strains of linear theory.
    Linear,
}
