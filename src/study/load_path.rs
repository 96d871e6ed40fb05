//! Load path of a static scene: its equilibria while loads and prescribed displacements grow together from zero to
//! their full values, found by the follower that solves the scene ([`crate::method`]).

use std::ops::ControlFlow;

use nalgebra::Vector2;

use crate::assembly::{Forces, Kinematics, Problem};
use crate::continuation::ContinuationPoint;
use crate::format::engineering;
use crate::method::{
    Bifurcation, Drive, Jump, PathEndReason, PathFollower, PathProgress, StaticEquations, Workspace, support_stiffness,
};
use crate::progress::{Observer, Progress};
use crate::scene::{Analysis, MethodKind, Place, Scene, Support};
use crate::sentence::{Sentence, displayed, sentence};
use crate::simulation::{Equilibrium, Simulation, Status, SupportReaction, supports_power};
use crate::state::{State, largest, largest_distance};
use crate::timings::Timings;

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

/// End of a path before the full load.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathEnd {
    /// Load factor.
    pub factor: f64,
    /// Reason.
    pub reason: PathEndReason,
    /// Quantities that the load factor refers to.
    pub drive: Drive,
}

impl std::fmt::Display for PathEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "not followed beyond {} of {}: ", engineering(100.0 * self.factor, "%"), self.drive)?;
        match self.reason {
            PathEndReason::NoEquilibrium => write!(f, "no stable equilibrium was found there"),
            PathEndReason::Solves(most) => write!(f, "the path took {most} solves until there"),
            PathEndReason::Interrupted => write!(f, "interrupted"),
        }
    }
}

/// Equilibrium at the end of the load path from rest, if it differs from the result.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Elsewhere {
    /// Largest distance of a node from the result, m.
    pub distance: f64,
    /// First bifurcation at which the path loses its stability: the result may be the branch that a body takes there.
    pub buckling: Option<Bifurcation>,
}

/// Load next to the full load at which the path from rest loses its stability.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct CriticalLoad {
    /// Load factor; above 1 but under linear theory.
    pub factor: f64,
    /// Quantities that the load factor refers to.
    pub drive: Drive,
}

impl From<&CriticalLoad> for Sentence {
    fn from(critical: &CriticalLoad) -> Self {
        // Next to the load, four digits could say 100 %.
        let percent = if critical.factor > 1.0 && critical.factor < 1.0005 {
            sentence!("just beyond 100 %")
        } else {
            engineering(100.0 * critical.factor, "%").into()
        };
        let drive = &critical.drive;
        sentence!("becomes unstable at %{percent} of %{drive}", percent, drive)
    }
}

/// Critical points of the load path from rest, and its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathSummary {
    /// First jump on the path, if any.
    pub jump: Option<Jump>,
    /// First bifurcation at which the path loses its stability.
    pub buckling: Option<Bifurcation>,
    /// Critical load next to the full load of a path that neither jumps nor buckles below. Linear theory does neither:
    /// under it, this is the first critical load of the path, and may be below the full load.
    pub critical: Option<CriticalLoad>,
    /// Work of moving supports, J; `None` if the path was not followed to the full load.
    pub supports_work: Option<f64>,
    /// End of the path, if it is not the result.
    pub elsewhere: Option<Elsewhere>,
}

displayed!(Elsewhere, CriticalLoad);

impl From<&Elsewhere> for Sentence {
    fn from(elsewhere: &Elsewhere) -> Self {
        let distance = engineering(elsewhere.distance, "m");
        match &elsewhere.buckling {
            None => sentence!("loading from rest leads to another equilibrium, %{distance} away", distance),
            Some(Bifurcation { factor, drive, .. }) => sentence!(
                "not on the path from rest, which is unstable above %{percent} of %{drive} and ends %{distance} away",
                percent = engineering(100.0 * factor, "%"),
                drive,
                distance
            ),
        }
    }
}

impl PathSummary {
    fn of(jump: Option<Jump>, bifurcations: &[Bifurcation]) -> Self {
        let buckling = bifurcations.iter().find(|b| b.unstable_modes[0] == 0).copied();
        Self { jump, buckling, ..Self::default() }
    }

    /// Returns the load factor at which the path first jumps or buckles.
    pub(super) fn first_event(&self) -> Option<f64> {
        let events = [self.jump.map(|jump| jump.factor), self.buckling.map(|buckling| buckling.factor)];
        events.into_iter().flatten().reduce(f64::min)
    }

    /// Returns the critical load of the path next to the load of a simulation under linear theory.
    fn of_linear(simulation: &Simulation, observe: Observer<'_>) -> Self {
        Self { critical: Self::default().critical_load(simulation, observe), ..Self::default() }
    }

    /// Returns the critical load next to the load of a simulation's scene: `None` if the path jumps or buckles below, or
    /// cannot be followed to it.
    fn critical_load(&self, simulation: &Simulation, observe: Observer<'_>) -> Option<CriticalLoad> {
        if self.first_event().is_some() {
            return None;
        }
        let factor = NEXT * LoadPath::end_of(simulation, NEXT, observe)?.summary.first_event()?;
        (factor > 1.0 || simulation.is_linear())
            .then(|| CriticalLoad { factor, drive: Drive::of(simulation.problem()) })
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
    #[must_use]
    pub fn to(&self, result: &[Vector2<f64>]) -> PathSummary {
        let Some(end) = &self.end else { return self.summary };
        let distance = largest_distance(end, result);
        let is_elsewhere = distance > SAME * largest(end).max(largest(result));
        let elsewhere = is_elsewhere.then_some(Elsewhere { distance, buckling: self.summary.buckling });
        PathSummary { elsewhere, critical: self.summary.critical.filter(|_| !is_elsewhere), ..self.summary }
    }
}

/// Load path of a scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// Work of moving supports, the integral of their reactions along the path, J.
    pub supports_work: f64,
    /// End of the path before the full load; `None` if it was followed to its end.
    pub end: Option<PathEnd>,
}

/// Number of states of a path that is drawn.
const DRAWN: u32 = 60;
/// Number of states of a path along which the work of supports is integrated by the trapezoidal rule.
const INTEGRATED: u32 = 60;
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
    /// Follows the path of a scene. `None` for a motion, for linear theory, and if the scene cannot be simulated.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        Self::observed(scene, &|_| ControlFlow::Continue(()))
    }

    /// Follows the path as [`Self::of`] with progress reports; a cancelled path ends early.
    #[must_use]
    pub fn observed(scene: &Scene, observe: Observer<'_>) -> Option<Self> {
        let simulation = can_be_followed(scene).then(|| Simulation::new(scene).ok())??;
        Tracer::new(&simulation)?.trace(DRAWN, observe)
    }

    /// Compares a result with the end of the load path from rest, and summarizes the path; `None` for a motion or a
    /// result that has not converged, if the model is too large, or if the path cannot be followed.
    #[must_use]
    pub fn to_result(simulation: &Simulation, observe: Observer<'_>) -> Option<PathSummary> {
        let search = simulation.equilibrium()?;
        if !simulation.status().is_success() {
            return None;
        }
        let is_small = simulation.system().dofs() <= MAX_UNKNOWNS;
        if simulation.is_linear() {
            return is_small.then(|| PathSummary::of_linear(simulation, observe));
        }
        let mut summary = match search.path_events() {
            Some(events) => PathSummary::of(events.jump, &events.bifurcations),
            None if is_small => Self::end_of(simulation, 1.0, observe)?.to(simulation.displacement()),
            None => return None,
        };
        if is_small && summary.elsewhere.is_none() {
            summary.critical = summary.critical_load(simulation, observe);
        }
        if is_small && summary.elsewhere.is_none() && simulation.problem().supports().move_the_body() {
            let path = Tracer::new(simulation).and_then(|tracer| tracer.trace(INTEGRATED, observe));
            summary.supports_work = path.filter(|path| path.end.is_none()).map(|path| path.supports_work);
        }
        Some(summary)
    }

    /// Follows the load path of a simulation's scene on its mesh, to `part` of the load; returns its critical points and
    /// the displacement at its end, m; `None` if the path cannot be followed, or is cancelled.
    fn end_of(simulation: &Simulation, part: f64, observe: Observer<'_>) -> Option<PathFromRest> {
        let mut scene = simulation.scene().clone();
        scene.scale_loads(part);
        scene.solver.method = MethodKind::Newton;
        scene.solver.accept_after = 0;
        scene.solver.max_iterations = MAX_SOLVES;
        let mut follower = Simulation::with_system(&scene, simulation.system().clone()).ok()?;
        let now = sentence!("following the load path");
        let reached = |follower: &Simulation| follower.equilibrium().map_or(0.0, Equilibrium::load_factor);
        let flow =
            follower.solve_watched(&mut |follower| observe(Progress { fraction: reached(follower), now: Some(&now) }));
        if flow.is_break() || *follower.status() != Status::Converged {
            return None;
        }
        let events = follower.equilibrium()?.path_events()?;
        let summary = PathSummary::of(events.jump, &events.bifurcations);
        Some(PathFromRest { summary, end: Some(follower.displacement().to_vec()) })
    }

    /// Follows the load path of a scene to its end; `None` for a motion, if the path cannot be followed, or is cancelled,
    /// or the model is too large.
    #[must_use]
    pub fn end_of_scene(scene: &Scene, observe: Observer<'_>) -> Option<PathFromRest> {
        let simulation = (scene.analysis == Analysis::Static).then(|| Simulation::new(scene).ok())??;
        let is_small = simulation.system().dofs() <= MAX_UNKNOWNS;
        if simulation.is_linear() {
            let summary = || PathSummary::of_linear(&simulation, observe);
            return is_small.then(|| PathFromRest { summary: summary(), end: None });
        }
        let mut path = is_small.then(|| Self::end_of(&simulation, 1.0, observe))??;
        path.summary.critical = path.summary.critical_load(&simulation, observe);
        Some(path)
    }

    /// Summarizes the path.
    #[must_use]
    pub fn summary(&self) -> PathSummary {
        let supports_work = self.end.is_none().then_some(self.supports_work);
        PathSummary { supports_work, ..PathSummary::of(self.jump, &self.bifurcations) }
    }

    /// Returns `true` if the path reaches the full load without a jump or a bifurcation.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.bifurcations.is_empty() && self.jump.is_none() && self.end.is_none()
    }

    /// Returns `true` if the moving support only rotates.
    #[must_use]
    pub fn rotates(&self, scene: &Scene) -> bool {
        self.driven.and_then(|i| scene.supports.get(i)).is_some_and(|support| support.displacement == [0.0; 2])
    }

    /// Returns the motion of the moving support at a state: its displacement, m, or its rotation, rad, if it only
    /// rotates; and the reaction along it, N or N m. `None` if no support moves.
    #[must_use]
    pub fn driven_pair(&self, scene: &Scene, state: &PathState) -> Option<[f64; 2]> {
        let (support, reaction) = (scene.supports.get(self.driven?)?, state.reactions.get(self.driven?)?);
        let increment = Vector2::from(support.displacement);
        Some(match increment.norm() {
            0.0 => [state.factor * support.turn, reaction.moment],
            length => [state.factor * length, reaction.force.dot(&increment) / length],
        })
    }
}

fn can_be_followed(scene: &Scene) -> bool {
    scene.analysis == Analysis::Static && scene.solver.method != MethodKind::Linear
}

/// Records the states of a path.
struct Tracer {
    name: String,
    driven: Option<usize>,
    problem: Problem,
    workspace: Workspace,
    forces: Forces,
    timings: Timings,
    path: Vec<PathState>,
    /// Derivative of the work of moving supports with respect to the load factor at the last state, J.
    power: f64,
    /// Load factor up to which the work is integrated.
    reached: f64,
    work: f64,
    /// Last equilibrium, and its stability under force control.
    last: Option<(ContinuationPoint<State>, Option<bool>)>,
}

impl Tracer {
    /// Returns a recorder of the path of a simulation's scene, on its mesh.
    fn new(simulation: &Simulation) -> Option<Self> {
        let (scene, problem) = (simulation.scene(), simulation.problem().clone());
        Some(Self {
            name: scene.name.clone(),
            driven: scene.supports.iter().position(Support::moves),
            workspace: Workspace::new(problem.system()).ok()?,
            forces: Forces::new(problem.system().mesh().nodes().len()),
            timings: Timings::default(),
            problem,
            path: Vec::new(),
            power: 0.0,
            reached: 0.0,
            work: 0.0,
            last: None,
        })
    }

    fn trace(mut self, count: u32, observe: Observer<'_>) -> Option<LoadPath> {
        let now = sentence!("following the load path");
        let mut follower = PathFollower::start(&mut self.equations())?.locating_all();
        self.record(follower.last().clone(), true);
        let (mut end, mut states_before_jump, mut bifurcations) = (None, None, 0);
        // Critical point of the last step: the goals before it are found after the step.
        let mut critical: Option<ContinuationPoint<State>> = None;
        let mut goals = (1..=count).map(|i| f64::from(i) / f64::from(count));
        let mut goal = goals.next();
        while let Some(to) = goal {
            if observe(Progress { fraction: follower.last().factor, now: Some(&now) }).is_break() {
                end = Some(PathEndReason::Interrupted);
                break;
            }
            let had_jumped = follower.limit().is_some();
            let progress = follower.advance(&mut self.equations(), to, MAX_SOLVES);
            let is_before = matches!(progress, PathProgress::Reached)
                && critical.as_ref().is_some_and(|critical| follower.last().factor < critical.factor);
            if let Some(critical) = critical.take_if(|_| !is_before) {
                self.record(critical, true);
            }
            let found = follower.events().bifurcations.len();
            if found > bifurcations {
                bifurcations = found;
                critical = follower.crossing().cloned();
            }
            if !had_jumped {
                critical = follower.limit().cloned().or(critical);
            }
            if states_before_jump.is_none() && follower.events().jump.is_some_and(|jump| jump.distance.is_some()) {
                states_before_jump = Some(self.path.len());
                // No support moves in a jump.
                if let Some(landing) = follower.landing() {
                    self.record(landing.clone(), false);
                }
            }
            match progress {
                PathProgress::Continue => {
                    // The end of the piece of the path that was searched last.
                    let last = follower.last();
                    if self.driven.is_some() && follower.limit().is_none() && last.factor > self.reached {
                        self.visit(&last.clone(), true);
                    }
                }
                PathProgress::Reached => {
                    self.record(follower.last().clone(), true);
                    goal = goals.next();
                }
                PathProgress::Ended(reason) => {
                    end = Some(reason);
                    break;
                }
            }
        }
        let events = follower.take_events();
        let factor = follower.last().factor;
        if end.is_some() && self.path.last().is_some_and(|state| state.factor < factor) {
            self.record(follower.last().clone(), true);
        }
        Some(LoadPath {
            scene: self.name,
            states: self.path,
            jump: events.jump,
            states_before_jump,
            bifurcations: events.bifurcations,
            driven: self.driven,
            supports_work: self.work,
            end: end.map(|reason| PathEnd { factor, reason, drive: Drive::of(&self.problem) }),
        })
    }

    fn equations(&mut self) -> StaticEquations<'_> {
        StaticEquations::new(&self.problem, &mut self.forces, &mut self.workspace, &mut self.timings)
    }

    /// Records an equilibrium. If the body loses or regains its stability under force control since the last one, the
    /// state between them at which this happens is recorded first. `works` is `true` if the supports do work between
    /// the two.
    fn record(&mut self, point: ContinuationPoint<State>, works: bool) {
        self.visit(&point, works);
        self.push(&point);
    }

    /// Integrates the work of moving supports to an equilibrium, and records the change of stability under force
    /// control on the way to it.
    fn visit(&mut self, point: &ContinuationPoint<State>, works: bool) {
        let stable = self.is_stable(point);
        if let Some((last, Some(before))) = self.last.take()
            && works
            && [point.modes, last.modes] == [0; 2]
            && stable.is_some_and(|stable| stable != before)
            && let Some(limit) = self.limit_under_force(&last, before, point)
        {
            self.integrate(&limit, works);
            self.last = Some((limit.clone(), Some(true)));
            self.push(&limit);
        }
        self.integrate(point, works);
        self.last = Some((point.clone(), stable));
    }

    /// Integrates the work of moving supports to a state beyond the last one.
    fn integrate(&mut self, point: &ContinuationPoint<State>, works: bool) {
        if self.driven.is_none() {
            return;
        }
        let reactions = self.reactions(point);
        let power = supports_power(&self.problem, &reactions);
        if works {
            self.work += 0.5 * (point.factor - self.reached) * (self.power + power);
        }
        (self.power, self.reached) = (power, point.factor);
    }

    fn push(&mut self, point: &ContinuationPoint<State>) {
        let reactions = self.reactions(point);
        let probes = self.problem.probes().iter().map(|p| p.mean(&point.state.displacement)).collect();
        let stable = self.last.as_ref().and_then(|(_, stable)| *stable);
        self.path.push(PathState { factor: point.factor, probes, reactions, stable, unstable_modes: point.modes });
    }

    /// Returns `true` if a state is stable under force control.
    fn is_stable(&mut self, point: &ContinuationPoint<State>) -> Option<bool> {
        if point.modes > 0 || self.driven.is_none() {
            return Some(point.modes == 0);
        }
        let Self { problem, workspace, forces, .. } = self;
        support_stiffness(problem, &point.state, point.factor, forces, workspace).map(|stiffness| stiffness > 0.0)
    }

    /// Returns the last or first state, between two others, that is stable under force control, by bisection.
    fn limit_under_force(
        &mut self,
        from: &ContinuationPoint<State>,
        stable: bool,
        to: &ContinuationPoint<State>,
    ) -> Option<ContinuationPoint<State>> {
        /// Number of bisections; the reaction is stationary there, so that its error is about the square of 2⁻¹⁰.
        const BISECTIONS: u32 = 10;
        let (mut low, mut high) = (from.clone(), to.clone());
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low.factor + high.factor);
            let point = PathFollower::between(&mut self.equations(), &low, &high, middle)?;
            let side = if self.is_stable(&point)? == stable { &mut low } else { &mut high };
            *side = point;
        }
        Some(if stable { low } else { high })
    }

    fn reactions(&mut self, point: &ContinuationPoint<State>) -> Vec<SupportReaction> {
        use Kinematics::Corotated;
        self.problem.linearize(&point.state, &mut self.forces, None);
        self.problem.balance(&point.state, Corotated, point.factor, &mut self.forces);
        crate::simulation::support_reactions(&self.problem, &point.state, Corotated, &self.forces)
    }
}

/// Describes a support: `support left`, `support (0.1, 0.0085)`.
#[must_use]
pub fn support_text(scene: &Scene, number: usize) -> String {
    scene.supports.get(number).map_or_else(|| "support".to_owned(), |support| format!("support {}", support.place))
}

/// Returns the name of a support in tables: its edge, or its table in the scene.
#[must_use]
pub fn support_name(scene: &Scene, number: usize) -> String {
    match scene.supports.get(number).map(|s| &s.place) {
        Some(Place::Edge(edge)) => edge.clone(),
        _ => format!("support.{number}"),
    }
}
