//! Methods: the iterations that bring a state closer to equilibrium.
//!
//! A method decides which matrix a step factorizes, under which part of the load, and when the solve is done. The step
//! itself is the article's, the same for all methods: [`crate::step`].

use crate::scene::MethodKind;
use crate::state::State;
use crate::step::{Iteration, Linearization, Operation};

mod auto;
mod certificate;
mod iteration;
mod linear;
mod newton;
mod path;
mod status;
mod warped;

pub use crate::assembly::IterationError;
pub use crate::step::Workspace;
pub use auto::{AutoReport, Decision};
pub use certificate::{Certificate, fixed_point_rho, is_stable, support_stiffness};
pub(crate) use iteration::Criteria;
pub use path::{Bifurcation, Drive, Jump, PathEndReason, PathEvents};
pub(crate) use path::{PathFollower, PathPart, PathProgress, StaticEquations};
pub use status::Reason;
pub(crate) use status::is_useful_start;

/// Entry of the registry.
#[derive(Clone, Copy, Debug)]
pub struct MethodEntry {
    /// Method in scene files.
    pub kind: MethodKind,
    /// Name in scene files.
    pub id: &'static str,
    /// One sentence for lists and tooltips.
    pub about: &'static str,
    /// Constructor.
    pub(crate) start: fn() -> Box<dyn Method>,
    /// Colours of its results in charts, on a light and on a dark background.
    pub colors: [[u8; 3]; 2],
}

/// All methods; to add one, write a file in this folder, and a line here and in `MethodKind::entry`.
pub const METHODS: &[MethodEntry] = &[linear::ENTRY, warped::ENTRY, newton::ENTRY, auto::ENTRY];

impl MethodKind {
    /// Returns the registry entry.
    #[doc(hidden)]
    pub fn entry(self) -> MethodEntry {
        match self {
            Self::Linear => linear::ENTRY,
            Self::Warped => warped::ENTRY,
            Self::Newton => newton::ENTRY,
            Self::Auto => auto::ENTRY,
        }
    }

    /// Returns the name in scene files.
    pub fn id(self) -> &'static str {
        self.entry().id
    }

    /// Returns `true` if the method moves a body by linear theory alone.
    pub(crate) fn moves_linearly(self) -> bool {
        self == Self::Linear
    }
}

/// Decision of a method after an iteration.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Continue with another iteration.
    Continue,
    /// Continue with another iteration; the load factor or the state has changed since the forces were computed.
    Changed,
    /// Converged; where the residual is above the tolerance, it is within this bound of its rounding error.
    Converged(Option<f64>),
    /// Give up.
    Stop(Reason),
}

/// Reason why a method restarts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restart {
    /// The body is at rest, or in a state set by the caller; the equations are unchanged.
    AtRest,
    /// The state is kept; loads or tolerances have changed, the stiffness has not.
    NewLoads,
    /// The state is kept; the stiffness has changed.
    NewStiffness,
    /// The unknowns have changed; all earlier results are invalid.
    NewUnknowns,
}

/// Figures of a method for display.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MethodReport {
    /// Number of load steps so far, including the current one.
    pub load_steps: u32,
    /// Number of linear solves of the last iteration.
    pub solves: u32,
    /// Counts of the solves and factorizations that were skipped; `None` for methods that skip none.
    pub auto_report: Option<AutoReport>,
}

impl MethodReport {
    const DEFAULT: Self = Self { load_steps: 1, solves: 1, auto_report: None };
}

/// Solution method: a policy over the steps of [`crate::step`]. It may have internal state; a new one starts at rest.
/// The trait is not public: methods are listed in [`METHODS`].
pub(crate) trait Method: std::fmt::Debug + Send + Sync {
    /// Clones without cached factors; they are rebuilt on first use.
    fn copy(&self) -> Box<dyn Method>;

    /// Resets the iteration, and discards what the restart makes invalid.
    fn restart(&mut self, why: Restart);

    /// Returns strain measure and load factor of the current state, and the tangent that the next step will need.
    fn linearization(&self) -> Linearization;

    /// Returns figures for display.
    fn report(&self) -> MethodReport {
        MethodReport::DEFAULT
    }

    /// Returns the critical points of the path from rest to the current state; `None` if the state is not known to be
    /// the end of that path.
    fn path_events(&self) -> Option<PathEvents> {
        None
    }

    /// Prepares the state for the next step, and returns the operation with which it begins. Afterwards,
    /// [`Self::linearization`] is that of its end.
    ///
    /// # Errors
    /// [`IterationError`]; the caller then restores the state.
    fn plan(&mut self, it: &mut Iteration<'_>, criteria: &Criteria) -> Result<Operation, IterationError>;

    /// Decides whether the linearized state is the result; `step` is the length of the step that led to it, if one did.
    fn check_convergence(&mut self, it: &mut Iteration<'_>, criteria: &Criteria, step: Option<f64>) -> Verdict;

    /// Handles a failed step; the state is the one before it. Returns how to continue.
    fn recover(&mut self, _: &mut Iteration<'_>, error: IterationError) -> Verdict {
        Verdict::Stop(Reason::Iteration(error))
    }

    /// Leaves the best available state; called when the iteration limit is reached.
    fn stop(&mut self, _: &mut State) {}
}
