//! A large body, made and solved in a thread of its own: what is asked for, and what comes back.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::app::language::{fill, tr, translated};
use crate::app::session::quality::Quality;
use crate::app::task::thread::{Job, Line};
use crate::assembly::System;
use crate::render::display_geometry::Drawing;
use crate::scene::{Analysis, MethodKind, Scene, SolverSettings};
use crate::simulation::{Simulation, SimulationError, Status};
use crate::state::State;
use crate::words::grouped;

/// From one picture to the next while a body is solved.
const PICTURE: Duration = Duration::from_millis(100);

/// Residuals that are kept for the way down.
const MOST_RESIDUALS: usize = 400;

/// A body, and the same under linear theory on the same equations; `None` where that could not be set up.
#[derive(Debug)]
pub(crate) struct Bodies {
    pub simulation: Simulation,
    pub linear: Option<Simulation>,
}

impl Bodies {
    /// Copies to look at; `None` of a motion.
    pub(crate) fn snapshot(&self) -> Option<Self> {
        let linear = self.linear.as_ref().and_then(Simulation::snapshot);
        Some(Self { simulation: self.simulation.snapshot()?, linear })
    }
}

/// Where a solve begins.
#[derive(Debug, Default)]
pub(crate) enum Start {
    /// Where the body is.
    #[default]
    There,
    AtRest,
    /// In this state.
    From(State),
}

/// What is asked for.
#[derive(Debug)]
pub(crate) struct Order {
    pub scene: Scene,
    /// What goes on, with its drawing where that has not been shown yet; `None`: a new body is meshed.
    pub bodies: Option<(Bodies, Option<Drawing>)>,
    pub start: Start,
    /// Iterations at most; `None`: to the end.
    pub iterations: Option<u32>,
    /// Those before.
    pub residuals: Vec<f64>,
}

/// What there is to see at an instant.
#[derive(Debug)]
pub(crate) struct Picture {
    pub bodies: Bodies,
    /// Of the mesh, where that is another one than before.
    pub drawing: Option<Drawing>,
    pub residuals: Vec<f64>,
}

/// What is done at present.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Doing {
    Meshes,
    SolvesLinear,
    Iterates(u32),
    Certifies,
}

/// What is said on the way.
#[derive(Debug)]
pub(crate) enum News {
    Doing(Doing),
    Picture(Box<Picture>),
}

/// The end: the body itself, not a copy.
#[derive(Debug)]
pub(crate) struct Done {
    pub picture: Picture,
    /// Of a body that has come to its end.
    pub quality: Option<Quality>,
}

/// Why there is no such body; what there was is as it was.
#[derive(Debug)]
pub(crate) struct Refused {
    pub error: SimulationError,
    pub bodies: Option<(Bodies, Option<Drawing>)>,
}

pub(crate) type Ended = Result<Box<Done>, Box<Refused>>;

/// An order that is carried out.
#[derive(Debug)]
pub(crate) struct Errand {
    pub job: Job<News, Ended>,
    /// The scene that was asked for.
    pub given: Scene,
    /// Whether a new body is meshed.
    pub is_new: bool,
    pub doing: Doing,
    /// Whether nobody wants it any more.
    pub is_cancelled: bool,
}

impl Errand {
    /// Sends somebody.
    ///
    /// # Errors
    /// There is no thread.
    pub(crate) fn start(order: Order) -> std::io::Result<Self> {
        let (given, is_new) = (order.scene.clone(), order.bodies.is_none());
        let doing = if is_new { Doing::Meshes } else { Doing::Iterates(0) };
        let job = Job::start("errand", move |line| work(order, line))?;
        Ok(Self { job, given, is_new, doing, is_cancelled: false })
    }

    /// What is done at present, in words.
    pub(crate) fn words(&self) -> String {
        let body = body_words(&self.given);
        match self.doing {
            Doing::Meshes => fill!("Meshing %{body}", body = body),
            Doing::SolvesLinear => fill!("Factorizing %{body}", body = body),
            Doing::Iterates(0) => fill!("Solving %{body}", body = body),
            Doing::Iterates(n) => fill!("Solving %{body}, iteration %{n}", body = body, n = n),
            Doing::Certifies => fill!("Certifying %{body}", body = body),
        }
    }
}

/// `500,000 triangles`.
fn body_words(scene: &Scene) -> String {
    let cell = scene.element().entry().cell;
    match (&scene.beam, &scene.mesh) {
        (Some(beam), _) => {
            let cells = beam.cells.iter().map(|&n| u64::from(n)).product::<u64>();
            // A triangle is half a cell of a beam.
            let pieces = if cell.corners.len() == 3 { 2 } else { 1 };
            translated(&format!("{} {}s", grouped(pieces * cells), cell.name))
        }
        (None, Some(mesh)) => mesh.file.clone(),
        (None, None) => tr("the body").to_owned(),
    }
}

/// Notes the residual of an iteration; a new search begins a new list.
pub(crate) fn note_residual(simulation: &Simulation, residuals: &mut Vec<f64>) {
    if simulation.iterations() <= 1 || residuals.len() >= MOST_RESIDUALS {
        residuals.clear();
    }
    residuals.push(simulation.residual());
}

/// A scene under linear theory.
fn linear_scene(scene: &Scene) -> Scene {
    let solver = SolverSettings { method: MethodKind::Linear, ..scene.solver.clone() };
    Scene { solver, ..scene.clone() }
}

/// Linear theory's body of a scene, solved; `known` is that of the scene before.
pub(crate) fn solve_linear(scene: &Scene, system: &Arc<System>, known: Option<Simulation>) -> Option<Simulation> {
    if scene.analysis == Analysis::Dynamic {
        return None;
    }
    let scene = linear_scene(scene);
    // On the body's own equations: nothing of them is made twice.
    let mut shared = known.filter(|linear| Arc::ptr_eq(linear.system(), system));
    shared = shared.and_then(|mut linear| linear.change_scene(&scene).is_ok().then_some(linear));
    let mut linear = shared.or_else(|| Simulation::with_system(&scene, system.clone()).ok())?;
    linear.solve();
    Some(linear)
}

fn work(order: Order, line: &Line<News, Ended>) -> Ended {
    let Order { scene, bodies, start, iterations, mut residuals } = order;
    let (mut bodies, mut drawing) = match bodies {
        Some((mut bodies, drawing)) => {
            if bodies.simulation.scene() != &scene
                && let Err(error) = bodies.simulation.change_scene(&scene)
            {
                return Err(Box::new(Refused { error, bodies: Some((bodies, drawing)) }));
            }
            (bodies, drawing)
        }
        None => {
            let made = Simulation::new(&scene).map_err(|error| Box::new(Refused { error, bodies: None }))?;
            let drawing = Drawing::new(made.system().mesh());
            // Smooth fields need it, which are going to be looked at.
            let _ = made.system().recovery();
            (Bodies { simulation: made, linear: None }, Some(drawing))
        }
    };
    match start {
        Start::There => {}
        Start::AtRest => bodies.simulation.reset(),
        // A state of another body is not put on this one.
        Start::From(state) => _ = bodies.simulation.restore(&state),
    }
    if bodies.linear.as_ref().is_none_or(|linear| *linear.scene() != linear_scene(&scene)) {
        let known = bodies.linear.take();
        if line.say(News::Doing(Doing::SolvesLinear)).is_continue() {
            bodies.linear = solve_linear(&scene, bodies.simulation.system(), known);
        }
    }
    solve(&mut bodies, &mut drawing, (iterations, &mut residuals), line);
    let mut quality = None;
    let ended = bodies.simulation.motion().is_none() && *bodies.simulation.status() != Status::Running;
    if ended && line.say(News::Doing(Doing::Certifies)).is_continue() {
        bodies.simulation.certify();
        let mut own = Quality::default();
        own.follow(&bodies.simulation);
        quality = Some(own);
    }
    Ok(Box::new(Done { picture: Picture { bodies, drawing, residuals }, quality }))
}

/// Iterates to the end, or until it is called off; there is a picture of it now and then.
fn solve(
    bodies: &mut Bodies,
    drawing: &mut Option<Drawing>,
    (most, residuals): (Option<u32>, &mut Vec<f64>),
    line: &Line<News, Ended>,
) {
    if bodies.simulation.motion().is_some() {
        return;
    }
    let (mut made, mut shown) = (0, None::<Instant>);
    while *bodies.simulation.status() == Status::Running && most.is_none_or(|most| made < most) {
        if line.say(News::Doing(Doing::Iterates(bodies.simulation.iterations()))).is_break() {
            return;
        }
        bodies.simulation.step();
        note_residual(&bodies.simulation, residuals);
        made += 1;
        if shown.is_none_or(|shown| shown.elapsed() >= PICTURE)
            && let Some(bodies) = bodies.snapshot()
        {
            let picture = Picture { bodies, drawing: drawing.take(), residuals: residuals.clone() };
            let _ = line.say(News::Picture(Box::new(picture)));
            shown = Some(Instant::now());
        }
    }
}
