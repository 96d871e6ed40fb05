//! The path from rest: equilibria of a body at rest while its loads and prescribed displacements grow together from 0
//! to 1, followed by pseudo-arclength continuation ([`crate::continuation`]).
//!
//! The answer of a scene at rest is the end of this path at λ = 1. Where the path turns back (a limit point), the body
//! jumps, and the answer is the first stable state beyond: the first one on the same path if that returns to the load,
//! else the one that a descent of the energy leads to. Where another path crosses (a bifurcation, as of a perfect
//! column), the path goes on, unstable.

use nalgebra::Vector2;

use super::Workspace;
use super::iteration::{assemble, measure};
use crate::assembly::{Forces, Kinematics, Problem};
use crate::continuation::{Continuation, ContinuationPoint, Critical, CriticalMode, PathEquations, PathFailure};
use crate::element::Tangent;
use crate::format::engineering;
use crate::sentence::{Sentence, displayed, sentence};
use crate::state::{State, largest_distance};
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
}

impl StaticEquations<'_> {
    /// Moves the supports to their positions at a load factor.
    fn put(&self, state: &mut State, factor: f64) {
        let supports = self.problem.supports();
        if supports.move_the_body() {
            supports.put(self.problem.system().mesh(), factor, Kinematics::Corotated, &mut state.displacement);
        }
    }

    /// Writes ∂(f_ext − f_int)/∂λ at constant free unknowns into `rate`.
    fn load_rate(&mut self, state: &State, factor: f64, rate: &mut [f64]) {
        /// Step of the central differences: largest motion of a support relative to the height of the strip, and
        /// largest rotation, rad. Their relative error is about the square of the step plus the unit roundoff over the
        /// step.
        const STEP: f64 = 1e-4;
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
        let Workspace { trial, free, .. } = &mut **workspace;
        for h in [step, -step] {
            trial.copy_from(state);
            problem.supports().put(system.mesh(), factor + h, Kinematics::Corotated, &mut trial.displacement);
            problem.update_and_linearize(trial, Kinematics::Corotated, forces, None);
            problem.balance(trial, Kinematics::Corotated, factor + h, forces);
            pattern.restrict(forces.residual(), free);
            rate.iter_mut().zip(&*free).for_each(|(rate, f)| *rate += f / (2.0 * h));
        }
    }
}

impl PathEquations for StaticEquations<'_> {
    type Configuration = State;

    fn unknowns(&self) -> usize {
        self.problem.system().dofs()
    }

    fn advance(&self, state: &mut State, direction: &[f64], length: f64, factor: f64) {
        self.problem.system().pattern().advance(direction, length, &mut state.displacement);
        self.put(state, factor);
    }

    fn complete(&self, state: &mut State) {
        self.problem.system().update_rotations(state, Kinematics::Corotated);
    }

    fn linearize(&mut self, state: &mut State, factor: f64, correction: &mut [f64], rate: &mut [f64]) -> Option<usize> {
        /// Relative residual that is only rounding error: next to a singular tangent, it must not become a correction.
        const BALANCED: f64 = 2e-15;
        let wanted = (Some(Tangent::EXACT), factor);
        let Self { problem, forces, workspace, timings, .. } = self;
        let residual = measure(problem, state, (Kinematics::Corotated, true), wanted, forces, workspace, timings);
        if residual > BALANCED {
            problem.system().pattern().restrict(forces.residual(), correction);
        } else {
            correction.fill(0.0);
        }
        let Workspace { matrix, factor: cholesky, .. } = &mut **workspace;
        timed(&mut timings.factorize, || cholesky.factorize_symmetric(matrix.values()));
        self.load_rate(state, factor, rate);
        self.last_rate.clear();
        self.last_rate.extend_from_slice(rate);
        let Self { workspace, timings, .. } = self;
        let cholesky = &mut workspace.factor;
        timed(&mut timings.solve, || {
            cholesky.solve_in_place(correction);
            cholesky.solve_in_place(rate);
        });
        let is_finite = correction.iter().chain(&*rate).all(|v| v.is_finite());
        is_finite.then(|| cholesky.negative_eigenvalues())
    }

    fn critical_mode(&mut self) -> Option<CriticalMode> {
        /// Number of inverse iterations; the critical eigenvalue is far smaller than all others.
        const INVERSE_ITERATIONS: u32 = 16;
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let cholesky = &mut self.workspace.factor;
        // A vector that is orthogonal to no mode.
        let mut mode: Vec<f64> = (0..self.last_rate.len()).map(|i| (i as f64 * 0.754_877_666).fract() - 0.3).collect();
        let mut stiffness = 0.0;
        for _ in 0..INVERSE_ITERATIONS {
            let length = norm(&mode);
            mode.iter_mut().for_each(|v| *v /= length);
            let before = mode.clone();
            cholesky.solve_in_place(&mut mode);
            stiffness = 1.0 / dot(&before, &mode);
        }
        let cosine = dot(&mode, &self.last_rate).abs() / (norm(&mode) * norm(&self.last_rate));
        (stiffness.is_finite() && cosine.is_finite()).then_some(CriticalMode { stiffness, cosine })
    }
}

/// Quantities that grow along a path from rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Drive {
    /// The loads.
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
    #[must_use]
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
    /// `true` if the state beyond the jump is on the same path; `false` if a descent of the energy led to it.
    pub is_on_path: bool,
    /// Quantities that the load factor refers to.
    pub drive: Drive,
}

/// Critical point on the path, at which the exact tangent is singular and another path crosses this one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Bifurcation {
    /// Load factor.
    pub factor: f64,
    /// Quantities that the load factor refers to.
    pub drive: Drive,
    /// Numbers of negative eigenvalues of the exact tangent below and beyond it: 0 where the path is stable.
    pub unstable_modes: [usize; 2],
}

displayed!(Jump, Bifurcation);

impl Jump {
    /// Returns the jump from a limit point to a state, if one is known.
    pub(super) fn from(
        limit: &ContinuationPoint<State>,
        to: Option<&State>,
        is_on_path: bool,
        problem: &Problem,
    ) -> Self {
        let distance = to.map(|to| largest_distance(&limit.state.displacement, &to.displacement));
        Self { factor: limit.factor, distance, is_on_path, drive: Drive::of(problem) }
    }
}

impl From<&Jump> for Sentence {
    fn from(jump: &Jump) -> Self {
        let (percent, drive) = (percent(jump.factor), &jump.drive);
        match jump.distance {
            None => sentence!(
                "limit point at %{percent} of %{drive}: no stable equilibrium was found beyond it",
                percent,
                drive
            ),
            Some(distance) if jump.is_on_path => sentence!(
                "jumped: beyond the limit point at %{percent} of %{drive}, the next equilibrium is %{distance} away",
                percent,
                drive,
                distance = engineering(distance, "m")
            ),
            Some(distance) => sentence!(
                "jumped: beyond the limit point at %{percent} of %{drive}, the body comes to rest %{distance} away",
                percent,
                drive,
                distance = engineering(distance, "m")
            ),
        }
    }
}

/// Formats a load factor in percent, with four digits.
fn percent(factor: f64) -> String {
    engineering(100.0 * factor, "%")
}

impl Bifurcation {
    /// Returns a short label for figures: `buckles at 49.3 %`.
    #[must_use]
    pub fn label(&self) -> Sentence {
        let percent = engineering((self.factor * 1e3).round() / 10.0, "%");
        match self.unstable_modes {
            [0, _] => sentence!("buckles at %{percent}", percent),
            [_, 0] => sentence!("stable from %{percent}", percent),
            [_, modes] => sentence!("%{n} unstable modes from %{percent}", n = modes, percent),
        }
    }
}

impl From<&Bifurcation> for Sentence {
    fn from(bifurcation: &Bifurcation) -> Self {
        let (percent, drive) = (percent(bifurcation.factor), &bifurcation.drive);
        match bifurcation.unstable_modes {
            [0, _] => {
                sentence!("buckles at %{percent} of %{drive}: beyond it, this path is unstable", percent, drive)
            }
            [_, 0] => sentence!("stable again above %{percent} of %{drive}", percent, drive),
            [_, 1] => sentence!("1 mode is unstable above %{percent} of %{drive}", percent, drive),
            [_, modes] => {
                sentence!("%{n} modes are unstable above %{percent} of %{drive}", n = modes, percent, drive)
            }
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

/// Piece of a path between two of its points.
#[derive(Clone, Debug)]
struct PathPiece {
    from: ContinuationPoint<State>,
    to: ContinuationPoint<State>,
}

/// Follower of the path from rest.
#[derive(Clone, Debug)]
pub(crate) struct PathFollower {
    path: Continuation<State>,
    /// Pieces of the last step that are not yet searched for the goal.
    pieces: Vec<PathPiece>,
    /// Limit point from which the body has jumped, until the path is stable again at the load of that point.
    limit: Option<ContinuationPoint<State>>,
    /// First stable state beyond the first limit point, at the load of that point.
    landing: Option<ContinuationPoint<State>>,
    /// Last point before the last bifurcation.
    crossing: Option<ContinuationPoint<State>>,
    /// Number of unstable modes that the path has gained at bifurcations.
    unstable_modes: usize,
    /// Number of linearizations since the limit point.
    since_limit: u32,
    /// Last equilibrium whose unstable modes all arose at bifurcations.
    last: ContinuationPoint<State>,
    /// `true` during the descent of the energy from the limit point.
    descends: bool,
    /// Number of linearizations of the descent and of paths before it.
    descent_steps: u32,
    /// Critical points so far.
    events: PathEvents,
    /// Number of steps so far.
    pub steps: u32,
}

/// Progress of a path toward a load factor.
#[derive(Debug)]
pub(crate) enum PathProgress {
    /// The goal is not reached yet.
    Continue,
    /// [`PathFollower::last`] is the equilibrium at the goal, to the accuracy of the path.
    Reached,
    /// The path ended before the goal.
    Ended(PathEndReason),
}

/// Load factor below which a path that turned back does not lead to the goal.
const LOWEST_FACTOR: f64 = -2.0;
/// Number of linearizations after a limit point within which the path must return to the goal.
const MAX_RETURN: u32 = 200;
/// Largest number of steps of a descent.
const MAX_DESCENT: u32 = 150;

impl PathFollower {
    /// Starts at rest; `None` if the tangent at rest is singular.
    pub fn start(equations: &mut StaticEquations<'_>) -> Option<Self> {
        let state = equations.problem.system().at_rest();
        Self::start_at(equations, state, 0.0)
    }

    fn start_at(equations: &mut StaticEquations<'_>, state: State, factor: f64) -> Option<Self> {
        let unit = unit(equations.problem);
        let mut path = Continuation::start(equations, state, factor, unit, u32::MAX)?;
        path.limit_factor(equations.problem.supports().largest_load_step());
        let last = path.point().clone();
        let unstable_modes = last.modes;
        Some(Self {
            path,
            pieces: Vec::new(),
            limit: None,
            landing: None,
            crossing: None,
            unstable_modes,
            since_limit: 0,
            last,
            descends: false,
            descent_steps: 0,
            events: PathEvents::default(),
            steps: 0,
        })
    }

    /// Locates every bifurcation, not only the first.
    pub fn locating_all(mut self) -> Self {
        self.path.locate_all();
        self
    }

    /// Returns the number of linearizations so far.
    pub fn linearizations(&self) -> u32 {
        self.path.linearizations + self.descent_steps
    }

    /// Returns the last point of the path.
    pub fn current(&self) -> &ContinuationPoint<State> {
        self.path.point()
    }

    /// Returns the last point before the last bifurcation.
    pub fn crossing(&self) -> Option<&ContinuationPoint<State>> {
        self.crossing.as_ref()
    }

    /// Returns the limit point that the path is beyond, if it has not yet returned to its load.
    pub fn limit(&self) -> Option<&ContinuationPoint<State>> {
        self.limit.as_ref()
    }

    /// Returns the first stable state beyond the first limit point, at its load, if it is on the path.
    pub fn landing(&self) -> Option<&ContinuationPoint<State>> {
        self.landing.as_ref()
    }

    /// Returns the critical points so far.
    pub fn events(&self) -> &PathEvents {
        &self.events
    }

    /// Takes the critical points up to the full load, which the last step may have passed.
    pub fn take_events(&mut self) -> PathEvents {
        self.events.bifurcations.retain(|bifurcation| bifurcation.factor <= 1.0);
        std::mem::take(&mut self.events)
    }

    /// Returns the point at load factor `goal` between two points of a path; `None` if none is found.
    pub fn between(
        equations: &mut StaticEquations<'_>,
        from: &ContinuationPoint<State>,
        to: &ContinuationPoint<State>,
        goal: f64,
    ) -> Option<ContinuationPoint<State>> {
        let mut path =
            Continuation::start(equations, from.state.clone(), from.factor, unit(equations.problem), u32::MAX)?;
        path.between(equations, from, to, goal)
    }

    /// Returns the last equilibrium without unstable modes but those of bifurcations.
    pub fn last(&self) -> &ContinuationPoint<State> {
        &self.last
    }

    /// Goes on toward load factor `goal` by at most one step, with at most `solves` linearizations.
    pub fn advance(&mut self, equations: &mut StaticEquations<'_>, goal: f64, solves: u32) -> PathProgress {
        self.path.limit_linearizations(solves);
        if self.descends {
            return self.descend(equations, goal, solves);
        }
        while let Some(piece) = self.pieces.first() {
            if self.search(equations, &piece.clone(), goal) {
                return PathProgress::Reached;
            }
            let searched = self.pieces.remove(0).to;
            if searched.modes == self.unstable_modes && searched.slope >= 0.0 && self.limit.is_none() {
                self.last = searched;
            }
        }
        let before = self.path.linearizations;
        let stepped = self.path.step(equations);
        self.steps += 1;
        self.since_limit += self.path.linearizations - before;
        let (from, to) = (self.path.before().clone(), self.path.point().clone());
        match stepped {
            Err(PathFailure::Limit) => return PathProgress::Ended(PathEndReason::Solves(solves)),
            Err(PathFailure::Stuck) if self.limit.is_some() => return self.start_descent(),
            Err(PathFailure::Stuck) => return PathProgress::Ended(PathEndReason::NoEquilibrium),
            Ok(None) => self.pieces.push(PathPiece { from, to }),
            Ok(Some((Critical::Bifurcation(modes), crossing))) => {
                if self.limit.is_none() {
                    // Smallest number above the load factor of the crossing.
                    let factor = crossing.factor.next_up();
                    self.crossing = Some(crossing);
                    let drive = Drive::of(equations.problem);
                    self.events.bifurcations.push(Bifurcation { factor, unstable_modes: modes, drive });
                }
                let change = modes[1] as isize - modes[0] as isize;
                self.unstable_modes = self.unstable_modes.saturating_add_signed(change);
                self.pieces.push(PathPiece { from, to });
            }
            Ok(Some((Critical::Limit, limit))) => {
                if self.limit.is_none() && from.slope > 0.0 {
                    self.since_limit = 0;
                    self.limit = Some(limit.clone());
                    self.last = limit.clone();
                }
                self.pieces.push(PathPiece { from, to: limit.clone() });
                self.pieces.push(PathPiece { from: limit, to });
            }
        }
        let leaves = self.path.point().factor < LOWEST_FACTOR * goal.max(1e-3) || self.since_limit > MAX_RETURN;
        if self.limit.is_some() && leaves {
            return self.start_descent();
        }
        PathProgress::Continue
    }

    /// Searches a piece of the path for the state at `goal`, and for the state in which a jump ends; returns `true` if
    /// the former is found.
    fn search(&mut self, equations: &mut StaticEquations<'_>, piece: &PathPiece, goal: f64) -> bool {
        let rises = piece.from.factor < piece.to.factor;
        let stable = |p: &ContinuationPoint<State>| p.modes == self.unstable_modes;
        if !rises || !(stable(&piece.from) || stable(&piece.to)) {
            return false;
        }
        if let Some(limit) = self.limit.clone().filter(|limit| piece.to.factor >= limit.factor) {
            let is_start = piece.to.factor == limit.factor;
            if !is_start && let Some(landing) = self.path.between(equations, &piece.from, &piece.to, limit.factor) {
                let jump = Jump::from(&limit, Some(&landing.state), true, equations.problem);
                self.events.jump.get_or_insert(jump);
                self.limit = None;
                self.landing.get_or_insert(landing.clone());
                self.last = landing;
            }
        }
        if !(piece.from.factor..=piece.to.factor).contains(&goal) {
            return false;
        }
        let found = self.path.between(equations, &piece.from, &piece.to, goal);
        let is_found = found.is_some();
        self.last = found.unwrap_or_else(|| self.last.clone());
        is_found
    }

    /// Begins to descend from the limit point.
    fn start_descent(&mut self) -> PathProgress {
        self.descends = true;
        PathProgress::Continue
    }

    /// Descends the energy at the goal's load from the limit point.
    fn descend(&mut self, equations: &mut StaticEquations<'_>, goal: f64, solves: u32) -> PathProgress {
        let mut state = self.last.state.clone();
        equations.put(&mut state, goal);
        for _ in 0..MAX_DESCENT {
            // The state at the end takes one more linearization.
            if self.linearizations() + 1 >= solves {
                return PathProgress::Ended(PathEndReason::Solves(solves));
            }
            self.descent_steps += 1;
            match descend(equations, &mut state, goal) {
                Descent::Lower => {}
                Descent::Stable => {
                    let Some(next) = Self::start_at(equations, state, goal) else { break };
                    if let Some(limit) = &self.limit {
                        let jump = Jump::from(limit, Some(&next.last.state), false, equations.problem);
                        self.events.jump.get_or_insert(jump);
                    }
                    *self = Self {
                        events: std::mem::take(&mut self.events),
                        steps: self.steps + 1,
                        descent_steps: self.linearizations(),
                        ..next
                    };
                    return PathProgress::Reached;
                }
                Descent::Stuck => break,
            }
        }
        if let Some(limit) = &self.limit {
            self.events.jump.get_or_insert(Jump::from(limit, None, false, equations.problem));
        }
        PathProgress::Ended(PathEndReason::NoEquilibrium)
    }
}

/// Returns the root mean square displacement that counts as much as the whole load in the norm of a path: a tenth of
/// the body's size, at which slender bodies deform nonlinearly.
fn unit(problem: &Problem) -> f64 {
    0.1 * problem.system().size()
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

/// Performs a step that lowers the energy at a load factor: Newton's with the exact tangent where it is positive
/// definite, else with A + max(G, 0), halved until the energy falls (Armijo's rule).
fn descend(equations: &mut StaticEquations<'_>, state: &mut State, factor: f64) -> Descent {
    /// Relative residual of an equilibrium.
    const BALANCED: f64 = 1e-6;
    /// Fraction of the decrease predicted by the slope with which a step is accepted.
    const SUFFICIENT: f64 = 1e-4;
    /// Largest number of halvings of a step.
    const MAX_HALVINGS: u32 = 40;
    let StaticEquations { problem, forces, workspace, timings, .. } = equations;
    let wanted = (Some(Tangent::EXACT), factor);
    let residual = measure(problem, state, (Kinematics::Corotated, true), wanted, forces, workspace, timings);
    let definite = workspace.factor.factorize(workspace.matrix.values()).is_ok();
    if !definite {
        assemble(problem, state, forces, workspace, Tangent::DEFINITE, factor);
        problem.balance(state, Kinematics::Corotated, factor, forces);
        if workspace.factor.factorize(workspace.matrix.values()).is_err() {
            return Descent::Stuck;
        }
    } else if residual <= BALANCED {
        return Descent::Stable;
    }
    let pattern = problem.system().pattern();
    let Workspace { factor: cholesky, free, trial, .. } = &mut **workspace;
    pattern.restrict(forces.residual(), free);
    cholesky.solve_in_place(free);
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
