//! Decides whether linear theory is accurate enough for a motion.

use nalgebra::Vector2;

use super::step::{combine, dot};
use crate::assembly::{Forces, Kinematics, Mass, Matrix, Problem};
use crate::element::Tangent;
use crate::rotation::Rotation;
use crate::solver::{Factor, SolverError};
use crate::state::State;

/// Fraction of the requested error that linear theory may reach; the rest is a margin for what the estimate omits.
const USABLE: f64 = 0.25;
/// Error of linear theory relative to the displacement, per rotation angle θ: a length that rotates by θ moves by θ and
/// shortens by θ²/2, which linear theory neglects.
const SHORTENING: f64 = 0.5;
/// Hysteresis: after a rejection, linear theory is tried again below this fraction of the rotation limit; otherwise it
/// would alternate with every oscillation.
const AGAIN: f64 = 0.5;
/// Multiple of the stress at which stability is checked.
const CHECK_AHEAD: f64 = 2.0;
/// Number of steps between stability checks; a check is also made when the elastic energy has grown by
/// [`CHECK_AHEAD`]².
const CHECK_EVERY: u32 = 16;
/// Smallest elastic energy of a step, relative to the body's, that is not rounding error.
const NO_WAY: f64 = 1e-12;

/// State of the decision for or against linear theory in a motion.
///
/// Linear theory has two errors: at an instant, the neglected shortening by rotations; over time, a slightly different
/// stiffness. Over a step with displacement Δ, the ratio of corotated to linear stiffness is Δ·(f₁ − f₀)/(Δ·K Δ), f₀
/// and f₁ the corotated forces at its start and end. Half of its distance from 1 is the relative error of a frequency.
/// Multiplied by the phase angles of the steps and summed, it is the phase error of a vibration, which accumulates.
/// Linear theory does not detect buckling: the tangent must be positive definite under more than the current stress.
#[derive(Debug, Default)]
pub(crate) struct LinearTheory {
    /// `true` if the current state is that of linear theory.
    pub in_use: bool,
    /// `true` if linear theory was rejected and not tried again since.
    refused: bool,
    /// Estimated phase error, rad.
    phase: f64,
    /// Steps since the last stability check, and the elastic energy at that check, J.
    checked: Option<(u32, f64)>,
    scratch: Option<Box<StepScratch>>,
}

/// Work memory, allocated once per system.
#[derive(Debug)]
struct StepScratch {
    /// Corotated state at the end of a step.
    seen: State,
    /// Displacement of the step, as a state of linear theory.
    increment: State,
    forces: Forces,
    /// Corotated internal force at the start of the step, N.
    before: Vec<Vector2<f64>>,
    matrix: Matrix,
    factor: Factor,
}

impl StepScratch {
    fn new(problem: &Problem) -> Result<Self, SolverError> {
        let system = problem.system();
        let rest = system.at_rest();
        Ok(Self {
            before: rest.displacement.to_vec(),
            forces: Forces::new(rest.displacement.len()),
            matrix: Matrix::new(system.pattern()),
            factor: Factor::new(system.symbolic()?)?,
            seen: rest.clone(),
            increment: rest,
        })
    }

    /// Returns `true` if the body in the state `seen` is stable at [`CHECK_AHEAD`] times its stress.
    fn is_stable(&mut self, problem: &Problem) -> bool {
        let tangent = Tangent { geometric: CHECK_AHEAD, ..Tangent::EXACT };
        problem.linearize(&self.seen, &mut self.forces, Some((tangent, &mut self.matrix)));
        problem.loads().add_stiffness(problem.system(), &self.seen.displacement, CHECK_AHEAD, &mut self.matrix);
        self.factor.factorize(self.matrix.values()).is_ok()
    }
}

impl LinearTheory {
    /// Returns `true` if linear theory should be tried for a step from `state`; `asked` is the requested error. The
    /// rotations of the state decide if linear theory is not in use.
    pub fn is_worth_a_try(&self, state: &State, asked: f64) -> bool {
        let most = if self.refused { AGAIN } else { 1.0 } * largest_linear_rotation(asked);
        self.phase <= USABLE * asked && (self.in_use || largest_rotation(&state.rotations) <= most)
    }

    /// Returns `true` if the linear step of length h from one state to another is within the requested error; linear
    /// theory is then in use.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn accepts(
        &mut self,
        problem: &Problem,
        mass: &Mass,
        [start, end]: [&State; 2],
        h: f64,
        asked: f64,
    ) -> Result<bool, SolverError> {
        let scratch = match &mut self.scratch {
            Some(scratch) => scratch,
            None => self.scratch.insert(Box::new(StepScratch::new(problem)?)),
        };
        if !self.in_use {
            scratch.seen.copy_from(start);
            problem.update_and_linearize(&mut scratch.seen, Kinematics::Corotated, &mut scratch.forces, None);
            scratch.before.copy_from_slice(&scratch.forces.internal);
            self.checked = None;
        }
        let StepScratch { seen, increment, forces, before, .. } = &mut **scratch;
        seen.copy_from(end);
        problem.update_and_linearize(seen, Kinematics::Corotated, forces, None);
        combine(increment.displacement.overwrite(), [(1.0, &end.displacement), (-1.0, &start.displacement)]);
        let (stored, stiffness) = (problem.elastic_energy(end), 2.0 * problem.elastic_energy(increment));
        let corotated = dot(&increment.displacement, &forces.internal) - dot(&increment.displacement, before);
        let off = if stiffness > NO_WAY * stored { (corotated / stiffness - 1.0).abs() } else { 0.0 };
        before.copy_from_slice(&forces.internal);
        let length = mass.energy_product(&end.displacement);
        // Where the displacement passes zero the estimated angle is unbounded; it is limited to 1 rad.
        let angle = if length > 0.0 { h * (mass.energy_product(&end.velocity) / length).sqrt() } else { 0.0 };
        let phase = self.phase + 0.5 * off * angle.min(1.0);
        let mut accepted =
            largest_rotation(&seen.rotations) <= largest_linear_rotation(asked) && off.max(phase) <= USABLE * asked;
        let due = |(steps, energy): (u32, f64)| steps >= CHECK_EVERY || stored > CHECK_AHEAD * CHECK_AHEAD * energy;
        if accepted && self.checked.is_none_or(due) {
            accepted = scratch.is_stable(problem);
            self.checked = Some((0, stored));
        }
        if accepted {
            self.phase = phase;
            self.checked = self.checked.map(|(steps, energy)| (steps + 1, energy));
        }
        (self.in_use, self.refused) = (accepted, !accepted);
        Ok(accepted)
    }

    /// Resets everything but the work memory, for another motion.
    pub fn invalidate(&mut self) {
        *self = Self { scratch: self.scratch.take(), ..Self::default() };
    }
}

/// Returns the largest rotation of a part of the body that is within the requested error, rad.
fn largest_linear_rotation(asked: f64) -> f64 {
    USABLE * asked / SHORTENING
}

/// Returns the sine of the largest rotation, or 1 for rotations of 90° and more.
fn largest_rotation(rotations: &[Rotation]) -> f64 {
    rotations.iter().map(|r| if r.c > 0.0 { r.s.abs() } else { 1.0 }).fold(0.0, f64::max)
}
