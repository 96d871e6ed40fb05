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

use self::expansion::{Expansion, relative_size};
use super::newton::{MAX_GROWTH, Newton, size, softens};
use super::status::{LONGEST_STEP, StepLengths, farthest};
use super::{Criteria, IterationError, Method, MethodEntry, MethodReport, PathEvents, Restart, Verdict};
use crate::assembly::{Forces, Kinematics};
use crate::element::Tangent;
use crate::scene::MethodKind;
use crate::state::{State, largest};
use crate::step::{Iteration, Linearization, Operation};

mod expansion;
mod report;

pub use report::{AutoReport, Decision};

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Auto,
    id: "auto",
    about: "As few computations as the estimated error allows for the required accuracy: no solve if nothing changed, linear \
            theory or the old factorization while accurate enough, load steps as a last resort.",
    start: || Box::<Auto>::default(),
    colors: [[0, 120, 80], [110, 220, 140]],
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

/// Observed convergence of the factorized tangent in the workspace.
#[derive(Debug)]
struct OldTangent {
    definite: bool,
    /// `true` if it is the tangent of a state close to equilibrium.
    trusted: bool,
    /// `true` if the next step may use it again.
    serves: bool,
}

/// State of the method `auto`.
#[derive(Debug, Default)]
pub struct Auto {
    expansion: Option<Expansion>,
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
    fn try_linear(&mut self, it: &mut Iteration<'_>, criteria: &Criteria) -> Result<bool, IterationError> {
        if it.problem.mouse_spring().is_some() || it.problem.supports().move_the_body() {
            // The expansion supports dead loads and moments only.
            self.linear = false;
            return Ok(false);
        }
        let turned = it.state.rotations.iter().map(|r| r.angle().abs()).fold(0.0, f64::max);
        let tries = self.linear || turned <= LARGEST_LINEAR_ROTATION.min(self.refused.unwrap_or(f64::INFINITY));
        if !tries {
            return Ok(false);
        }
        let expansion = self.expansion.get_or_insert_with(|| Expansion::new(it.problem));
        let error = expansion.solve(it, &mut self.report)?;
        let from_rest = self.linear || largest(&it.state.displacement) == 0.0;
        self.linear = error <= USABLE * criteria.error && expansion.is_stable(it, &mut self.report);
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
            let linear = expansion.linear();
            it.state.displacement.overwrite().copy_from_slice(linear);
            it.workspace.tangent = None;
            self.lengths.stepped(linear.iter().map(|u| u.norm_squared()).sum::<f64>().sqrt());
            return Ok(true);
        }
        Ok(false)
    }

    /// Solves for a corotated step, with the old factor if it may be reused.
    fn plan_corotated_step(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        let is_put = it.supports_are_at(1.0, Kinematics::Corotated);
        if is_put && self.tangent.as_ref().is_some_and(|t| t.serves) {
            let step = self.solve(it)?;
            if step <= LONG {
                self.take(step, false, it);
                return Ok(());
            }
        }
        let wanted = Linearization { tangent: Some(Tangent::EXACT), ..self.linearization() };
        let trusted = it.forces.relative_residual <= TRUSTED;
        it.carry(wanted);
        self.tangent = None;
        let definite = it.factorize_symmetric();
        self.report.factorizations += 1;
        self.report.decision = Decision::NewFactor;
        self.tangent = Some(OldTangent { definite, trusted, serves: false });
        if self.from_rest && self.steps == 1 {
            it.workspace.trial.copy_from(it.state);
        }
        it.put_supports(wanted);
        let step = self.solve(it)?;
        self.take(step, true, it);
        Ok(())
    }

    /// Solves for a step; returns its size relative to the displacement.
    fn solve(&mut self, it: &mut Iteration<'_>) -> Result<f64, IterationError> {
        self.report.solves += 1;
        it.solve()?;
        let Self { step, .. } = self;
        step.clear();
        step.resize(it.state.displacement.len(), Vector2::zeros());
        it.problem.system().pattern().add_free(&it.workspace.linear.correction, 1.0, step);
        Ok(relative_size(it.problem, step, &it.state.displacement))
    }

    /// Takes the step in the workspace, whose size relative to the displacement is `step`.
    fn take(&mut self, step: f64, fresh: bool, it: &Iteration<'_>) {
        self.lengths.stepped(it.step_length());
        if let Some(tangent) = &mut self.tangent {
            let near = tangent.definite && tangent.trusted && (!fresh || step <= NEAR);
            tangent.serves = near && self.lengths.ratio.is_none_or(|r| r <= SERVES);
        }
        // The remaining error is at most the last step if steps at least halve; else it is the sum of their geometric
        // series.
        // A single step gives no estimate: an old factor may be far too stiff for the remaining displacement.
        self.report.estimated_error = match self.lengths.ratio {
            Some(ratio) if ratio < 1.0 => step * (ratio / (1.0 - ratio)).max(1.0),
            _ => f64::INFINITY,
        };
    }

    /// Returns `true` if the resultant of the residual force is within the requested error, relative to that of the
    /// loads. On a slender body a small error of the displacement does not imply this.
    fn is_balanced(it: &Iteration<'_>, tolerance: f64) -> bool {
        let pattern = it.problem.system().pattern();
        let Forces { external, residual, .. } = &*it.forces;
        let total = |force: &[Vector2<f64>]| pattern.resultant(force).norm();
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

    fn accept(&mut self, it: &Iteration<'_>, criteria: &Criteria) -> Verdict {
        // Reuse the allocated vector.
        let mut residual_force = self.accepted.take().map_or_else(Vec::new, |accepted| accepted.residual_force);
        residual_force.clone_from(&it.forces.residual);
        self.accepted =
            Some(Accepted { residual_force, max_error: criteria.error, estimated_error: self.report.estimated_error });
        Verdict::Converged(None)
    }
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
                Self { linear: old.linear, expansion: old.expansion.map(Expansion::without_factor), ..Self::default() }
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

    fn linearization(&self) -> Linearization {
        let kinematics = if self.linear { Kinematics::Linear } else { Kinematics::Corotated };
        let own = Linearization { kinematics, tangent: None, load_factor: 1.0 };
        self.newton.as_ref().map_or(own, Method::linearization)
    }

    fn report(&self) -> MethodReport {
        let report = self.newton.as_ref().map_or(MethodReport::DEFAULT, Method::report);
        MethodReport { auto_report: Some(self.report), ..report }
    }

    fn path_events(&self) -> Option<PathEvents> {
        match &self.newton {
            Some(newton) => newton.path_events(),
            None => (self.from_rest && !self.linear).then(PathEvents::default),
        }
    }

    fn plan(&mut self, it: &mut Iteration<'_>, criteria: &Criteria) -> Result<Operation, IterationError> {
        self.steps += 1;
        if self.newton.is_none() && self.steps == 1 {
            self.from_rest = it.is_at_rest();
            if self.from_rest {
                it.workspace.trial.copy_from(it.state);
            }
            if self.try_linear(it, criteria)? {
                return Ok(Operation::Linearize);
            }
        }
        let leaves_rest = self.from_rest && self.steps == 1 && it.problem.supports().move_the_body();
        if self.newton.is_none() && (leaves_rest || it.supports_rotate_in_steps()) {
            self.start_load_steps(it.state);
            it.workspace.tangent = None;
        }
        if let Some(newton) = &mut self.newton {
            let first = newton.plan(it, criteria);
            let solves = newton.report().solves;
            self.report.solves += solves;
            self.report.factorizations += solves;
            return first;
        }
        if self.report.decision == Decision::Undecided {
            self.report.decision = Decision::OldFactor;
        }
        self.plan_corotated_step(it)?;
        Ok(Operation::Advance)
    }

    fn check_convergence(&mut self, it: &mut Iteration<'_>, criteria: &Criteria, step: Option<f64>) -> Verdict {
        if let Some(newton) = &mut self.newton {
            let verdict = newton.check_convergence(it, criteria, step);
            if matches!(verdict, Verdict::Converged(_)) {
                self.report.estimated_error = it.forces.relative_residual;
                self.accept(it, criteria);
            }
            return verdict;
        }
        if self.from_rest && self.steps == 1 && !self.linear {
            // The first step from rest, whose start is in the workspace, shows whether the body softens.
            self.linear_size = size(&it.state.displacement);
            if softens(it) {
                return self.start_load_steps(it.state);
            }
        }
        if self.steps == 0 {
            if !it.supports_are_at(1.0, self.linearization().kinematics) {
                return Verdict::Continue;
            }
            let same = self
                .accepted
                .as_ref()
                .filter(|last| last.residual_force == it.forces.residual && last.max_error <= criteria.error);
            if let Some(last) = same {
                self.report.decision = Decision::Unchanged;
                self.report.estimated_error = last.estimated_error;
                return Verdict::Converged(None);
            }
            if !self.linear && it.forces.relative_residual == 0.0 {
                self.report.decision = Decision::Unchanged;
                return self.accept(it, criteria);
            }
            return Verdict::Continue;
        }
        if self.linear {
            return self.accept(it, criteria);
        }
        let trusted = self.tangent.as_ref().is_some_and(|t| t.trusted);
        let tolerance = USABLE * criteria.error;
        let within = trusted && self.report.estimated_error <= tolerance && Self::is_balanced(it, tolerance);
        let done = within || it.forces.relative_residual <= criteria.residual;
        match &self.tangent {
            Some(tangent) if done => {
                let grows = self.from_rest && size(&it.state.displacement) > MAX_GROWTH * self.linear_size;
                if tangent.definite && !grows { self.accept(it, criteria) } else { self.start_load_steps(it.state) }
            }
            Some(tangent) if self.from_rest && !tangent.definite => self.start_load_steps(it.state),
            _ if self.steps >= MAX_STEPS || farthest(it.problem.system(), it.state) > LONGEST_STEP => {
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
