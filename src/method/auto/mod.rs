//! Method `auto`: as much computation as the requested accuracy needs.
//!
//! - **No solve** if nothing has changed since the last result.
//! - **Linear theory** while its error, estimated by the next terms of the displacement's expansion in the load, is
//!   small ([`Expansion`]).
//! - **The old factor** while it converges fast: steps u ← u + M⁻¹ (f_ext − f_int) with the last exact tangent M = A +
//!   G, which is factorized again only if the steps shrink too slowly (modified Newton).
//! - **Load stepping** ([`Newton`]) if these steps diverge, or lead to an unstable state.
//!
//! The method stops when the estimated error is within the requested one, not at a given residual.

use nalgebra::Vector2;

use self::expansion::{Expansion, relative_size, solve_nodal};
use super::newton::{Newton, grows, size, softens};
use super::status::{LONGEST_STEP, StepLengths, farthest};
use super::{Iteration, IterationError, Method, MethodEntry, MotionMethod, PathEvents, Restart, Verdict};
use crate::assembly::{Forces, Kinematics};
use crate::element::Tangent;
use crate::rotation::Rotation;
use crate::scene::MethodKind;
use crate::solver::Factor;
use crate::state::{State, largest};
use crate::timings::timed;

mod expansion;
mod report;

pub use report::{AutoReport, Decision};

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Auto,
    id: "auto",
    about: "As few computations as the estimated error allows for the required accuracy: no solve if nothing changed, linear \
            theory or the old factorization while accurate enough, load steps as a last resort.",
    start: || Box::<Auto>::default(),
    motion: Some(MotionMethod::Adaptive),
};

/// Fraction of the requested error that the estimates may reach; the rest is a margin for what they omit.
const USABLE: f64 = 0.5;
/// Rotation, rad, beyond which linear theory is not tried; its error for a cantilever is then 10 %.
const LARGEST_LINEAR_ROTATION: f64 = 0.25;
/// Largest ratio of successive steps with which an old factor is used again; beyond it a new factor gains a few digits
/// at the cost of a few steps.
const SERVES: f64 = 0.3;
/// Relative residual below which the tangent of a state is reused. The tangent of the linear solution is not: its
/// spurious tension stiffens it, so that its steps are short although the solution is far away.
const TRUSTED: f64 = 0.01;
/// Largest step with an old factor, as a fraction of the displacement.
const LONG: f64 = 0.2;
/// Largest first step of a factor that is reused, as a fraction of the displacement: its state is then near the
/// solution.
const NEAR: f64 = 0.05;
/// Number of steps after which load stepping takes over; near a solution three or four steps suffice.
const MAX_STEPS: u32 = 15;
/// Smallest resultant of the loads, relative to their norm, that is more than rounding error.
const MIN_RESULTANT: f64 = 1e-9;

/// Factorized tangent and its observed convergence.
#[derive(Debug)]
struct OldTangent {
    factor: Factor,
    definite: bool,
    /// `true` if it is the tangent of a state close to equilibrium.
    trusted: bool,
    /// `true` if the next step may use it again.
    serves: bool,
}

/// State of the method `auto`.
#[derive(Debug, Default)]
pub struct Auto {
    expansion: Expansion,
    tangent: Option<OldTangent>,
    /// Largest rotation of the state for which linear theory was last rejected, rad.
    refused: Option<f64>,
    /// Last result: with equal forces nothing has changed.
    accepted: Option<Accepted>,
    /// `true` if the current state is that of linear theory.
    linear: bool,
    steps: u32,
    lengths: StepLengths,
    /// Norm of the displacement after the first step from rest, that of linear theory, m.
    linear_size: f64,
    newton: Option<Newton>,
    /// `true` if the search began at rest.
    from_rest: bool,
    report: AutoReport,
    /// Last step, as a nodal vector.
    step: Vec<Vector2<f64>>,
}

/// Data with which a result was accepted.
#[derive(Debug)]
struct Accepted {
    residual_force: Vec<Vector2<f64>>,
    max_error: f64,
    estimated_error: f64,
}

impl Auto {
    /// Tries linear theory. If the state is at rest or that of linear theory, the solution is also the first Newton
    /// step and is taken in any case; returns `true` if a step was made.
    fn try_linear(&mut self, it: &mut Iteration<'_>) -> Result<bool, IterationError> {
        if it.problem.mouse_spring().is_some() || it.problem.supports().move_the_body() {
            // The expansion supports dead loads and moments only.
            self.linear = false;
            return Ok(false);
        }
        let turned = largest_rotation(&it.state.rotations);
        let tries = self.linear || turned <= LARGEST_LINEAR_ROTATION.min(self.refused.unwrap_or(f64::INFINITY));
        if !tries {
            return Ok(false);
        }
        let error = self.expansion.solve(it, &mut self.report)?;
        let from_rest = self.linear || largest(&it.state.displacement) == 0.0;
        self.linear = error <= USABLE * it.tolerances.error && self.expansion.is_stable(it, &mut self.report);
        if self.linear {
            self.report.decision = Decision::Linear;
            self.report.estimated_error = error;
            self.refused = None;
        } else {
            self.report.estimated_error = f64::INFINITY;
            // At rest the rotation under the load is unknown, so linear theory is always tried there.
            self.refused = (turned > 0.0).then_some(turned);
        }
        if self.linear || from_rest {
            let linear = self.expansion.linear();
            it.state.displacement.overwrite().copy_from_slice(linear);
            it.workspace.tangent = None;
            self.lengths.stepped(linear.iter().map(|u| u.norm_squared()).sum::<f64>().sqrt());
            return Ok(true);
        }
        Ok(false)
    }

    /// Performs one corotated step, with the old factor if it may be reused.
    fn step(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        self.step.resize(it.state.displacement.len(), Vector2::zeros());
        let is_put = it.supports_are_at(1.0, Kinematics::Corotated);
        if is_put && self.tangent.as_ref().is_some_and(|t| t.serves) {
            self.solve_for_step(it)?;
            let step = relative_size(it.problem, &self.step, &it.state.displacement);
            if step <= LONG {
                self.advance(it, step, false);
                return Ok(());
            }
        }
        it.carry(1.0);
        it.assemble(Tangent::EXACT, 1.0);
        let mut factor = match self.tangent.take() {
            Some(tangent) => tangent.factor,
            None => Factor::new(it.system().symbolic()?)?,
        };
        let values = it.workspace.matrix.values();
        let definite = timed(&mut it.timings.factorize, || factor.factorize_symmetric(values));
        self.report.factorizations += 1;
        self.report.decision = Decision::NewFactor;
        self.tangent = Some(OldTangent { factor, definite, trusted: it.residual <= TRUSTED, serves: false });
        let is_first = self.from_rest && self.steps == 1;
        if is_first {
            it.workspace.trial.copy_from(it.state);
        }
        it.put_supports(1.0, Kinematics::Corotated);
        self.solve_for_step(it)?;
        let step = relative_size(it.problem, &self.step, &it.state.displacement);
        self.advance(it, step, true);
        if is_first {
            self.check_softening(it);
        }
        Ok(())
    }

    /// Computes the step M⁻¹ (f_ext − f_int) into `step` and the workspace.
    fn solve_for_step(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        let Some(tangent) = &mut self.tangent else { return Ok(()) };
        self.report.solves += 1;
        let residual = std::mem::take(&mut it.forces.residual);
        let solved = solve_nodal(it, &mut tangent.factor, &residual, &mut self.step);
        it.forces.residual = residual;
        solved
    }

    /// Applies the step in the workspace, whose size relative to the displacement is `step`.
    fn advance(&mut self, it: &mut Iteration<'_>, step: f64, fresh: bool) {
        it.advance(1.0);
        self.lengths.stepped(it.step_length());
        if let Some(tangent) = &mut self.tangent {
            let near = tangent.definite && tangent.trusted && (!fresh || step <= NEAR);
            tangent.serves = near && self.lengths.ratio().is_none_or(|r| r <= SERVES);
        }
        // The remaining error is at most the last step if steps at least halve; else it is the sum of their geometric
        // series.
        self.report.estimated_error = match self.lengths.ratio() {
            Some(ratio) if ratio >= 1.0 => f64::INFINITY,
            Some(ratio) => step * (ratio / (1.0 - ratio)).max(1.0),
            // A single step gives no estimate: an old factor may be far too stiff for the remaining displacement.
            None => f64::INFINITY,
        };
    }

    /// Follows the path from rest if the first step, whose start is in the workspace, shows that the body softens.
    fn check_softening(&mut self, it: &mut Iteration<'_>) {
        self.linear_size = size(&it.state.displacement);
        if softens(it) {
            self.start_load_steps(it.state);
        }
    }

    /// Returns `true` if the resultant of the residual force is within the requested error, relative to that of the
    /// loads. On a slender body a small error of the displacement does not imply this.
    fn is_balanced(it: &Iteration<'_>) -> bool {
        let pattern = it.system().pattern();
        let Forces { external, residual, .. } = &*it.forces;
        let total = |force: &[Vector2<f64>]| pattern.resultant(force).norm();
        let tolerance = USABLE * it.tolerances.error;
        let all = pattern.norm(external);
        // A load without a resultant, such as a moment, gives nothing to compare with.
        let resultant = total(external);
        resultant <= MIN_RESULTANT * all || total(residual) <= tolerance * resultant
    }

    /// Starts load stepping from rest.
    fn start_load_steps(&mut self, state: &mut State) -> Verdict {
        state.reset();
        self.newton = Some(Newton::on_path());
        self.tangent = None;
        self.report.decision = Decision::LoadSteps;
        Verdict::Changed
    }

    fn accept(&mut self, it: &Iteration<'_>) -> Verdict {
        // Reuse the allocated vector.
        let mut residual_force = self.accepted.take().map_or_else(Vec::new, |accepted| accepted.residual_force);
        residual_force.clone_from(&it.forces.residual);
        self.accepted = Some(Accepted {
            residual_force,
            max_error: it.tolerances.error,
            estimated_error: self.report.estimated_error,
        });
        Verdict::Converged
    }
}

/// Returns the largest angle of the rotations, rad.
fn largest_rotation(r: &[Rotation]) -> f64 {
    r.iter().map(|r| r.angle().abs()).fold(0.0, f64::max)
}

impl Method for Auto {
    fn copy(&self) -> Box<dyn Method> {
        let Self { refused, linear, steps, newton, report, .. } = self;
        Box::new(Self {
            refused: *refused,
            linear: *linear,
            steps: *steps,
            lengths: self.lengths.clone(),
            newton: newton.clone(),
            report: *report,
            ..Self::default()
        })
    }

    fn restart(&mut self, why: Restart) {
        let old = std::mem::take(self);
        *self = match why {
            Restart::NewUnknowns => Self { linear: old.linear, ..Self::default() },
            Restart::NewStiffness => {
                Self { linear: old.linear, expansion: old.expansion.without_factor(), ..Self::default() }
            }
            Restart::AtRest => Self { expansion: old.expansion, ..Self::default() },
            Restart::NewLoads => Self {
                expansion: old.expansion,
                tangent: old.tangent,
                refused: old.refused,
                accepted: old.accepted,
                linear: old.linear,
                step: old.step,
                ..Self::default()
            },
        };
        if let Some(tangent) = &mut self.tangent {
            tangent.serves = tangent.definite && tangent.trusted;
        }
    }

    fn kinematics(&self) -> Kinematics {
        if self.linear { Kinematics::Linear } else { Kinematics::Corotated }
    }

    fn tangent(&self) -> Option<Tangent> {
        self.newton.as_ref().and_then(Method::tangent)
    }

    fn load_factor(&self) -> f64 {
        self.newton.as_ref().map_or(1.0, Method::load_factor)
    }

    fn load_steps(&self) -> u32 {
        self.newton.as_ref().map_or(1, Method::load_steps)
    }

    fn solves(&self) -> u32 {
        self.newton.as_ref().map_or(1, Method::solves)
    }

    fn path_events(&self) -> Option<PathEvents> {
        match &self.newton {
            Some(newton) => newton.path_events(),
            None => (self.from_rest && !self.linear).then(PathEvents::default),
        }
    }

    fn step_ratio(&self) -> Option<f64> {
        self.lengths.ratio()
    }

    fn report(&self) -> Option<AutoReport> {
        Some(self.report)
    }

    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        self.steps += 1;
        if let Some(newton) = &mut self.newton {
            let iterated = newton.iterate(it);
            self.report.solves += newton.solves();
            self.report.factorizations += newton.solves();
            return iterated;
        }
        if self.steps == 1 {
            self.from_rest = it.is_at_rest();
            if self.from_rest {
                it.workspace.trial.copy_from(it.state);
            }
            if self.try_linear(it)? {
                if self.from_rest && !self.linear {
                    self.check_softening(it);
                }
                return Ok(());
            }
        }
        let leaves_rest = self.from_rest && self.steps == 1 && it.problem.supports().move_the_body();
        if leaves_rest || it.supports_rotate_in_steps() {
            self.start_load_steps(it.state);
            it.workspace.tangent = None;
            return self.iterate(it);
        }
        if self.report.decision == Decision::Undecided {
            self.report.decision = Decision::OldFactor;
        }
        self.step(it)
    }

    fn check_convergence(&mut self, it: &mut Iteration<'_>) -> Verdict {
        if let Some(newton) = &mut self.newton {
            let verdict = newton.check_convergence(it);
            if matches!(verdict, Verdict::Converged | Verdict::AtRounding(_)) {
                self.report.estimated_error = it.residual;
                self.accept(it);
            }
            return verdict;
        }
        if self.steps == 0 {
            if !it.supports_are_at(1.0, self.kinematics()) {
                return Verdict::Continue;
            }
            let same = self
                .accepted
                .as_ref()
                .filter(|last| last.residual_force == it.forces.residual && last.max_error <= it.tolerances.error);
            if let Some(last) = same {
                self.report.decision = Decision::Unchanged;
                self.report.estimated_error = last.estimated_error;
                return Verdict::Converged;
            }
            if !self.linear && it.residual == 0.0 {
                self.report.decision = Decision::Unchanged;
                return self.accept(it);
            }
            return Verdict::Continue;
        }
        if self.linear {
            return self.accept(it);
        }
        let trusted = self.tangent.as_ref().is_some_and(|t| t.trusted);
        let within = trusted && self.report.estimated_error <= USABLE * it.tolerances.error && Self::is_balanced(it);
        let done = within || it.residual <= it.tolerances.residual;
        match &self.tangent {
            Some(tangent) if done => {
                let grows = self.from_rest && grows(it.state, self.linear_size);
                if tangent.definite && !grows { self.accept(it) } else { self.start_load_steps(it.state) }
            }
            Some(tangent) if self.from_rest && !tangent.definite => self.start_load_steps(it.state),
            _ if self.steps >= MAX_STEPS || farthest(it.system(), it.state) > LONGEST_STEP => {
                self.start_load_steps(it.state)
            }
            _ => Verdict::Continue,
        }
    }

    fn stop(&mut self, state: &mut State) {
        if let Some(newton) = &mut self.newton {
            newton.stop(state);
        }
    }

    fn recover(&mut self, it: &mut Iteration<'_>, error: IterationError) -> Verdict {
        match &mut self.newton {
            Some(newton) => newton.recover(it, error),
            None => self.start_load_steps(it.state),
        }
    }
}
