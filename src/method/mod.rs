//! Methods: how an iteration turns the current state into one nearer to equilibrium.
//!
//! A method decides which matrix an iteration factorizes, and when the solve is done. The iteration itself is the
//! article's, the same for all:
//!
//! rotations(F(x)) → assemble A, f → factorize → solve → update x

use crate::assembly::Kinematics;
use crate::element::Tangent;
use crate::scene::{Analysis, Invalid, MethodKind};
use crate::state::State;

mod auto;
mod certificate;
mod iteration;
mod linear;
mod newton;
mod status;
mod warped;

pub use auto::{AutoReport, Decision};
pub use certificate::{Certificate, fixed_point_rho, is_stable, rho_words, support_stiffness};
pub(crate) use iteration::measure;
pub use iteration::{Iteration, IterationError, Tolerances, Workspace};
pub(crate) use status::is_useful_start;
pub use status::{Reason, floor_words};

/// An entry of the registry.
#[derive(Clone, Copy, Debug)]
pub struct MethodEntry {
    /// What scene files name.
    pub kind: MethodKind,
    /// The name scene files use.
    pub id: &'static str,
    /// One sentence for lists and tooltips.
    pub about: &'static str,
    /// The method at rest.
    pub start: fn() -> Box<dyn Method>,
    /// How time steps are solved; `None` for a method that does not serve motions.
    pub motion: Option<MotionMethod>,
}

/// How the stages of time steps are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionMethod {
    /// Linear theory.
    Linear,
    /// Corotated, with the article's matrix A.
    Warped,
    /// Corotated, with the exact tangent A + G.
    Exact,
    /// Linear theory or earlier factors while they serve, else the exact tangent.
    Adaptive,
}

impl MethodEntry {
    /// Returns how the method solves time steps.
    ///
    /// # Errors
    /// [`Invalid`], naming the methods that serve motions, if this one does not.
    pub fn in_motion(&self) -> Result<MotionMethod, Invalid> {
        self.motion.ok_or_else(|| {
            let known: Vec<&str> = METHODS.iter().filter(|m| m.motion.is_some()).map(|m| m.id).collect();
            let known = known.join(", ");
            let message = format!("expected one of {known} beside analysis = \"dynamic\", got \"{}\"", self.id);
            Invalid::new("solver.method", message)
        })
    }

    /// `true` if the method can find what a scene with this analysis asks for.
    #[must_use]
    pub fn serves(&self, analysis: Analysis) -> bool {
        analysis == Analysis::Static || self.motion.is_some()
    }
}

macro_rules! registry {
    ($($kind:ident => $entry:path),* $(,)?) => {
        /// Every method there is: a file beside this one and a line here.
        pub const METHODS: &[MethodEntry] = &[$($entry),*];

        impl MethodKind {
            /// Its entry in the registry.
            #[must_use]
            pub fn entry(self) -> MethodEntry {
                match self {
                    $(Self::$kind => $entry),*
                }
            }
        }
    };
}

registry! {
    Linear => linear::ENTRY,
    Warped => warped::ENTRY,
    Newton => newton::ENTRY,
    Auto => auto::ENTRY,
}

impl MethodKind {
    /// The name scene files use.
    #[must_use]
    pub fn id(self) -> &'static str {
        self.entry().id
    }

    /// `true` if the method moves a body by linear theory alone.
    pub(crate) fn moves_linearly(self) -> bool {
        self.entry().motion == Some(MotionMethod::Linear)
    }
}

/// What a method makes of a state that an iteration has reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Another iteration.
    Continue,
    /// Another iteration; the load factor or the state has changed since it was measured.
    Changed,
    /// Done.
    Converged,
    /// Done as far as double precision goes: the residual is above the tolerance, and within this bound of what rounding
    /// changes in it.
    AtRounding(f64),
    /// No use to go on.
    Stop(Reason),
}

/// Why a method begins anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restart {
    /// The body is at rest, or where the caller put it; the equations are what they were.
    AtRest,
    /// The state is kept; loads or tolerances have changed, the stiffness has not.
    NewLoads,
    /// The state is kept, the stiffness is another one.
    NewStiffness,
    /// The unknowns are others: nothing that was found of them is of use.
    NewUnknowns,
}

/// What makes a method. It may remember: a new one starts at rest.
pub trait Method: std::fmt::Debug + Send + Sync {
    /// A copy as it stands, without what it keeps for the iterations to come: it finds that again.
    fn copy(&self) -> Box<dyn Method>;

    /// Forgets the iteration that was, and what the restart makes useless.
    fn restart(&mut self, why: Restart);

    /// How the present state is seen.
    fn kinematics(&self) -> Kinematics {
        Kinematics::Corotated
    }

    /// The tangent that the next iteration is going to need of the present state: it is assembled in the sweep that
    /// measures the state. `None` where none is needed, or that is not known yet.
    fn tangent(&self) -> Option<Tangent> {
        None
    }

    /// The fraction of the load that is on the body at present.
    fn load_factor(&self) -> f64 {
        1.0
    }

    /// Load steps taken so far, the present one included.
    fn load_steps(&self) -> u32 {
        1
    }

    /// Length of the last step over that of the one before: below 1 the iteration contracts.
    fn step_ratio(&self) -> Option<f64> {
        None
    }

    /// What was skipped because the scene does not need it; `None` for methods that do not decide.
    fn report(&self) -> Option<AutoReport> {
        None
    }

    /// One iteration: a new displacement from the current one.
    ///
    /// # Errors
    /// [`IterationError`]; the caller puts the state back then.
    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError>;

    /// Judges the state of the iteration.
    fn judge(&mut self, it: &mut Iteration<'_>) -> Verdict;

    /// Out of iterations: leaves the best state there is.
    fn stop(&mut self, _: &mut State) {}

    /// What to do where an iteration gave no state; the state is the one before.
    fn recover(&mut self, _: &mut Iteration<'_>, error: IterationError) -> Verdict {
        Verdict::Stop(Reason::Iteration(error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_that_does_not_serve_motions_is_refused_by_a_message_with_those_that_do() {
        for entry in METHODS.iter().filter(|entry| entry.motion.is_some()) {
            assert_eq!(entry.in_motion().ok(), entry.motion);
            assert!(entry.serves(Analysis::Dynamic));
        }
        let other = MethodEntry { id: "other", motion: None, ..MethodKind::Newton.entry() };
        let refused = other.in_motion().unwrap_err();
        assert_eq!(refused.key, "solver.method");
        let known = "expected one of linear, warped, newton, auto beside analysis = \"dynamic\", got \"other\"";
        assert_eq!(refused.message, known);
        assert!(other.serves(Analysis::Static) && !other.serves(Analysis::Dynamic));
    }
}
