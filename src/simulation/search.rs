//! Search for an equilibrium by iteration.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::{Body, Status};
use crate::assembly::{Change, Forces, Kinematics, LARGEST_TURN, Problem};
use crate::displacement::Displacement;
use crate::element::{Tangent, UNIT};
use crate::method::{
    AutoReport, Certificate, Iteration, IterationError, Method, PathEvents, Reason, Restart, Tolerances, Verdict,
    Workspace, fixed_point_rho, is_stable, measure,
};
use crate::scene::{Scene, SolverSettings, Support};
use crate::solver::SolverError;
use crate::state::{State, largest};
use crate::timings::{Timings, timed};

/// Search for an equilibrium with a method.
#[derive(Debug)]
pub(super) struct Search {
    method: Box<dyn Method>,
    /// Displacement and edge angles before the current iteration.
    previous: (Displacement, Vec<f64>),
    forces: Forces,
    /// Work memory, allocated on first use.
    workspace: Option<Workspace>,
    residual: f64,
    /// Bound of the residual's rounding error, if the solve ended at it.
    floor: Option<f64>,
    iterations: u32,
    status: Status,
    certificate: Option<Certificate>,
    timings: Timings,
    last_iteration: Timings,
    /// Results for display, taken over from the instance that made the iterations; `None` if this one made them.
    figures: Option<Figures>,
    /// Critical points of the path, taken over likewise.
    path_events: Option<PathEvents>,
}

/// Figures that a method computes for display.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Figures {
    kinematics: Kinematics,
    load_factor: f64,
    load_steps: u32,
    step_ratio: Option<f64>,
    auto_report: Option<AutoReport>,
}

/// State and results of a search, as data that can be sent to another instance of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Found {
    /// State that the search has reached.
    pub state: State,
    /// Number of iterations.
    pub iterations: u32,
    forces: Forces,
    residual: f64,
    floor: Option<f64>,
    status: Status,
    certificate: Option<Certificate>,
    timings: Timings,
    last_iteration: Timings,
    figures: Figures,
    path_events: Option<PathEvents>,
}

fn tolerances(settings: &SolverSettings) -> Tolerances {
    Tolerances { residual: settings.tolerance, error: 0.01 * settings.max_error_percent }
}

impl Search {
    /// Returns a search that starts from the current state.
    pub fn new(body: &mut Body) -> Result<Self, SolverError> {
        let mut search = Self::unmeasured(&body.scene, Forces::new(body.state.displacement.len()));
        search.workspace = Some(Workspace::new(body.problem.system())?);
        search.previous = (body.state.displacement.clone(), body.state.edge_angles.clone());
        search.restart(body, Restart::AtRest);
        Ok(search)
    }

    /// Returns a search whose state has not been measured, without work memory.
    fn unmeasured(scene: &Scene, forces: Forces) -> Self {
        Self {
            method: (scene.solver.method.entry().start)(),
            previous: (Displacement::zeros(0), Vec::new()),
            forces,
            workspace: None,
            residual: 0.0,
            floor: None,
            iterations: 0,
            status: Status::Running,
            certificate: None,
            timings: Timings::default(),
            last_iteration: Timings::default(),
            figures: None,
            path_events: None,
        }
    }

    /// Returns a search with the results that another instance has found, and its state.
    pub fn of(scene: &Scene, found: Found) -> (Self, State) {
        let mut search = Self::unmeasured(scene, found.forces);
        search.residual = found.residual;
        search.floor = found.floor;
        search.iterations = found.iterations;
        search.status = found.status;
        search.certificate = found.certificate;
        search.timings = found.timings;
        search.last_iteration = found.last_iteration;
        search.figures = Some(found.figures);
        search.path_events = found.path_events;
        (search, found.state)
    }

    /// Copies the search without its work memory, which is allocated again if the copy is continued.
    pub fn copy(&self) -> Self {
        Self {
            method: self.method.copy(),
            previous: (Displacement::zeros(0), Vec::new()),
            forces: self.forces.clone(),
            workspace: None,
            residual: self.residual,
            floor: self.floor,
            iterations: self.iterations,
            status: self.status.clone(),
            certificate: self.certificate,
            timings: self.timings,
            last_iteration: self.last_iteration,
            figures: self.figures,
            path_events: self.path_events.clone(),
        }
    }

    /// Returns the state and the results as data.
    pub fn found(&self, body: &Body) -> Found {
        Found {
            state: body.state.clone(),
            iterations: self.iterations,
            forces: self.forces.clone(),
            residual: self.residual,
            floor: self.floor,
            status: self.status.clone(),
            certificate: self.certificate,
            timings: self.timings,
            last_iteration: self.last_iteration,
            figures: self.figures(),
            path_events: self.path_events(),
        }
    }

    fn figures(&self) -> Figures {
        self.figures.unwrap_or_else(|| Figures {
            kinematics: self.method.kinematics(),
            load_factor: self.method.load_factor(),
            load_steps: self.method.load_steps(),
            step_ratio: self.method.step_ratio(),
            auto_report: self.method.report(),
        })
    }

    /// Takes the work memory out of the search, allocating it if necessary; the search ends if that fails.
    fn take_workspace(&mut self, problem: &Problem) -> Option<Workspace> {
        let workspace = self.workspace.take().map_or_else(|| Workspace::new(problem.system()), Ok);
        workspace.map_err(|error| self.status = Reason::Iteration(error.into()).into()).ok()
    }

    /// Marks the workspace's matrix as outdated.
    fn discard_tangent(&mut self) {
        if let Some(workspace) = &mut self.workspace {
            workspace.tangent = None;
        }
    }

    /// Continues after an edit; `before` is the previous scene. The state is kept unless it is not a useful start.
    pub fn edit(&mut self, body: &mut Body, before: &Scene, change: Change) -> Result<(), SolverError> {
        let why = match change {
            Change::Mesh | Change::Unknowns => {
                self.workspace = Some(Workspace::new(body.problem.system())?);
                Restart::NewUnknowns
            }
            Change::Stiffness => Restart::NewStiffness,
            Change::Loads => Restart::NewLoads,
        };
        let moments = |scene: &Scene| scene.loads.iter().any(|load| load.is_moment());
        if moments(before) || moments(&body.scene) {
            // The exact tangent contains the moments.
            self.discard_tangent();
        }
        let same_method = body.scene.solver.method == before.solver.method;
        let same_unknowns = change <= Change::Stiffness;
        let keeps_state = same_method
            && !matches!(self.status, Status::Diverged(_))
            && self.can_follow(&before.supports, &body.scene.supports)
            && body.is_useful_start(same_unknowns);
        if !same_method {
            self.method = (body.scene.solver.method.entry().start)();
        }
        self.method.restart(why);
        if keeps_state {
            self.restart(body, why);
        } else {
            body.state.reset();
            self.restart(body, Restart::AtRest);
        }
        Ok(())
    }

    /// Returns `true` if the search can continue from the current state with changed supports: not if they rotate far,
    /// or their rotation was not completed, because the number of full rotations would be unknown.
    fn can_follow(&self, before: &[Support], after: &[Support]) -> bool {
        let far = |angle: f64| angle.abs() > LARGEST_TURN;
        let mut pairs = before.iter().zip(after);
        before == after || !pairs.any(|(a, b)| far(b.turn - a.turn) || far(a.turn) && self.status != Status::Converged)
    }

    /// Resets counts and times, and computes the forces of the current state.
    pub fn restart(&mut self, body: &mut Body, why: Restart) {
        self.iterations = 0;
        self.floor = None;
        self.status = Status::Running;
        self.certificate = None;
        self.timings = Timings::default();
        self.last_iteration = Timings::default();
        self.figures = None;
        let Some(mut workspace) = self.take_workspace(&body.problem) else { return };
        let mut unmeasured = Timings::default();
        if why == Restart::NewLoads {
            // The internal forces are unchanged.
            let (kinematics, load_factor) = (self.method.kinematics(), self.method.load_factor());
            self.residual = body.problem.balance(&body.state, kinematics, load_factor, &mut self.forces);
        } else {
            if why == Restart::AtRest {
                self.method.restart(why);
            }
            let wanted = (self.method.tangent(), self.method.load_factor());
            self.measure_forces(body, &mut workspace, why == Restart::AtRest, wanted, &mut unmeasured);
        }
        let verdict =
            self.with_method(body, &mut workspace, &mut unmeasured, |method, it| method.check_convergence(it));
        self.apply_verdict(body, &mut workspace, verdict, &mut unmeasured);
        self.workspace = Some(workspace);
    }

    /// Restarts the search after a mouse spring was attached, moved or removed.
    pub fn pulled(&mut self, body: &mut Body, moved_only: bool) {
        let why = if moved_only { Restart::NewLoads } else { Restart::NewStiffness };
        // The tangent contains the mouse spring.
        self.discard_tangent();
        self.method.restart(why);
        self.restart(body, why);
    }

    /// Performs one iteration; does nothing once the status is final.
    pub fn step(&mut self, body: &mut Body) {
        if self.status != Status::Running {
            return;
        }
        let Some(mut workspace) = self.take_workspace(&body.problem) else { return };
        self.figures = None;
        let mut timings = Timings::default();
        let State { displacement, edge_angles, .. } = &body.state;
        self.previous.0.copy_from(displacement);
        self.previous.1.clone_from(edge_angles);
        let iterated = self.with_method(body, &mut workspace, &mut timings, |method, it| method.iterate(it));
        self.iterations += self.method.solves();
        let measured = iterated.and_then(|()| {
            self.measure(body, &mut workspace, &mut timings);
            if self.residual.is_finite() { Ok(()) } else { Err(IterationError::NotFinite) }
        });
        if measured.is_err() {
            body.state.displacement.copy_from(&self.previous.0);
            body.state.edge_angles.copy_from_slice(&self.previous.1);
            self.measure(body, &mut workspace, &mut timings);
        }
        let verdict = self.with_method(body, &mut workspace, &mut timings, |method, it| match measured {
            Ok(()) => method.check_convergence(it),
            Err(error) => method.recover(it, error),
        });
        self.apply_verdict(body, &mut workspace, verdict, &mut timings);
        self.workspace = Some(workspace);
        self.timings.add(&timings);
        self.last_iteration = timings;
    }

    /// Runs `work` with the method on the current state.
    fn with_method<T>(
        &mut self,
        body: &mut Body,
        workspace: &mut Workspace,
        timings: &mut Timings,
        work: impl FnOnce(&mut dyn Method, &mut Iteration<'_>) -> T,
    ) -> T {
        let mut iteration = Iteration {
            problem: &body.problem,
            forces: &mut self.forces,
            residual: self.residual,
            tolerances: tolerances(&body.scene.solver),
            state: &mut body.state,
            workspace,
            timings,
            solves_left: body.scene.solver.max_iterations.saturating_sub(self.iterations).max(1),
        };
        work(self.method.as_mut(), &mut iteration)
    }

    /// Carries out the method's decision.
    fn apply_verdict(&mut self, body: &mut Body, workspace: &mut Workspace, verdict: Verdict, timings: &mut Timings) {
        match verdict {
            Verdict::Continue => {}
            Verdict::Changed => self.measure(body, workspace, timings),
            Verdict::Converged => self.status = Status::Converged,
            Verdict::AtRounding(floor) => {
                self.status = Status::Converged;
                self.floor = Some(floor);
            }
            Verdict::Stop(reason) => self.status = reason.into(),
        }
        let solver = &body.scene.solver;
        let (most, enough) = (solver.max_iterations, solver.accept_after);
        if self.status == Status::Running && enough != 0 && self.iterations >= enough {
            self.end(body, workspace, Status::Accepted, timings);
        } else if self.status == Status::Running && self.iterations >= most {
            self.end(body, workspace, Reason::IterationLimit(most).into(), timings);
        }
    }

    /// Ends the search before convergence, and computes the residual under the whole load. An accepted result is kept;
    /// otherwise the method restores the best available state.
    fn end(&mut self, body: &mut Body, workspace: &mut Workspace, status: Status, timings: &mut Timings) {
        self.status = status;
        if self.status != Status::Accepted {
            self.method.stop(&mut body.state);
        }
        self.measure_forces(body, workspace, true, (None, 1.0), timings);
    }

    /// Interrupts a running search.
    pub fn stop(&mut self, body: &mut Body) {
        if self.status != Status::Running {
            return;
        }
        let Some(mut workspace) = self.take_workspace(&body.problem) else { return };
        self.end(body, &mut workspace, Reason::Interrupted.into(), &mut Timings::default());
        self.workspace = Some(workspace);
    }

    /// Computes rotations, forces and residual of the current state under the current load, and the tangent that the
    /// next iteration needs.
    fn measure(&mut self, body: &mut Body, workspace: &mut Workspace, timings: &mut Timings) {
        let wanted = (self.method.tangent(), self.method.load_factor());
        self.measure_forces(body, workspace, true, wanted, timings);
    }

    /// Computes forces and residual under a load factor, and a tangent if requested; if `follow` is `true`, the
    /// displacement is new and the rotations are updated.
    fn measure_forces(
        &mut self,
        body: &mut Body,
        workspace: &mut Workspace,
        follow: bool,
        wanted: (Option<Tangent>, f64),
        timings: &mut Timings,
    ) {
        let rotate = (self.method.kinematics(), follow);
        let Body { problem, state, .. } = body;
        self.residual = measure(problem, state, rotate, wanted, &mut self.forces, workspace, timings);
        if self.residual > 0.0 && self.is_at_rest_within_rounding(problem, state) {
            // Both the residual and the forces that it is relative to shrink with the displacement.
            *state = problem.system().at_rest();
            self.residual = measure(problem, state, rotate, wanted, &mut self.forces, workspace, timings);
        }
    }

    /// Returns `true` if nothing loads the body and its nodes are where they are at rest, within the unit roundoff of
    /// the body's size.
    fn is_at_rest_within_rounding(&self, problem: &Problem, state: &State) -> bool {
        self.forces.external.iter().all(|f| *f == Vector2::zeros())
            && !problem.supports().move_the_body()
            && largest(&state.displacement) <= UNIT * problem.system().size()
    }

    /// Returns `true` if the state is an equilibrium of large rotations without a mouse spring.
    pub fn can_be_certified(&self, problem: &Problem) -> bool {
        problem.mouse_spring().is_none() && self.is_equilibrium() && self.kinematics() != Kinematics::Linear
    }

    /// Implements [`super::Simulation::certify`].
    pub fn certify(&mut self, problem: &Problem, state: &State) -> Certificate {
        if let Some(certificate) = self.certificate {
            return certificate;
        }
        if !self.can_be_certified(problem) {
            return Certificate::default();
        }
        let made = self.workspace.take().map_or_else(|| Workspace::new(problem.system()), Ok);
        let Ok(made) = made else { return Certificate::default() };
        let load_factor = self.load_factor();
        let workspace = self.workspace.insert(made);
        let forces = &mut self.forces;
        let certificate = timed(&mut self.timings.certify, || Certificate {
            fixed_point_rho: fixed_point_rho(problem, state, load_factor, forces, workspace),
            stable: Some(is_stable(problem, state, load_factor, forces, workspace)),
        });
        *self.certificate.insert(certificate)
    }

    /// Returns `true` if the state is an equilibrium: at the whole load, or at the part of it that was reached.
    fn is_equilibrium(&self) -> bool {
        match self.status {
            Status::Converged => true,
            Status::NotConverged(_) => self.load_factor() < 1.0,
            _ => false,
        }
    }

    pub fn certificate(&self) -> Option<Certificate> {
        self.certificate
    }

    pub fn kinematics(&self) -> Kinematics {
        self.figures().kinematics
    }

    pub fn forces(&self) -> &Forces {
        &self.forces
    }

    pub fn load_factor(&self) -> f64 {
        self.figures().load_factor
    }

    pub fn load_steps(&self) -> u32 {
        self.figures().load_steps
    }

    pub fn auto_report(&self) -> Option<AutoReport> {
        self.figures().auto_report
    }

    /// Returns the critical points of the path from rest, if it is known to lead to the result.
    pub fn path_events(&self) -> Option<PathEvents> {
        let events = match self.figures {
            Some(_) => self.path_events.clone(),
            None => self.method.path_events(),
        };
        events.filter(|_| self.status.is_success())
    }

    pub fn status(&self) -> &Status {
        &self.status
    }

    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    pub fn residual(&self) -> f64 {
        self.forces.below_rounding.map_or(self.residual, |[residual, _]| residual)
    }

    pub fn residual_floor(&self) -> Option<f64> {
        let below = self.forces.below_rounding.filter(|_| self.status == Status::Converged);
        self.floor.or(below.map(|[_, bound]| bound))
    }

    pub fn step_ratio(&self) -> Option<f64> {
        self.figures().step_ratio
    }

    pub fn last_iteration(&self) -> &Timings {
        &self.last_iteration
    }

    pub fn timings(&self) -> &Timings {
        &self.timings
    }
}
