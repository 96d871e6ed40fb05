//! As much as the asked accuracy needs, and no more.
//!
//! - **No solve** where nothing has changed since the last result.
//! - **Linear theory** while its error is small. That error is estimated by the next terms of the displacement's
//!   expansion in the load (Koiter's asymptotic expansion): with g(u, λ) = λ f_ext(u) − f_int(u) and
//!   u(λ) = λ u₁ + λ² u₂ + λ³ u₃ + …, K u₁ = f_ext(0) is the linear solution, K u₂ the quadratic part of g along λ u₁,
//!   and K u₃ the cubic part along λ u₁ + λ² u₂. The imbalance at u₁ itself would not do: on a slender beam its cubic part
//!   is large, and cancels against u₂'s own.
//! - **The old factor** while it serves: steps u ← u + M⁻¹ (f_ext − f_int) with the last exact tangent M = A + G,
//!   factorized anew only where they shrink too slowly (modified Newton).
//! - **Load stepping** ([`Newton`]) where these steps lead nowhere, or to an unstable state.
//!
//! It ends where the estimated error is within the goal, not at a residual.

use nalgebra::Vector2;

use super::certificate::{is_stable, tangent};
use super::frame::timed;
use super::newton::Newton;
use super::status::farthest;
use super::{Frame, FrameError, Method, Occasion, Verdict};
use crate::assembly::System;
use crate::rotation::Rotation;
use crate::solver::Factor;

pub(super) const ABOUT: &str = "As little of the others as the asked accuracy needs: no solve where nothing changed, \
linear theory while it serves, the old factor while it serves, load steps where nothing else does.";

/// The share of the asked error that the estimates may use up: the rest is for what estimates leave out, and the mesh.
const SHARE: f64 = 0.5;
/// A largest rotation, rad, beyond which linear theory need not be asked: a cantilever's is off by 10 % by then.
const LARGEST_LINEAR_ROTATION: f64 = 0.25;
/// Size of the displacement gradient at which the parts of g are measured: smaller loses digits to rounding, larger lets
/// higher parts in.
const PROBING: f64 = 1e-4;
/// How many times the load linear theory is checked for stability, so that a growing load is not checked every frame.
const CHECK_AHEAD: f64 = 2.0;
/// Two linear solutions are the same up to a factor if they differ by this share.
const SAME_SHAPE: f64 = 0.1;
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

/// What `auto` did for the present result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thrift {
    /// What it came down to.
    pub decision: Decision,
    /// Back substitutions.
    pub solves: u32,
    /// Matrices factorized.
    pub factorizations: u32,
    /// Estimated error of the method (the mesh has its own), as a share of the displacement; after load stepping, the
    /// relative residual. Infinite before the end.
    pub estimated_error: f64,
}

/// What a result came down to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decision {
    /// Not there yet.
    #[default]
    Undecided,
    /// No solve: nothing has changed.
    Unchanged,
    /// Linear theory.
    Linear,
    /// Corotated steps, all with an old factor.
    OldFactor,
    /// Corotated steps, factorized anew.
    NewFactor,
    /// Load stepping.
    LoadSteps,
}

impl Decision {
    /// The word in JSON.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Undecided => "undecided",
            Self::Unchanged => "unchanged",
            Self::Linear => "linear",
            Self::OldFactor => "old_factor",
            Self::NewFactor => "new_factor",
            Self::LoadSteps => "load_steps",
        }
    }
}

impl std::fmt::Display for Decision {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Undecided => "not decided yet",
            Self::Unchanged => "nothing changed: no solve",
            Self::Linear => "linear theory serves",
            Self::OldFactor => "the old factor serves",
            Self::NewFactor => "factorized anew",
            Self::LoadSteps => "load stepping",
        })
    }
}

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
    /// The factor of K at rest.
    rest: Option<Factor>,
    tangent: Option<Tangent>,
    /// Linear solution up to which the body has been found stable.
    checked: Option<Vec<Vector2<f64>>>,
    /// Largest rotation at which linear theory last refused; 0 before.
    refused: Option<f64>,
    /// Imbalance of the last result: the same again means that nothing has changed.
    result: Option<Vec<Vector2<f64>>>,
    /// Whether the present state is linear theory's.
    linear: bool,
    steps: u32,
    /// Length of the last step, and over the one before.
    last_step: f64,
    ratio: Option<f64>,
    newton: Option<Newton>,
    thrift: Thrift,
    scratch: Scratch,
}

/// Vectors over nodes and points, made once.
#[derive(Debug, Default)]
struct Scratch {
    rest: Vec<Vector2<f64>>,
    /// A linear solution.
    first: Vec<Vector2<f64>>,
    /// A correction to it, or a step.
    second: Vec<Vector2<f64>>,
    third: Vec<Vector2<f64>>,
    probe: Vec<Vector2<f64>>,
    force: Vec<Vector2<f64>>,
    magnitude: Vec<Vector2<f64>>,
    sum: Vec<Vector2<f64>>,
    r: Vec<Rotation>,
}

impl Scratch {
    fn fit(&mut self, nodes: usize, points: usize) {
        let Self { rest, first, second, third, probe, force, magnitude, sum, r } = self;
        for vector in [rest, first, second, third, probe, force, magnitude, sum] {
            vector.resize(nodes, Vector2::zeros());
        }
        r.resize(points, Rotation::IDENTITY);
    }
}

fn largest(field: &[Vector2<f64>]) -> f64 {
    field.iter().map(|v| v.norm()).fold(0.0, f64::max)
}

/// The size of `part` over that of `whole`: of the field, or of what the first probe sees of it if that is more.
fn share(system: &System, part: &[Vector2<f64>], whole: &[Vector2<f64>]) -> f64 {
    /// A probe that moves less than this share of the body does not measure it.
    const AT_REST: f64 = 1e-9;
    let scale = largest(whole);
    if scale == 0.0 {
        return if largest(part) == 0.0 { 0.0 } else { f64::INFINITY };
    }
    let seen = system.probes.first().map(|p| (p.mean(part).norm(), p.mean(whole).norm()));
    let seen = seen.filter(|(_, whole)| *whole > AT_REST * scale).map_or(0.0, |(part, whole)| part / whole);
    seen.max(largest(part) / scale)
}

impl Auto {
    /// K⁻¹ of a nodal force, into `result`.
    fn solve_at_rest(
        frame: &mut Frame<'_>,
        factor: &mut Factor,
        force: &[Vector2<f64>],
        result: &mut [Vector2<f64>],
    ) -> Result<(), FrameError> {
        let free = &mut frame.workspace.free;
        timed(&mut frame.profile.solve, || {
            frame.system.restrict(force, free);
            factor.solve_in_place(free);
            result.fill(Vector2::zeros());
            frame.system.add_free(free, result);
        });
        if free.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(FrameError::NotFinite) }
    }

    /// The linear solution into `scratch.first`, its next terms into `scratch.second` and `scratch.third`.
    fn expand(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        let system = frame.system;
        self.scratch.fit(frame.u.len(), frame.r.len());
        let Scratch { rest, first, second, third, probe, force, magnitude, sum, r } = &mut self.scratch;
        let factor = match &mut self.rest {
            Some(factor) => factor,
            None => {
                r.fill(Rotation::IDENTITY);
                let values = &mut frame.workspace.values;
                timed(&mut frame.profile.assemble, || system.stiffness(r, values));
                let mut factor = Factor::new(&system.pattern)?;
                timed(&mut frame.profile.factorize, || factor.factorize(values))?;
                self.thrift.factorizations += 1;
                self.rest.insert(factor)
            }
        };
        timed(&mut frame.profile.assemble, || system.external_force(rest, 1.0, force));
        Self::solve_at_rest(frame, factor, force, first)?;
        let mut gradient: f64 = 0.0;
        timed(&mut frame.profile.assemble, || {
            r.fill(Rotation::IDENTITY);
            system.elements.visit_strains(first, r, &mut |_, h, _| gradient = gradient.max(h.amax()));
        });
        let scale = PROBING / gradient.max(f64::MIN_POSITIVE);
        second.fill(Vector2::zeros());
        // Of g(±λ) half the sum is the even part, which begins with λ²; half the difference the odd one. Along λ u₁ the
        // linear part of g cancels, along λ u₁ + λ² u₂ the quadratic one too.
        for power in [2, 3] {
            timed(&mut frame.profile.assemble, || {
                sum.fill(Vector2::zeros());
                for scale in [scale, -scale] {
                    let terms = first.iter().zip(second.iter());
                    probe.iter_mut().zip(terms).for_each(|(p, (u, v))| *p = u * scale + v * (scale * scale));
                    let weight = 0.5 / scale.powi(power);
                    system.elements.rotations(probe, r);
                    system.internal_force(probe, r, force, magnitude);
                    sum.iter_mut().zip(force.iter()).for_each(|(s, f)| *s -= f * weight);
                    system.external_force(probe, scale, force);
                    sum.iter_mut().zip(force.iter()).for_each(|(s, f)| *s += f * weight);
                }
            });
            Self::solve_at_rest(frame, factor, sum, if power == 2 { &mut *second } else { &mut *third })?;
        }
        self.thrift.solves += 3;
        Ok(())
    }

    /// Whether the body is stable under the linear solution in `scratch.first`; checked once for a shape of it.
    fn is_stable_linearly(&mut self, frame: &mut Frame<'_>) -> bool {
        let Scratch { first, probe, r, .. } = &mut self.scratch;
        let covered = self.checked.as_ref().is_some_and(|checked| {
            let along: f64 = first.iter().zip(checked).map(|(u, c)| u.dot(c)).sum();
            let of: f64 = checked.iter().map(|c| c.norm_squared()).sum();
            let scale = along / of;
            let off = first.iter().zip(checked).map(|(u, c)| (u - c * scale).norm()).fold(0.0, f64::max);
            (0.0..=1.0).contains(&scale) && off <= SAME_SHAPE * largest(first)
        });
        if covered {
            return true;
        }
        for ahead in [CHECK_AHEAD, 1.0] {
            probe.iter_mut().zip(first.iter()).for_each(|(p, u)| *p = u * ahead);
            let (system, workspace) = (frame.system, &mut *frame.workspace);
            self.thrift.factorizations += 1;
            let stable = timed(&mut frame.profile.factorize, || {
                system.elements.rotations(probe, r);
                is_stable(system, probe, r, ahead, workspace)
            });
            if stable {
                self.checked = Some(probe.clone());
                return true;
            }
        }
        false
    }

    /// Tries linear theory. Where the state is at rest, or linear theory's, its solution is also the first of Newton's
    /// steps, and taken; returns whether a step was made.
    fn try_linear(&mut self, frame: &mut Frame<'_>) -> Result<bool, FrameError> {
        let turned = largest_rotation(frame.r);
        let tries = self.linear || turned <= LARGEST_LINEAR_ROTATION.min(self.refused.unwrap_or(f64::INFINITY));
        if !tries {
            return Ok(false);
        }
        self.expand(frame)?;
        let Scratch { first, second, third, .. } = &self.scratch;
        let error = share(frame.system, second, first) + share(frame.system, third, first);
        let from_rest = self.linear || largest(frame.u) == 0.0;
        self.linear = error <= SHARE * frame.goal.max_error && self.is_stable_linearly(frame);
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
            frame.u.copy_from_slice(&self.scratch.first);
            self.stepped(self.scratch.first.iter().map(|u| u.norm_squared()).sum::<f64>().sqrt());
            return Ok(true);
        }
        Ok(false)
    }

    fn stepped(&mut self, step: f64) {
        self.ratio = (self.last_step > 0.0).then(|| step / self.last_step).filter(|r| r.is_finite());
        self.last_step = step;
    }

    /// One corotated step, with the old factor if that serves.
    fn step(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        self.scratch.fit(frame.u.len(), frame.r.len());
        if self.tangent.as_ref().is_some_and(|t| t.serves) {
            self.solve_for_step(frame)?;
            let step = share(frame.system, &self.scratch.second, frame.u);
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
        let definite = timed(&mut frame.profile.factorize, || {
            let definite = factor.factorize(values).is_ok();
            if !definite {
                factor.factorize_indefinite(values);
            }
            definite
        });
        self.thrift.factorizations += 1;
        self.thrift.decision = Decision::NewFactor;
        self.tangent = Some(Tangent { factor, definite, trusted: frame.residual <= TRUSTED, serves: false });
        self.solve_for_step(frame)?;
        let step = share(frame.system, &self.scratch.second, frame.u);
        self.advance(frame, step, true);
        Ok(())
    }

    /// The step M⁻¹ (f_ext − f_int), into `scratch.second` and the workspace.
    fn solve_for_step(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        let Some(tangent) = &mut self.tangent else { return Ok(()) };
        let imbalance = frame.imbalance;
        self.thrift.solves += 1;
        Self::solve_at_rest(frame, &mut tangent.factor, imbalance, &mut self.scratch.second)
    }

    /// Takes the step in the workspace, which is this share of the displacement.
    fn advance(&mut self, frame: &mut Frame<'_>, step: f64, fresh: bool) {
        frame.advance(1.0);
        self.stepped(frame.step_length());
        if let Some(tangent) = &mut self.tangent {
            let near = tangent.definite && tangent.trusted && (!fresh || step <= NEAR);
            tangent.serves = near && self.ratio.is_none_or(|r| r <= SERVES);
        }
        // What is left is no more than the step just made, where steps at least halve; else their geometric series.
        self.thrift.estimated_error = match self.ratio {
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
        self.result = Some(frame.imbalance.to_vec());
        Verdict::Converged
    }
}

/// The largest angle of some rotations, rad.
fn largest_rotation(r: &[Rotation]) -> f64 {
    r.iter().map(|r| r.angle().abs()).fold(0.0, f64::max)
}

impl Method for Auto {
    fn begin(&mut self, occasion: Occasion) {
        let fresh = Self { scratch: std::mem::take(&mut self.scratch), ..Self::default() };
        *self = match occasion {
            Occasion::NewStiffness => Self { linear: self.linear, ..fresh },
            Occasion::Reset => Self { rest: self.rest.take(), checked: self.checked.take(), ..fresh },
            Occasion::NewLoads => Self {
                rest: self.rest.take(),
                tangent: self.tangent.take(),
                checked: self.checked.take(),
                refused: self.refused,
                result: self.result.take(),
                linear: self.linear,
                ..fresh
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
        self.ratio
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
            let same = self.result.as_deref() == Some(frame.imbalance);
            if same || (!self.linear && frame.residual == 0.0) {
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
