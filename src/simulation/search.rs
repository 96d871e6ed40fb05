//! Search for an equilibrium by iteration.

use nalgebra::Vector2;

use super::{Body, Status};
use crate::assembly::{Change, Forces, Kinematics, LARGEST_TURN};
use crate::displacement::Displacement;
use crate::element::UNIT;
use crate::method::{Certificate, Criteria, Method, Reason, Restart, Verdict, Workspace, fixed_point_rho, is_stable};
use crate::scene::{Scene, SolverSettings};
use crate::solver::SolverError;
use crate::state::largest;
use crate::step::{Iteration, Linearization, Operation, RotationUpdate};
use crate::timings::{Timings, timed};

/// Search for an equilibrium with a method.
#[derive(Debug)]
pub(super) struct Search {
    pub method: Box<dyn Method>,
    /// Displacement and edge angles before the current iteration.
    previous: (Displacement, Vec<f64>),
    pub forces: Forces,
    /// Work memory, allocated on first use.
    workspace: Option<Workspace>,
    pub iterations: u32,
    /// Bound of the residual's rounding error, if the solve ended at it.
    pub floor: Option<f64>,
    pub certificate: Option<Certificate>,
}

fn criteria(settings: &SolverSettings, iterations: u32) -> Criteria {
    Criteria {
        residual: settings.tolerance,
        error: 0.01 * settings.max_error_percent,
        solves_left: settings.max_iterations.saturating_sub(iterations).max(1),
    }
}

impl Search {
    /// Returns a search that starts from the current state.
    pub fn new(body: &mut Body) -> Result<Self, SolverError> {
        let mut search = Self {
            method: (body.scene.solver.method.entry().start)(),
            previous: (body.state.displacement.clone(), body.state.edge_angles.clone()),
            forces: Forces::new(body.state.displacement.len()),
            workspace: Some(Workspace::new(body.problem.system())?),
            iterations: 0,
            floor: None,
            certificate: None,
        };
        search.restart(body, Restart::AtRest);
        Ok(search)
    }

    /// Copies the search without its work memory, which is allocated again if the copy is continued.
    pub fn copy(&self) -> Self {
        Self {
            method: self.method.copy(),
            previous: (Displacement::zeros(0), Vec::new()),
            forces: self.forces.clone(),
            workspace: None,
            ..*self
        }
    }

    /// Takes the work memory out of the search, allocating it if necessary; the search ends if that fails.
    fn take_workspace(&mut self, body: &mut Body) -> Option<Workspace> {
        let workspace = self.workspace.take().map_or_else(|| Workspace::new(body.problem.system()), Ok);
        workspace.map_err(|error| body.status = Reason::Iteration(error.into()).into()).ok()
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
        // A rotation that is large, or was not completed, would leave the number of full rotations unknown.
        let far = |angle: f64| angle.abs() > LARGEST_TURN;
        let is_complete = body.status == Status::Converged;
        let mut turns = before.supports.iter().zip(&body.scene.supports).map(|(a, b)| (a.turn, b.turn));
        let can_follow =
            before.supports == body.scene.supports || !turns.any(|(a, b)| far(b - a) || far(a) && !is_complete);
        let keeps_state = same_method
            && !matches!(body.status, Status::Diverged(_))
            && can_follow
            && body.is_useful_start(same_unknowns);
        if !same_method {
            self.method = (body.scene.solver.method.entry().start)();
        }
        self.method.restart(why);
        if !keeps_state {
            body.state.reset();
        }
        self.restart(body, if keeps_state { why } else { Restart::AtRest });
        Ok(())
    }

    /// Resets counts and times, and computes the forces of the current state.
    pub fn restart(&mut self, body: &mut Body, why: Restart) {
        (self.iterations, self.floor, self.certificate) = Default::default();
        (body.status, body.timings, body.last_iteration) = Default::default();
        let Some(mut workspace) = self.take_workspace(body) else { return };
        let (criteria, mut untimed) = (criteria(&body.scene.solver, 0), Timings::default());
        self.method.restart(why);
        let mut it = iteration(body, &mut self.forces, &mut workspace, &mut untimed);
        let wanted = self.method.linearization();
        match why {
            Restart::AtRest => relinearize(&mut it, wanted),
            // The internal forces are unchanged.
            Restart::NewLoads => {
                it.problem.balance(it.state, wanted.kinematics, wanted.load_factor, it.forces);
            }
            Restart::NewStiffness | Restart::NewUnknowns => {
                it.linearize(RotationUpdate::Keep, wanted);
                settle(&mut it, wanted);
            }
        }
        let verdict = self.method.check_convergence(&mut it, &criteria, None);
        self.apply_verdict(verdict, body, &mut workspace, &mut untimed);
        self.workspace = Some(workspace);
    }

    /// Restarts the search after a mouse spring was attached, moved or removed.
    pub fn pulled(&mut self, body: &mut Body, moved_only: bool) {
        let why = if moved_only { Restart::NewLoads } else { Restart::NewStiffness };
        // The tangent contains the mouse spring.
        self.discard_tangent();
        self.restart(body, why);
    }

    /// Performs one step; does nothing once the status is final.
    pub fn step(&mut self, body: &mut Body) {
        if body.status != Status::Running {
            return;
        }
        let Some(mut workspace) = self.take_workspace(body) else { return };
        let criteria = criteria(&body.scene.solver, self.iterations);
        let mut timings = Timings::default();
        self.previous.0.copy_from(&body.state.displacement);
        self.previous.1.clone_from(&body.state.edge_angles);
        let mut it = iteration(body, &mut self.forces, &mut workspace, &mut timings);
        let planned = self.method.plan(&mut it, &criteria);
        self.iterations += self.method.report().solves;
        let stepped = planned.and_then(|first| {
            it.step(first, self.method.linearization())?;
            settle(&mut it, self.method.linearization());
            Ok((first <= Operation::Advance).then(|| it.step_length()))
        });
        let verdict = match stepped {
            Ok(length) => self.method.check_convergence(&mut it, &criteria, length),
            Err(error) => {
                it.state.displacement.copy_from(&self.previous.0);
                it.state.edge_angles.copy_from_slice(&self.previous.1);
                relinearize(&mut it, self.method.linearization());
                self.method.recover(&mut it, error)
            }
        };
        self.apply_verdict(verdict, body, &mut workspace, &mut timings);
        self.workspace = Some(workspace);
        body.timings.add(&timings);
        body.last_iteration = timings;
    }

    /// Carries out the method's decision.
    fn apply_verdict(&mut self, verdict: Verdict, body: &mut Body, workspace: &mut Workspace, timings: &mut Timings) {
        match verdict {
            Verdict::Continue => {}
            Verdict::Changed => {
                relinearize(&mut iteration(body, &mut self.forces, workspace, timings), self.method.linearization())
            }
            Verdict::Converged(floor) => (body.status, self.floor) = (Status::Converged, floor),
            Verdict::Stop(reason) => body.status = reason.into(),
        }
        let solver = &body.scene.solver;
        let (most, enough) = (solver.max_iterations, solver.accept_after);
        if body.status == Status::Running && enough != 0 && self.iterations >= enough {
            self.end(body, workspace, Status::Accepted, timings);
        } else if body.status == Status::Running && self.iterations >= most {
            self.end(body, workspace, Reason::IterationLimit(most).into(), timings);
        }
    }

    /// Ends the search before convergence, and computes the residual under the whole load. An accepted result is kept;
    /// otherwise the method restores the best available state.
    fn end(&mut self, body: &mut Body, workspace: &mut Workspace, status: Status, timings: &mut Timings) {
        body.status = status;
        if body.status != Status::Accepted {
            self.method.stop(&mut body.state);
        }
        let wanted = Linearization { tangent: None, load_factor: 1.0, ..self.method.linearization() };
        relinearize(&mut iteration(body, &mut self.forces, workspace, timings), wanted);
    }

    /// Interrupts a running search.
    pub fn stop(&mut self, body: &mut Body) {
        let Some(mut workspace) = self.take_workspace(body) else { return };
        self.end(body, &mut workspace, Reason::Interrupted.into(), &mut Timings::default());
        self.workspace = Some(workspace);
    }

    /// Returns `true` if the state is an equilibrium of large rotations without a mouse spring: at the whole load, or at
    /// the part of it that was reached.
    pub fn can_be_certified(&self, Body { problem, status, .. }: &Body) -> bool {
        let Linearization { kinematics, load_factor, .. } = self.method.linearization();
        let reached = *status == Status::Converged || matches!(status, Status::NotConverged(_)) && load_factor < 1.0;
        problem.mouse_spring().is_none() && reached && kinematics != Kinematics::Linear
    }

    /// Implements [`super::Simulation::certify`].
    pub fn certify(&mut self, body: &mut Body) -> Certificate {
        if self.certificate.is_some() || !self.can_be_certified(body) {
            return self.certificate.unwrap_or_default();
        }
        let Body { problem, state, timings, .. } = body;
        let made = self.workspace.take().map_or_else(|| Workspace::new(problem.system()), Ok);
        let Ok(made) = made else { return Certificate::default() };
        let load_factor = self.load_factor();
        let workspace = self.workspace.insert(made);
        let forces = &mut self.forces;
        let certificate = timed(&mut timings.certify, || Certificate {
            fixed_point_rho: fixed_point_rho(problem, state, load_factor, forces, workspace),
            stable: Some(is_stable(problem, state, load_factor, forces, workspace)),
        });
        *self.certificate.insert(certificate)
    }

    pub fn kinematics(&self) -> Kinematics {
        self.method.linearization().kinematics
    }

    pub fn load_factor(&self) -> f64 {
        self.method.linearization().load_factor
    }

    pub fn residual(&self) -> f64 {
        self.forces.below_rounding.map_or(self.forces.relative_residual, |[residual, _]| residual)
    }
}

fn iteration<'a>(
    body: &'a mut Body,
    forces: &'a mut Forces,
    workspace: &'a mut Workspace,
    timings: &'a mut Timings,
) -> Iteration<'a> {
    Iteration { problem: &body.problem, state: &mut body.state, forces, workspace, timings }
}

/// Linearizes a state with a new displacement.
fn relinearize(it: &mut Iteration<'_>, wanted: Linearization) {
    it.linearize(RotationUpdate::Follow, wanted);
    settle(it, wanted);
}

/// Returns to rest exactly if nothing loads the body and its nodes are where they are at rest, within the unit roundoff
/// of the body's size: both the residual and the forces that it is relative to shrink with the displacement.
fn settle(it: &mut Iteration<'_>, wanted: Linearization) {
    let system = it.problem.system();
    let rests = it.forces.relative_residual > 0.0
        && it.forces.external.iter().all(|f| *f == Vector2::zeros())
        && !it.problem.supports().move_the_body()
        && largest(&it.state.displacement) <= UNIT * system.size();
    if rests {
        *it.state = system.at_rest();
        it.linearize(RotationUpdate::Follow, wanted);
    }
}
