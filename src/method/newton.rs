//! Newton's method with the exact tangent A + G: full steps, and around them adaptive load stepping.
//!
//! The first full step from rest is the linear solution, absurdly long, and the second one repairs it: a line search on
//! the energy would refuse both, and is what makes Newton slow here. Where full steps fail the load is put on in parts.
//! Where no part is small enough, line-searched descent takes over: on A + G where that is positive definite, else on
//! A + max(G, 0), which always is.
//!
//! Supports that move are put on with the load: the body is turned as a whole with them, and what is left of their way
//! enters the first step of a load step as a force.

use super::iteration::ROUNDING;
use super::status::{LONGEST_STEP, farthest};
use super::{Iteration, IterationError, Method, MethodEntry, MotionMethod, Reason, Restart, Verdict};
use crate::assembly::Kinematics;
use crate::element::Tangent;
use crate::scene::MethodKind;
use crate::state::State;

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Newton,
    id: "newton",
    about: "Newton with the exact tangent A + G: an exact, stable equilibrium in a few solves, also under large loads.",
    start: || Box::<Newton>::default(),
    motion: Some(MotionMethod::Exact),
};

/// Full steps a load step may take before it must be close. The ordinary count is 5 to 9.
const MAX_STEPS: u32 = 15;
/// A relative residual this small is close: convergence is quadratic from here …
const CLOSE: f64 = 1e-2;
/// … and gets this many steps more.
const LAST_STEPS: u32 = 6;
/// Load steps grow by this after a success …
const GROW: f64 = 2.0;
/// … and shrink by this after a failure.
const SHRINK: f64 = 0.35;
/// A load step below this hands over to descent.
const SMALLEST_LOAD_STEP: f64 = 1e-4;
/// Relative residual that will do between load steps: the next step corrects it anyway.
const BETWEEN_LOAD_STEPS: f64 = 1e-3;
/// Steps in a row that do not shorten, after which a load step is given up.
const PATIENCE: u32 = 3;
/// Armijo's constant: descent accepts a step if the energy falls by at least this fraction of what the slope promises.
const SUFFICIENT: f64 = 1e-4;
/// Halvings of a descent step before it is given up.
const MAX_HALVINGS: u32 = 40;

/// The state of the load stepping.
#[derive(Clone, Debug)]
pub struct Newton {
    /// Load factor being solved for.
    target: f64,
    /// The last load factor whose equilibrium was found, and that equilibrium.
    reached: f64,
    base: Option<State>,
    is_based: bool,
    load_step: f64,
    /// The most that supports allow.
    largest_load_step: f64,
    load_steps: u32,
    steps: u32,
    shortest: f64,
    worse: u32,
    descends: bool,
    no_descent: bool,
    last_step: f64,
    last_residual: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Self {
            target: 1.0,
            reached: 0.0,
            base: None,
            is_based: false,
            load_step: 1.0,
            largest_load_step: 1.0,
            load_steps: 1,
            steps: 0,
            shortest: f64::INFINITY,
            worse: 0,
            descends: false,
            no_descent: false,
            last_step: 0.0,
            last_residual: f64::INFINITY,
        }
    }
}

impl Newton {
    fn begin_load_step(&mut self) {
        self.load_step = self.load_step.min(self.largest_load_step);
        // Descent takes the whole load in one go, but not supports that turn far.
        let step = if self.descends { self.largest_load_step } else { self.load_step };
        self.target = (self.reached + step).min(1.0);
        self.load_steps += 1;
        self.steps = 0;
        self.shortest = f64::INFINITY;
        self.worse = 0;
        self.last_residual = f64::INFINITY;
    }

    /// Back to the last equilibrium, with less load; or, if that was hardly any, to descent.
    fn give_up_load_step(&mut self, state: &mut State) -> Verdict {
        self.restore(state);
        self.load_step = SHRINK * (self.target - self.reached);
        self.descends = self.load_step < SMALLEST_LOAD_STEP;
        self.begin_load_step();
        Verdict::Changed
    }

    /// The last equilibrium: of no load that is the body at rest, wherever the iteration started.
    fn restore(&mut self, state: &mut State) {
        let Some(base) = self.base.as_mut().filter(|_| self.is_based) else { return };
        if self.reached == 0.0 {
            base.reset();
        }
        state.copy_from(base);
    }

    /// A step that lowers the energy: on A + G where that is positive definite, else on A + max(G, 0), halved until the
    /// energy falls.
    fn descend(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        if !it.supports_are_at(self.target, Kinematics::Corotated) {
            it.carry(self.target);
            it.assemble(Tangent::WARPED, self.target);
            it.factorize()?;
            it.put_supports(self.target, Kinematics::Corotated);
            self.last_step = it.step()?;
            return Ok(());
        }
        it.assemble(Tangent::EXACT, self.target);
        if it.factorize().is_err() {
            it.assemble(Tangent::DEFINITE, self.target);
            it.factorize()?;
        }
        it.solve_for_step()?;
        let (problem, trial) = (it.problem, &mut it.workspace.trial);
        let promised = problem.system().pattern().dot(&it.forces.residual, &it.workspace.free);
        let before = problem.energy(it.state, self.target);
        // Differences of energies below this are rounding.
        let noise = 1e-13 * before.abs();
        let mut fraction = 1.0;
        for _ in 0..MAX_HALVINGS {
            trial.copy_from(it.state);
            problem.system().pattern().advance(&it.workspace.free, fraction, &mut trial.displacement);
            problem.system().follow(trial, self.kinematics());
            let after = problem.energy(trial, self.target);
            if after.is_finite() && after <= before - SUFFICIENT * fraction * promised + noise {
                it.advance(fraction);
                self.last_step = it.step_length();
                return Ok(());
            }
            fraction *= 0.5;
        }
        self.no_descent = true;
        Ok(())
    }
}

impl Method for Newton {
    fn copy(&self) -> Box<dyn Method> {
        Box::new(self.clone())
    }

    fn restart(&mut self, _: Restart) {
        // The room for it is kept: a frame allocates nothing.
        *self = Self { base: self.base.take(), ..Self::default() };
    }

    fn tangent(&self) -> Option<Tangent> {
        Some(Tangent::EXACT)
    }

    fn load_factor(&self) -> f64 {
        self.target
    }

    fn load_steps(&self) -> u32 {
        self.load_steps
    }

    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        if !self.is_based {
            match &mut self.base {
                Some(base) if base.accept(it.state).is_ok() => base.copy_from(it.state),
                base => *base = Some(it.state.clone()),
            }
            self.is_based = true;
            self.largest_load_step = it.problem.supports().largest_load_step();
            if it.supports_must_turn_in_steps() {
                self.load_step = self.largest_load_step;
                self.target = self.load_step;
                it.workspace.tangent = None;
            }
        }
        self.steps += 1;
        if self.descends {
            return self.descend(it);
        }
        it.carry(self.target);
        it.assemble(Tangent::EXACT, self.target);
        it.factorize_symmetric();
        it.put_supports(self.target, Kinematics::Corotated);
        self.last_step = it.step()?;
        Ok(())
    }

    fn judge(&mut self, it: &mut Iteration<'_>) -> Verdict {
        let (residual, tolerance) = (it.residual, it.tolerances.residual);
        if self.steps == 0 {
            // Nothing solved yet; a state without load is its own equilibrium.
            let is_there = self.target == 1.0 && it.supports_are_at(1.0, Kinematics::Corotated);
            return if residual <= tolerance && is_there { Verdict::Converged } else { Verdict::Continue };
        }
        let enough = if self.target < 1.0 { tolerance.max(BETWEEN_LOAD_STEPS) } else { tolerance };
        let gets_on = residual < self.last_residual;
        self.last_residual = residual;
        // A step from what rounding leaves would be rounding too: soft bodies go far on it.
        let floor = if residual <= enough || self.target < 1.0 { None } else { it.floor() };
        if residual <= enough || floor.is_some() {
            it.assemble(Tangent::EXACT, self.target);
            let stable = it.factorize().is_ok();
            if self.target == 1.0 && (stable || self.descends) {
                return floor.map_or(Verdict::Converged, Verdict::AtRounding);
            }
            if !stable && !self.descends {
                return self.give_up_load_step(it.state);
            }
            self.descends = false;
            if let Some(base) = &mut self.base {
                base.copy_from(it.state);
            }
            self.reached = self.target;
            self.load_step = GROW * self.load_step.max(SMALLEST_LOAD_STEP);
            self.begin_load_step();
            return Verdict::Changed;
        }
        if self.no_descent {
            return Verdict::Stop(Reason::NoDescent);
        }
        if self.descends {
            return Verdict::Continue;
        }
        if self.last_step < self.shortest {
            self.shortest = self.last_step;
            self.worse = 0;
        } else {
            self.worse += 1;
        }
        let near = residual < ROUNDING && self.target == 1.0;
        if self.worse >= PATIENCE && near && !gets_on {
            return Verdict::Stop(Reason::Stuck(self.worse));
        }
        let nodes = (it.workspace.free.len() as f64 * 0.5).sqrt();
        let too_long = self.last_step / nodes > LONGEST_STEP * it.system().size();
        let hopeless = self.steps > 1
            && (too_long || self.worse >= PATIENCE && !near || farthest(it.system(), it.state) > LONGEST_STEP);
        let late = self.steps >= MAX_STEPS + if residual < CLOSE { LAST_STEPS } else { 0 };
        if late || hopeless { self.give_up_load_step(it.state) } else { Verdict::Continue }
    }

    fn stop(&mut self, state: &mut State) {
        // Descent only ever improves on what it started from.
        if !self.descends {
            self.restore(state);
            self.target = self.reached;
        }
    }

    fn recover(&mut self, it: &mut Iteration<'_>, error: IterationError) -> Verdict {
        if self.descends { Verdict::Stop(Reason::Iteration(error)) } else { self.give_up_load_step(it.state) }
    }
}
