//! The path from rest: equilibria of a body at rest while its loads and prescribed displacements grow together from 0
//! to 1, followed by pseudo-arclength continuation ([`crate::continuation`]).
//!
//! The answer of a scene at rest is the end of this path at λ = 1. Where the path turns back (a limit point), the body
//! jumps, and the answer is the first stable state beyond: the first one on the same path if that returns to the load,
//! else the one that a descent of the energy leads to. Where another path crosses (a bifurcation, as of a perfect
//! column), the path goes on, unstable.
//!
//! Where supports move, the unknowns are those in the frame of the supports, which moves with them as a rigid body
//! ([`crate::assembly::Supports`]): a rigid motion is no deformation, and the load that grows along the path deforms the
//! body in its own symmetry, so that it is orthogonal to a mode that breaks the symmetry.

use std::borrow::Cow;

use nalgebra::Vector2;

use crate::assembly::{Forces, Kinematics, LinearSystem, Problem};
use crate::continuation::{Continuation, ContinuationPoint, Critical, CriticalMode, PathEquations, PathFailure, dot};
use crate::element::Tangent;
use crate::format::engineering;
use crate::rotation::Rotation;
use crate::sentence::{Sentence, displayed, sentence};
use crate::solver::Factor;
use crate::state::{State, largest_distance};
use crate::step::{Iteration, Linearization, RotationUpdate, Workspace};
use crate::timings::{Timings, timed};

/// Equations of a body at rest under a growing load.
pub(crate) struct StaticEquations<'a> {
    pub problem: &'a Problem,
    pub forces: &'a mut Forces,
    pub workspace: &'a mut Workspace,
    pub timings: &'a mut Timings,
    /// ∂(f_ext − f_int)/∂λ of the last linearization.
    last_rate: Vec<f64>,
}

impl<'a> StaticEquations<'a> {
    pub fn new(
        problem: &'a Problem,
        forces: &'a mut Forces,
        workspace: &'a mut Workspace,
        timings: &'a mut Timings,
    ) -> Self {
        Self { problem, forces, workspace, timings, last_rate: Vec::new() }
    }

    /// Computes forces, and the matrix of a tangent, of a state at a load factor.
    fn linearize_at(&mut self, state: &mut State, rotations: RotationUpdate<'_>, tangent: Tangent, load_factor: f64) {
        let Self { problem, forces, workspace, timings, .. } = self;
        let wanted = Linearization::corotated(tangent, load_factor);
        Iteration { problem, state, forces, workspace, timings }.linearize(rotations, wanted);
    }
}

/// Moves a body with the frame of its supports from one load factor to another, and the supports to their positions there.
fn put(problem: &Problem, state: &mut State, factors: [f64; 2]) {
    let (supports, mesh) = (problem.supports(), problem.system().mesh());
    if supports.move_the_body() {
        supports.carry_with_frame(problem.system(), factors, state);
        supports.put(mesh, factors[1], Kinematics::Corotated, &mut state.displacement);
    }
}

/// Rotates a vector over the free unknowns at the nodes with two of them.
fn rotate(problem: &Problem, rotation: Rotation, free: &mut [f64]) {
    for &(_, first) in problem.system().pattern().free_nodes() {
        let pair = &mut free[first as usize..][..2];
        pair.copy_from_slice(rotation.apply(Vector2::new(pair[0], pair[1])).as_slice());
    }
}

impl StaticEquations<'_> {
    /// Writes ∂(f_ext − f_int)/∂λ at constant free unknowns into `rate`.
    fn load_rate(&mut self, state: &State, factor: f64, rate: &mut [f64]) {
        /// Step of the differences of fourth order: largest motion of a support relative to the height of the strip, and
        /// largest rotation, rad. Their relative error is about the fourth power of the step plus the unit roundoff over
        /// the step.
        const STEP: f64 = 5e-4;
        let Self { problem, forces, workspace, .. } = self;
        let system = problem.system();
        let pattern = system.pattern();
        if !problem.supports().move_the_body() {
            let nodal = &mut workspace.nodal;
            problem.loads().force(system, &state.displacement, Kinematics::Corotated, 1.0, nodal);
            if let Some(spring) = problem.mouse_spring() {
                spring.add_force(spring.force_at_rest(&state.displacement), nodal);
            }
            pattern.restrict(nodal, rate);
            return;
        }
        let height = system.strip()[1];
        let largest = problem.supports().all().iter().map(|s| (s.displacement.norm() / height).max(s.rotation.abs()));
        let step = STEP / largest.fold(0.0, f64::max);
        rate.fill(0.0);
        let Workspace { trial, linear: LinearSystem { correction: free, .. }, .. } = &mut **workspace;
        for (steps, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
            let at = factor + steps * step;
            trial.copy_from(state);
            put(problem, trial, [factor, at]);
            problem.update_and_linearize(trial, Kinematics::Corotated, forces, None);
            problem.balance(trial, Kinematics::Corotated, at, forces);
            pattern.restrict(forces.residual(), free);
            rate.iter_mut().zip(&*free).for_each(|(rate, f)| *rate += f * weight / (12.0 * step));
        }
    }
}

impl PathEquations for StaticEquations<'_> {
    type Configuration = State;

    fn unknowns(&self) -> usize {
        self.problem.system().dofs()
    }

    fn advance(&self, state: &mut State, direction: &[f64], length: f64, factors: [f64; 2]) {
        let (supports, system) = (self.problem.supports(), self.problem.system());
        let mut direction = Cow::Borrowed(direction);
        if supports.move_the_body() {
            put(self.problem, state, factors);
            let frame = supports.frame_rotation(system.mesh(), factors[1]);
            rotate(self.problem, frame, direction.to_mut());
        }
        system.pattern().advance(&direction, length, &mut state.displacement);
    }

    fn complete(&self, state: &mut State) {
        self.problem.system().update_rotations(state, Kinematics::Corotated);
    }

    fn linearize(
        &mut self,
        state: &mut State,
        factor: f64,
        stressed: Option<&State>,
        correction: &mut [f64],
        rate: &mut [f64],
    ) -> Option<usize> {
        /// Relative residual that is only rounding error: next to a singular tangent, it must not become a correction.
        const BALANCED: f64 = 2e-15;
        let rotations = stressed.map_or(RotationUpdate::Follow, RotationUpdate::FollowStressed);
        self.linearize_at(state, rotations, Tangent::EXACT, factor);
        let Self { problem, forces, workspace, timings, .. } = self;
        if forces.relative_residual > BALANCED {
            problem.system().pattern().restrict(forces.residual(), correction);
        } else {
            correction.fill(0.0);
        }
        workspace.linear.factorize_symmetric(timings);
        self.load_rate(state, factor, rate);
        self.last_rate.clear();
        self.last_rate.extend_from_slice(rate);
        let Self { problem, workspace, timings, .. } = self;
        let cholesky = &mut workspace.linear.factor;
        timed(&mut timings.solve, || {
            cholesky.solve_in_place(correction);
            cholesky.solve_in_place(rate);
        });
        if problem.supports().move_the_body() {
            let Rotation { c, s } = problem.supports().frame_rotation(problem.system().mesh(), factor);
            for free in [&mut *correction, &mut *rate] {
                rotate(problem, Rotation { c, s: -s }, free);
            }
        }
        let is_finite = correction.iter().chain(&*rate).all(|v| v.is_finite());
        is_finite.then(|| cholesky.negative_eigenvalues())
    }

    fn critical_mode(&mut self) -> Option<CriticalMode> {
        /// Largest cosine that is the rounding error of differences: the unit roundoff over their step. Far from the crossing
        /// of an imperfect body, cosines are not much larger: they grow as one over the mode's stiffness.
        const ROUNDING: f64 = 2e-13;
        let (mode, stiffness) = softest_mode(&mut self.workspace.linear.factor, self.last_rate.len(), &[]);
        let mut cosine = dot(&mode, &self.last_rate).abs() / (norm(&mode) * norm(&self.last_rate));
        if self.problem.supports().move_the_body() && cosine.is_finite() {
            // The stiff elements beside a moved support hide the part of the load in a mode, however large it is.
            cosine = if cosine < ROUNDING { 0.0 } else { 1.0 };
        }
        (stiffness.is_finite() && cosine.is_finite()).then_some(CriticalMode { stiffness, cosine })
    }
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// Returns the mode of a factorized matrix with the eigenvalue closest to 0, and this eigenvalue, by inverse iteration;
/// the unit vectors `others` are modes that are known already.
fn softest_mode(cholesky: &mut Factor, unknowns: usize, others: &[Vec<f64>]) -> (Vec<f64>, f64) {
    /// Number of inverse iterations; a critical eigenvalue is far smaller than all others.
    const INVERSE_ITERATIONS: u32 = 16;
    // A vector that is orthogonal to no mode.
    let part = |i: usize| ((i + 7 * others.len()) as f64 * 0.754_877_666).fract() - 0.3;
    let mut mode: Vec<f64> = (0..unknowns).map(part).collect();
    let mut stiffness = 0.0;
    for _ in 0..INVERSE_ITERATIONS {
        for other in others {
            let along = dot(other, &mode);
            mode.iter_mut().zip(other).for_each(|(v, other)| *v -= along * other);
        }
        let length = norm(&mode);
        mode.iter_mut().for_each(|v| *v /= length);
        let before = mode.clone();
        cholesky.solve_in_place(&mut mode);
        stiffness = 1.0 / dot(&before, &mode);
    }
    (mode, stiffness)
}

/// Quantities that grow along a path from rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Drive {
    /// The loads.
    #[default]
    Loads,
    /// The prescribed motion of supports.
    Supports,
    /// Both.
    Both,
}

displayed!(Drive);

impl From<&Drive> for Sentence {
    fn from(drive: &Drive) -> Self {
        match drive {
            Drive::Loads => sentence!("the load"),
            Drive::Supports => sentence!("the support motion"),
            Drive::Both => sentence!("load and support motion"),
        }
    }
}

impl Drive {
    /// Returns the quantities that grow along the path of a problem.
    pub fn of(problem: &Problem) -> Self {
        let loads = problem.loads();
        let is_loaded = loads.moments().next().is_some() || loads.dead_force().iter().any(|f| *f != Vector2::zeros());
        match (is_loaded, problem.supports().move_the_body()) {
            (true, true) => Self::Both,
            (false, true) => Self::Supports,
            (_, false) => Self::Loads,
        }
    }
}

/// Jump of the body from its path at a limit point.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Jump {
    /// Load factor of the limit point: the largest one of the path before the jump.
    pub factor: f64,
    /// Largest displacement of a node in the jump at this load factor, m; `None` if no stable state was found beyond.
    pub distance: Option<f64>,
}

/// Critical point on the path, at which the exact tangent is singular and another path crosses this one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Bifurcation {
    /// Load factor.
    pub factor: f64,
    /// Numbers of negative eigenvalues of the exact tangent below and beyond it: 0 where the path is stable.
    pub unstable_modes: [usize; 2],
}

impl Jump {
    /// Returns the jump from a limit point to a state, if one is known.
    fn from(limit: &ContinuationPoint<State>, to: Option<&State>) -> Self {
        let distance = to.map(|to| largest_distance(&limit.state.displacement, &to.displacement));
        Self { factor: limit.factor, distance }
    }

    /// Returns `true` if the body does not come to rest where it has left its path.
    fn is_far(&self, problem: &Problem) -> bool {
        self.distance.is_some_and(|distance| distance > SAME_STATE * problem.system().size())
    }
}

impl Bifurcation {
    /// Returns a short label for figures: `buckles at 49.3 %`.
    pub fn label(&self) -> Sentence {
        let percent = engineering((self.factor * 1e3).round() / 10.0, "%");
        match self.unstable_modes {
            [0, _] => sentence!("buckles at %{percent}", percent),
            [_, 0] => sentence!("stable from %{percent}", percent),
            [_, modes] => sentence!("%{n} unstable modes from %{percent}", n = modes, percent),
        }
    }
}

/// Critical points of a path from rest.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathEvents {
    /// First jump.
    pub jump: Option<Jump>,
    /// Bifurcations, at each of which the number of unstable modes changes.
    pub bifurcations: Vec<Bifurcation>,
}

/// Reason why a path ends before the full load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum PathEndReason {
    /// No equilibrium was found near the last one, stable or not.
    NoEquilibrium,
    /// The limit of the number of solves was reached.
    Solves(u32),
    /// The command was interrupted.
    Interrupted,
}

/// Part of a path that a step has added.
#[derive(Clone, Debug)]
pub(crate) enum PathPart {
    /// The equilibria between two points, in the order of the load.
    Between(Box<[ContinuationPoint<State>; 2]>),
    /// The last point is critical, or the end of the path.
    Mark,
    /// The state at which a jump or a descent ends.
    Landing(Box<ContinuationPoint<State>>),
}

/// Follower of the path from rest to a load factor.
#[derive(Clone, Debug)]
pub(crate) struct PathFollower {
    pub path: Continuation<State>,
    /// Load factor at the end.
    end: f64,
    /// Parts of the path since they were last taken.
    pub parts: Vec<PathPart>,
    /// Limit point from which the body has jumped, until the path is stable again at the load of that point.
    pub limit: Option<ContinuationPoint<State>>,
    /// Number of unstable modes that the path has gained at bifurcations.
    unstable_modes: usize,
    /// Number of linearizations since the limit point.
    since_limit: u32,
    /// Last equilibrium whose unstable modes all arose at bifurcations.
    pub last: ContinuationPoint<State>,
    /// `true` during the descent of the energy from the limit point.
    descends: bool,
    /// Number of linearizations of descents and of paths before them.
    descent_steps: u32,
    /// Critical points so far.
    pub events: PathEvents,
    /// Number of steps so far.
    pub steps: u32,
}

/// Progress of a path.
#[derive(Debug)]
pub(crate) enum PathProgress {
    /// The end is not reached yet.
    Continue,
    /// [`PathFollower::last`] is the equilibrium at the end, to the accuracy of the path.
    Reached,
    /// The path ended before.
    Ended(PathEndReason),
}

/// Number of places in a unit of λ at which the path of moved supports is looked at for pairs of bifurcations.
const PLACES: f64 = 16.0;
/// Load factor below which a path that turned back does not return.
const LOWEST_FACTOR: f64 = -2.0;
/// Number of linearizations after a limit point within which the path must return to its load.
const MAX_RETURN: u32 = 200;
/// Largest number of steps of a descent.
const MAX_DESCENT: u32 = 150;
/// Load factor beyond a limit point at which a descent begins.
const BEYOND: f64 = 1e-3;
/// Distance, relative to the size of the body, within which a descent leads back to the path that it left.
const SAME_STATE: f64 = 1e-3;

impl PathFollower {
    /// Starts at rest, toward the load factor `end`; `None` if the tangent at rest is singular.
    pub fn start(equations: &mut StaticEquations<'_>, end: f64) -> Option<Self> {
        let state = equations.problem.system().at_rest();
        Self::start_at(equations, state, 0.0, end)
    }

    fn start_at(equations: &mut StaticEquations<'_>, state: State, factor: f64, end: f64) -> Option<Self> {
        // A root mean square displacement of a tenth of the body's size, at which slender bodies deform nonlinearly, counts
        // as much as the whole load in the norm of the path.
        let unit = 0.1 * equations.problem.system().size();
        let mut path = Continuation::start(equations, state, factor, unit, u32::MAX)?;
        path.max_by_factor = equations.problem.supports().largest_load_step();
        let moves = equations.problem.supports().move_the_body();
        (path.places, path.may_lag) = (if moves { PLACES } else { 0.0 }, !moves);
        let last = path.point.clone();
        let unstable_modes = last.modes;
        Some(Self {
            path,
            end,
            parts: Vec::new(),
            limit: None,
            unstable_modes,
            since_limit: 0,
            last,
            descends: false,
            descent_steps: 0,
            events: PathEvents::default(),
            steps: 0,
        })
    }

    /// Returns the number of linearizations so far.
    pub fn linearizations(&self) -> u32 {
        self.path.linearizations + self.descent_steps
    }

    /// Takes the critical points up to the end, which the last step may have passed.
    pub fn take_events(&mut self) -> PathEvents {
        self.events.bifurcations.retain(|bifurcation| bifurcation.factor <= self.end);
        std::mem::take(&mut self.events)
    }

    /// Goes on toward the end by at most one step, with at most `solves` linearizations in all.
    pub fn advance(&mut self, equations: &mut StaticEquations<'_>, solves: u32) -> PathProgress {
        self.path.max_linearizations = solves.saturating_sub(self.descent_steps);
        if self.descends {
            return self.descend(equations, solves);
        }
        let on_path = |path: &Continuation<State>| path.linearizations - path.located;
        let before = on_path(&self.path);
        let stepped = self.path.step(equations);
        self.steps += 1;
        self.since_limit += on_path(&self.path) - before;
        let (from, to) = (self.path.before.clone(), self.path.point.clone());
        let is_beyond = self.limit.is_some();
        let progress = match stepped {
            Err(PathFailure::Limit) => PathProgress::Ended(PathEndReason::Solves(solves)),
            Err(PathFailure::Stuck) if is_beyond => self.start_descent(),
            Err(PathFailure::Stuck) => PathProgress::Ended(PathEndReason::NoEquilibrium),
            Ok(None) => self.add(equations, from, to, None),
            Ok(Some((Critical::Bifurcation(modes), crossing))) => {
                if !is_beyond {
                    // Smallest number above the load factor of the crossing.
                    let factor = crossing.factor.next_up();
                    self.events.bifurcations.push(Bifurcation { factor, unstable_modes: modes });
                }
                let change = modes[1] as isize - modes[0] as isize;
                self.unstable_modes = self.unstable_modes.saturating_add_signed(change);
                self.add(equations, from, to, Some(crossing))
            }
            Ok(Some((kind, limit))) if !is_beyond && from.slope > 0.0 => {
                match self.add(equations, from, limit.clone(), None) {
                    PathProgress::Continue if !self.descends => {
                        self.parts.push(PathPart::Mark);
                        self.since_limit = 0;
                        self.limit = Some(limit.clone());
                        self.last = limit;
                        // The frame of moved supports turns on while the path leads back: the body is let go at once.
                        let leads_nowhere = kind == Critical::Tip || equations.problem.supports().move_the_body();
                        if leads_nowhere { self.start_descent() } else { PathProgress::Continue }
                    }
                    progress => progress,
                }
            }
            Ok(Some((_, limit))) => match self.add(equations, from, limit.clone(), None) {
                PathProgress::Continue if !self.descends => self.add(equations, limit, to, None),
                progress => progress,
            },
        };
        let leaves = self.path.point.factor < LOWEST_FACTOR || self.since_limit > MAX_RETURN;
        if self.limit.is_some() && leaves && matches!(progress, PathProgress::Continue) {
            return self.start_descent();
        }
        progress
    }

    /// Adds a piece of the path to the parts that the body follows, from where it lands if it has jumped, up to the end;
    /// `crossing` is a bifurcation on it.
    fn add(
        &mut self,
        equations: &mut StaticEquations<'_>,
        from: ContinuationPoint<State>,
        to: ContinuationPoint<State>,
        crossing: Option<ContinuationPoint<State>>,
    ) -> PathProgress {
        let is_followed = |p: &ContinuationPoint<State>| p.modes == self.unstable_modes;
        if from.factor >= to.factor || !(is_followed(&from) || is_followed(&to)) {
            return PathProgress::Continue;
        }
        let mut start = from.clone();
        if let Some(limit) = self.limit.clone() {
            if to.factor < limit.factor {
                return PathProgress::Continue;
            }
            let landing = self.path.between(equations, &from, &to, limit.factor);
            let jump = landing.as_ref().map(|landing| Jump::from(&limit, Some(&landing.state)));
            let Some((landing, jump)) = landing.zip(jump.filter(|jump| jump.is_far(equations.problem))) else {
                // A path that returns to its limit point is a loop.
                return self.start_descent();
            };
            self.events.jump.get_or_insert(jump);
            self.limit = None;
            self.last = landing.clone();
            self.parts.push(PathPart::Landing(Box::new(landing.clone())));
            start = landing;
        }
        if let Some(crossing) = crossing.filter(|crossing| crossing.factor > start.factor && crossing.factor < self.end)
        {
            self.parts.extend([PathPart::Between(Box::new([start, crossing.clone()])), PathPart::Mark]);
            start = crossing;
        }
        if to.factor < self.end {
            self.parts.push(PathPart::Between(Box::new([start, to.clone()])));
            if to.modes == self.unstable_modes && to.slope >= 0.0 {
                self.last = to;
            }
            return PathProgress::Continue;
        }
        let Some(end) = self.path.between(equations, &from, &to, self.end) else {
            // The step has passed a place that shorter ones do not pass: the path ends there.
            self.limit = Some(from.clone());
            self.last = from;
            return self.start_descent();
        };
        self.parts.extend([PathPart::Between(Box::new([start, end.clone()])), PathPart::Mark]);
        self.last = end;
        PathProgress::Reached
    }

    /// Begins to descend from the limit point.
    fn start_descent(&mut self) -> PathProgress {
        self.descends = true;
        PathProgress::Continue
    }

    /// Descends the energy from the limit point, and goes on from there: a little beyond its load if supports move, whose
    /// motion must be followed, or else at the end, to which loads that stay as they are lead at once.
    fn descend(&mut self, equations: &mut StaticEquations<'_>, solves: u32) -> PathProgress {
        let limit = self.limit.take().unwrap_or_else(|| self.last.clone());
        let end = if limit.factor < 1.0 { 1.0 } else { self.end };
        let moves = equations.problem.supports().move_the_body();
        let factor = if moves { (limit.factor + BEYOND).min(end) } else { end };
        let mut start = limit.clone();
        put(equations.problem, &mut start.state, [limit.factor, factor]);
        let mut state = start.state.clone();
        for _ in 0..MAX_DESCENT {
            // The state at the end takes one more linearization.
            if self.linearizations() + 1 >= solves {
                self.limit = Some(limit);
                return PathProgress::Ended(PathEndReason::Solves(solves));
            }
            self.descent_steps += 1;
            match descend(equations, &mut state, factor) {
                Descent::Lower => {}
                Descent::Stable => {
                    let Some(mut next) = Self::start_at(equations, state, factor, self.end) else { break };
                    let jump = Jump::from(&start, Some(&next.last.state));
                    if jump.is_far(equations.problem) {
                        self.events.jump.get_or_insert(jump);
                    }
                    (next.path.locates_all, next.path.max_by_factor) = (self.path.locates_all, self.path.max_by_factor);
                    self.parts.push(PathPart::Landing(Box::new(next.last.clone())));
                    *self = Self {
                        parts: std::mem::take(&mut self.parts),
                        events: std::mem::take(&mut self.events),
                        steps: self.steps + 1,
                        descent_steps: self.linearizations(),
                        ..next
                    };
                    return if factor < self.end { PathProgress::Continue } else { PathProgress::Reached };
                }
                Descent::Stuck => break,
            }
        }
        self.events.jump.get_or_insert(Jump::from(&limit, None));
        self.limit = Some(limit);
        PathProgress::Ended(PathEndReason::NoEquilibrium)
    }
}

/// Result of a step of a descent.
enum Descent {
    /// The energy is lower.
    Lower,
    /// The state is close to a stable equilibrium.
    Stable,
    /// No step lowers the energy.
    Stuck,
}

/// Performs a step that lowers the energy at a load factor: Newton's with the exact tangent or, where it is unstable, with
/// A + max(G, 0). Where supports move, this matrix is too stiff in bending: there Newton's step is turned round in the
/// unstable modes, if these are few. A step is halved until the energy falls (Armijo's rule).
fn descend(equations: &mut StaticEquations<'_>, state: &mut State, factor: f64) -> Descent {
    /// Relative residual of an equilibrium.
    const BALANCED: f64 = 1e-6;
    /// Fraction of the decrease predicted by the slope with which a step is accepted.
    const SUFFICIENT: f64 = 1e-4;
    /// Largest number of halvings of a step.
    const MAX_HALVINGS: u32 = 40;
    /// Largest component of a step relative to the size of the body: the rotations of longer ones are not known.
    const LONGEST: f64 = 0.1;
    equations.linearize_at(state, RotationUpdate::Follow, Tangent::EXACT, factor);
    let definite = equations.workspace.linear.factorize(equations.timings).is_ok();
    if definite && equations.forces.relative_residual <= BALANCED {
        return Descent::Stable;
    }
    let problem = equations.problem;
    let (moves, pattern) = (problem.supports().move_the_body(), problem.system().pattern());
    pattern.restrict(equations.forces.residual(), &mut equations.workspace.linear.correction);
    let is_solved = !definite && moves && solve_downhill(&mut equations.workspace.linear);
    if !definite && !is_solved {
        equations.linearize_at(state, RotationUpdate::Keep, Tangent::DEFINITE, factor);
        if equations.workspace.linear.factorize(equations.timings).is_err() {
            return Descent::Stuck;
        }
    }
    let StaticEquations { forces, workspace, timings, .. } = equations;
    if !is_solved && workspace.linear.solve(pattern, forces.residual(), timings).is_err() {
        return Descent::Stuck;
    }
    let Workspace { linear: LinearSystem { correction: free, .. }, trial, .. } = &mut **workspace;
    let longest = free.iter().fold(0.0, |longest: f64, v| longest.max(v.abs()));
    let scale = if moves { (LONGEST * problem.system().size() / longest).min(1.0) } else { 1.0 };
    free.iter_mut().for_each(|v| *v *= scale);
    let promised = pattern.dot(forces.residual(), free);
    let before = problem.energy(state, factor);
    // Differences of energies below this are rounding errors.
    let noise = 1e-13 * before.abs();
    let mut fraction = 1.0;
    for _ in 0..MAX_HALVINGS {
        trial.copy_from(state);
        pattern.advance(free, fraction, &mut trial.displacement);
        problem.system().update_rotations(trial, Kinematics::Corotated);
        let after = problem.energy(trial, factor);
        if after.is_finite() && after <= before - SUFFICIENT * fraction * promised + noise {
            state.copy_from(trial);
            return Descent::Lower;
        }
        fraction *= 0.5;
    }
    Descent::Stuck
}

/// Replaces the force r in the correction by |K|⁻¹ r: Newton's step with the matrix K, with the opposite sign in the modes with
/// negative stiffness. Returns `false` if these are too many or not found, or if the step does not follow the force.
fn solve_downhill(linear: &mut LinearSystem) -> bool {
    /// Largest number of modes with negative stiffness.
    const MAX_MODES: usize = 6;
    let LinearSystem { factor: cholesky, matrix, correction: free } = linear;
    cholesky.factorize_symmetric(matrix.values());
    let negative = cholesky.negative_eigenvalues();
    if !(1..=MAX_MODES).contains(&negative) {
        return false;
    }
    let force = free.clone();
    cholesky.solve_in_place(free);
    let (mut found, mut modes): (usize, Vec<Vec<f64>>) = (0, Vec::new());
    while found < negative && modes.len() < MAX_MODES + negative {
        let (mut mode, stiffness) = softest_mode(cholesky, free.len(), &modes);
        let length = norm(&mode);
        mode.iter_mut().for_each(|v| *v /= length);
        if stiffness < 0.0 {
            found += 1;
            let along = dot(&mode, free);
            free.iter_mut().zip(&mode).for_each(|(v, mode)| *v -= 2.0 * along * mode);
        }
        modes.push(mode);
    }
    found == negative && free.iter().all(|v| v.is_finite()) && dot(&force, free) > 0.0
}
