//! When an iteration is over: converged, out of iterations, or going nowhere.

use super::iteration::ROUNDING;
use super::{Iteration, IterationError, Verdict};
use crate::assembly::System;
use crate::state::{State, largest};
use crate::words::{count, number, two_digits};

/// Why an iteration stopped before it converged.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// All iterations that were allowed.
    IterationLimit(u32),
    /// The residual has not fallen for this many iterations; it is small, and more than rounding explains.
    Stuck(u32),
    /// The residual has not fallen for this many iterations, and is not small.
    Stalled(u32),
    /// A node is farther from its rest position than this many sizes of the body.
    RanAway(f64),
    /// An iteration gave no state.
    Iteration(IterationError),
    /// No load step, however small, and no descent led on.
    NoDescent,
    /// Stopped from outside.
    Interrupted,
}

impl Reason {
    /// Whether the iteration leads nowhere; if not it stopped while still improving, or near its end.
    #[must_use]
    pub fn is_divergence(&self) -> bool {
        match self {
            Self::IterationLimit(_) | Self::Stuck(_) | Self::NoDescent | Self::Interrupted => false,
            Self::Stalled(_) | Self::RanAway(_) | Self::Iteration(_) => true,
        }
    }
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::IterationLimit(n) => {
                write!(f, "the limit of {} is reached; more may do", count(*n, "iteration"))
            }
            Self::Stuck(n) => {
                write!(f, "the residual has not fallen for {n} iterations, and is more than rounding explains")
            }
            Self::Stalled(n) => write!(
                f,
                "the residual has not fallen for {n} iterations: this load is too large for the iteration; lower it"
            ),
            Self::RanAway(sizes) => {
                write!(f, "the body has gone more than {sizes} times its size away; lower the load")
            }
            Self::Interrupted => write!(f, "interrupted before the end: the result is partial"),
            Self::NoDescent => write!(f, "no load step, however small, and no descent leads on from here"),
            Self::Iteration(error) => write!(f, "{error}; lower the load"),
        }
    }
}

/// What it means that a solve has ended at the bound of rounding in its residual, in words.
#[must_use]
pub fn floor_words(floor: f64, tolerance: f64) -> String {
    let [floor, tolerance] = [floor, tolerance].map(|v| number(two_digits(v)));
    format!("no digits are left: rounding may change the residual by {floor}, so {tolerance} cannot be asked for here")
}

/// Iterations without progress after which a fixed-point iteration is called off. A larger number lets slower
/// iterations converge; a smaller one tells the user earlier that a load is hopeless.
const PATIENCE: u32 = 30;
/// A new best residual counts as progress if it is this much below the old one.
const PROGRESS: f64 = 0.98;
/// A residual that is more than this part of the one before no longer falls as an iteration makes it.
const FALLS: f64 = 0.5;
/// Displacement over the size of the body beyond which nothing useful is to be expected. The linear solution of a
/// slender beam under a large load is absurdly long, and still what was asked for: so not too small.
const FARTHEST: f64 = 1e6;

/// Sees from its residuals whether a fixed-point iteration still gets anywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct StallDetector {
    best: Option<f64>,
    last: Option<f64>,
    waiting: u32,
    pub(super) steps: StepLengths,
}

/// The lengths of the last two steps.
#[derive(Clone, Debug, Default)]
pub(super) struct StepLengths {
    last: f64,
    ratio: Option<f64>,
}

impl StepLengths {
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

impl StallDetector {
    /// Judges the state of an iteration.
    pub(super) fn judge(&mut self, it: &mut Iteration<'_>) -> Verdict {
        let residual = it.residual;
        if residual <= it.tolerances.residual {
            return Verdict::Converged;
        }
        if self.last.replace(residual).is_some_and(|last| residual > FALLS * last)
            && let Some(floor) = it.floor()
        {
            return Verdict::AtRounding(floor);
        }
        let farthest = farthest(it.system(), it.state);
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
            Verdict::Stop(Reason::Stuck(self.waiting))
        } else {
            Verdict::Stop(Reason::Stalled(self.waiting))
        }
    }
}

/// The largest displacement over the size of the body at rest.
pub(super) fn farthest(system: &System, state: &State) -> f64 {
    largest(&state.displacement) / system.size()
}

/// A displacement this many sizes of the body long is not worth going on from. The linear solution of a slender beam
/// under a moderate load, with which Newton's method begins, is shorter.
pub(super) const LONGEST_STEP: f64 = 20.0;

/// Whether a solve that starts from this state has a chance: it is finite, not absurdly far from rest, and no element is
/// crushed or turned inside out.
pub(crate) fn is_useful_start(system: &System, state: &State) -> bool {
    /// Area of an element over that at rest, below which it counts as crushed.
    const CRUSHED: f64 = 0.01;
    state.is_finite()
        && farthest(system, state) <= LONGEST_STEP
        && system.elements().smallest_area_ratio(&state.displacement) > CRUSHED
}
