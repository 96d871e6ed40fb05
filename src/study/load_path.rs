//! The load path of any scene at rest: its equilibria while loads are put on and supports taken on their way together,
//! from nothing to the whole. Each is the one nearest to the one before; where there is none the body jumps.

use nalgebra::Vector2;

use crate::assembly::{Forces, Problem};
use crate::method::{Workspace, support_stiffness};
use crate::scene::{Analysis, MethodKind, Place, Scene};
use crate::simulation::{Simulation, Status, SupportReaction};
use crate::state::{State, largest};
use crate::words::engineering;

/// An equilibrium of the path.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PathState {
    /// Fraction of the scene's loads, and of the way of its supports.
    pub factor: f64,
    /// Displacement of every probe, m.
    pub probes: Vec<Vector2<f64>>,
    /// The reaction of every support.
    pub reactions: Vec<SupportReaction>,
    /// Whether it is stable with the supports that move let go and pushed by their reactions instead: under force
    /// control. Held by them it is stable anyway. `None` where that is not known.
    pub stable: Option<bool>,
}

/// Where the body leaves the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The last fraction of the load with an equilibrium near those before.
    pub factor: f64,
    /// How far some node jumps, m; 0 where no equilibrium was found to jump to.
    pub distance: f64,
}

impl std::fmt::Display for Jump {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.factor >= 1.0 {
            return write!(f, "it jumped: another equilibrium under this load is nearer to rest");
        }
        let percent = engineering(100.0 * self.factor, "%");
        match self.distance {
            0.0 => write!(f, "beyond {percent} of the load no stable equilibrium was found"),
            distance => write!(
                f,
                "it jumped: beyond {percent} of the load the next equilibrium is {} away",
                engineering(distance, "m")
            ),
        }
    }
}

/// The path of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoadPath {
    /// The scene's title.
    pub scene: String,
    /// The equilibria, from no load on.
    pub states: Vec<PathState>,
    /// Where it jumps, the first time.
    pub jump: Option<Jump>,
    /// Number of the first support that moves: the path is drawn over its way. Else over the load.
    pub driven: Option<usize>,
    /// Whether it was followed to its end.
    pub complete: bool,
    /// Displacement at the end, m.
    end: Vec<Vector2<f64>>,
}

/// States of a path that is drawn.
const DRAWN: u32 = 60;
/// States of a path that is followed only to see where it jumps.
const FOLLOWED: u32 = 8;
/// A step of the load factor that is not divided any more.
const SMALLEST_STEP: f64 = 1e-4;
/// A step that moves the body so many times as far as the steps before promised has left the path.
const FARTHER: f64 = 4.0;
/// What is no jump however small the step was: part of the largest displacement. A column that buckles leaves the
/// straight way fast, but without a jump.
const NO_JUMP: f64 = 0.05;
/// Iterations that take a body to the next equilibrium of its path.
const FEW_ITERATIONS: u32 = 20;
/// Iterations that take a body which jumps to where it ends.
const ENOUGH_ITERATIONS: u32 = 500;
/// Solves after which a path is given up.
const MOST_SOLVES: u32 = 300;
/// Unknowns beyond which a path is too dear to be a by-product of a solve.
const MOST_UNKNOWNS: usize = 6000;

impl LoadPath {
    /// The path of a scene; `None` of a motion, of linear theory, and where the scene cannot be simulated.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        Follower::new(scene)?.follow(DRAWN)
    }

    /// The jump on the way to a result of a scene, its displacement in m: `Some(None)` where there was none, `None`
    /// where that is not known.
    #[must_use]
    pub fn jump_before(scene: &Scene, result: &[Vector2<f64>]) -> Option<Option<Jump>> {
        /// Part of the largest displacement that is no other equilibrium.
        const SAME: f64 = 0.02;
        let follower = Follower::new(scene)?;
        if follower.simulation.system().dofs() > MOST_UNKNOWNS
            || result.len() != follower.simulation.displacement().len()
        {
            return None;
        }
        let path = follower.follow(FOLLOWED)?;
        if path.jump.is_some() {
            return Some(path.jump);
        }
        let distance = path.end.iter().zip(result).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        let elsewhere = distance > SAME * largest(result).max(largest(&path.end));
        // Another equilibrium than that of the path was reached by going through a jump of one's own.
        path.complete.then(|| elsewhere.then_some(Jump { factor: 1.0, distance }))
    }

    /// Where a scene's body jumps on its way from rest; `None` where it does not, or that is not known.
    #[must_use]
    pub fn jump_of(scene: &Scene) -> Option<Jump> {
        let follower = Follower::new(scene)?;
        if follower.simulation.system().dofs() > MOST_UNKNOWNS {
            return None;
        }
        follower.follow(FOLLOWED)?.jump
    }

    /// The way of the support that moves at a state: its displacement, m, or its turn, rad, where it only turns; and the
    /// reaction along it, N or N m. `None` where none moves.
    #[must_use]
    pub fn driven_pair(&self, scene: &Scene, state: &PathState) -> Option<[f64; 2]> {
        let (support, reaction) = (scene.supports.get(self.driven?)?, state.reactions.get(self.driven?)?);
        let way = Vector2::from(support.displacement);
        Some(match way.norm() {
            0.0 => [state.factor * support.turn, reaction.moment],
            length => [state.factor * length, reaction.force.dot(&way) / length],
        })
    }
}

/// Follows a path.
struct Follower {
    scene: Scene,
    simulation: Simulation,
    /// The whole scene, of which the path has parts.
    whole: Problem,
    workspace: Workspace,
    forces: Forces,
    reached: f64,
    state: State,
    /// How fast the body moves, m a load factor.
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
        let system = linear.system().clone();
        let whole = Problem::new(&scene, system.clone()).ok()?;
        let workspace = Workspace::new(&system).ok()?;
        let simulation = Simulation::with_system(&part(&scene, 0.0), system).ok()?;
        let (state, forces) = (simulation.state().clone(), Forces::new(simulation.displacement().len()));
        Some(Self { scene, simulation, whole, workspace, forces, reached: 0.0, state, rate, solves: 0 })
    }

    fn follow(mut self, count: u32) -> Option<LoadPath> {
        if *self.simulation.solve() != Status::Converged {
            return None;
        }
        let moves = |s: &crate::scene::Support| s.moves();
        let mut path = LoadPath {
            scene: self.scene.name.clone(),
            states: vec![self.seen()],
            jump: None,
            driven: self.scene.supports.iter().position(moves),
            complete: true,
            end: Vec::new(),
        };
        for i in 1..=count {
            let goal = f64::from(i) / f64::from(count);
            if !self.go(goal, &mut path) {
                path.complete = false;
                break;
            }
            path.states.push(self.seen());
        }
        path.end = self.state.displacement.to_vec();
        Some(path)
    }

    /// Goes on to a load factor; says whether it got there.
    fn go(&mut self, goal: f64, path: &mut LoadPath) -> bool {
        let mut step = goal - self.reached;
        while self.reached < goal {
            // The last part of the way must not be left to rounding.
            let to = if goal - self.reached <= step * (1.0 + 1e-9) { goal } else { self.reached + step };
            let converged = self.solve_near(to);
            let moved = self.distance();
            if converged && moved <= FARTHER * self.rate * (to - self.reached) {
                self.accept(to, moved);
                step *= 2.0;
                continue;
            }
            if self.solves > MOST_SOLVES {
                return false;
            }
            step = 0.4 * (to - self.reached);
            if step >= SMALLEST_STEP {
                self.go_back();
                continue;
            }
            // No near equilibrium: wherever the solve goes is where the body goes.
            let converged = *self.simulation.solve() == Status::Converged;
            let moved = self.distance();
            if !converged {
                path.jump.get_or_insert(Jump { factor: self.reached, distance: 0.0 });
                return false;
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
        true
    }

    /// Solves at a load factor from where the body is, as long as that takes few iterations of one load step; says whether
    /// it did.
    fn solve_near(&mut self, factor: f64) -> bool {
        self.solves += 1;
        if self.simulation.change_scene(&part(&self.scene, factor)).is_err() {
            return false;
        }
        let gets_on = |s: &Simulation| *s.status() == Status::Running && s.iterations() < FEW_ITERATIONS;
        while gets_on(&self.simulation) && self.simulation.load_stepping().1 == 1 {
            self.simulation.step();
        }
        *self.simulation.status() == Status::Converged && self.simulation.load_stepping().1 == 1
    }

    /// How far some node is from the last accepted state, m.
    fn distance(&self) -> f64 {
        let nodes = self.simulation.displacement().iter().zip(&self.state.displacement);
        nodes.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    }

    fn accept(&mut self, factor: f64, moved: f64) {
        self.rate = (moved / (factor - self.reached)).max(f64::MIN_POSITIVE);
        self.reached = factor;
        self.state.copy_from(self.simulation.state());
    }

    fn go_back(&mut self) {
        // Both were accepted before.
        let _ = self.simulation.change_scene(&part(&self.scene, self.reached));
        let _ = self.simulation.restore(&self.state);
    }

    /// The last accepted state.
    fn seen(&mut self) -> PathState {
        let probes = self.whole.probes().iter().map(|p| p.mean(&self.state.displacement)).collect();
        let stable = if self.whole.supports().move_the_body() {
            let Self { whole, workspace, forces, state, .. } = self;
            support_stiffness(whole, state, self.reached, forces, workspace).map(|stiffness| stiffness > 0.0)
        } else {
            Some(true)
        };
        PathState { factor: self.reached, probes, reactions: self.reactions(), stable }
    }

    fn reactions(&mut self) -> Vec<SupportReaction> {
        use crate::assembly::Kinematics::Corotated;
        self.whole.linearize(&self.state, &mut self.forces, None);
        self.whole.balance(&self.state, Corotated, self.reached, &mut self.forces);
        crate::simulation::support_reactions(&self.whole, &self.state, Corotated, &self.forces)
    }
}

/// The scene with a part of its loads, its supports on a part of their way.
fn part(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.scale_loads(factor);
    scene
}

/// What a support is called in words: `support left`, `support (0.1, 0.0085)`.
#[must_use]
pub fn support_words(scene: &Scene, number: usize) -> String {
    scene.supports.get(number).map_or_else(|| "support".to_owned(), |support| format!("support {}", support.place))
}

/// What a support is called in the columns of tables: its edge, or its number.
#[must_use]
pub fn support_name(scene: &Scene, number: usize) -> String {
    match scene.supports.get(number).map(|s| &s.place) {
        Some(Place::Edge(edge)) => edge.clone(),
        _ => format!("support.{number}"),
    }
}
