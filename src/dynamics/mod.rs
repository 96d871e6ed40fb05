//! Time: integrators, which take a body one step further, and the energy ledger that judges them.
//!
//! An integrator is a file beside this one and a line in [`INTEGRATORS`]. The implicit ones solve stages, all of one form:
//!
//! f_ext − f_int(u) − f_d − α M (u − û) = 0, û where the body would fly freely, with a tangent of f_int beside α M.
//!
//! They share the equations, the factor and the state with statics.

use crate::scene::IntegratorKind;

mod correction;
mod energy_momentum;
mod implicit_euler;
mod ledger;
mod linear_theory;
mod modes;
mod report;
mod stage;
mod step;
mod symplectic_euler;
mod tr_bdf2;

pub use ledger::{Ledger, Momentum};
pub(crate) use linear_theory::LinearTheory;
pub use modes::{critical_step, lowest_frequency};
pub use report::{MotionDecision, MotionReport};
pub(crate) use stage::{StageSolver, Step};
pub(crate) use step::{Booking, Memory, Solves};
pub use step::{Counts, StepError, StopReason};

/// Which mass matrix an integrator moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inertia {
    /// ∫ ρ t NₐN_b dA.
    Consistent,
    /// A mass a node.
    Lumped,
}

/// An entry of the registry.
#[derive(Clone, Copy, Debug)]
pub struct IntegratorEntry {
    /// What scene files name.
    pub kind: IntegratorKind,
    /// The name scene files use.
    pub id: &'static str,
    /// One sentence for lists and tooltips.
    pub about: &'static str,
    /// The power of the step that its error goes with.
    pub order: u32,
    /// Stages a step, each of one solve or more; 0 for an explicit integrator, which solves nothing.
    pub stages: u32,
    /// Whether it iterates to the tolerance, whatever number of solves it is asked for.
    pub always_iterates: bool,
    /// The mass matrix it moves.
    pub inertia: Inertia,
    /// Takes a step.
    pub(crate) step: fn(&mut Step<'_>) -> Result<Booking, StepError>,
}

impl IntegratorEntry {
    /// Whether it solves nothing, and is stable below a critical step only.
    #[must_use]
    pub fn is_explicit(&self) -> bool {
        self.stages == 0
    }
}

macro_rules! registry {
    ($($kind:ident => $entry:path),* $(,)?) => {
        /// Every integrator there is.
        pub static INTEGRATORS: &[&IntegratorEntry] = &[$(&$entry),*];

        impl IntegratorKind {
            /// Its entry in the registry.
            #[must_use]
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
    /// The name scene files use.
    #[must_use]
    pub fn id(self) -> &'static str {
        self.entry().id
    }
}
