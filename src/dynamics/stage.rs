//! Implicit stage of a time step.

use nalgebra::Vector2;

use super::correction::{Accuracy, Weights};
use super::step::{Counts, Memory, Solves, StepEnergy, StepError, combine, work};
use crate::assembly::{Kinematics, Mass, MouseSpring, Problem};
use crate::element::{StrainRate, Tangent};
use crate::scene::{Damping, MethodKind};
use crate::solver::SolverError;
use crate::state::State;
use crate::timings::{Timings, timed};

/// Equations f_ext + s − f_int − f_d − α M (u − û) = 0 for the displacement u at the end of a stage; û is stored in
/// [`Memory`].
///
/// The damping velocity is the difference quotient v = β u + Σ cᵢ uᵢ, and f_d = m (a M v + b ∫ F ℂ[Ė] ∇N dA) with the
/// same quotient Ė of Green's strain, so that the stiffness-proportional part does not damp rotations of the body
/// (Rayleigh damping with factors a and b, α and β in [`crate::Damping`]). Here α and β are weights of the stage, and m
/// is a number.
#[derive(Debug)]
pub(super) struct Stage<'a> {
    /// State at the start of the step.
    pub start: &'a State,
    /// α, 1/s².
    pub inertia: f64,
    /// `true` if the iteration starts from the state at the start of the step; `false` from the state in free flight.
    pub from_start: bool,
    /// Start force s, N; `None` for zero.
    pub start_force: Option<&'a [Vector2<f64>]>,
    /// `true` if forces are averages between the start of the step and the end of the stage; `false` if they are those
    /// at its end.
    pub between: bool,
    /// Matrix of the elements that is added to α M.
    pub tangent: Tangent,
    /// β, 1/s.
    pub rate: f64,
    /// cᵢ (1/s) and uᵢ (m).
    pub others: &'a [(f64, &'a [Vector2<f64>])],
    /// `true` if damping acts on the configuration half way between the start of the step and the end of the stage;
    /// `false` at the end.
    pub damps_at_midpoint: bool,
    /// m, factor of the damping force.
    pub damping: f64,
}

/// Largest number of terms of a difference quotient.
const TERMS: usize = 3;
/// Number of solves after which the iteration of a stage fails; usually two to eight suffice.
const MAX_SOLVES: u32 = 30;
/// Relative accuracy of the only correction of a stage, as a fraction of the error requested for the motion.
const ACCURACY: f64 = 0.03;
/// Relative accuracy of a correction that is followed by others, whose residual shows the remaining error.
const ACCURACY_OF_ITERATIONS: f64 = 0.05;
/// Ratio of successive residuals below which no new matrix is needed.
const PROGRESS: f64 = 0.25;
/// Relative rounding error of K u, a lower bound of residuals.
const ROUNDING: f64 = 4e-16;

/// Solver of stages.
#[derive(Debug)]
pub(crate) struct StageSolver<'a> {
    pub problem: &'a mut Problem,
    pub mass: &'a Mass,
    pub damping: Damping,
    pub method: MethodKind,
    pub kinematics: Kinematics,
    pub solves: Solves,
    /// Error requested for the whole motion, as a fraction.
    pub max_error: f64,
    /// Tolerance of the scene's solver, for integrators that always iterate.
    pub tolerance: f64,
    pub memory: &'a mut Memory,
    pub counts: &'a mut Counts,
    pub timings: &'a mut Timings,
}

/// Time step from one state to the next.
#[derive(Debug)]
pub(crate) struct Step<'a> {
    pub solver: StageSolver<'a>,
    /// Length of the step, s.
    pub h: f64,
    /// State at the start.
    pub start: &'a State,
    /// State at the end; initially a copy of `start`.
    pub state: &'a mut State,
    /// Intermediate state, for integrators that need one.
    pub middle: &'a mut State,
    /// `true` if the ledger is kept.
    pub records_energy: bool,
}

impl StageSolver<'_> {
    /// Solves a stage, starting from `state`, whose rotations must be those of its displacement.
    ///
    /// # Errors
    /// [`StepError`]; the state is then invalid.
    pub(super) fn solve(&mut self, stage: &Stage<'_>, state: &mut State) -> Result<(), StepError> {
        let (most, tolerance) = match self.solves {
            Solves::Times(most) => (most, None),
            Solves::Tolerance(tolerance) => (MAX_SOLVES, Some(tolerance)),
        };
        self.memory.corrector.begin_stage();
        let mut before = f64::INFINITY;
        for solves in 0..=most {
            if solves == most && tolerance.is_none() {
                break;
            }
            let tangent = self.tangent(stage);
            // An iteration does not need the current matrix as long as the residual decreases fast.
            let old = solves > 0 && tolerance.is_some() && self.keeps_factors();
            let [residual, scale] = self.linearize(stage, tangent.filter(|_| !old), state);
            if !residual.is_finite() {
                return Err(StepError::NotFinite);
            }
            let floor = self.rounding(state);
            if solves > 0 && residual <= (tolerance.unwrap_or(0.0) * scale).max(floor) {
                break;
            }
            if solves == most {
                return Err(StepError::NotConverged(most));
            }
            let gets_on = old && residual <= PROGRESS * before;
            if old && !gets_on {
                self.linearize(stage, tangent, state);
            }
            before = residual;
            self.correct(stage, tangent, gets_on, state)?;
            self.update_rotations(state);
        }
        Ok(())
    }

    /// Updates rotations and edge angles to those of the displacement.
    pub fn update_rotations(&mut self, state: &mut State) {
        let (system, kinematics) = (self.problem.system(), self.kinematics);
        timed(&mut self.timings.rotate, || system.update_rotations(state, kinematics));
    }

    /// Returns the matrix of the elements that the next solve needs; `None` if a constant matrix is already factorized.
    fn tangent(&self, stage: &Stage<'_>) -> Option<Tangent> {
        let constant = self.constant(stage);
        if let (Some(constant), Some(of)) = (constant, self.memory.corrector.constant)
            && constant.are_about(&of)
        {
            return None;
        }
        let Tangent { warped, geometric, definite } = stage.tangent;
        let turns = self.kinematics == Kinematics::Corotated && self.method != MethodKind::Warped;
        Some(Tangent { warped, geometric: if turns { geometric } else { 0.0 }, definite })
    }

    /// Returns the weights of the matrix if it is constant: with linear theory and without a mouse spring.
    fn constant(&self, stage: &Stage<'_>) -> Option<Weights> {
        let is_constant = self.kinematics == Kinematics::Linear && self.problem.mouse_spring().is_none();
        is_constant.then(|| self.weights(stage))
    }

    /// Returns the weights of mass and stiffness in a stage's matrix.
    fn weights(&self, stage: &Stage<'_>) -> Weights {
        Weights {
            inertia: stage.inertia + stage.damping * self.damping.mass * stage.rate,
            stiffness: stage.tangent.warped + stage.damping * self.damping.stiffness * stage.rate,
        }
    }

    /// Computes the residual force of a state, and the matrix if requested; returns as [`Self::residual`].
    fn linearize(&mut self, stage: &Stage<'_>, tangent: Option<Tangent>, state: &State) -> [f64; 2] {
        let mut timings = std::mem::take(self.timings);
        let residual = timed(&mut timings.linearize, || {
            let forces = self.residual(stage, tangent, state);
            if let Some(tangent) = tangent {
                self.complete_matrix(stage, tangent, state);
            }
            forces
        });
        *self.timings = timings;
        residual
    }

    /// Computes the residual force of a state into the memory's forces, and the elements' matrix if requested. Damping
    /// and the mouse spring are included in the residual only. Returns its norm over the free unknowns, and the largest of
    /// the forces in it, N.
    fn residual(&mut self, stage: &Stage<'_>, tangent: Option<Tangent>, state: &State) -> [f64; 2] {
        let Memory { corrector, forces, free_flight, mean, scratch: [increment, momentum], .. } = &mut *self.memory;
        let (problem, system) = (&*self.problem, self.problem.system());
        let matrix = tangent.map(|tangent| (tangent, &mut corrector.linear.matrix));
        match self.kinematics {
            Kinematics::Corotated if stage.between => problem.linearize_between([stage.start, state], forces, matrix),
            Kinematics::Linear if stage.between => {
                combine(mean.displacement.overwrite(), [(0.5, &stage.start.displacement), (0.5, &state.displacement)]);
                problem.linearize(mean, forces, matrix);
            }
            _ => problem.linearize(state, forces, matrix),
        }
        if stage.between && self.kinematics == Kinematics::Corotated {
            problem.loads().force_between(system, [stage.start, state], &mut forces.external);
        } else {
            problem.loads().force(system, &state.displacement, self.kinematics, 1.0, &mut forces.external);
        }
        let pattern = system.pattern();
        let mut scale = pattern.norm_of_bounds(&forces.magnitude).max(pattern.norm(&forces.external));
        for (i, residual) in forces.residual.iter_mut().enumerate() {
            *residual = forces.external[i] - forces.internal[i] + stage.start_force.map_or(Vector2::zeros(), |s| s[i]);
        }
        combine(increment, [(stage.inertia, &state.displacement), (-stage.inertia, free_flight)]);
        self.mass.multiply(increment, momentum);
        scale = scale.max(pattern.norm(momentum));
        subtract(momentum, &mut forces.residual);
        if self.damping != Damping::default() {
            self.damping_force(stage, state);
            let Memory { forces, damping, .. } = &mut *self.memory;
            scale = scale.max(self.problem.system().pattern().norm(damping));
            subtract(damping, &mut forces.residual);
        }
        let applied = self.applied_mouse_spring_force(stage, state);
        let (problem, forces) = (&*self.problem, &mut self.memory.forces);
        if let Some(spring) = problem.mouse_spring() {
            spring.add_force(applied, &mut forces.residual);
        }
        let norm = problem.system().pattern().norm(&forces.residual);
        self.memory.residual = if scale > 0.0 { norm / scale } else { 0.0 };
        [norm, scale]
    }

    /// Computes f_d into the memory.
    fn damping_force(&mut self, stage: &Stage<'_>, state: &State) {
        let Memory { damping, scratch: [configuration, velocity], .. } = &mut *self.memory;
        let Damping { mass, stiffness, .. } = self.damping;
        let terms = terms(stage, state);
        let terms = &terms[..=stage.others.len()];
        velocity.fill(Vector2::zeros());
        for (c, u) in terms {
            velocity.iter_mut().zip(*u).for_each(|(v, u)| *v += u * *c);
        }
        damping.fill(Vector2::zeros());
        if mass > 0.0 {
            self.mass.multiply(velocity, damping);
            damping.iter_mut().for_each(|f| *f *= stage.damping * mass);
        }
        if stiffness > 0.0 {
            damped_configuration(self.kinematics, stage, state, configuration);
            let rate = match self.kinematics {
                Kinematics::Corotated => StrainRate::Difference(terms),
                Kinematics::Linear => StrainRate::Velocity(velocity),
            };
            let moduli = self.problem.material().membrane().scaled(stage.damping * stiffness);
            self.problem.system().elements().viscous_force(moduli, configuration, rate, damping);
        }
    }

    /// Adds the parts of inertia, damping, moments and mouse spring to the elements' matrix.
    fn complete_matrix(&mut self, stage: &Stage<'_>, tangent: Tangent, state: &State) {
        if self.damping.stiffness > 0.0 {
            let Memory { corrector, scratch: [configuration, _], .. } = &mut *self.memory;
            damped_configuration(self.kinematics, stage, state, configuration);
            let (system, material) = (self.problem.system(), self.problem.material());
            let moduli = material.membrane().scaled(stage.damping * self.damping.stiffness * stage.rate);
            corrector.linear.matrix.sum(|values| {
                system.elements().viscous_matrix(moduli, configuration, system.slots(), values);
            });
        }
        let matrix = &mut self.memory.corrector.linear.matrix;
        let inertia = stage.inertia + stage.damping * self.damping.mass * stage.rate;
        self.mass.add_to(inertia, matrix);
        if tangent.is_exact() {
            let loads = self.problem.loads();
            loads.add_stiffness(self.problem.system(), &state.displacement, tangent.geometric, matrix);
        }
        if let Some(spring) = self.problem.mouse_spring() {
            let (u, v) = held(stage, spring, state);
            // Half way through the stage, the point moves half as far as at the end.
            let share = if stage.between { 0.5 } else { 1.0 };
            spring.add_stiffness(u, v, stage.rate / share, share, matrix);
        }
    }

    /// Factorizes the matrix; if it is not positive definite, a positive definite one is used instead.
    fn factorize(&mut self, stage: &Stage<'_>, tangent: Tangent, state: &State) -> Result<(), StepError> {
        let mut made = self.try_factorize();
        if made.is_err() && tangent.is_exact() {
            self.linearize(stage, Some(Tangent { definite: true, ..tangent }), state);
            made = self.try_factorize();
        }
        self.memory.corrector.constant = if made.is_ok() { self.constant(stage) } else { None };
        Ok(made?)
    }

    fn try_factorize(&mut self) -> Result<(), SolverError> {
        let corrector = &mut self.memory.corrector;
        self.counts.factorizations += 1;
        corrector.linear.factorize(self.timings)
    }

    /// Returns `true` if corrections are computed with factors of earlier matrices (`auto`).
    fn keeps_factors(&self) -> bool {
        self.method == MethodKind::Auto && self.kinematics == Kinematics::Corotated
    }

    /// Performs u ← u + K⁻¹ r, with a factor of K if `tangent` is given, else with the existing factor. The matrix K is
    /// that of the current state, or, if `earlier`, of an earlier solve of the same stage.
    fn correct(
        &mut self,
        stage: &Stage<'_>,
        tangent: Option<Tangent>,
        earlier: bool,
        state: &mut State,
    ) -> Result<(), StepError> {
        let is_corrected = tangent.is_some() && self.correct_with_kept_factor(stage, earlier, state);
        if let Some(tangent) = tangent
            && !is_corrected
        {
            if earlier {
                self.linearize(stage, Some(tangent), state);
            }
            self.factorize(stage, tangent, state)?;
            if self.method == MethodKind::Auto {
                let weights = self.weights(stage);
                self.memory.corrector.keep(weights, self.problem.system(), state);
            }
        }
        let Memory { corrector, forces, .. } = &mut *self.memory;
        let (linear, pattern) = (&mut corrector.linear, self.problem.system().pattern());
        if !is_corrected {
            self.counts.solves += 1;
            linear.solve(pattern, &forces.residual, self.timings).map_err(|_| StepError::NotFinite)?;
        }
        linear.advance(pattern, &mut state.displacement, self.timings);
        Ok(())
    }

    /// Tries to compute the correction with the factor of an earlier matrix; returns `true` if that succeeded.
    fn correct_with_kept_factor(&mut self, stage: &Stage<'_>, earlier: bool, state: &State) -> bool {
        if !self.keeps_factors() {
            return false;
        }
        let accuracy = match self.solves {
            Solves::Times(_) => ACCURACY * self.max_error,
            Solves::Tolerance(_) => ACCURACY_OF_ITERATIONS,
        };
        let accuracy = Accuracy { relative: accuracy, is_checked: earlier };
        let (weights, system) = (self.weights(stage), self.problem.system());
        let Memory { corrector, forces, free_flight, scratch: [flight, _], .. } = &mut *self.memory;
        combine(flight, [(1.0, free_flight), (-1.0, &state.displacement)]);
        let guess = stage.from_start.then_some(flight.as_slice());
        let force = &forces.residual;
        let (solves, done) = timed(&mut self.timings.solve, || {
            corrector.correct_with_kept(force, weights, accuracy, guess, system, state)
        });
        self.counts.solves += u64::from(solves);
        done
    }

    /// Stores the force f_ext − f_int that accelerates a body, without pulses and mouse spring, in `result.net_force`.
    pub fn measure_net_force(&mut self, state: &State, result: &mut State) {
        self.problem.set_pulses(&|_| 0.0);
        let (problem, forces) = (&*self.problem, &mut self.memory.forces);
        timed(&mut self.timings.linearize, || {
            problem.linearize(state, forces, None);
            problem.loads().force(problem.system(), &state.displacement, self.kinematics, 1.0, &mut forces.external);
            combine(&mut result.net_force, [(1.0, &forces.external), (-1.0, &forces.internal)]);
        });
        result.knows_net_force = true;
    }

    /// Stores the same force as it results from the stage's equations at its end: α M (u − û) + f_d without mouse
    /// spring and pulses.
    pub(super) fn keep_net_force(&mut self, stage: &Stage<'_>, state: &mut State) {
        let Memory { free_flight, scratch: [increment, _], .. } = &mut *self.memory;
        combine(increment, [(stage.inertia, &state.displacement), (-stage.inertia, free_flight)]);
        self.mass.multiply(increment, &mut state.net_force);
        if self.damping != Damping::default() {
            self.damping_force(stage, state);
            state.net_force.iter_mut().zip(&self.memory.damping).for_each(|(f, d)| *f += d);
        }
        let applied = self.applied_mouse_spring_force(stage, state);
        self.add_mouse_spring_force(-applied, &mut state.net_force);
        let mut net_force = std::mem::take(&mut state.net_force);
        self.add_pulse_force(state, -1.0, &mut net_force);
        state.net_force = net_force;
        state.knows_net_force = true;
    }

    /// Adds the forces of pulses at their current size, N, times `factor`.
    pub(super) fn add_pulse_force(&self, state: &State, factor: f64, forces: &mut [Vector2<f64>]) {
        let problem = &*self.problem;
        problem.loads().add_pulse_force(problem.system(), &state.displacement, self.kinematics, factor, forces);
    }

    /// Returns the force of the mouse spring at the state's time, N.
    pub fn mouse_spring_force(&mut self, state: &State) -> Vector2<f64> {
        self.problem.set_time(state.time);
        let force = |spring: &MouseSpring| spring.force(spring.mean(&state.displacement), spring.mean(&state.velocity));
        self.problem.mouse_spring().map_or_else(Vector2::zeros, force)
    }

    /// Adds a force of the mouse spring to nodal forces, N.
    pub(super) fn add_mouse_spring_force(&self, spring: Vector2<f64>, forces: &mut [Vector2<f64>]) {
        if let Some(point) = self.problem.mouse_spring() {
            point.add_force(spring, forces);
        }
    }

    /// Returns the force of the mouse spring in a stage's equations, N.
    pub(super) fn applied_mouse_spring_force(&self, stage: &Stage<'_>, state: &State) -> Vector2<f64> {
        self.problem.mouse_spring().map_or_else(Vector2::zeros, |spring| {
            let (u, v) = held(stage, spring, state);
            spring.force(u, v)
        })
    }

    /// Computes the stage's entries in the ledger, from its own start to its end; the residual there is left in the
    /// memory's forces.
    ///
    /// The integrator's loss is the work of the unsolved residual, plus the difference between the work of the loads
    /// and that of the forces used. Forces averaged over the stage do exactly the work of the potential; the pulses are
    /// then recorded with the rest of the work. Forces at the end of the stage do not, and the pulses are recorded with
    /// their mean.
    ///
    /// The mouse spring is recorded with the mean force that the integrator applies, not with its force at the end
    /// velocity: a firm spring damps a light node within a step, and the end velocity of a trapezoidal stage then
    /// alternates. The mean force is `earlier`, N, from earlier stages, plus `share` times that in this stage's equations.
    pub(super) fn record(
        &mut self,
        stage: &Stage<'_>,
        [from, state]: [&State; 2],
        (earlier, share): (Vector2<f64>, f64),
    ) -> StepEnergy {
        let spring = earlier + self.applied_mouse_spring_force(stage, state) * share;
        self.residual(stage, None, state);
        let loads = self.problem.loads();
        let moved = |spring: &MouseSpring| spring.mean(&state.displacement) - spring.mean(&from.displacement);
        let moved = self.problem.mouse_spring().map_or_else(Vector2::zeros, moved);
        let Memory { forces, damping, .. } = &*self.memory;
        let used = work(&forces.external, from, state);
        let potential = loads.potential(from, 1.0) - loads.potential(state, 1.0);
        let pulses = if stage.between { used - potential } else { loads.pulse_work([from, state]) };
        let damps = self.damping != Damping::default();
        let unsolved = work(&forces.residual, from, state);
        StepEnergy {
            dissipated: if damps { work(damping, from, state) } else { 0.0 },
            lost: Some(unsolved + (potential + pulses - used)),
            pulses,
            mouse_spring: spring.dot(&moved),
        }
    }

    /// Returns the rounding error of the residual: ε ‖diag(K) |u|‖, N.
    fn rounding(&mut self, state: &State) -> f64 {
        let pattern = self.problem.system().pattern();
        let corrector = &mut self.memory.corrector;
        pattern.select(&state.displacement, &mut corrector.linear.correction);
        let squares =
            corrector.linear.matrix.diagonal(pattern).zip(&corrector.linear.correction).map(|(k, u)| (k * u).powi(2));
        ROUNDING * squares.sum::<f64>().sqrt()
    }
}

/// Computes the displacement at which damping acts; in linear theory this is the rest position.
fn damped_configuration(kinematics: Kinematics, stage: &Stage<'_>, state: &State, configuration: &mut [Vector2<f64>]) {
    let at_start = if stage.damps_at_midpoint { 0.5 } else { 0.0 };
    match kinematics {
        Kinematics::Linear => configuration.fill(Vector2::zeros()),
        Kinematics::Corotated => {
            combine(configuration, [(at_start, &stage.start.displacement), (1.0 - at_start, &state.displacement)]);
        }
    }
}

/// Returns the terms of a stage's difference quotient: first the unknown's term, then the others.
fn terms<'a>(stage: &Stage<'a>, state: &'a State) -> [(f64, &'a [Vector2<f64>]); TERMS] {
    let mut terms = [(stage.rate, &*state.displacement); TERMS];
    terms[1..].iter_mut().zip(stage.others).for_each(|(term, other)| *term = *other);
    terms
}

/// Returns displacement and velocity of the point of the mouse spring, at the place of the stage's forces.
fn held(stage: &Stage<'_>, spring: &MouseSpring, state: &State) -> (Vector2<f64>, Vector2<f64>) {
    let u = spring.mean(&state.displacement);
    let v = u * stage.rate + stage.others.iter().map(|(c, other)| spring.mean(other) * *c).sum::<Vector2<f64>>();
    (if stage.between { (u + spring.mean(&stage.start.displacement)) * 0.5 } else { u }, v)
}

fn subtract(what: &[Vector2<f64>], from: &mut [Vector2<f64>]) {
    from.iter_mut().zip(what).for_each(|(from, what)| *from -= what);
}
