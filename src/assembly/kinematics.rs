//! Measures of strain.

/// How a state is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinematics {
    /// Strains are measured after turning elements back.
    Corotated,
    /// Strains are those of linear theory.
    Linear,
}
