//! The march in time: one time step a step.

use nalgebra::Vector2;

use super::{Body, SimulationError, Status};
use crate::assembly::{Change, Forces, Kinematics, Mass, Problem};
use crate::dynamics::{
    Booking, Counts, Inertia, IntegratorEntry, Ledger, LinearTheory, Memory, Momentum, MotionDecision, MotionReport,
    Solves, StageSolver, Step, StepError, StopReason, critical_step,
};
use crate::method::MotionMethod;
use crate::scene::{DynamicsSettings, Load, MethodKind, Scene, Start};
use crate::state::{State, largest};
use crate::timings::Timings;

/// Halvings of a step before the motion is given up.
const MOST_HALVINGS: u32 = 10;
/// Sizes of the body that it may go away: beyond, its strains have lost half of their digits.
const FARTHEST: f64 = 1e6;
/// A fraction of a step that is rounding of the time.
const NO_TIME: f64 = 1e-6;
/// Of the energy of a body and of the work on it, a step that adds more has failed.
const MOST_ADDED: f64 = 0.25;
/// A body whose points all move by less than this fraction of its size a second …
const UNSEEN: f64 = 1e-6;
/// … for so long, s, and as many steps, is at rest.
const QUIET: f64 = 0.5;
const QUIET_STEPS: u32 = 10;

/// A body in motion.
#[derive(Debug)]
pub struct Motion {
    mass: Mass,
    memory: Memory,
    start: State,
    middle: State,
    counts: Counts,
    method: MotionMethod,
    linear: LinearTheory,
    report: MotionReport,
    ledger: Ledger,
    keeps_ledger: bool,
    /// Steps are checked for energy that comes from nowhere. A hand pulls harder on few nodes than loads do: a step that
    /// solves its stages once can then be far off.
    is_guarded: bool,
    stopped: Option<StopReason>,
    /// Steps in a row in which nothing has been seen to move.
    quiet_steps: u32,
    critical_step: Option<f64>,
    timings: Timings,
    last_step: Timings,
}

/// A motion at an instant: its state, energies and counts. [`super::Simulation::return_to`] goes back to it.
#[derive(Clone, Debug)]
pub struct Moment {
    state: State,
    ledger: Ledger,
    counts: Counts,
    report: MotionReport,
    is_linear: bool,
    method: MethodKind,
}

impl Moment {
    pub(super) fn of(motion: &Motion, Body { state, scene, .. }: &Body) -> Self {
        let Motion { ledger, counts, report, linear, .. } = motion;
        let (ledger, counts, report) = (*ledger, *counts, *report);
        let (is_linear, method) = (linear.is_in_use(), scene.solver.method);
        Self { state: state.clone(), ledger, counts, report, is_linear, method }
    }

    /// Becomes another moment of the same body, without allocating.
    pub(super) fn copy_from(&mut self, motion: &Motion, Body { state, scene, .. }: &Body) {
        self.state.copy_from(state);
        self.method = scene.solver.method;
        (self.ledger, self.counts, self.report) = (motion.ledger, motion.counts, motion.report);
        self.is_linear = motion.linear.is_in_use();
    }

    /// State of the body.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Energy ledger up to this moment.
    #[must_use]
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Memory that it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.state.bytes()
    }
}

impl Motion {
    /// One that begins where the body is, with the velocity it has.
    pub(super) fn new(body: &mut Body) -> Result<Self, SimulationError> {
        let Body { scene, problem, state } = body;
        let method = scene.solver.method.entry().in_motion()?;
        let mass = Mass::new(problem.system(), scene.material.area_density());
        let mut motion = Self {
            memory: Memory::new(problem.system())?,
            start: state.clone(),
            middle: state.clone(),
            counts: Counts::default(),
            method,
            linear: LinearTheory::default(),
            report: MotionReport::default(),
            ledger: Ledger::default(),
            keeps_ledger: true,
            is_guarded: false,
            stopped: None,
            quiet_steps: 0,
            critical_step: None,
            timings: Timings::default(),
            last_step: Timings::default(),
            mass,
        };
        motion.begin(body);
        Ok(motion)
    }

    /// Begins where the body is, with the velocity it has.
    pub(super) fn begin(&mut self, body: &mut Body) {
        self.linear.forget();
        body.problem.system().follow(&mut body.state, self.kinematics());
        self.begin_steps(body);
        let Body { scene, problem, state } = body;
        self.counts = Counts::default();
        self.report = MotionReport::default();
        self.ledger = Ledger::open(problem, &self.mass, inertia(scene), state);
        self.find_critical_step(scene, problem);
    }

    /// Goes back to a moment, with the energies and counts of then. The next step is as after [`Self::begin`].
    pub(super) fn return_to(&mut self, body: &mut Body, moment: &Moment) {
        let Moment { state, ledger, counts, report, is_linear, method } = moment;
        body.state.copy_from(state);
        self.linear.forget();
        self.linear.set_in_use(*is_linear);
        // Rotations of edges that are found again differ by rounding.
        if *method != body.scene.solver.method {
            body.problem.system().follow(&mut body.state, self.kinematics());
        }
        self.begin_steps(body);
        (self.ledger, self.counts, self.report) = (*ledger, *counts, *report);
    }

    /// Forgets how the body came to where it is.
    fn begin_steps(&mut self, body: &mut Body) {
        let Body { problem, state, .. } = body;
        // What came before must not be seen in what comes.
        self.memory.corrector.forget();
        self.memory.residual = 0.0;
        problem.set_time(state.time);
        self.stopped = None;
        self.quiet_steps = 0;
        self.is_guarded = problem.hand().is_some();
        self.timings = Timings::default();
        self.last_step = Timings::default();
    }

    /// Goes on after an edit; `before` is the scene that was. Position and velocity are kept.
    pub(super) fn edit(&mut self, body: &mut Body, before: &Scene, change: Change) -> Result<(), SimulationError> {
        let Body { scene, problem, state } = body;
        self.method = scene.solver.method.entry().in_motion()?;
        let mass_changes = scene.material.area_density() != before.material.area_density();
        if change == Change::Unknowns {
            self.memory = Memory::new(problem.system())?;
            self.linear.forget_system();
        }
        if change == Change::Unknowns || mass_changes {
            self.mass = Mass::new(problem.system(), scene.material.area_density());
        }
        self.memory.corrector.forget();
        self.linear.forget();
        let fixed_stay = problem.system().pattern().are_fixed_at_rest(&state.displacement);
        if !(fixed_stay && state.is_finite()) {
            start(scene, problem, &self.mass, state);
            self.begin(body);
            return Ok(());
        }
        problem.system().pattern().stop_fixed(&mut state.velocity);
        problem.system().follow(state, self.kinematics());
        problem.set_time(state.time);
        state.knows_net_force = false;
        self.stopped = None;
        self.quiet_steps = 0;
        if inertia(scene) == inertia(before) {
            self.ledger.edit(problem, &self.mass, inertia(scene), state);
        } else {
            self.ledger = Ledger::open(problem, &self.mass, inertia(scene), state);
        }
        if change >= Change::Stiffness || mass_changes || scene.dynamics != before.dynamics {
            self.find_critical_step(scene, problem);
        }
        Ok(())
    }

    /// Back to the start of the scene.
    pub(super) fn reset(&mut self, body: &mut Body) {
        start(&body.scene, &body.problem, &self.mass, &mut body.state);
        self.begin(body);
    }

    fn find_critical_step(&mut self, scene: &Scene, problem: &Problem) {
        self.critical_step =
            if entry(scene).is_explicit() { critical_step(problem, &self.mass, scene.dynamics.damping) } else { None };
    }

    /// A time step; one that fails is taken in halves. Nothing once the motion has been given up.
    pub(super) fn step(&mut self, body: &mut Body) {
        if self.stopped.is_some() {
            return;
        }
        let (whole, end) = next_step(&body.scene.dynamics, body.state.time);
        self.last_step = Timings::default();
        let (mut halvings, mut left) = (0, 1_u32);
        let factorizations = self.counts.factorizations;
        while left > 0 {
            self.start.copy_from(&body.state);
            let part = whole / f64::from(1_u32 << halvings);
            match self.take_step(body, part).and_then(|booking| self.book(&booking, body)) {
                Ok(()) => left -= 1,
                Err(error) => {
                    body.state.copy_from(&self.start);
                    // Beyond its critical step an explicit scheme is to be seen to fail; a hand must not make it fail.
                    let gives_up = entry(&body.scene).is_explicit() && !self.is_guarded;
                    if halvings == MOST_HALVINGS || gives_up {
                        self.stopped = Some(self.reason(error, part));
                        break;
                    }
                    self.counts.halvings += 1;
                    halvings += 1;
                    left *= 2;
                }
            }
        }
        if left == 0 {
            // Sums of parts round; the steps' own times do not.
            body.state.time = end;
            self.counts.steps += 1;
            let still = largest(&body.state.velocity) < UNSEEN * body.problem.system().size();
            self.quiet_steps = if still { self.quiet_steps.saturating_add(1) } else { 0 };
            self.report.note(match self.counts.factorizations > factorizations {
                _ if self.linear.is_in_use() => MotionDecision::Linear,
                true => MotionDecision::NewFactor,
                false => MotionDecision::OldFactor,
            });
            if largest(&body.state.displacement) > FARTHEST * body.problem.system().size() {
                self.stopped = Some(StopReason::RanAway(FARTHEST));
            }
        }
        self.timings.add(&self.last_step);
    }

    /// Enters a step into the books; fails where they show that it has failed.
    fn book(&mut self, booking: &Booking, body: &Body) -> Result<(), StepError> {
        if self.keeps_books() {
            let (Body { scene, problem, state }, mut ledger) = (body, self.ledger);
            ledger.book(booking, problem, &self.mass, inertia(scene), state);
            if self.is_guarded && ledger.has_gained_since(&self.ledger, MOST_ADDED) {
                return Err(StepError::AddedEnergy);
            }
            self.ledger = ledger;
        }
        Ok(())
    }

    fn keeps_books(&self) -> bool {
        self.keeps_ledger || self.is_guarded
    }

    /// A step of h; `auto` takes it under linear theory where that serves.
    fn take_step(&mut self, body: &mut Body, h: f64) -> Result<Booking, StepError> {
        let asked = asked_error(&body.scene);
        let decides = self.decides(&body.scene);
        if decides && body.problem.hand().is_none() && self.linear.is_worth_a_try(&body.state, asked) {
            let was_in_use = self.linear.is_in_use();
            if !was_in_use {
                self.see(body, Kinematics::Linear);
            }
            if let Ok(booking) = self.try_step(body, Kinematics::Linear, h)
                && self.linear.accepts(&body.problem, &self.mass, [&self.start, &body.state], h, asked)?
            {
                if !was_in_use && self.keeps_books() {
                    self.ledger.change_theory(&body.problem, &self.mass, inertia(&body.scene), &self.start);
                }
                return Ok(booking);
            }
            body.state.copy_from(&self.start);
            self.linear.leave();
            self.see(body, Kinematics::Corotated);
            if was_in_use && self.keeps_books() {
                self.ledger.change_theory(&body.problem, &self.mass, inertia(&body.scene), &self.start);
            }
        } else if self.linear.is_in_use() {
            self.linear.leave();
            self.see(body, Kinematics::Corotated);
            if self.keeps_books() {
                self.ledger.change_theory(&body.problem, &self.mass, inertia(&body.scene), &self.start);
            }
        }
        self.try_step(body, self.kinematics(), h)
    }

    /// Sees the start of a step under another theory.
    fn see(&mut self, body: &mut Body, kinematics: Kinematics) {
        body.problem.system().follow(&mut body.state, kinematics);
        body.state.knows_net_force = false;
        self.start.copy_from(&body.state);
    }

    fn try_step(&mut self, body: &mut Body, kinematics: Kinematics, h: f64) -> Result<Booking, StepError> {
        let books = self.keeps_books();
        let Body { scene, problem, state } = body;
        let settings = &scene.dynamics;
        let solves = match settings.iterations {
            0 => Solves::Tolerance(scene.solver.tolerance),
            n => Solves::Times(n),
        };
        let mut step = Step {
            solver: StageSolver {
                problem,
                mass: &self.mass,
                damping: settings.damping,
                method: self.method,
                kinematics,
                solves,
                max_error: asked_error(scene),
                tolerance: scene.solver.tolerance,
                memory: &mut self.memory,
                counts: &mut self.counts,
                timings: &mut self.last_step,
            },
            h,
            start: &self.start,
            state,
            middle: &mut self.middle,
            books,
        };
        (settings.integrator.entry().step)(&mut step)
    }

    fn reason(&self, error: StepError, part: f64) -> StopReason {
        match self.critical_step {
            Some(critical) => StopReason::Exploded { step: part, critical },
            None => StopReason::Step { step: part, error },
        }
    }

    fn kinematics(&self) -> Kinematics {
        let linear = self.method == MotionMethod::Linear || self.linear.is_in_use();
        if linear { Kinematics::Linear } else { Kinematics::Corotated }
    }

    /// `true` if the method decides how steps are solved.
    fn decides(&self, scene: &Scene) -> bool {
        self.method == MotionMethod::Adaptive && !entry(scene).is_explicit()
    }

    /// Ends a motion that has not come to its end.
    pub(super) fn stop(&mut self, body: &Body) {
        if self.status(&body.scene, &body.state) == Status::Running {
            self.stopped = Some(StopReason::Interrupted);
        }
    }

    /// Whether strains are those of linear theory.
    pub(super) fn is_linear(&self) -> bool {
        self.kinematics() == Kinematics::Linear
    }

    pub(super) fn status(&self, scene: &Scene, state: &State) -> Status {
        let settings = &scene.dynamics;
        match &self.stopped {
            Some(reason) => Status::Stopped(*reason),
            None if state.time >= settings.duration => Status::Finished,
            None => Status::Running,
        }
    }

    /// Whether nothing has moved for a while, and nothing will unless somebody does something.
    pub(super) fn is_at_rest(&self, scene: &Scene, state: &State) -> bool {
        let quiet = f64::from(self.quiet_steps) * scene.dynamics.time_step;
        let pulses_are_over = scene.loads.iter().filter_map(Load::pulse).all(|p| p.start + p.duration <= state.time);
        self.quiet_steps >= QUIET_STEPS && quiet >= QUIET && pulses_are_over
    }

    /// A hand has taken hold, moved or let go.
    pub(super) fn pulled(&mut self, body: &Body) {
        if !self.keeps_books() {
            self.ledger = Ledger::open(&body.problem, &self.mass, inertia(&body.scene), &body.state);
        }
        self.is_guarded = true;
        self.quiet_steps = 0;
        self.memory.corrector.matrix_changes();
    }

    /// What the last stage has left unsolved, over the largest of its forces.
    pub(super) fn residual(&self) -> f64 {
        self.memory.residual
    }

    pub(super) fn forces(&self) -> &Forces {
        &self.memory.forces
    }

    pub(super) fn timings(&self) -> &Timings {
        &self.timings
    }

    pub(super) fn last_step(&self) -> &Timings {
        &self.last_step
    }

    pub(super) fn keep_ledger(&mut self, keep: bool, body: &Body) {
        if keep && !self.keeps_ledger {
            self.ledger = Ledger::open(&body.problem, &self.mass, inertia(&body.scene), &body.state);
        }
        self.keeps_ledger = keep;
    }

    pub(super) fn momentum(&self, body: &Body) -> Momentum {
        Momentum::of(&body.problem, &self.mass, inertia(&body.scene), &body.state)
    }

    /// Where the energy has gone since the start.
    #[must_use]
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Steps and solves since the start.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What `auto` has decided since the start; `None` for other methods, and for integrators that solve nothing.
    #[must_use]
    pub fn auto_report(&self, scene: &Scene) -> Option<MotionReport> {
        let Counts { solves, factorizations, .. } = self.counts;
        self.decides(scene).then_some(MotionReport { solves, factorizations, ..self.report })
    }

    /// The longest stable step about rest, s; `None` for an integrator that has no such limit.
    #[must_use]
    pub fn critical_step(&self) -> Option<f64> {
        self.critical_step
    }
}

/// Length of the step that begins at a time, s, and the time it ends at: the step that reaches the duration ends there.
fn next_step(settings: &DynamicsSettings, time: f64) -> (f64, f64) {
    let DynamicsSettings { time_step, duration, .. } = *settings;
    if time < duration && time + time_step > duration - NO_TIME * time_step {
        (duration - time, duration)
    } else {
        (time_step, time + time_step)
    }
}

fn entry(scene: &Scene) -> &'static IntegratorEntry {
    scene.dynamics.integrator.entry()
}

/// The error asked of a motion, as a fraction.
fn asked_error(scene: &Scene) -> f64 {
    0.01 * scene.solver.max_error_percent
}

fn inertia(scene: &Scene) -> Inertia {
    entry(scene).inertia
}

/// Puts a body at rest and gives it the velocity a scene starts with.
fn start(scene: &Scene, problem: &Problem, mass: &Mass, state: &mut State) {
    state.reset();
    let Start { velocity, spin } = scene.start;
    let nodes = problem.system().mesh().nodes();
    let centre = nodes.iter().zip(mass.lumped()).map(|(x, m)| x * *m).sum::<Vector2<f64>>() / mass.total();
    for (v, x) in state.velocity.iter_mut().zip(nodes) {
        let arm = x - centre;
        *v = Vector2::from(velocity) + Vector2::new(-arm.y, arm.x) * spin;
    }
    problem.system().pattern().stop_fixed(&mut state.velocity);
}

/// The state a scene starts with.
pub(super) fn start_of(scene: &Scene, problem: &Problem) -> State {
    let mut state = problem.system().at_rest();
    if scene.start != Start::default() {
        start(scene, problem, &Mass::new(problem.system(), scene.material.area_density()), &mut state);
    }
    state
}
