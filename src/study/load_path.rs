//! Load path of a static scene: its equilibria while loads and prescribed displacements grow together from zero to
//! their full values, found by the follower that solves the scene ([`crate::method`]).

use super::prelude::*;
use crate::assembly::{Forces, Kinematics, Problem};
use crate::continuation::ContinuationPoint;
use crate::method::{
    Bifurcation, Drive, Jump, PathEndReason, PathFollower, PathPart, PathProgress, StaticEquations, Workspace,
    support_stiffness,
};
use crate::scene::Support;
use crate::simulation::{SupportReaction, support_reactions};
use crate::state::{State, largest, largest_distance};

/// Equilibrium on the path.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathState {
    /// Load factor of the scene's loads and prescribed displacements.
    pub factor: f64,
    /// Displacement of every probe, m.
    pub probes: Vec<Vector2<f64>>,
    /// Reaction of every support.
    pub reactions: Vec<SupportReaction>,
    /// `true` if the state is stable under force control: with moving supports released and loaded by their reactions
    /// instead. `None` if unknown.
    pub stable: Option<bool>,
    /// Number of unstable modes with the supports held.
    pub unstable_modes: usize,
}

/// Critical points of the load path from rest, and its end.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathSummary {
    /// First jump on the path, if any.
    pub jump: Option<Jump>,
    /// First bifurcation at which the path loses its stability.
    pub buckling: Option<Bifurcation>,
    /// Load factor next to the full load at which a path that neither jumps nor buckles below loses its stability. Linear
    /// theory does neither: under it, this is the first critical load of the path, and may be below the full load.
    pub critical: Option<f64>,
    /// Quantities that the load factors refer to.
    pub drive: Drive,
    /// Work of moving supports, J; `None` if the path was not followed to the full load.
    pub supports_work: Option<f64>,
    /// Largest distance of a node between the result and the end of the path, m; `None` if both are the same equilibrium.
    /// If the path buckles, the result may be the branch that a body takes there.
    pub elsewhere: Option<f64>,
}

impl PathSummary {
    /// Returns the critical points of a problem's path up to a load factor.
    fn of(problem: &Problem, jump: Option<Jump>, bifurcations: &[Bifurcation], most: f64) -> Self {
        let buckling = bifurcations.iter().find(|b| b.unstable_modes[0] == 0 && b.factor <= most).copied();
        let (jump, drive) = (jump.filter(|jump| jump.factor <= most), Drive::of(problem));
        Self { jump, buckling, critical: None, drive, supports_work: None, elsewhere: None }
    }

    /// Returns the load factor at which the path first jumps or buckles.
    pub(super) fn first_event(&self) -> Option<f64> {
        let events = [self.jump.map(|jump| jump.factor), self.buckling.map(|buckling| buckling.factor)];
        events.into_iter().flatten().reduce(f64::min)
    }
}

/// Critical points of the load path from rest, and the equilibrium at its end.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathFromRest {
    summary: PathSummary,
    /// Displacement of every node at the end, m; `None` under linear theory, whose result is no equilibrium.
    end: Option<Vec<Vector2<f64>>>,
}

impl PathFromRest {
    /// Compares a result, a displacement in m, with the end of the path.
    pub fn to(&self, result: &[Vector2<f64>]) -> PathSummary {
        let Some(end) = &self.end else { return self.summary };
        let distance = largest_distance(end, result);
        if distance <= SAME * largest(end).max(largest(result)) {
            return self.summary;
        }
        PathSummary { elsewhere: Some(distance), critical: None, supports_work: None, ..self.summary }
    }
}

/// Load path of a scene.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct LoadPath {
    /// Title of the scene.
    pub scene: String,
    /// Equilibria, from zero load on.
    pub states: Vec<PathState>,
    /// First jump.
    pub jump: Option<Jump>,
    /// Number of states before the first jump.
    pub states_before_jump: Option<usize>,
    /// Bifurcations, at each of which the number of unstable modes changes.
    pub bifurcations: Vec<Bifurcation>,
    /// Index of the first moving support: the path is drawn over its displacement; `None` if it is drawn over the load.
    pub driven: Option<usize>,
    /// Quantities that the load factors refer to.
    pub drive: Drive,
    /// Work of moving supports along the path, J.
    pub supports_work: f64,
    /// Load factor at which the path ends before the full load, and the reason; `None` if it was followed to its end.
    pub end: Option<(f64, PathEndReason)>,
}

/// Number of rows of a path, which are drawn and between which the work of supports is integrated.
const ROWS: u32 = 60;
/// Smallest number of steps of a path: longer ones might leap over a limit point, to an equilibrium beyond its jump.
const STEPS: f64 = 15.0;
/// Largest number of solves along a path.
const MAX_SOLVES: u32 = 6000;
/// Number of unknowns above which a path is too expensive to be computed as part of a solve.
pub(super) const MAX_UNKNOWNS: usize = 6000;
/// Part of the load up to which a critical load counts as next to it.
const NEXT: f64 = 1.5;
/// Largest distance between a result and the end of the path, relative to the largest displacement, at which both count
/// as the same equilibrium.
const SAME: f64 = 0.02;

impl LoadPath {
    /// Follows the path of a scene; a cancelled path ends early. `None` for a motion, for linear theory, and if the scene cannot
    /// be simulated.
    pub fn of(scene: &Scene, observe: Observer<'_>) -> Option<Self> {
        let can_be_followed = scene.analysis == Analysis::Static && scene.solver.method != MethodKind::Linear;
        let simulation = can_be_followed.then(|| Simulation::new(scene).ok())??;
        Some(Tracer::new(&simulation)?.trace(1.0, true, observe)?.path)
    }

    /// Compares a result with the end of the load path from rest, and summarizes the path; `None` for a motion or a
    /// result that has not converged, or if the path cannot be followed. Of a large model only the critical points are known
    /// that its own search has met.
    pub fn to_result(simulation: &Simulation, observe: Observer<'_>) -> Option<PathSummary> {
        let search = simulation.equilibrium().filter(|_| simulation.status().is_success())?;
        let (problem, events) = (simulation.problem(), search.path_events().filter(|_| !simulation.is_linear()));
        // A search that has met a critical point has followed the path to its end; the work of supports it has not.
        let has_event = events.as_ref().is_some_and(|path| path.jump.is_some() || !path.bifurcations.is_empty());
        let follows = !has_event || problem.supports().move_the_body();
        if let Some(path) = follows.then(|| Self::from_rest(simulation, observe)).flatten() {
            return Some(path.to(simulation.displacement()));
        }
        events.map(|events| PathSummary::of(problem, events.jump, &events.bifurcations, f64::INFINITY))
    }

    /// Follows the load path of a simulation's scene, through the full load to a critical load next to it; `None` for a motion,
    /// if the full load is not reached, or the search is cancelled, or the model is too large.
    pub(crate) fn from_rest(simulation: &Simulation, observe: Observer<'_>) -> Option<PathFromRest> {
        simulation.equilibrium().filter(|_| simulation.system().dofs() <= MAX_UNKNOWNS)?;
        let is_linear = simulation.is_linear();
        let has_work = simulation.problem().supports().move_the_body() && !is_linear;
        let Tracer { path, end, .. } = Tracer::new(simulation)?.trace(NEXT, has_work, observe)?;
        let is_cancelled = matches!(path.end, Some((_, PathEndReason::Interrupted)));
        let end = end.filter(|_| !is_cancelled)?;
        let within = |most: f64| PathSummary::of(simulation.problem(), path.jump, &path.bifurcations, most);
        let summary = within(if is_linear { 0.0 } else { 1.0 });
        let critical = within(NEXT).first_event().filter(|_| summary.first_event().is_none());
        let summary = PathSummary { critical, supports_work: has_work.then_some(path.supports_work), ..summary };
        Some(PathFromRest { summary, end: (!is_linear).then_some(end) })
    }

    /// Returns the load factor at which the load path of a simulation's scene first jumps or buckles, if it does so up to the
    /// load factor `most`.
    pub(super) fn first_event(simulation: &Simulation, most: f64, observe: Observer<'_>) -> Option<f64> {
        let path = Tracer::new(simulation)?.trace(most, false, observe)?.path;
        PathSummary::of(simulation.problem(), path.jump, &path.bifurcations, most).first_event()
    }

    /// Returns `true` if the path reaches the full load without a jump or a bifurcation.
    pub fn is_plain(&self) -> bool {
        self.bifurcations.is_empty() && self.jump.is_none() && self.end.is_none()
    }

    /// Returns the first state, before the body becomes unstable, beyond which it is unstable under force control.
    pub(super) fn limit_under_force(&self) -> Option<&PathState> {
        let stable = self.states.windows(2).take_while(|pair| pair[1].unstable_modes == 0);
        stable.filter(|pair| [pair[0].stable, pair[1].stable] == [Some(true), Some(false)]).map(|pair| &pair[0]).next()
    }

    /// Returns `true` if the moving support only rotates.
    pub fn rotates(&self, scene: &Scene) -> bool {
        self.driven.and_then(|i| scene.supports.get(i)).is_some_and(|support| support.displacement == [0.0; 2])
    }

    /// Returns the motion of the moving support at a state: its displacement, m, or its rotation, rad, if it only
    /// rotates; and the reaction along it, N or N m. `None` if no support moves.
    pub fn driven_pair(&self, scene: &Scene, state: &PathState) -> Option<[f64; 2]> {
        let (support, reaction) = (scene.supports.get(self.driven?)?, state.reactions.get(self.driven?)?);
        let increment = Vector2::from(support.displacement);
        Some(match increment.norm() {
            0.0 => [state.factor * support.turn, reaction.moment],
            length => [state.factor * length, reaction.force.dot(&increment) / length],
        })
    }
}

/// Equilibrium on a path that is followed.
type Point = ContinuationPoint<State>;

/// Records the states of a path.
struct Tracer {
    path: LoadPath,
    problem: Problem,
    workspace: Workspace,
    forces: Forces,
    timings: Timings,
    /// Number of the next row.
    row: u32,
    /// Load factor, elastic energy and potential of the whole loads, J, at the last equilibrium of this part of the path.
    energies: Option<[f64; 3]>,
    /// Last equilibrium, and its stability under force control.
    last: Option<(Point, Option<bool>)>,
    /// Displacement under the full load, m.
    end: Option<Vec<Vector2<f64>>>,
}

impl Tracer {
    /// Returns a recorder of the path of a simulation's scene, on its mesh.
    fn new(simulation: &Simulation) -> Option<Self> {
        let (scene, problem) = (simulation.scene(), simulation.problem().clone());
        let driven = scene.supports.iter().position(Support::moves);
        Some(Self {
            path: LoadPath { scene: scene.name.clone(), driven, drive: Drive::of(&problem), ..LoadPath::default() },
            workspace: Workspace::new(problem.system()).ok()?,
            forces: Forces::new(problem.system().mesh().nodes().len()),
            timings: Timings::default(),
            problem,
            row: 1,
            energies: None,
            last: None,
            end: None,
        })
    }

    /// Follows the path to the load factor `to`, beyond the full load only until it jumps or buckles, and records its states up
    /// to the full load: all rows and critical points if the record `is_complete`. `None` if the tangent at rest is singular.
    fn trace(mut self, to: f64, is_complete: bool, observe: Observer<'_>) -> Option<Self> {
        let now = sentence!("following the load path");
        self.row = if is_complete { 1 } else { ROWS };
        let mut follower = PathFollower::start(&mut self.equations(), to)?;
        follower.path.locates_all = is_complete;
        let has_own_limit = self.problem.supports().move_the_body();
        follower.path.max_by_factor = if has_own_limit { follower.path.max_by_factor } else { to / STEPS };
        self.visit(&follower, &follower.last);
        self.mark();
        let end = loop {
            if observe(Progress { fraction: follower.last.factor / to, now: Some(&now) }).is_break() {
                break Some(PathEndReason::Interrupted);
            }
            let progress = follower.advance(&mut self.equations(), MAX_SOLVES);
            for part in std::mem::take(&mut follower.parts) {
                match part {
                    PathPart::Between(ends) => self.follow(&follower, &ends[0], &ends[1]),
                    PathPart::Mark => self.mark(),
                    PathPart::Landing(landing) => {
                        if follower.events.jump.is_some() && landing.factor <= 1.0 {
                            self.path.states_before_jump.get_or_insert(self.path.states.len());
                        }
                        (self.last, self.energies) = (None, None);
                        self.visit(&follower, &landing);
                        self.mark();
                    }
                }
            }
            let has_event = follower.events.jump.is_some() || !follower.events.bifurcations.is_empty();
            match progress {
                PathProgress::Continue if self.end.is_some() && has_event => break None,
                PathProgress::Continue => {}
                PathProgress::Reached => break None,
                PathProgress::Ended(reason) => break Some(reason),
            }
        };
        let (events, factor) = (follower.take_events(), follower.last.factor);
        self.mark();
        (self.path.jump, self.path.bifurcations) = (events.jump, events.bifurcations);
        self.path.end = end.map(|reason| (factor, reason));
        Some(self)
    }

    fn equations(&mut self) -> StaticEquations<'_> {
        StaticEquations::new(&self.problem, &mut self.forces, &mut self.workspace, &mut self.timings)
    }

    /// Records the rows between two points of the path, and visits the second one.
    fn follow(&mut self, follower: &PathFollower, from: &Point, to: &Point) {
        let factor = |row: u32| f64::from(row) / f64::from(ROWS);
        while self.row <= ROWS && factor(self.row) < to.factor {
            let at = factor(self.row);
            self.row += 1;
            if at > from.factor
                && let Some(row) = follower.path.clone().between(&mut self.equations(), from, to, at)
            {
                self.visit(follower, &row);
                self.mark();
            }
        }
        self.visit(follower, to);
        if factor(self.row) == to.factor {
            self.mark();
        }
    }

    /// Adds the work of moving supports up to the next equilibrium of the path. If the body loses or regains its stability
    /// under force control since the last equilibrium, the state between them at which this happens is recorded.
    fn visit(&mut self, follower: &PathFollower, point: &Point) {
        if point.factor > 1.0 {
            return;
        }
        let stable = self.is_stable(point);
        if let Some((last, Some(before))) = self.last.take()
            && [point.modes, last.modes] == [0; 2]
            && stable.is_some_and(|stable| stable != before)
            && let Some(limit) = self.limit_under_force(follower, &last, before, point)
        {
            self.add_work(&limit);
            self.last = Some((limit, Some(true)));
            self.mark();
        }
        self.add_work(point);
        self.last = Some((point.clone(), stable));
    }

    /// Adds the work of moving supports since the last equilibrium: the change of the elastic energy less the work of the
    /// loads, which grow with the load factor, by the trapezoidal rule.
    fn add_work(&mut self, Point { state, factor, .. }: &Point) {
        if self.path.driven.is_some() {
            let (elastic, potential) = (self.problem.elastic_energy(state), self.problem.loads().potential(state, 1.0));
            if let Some([last, stored, before]) = self.energies.replace([*factor, elastic, potential]) {
                self.path.supports_work += elastic - stored + 0.5 * (last + factor) * (potential - before);
            }
        }
    }

    /// Records the last equilibrium, unless it is recorded already.
    fn mark(&mut self) {
        let Some((point, stable)) = self.last.take() else { return };
        self.problem.linearize(&point.state, &mut self.forces, None);
        self.problem.balance(&point.state, Kinematics::Corotated, point.factor, &mut self.forces);
        let reactions = support_reactions(&self.problem, &point.state, Kinematics::Corotated, &self.forces);
        let probes = self.problem.probes().iter().map(|p| p.mean(&point.state.displacement)).collect();
        let state = PathState { factor: point.factor, probes, reactions, stable, unstable_modes: point.modes };
        if self.path.states.last() != Some(&state) {
            self.path.states.push(state);
        }
        if point.factor == 1.0 {
            self.end = Some(point.state.displacement.to_vec());
        }
        self.last = Some((point, stable));
    }

    /// Returns `true` if a state is stable under force control.
    fn is_stable(&mut self, point: &Point) -> Option<bool> {
        if point.modes > 0 || self.path.driven.is_none() {
            return Some(point.modes == 0);
        }
        let Self { problem, workspace, forces, .. } = self;
        support_stiffness(problem, &point.state, point.factor, forces, workspace).map(|stiffness| stiffness > 0.0)
    }

    /// Returns the last or first state, between two others, that is stable under force control, by bisection.
    fn limit_under_force(&mut self, follower: &PathFollower, from: &Point, stable: bool, to: &Point) -> Option<Point> {
        /// Number of bisections; the reaction is stationary there, so that its error is about the square of 2⁻¹⁰.
        const BISECTIONS: u32 = 10;
        let (mut low, mut high) = (from.clone(), to.clone());
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low.factor + high.factor);
            let point = follower.path.clone().between(&mut self.equations(), &low, &high, middle)?;
            let side = if self.is_stable(&point)? == stable { &mut low } else { &mut high };
            *side = point;
        }
        Some(if stable { low } else { high })
    }
}

/// Describes a support: `support left`, `support (0.1, 0.0085)`.
pub fn support_text(scene: &Scene, number: usize) -> String {
    scene.supports.get(number).map_or_else(|| "support".to_owned(), |support| format!("support {}", support.place))
}

/// Returns the name of a support in tables: its edge, or its table in the scene.
pub fn support_name(scene: &Scene, number: usize) -> String {
    match scene.supports.get(number).map(|s| &s.place) {
        Some(Place::Edge(edge)) => edge.clone(),
        _ => format!("support.{number}"),
    }
}
