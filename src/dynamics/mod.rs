//! Time integration: integrators, which compute time steps, and the energy ledger.
//!
//! To add an integrator, write a file in this folder and a line in [`INTEGRATORS`]. The implicit ones solve stages of a
//! common form:
//!
//! f_ext + s − f_int(u) − f_d − α M (u − û) = 0, with s a constant start force and û the displacement in free flight.
//! The matrix is the tangent of f_int plus α M.
//!
//! Equations, factor and state are the same as in statics.

use crate::scene::IntegratorKind;

mod correction;
mod energy_momentum;
mod implicit_euler;
mod ledger;
mod linear_theory;
mod modes;
mod stage;
mod step;
mod symplectic_euler;
#[cfg(test)]
mod tests;
mod tr_bdf2;

pub use ledger::{Ledger, Momentum};
pub(crate) use linear_theory::LinearTheory;
pub use modes::{critical_step, lowest_frequency};
pub(crate) use stage::{StageSolver, Step};
pub use step::{Counts, StepError, StopReason};
pub(crate) use step::{Memory, Solves, StepEnergy};

/// Entry of the registry.
#[derive(Clone, Copy, Debug)]
pub struct IntegratorEntry {
    /// Integrator in scene files.
    pub kind: IntegratorKind,
    /// Name in scene files.
    pub id: &'static str,
    /// One sentence for lists and tooltips.
    pub about: &'static str,
    /// Order of accuracy: the error is proportional to this power of the step.
    pub order: u32,
    /// Number of stages per step, each of one solve or more; 0 for explicit integrators.
    pub stages: u32,
    /// `true` if stages are always iterated to the tolerance, whatever number of solves is requested.
    pub always_iterates: bool,
    /// Colours of its results in charts, on a light and on a dark background.
    pub colors: [[u8; 3]; 2],
    /// Function that computes a step.
    pub(crate) step: fn(&mut Step<'_>) -> Result<StepEnergy, StepError>,
}

impl IntegratorEntry {
    /// Returns `true` for an explicit integrator, which solves no equations, has a lumped mass matrix, and is stable below a
    /// critical step only.
    pub fn is_explicit(&self) -> bool {
        self.stages == 0
    }
}

macro_rules! registry {
    ($($kind:ident => $entry:path),* $(,)?) => {
        /// All integrators.
        pub static INTEGRATORS: &[&IntegratorEntry] = &[$(&$entry),*];

        impl IntegratorKind {
            /// Returns the registry entry.
            #[doc(hidden)]
            pub fn entry(self) -> &'static IntegratorEntry {
                match self {
                    $(Self::$kind => &$entry),*
                }
            }
        }
    };
}

registry! {
    TrBdf2 => tr_bdf2::ENTRY,
    EnergyMomentum => energy_momentum::ENTRY,
    ImplicitEuler => implicit_euler::ENTRY,
    SymplecticEuler => symplectic_euler::ENTRY,
}

impl IntegratorKind {
    /// Returns all integrators, in the order of the registry.
    #[doc(hidden)]
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        INTEGRATORS.iter().map(|entry| entry.kind)
    }

    /// Returns the name in scene files.
    pub fn id(self) -> &'static str {
        self.entry().id
    }
}
