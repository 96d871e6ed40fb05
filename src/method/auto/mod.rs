//! As much as the asked accuracy needs, and no more.
//!
//! - **No solve** where nothing has changed since the last result.
//! - **Linear theory** while its error, estimated by the next terms of the displacement's expansion in the load, is small
//!   ([`Expansion`]).
//! - **The old factor** while it serves: steps u ← u + M⁻¹ (f_ext − f_int) with the last exact tangent M = A + G,
//!   factorized anew only where they shrink too slowly (modified Newton).
//! - **Load stepping** ([`Newton`]) where these steps lead nowhere, or to an unstable state.
//!
//! It ends where the estimated error is within the goal, not at a residual.

use nalgebra::Vector2;

use self::expansion::{Expansion, relative_size, solve_nodal};
use super::newton::Newton;
use super::status::{LONGEST_STEP, StepLengths, farthest};
use super::{Iteration, IterationError, Method, MethodEntry, MotionMethod, Restart, Verdict};
use crate::assembly::Kinematics;
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
    about: "As little of the others as the asked accuracy needs: no solve where nothing changed, linear theory while it \
            serves, the old factor while it serves, load steps where nothing else does.",
    start: || Box::<Auto>::default(),
    motion: Some(MotionMethod::Adaptive),
};

/// The fraction of the asked error that the estimates may use up: the rest is for what estimates leave out.
const USABLE: f64 = 0.5;
/// A largest rotation, rad, beyond which linear theory need not be asked: a cantilever's is off by 10 % by then.
const LARGEST_LINEAR_ROTATION: f64 = 0.25;
/// A factor that shrinks steps by less than this is given up: a fresh one wins a few digits for the price of a few such.
const SERVES: f64 = 0.3;
/// Relative residual of a state whose tangent can be trusted. The tangent of the linear solution is not: a tension that
/// is not there stiffens it, so that its steps are short though the solution is far away.
const TRUSTED: f64 = 0.01;
/// A step longer than this fraction of the displacement is not left to an old factor.
const LONG: f64 = 0.2;
/// A factor is used again only if its own step was no longer than this fraction of the displacement: the state it was
/// made at is near the solution then.
const NEAR: f64 = 0.05;
/// Steps after which load stepping takes over: in the basin of a solution three or four do.
const MAX_STEPS: u32 = 15;

/// A factorized tangent and what its steps have shown of it.
#[derive(Debug)]
struct OldTangent {
    factor: Factor,
    definite: bool,
    /// Whether it is the tangent of a state near enough to equilibrium.
    trusted: bool,
    /// Whether the next step may use it again.
    serves: bool,
}

/// The state of the decisions.
#[derive(Debug, Default)]
pub struct Auto {
    expansion: Expansion,
    tangent: Option<OldTangent>,
    /// Largest rotation of the state in which linear theory last refused.
    refused: Option<f64>,
    /// The last result: under the same forces nothing has changed.
    accepted: Option<Accepted>,
    /// Whether the present state is linear theory's.
    linear: bool,
    steps: u32,
    lengths: StepLengths,
    newton: Option<Newton>,
    report: AutoReport,
    /// The last step, over nodes.
    step: Vec<Vector2<f64>>,
}

/// What a result was accepted on.
#[derive(Debug)]
struct Accepted {
    residual_force: Vec<Vector2<f64>>,
    max_error: f64,
    estimated_error: f64,
}

impl Auto {
    /// Tries linear theory. Where the state is at rest, or linear theory's, its solution is also the first of Newton's
    /// steps, and taken; returns whether a step was made.
    fn try_linear(&mut self, it: &mut Iteration<'_>) -> Result<bool, IterationError> {
        if it.problem.hand().is_some() || it.problem.supports().move_the_body() {
            // The expansion knows dead loads and moments only.
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
            // At rest nothing is known of how far the load turns the body: there it is always tried.
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

    /// One corotated step, with the old factor if that serves.
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
            None => Factor::new(it.system().symbolic())?,
        };
        let values = it.workspace.matrix.values();
        let definite = timed(&mut it.timings.factorize, || factor.factorize_symmetric(values));
        self.report.factorizations += 1;
        self.report.decision = Decision::NewFactor;
        self.tangent = Some(OldTangent { factor, definite, trusted: it.residual <= TRUSTED, serves: false });
        it.put_supports(1.0, Kinematics::Corotated);
        self.solve_for_step(it)?;
        let step = relative_size(it.problem, &self.step, &it.state.displacement);
        self.advance(it, step, true);
        Ok(())
    }

    /// The step M⁻¹ (f_ext − f_int), into `step` and the workspace.
    fn solve_for_step(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        let Some(tangent) = &mut self.tangent else { return Ok(()) };
        self.report.solves += 1;
        let residual = std::mem::take(&mut it.forces.residual);
        let solved = solve_nodal(it, &mut tangent.factor, &residual, &mut self.step);
        it.forces.residual = residual;
        solved
    }

    /// Takes the step in the workspace, which has this size relative to the displacement.
    fn advance(&mut self, it: &mut Iteration<'_>, step: f64, fresh: bool) {
        it.advance(1.0);
        self.lengths.stepped(it.step_length());
        if let Some(tangent) = &mut self.tangent {
            let near = tangent.definite && tangent.trusted && (!fresh || step <= NEAR);
            tangent.serves = near && self.lengths.ratio().is_none_or(|r| r <= SERVES);
        }
        // What is left is no more than the step just made, where steps at least halve; else their geometric series.
        self.report.estimated_error = match self.lengths.ratio() {
            Some(ratio) if ratio >= 1.0 => f64::INFINITY,
            Some(ratio) => step * (ratio / (1.0 - ratio)).max(1.0),
            // One step says nothing of what it leaves: an old factor may be far too stiff for the way left.
            None => f64::INFINITY,
        };
    }

    /// Load stepping from rest.
    fn hand_over(&mut self, state: &mut State) -> Verdict {
        state.reset();
        self.newton = Some(Newton::default());
        self.tangent = None;
        self.report.decision = Decision::LoadSteps;
        Verdict::Changed
    }

    fn accept(&mut self, it: &Iteration<'_>) -> Verdict {
        // Room that is there is used again.
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

/// The largest angle of some rotations, rad.
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

    fn step_ratio(&self) -> Option<f64> {
        self.lengths.ratio()
    }

    fn report(&self) -> Option<AutoReport> {
        Some(self.report)
    }

    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        self.steps += 1;
        if let Some(newton) = &mut self.newton {
            self.report.solves += 1;
            self.report.factorizations += 1;
            return newton.iterate(it);
        }
        if self.steps == 1 && self.try_linear(it)? {
            return Ok(());
        }
        if it.supports_must_turn_in_steps() {
            self.hand_over(it.state);
            it.workspace.tangent = None;
            return self.iterate(it);
        }
        if self.report.decision == Decision::Undecided {
            self.report.decision = Decision::OldFactor;
        }
        self.step(it)
    }

    fn judge(&mut self, it: &mut Iteration<'_>) -> Verdict {
        if let Some(newton) = &mut self.newton {
            let verdict = newton.judge(it);
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
        let within = trusted && self.report.estimated_error <= USABLE * it.tolerances.error;
        let done = within || it.residual <= it.tolerances.residual;
        match &self.tangent {
            Some(tangent) if done && tangent.definite => self.accept(it),
            Some(_) if done => self.hand_over(it.state),
            _ if self.steps >= MAX_STEPS || farthest(it.system(), it.state) > LONGEST_STEP => self.hand_over(it.state),
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
            None => self.hand_over(it.state),
        }
    }
}
