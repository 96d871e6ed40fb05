//! What a time step works with.

use nalgebra::Vector2;
use thiserror::Error;

use super::correction::Corrector;
use crate::assembly::{Forces, System};
use crate::element::Tangent;
use crate::solver::SolverError;
use crate::state::State;
use crate::words::number;

/// Why a step gave no state.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum StepError {
    /// No factor.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// A number is not finite.
    #[error("a result is not a finite number")]
    NotFinite,
    /// The step has added energy as no error of rounding or linearization does.
    #[error("the step has added energy to the motion")]
    AddedEnergy,
    /// The iteration of a stage did not reach its tolerance.
    #[error("the iteration did not reach its tolerance within {0} solves")]
    NotConverged(u32),
}

/// Why a motion cannot go on.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum StopReason {
    /// A step failed, however short.
    #[error("a step failed even at {} s: {error}", number(*step))]
    Step {
        /// The last step tried, s.
        step: f64,
        /// Why it failed.
        error: StepError,
    },
    /// An explicit step gave no finite state.
    #[error("the motion exploded: the step of {} s, the critical one is about {} s", number(*step), number(*critical))]
    Exploded {
        /// The step, s.
        step: f64,
        /// The longest stable one about rest, s.
        critical: f64,
    },
    /// A node is farther from its rest position than this many sizes of the body.
    #[error("the body has gone more than {} times its size away", number(*.0))]
    RanAway(f64),
    /// Whoever was stepping has stopped before the end.
    #[error("interrupted before the end: the result is partial")]
    Interrupted,
}

/// How often a stage is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solves {
    /// This often, unless it is exact before.
    Times(u32),
    /// Until the relative residual is below a tolerance.
    Tolerance(f64),
}

impl Solves {
    /// The matrix of the elements for forces at the end of a stage. An iteration converges fastest with all of G; where
    /// its solves are counted, a negative G makes the motion explode.
    pub fn tangent(self) -> Tangent {
        match self {
            Self::Times(_) => Tangent::DEFINITE,
            Self::Tolerance(_) => Tangent::EXACT,
        }
    }
}

/// What was done since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Time steps taken.
    pub steps: u64,
    /// Back substitutions.
    pub solves: u64,
    /// Factorizations.
    pub factorizations: u64,
    /// Times that a step failed and was halved.
    pub halvings: u64,
}

/// What a step adds to the ledger, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Booking {
    /// By damping.
    pub dissipated: f64,
    /// By the integrator itself, where it can tell apart from the sum of all else.
    pub lost: Option<f64>,
    /// Work of the loads in time.
    pub pulses: f64,
    /// Work of the hand.
    pub hand: f64,
}

/// Memory steps work in, made once for a system.
#[derive(Debug)]
pub(crate) struct Memory {
    pub corrector: Corrector,
    /// Forces of the stage that was assembled last.
    pub forces: Forces,
    /// û of the present stage, m.
    pub free_flight: Vec<Vector2<f64>>,
    /// Damping force, N.
    pub damping: Vec<Vector2<f64>>,
    /// What the stage that was assembled last leaves unsolved, over the largest of its forces.
    pub residual: f64,
    /// Half way through a step, under linear theory.
    pub mean: State,
    /// For passing results.
    pub scratch: [Vec<Vector2<f64>>; 2],
}

impl Memory {
    pub fn new(system: &System) -> Result<Self, SolverError> {
        let zero = vec![Vector2::zeros(); system.mesh().nodes().len()];
        Ok(Self {
            corrector: Corrector::new(system)?,
            forces: Forces::new(zero.len()),
            free_flight: zero.clone(),
            damping: zero.clone(),
            residual: 0.0,
            mean: system.at_rest(),
            scratch: [zero.clone(), zero],
        })
    }
}

/// Product of nodal vectors.
pub(super) fn dot(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// The sum of f(x) · (uᵢ(after) − uᵢ(before)) over nodes.
pub(super) fn work(force: &[Vector2<f64>], before: &State, after: &State) -> f64 {
    let ways = after.displacement.iter().zip(&before.displacement);
    force.iter().zip(ways).map(|(f, (after, before))| f.dot(&(after - before))).sum()
}

/// result = Σ cᵢ xᵢ.
pub(super) fn combine<const N: usize>(result: &mut [Vector2<f64>], terms: [(f64, &[Vector2<f64>]); N]) {
    for (i, r) in result.iter_mut().enumerate() {
        *r = terms.iter().map(|(c, x)| x[i] * *c).sum();
    }
}
