//! Methods: how a frame turns the current state into the next one.
//!
//! A method decides with which rotations the body is seen, which matrix a frame factorizes, and when it is done. The
//! frame itself is the article's, the same for all:
//!
//! rotations(F(x)) → assemble A, f → factorize → solve → update x

use nalgebra::Vector2;

use crate::assembly::System;
use crate::rotation::Rotation;
use crate::scene::MethodKind;

mod auto;
mod certificate;
mod frame;
mod linear;
mod newton;
mod status;
mod warped;

pub use auto::{Decision, Thrift};
pub use certificate::{fixed_point_rho, is_stable, rho_words};
pub(crate) use frame::timed;
pub use frame::{Frame, FrameError, Goal, Profile, Workspace};
pub use status::{Reason, Status};

/// An entry of the registry.
#[derive(Clone, Copy, Debug)]
pub struct MethodEntry {
    /// What scene files name.
    pub kind: MethodKind,
    /// One sentence for lists and tooltips.
    pub about: &'static str,
    /// The method at rest.
    pub start: fn() -> Box<dyn Method>,
}

const LINEAR: MethodEntry =
    MethodEntry { kind: MethodKind::Linear, about: linear::ABOUT, start: || Box::<linear::Linear>::default() };
const WARPED: MethodEntry =
    MethodEntry { kind: MethodKind::Warped, about: warped::ABOUT, start: || Box::<warped::Warped>::default() };
const NEWTON: MethodEntry =
    MethodEntry { kind: MethodKind::Newton, about: newton::ABOUT, start: || Box::<newton::Newton>::default() };

const AUTO: MethodEntry =
    MethodEntry { kind: MethodKind::Auto, about: auto::ABOUT, start: || Box::<auto::Auto>::default() };

/// Every method there is: a file beside this one and a line here.
pub const METHODS: &[MethodEntry] = &[LINEAR, WARPED, NEWTON, AUTO];

impl MethodKind {
    /// Its entry in the registry.
    #[must_use]
    pub fn entry(self) -> MethodEntry {
        match self {
            Self::Linear => LINEAR,
            Self::Warped => WARPED,
            Self::Newton => NEWTON,
            Self::Auto => AUTO,
        }
    }
}

/// What a method makes of a state that a frame has reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Another frame.
    Continue,
    /// Another frame; the load factor or the state has changed since it was measured.
    Changed,
    /// Done.
    Converged,
    /// No use to go on.
    Stop(Reason),
}

/// Why a method begins anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occasion {
    /// The state is another one, and the equations may be.
    Reset,
    /// The state is kept; loads, supports' reactions or goals have changed, the stiffness has not.
    NewLoads,
    /// The state is kept, the stiffness is another one.
    NewStiffness,
}

/// What makes a method. It may remember: a new one starts at rest.
pub trait Method: std::fmt::Debug + Send {
    /// Forgets the iteration that was, and what the occasion makes useless.
    fn begin(&mut self, occasion: Occasion);

    /// The rotations with which the state `u` is seen.
    fn rotate(&self, system: &System, u: &[Vector2<f64>], r: &mut [Rotation]);

    /// Whether strains are measured after turning elements back. If not, they are those of linear theory.
    fn corotates(&self) -> bool;

    /// The share of the load that is on the body at present.
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

    /// What was left out because the scene does not need it; `None` for methods that do not decide.
    fn thrift(&self) -> Option<Thrift> {
        None
    }

    /// One frame: a new displacement from the current one.
    ///
    /// # Errors
    /// [`FrameError`]; the displacement is unchanged then.
    fn solve(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError>;

    /// Judges the state in `frame`.
    fn judge(&mut self, frame: &mut Frame<'_>) -> Verdict;

    /// Out of iterations: leaves the best state there is in `u`.
    fn stop(&mut self, _: &mut [Vector2<f64>]) {}

    /// What to do where a frame gave no state; the displacement is the one before.
    fn recover(&mut self, _: &mut Frame<'_>, error: FrameError) -> Verdict {
        Verdict::Stop(Reason::Frame(error))
    }
}
