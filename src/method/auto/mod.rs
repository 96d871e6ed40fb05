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

use self::expansion::{Expansion, share, solve_nodal};
use super::certificate::tangent;
use super::frame::timed;
use super::newton::Newton;
use super::status::{Steps, farthest, largest};
use super::{Frame, FrameError, Method, Occasion, Verdict};
use crate::assembly::System;
use crate::rotation::Rotation;
use crate::solver::Factor;

mod expansion;
mod thrift;

pub use thrift::{Decision, Thrift};

pub(super) const ABOUT: &str = "As little of the others as the asked accuracy needs: no solve where nothing changed, \
linear theory while it serves, the old factor while it serves, load steps where nothing else does.";

/// The share of the asked error that the estimates may use up: the rest is for what estimates leave out, and the mesh.
const SHARE: f64 = 0.5;
/// A largest rotation, rad, beyond which linear theory need not be asked: a cantilever's is off by 10 % by then.
const LARGEST_LINEAR_ROTATION: f64 = 0.25;
/// A factor that shrinks steps by less than this is given up: a fresh one wins a few digits for the price of a few such.
const SERVES: f64 = 0.3;
/// Relative residual of a state whose tangent can be trusted. The tangent of the linear solution, say, is stiffened by a
/// tension that is not there: its steps are short however far the way.
const TRUSTED: f64 = 0.01;
/// A step longer than this share of the displacement is not left to an old factor.
const LONG: f64 = 0.2;
/// A factor is used again only if its own step was no longer than this share: it is a tangent near the solution then.
const NEAR: f64 = 0.05;
/// Steps after which load stepping takes over: in the basin of a solution three or four do.
const MAX_STEPS: u32 = 15;
/// A displacement this many sizes of the body long is not worth going on from.
const FARTHEST: f64 = 20.0;

/// A factorized tangent and what its steps have shown of it.
#[derive(Debug)]
struct Tangent {
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
    tangent: Option<Tangent>,
    /// Largest rotation of the state in which linear theory last refused.
    refused: Option<f64>,
    /// The last result: under the same forces nothing has changed.
    accepted: Option<Accepted>,
    /// Whether the present state is linear theory's.
    linear: bool,
    steps: u32,
    lengths: Steps,
    newton: Option<Newton>,
    thrift: Thrift,
    /// The last step, over nodes.
    step: Vec<Vector2<f64>>,
}

/// What a result was accepted on.
#[derive(Debug)]
struct Accepted {
    imbalance: Vec<Vector2<f64>>,
    max_error: f64,
    estimated_error: f64,
}

impl Auto {
    /// Tries linear theory. Where the state is at rest, or linear theory's, its solution is also the first of Newton's
    /// steps, and taken; returns whether a step was made.
    fn try_linear(&mut self, frame: &mut Frame<'_>) -> Result<bool, FrameError> {
        let turned = largest_rotation(frame.r);
        let tries = self.linear || turned <= LARGEST_LINEAR_ROTATION.min(self.refused.unwrap_or(f64::INFINITY));
        if !tries {
            return Ok(false);
        }
        let error = self.expansion.solve(frame, &mut self.thrift)?;
        let from_rest = self.linear || largest(frame.u) == 0.0;
        self.linear = error <= SHARE * frame.goal.max_error && self.expansion.is_stable(frame, &mut self.thrift);
        if self.linear {
            self.thrift.decision = Decision::Linear;
            self.thrift.estimated_error = error;
            self.refused = None;
        } else {
            self.thrift.estimated_error = f64::INFINITY;
            // At rest nothing is known of how far the load turns the body: there it is always tried.
            self.refused = (turned > 0.0).then_some(turned);
        }
        if self.linear || from_rest {
            let linear = self.expansion.linear();
            frame.u.copy_from_slice(linear);
            self.lengths.stepped(linear.iter().map(|u| u.norm_squared()).sum::<f64>().sqrt());
            return Ok(true);
        }
        Ok(false)
    }

    /// One corotated step, with the old factor if that serves.
    fn step(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        self.step.resize(frame.u.len(), Vector2::zeros());
        if self.tangent.as_ref().is_some_and(|t| t.serves) {
            self.solve_for_step(frame)?;
            let step = share(frame.system, &self.step, frame.u);
            if step <= LONG {
                self.advance(frame, step, false);
                return Ok(());
            }
        }
        let (system, values) = (frame.system, &mut frame.workspace.values);
        timed(&mut frame.profile.assemble, || tangent(system, frame.u, frame.r, 1.0, values));
        let mut factor = match self.tangent.take() {
            Some(tangent) => tangent.factor,
            None => Factor::new(&system.pattern)?,
        };
        let definite = timed(&mut frame.profile.factorize, || factor.factorize_symmetric(values));
        self.thrift.factorizations += 1;
        self.thrift.decision = Decision::NewFactor;
        self.tangent = Some(Tangent { factor, definite, trusted: frame.residual <= TRUSTED, serves: false });
        self.solve_for_step(frame)?;
        let step = share(frame.system, &self.step, frame.u);
        self.advance(frame, step, true);
        Ok(())
    }

    /// The step M⁻¹ (f_ext − f_int), into `step` and the workspace.
    fn solve_for_step(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        let Some(tangent) = &mut self.tangent else { return Ok(()) };
        let imbalance = frame.imbalance;
        self.thrift.solves += 1;
        solve_nodal(frame, &mut tangent.factor, imbalance, &mut self.step)
    }

    /// Takes the step in the workspace, which is this share of the displacement.
    fn advance(&mut self, frame: &mut Frame<'_>, step: f64, fresh: bool) {
        frame.advance(1.0);
        self.lengths.stepped(frame.step_length());
        if let Some(tangent) = &mut self.tangent {
            let near = tangent.definite && tangent.trusted && (!fresh || step <= NEAR);
            tangent.serves = near && self.lengths.ratio().is_none_or(|r| r <= SERVES);
        }
        // What is left is no more than the step just made, where steps at least halve; else their geometric series.
        self.thrift.estimated_error = match self.lengths.ratio() {
            Some(ratio) if ratio >= 1.0 => f64::INFINITY,
            Some(ratio) => step * (ratio / (1.0 - ratio)).max(1.0),
            // One step says nothing of what it leaves: an old factor may be far too stiff for the way left.
            None => f64::INFINITY,
        };
    }

    /// Load stepping from rest.
    fn hand_over(&mut self, frame: &mut Frame<'_>) -> Verdict {
        frame.u.fill(Vector2::zeros());
        self.newton = Some(Newton::default());
        self.tangent = None;
        self.thrift.decision = Decision::LoadSteps;
        Verdict::Changed
    }

    fn accept(&mut self, frame: &Frame<'_>) -> Verdict {
        self.accepted = Some(Accepted {
            imbalance: frame.imbalance.to_vec(),
            max_error: frame.goal.max_error,
            estimated_error: self.thrift.estimated_error,
        });
        Verdict::Converged
    }
}

/// The largest angle of some rotations, rad.
fn largest_rotation(r: &[Rotation]) -> f64 {
    r.iter().map(|r| r.angle().abs()).fold(0.0, f64::max)
}

impl Method for Auto {
    fn begin(&mut self, occasion: Occasion) {
        let old = std::mem::take(self);
        *self = match occasion {
            Occasion::NewStiffness => Self { linear: old.linear, ..Self::default() },
            Occasion::Reset => Self { expansion: old.expansion, ..Self::default() },
            Occasion::NewLoads => Self {
                expansion: old.expansion,
                tangent: old.tangent,
                refused: old.refused,
                accepted: old.accepted,
                linear: old.linear,
                ..Self::default()
            },
        };
        if let Some(tangent) = &mut self.tangent {
            tangent.serves = tangent.definite && tangent.trusted;
        }
    }

    fn rotate(&self, system: &System, u: &[Vector2<f64>], r: &mut [Rotation]) {
        if self.linear {
            r.fill(Rotation::IDENTITY);
        } else {
            system.elements.rotations(u, r);
        }
    }

    fn corotates(&self) -> bool {
        !self.linear
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

    fn thrift(&self) -> Option<Thrift> {
        Some(self.thrift)
    }

    fn solve(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        self.steps += 1;
        if let Some(newton) = &mut self.newton {
            self.thrift.solves += 1;
            self.thrift.factorizations += 1;
            return newton.solve(frame);
        }
        if self.steps == 1 && self.try_linear(frame)? {
            return Ok(());
        }
        if self.thrift.decision == Decision::Undecided {
            self.thrift.decision = Decision::OldFactor;
        }
        self.step(frame)
    }

    fn judge(&mut self, frame: &mut Frame<'_>) -> Verdict {
        if let Some(newton) = &mut self.newton {
            let verdict = newton.judge(frame);
            return if verdict == Verdict::Converged {
                self.thrift.estimated_error = frame.residual;
                self.accept(frame)
            } else {
                verdict
            };
        }
        if self.steps == 0 {
            let same = self
                .accepted
                .as_ref()
                .filter(|last| last.imbalance == frame.imbalance && last.max_error <= frame.goal.max_error);
            if let Some(last) = same {
                self.thrift.decision = Decision::Unchanged;
                self.thrift.estimated_error = last.estimated_error;
                return Verdict::Converged;
            }
            if !self.linear && frame.residual == 0.0 {
                self.thrift.decision = Decision::Unchanged;
                return self.accept(frame);
            }
            return Verdict::Continue;
        }
        if self.linear {
            return self.accept(frame);
        }
        let trusted = self.tangent.as_ref().is_some_and(|t| t.trusted);
        let within = trusted && self.thrift.estimated_error <= SHARE * frame.goal.max_error;
        let done = within || frame.residual <= frame.goal.tolerance;
        match &self.tangent {
            Some(tangent) if done && tangent.definite => self.accept(frame),
            Some(_) if done => self.hand_over(frame),
            _ if self.steps >= MAX_STEPS || farthest(frame.system, frame.u) > FARTHEST => self.hand_over(frame),
            _ => Verdict::Continue,
        }
    }

    fn stop(&mut self, u: &mut [Vector2<f64>]) {
        if let Some(newton) = &mut self.newton {
            newton.stop(u);
        }
    }

    fn recover(&mut self, frame: &mut Frame<'_>, error: FrameError) -> Verdict {
        match &mut self.newton {
            Some(newton) => newton.recover(frame, error),
            None => self.hand_over(frame),
        }
    }
}
