//! Newton's method with the exact tangent A + G.
//!
//! From rest, if no support moves, the whole load is applied at once, with full steps. The first one is the linear
//! solution, which is far too long, and the second one corrects it: a line search on the energy would reject both and
//! slow the method down. The result counts as the end of the path from rest if nothing in the iteration softens, as columns and arches do:
//!
//! - the body does not soften to first order in the load ([`softens`]),
//! - every tangent is positive definite, as the factorization shows at no extra cost,
//! - the displacement is not larger than that of linear theory.
//!
//! Otherwise, and where supports move, [`PathFollower`] follows the path from rest.
//!
//! From another state, for example while a load is dragged, full steps lead to the equilibrium nearby; if they fail,
//! the path is followed from rest.
//!
//! The motion of supports is applied with the load: beside the path, the body is rotated as a whole with them, and the
//! rest of their motion enters the first step as a force.

use nalgebra::Vector2;

use super::iteration::ROUNDING;
use super::path::{PathEndReason, PathEvents, PathFollower, PathProgress, StaticEquations};
use super::status::{LONGEST_STEP, StepLengths, farthest};
use super::{Criteria, IterationError, Method, MethodEntry, MethodReport, Reason, Restart, Verdict};
use crate::assembly::Kinematics;
use crate::continuation::ContinuationPoint;
use crate::element::Tangent;
use crate::scene::MethodKind;
use crate::state::{State, largest};
use crate::step::{Iteration, Linearization, Operation, Workspace};
use crate::timings::timed;

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Newton,
    id: "newton",
    about: "Newton with the exact tangent A + G: an exact, stable equilibrium in a few solves, also under large loads.",
    start: || Box::<Newton>::default(),
    colors: [[0, 100, 180], [90, 200, 250]],
};

/// Full steps before the residual must be close to zero. Usually 5 to 9 are needed.
const MAX_STEPS: u32 = 15;
/// Relative residual below which convergence is quadratic.
const CLOSE: f64 = 1e-2;
/// Additional steps once the residual is below [`CLOSE`].
const LAST_STEPS: u32 = 6;
/// Number of successive steps without decrease after which full steps are given up.
const PATIENCE: u32 = 3;
/// Largest softening with which the whole load is applied at once. A larger value sends fewer bodies to the path, at
/// the risk of a missed limit load.
const MAX_SOFTENING: f64 = 0.05;
/// Largest displacement, relative to that of linear theory, with which the result counts as the end of the path.
pub(super) const MAX_GROWTH: f64 = 1.1;

/// Phase of the solve.
#[derive(Clone, Debug, Default)]
enum NewtonPhase {
    /// Full steps under the whole load.
    #[default]
    Direct,
    /// The path from rest; `None` until its follower is made.
    Path(Option<Box<PathFollower>>),
    /// Full steps from the end of the path.
    Finish(PathEvents),
    /// Full steps under growing parts of the load, where rounding errors hide the path, or the path is long.
    LoadSteps(Box<LoadSteps>),
}

/// Load steps from rest, each by full steps: they solve slender bodies in fewer solves, but are not known to end on the
/// path.
#[derive(Clone, Debug)]
struct LoadSteps {
    /// Last equilibrium, and its load factor.
    base: State,
    reached: f64,
    /// Length of the current load step.
    step: f64,
    /// The path, which has no limit point so far, and `true` if it goes on where the load steps fail.
    path: Box<PathFollower>,
    goes_on: bool,
}

/// Factor by which load steps grow after a success.
const GROW: f64 = 2.0;
/// Factor by which load steps shrink after a failure.
const SHRINK: f64 = 0.35;
/// Number of solves along a path after which load steps are tried.
const MAX_PATH_SOLVES: u32 = 600;
/// Smallest load step.
const MIN_LOAD_STEP: f64 = 1e-4;
/// Relative residual accepted between load steps; the next step corrects it.
const BETWEEN_LOAD_STEPS: f64 = 1e-3;

/// State of the method.
#[derive(Clone, Debug, Default)]
pub struct Newton {
    phase: NewtonPhase,
    /// Load factor of the current state; `None` for the whole load.
    load_factor: Option<f64>,
    load_steps: u32,
    /// `true` if load steps have failed.
    load_steps_failed: bool,
    from_rest: bool,
    steps: u32,
    /// Number of linear solves of the last iteration.
    solves: u32,
    shortest: f64,
    worse: u32,
    lengths: StepLengths,
    last_residual: f64,
    /// Norm of the displacement of linear theory, m.
    linear: f64,
    /// Reason why the path has ended before the whole load.
    end: Option<Reason>,
}

impl Newton {
    /// Returns the method that follows the path from rest from its first iteration on.
    pub(super) fn on_path() -> Self {
        Self { phase: NewtonPhase::Path(None), load_factor: Some(0.0), ..Self::default() }
    }

    /// Returns to rest and begins to follow the path.
    fn give_up(&mut self, state: &mut State) -> Verdict {
        state.reset();
        *self = Self::on_path();
        Verdict::Changed
    }

    /// Ends full steps without success: follows the path, tries a shorter load step, or stops.
    fn fail(&mut self, state: &mut State) -> Verdict {
        let steps = match &mut self.phase {
            NewtonPhase::Finish(_) => return Verdict::Stop(Reason::Stuck(self.steps)),
            NewtonPhase::Direct | NewtonPhase::Path(_) => return self.give_up(state),
            NewtonPhase::LoadSteps(steps) => steps,
        };
        state.copy_from(&steps.base);
        steps.step = SHRINK * (self.load_factor.unwrap_or(1.0) - steps.reached);
        if steps.step >= MIN_LOAD_STEP {
            self.begin_load_step();
            return Verdict::Changed;
        }
        let ContinuationPoint { state: end, factor, .. } = &steps.path.last;
        let reached = steps.reached.max(*factor);
        if *factor > steps.reached {
            state.copy_from(end);
        }
        self.load_factor = Some(reached);
        if !steps.goes_on {
            return Verdict::Stop(Reason::NoEquilibrium(reached));
        }
        self.load_steps_failed = true;
        self.phase = NewtonPhase::Path(Some(steps.path.clone()));
        Verdict::Changed
    }

    fn begin_load_step(&mut self) {
        if let NewtonPhase::LoadSteps(steps) = &self.phase {
            self.load_factor = Some((steps.reached + steps.step).min(1.0));
        }
        (self.load_steps, self.steps) = (self.load_steps + 1, 0);
    }

    /// Returns `true` if the tangent is known to be positive definite without a factorization: every tangent of the
    /// iteration was, and the last two steps contract so fast that it is not singular between them (Deuflhard, section
    /// 2.1).
    fn is_known_stable(&self) -> bool {
        /// Largest contraction.
        const FAST: f64 = 0.1;
        let is_fast = self.lengths.ratio.is_some_and(|ratio| ratio <= FAST);
        matches!(self.phase, NewtonPhase::Direct) && self.from_rest && is_fast
    }

    /// Prepares a full step under the current load.
    fn plan_full_step(&mut self, it: &mut Iteration<'_>) -> Operation {
        let is_first = self.from_rest && self.steps == 1;
        // Linear theory has no part of the moments in its tangent.
        let is_linear = is_first && it.problem.loads().moments().next().is_some();
        let tangent = if is_linear { Tangent::WARPED } else { Tangent::EXACT };
        it.carry(Linearization { tangent: Some(tangent), ..self.linearization() });
        if is_first {
            it.workspace.trial.copy_from(it.state);
        }
        it.put_supports(self.linearization());
        if self.from_rest { Operation::Factorize } else { Operation::FactorizeIndefinite }
    }

    /// Follows the path by a step.
    fn step_on_path(&mut self, it: &mut Iteration<'_>, solves_left: u32) {
        let NewtonPhase::Path(follower) = &mut self.phase else { return };
        let Iteration { problem, state, forces, workspace, timings } = it;
        let mut equations = StaticEquations::new(problem, forces, workspace, timings);
        let before = follower.as_ref().map_or(0, |follower| follower.linearizations());
        if follower.is_none() {
            *follower = PathFollower::start(&mut equations, 1.0).map(Box::new);
        }
        let Some(follower) = follower else {
            self.end = Some(Reason::NoEquilibrium(0.0));
            return;
        };
        let progress = follower.advance(&mut equations, before + solves_left);
        follower.parts.clear();
        self.solves = (follower.linearizations() - before).max(1);
        self.load_steps = follower.steps;
        let shown = match &progress {
            PathProgress::Continue => &follower.path.point,
            PathProgress::Reached | PathProgress::Ended(_) => &follower.last,
        };
        state.copy_from(&shown.state);
        self.load_factor = Some(shown.factor);
        let has_limit = follower.limit.is_some();
        // Nothing but the path leads to its end where supports move.
        let may_shorten = !has_limit && !problem.supports().move_the_body() && !self.load_steps_failed;
        match progress {
            PathProgress::Ended(PathEndReason::Solves(_)) => {}
            PathProgress::Continue if !may_shorten || follower.linearizations() <= MAX_PATH_SOLVES => {}
            PathProgress::Reached => {
                self.phase = NewtonPhase::Finish(follower.take_events());
                (self.load_factor, self.steps) = (None, 0);
            }
            // Beyond a limit point full steps lead nowhere.
            PathProgress::Ended(_) if has_limit => self.end = Some(Reason::NoEquilibrium(follower.last.factor)),
            // The path is too long, or rounding errors keep the follower from any step.
            PathProgress::Continue | PathProgress::Ended(_) => {
                state.reset();
                let (base, path) = (state.clone(), follower.clone());
                let goes_on = matches!(progress, PathProgress::Continue);
                let steps = LoadSteps { base, reached: 0.0, step: SHRINK, path, goes_on };
                self.phase = NewtonPhase::LoadSteps(Box::new(steps));
                self.begin_load_step();
            }
        }
    }
}

/// Returns `true` if the body softens, as an arch does: the displacement to second order in the load relative to the
/// linear displacement d, minus 1, is then positive. With the elastic energy ½ a s² + ⅙ c s³ along s d it is −c/2a. d is
/// the first step from rest, which began at `workspace.trial`.
pub(super) fn softens(it: &mut Iteration<'_>) -> bool {
    /// Length of the differences relative to the height of the strip: strains and rotations of this order.
    const STEP: f64 = 1e-3;
    /// Largest displacement, relative to the size of the body, that is only rounding error.
    const ROUNDING_ERROR: f64 = 1e-11;
    let Iteration { problem, state, workspace, timings, .. } = it;
    let Workspace { trial, trial_forces: forces, nodal, .. } = &mut **workspace;
    let softening = timed(&mut timings.linearize, || {
        for (d, (start, end)) in nodal.iter_mut().zip(trial.displacement.iter().zip(&state.displacement)) {
            *d = end - start;
        }
        let longest = largest(nodal);
        if longest <= ROUNDING_ERROR * problem.system().size() {
            return 0.0;
        }
        let step = (STEP * problem.system().strip()[1] / longest).min(1.0);
        // Dead forces are the same in both states, and cancel.
        let loads_vary = problem.loads().moments().next().is_some() || problem.mouse_spring().is_some();
        let mut work = |by: f64| {
            for (u, d) in trial.displacement.overwrite().iter_mut().zip(&*nodal) {
                *u += d * by;
            }
            problem.update_and_linearize(trial, Kinematics::Corotated, forces, None);
            let dot = |f: &[Vector2<f64>]| nodal.iter().zip(f).map(|(d, f)| d.dot(f)).sum::<f64>();
            let internal = dot(&forces.internal);
            if !loads_vary {
                return [internal, 0.0];
            }
            problem.balance(trial, Kinematics::Corotated, step, forces);
            [internal, dot(&forces.external)]
        };
        let ([ahead, pushes], [behind, pulls]) = (work(step), work(-2.0 * step));
        -(ahead + behind - (pushes - pulls)) / (step * (ahead - behind))
    });
    softening > MAX_SOFTENING
}

impl Method for Newton {
    fn copy(&self) -> Box<dyn Method> {
        Box::new(self.clone())
    }

    fn restart(&mut self, _: Restart) {
        *self = Self::default();
    }

    fn linearization(&self) -> Linearization {
        Linearization::corotated(Tangent::EXACT, self.load_factor.unwrap_or(1.0))
    }

    fn report(&self) -> MethodReport {
        MethodReport { load_steps: self.load_steps.max(1), solves: self.solves.max(1), ..MethodReport::DEFAULT }
    }

    fn path_events(&self) -> Option<PathEvents> {
        match &self.phase {
            NewtonPhase::Direct if self.from_rest => Some(PathEvents::default()),
            NewtonPhase::Finish(events) => Some(events.clone()),
            NewtonPhase::Direct | NewtonPhase::Path(_) | NewtonPhase::LoadSteps(_) => None,
        }
    }

    fn plan(&mut self, it: &mut Iteration<'_>, criteria: &Criteria) -> Result<Operation, IterationError> {
        self.solves = 1;
        if !matches!(self.phase, NewtonPhase::Path(_)) {
            self.steps += 1;
            if self.steps == 1 && matches!(self.phase, NewtonPhase::Direct) {
                self.from_rest = it.is_at_rest();
                if self.from_rest && it.problem.supports().move_the_body() {
                    *self = Self::on_path();
                }
            }
        }
        if let NewtonPhase::Path(_) = self.phase {
            self.step_on_path(it, criteria.solves_left);
            return Ok(Operation::Linearize);
        }
        Ok(self.plan_full_step(it))
    }

    fn check_convergence(&mut self, it: &mut Iteration<'_>, criteria: &Criteria, step: Option<f64>) -> Verdict {
        if let Some(step) = step {
            self.lengths.stepped(step);
            if self.from_rest && self.steps == 1 {
                self.linear = size(&it.state.displacement);
                if softens(it) {
                    return self.give_up(it.state);
                }
            }
        }
        let (residual, is_partial) = (it.forces.relative_residual, self.load_factor.is_some_and(|factor| factor < 1.0));
        let tolerance = criteria.residual.max(if is_partial { BETWEEN_LOAD_STEPS } else { 0.0 });
        if let NewtonPhase::Path(_) = self.phase {
            return self.end.take().map_or(Verdict::Continue, Verdict::Stop);
        }
        let is_direct = matches!(self.phase, NewtonPhase::Direct);
        // A body at rest without load is in equilibrium, but its supports may have to move.
        if self.steps == 0 && is_direct && residual <= tolerance && it.supports_are_at(1.0, Kinematics::Corotated) {
            return Verdict::Converged(None);
        }
        // A step takes the rounding errors of the supports' motion along the path out of the strains.
        let is_end = matches!(self.phase, NewtonPhase::Finish(_)) && !it.problem.supports().move_the_body();
        if self.steps == 0 && !is_end {
            return Verdict::Continue;
        }
        let gets_on = residual < self.last_residual;
        self.last_residual = residual;
        // A step computed from a residual at rounding level would be rounding error too, and move soft bodies far.
        let floor = if residual <= tolerance || is_partial { None } else { it.floor() };
        if residual <= tolerance || floor.is_some() {
            let grows = self.from_rest && size(&it.state.displacement) > MAX_GROWTH * self.linear;
            let is_unstable = matches!(&self.phase, NewtonPhase::Finish(events) if !events.bifurcations.is_empty());
            let is_known = is_unstable || self.is_known_stable();
            if !grows && (is_known || it.factorize().is_ok()) {
                let NewtonPhase::LoadSteps(steps) = &mut self.phase else { return Verdict::Converged(floor) };
                if !is_partial {
                    return Verdict::Converged(floor);
                }
                steps.base.copy_from(it.state);
                (steps.reached, steps.step) = (steps.reached + steps.step, GROW * steps.step);
                self.begin_load_step();
                return Verdict::Changed;
            }
            return self.fail(it.state);
        }
        if self.steps == 0 {
            return Verdict::Continue;
        }
        if self.steps == 1 || self.lengths.last < self.shortest {
            self.shortest = self.lengths.last;
            self.worse = 0;
        } else {
            self.worse += 1;
        }
        let near = residual < ROUNDING && !is_partial;
        if self.worse >= PATIENCE && near && !gets_on {
            return Verdict::Stop(Reason::Stuck(self.worse));
        }
        let nodes = (it.workspace.linear.correction.len() as f64 * 0.5).sqrt();
        let too_long = self.lengths.last / nodes > LONGEST_STEP * it.problem.system().size();
        let hopeless = self.steps > 1
            && (too_long || self.worse >= PATIENCE && !near || farthest(it.problem.system(), it.state) > LONGEST_STEP);
        let late = self.steps >= MAX_STEPS + if residual < CLOSE { LAST_STEPS } else { 0 };
        if late || hopeless { self.fail(it.state) } else { Verdict::Continue }
    }

    fn stop(&mut self, state: &mut State) {
        match &self.phase {
            NewtonPhase::Path(Some(follower)) => {
                state.copy_from(&follower.last.state);
                self.load_factor = Some(follower.last.factor);
            }
            // Without load the body at rest is the only known equilibrium.
            NewtonPhase::Direct | NewtonPhase::Path(None) => {
                state.reset();
                self.load_factor = Some(0.0);
            }
            NewtonPhase::LoadSteps(steps) => {
                state.copy_from(&steps.base);
                self.load_factor = Some(steps.reached);
            }
            NewtonPhase::Finish(_) => {}
        }
    }

    fn recover(&mut self, it: &mut Iteration<'_>, error: IterationError) -> Verdict {
        match self.phase {
            NewtonPhase::Direct | NewtonPhase::LoadSteps(_) => self.fail(it.state),
            NewtonPhase::Path(_) | NewtonPhase::Finish(_) => Verdict::Stop(Reason::Iteration(error)),
        }
    }
}

/// Returns the Euclidean norm of a displacement, m.
pub(super) fn size(u: &[Vector2<f64>]) -> f64 {
    u.iter().map(|u| u.norm_squared()).sum::<f64>().sqrt()
}
