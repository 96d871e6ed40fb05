//! When an iteration is over: converged, out of iterations, or going nowhere.

use nalgebra::Vector2;

use super::{FrameError, Verdict};
use crate::assembly::System;

/// Where a simulation stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Status {
    /// Not there yet.
    #[default]
    Running,
    /// The residual is below the tolerance.
    Converged,
    /// It stopped while still improving, or at the limit of rounding.
    NotConverged(Reason),
    /// The iteration does not lead to an equilibrium; the state shown is its last finite one.
    Diverged(Reason),
}

impl Status {
    /// The word in JSON.
    #[must_use]
    pub fn id(&self) -> &'static str {
        match self {
            Self::Running | Self::NotConverged(_) => "not_converged",
            Self::Converged => "converged",
            Self::Diverged(_) => "diverged",
        }
    }
}

/// Why an iteration stopped before it converged.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// All iterations that were allowed.
    IterationLimit(u32),
    /// The residual has not fallen for this many iterations, and is as small as rounding lets it be.
    Stagnated(u32),
    /// The residual has not fallen for this many iterations.
    Wanders(u32),
    /// A node is farther from its rest position than this many sizes of the body.
    RanAway(f64),
    /// A frame gave no state.
    Frame(FrameError),
    /// No load step, however small, and no descent led on.
    Stuck,
}

impl Reason {
    /// The status it leads to.
    #[must_use]
    pub fn status(self) -> Status {
        match self {
            Self::IterationLimit(_) | Self::Stagnated(_) | Self::Stuck => Status::NotConverged(self),
            Self::Wanders(_) | Self::RanAway(_) | Self::Frame(_) => Status::Diverged(self),
        }
    }
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::IterationLimit(n) => {
                write!(f, "the limit of {n} iterations is reached; more may do")
            }
            Self::Stagnated(n) => {
                write!(f, "the residual has not fallen for {n} iterations: rounding allows no smaller one")
            }
            Self::Wanders(n) => write!(
                f,
                "the residual has not fallen for {n} iterations: this load is too large for the iteration; lower it"
            ),
            Self::RanAway(sizes) => {
                write!(f, "the body has gone more than {sizes} times its size away; lower the load")
            }
            Self::Stuck => write!(f, "no load step, however small, and no descent leads on from here"),
            Self::Frame(error) => write!(f, "{error}; lower the load"),
        }
    }
}

/// Iterations without progress after which a fixed-point iteration is called off. Longer sees slower convergence through, and
/// keeps users of a hopeless load waiting longer.
const PATIENCE: u32 = 30;
/// A new best residual counts as progress if it is this much below the old one.
const PROGRESS: f64 = 0.98;
/// A residual that stagnates below this has met rounding, not divergence.
pub(super) const ROUNDING: f64 = 1e-6;
/// Displacement over the size of the body beyond which nothing useful is to be expected. The linear solution of a
/// slender beam under a large load is absurdly long, and still what was asked for: so not too small.
const FARTHEST: f64 = 1e6;

/// Watches the residuals and steps of a fixed-point iteration go by.
#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    best: Option<f64>,
    waiting: u32,
    pub(super) steps: Steps,
}

/// The lengths of steps as they go by.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    last: f64,
    ratio: Option<f64>,
}

impl Steps {
    /// Takes the length of a step.
    pub(super) fn stepped(&mut self, step: f64) {
        self.ratio = (self.last > 0.0).then(|| step / self.last).filter(|r| r.is_finite());
        self.last = step;
    }

    /// Length of the last step over that of the one before.
    pub(super) fn ratio(&self) -> Option<f64> {
        self.ratio
    }
}

impl Watch {
    /// Judges a state by its residual and by its largest displacement over the size of the body.
    pub(super) fn judge(&mut self, residual: f64, tolerance: f64, farthest: f64) -> Verdict {
        if residual <= tolerance {
            return Verdict::Converged;
        }
        let best = *self.best.get_or_insert(f64::INFINITY);
        if residual < PROGRESS * best {
            self.best = Some(residual);
            self.waiting = 0;
        } else {
            self.waiting += 1;
        }
        if farthest > FARTHEST {
            Verdict::Stop(Reason::RanAway(FARTHEST))
        } else if self.waiting < PATIENCE {
            Verdict::Continue
        } else if best < ROUNDING {
            Verdict::Stop(Reason::Stagnated(self.waiting))
        } else {
            Verdict::Stop(Reason::Wanders(self.waiting))
        }
    }
}

/// The largest displacement over the size of the body at rest.
pub(super) fn farthest(system: &System, u: &[Vector2<f64>]) -> f64 {
    largest(u) / system.size
}

/// The largest length in a nodal field.
pub(super) fn largest(field: &[Vector2<f64>]) -> f64 {
    field.iter().map(|v| v.norm()).fold(0.0, f64::max)
}
