//! Newton's method with the exact tangent A + G: full steps with adaptive load stepping.
//!
//! The first full step from rest is the linear solution, which is far too long, and the second one corrects it: a line
//! search on the energy would reject both and slow Newton's method down. If full steps fail, the load is applied in
//! parts. If no part is small enough, line-searched descent takes over: with A + G if it is positive definite, else
//! with A + max(G, 0), which always is.
//!
//! The motion of supports is applied with the load: the body is rotated as a whole with them, and the rest of their
//! motion enters the first step of a load step as a force.

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

/// Full steps per load step before the residual must be close to zero. Usually 5 to 9 are needed.
const MAX_STEPS: u32 = 15;
/// Relative residual below which convergence is quadratic.
const CLOSE: f64 = 1e-2;
/// Additional steps once the residual is below [`CLOSE`].
const LAST_STEPS: u32 = 6;
/// Factor by which load steps grow after a success.
const GROW: f64 = 2.0;
/// Factor by which load steps shrink after a failure.
const SHRINK: f64 = 0.35;
/// Smallest load step; below it descent takes over.
const SMALLEST_LOAD_STEP: f64 = 1e-4;
/// Relative residual accepted between load steps; the next step corrects it.
const BETWEEN_LOAD_STEPS: f64 = 1e-3;
/// Number of successive steps without decrease after which a load step is given up.
const PATIENCE: u32 = 3;
/// Armijo's constant: descent accepts a step if the energy falls by at least this fraction of the decrease predicted by
/// the slope.
const SUFFICIENT: f64 = 1e-4;
/// Largest number of halvings of a descent step.
const MAX_HALVINGS: u32 = 40;

/// State of load stepping.
#[derive(Clone, Debug)]
pub struct Newton {
    /// Load factor of the current load step.
    target: f64,
    /// Last load factor with a known equilibrium; `base` is that equilibrium.
    reached: f64,
    base: Option<State>,
    is_based: bool,
    load_step: f64,
    /// Largest load step that the supports allow.
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
        // Descent applies the whole load at once, but not large rotations of supports.
        let step = if self.descends { self.largest_load_step } else { self.load_step };
        self.target = (self.reached + step).min(1.0);
        self.load_steps += 1;
        self.steps = 0;
        self.shortest = f64::INFINITY;
        self.worse = 0;
        self.last_residual = f64::INFINITY;
    }

    /// Returns to the last equilibrium and tries a smaller load step, or descent if it would be too small.
    fn give_up_load_step(&mut self, state: &mut State) -> Verdict {
        self.restore(state);
        self.load_step = SHRINK * (self.target - self.reached);
        self.descends = self.load_step < SMALLEST_LOAD_STEP;
        self.begin_load_step();
        Verdict::Changed
    }

    /// Restores the last equilibrium; without load this is the body at rest, wherever the iteration started.
    fn restore(&mut self, state: &mut State) {
        let Some(base) = self.base.as_mut().filter(|_| self.is_based) else { return };
        if self.reached == 0.0 {
            base.reset();
        }
        state.copy_from(base);
    }

    /// Performs a step that lowers the energy: with A + G if it is positive definite, else with A + max(G, 0), halved
    /// until the energy falls.
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
        // Differences of energies below this are rounding errors.
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
        // Keep the allocated state, so that no memory is allocated per frame.
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
            if it.supports_rotate_in_steps() {
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
            // Before the first step only a state under the full load can have converged; without load the state is
            // trivially in equilibrium.
            let is_there = self.target == 1.0 && it.supports_are_at(1.0, Kinematics::Corotated);
            return if residual <= tolerance && is_there { Verdict::Converged } else { Verdict::Continue };
        }
        let enough = if self.target < 1.0 { tolerance.max(BETWEEN_LOAD_STEPS) } else { tolerance };
        let gets_on = residual < self.last_residual;
        self.last_residual = residual;
        // A step computed from a residual at rounding level would be rounding error too, and move soft bodies far.
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
        // Descent never raises the energy, so its last state is the best one.
        if !self.descends {
            self.restore(state);
            self.target = self.reached;
        }
    }

    fn recover(&mut self, it: &mut Iteration<'_>, error: IterationError) -> Verdict {
        if self.descends { Verdict::Stop(Reason::Iteration(error)) } else { self.give_up_load_step(it.state) }
    }
}
