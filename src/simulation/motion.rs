//! Motion: time stepping of a scene.

use nalgebra::Vector2;

use super::{Body, SimulationError, Status};
use crate::assembly::{Change, Forces, Kinematics, Mass, Problem};
use crate::dynamics::{
    Counts, IntegratorEntry, Ledger, LinearTheory, Memory, Solves, StageSolver, Step, StepEnergy, StepError,
    StopReason, critical_step,
};
use crate::element::StrainRate;
use crate::method::Decision;
use crate::scene::{DynamicsSettings, Load, MethodKind, Scene, Start};
use crate::section::{MotionBalance, NodalBalance};
use crate::state::{State, largest};
use crate::timings::Timings;

/// Largest number of halvings of a step before the motion stops.
const MAX_HALVINGS: u32 = 10;
/// Number of halvings of a step beyond which a grab that pulls too hard slips.
const FIRM: u32 = 2;
/// Largest displacement, in sizes of the body; beyond, strains have lost half of their digits.
const FARTHEST: f64 = 1e6;
/// Fraction of a step that counts as rounding error of the time.
const NO_TIME: f64 = 1e-6;
/// Largest energy added by a step, relative to the energy of the body and the work on it; a step that adds more has
/// failed.
const MAX_ADDED: f64 = 0.25;
/// Largest relative residual of a stage while a mouse spring is attached.
const GRABBED: f64 = 1e-6;
/// Speed below which a node counts as at rest, body sizes per second.
const UNSEEN: f64 = 1e-6;
/// Duration, s, for which all nodes must be at rest; also at least [`QUIET_STEPS`] steps.
const QUIET: f64 = 0.5;
const QUIET_STEPS: u32 = 10;

/// Time stepping of a body: work memory, energies and counts.
#[derive(Debug)]
pub(super) struct TimeStepping {
    pub(super) mass: Mass,
    pub(super) memory: Memory,
    start: State,
    middle: State,
    pub(super) counts: Counts,
    method: MethodKind,
    linear: LinearTheory,
    /// Kind of the last step.
    pub(super) decision: Decision,
    pub(super) ledger: Ledger,
    keeps_ledger: bool,
    /// `true` if steps are checked for spurious energy. A mouse spring exerts larger forces on few nodes than loads do,
    /// so that a step with a single solve per stage can be inaccurate.
    is_guarded: bool,
    /// Number of successive steps in which no node moved.
    quiet_steps: u32,
    pub(super) critical_step: Option<f64>,
}

/// Snapshot of a motion: state, energies and counts. [`Simulation::return_to`](crate::Simulation::return_to) returns to it.
#[derive(Clone, Debug)]
pub struct Moment {
    state: State,
    ledger: Ledger,
    counts: Counts,
    decision: Decision,
    is_linear: bool,
    method: MethodKind,
}

impl Moment {
    pub(super) fn of(motion: &TimeStepping, Body { state, scene, .. }: &Body) -> Self {
        let TimeStepping { ledger, counts, decision, ref linear, .. } = *motion;
        let (is_linear, method) = (linear.in_use, scene.solver.method);
        Self { state: state.clone(), ledger, counts, decision, is_linear, method }
    }

    /// Returns the state of the body.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Returns the energy ledger up to this moment.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Returns the memory used, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.state.bytes()
    }
}

impl TimeStepping {
    /// Returns a motion that starts from the current state and velocity.
    pub(super) fn new(body: &mut Body) -> Result<Self, SimulationError> {
        let Body { scene, problem, state, .. } = body;
        let method = scene.solver.method;
        let mass = Mass::new(problem.system(), scene.material.area_density());
        let mut motion = Self {
            memory: Memory::new(problem.system())?,
            start: state.clone(),
            middle: state.clone(),
            counts: Counts::default(),
            method,
            linear: LinearTheory::default(),
            decision: Decision::default(),
            ledger: Ledger::default(),
            keeps_ledger: true,
            is_guarded: false,
            quiet_steps: 0,
            critical_step: None,
            mass,
        };
        motion.begin(body);
        Ok(motion)
    }

    /// Starts a motion from the current state and velocity.
    pub(super) fn begin(&mut self, body: &mut Body) {
        self.linear.invalidate();
        body.problem.system().update_rotations(&mut body.state, self.kinematics());
        self.begin_steps(body);
        let Body { scene, problem, state, .. } = body;
        (self.counts, self.decision) = Default::default();
        self.ledger = Ledger::open(problem, &self.mass, has_lumped_mass(scene), state);
        self.find_critical_step(scene, problem);
    }

    /// Returns to a moment, with its energies and counts. The next step is as after [`Self::begin`].
    pub(super) fn return_to(&mut self, body: &mut Body, moment: &Moment) {
        let Moment { state, ledger, counts, decision, is_linear, method } = moment;
        body.state.copy_from(state);
        self.linear.invalidate();
        self.linear.in_use = *is_linear;
        // Only for another method: recomputed edge angles differ by rounding errors, and the same steps would not
        // repeat exactly.
        if *method != body.scene.solver.method {
            body.problem.system().update_rotations(&mut body.state, self.kinematics());
        }
        self.begin_steps(body);
        (self.ledger, self.counts, self.decision) = (*ledger, *counts, *decision);
    }

    /// Discards all data of previous steps.
    fn begin_steps(&mut self, body: &mut Body) {
        // Results must not depend on earlier steps.
        self.memory.corrector.invalidate();
        self.memory.residual = 0.0;
        body.problem.set_time(body.state.time);
        self.quiet_steps = 0;
        self.is_guarded = body.problem.mouse_spring().is_some();
        (body.timings, body.last_iteration) = Default::default();
        go_on(body);
    }

    /// Continues after an edit; `before` is the previous scene. Displacement and velocity are kept.
    pub(super) fn edit(&mut self, body: &mut Body, before: &Scene, change: Change) -> Result<(), SimulationError> {
        let Body { scene, problem, state, .. } = body;
        self.method = scene.solver.method;
        let mass_changes = scene.material.area_density() != before.material.area_density();
        if change == Change::Unknowns {
            self.memory = Memory::new(problem.system())?;
            self.linear = LinearTheory::default();
        }
        if change == Change::Unknowns || mass_changes {
            self.mass = Mass::new(problem.system(), scene.material.area_density());
        }
        self.memory.corrector.invalidate();
        self.linear.invalidate();
        let fixed_stay = problem.system().pattern().are_fixed_at_rest(&state.displacement);
        if !(fixed_stay && state.is_finite()) {
            *state = start_of(scene, problem);
            self.begin(body);
            return Ok(());
        }
        problem.system().pattern().stop_fixed(&mut state.velocity);
        problem.system().update_rotations(state, self.kinematics());
        problem.set_time(state.time);
        state.knows_net_force = false;
        self.quiet_steps = 0;
        if has_lumped_mass(scene) == has_lumped_mass(before) {
            self.ledger.edit(problem, &self.mass, has_lumped_mass(scene), state);
        } else {
            self.ledger = Ledger::open(problem, &self.mass, has_lumped_mass(scene), state);
        }
        if change >= Change::Stiffness || mass_changes || scene.dynamics != before.dynamics {
            self.find_critical_step(scene, problem);
        }
        go_on(body);
        Ok(())
    }

    fn find_critical_step(&mut self, scene: &Scene, problem: &Problem) {
        self.critical_step =
            if entry(scene).is_explicit() { critical_step(problem, &self.mass, scene.dynamics.damping) } else { None };
    }

    /// Performs a time step; a failed step is split into halves. Does nothing once the motion has stopped.
    pub(super) fn step(&mut self, body: &mut Body) {
        if matches!(body.status, Status::Stopped(_)) {
            return;
        }
        let (time, &DynamicsSettings { time_step, duration, .. }) = (body.state.time, &body.scene.dynamics);
        // The last step ends exactly at the duration.
        let is_last = time < duration && time + time_step > duration - NO_TIME * time_step;
        let (whole, end) = if is_last { (duration - time, duration) } else { (time_step, time + time_step) };
        body.last_iteration = Timings::default();
        let (mut halvings, mut left) = (0, 1_u32);
        let factorizations = self.counts.factorizations;
        while left > 0 {
            self.start.copy_from(&body.state);
            let part = whole / f64::from(1_u32 << halvings);
            match self.take_step(body, part).and_then(|energies| self.record(&energies, body)) {
                Ok(()) => left -= 1,
                Err(error) => {
                    body.state.copy_from(&self.start);
                    // An explicit scheme beyond its critical step should fail visibly; failures due to a mouse spring
                    // are handled by halving.
                    let gives_up = entry(&body.scene).is_explicit() && !self.is_guarded;
                    if halvings == MAX_HALVINGS || gives_up {
                        body.status = Status::Stopped(match self.critical_step {
                            Some(critical) => StopReason::Exploded { step: part, critical },
                            None => StopReason::Step { step: part, error },
                        });
                        break;
                    }
                    if halvings >= FIRM
                        && let Some(spring) = &mut body.problem.mouse_spring
                    {
                        spring.slip();
                    }
                    self.counts.halvings += 1;
                    halvings += 1;
                    left *= 2;
                }
            }
        }
        if left == 0 {
            // Use the exact end time instead of the rounded sum of the parts.
            body.state.time = end;
            go_on(body);
            self.counts.steps += 1;
            let still = largest(&body.state.velocity) < UNSEEN * body.problem.system().size();
            self.quiet_steps = if still { self.quiet_steps.saturating_add(1) } else { 0 };
            let (decision, steps) = match self.counts.factorizations > factorizations {
                _ if self.kinematics() == Kinematics::Linear => (Decision::Linear, &mut self.counts.linear_steps),
                true => (Decision::NewFactor, &mut self.counts.new_factor_steps),
                false => (Decision::OldFactor, &mut self.counts.old_factor_steps),
            };
            self.decision = decision;
            *steps += 1;
            if largest(&body.state.displacement) > FARTHEST * body.problem.system().size() {
                // A step beyond the critical one, or one that adds energy, explodes.
                body.status = Status::Stopped(match self.critical_step {
                    Some(critical) if whole > critical || self.ledger.has_gained_too_much() => {
                        StopReason::Exploded { step: whole, critical }
                    }
                    _ => StopReason::RanAway(FARTHEST),
                });
            }
        }
        body.timings.add(&body.last_iteration);
    }

    /// Records a step in the ledger; fails if the ledger shows spurious energy.
    fn record(&mut self, energies: &StepEnergy, body: &Body) -> Result<(), StepError> {
        if self.records_energy() {
            let (Body { scene, problem, state, .. }, mut ledger) = (body, self.ledger);
            ledger.record(energies, problem, &self.mass, has_lumped_mass(scene), state);
            if self.is_guarded && ledger.has_gained_since(&self.ledger, MAX_ADDED) {
                return Err(StepError::AddedEnergy);
            }
            self.ledger = ledger;
        }
        Ok(())
    }

    fn records_energy(&self) -> bool {
        self.keeps_ledger || self.is_guarded
    }

    /// Performs a step of length h; `auto` uses linear theory if it is accurate enough.
    fn take_step(&mut self, body: &mut Body, h: f64) -> Result<StepEnergy, StepError> {
        let (asked, was_in_use) = (asked_error(&body.scene), self.linear.in_use);
        let decides = self.decides(&body.scene) && body.problem.mouse_spring().is_none();
        if decides && self.linear.is_worth_a_try(&body.state, asked) {
            if !was_in_use {
                self.change_kinematics(body, Kinematics::Linear);
            }
            if let Ok(energies) = self.try_step(body, Kinematics::Linear, h)
                && self.linear.accepts(&body.problem, &self.mass, [&self.start, &body.state], h, asked)?
            {
                if !was_in_use {
                    self.change_theory(body);
                }
                return Ok(energies);
            }
            body.state.copy_from(&self.start);
        } else if !was_in_use {
            return self.try_step(body, self.kinematics(), h);
        }
        self.linear.in_use = false;
        self.change_kinematics(body, Kinematics::Corotated);
        if was_in_use {
            self.change_theory(body);
        }
        self.try_step(body, self.kinematics(), h)
    }

    /// Records that the step begins with another strain measure than the last one ended with.
    fn change_theory(&mut self, body: &Body) {
        if self.records_energy() {
            self.ledger.change_theory(&body.problem, &self.mass, has_lumped_mass(&body.scene), &self.start);
        }
    }

    /// Recomputes the start of a step with another strain measure.
    fn change_kinematics(&mut self, body: &mut Body, kinematics: Kinematics) {
        body.problem.system().update_rotations(&mut body.state, kinematics);
        body.state.knows_net_force = false;
        self.start.copy_from(&body.state);
    }

    fn try_step(&mut self, body: &mut Body, kinematics: Kinematics, h: f64) -> Result<StepEnergy, StepError> {
        let records_energy = self.records_energy();
        let Body { scene, problem, state, last_iteration, .. } = body;
        let settings = &scene.dynamics;
        let solves = match settings.iterations {
            0 => Solves::Tolerance(scene.solver.tolerance),
            // A single solve leaves a residual where the force of the spring bends at its cap; the work of this
            // residual would be energy that the integrator adds.
            _ if problem.mouse_spring().is_some() => Solves::Tolerance(scene.solver.tolerance.max(GRABBED)),
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
                timings: last_iteration,
            },
            h,
            start: &self.start,
            state,
            middle: &mut self.middle,
            records_energy,
        };
        (settings.integrator.entry().step)(&mut step)
    }

    pub(super) fn kinematics(&self) -> Kinematics {
        let linear = self.method == MethodKind::Linear || self.linear.in_use;
        if linear { Kinematics::Linear } else { Kinematics::Corotated }
    }

    /// Returns `true` if the method is `auto`, which chooses how each step is solved.
    pub(super) fn decides(&self, scene: &Scene) -> bool {
        self.method == MethodKind::Auto && !entry(scene).is_explicit()
    }

    /// Returns `true` if nothing has moved for a while, and no pulse is to come.
    pub(super) fn is_at_rest(&self, Body { scene, state, .. }: &Body) -> bool {
        let quiet = f64::from(self.quiet_steps) * scene.dynamics.time_step;
        let pulses_are_over = scene.loads.iter().filter_map(Load::pulse).all(|pulse| pulse.end() <= state.time);
        self.quiet_steps >= QUIET_STEPS && quiet >= QUIET && pulses_are_over
    }

    /// Updates the motion after a mouse spring was attached, moved or removed.
    pub(super) fn pulled(&mut self, body: &Body) {
        if !self.records_energy() {
            self.ledger = Ledger::open(&body.problem, &self.mass, has_lumped_mass(&body.scene), &body.state);
        }
        self.is_guarded = true;
        self.quiet_steps = 0;
        // The spring adds to the matrix.
        self.memory.corrector.constant = None;
    }

    /// Returns the forces and accelerations of the current state that sections balance, with this force of the mouse
    /// spring, N. Accelerations are those of the nodal forces, not differences of velocities, so that nothing but the state
    /// counts.
    pub(super) fn nodal_balance(&self, body: &Body, mouse_spring: Vector2<f64>) -> NodalBalance<'static> {
        let Body { scene, problem, state, .. } = body;
        let DynamicsSettings { damping, integrator, time_step, .. } = scene.dynamics;
        let (system, mut forces) = (problem.system(), Forces::new(state.displacement.len()));
        problem.linearize(state, &mut forces, None);
        let mut loads = problem.loads().clone();
        loads.set_time(state.time);
        loads.force(system, &state.displacement, self.kinematics(), 1.0, &mut forces.external);
        if let Some(spring) = problem.mouse_spring() {
            spring.add_force(mouse_spring, &mut forces.external);
        }
        // Velocities of integrators of first order are those of half a step before, so that the viscous stress vanishes
        // in rotations only there.
        let before = if integrator.entry().order == 1 { 0.5 * time_step } else { 0.0 };
        let damped: Vec<Vector2<f64>> = match self.kinematics() {
            Kinematics::Corotated => {
                state.displacement.iter().zip(&state.velocity).map(|(u, v)| u - v * before).collect()
            }
            Kinematics::Linear => vec![Vector2::zeros(); state.velocity.len()],
        };
        let viscosity = problem.material().membrane().scaled(damping.stiffness);
        let rate = StrainRate::Velocity(&state.velocity);
        system.elements().viscous_force(viscosity, &damped, rate, &mut forces.internal);
        let mut residual: Vec<Vector2<f64>> =
            forces.external.iter().zip(&forces.internal).map(|(f, i)| f - i).collect();
        let acceleration = self.mass.acceleration(system.pattern(), &residual);
        let mut inertia = forces.internal;
        self.mass.multiply(&acceleration, &mut inertia);
        residual.iter_mut().zip(&inertia).for_each(|(f, inertia)| *f -= inertia);
        let motion = Some(MotionBalance { acceleration, viscosity, damped });
        NodalBalance { load_factor: 1.0, residual: residual.into(), mouse_spring, motion }
    }

    pub(super) fn keep_ledger(&mut self, keep: bool, body: &Body) {
        if keep && !self.keeps_ledger {
            self.ledger = Ledger::open(&body.problem, &self.mass, has_lumped_mass(&body.scene), &body.state);
        }
        self.keeps_ledger = keep;
    }
}

fn entry(scene: &Scene) -> &'static IntegratorEntry {
    scene.dynamics.integrator.entry()
}

/// Returns the error requested for a motion, as a fraction.
fn asked_error(scene: &Scene) -> f64 {
    0.01 * scene.solver.max_error_percent
}

pub(super) fn has_lumped_mass(scene: &Scene) -> bool {
    entry(scene).is_explicit()
}

/// Sets the status of a motion that has not stopped.
fn go_on(Body { scene, state, status, .. }: &mut Body) {
    *status = if state.time >= scene.dynamics.duration { Status::Finished } else { Status::Running };
}

/// Returns the initial state of a scene: at rest, or with its initial velocity.
pub(super) fn start_of(scene: &Scene, problem: &Problem) -> State {
    let (mut state, Start { velocity, spin }) = (problem.system().at_rest(), scene.start);
    if scene.start == Start::default() {
        return state;
    }
    let (mass, nodes) = (Mass::new(problem.system(), scene.material.area_density()), problem.system().mesh().nodes());
    let centre = nodes.iter().zip(&mass.lumped).map(|(x, m)| x * *m).sum::<Vector2<f64>>() / mass.total;
    for (v, x) in state.velocity.iter_mut().zip(nodes) {
        let arm = x - centre;
        *v = Vector2::from(velocity) + Vector2::new(-arm.y, arm.x) * spin;
    }
    problem.system().pattern().stop_fixed(&mut state.velocity);
    state
}
