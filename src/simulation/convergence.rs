//! When an iteration is over: converged, out of iterations, or going nowhere.

use crate::method::FrameError;

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
}

impl Reason {
    pub(super) fn status(self) -> Status {
        match self {
            Self::IterationLimit(_) | Self::Stagnated(_) => Status::NotConverged(self),
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
            Self::Frame(error) => write!(f, "{error}; lower the load"),
        }
    }
}

/// Iterations without progress after which an iteration is called off. Longer sees slower convergence through, and
/// keeps users of a hopeless load waiting longer.
const PATIENCE: u32 = 30;
/// A new best residual counts as progress if it is this much below the old one.
const PROGRESS: f64 = 0.98;
/// A residual that stagnates below this has met rounding, not divergence.
const ROUNDING: f64 = 1e-6;
/// Displacement over the size of the body beyond which nothing useful is to be expected. The linear solution of a
/// slender beam under a large load is absurdly long, and still what was asked for: so not too small.
const FARTHEST: f64 = 1e6;

/// Watches residuals and steps go by.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    size: f64,
    best: f64,
    waiting: u32,
    last_step: f64,
    ratio: Option<f64>,
}

impl Watch {
    pub(super) fn new(size: f64) -> Self {
        Self { size, best: f64::INFINITY, waiting: 0, last_step: 0.0, ratio: None }
    }

    pub(super) fn restart(&mut self) {
        *self = Self::new(self.size);
    }

    pub(super) fn step_ratio(&self) -> Option<f64> {
        self.ratio
    }

    /// Takes a frame's residual, step length and largest displacement; says if the iteration should be called off.
    pub(super) fn observe(&mut self, residual: f64, step: f64, farthest: f64) -> Option<Reason> {
        self.ratio = (self.last_step > 0.0).then(|| step / self.last_step).filter(|r| r.is_finite());
        self.last_step = step;
        if residual < PROGRESS * self.best {
            self.best = residual;
            self.waiting = 0;
        } else {
            self.waiting += 1;
        }
        if farthest > FARTHEST * self.size {
            Some(Reason::RanAway(FARTHEST))
        } else if self.waiting < PATIENCE {
            None
        } else if self.best < ROUNDING {
            Some(Reason::Stagnated(self.waiting))
        } else {
            Some(Reason::Wanders(self.waiting))
        }
    }
}
