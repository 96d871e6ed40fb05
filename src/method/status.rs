//! End of an iteration: converged, out of iterations, or diverging.

use super::iteration::ROUNDING;
use super::{Criteria, IterationError, Verdict};
use crate::assembly::System;
use crate::format::engineering;
use crate::sentence::{Sentence, displayed, sentence};
use crate::state::{State, largest};
use crate::step::Iteration;

/// Reason why an iteration stopped before it converged.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Reason {
    /// The iteration limit was reached.
    IterationLimit(u32),
    /// The residual has not fallen for this many iterations; it is small, but above its rounding error.
    Stuck(u32),
    /// The residual has not fallen for this many iterations, and is not small.
    Stalled(u32),
    /// A node has moved by more than this multiple of the body's size.
    RanAway(f64),
    /// An iteration failed.
    Iteration(IterationError),
    /// No stable equilibrium was found beyond this load factor.
    NoEquilibrium(f64),
    /// Stopped from outside.
    Interrupted,
}

impl Reason {
    /// Returns `true` if the iteration diverges; `false` if it stopped while still improving, or close to convergence.
    pub fn is_divergence(&self) -> bool {
        match self {
            Self::IterationLimit(_) | Self::Stuck(_) | Self::NoEquilibrium(_) | Self::Interrupted => false,
            Self::Stalled(_) | Self::RanAway(_) | Self::Iteration(_) => true,
        }
    }
}

displayed!(Reason);

impl From<&Reason> for Sentence {
    fn from(reason: &Reason) -> Self {
        match reason {
            Reason::IterationLimit(n) => {
                sentence!("the limit of %{count} is reached", count = Self::count(*n, "iteration"))
            }
            Reason::Stuck(n) => {
                sentence!("the residual has not fallen for %{n} iterations, and is larger than rounding errors", n)
            }
            Reason::Stalled(n) => {
                sentence!("the residual has not fallen for %{n} iterations: the load is too large for this method", n)
            }
            Reason::RanAway(sizes) => {
                sentence!("the body has moved by more than %{n} times its size", n = sizes)
            }
            Reason::Interrupted => sentence!("interrupted before the end: the result is partial"),
            Reason::NoEquilibrium(factor) => sentence!(
                "no stable equilibrium was found beyond %{percent} of the load",
                percent = engineering(100.0 * factor, "%")
            ),
            Reason::Iteration(error) => error.into(),
        }
    }
}

/// Number of iterations without progress after which a fixed-point iteration is given up. A larger number lets slower
/// iterations converge; a smaller one reports earlier that a load is too large.
const PATIENCE: u32 = 30;
/// Largest ratio of a new best residual to the old one that counts as progress.
const PROGRESS: f64 = 0.98;
/// Largest ratio of a residual to the one before that counts as falling.
const FALLS: f64 = 0.5;
/// Largest useful displacement, relative to the size of the body. It is large because the linear solution of a slender
/// beam under a large load is very long and still a valid result of linear theory.
const FARTHEST: f64 = 1e6;

/// Detects from its residuals whether a fixed-point iteration still makes progress.
#[derive(Clone, Debug, Default)]
pub(super) struct StallDetector {
    best: Option<f64>,
    last: Option<f64>,
    waiting: u32,
}

/// Lengths of the last two steps.
#[derive(Clone, Debug, Default)]
pub(super) struct StepLengths {
    pub last: f64,
    /// Length of the last step relative to the one before.
    pub ratio: Option<f64>,
}

impl StepLengths {
    /// Records the length of a step.
    pub(super) fn stepped(&mut self, step: f64) {
        self.ratio = (self.last > 0.0).then(|| step / self.last).filter(|r| r.is_finite());
        self.last = step;
    }
}

impl StallDetector {
    /// Decides whether the iteration has converged, stalled or diverged.
    pub(super) fn check_convergence(&mut self, it: &mut Iteration<'_>, criteria: &Criteria) -> Verdict {
        let residual = it.forces.relative_residual;
        if residual <= criteria.residual {
            return Verdict::Converged(None);
        }
        if self.last.replace(residual).is_some_and(|last| residual > FALLS * last)
            && let Some(floor) = it.floor()
        {
            return Verdict::Converged(Some(floor));
        }
        let farthest = farthest(it.problem.system(), it.state);
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

/// Returns the largest displacement relative to the size of the body at rest.
pub(super) fn farthest(system: &System, state: &State) -> f64 {
    largest(&state.displacement) / system.size()
}

/// Largest displacement, in sizes of the body, from which an iteration continues. The linear solution of a slender beam
/// under a moderate load, with which Newton's method begins, is shorter.
pub(super) const LONGEST_STEP: f64 = 20.0;

/// Returns `true` if a solve may start from this state: it is finite, not too far from rest, and no element is crushed
/// or inverted.
pub(crate) fn is_useful_start(system: &System, state: &State) -> bool {
    /// Ratio of an element's current to rest area below which it counts as crushed.
    const CRUSHED: f64 = 0.01;
    state.is_finite()
        && farthest(system, state) <= LONGEST_STEP
        && system.elements().smallest_area_ratio(&state.displacement) > CRUSHED
}
