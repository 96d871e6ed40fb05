//! Load path of a static scene: its equilibria while loads and prescribed displacements grow together from zero to
//! their full values. Each equilibrium is the one nearest to the one before; where there is none, the body jumps.

use std::ops::ControlFlow;

use nalgebra::Vector2;

use crate::assembly::{Forces, Kinematics, Problem};
use crate::element::Tangent;
use crate::format::engineering;
use crate::method::{Workspace, support_stiffness};
use crate::scene::{Analysis, MethodKind, Place, Scene};
use crate::sentence::{Sentence, displayed, sentence};
use crate::simulation::{Simulation, Status, SupportReaction, supports_power};
use crate::state::{State, largest};

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
    /// instead. With the supports held it is stable in any case. `None` if unknown.
    pub stable: Option<bool>,
}

/// Jump of the body away from the path.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Jump {
    /// Last load factor with an equilibrium near the previous ones.
    pub factor: f64,
    /// Largest displacement of a node in the jump, m; 0 if no equilibrium was found after it.
    pub distance: f64,
}

displayed!(Jump, Bifurcation);

impl From<&Jump> for Sentence {
    fn from(jump: &Jump) -> Self {
        if jump.factor >= 1.0 {
            return sentence!("the body jumped: another equilibrium under this load is closer to rest");
        }
        let percent = engineering(100.0 * jump.factor, "%");
        match jump.distance {
            0.0 => sentence!("beyond %{percent} of the load no stable equilibrium was found", percent),
            distance => sentence!(
                "the body jumped: beyond %{percent} of the load the next equilibrium is %{distance} away",
                percent,
                distance = engineering(distance, "m")
            ),
        }
    }
}

/// Critical point on the path, at which the exact tangent is singular and another path crosses this one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Bifurcation {
    /// Load factor, within 0.001 of the full load.
    pub factor: f64,
    /// Numbers of negative eigenvalues of the exact tangent below and beyond it: 0 where the path is stable.
    pub unstable_modes: [usize; 2],
}

impl Bifurcation {
    /// Formats the load factor in percent, to a hundredth.
    fn percent(&self) -> String {
        engineering((self.factor * 1e4).round() / 1e2, "%")
    }

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
        let percent = bifurcation.percent();
        match bifurcation.unstable_modes {
            [0, _] => {
                sentence!("buckles at %{percent} of the load: beyond it, this path is unstable", percent)
            }
            [_, 0] => format!("stable again from {percent} of the load on").into(),
            [_, modes] => format!("from {percent} of the load on {modes} modes are unstable").into(),
        }
    }
}

/// Reason why a path ends before the full load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum PathEndReason {
    /// There is no equilibrium nearby, stable or not.
    NoEquilibrium,
    /// The limit of the number of solves was reached.
    Solves(u32),
    /// The command was interrupted.
    Interrupted,
}

/// End of a path before the full load.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathEnd {
    /// Load factor.
    pub factor: f64,
    /// Reason.
    pub reason: PathEndReason,
}

impl std::fmt::Display for PathEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the path ends at {} of the load: ", engineering(100.0 * self.factor, "%"))?;
        match self.reason {
            PathEndReason::NoEquilibrium => write!(f, "no equilibrium was found beyond it"),
            PathEndReason::Solves(most) => write!(f, "it took more than {most} solves"),
            PathEndReason::Interrupted => write!(f, "interrupted"),
        }
    }
}

/// Critical points of the load path that ends at an equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PathSummary {
    /// First jump on the path, if any.
    pub jump: Option<Jump>,
    /// First critical point at which the path loses its stability.
    pub buckling: Option<Bifurcation>,
    /// Work of moving supports, J; `None` if the path was not followed to the full load.
    pub supports_work: Option<f64>,
}

impl PathSummary {
    /// Describes jump and buckling, one sentence each.
    pub fn sentences(&self) -> impl Iterator<Item = Sentence> {
        let buckling = self.buckling.map(|buckling| Sentence::from(&buckling));
        self.jump.map(|jump| Sentence::from(&jump)).into_iter().chain(buckling)
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
    /// Points at which the stability changes without a jump.
    pub bifurcations: Vec<Bifurcation>,
    /// Index of the first moving support: the path is drawn over its displacement; `None` if it is drawn over the load.
    pub driven: Option<usize>,
    /// Work of moving supports, the integral of their reactions along the path, J.
    pub supports_work: f64,
    /// End of the path before the full load; `None` if it was followed to its end.
    pub end: Option<PathEnd>,
    /// Displacement at the end, m.
    last: Vec<Vector2<f64>>,
}

/// Number of states of a path that is drawn.
const DRAWN: u32 = 60;
/// Number of states of a path that is followed only to detect jumps.
const FOLLOWED: u32 = 8;
/// Number of states of a path along which the work of supports is integrated by the trapezoidal rule.
const INTEGRATED: u32 = 40;
/// Smallest step of the load factor.
const SMALLEST_STEP: f64 = 1e-4;
/// Largest ratio of a step's displacement to that predicted from the previous step; beyond it the step has left the
/// path.
const FARTHER: f64 = 4.0;
/// Displacement, relative to the largest displacement, below which a smallest step does not count as a jump. A buckling
/// column leaves the straight configuration fast, but without a jump.
const NO_JUMP: f64 = 0.05;
/// Iteration limit from one equilibrium on the path to the next.
const FEW_ITERATIONS: u32 = 20;
/// Iteration limit for a jump.
const ENOUGH_ITERATIONS: u32 = 500;
/// Number of solves after which the path ends.
const MOST_SOLVES: u32 = 300;
/// Width of the interval of the load factor in which a change of stability is located.
const BRACKET: f64 = 1e-3;
/// Number of unknowns above which a path is too expensive to be computed as part of a solve.
const MOST_UNKNOWNS: usize = 6000;

/// Callback that receives the completed fraction, and cancels with [`ControlFlow::Break`].
pub type PathObserver<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

impl LoadPath {
    /// Follows the path of a scene. `None` for a motion, for linear theory, and if the scene cannot be simulated.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        Self::follow(scene, &mut |_| ControlFlow::Continue(()))
    }

    /// Follows as [`Self::of`] with progress reports; a cancelled path ends early.
    #[must_use]
    pub fn follow(scene: &Scene, observe: PathObserver<'_>) -> Option<Self> {
        Follower::new(scene)?.follow(DRAWN, observe)
    }

    /// Follows the load path to a result of a scene, a displacement in m, and summarizes it; `None` if the path does
    /// not reach it.
    #[must_use]
    pub fn to_result(scene: &Scene, result: &[Vector2<f64>], observe: PathObserver<'_>) -> Option<PathSummary> {
        /// Largest difference, relative to the largest displacement, that does not count as another equilibrium.
        const SAME: f64 = 0.02;
        // Return before setting up equations that would not be used.
        if 2 * result.len() > MOST_UNKNOWNS {
            return None;
        }
        let follower = Follower::new(scene)?;
        let count = if follower.whole.supports().move_the_body() { INTEGRATED } else { FOLLOWED };
        let path = follower.follow(count, observe)?;
        let summary = path.summary();
        if summary.jump.is_some() || summary.buckling.is_some() {
            return Some(summary);
        }
        if path.end.is_some() || result.len() != path.last.len() {
            return None;
        }
        let distance = path.last.iter().zip(result).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        let elsewhere = distance > SAME * largest(result).max(largest(&path.last));
        // If the result is not on the path, the solver has jumped to another equilibrium.
        Some(PathSummary { jump: elsewhere.then_some(Jump { factor: 1.0, distance }), ..summary })
    }

    /// Follows the load path of a scene and summarizes it; `None` if the path cannot be followed.
    #[must_use]
    pub fn summary_of(scene: &Scene) -> Option<PathSummary> {
        let follower = Follower::new(scene)?;
        if follower.simulation.system().dofs() > MOST_UNKNOWNS {
            return None;
        }
        Some(follower.follow(FOLLOWED, &mut |_| ControlFlow::Continue(()))?.summary())
    }

    /// Summarizes the path.
    #[must_use]
    pub fn summary(&self) -> PathSummary {
        PathSummary {
            jump: self.jump,
            buckling: self.bifurcations.iter().find(|b| b.unstable_modes[0] == 0).copied(),
            supports_work: self.end.is_none().then_some(self.supports_work),
        }
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

/// Solver that follows a path.
struct Follower {
    scene: Scene,
    simulation: Simulation,
    /// Problem with the full loads.
    whole: Problem,
    workspace: Workspace,
    forces: Forces,
    reached: f64,
    state: State,
    /// Previous accepted state, and its load factor.
    before: (f64, State),
    /// Number of negative eigenvalues of the exact tangent at the last accepted state.
    unstable_modes: usize,
    /// Work of the supports so far, J, and its derivative with respect to the load factor at the last accepted state,
    /// J.
    work: f64,
    power: f64,
    /// Derivative of the largest displacement with respect to the load factor, m.
    rate: f64,
    solves: u32,
}

impl Follower {
    fn new(scene: &Scene) -> Option<Self> {
        if scene.analysis != Analysis::Static || scene.solver.method == MethodKind::Linear {
            return None;
        }
        let mut scene = scene.clone();
        scene.solver.method = MethodKind::Linear;
        let mut linear = Simulation::new(&scene).ok()?;
        linear.solve();
        let rate = largest(linear.displacement());
        scene.solver.method = MethodKind::Newton;
        scene.solver.max_iterations = scene.solver.max_iterations.max(ENOUGH_ITERATIONS);
        scene.solver.accept_after = 0;
        let system = linear.system().clone();
        let whole = Problem::new(&scene, system.clone()).ok()?;
        let workspace = Workspace::new(&system).ok()?;
        let simulation = Simulation::with_system(&part(&scene, 0.0), system).ok()?;
        let (state, forces) = (simulation.state().clone(), Forces::new(simulation.displacement().len()));
        let before = (0.0, state.clone());
        Some(Self {
            scene,
            simulation,
            whole,
            workspace,
            forces,
            reached: 0.0,
            state,
            before,
            unstable_modes: 0,
            work: 0.0,
            power: 0.0,
            rate,
            solves: 0,
        })
    }

    fn follow(mut self, count: u32, observe: PathObserver<'_>) -> Option<LoadPath> {
        if *self.simulation.solve() != Status::Converged {
            return None;
        }
        let moves = |s: &crate::scene::Support| s.moves();
        let mut path = LoadPath {
            scene: self.scene.name.clone(),
            states: vec![self.seen()],
            jump: None,
            bifurcations: Vec::new(),
            driven: self.scene.supports.iter().position(moves),
            supports_work: 0.0,
            end: None,
            last: Vec::new(),
        };
        for i in 1..=count {
            let goal = f64::from(i) / f64::from(count);
            if let Err(reason) = self.go(goal, &mut path, observe) {
                // The last equilibrium belongs to the path.
                if path.states.last().is_some_and(|state| state.factor < self.reached) {
                    path.states.push(self.seen());
                }
                path.end = Some(PathEnd { factor: self.reached, reason });
                break;
            }
            path.states.push(self.seen());
        }
        path.last = self.state.displacement.to_vec();
        path.supports_work = self.work;
        Some(path)
    }

    /// Continues to a load factor.
    fn go(&mut self, goal: f64, path: &mut LoadPath, observe: PathObserver<'_>) -> Result<(), PathEndReason> {
        let mut step = goal - self.reached;
        while self.reached < goal {
            if observe(self.reached).is_break() {
                return Err(PathEndReason::Interrupted);
            }
            // The last step ends exactly at the goal, without rounding errors.
            let to = if goal - self.reached <= step * (1.0 + 1e-9) { goal } else { self.reached + step };
            let nearby = |moved: f64, rate: f64, from: f64| moved <= FARTHER * rate * (to - from);
            if self.unstable_modes > 0 {
                step = self.go_unstable(to, path)?;
                continue;
            }
            let converged = self.solve_near(to);
            let moved = self.distance(self.simulation.displacement());
            if converged && nearby(moved, self.rate, self.reached) {
                self.accept(to, moved);
                step *= 2.0;
                continue;
            }
            if self.solves > MOST_SOLVES {
                return Err(PathEndReason::Solves(MOST_SOLVES));
            }
            step = 0.4 * (to - self.reached);
            if step >= SMALLEST_STEP {
                self.go_back();
                continue;
            }
            if self.loses_stability(to, path) {
                step = goal - self.reached;
                continue;
            }
            // There is no equilibrium nearby: the body jumps to the result of a full solve.
            let converged = *self.simulation.solve() == Status::Converged;
            let moved = self.distance(self.simulation.displacement());
            if !converged {
                path.jump.get_or_insert(Jump { factor: self.reached, distance: 0.0 });
                return Err(PathEndReason::NoEquilibrium);
            }
            if moved > NO_JUMP * largest(self.simulation.displacement()) {
                path.states.push(self.seen());
                path.jump.get_or_insert(Jump { factor: self.reached, distance: moved });
            }
            let rate = self.rate;
            self.accept(to, moved);
            self.rate = rate;
            step = goal - self.reached;
        }
        Ok(())
    }

    /// Continues over a critical point to the unstable equilibrium beyond it, if the path has one nearby; returns
    /// `true` if it does.
    fn loses_stability(&mut self, to: f64, path: &mut LoadPath) -> bool {
        let mut state = self.predicted(to);
        let Some(modes) = self.correct(&mut state, to) else { return false };
        let moved = self.distance(&state.displacement);
        if modes == 0 || moved > FARTHER * self.rate * (to - self.reached) {
            return false;
        }
        path.states.push(self.seen());
        path.bifurcations.push(Bifurcation { factor: 0.5 * (self.reached + to), unstable_modes: [0, modes] });
        self.accept_state(to, moved, &state);
        self.unstable_modes = modes;
        path.states.push(self.seen());
        true
    }

    /// Continues along an unstable path; returns the next step.
    fn go_unstable(&mut self, to: f64, path: &mut LoadPath) -> Result<f64, PathEndReason> {
        let width = to - self.reached;
        let mut state = self.predicted(to);
        self.solves += 1;
        let modes = self.correct(&mut state, to);
        let moved = self.distance(&state.displacement);
        let near = moved <= FARTHER * self.rate * width;
        match modes.filter(|_| near) {
            Some(modes) if modes == self.unstable_modes || width <= BRACKET => {
                if modes != self.unstable_modes {
                    let unstable_modes = [self.unstable_modes, modes];
                    path.bifurcations.push(Bifurcation { factor: 0.5 * (self.reached + to), unstable_modes });
                }
                self.accept_state(to, moved, &state);
                self.unstable_modes = modes;
                if modes == 0 {
                    self.go_back();
                }
                Ok(2.0 * width)
            }
            _ if self.solves > MOST_SOLVES => Err(PathEndReason::Solves(MOST_SOLVES)),
            _ if width < SMALLEST_STEP => Err(PathEndReason::NoEquilibrium),
            _ => Ok(0.4 * width),
        }
    }

    /// Returns the state at a load factor extrapolated from the last two states.
    fn predicted(&self, to: f64) -> State {
        let mut state = self.state.clone();
        let (factor, before) = &self.before;
        if self.reached > *factor {
            let part = (to - self.reached) / (self.reached - factor);
            let pairs = self.state.displacement.iter().zip(&before.displacement);
            let increments: Vec<Vector2<f64>> = pairs.map(|(now, before)| (now - before) * part).collect();
            for (u, increment) in state.displacement.overwrite().iter_mut().zip(&increments) {
                *u += increment;
            }
        }
        state
    }

    /// Computes the equilibrium at a load factor by Newton's method with the exact tangent, stable or not; returns the
    /// number of negative eigenvalues of the tangent there.
    fn correct(&mut self, state: &mut State, factor: f64) -> Option<usize> {
        /// Relative residual of an equilibrium.
        const BALANCED: f64 = 1e-9;
        let Self { whole, workspace, forces, .. } = self;
        let system = whole.system().clone();
        whole.supports().put(system.mesh(), factor, Kinematics::Corotated, &mut state.displacement);
        for _ in 0..FEW_ITERATIONS {
            system.follow(state, Kinematics::Corotated);
            whole.linearize(state, forces, Some((Tangent::EXACT, &mut workspace.matrix)));
            whole.add_load_stiffness(state, Tangent::EXACT, factor, &mut workspace.matrix);
            let residual = whole.balance(state, Kinematics::Corotated, factor, forces);
            workspace.tangent = None;
            workspace.factor.factorize_symmetric(workspace.matrix.values());
            if residual <= BALANCED {
                return Some(workspace.factor.negative_eigenvalues());
            }
            system.pattern().restrict(forces.residual(), &mut workspace.free);
            workspace.factor.solve_in_place(&mut workspace.free);
            if !workspace.free.iter().all(|v| v.is_finite()) {
                return None;
            }
            system.pattern().advance(&workspace.free, 1.0, &mut state.displacement);
        }
        None
    }

    /// Solves at a load factor from the current state, with few iterations and a single load step; returns `true` if it
    /// converged.
    fn solve_near(&mut self, factor: f64) -> bool {
        self.solves += 1;
        if self.simulation.change_scene(&part(&self.scene, factor)).is_err() {
            return false;
        }
        let gets_on = |s: &Simulation| *s.status() == Status::Running && s.iterations() < FEW_ITERATIONS;
        let is_in_one_step = |s: &Simulation| s.equilibrium().is_some_and(|search| search.load_steps() == 1);
        while gets_on(&self.simulation) && is_in_one_step(&self.simulation) {
            self.simulation.step();
        }
        *self.simulation.status() == Status::Converged && is_in_one_step(&self.simulation)
    }

    /// Returns the largest distance of a node from its position in the last accepted state, m.
    fn distance(&self, displacement: &[Vector2<f64>]) -> f64 {
        let nodes = displacement.iter().zip(&self.state.displacement);
        nodes.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    }

    fn accept(&mut self, factor: f64, moved: f64) {
        let state = self.simulation.state().clone();
        self.accept_state(factor, moved, &state);
    }

    fn accept_state(&mut self, factor: f64, moved: f64, state: &State) {
        let step = factor - self.reached;
        self.rate = (moved / step).max(f64::MIN_POSITIVE);
        self.before = (self.reached, self.state.clone());
        self.reached = factor;
        self.state.copy_from(state);
        if self.whole.supports().move_the_body() {
            let reactions = self.reactions();
            let power = supports_power(&self.whole, &reactions);
            self.work += 0.5 * step * (self.power + power);
            self.power = power;
        }
    }

    fn go_back(&mut self) {
        // Cannot fail: both were accepted before.
        let _ = self.simulation.change_scene(&part(&self.scene, self.reached));
        let _ = self.simulation.restore(&self.state);
    }

    /// Returns the last accepted state.
    fn seen(&mut self) -> PathState {
        let probes = self.whole.probes().iter().map(|p| p.mean(&self.state.displacement)).collect();
        let stable = if self.unstable_modes > 0 {
            Some(false)
        } else if self.whole.supports().move_the_body() {
            let Self { whole, workspace, forces, state, .. } = self;
            support_stiffness(whole, state, self.reached, forces, workspace).map(|stiffness| stiffness > 0.0)
        } else {
            Some(true)
        };
        PathState { factor: self.reached, probes, reactions: self.reactions(), stable }
    }

    fn reactions(&mut self) -> Vec<SupportReaction> {
        use Kinematics::Corotated;
        self.whole.linearize(&self.state, &mut self.forces, None);
        self.whole.balance(&self.state, Corotated, self.reached, &mut self.forces);
        crate::simulation::support_reactions(&self.whole, &self.state, Corotated, &self.forces)
    }
}

/// Returns the scene with its loads and prescribed displacements times `factor`.
fn part(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.scale_loads(factor);
    scene
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
