//! Whether linear theory is good enough for a motion.

use nalgebra::Vector2;

use super::step::{combine, dot};
use crate::assembly::{Forces, Kinematics, Mass, Matrix, Problem};
use crate::element::Tangent;
use crate::rotation::Rotation;
use crate::solver::{Factor, SolverError};
use crate::state::State;

/// The fraction of the asked error that linear theory may use up: the rest is for what the estimate leaves out.
const USABLE: f64 = 0.25;
/// What linear theory does not see of a turn by θ is θ²/2 of a length that moves by θ: so much of the displacement.
const SHORTENING: f64 = 0.5;
/// Having refused, it is asked again where the body has turned by less than this fraction of what it allows: else it
/// would come and go with every swing.
const AGAIN: f64 = 0.5;
/// Stability is checked at this many times the stress …
const CHECK_AHEAD: f64 = 2.0;
/// … every so many steps, and where the elastic energy has grown by the square of that.
const CHECK_EVERY: u32 = 16;
/// A step whose elastic energy is smaller than this fraction of the body's is rounding.
const NO_WAY: f64 = 1e-12;

/// What linear theory has been found to be worth in a motion.
///
/// Its error is, at an instant, what it does not see of a turn; and over time, that the body is a little stiffer or
/// softer than it says. Over a step Δ the corotated body's stiffness is Δ·(f₁ − f₀)/Δ², and half of what linear theory is
/// off by is what a frequency is off by; a vibration's phase by the sum of this over the angles it runs through. What
/// that sum has used up does not come back. Buckling it does not see at all: the tangent must be positive definite under
/// more than the present stress.
#[derive(Debug, Default)]
pub(crate) struct LinearTheory {
    /// Whether the present state is linear theory's.
    in_use: bool,
    /// It has refused, and not been tried again since.
    refused: bool,
    /// Angle by which the phase may be off, rad.
    phase: f64,
    /// Steps since stability was checked, and the elastic energy then, J.
    checked: Option<(u32, f64)>,
    scratch: Option<Box<Scratch>>,
}

/// What is measured on the way, made once for a system.
#[derive(Debug)]
struct Scratch {
    /// The end of a step, seen corotated.
    seen: State,
    /// The step itself, seen linearly.
    way: State,
    forces: Forces,
    /// Corotated internal force where the step began, N.
    before: Vec<Vector2<f64>>,
    matrix: Matrix,
    factor: Factor,
}

impl Scratch {
    fn new(problem: &Problem) -> Result<Self, SolverError> {
        let system = problem.system();
        let rest = system.at_rest();
        Ok(Self {
            before: rest.displacement.to_vec(),
            forces: Forces::new(rest.displacement.len()),
            matrix: Matrix::new(system.pattern()),
            factor: Factor::new(system.symbolic())?,
            seen: rest.clone(),
            way: rest,
        })
    }

    /// Whether the body seen is stable, and would be under [`CHECK_AHEAD`] times its stress.
    fn is_stable(&mut self, problem: &Problem) -> bool {
        let tangent = Tangent { geometric: CHECK_AHEAD, ..Tangent::EXACT };
        problem.linearize(&self.seen, &mut self.forces, Some((tangent, &mut self.matrix)));
        problem.loads().add_stiffness(problem.system(), &self.seen.displacement, CHECK_AHEAD, &mut self.matrix);
        self.factor.factorize(self.matrix.values()).is_ok()
    }
}

impl LinearTheory {
    /// Whether the present state is linear theory's.
    pub fn is_in_use(&self) -> bool {
        self.in_use
    }

    /// Whether to try it for a step from a state, whose rotations tell if it is not in use.
    pub fn is_worth_a_try(&self, state: &State, asked: f64) -> bool {
        let most = if self.refused { AGAIN } else { 1.0 } * largest_turn(asked);
        self.phase <= USABLE * asked && (self.in_use || largest_rotation(&state.rotations) <= most)
    }

    /// Whether its step of h from a state to another is within the asked error; if so it is in use from now on.
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
            None => self.scratch.insert(Box::new(Scratch::new(problem)?)),
        };
        if !self.in_use {
            scratch.seen.copy_from(start);
            problem.follow_and_linearize(&mut scratch.seen, Kinematics::Corotated, &mut scratch.forces, None);
            scratch.before.copy_from_slice(&scratch.forces.internal);
            self.checked = None;
        }
        let Scratch { seen, way, forces, before, .. } = &mut **scratch;
        seen.copy_from(end);
        problem.follow_and_linearize(seen, Kinematics::Corotated, forces, None);
        combine(way.displacement.overwrite(), [(1.0, &end.displacement), (-1.0, &start.displacement)]);
        let (stored, stiffness) = (problem.elastic_energy(end), 2.0 * problem.elastic_energy(way));
        let corotated = dot(&way.displacement, &forces.internal) - dot(&way.displacement, before);
        let off = if stiffness > NO_WAY * stored { (corotated / stiffness - 1.0).abs() } else { 0.0 };
        before.copy_from_slice(&forces.internal);
        let length = mass.energy_product(&end.displacement);
        // Where the displacement passes zero the angle has no bound, but is no more than one.
        let angle = if length > 0.0 { h * (mass.energy_product(&end.velocity) / length).sqrt() } else { 0.0 };
        let phase = self.phase + 0.5 * off * angle.min(1.0);
        let mut accepted = largest_rotation(&seen.rotations) <= largest_turn(asked) && off.max(phase) <= USABLE * asked;
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

    /// Sets that the present state is linear theory's, or that it is not.
    pub fn set_in_use(&mut self, in_use: bool) {
        self.in_use = in_use;
    }

    /// The present state is no longer linear theory's.
    pub fn leave(&mut self) {
        self.in_use = false;
    }

    /// Forgets what was found of another motion.
    pub fn forget(&mut self) {
        *self = Self { scratch: self.scratch.take(), ..Self::default() };
    }

    /// Forgets the system too.
    pub fn forget_system(&mut self) {
        *self = Self::default();
    }
}

/// The largest turn of a part of the body that is within the asked error, rad.
fn largest_turn(asked: f64) -> f64 {
    USABLE * asked / SHORTENING
}

/// The sine of the largest rotation, or 1 from a quarter turn on.
fn largest_rotation(rotations: &[Rotation]) -> f64 {
    rotations.iter().map(|r| if r.c > 0.0 { r.s.abs() } else { 1.0 }).fold(0.0, f64::max)
}
