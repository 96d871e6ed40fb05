//! Data of a time step.

use nalgebra::Vector2;
use thiserror::Error;

use super::correction::Corrector;
use crate::assembly::{Forces, System};
use crate::element::Tangent;
use crate::format::{engineering, number, three_digits};
use crate::sentence::{Sentence, sentence};
use crate::solver::SolverError;
use crate::state::State;

/// Reason why a step failed.
#[derive(Clone, Copy, Debug, Error, PartialEq, serde::Serialize, serde::Deserialize)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum StepError {
    /// The factorization failed.
    Solver(#[from] SolverError),
    /// A number is not finite.
    NotFinite,
    /// The step has added more energy than errors of rounding or linearization explain.
    AddedEnergy,
    /// The iteration of a stage did not reach its tolerance.
    NotConverged(u32),
}

/// Reason why a motion cannot continue.
///
/// ```
/// use warpbeam::{IntegratorKind, Scene, Simulation, Status, StepError, StopReason};
///
/// // An explicit motion explodes if its step is longer than the critical one.
/// let scene = Scene::beam(1.0, 0.1).clamp("left").gravity([0.0, -9.81]);
/// let mut swing = Simulation::new(&scene.moving(IntegratorKind::SymplecticEuler, 1.0 / 60.0))?;
/// let advice = match swing.solve() {
///     Status::Stopped(StopReason::Exploded { critical, .. }) if *critical < 0.001 => "use steps below 1 ms",
///     Status::Stopped(StopReason::Step { error: StepError::NotConverged(_), .. }) => "halve the time step",
///     _ => "read the status",
/// };
/// assert_eq!(advice, "use steps below 1 ms");
/// # Ok::<(), warpbeam::SimulationError>(())
/// ```
#[derive(Clone, Copy, Debug, Error, PartialEq, serde::Serialize, serde::Deserialize)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum StopReason {
    /// A step failed even at the smallest length.
    Step {
        /// Length of the last step tried, s.
        step: f64,
        /// Reason why it failed.
        error: StepError,
    },
    /// An explicit motion ran away, or reached a state that is not finite.
    Exploded {
        /// Step length, s.
        step: f64,
        /// Longest stable step about rest, s.
        critical: f64,
    },
    /// A node has moved by more than this multiple of the body's size.
    RanAway(f64),
    /// Stopped from outside before the end.
    Interrupted,
}

impl From<&StepError> for Sentence {
    fn from(error: &StepError) -> Self {
        match error {
            StepError::Solver(error) => error.into(),
            StepError::NotFinite => sentence!("a result is not a finite number: shorten the time step"),
            StepError::AddedEnergy => sentence!("the time step has added energy to the motion"),
            StepError::NotConverged(n) => {
                sentence!("the iteration did not reach its tolerance within %{n} solves", n)
            }
        }
    }
}

impl From<&StopReason> for Sentence {
    fn from(reason: &StopReason) -> Self {
        match reason {
            StopReason::Step { step, error } => sentence!(
                "a time step failed even when shortened to %{step}: %{error}",
                step = engineering(three_digits(*step), "s"),
                error
            ),
            StopReason::Exploded { step, critical } => sentence!(
                "the motion exploded: the time step of %{step} is too long; near rest, the critical one is about \
                 %{critical}",
                step = engineering(three_digits(*step), "s"),
                critical = engineering(three_digits(*critical), "s")
            ),
            StopReason::RanAway(sizes) => {
                sentence!("the body has moved by more than %{n} times its size", n = number(*sizes))
            }
            StopReason::Interrupted => sentence!("interrupted before the end: the result is partial"),
        }
    }
}

/// Number of solves per stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solves {
    /// This number, or fewer if the stage is solved exactly before.
    Times(u32),
    /// Until the relative residual is below this tolerance.
    Tolerance(f64),
}

impl Solves {
    /// Returns the matrix of the elements for forces at the end of a stage. An iteration converges fastest with all of
    /// G; with a fixed number of solves, a negative G makes the motion explode.
    pub fn tangent(self) -> Tangent {
        match self {
            Self::Times(_) => Tangent::DEFINITE,
            Self::Tolerance(_) => Tangent::EXACT,
        }
    }
}

/// Counts of operations since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Counts {
    /// Time steps.
    pub steps: u64,
    /// Back substitutions.
    pub solves: u64,
    /// Factorizations.
    pub factorizations: u64,
    /// Failed steps that were halved.
    pub halvings: u64,
    /// Time steps with linear theory.
    pub linear_steps: u64,
    /// Corotated time steps without a factorization.
    pub old_factor_steps: u64,
    /// Corotated time steps with a factorization.
    pub new_factor_steps: u64,
}

/// Entries of a step in the ledger, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct StepEnergy {
    /// Energy removed by damping.
    pub dissipated: f64,
    /// Energy removed by the integrator, if it is computed independently; `None` if it is the remainder of the balance.
    pub lost: Option<f64>,
    /// Work of pulses.
    pub pulses: f64,
    /// Work of the mouse spring.
    pub mouse_spring: f64,
}

/// Work memory of time steps, allocated once per system.
#[derive(Debug)]
pub(crate) struct Memory {
    pub corrector: Corrector,
    /// Forces of the stage assembled last.
    pub forces: Forces,
    /// û of the current stage, m.
    pub free_flight: Vec<Vector2<f64>>,
    /// Damping force, N.
    pub damping: Vec<Vector2<f64>>,
    /// Residual of the stage assembled last, relative to the largest of its forces.
    pub residual: f64,
    /// State half way through a step, with linear theory.
    pub mean: State,
    /// Temporary nodal vectors.
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

/// Returns the dot product of nodal vectors.
pub(super) fn dot(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Returns the work Σ f(x) · (uᵢ(after) − uᵢ(before)) over nodes.
pub(super) fn work(force: &[Vector2<f64>], before: &State, after: &State) -> f64 {
    let increments = after.displacement.iter().zip(&before.displacement);
    force.iter().zip(increments).map(|(f, (after, before))| f.dot(&(after - before))).sum()
}

/// Computes result = Σ cᵢ xᵢ.
pub(super) fn combine<const N: usize>(result: &mut [Vector2<f64>], terms: [(f64, &[Vector2<f64>]); N]) {
    for (i, r) in result.iter_mut().enumerate() {
        *r = terms.iter().map(|(c, x)| x[i] * *c).sum();
    }
}
