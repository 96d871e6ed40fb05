//! Background solve of large models, one at a time. The model before stays on display; edits change the requested
//! scene, which the next solve uses.

use super::*;
use crate::app::task::solve::{BackgroundSolve, MAX_PANE_UNKNOWNS, ModelBase, Phase, SolveOutcome, SolveRequest};
use crate::app::task::thread::Update;

/// Time after which the meshing of a body that is solved between two frames is shown.
const SOON: Duration = Duration::from_millis(500);

#[derive(Default)]
pub(super) struct Background {
    solve: Option<Box<BackgroundSolve>>,
    /// Session before the first edit whose result is incomplete.
    pub before: Option<Box<Before>>,
    /// `true` if the next solve starts from rest.
    pub from_rest: bool,
    /// Largest number of iterations of the next solve; `None` for no limit.
    iterations: Option<u32>,
}

/// Session before an edit, restored if the edit is cancelled.
pub(super) struct Before {
    since: Instant,
    pub version: Version,
    /// Number of undo steps.
    depth: usize,
    /// Label of the control that was edited.
    pub label: Option<&'static str>,
    /// `true` while the scene of a newly opened document is not displayed yet.
    pub is_another_document: bool,
}

impl Session {
    /// Returns `true` while a model is meshed or solved in the background.
    pub fn is_working(&self) -> bool {
        self.background.solve.is_some()
    }

    /// Returns the scene of the background solve, its current phase, and the time since the edit, s.
    pub(crate) fn work(&self) -> Option<(&Scene, Phase, u64)> {
        let (solve, before) = self.background.solve.as_ref().zip(self.background.before.as_ref())?;
        let (scene, since) = (&solve.scene, before.since.elapsed());
        // A mesh is usually made within this time.
        let is_soon_over = scene.unknowns() <= self.most_unknowns && since < SOON;
        (!is_soon_over).then_some((scene, solve.phase, since.as_secs()))
    }

    /// Returns `true` if `scene` is set up in the background: it takes too long for the time between two frames, and has a
    /// new mesh or is static. Time steps of motions are made between frames.
    pub(super) fn is_for_background(&self, scene: &Scene) -> bool {
        let (own, most) = (&self.model.simulation, self.most_unknowns);
        if !has_mesh_of(scene, own.scene()) {
            // A new mesh takes longer than an iteration.
            return scene.unknowns() > most.min(MAX_PANE_UNKNOWNS);
        }
        // Counting the nodes of a mesh file takes too long for every frame.
        let is_large = 2 * own.mesh().nodes().len() as u64 > most;
        is_large && scene.analysis == Analysis::Static && own.motion().is_none()
    }

    /// Returns `true` if the displayed model is solved in the background.
    pub(crate) fn is_in_background(&self) -> bool {
        self.is_working() || self.is_for_background(&self.present.scene)
    }

    /// Requests a scene, which the next background solve uses.
    pub(super) fn request_scene(&mut self, scene: Scene) {
        self.keep_before();
        self.present.scene = scene;
        self.changed.scene = true;
        self.stop_solve();
    }

    /// Solves again in the background, from rest or from the current state, without limit or for a number of iterations.
    pub(super) fn restart_in_background(&mut self, from_rest: bool, iterations: Option<u32>) {
        self.keep_before();
        (self.background.from_rest, self.background.iterations) = (from_rest, iterations);
        self.stop_solve();
        self.poll();
    }

    /// Keeps the session before the first edit.
    fn keep_before(&mut self) {
        // From now on the displayed model is a copy, which cannot be grabbed.
        self.release();
        if self.background.before.is_none() {
            self.background.before = Some(Box::new(Before {
                since: Instant::now(),
                version: self.present.clone(),
                depth: self.undo.past.len(),
                label: None,
                is_another_document: false,
            }));
        }
    }

    /// Cancels the solve; it returns the model that it has.
    pub(super) fn stop_solve(&self) {
        self.background.solve.iter().for_each(|solve| solve.task.cancel());
    }

    /// Handles the updates of the background solve, and starts the next solve if one is needed.
    pub(crate) fn poll(&mut self) {
        while self.take_update(false) {}
        self.start_solve(None);
    }

    /// Handles an update of the background solve, or `waits` for it; returns `false` if there is none.
    pub(super) fn take_update(&mut self, waits: bool) -> bool {
        let Some(solve) = &mut self.background.solve else { return false };
        match solve.task.next(waits) {
            Update::None => return false,
            Update::Progress(phase) => solve.phase = phase,
            Update::Done(outcome) => self.receive(outcome),
            Update::Died => {
                self.roll_back();
                // Repeating the same solve would fail in the same way.
                self.running = false;
                self.notices.push(Notice { label: None, message: sentence!("The solve ended unexpectedly") });
            }
        }
        true
    }

    fn receive(&mut self, outcome: SolveOutcome) {
        let Some(solve) = self.background.solve.take() else { return };
        // A solve that was cancelled, to go on after a change, has no result yet.
        let Background { from_rest, iterations, .. } = self.background;
        let goes_on = from_rest || iterations.is_some() || self.running && solve.task.is_cancelled();
        match outcome {
            Ok(model) if solve.scene == self.present.scene && !goes_on => self.display(*model),
            // The next solve continues with the model of one that an edit has superseded.
            Ok(model) if has_mesh_of(&self.present.scene, &solve.scene) => self.start_solve(Some(model)),
            Err(error) if solve.scene == self.present.scene => {
                let label = self.background.before.as_ref().and_then(|before| before.label);
                self.roll_back();
                self.notices.push(Notice { label, message: (&error).into() });
            }
            Ok(_) | Err(_) => {}
        }
    }

    /// Displays a result in place of the current model.
    fn display(&mut self, model: Model) {
        let scene = std::mem::replace(&mut self.model, model).simulation.scene().clone();
        self.frame.timings = *self.model.simulation.last_iteration();
        self.scene_changed(&scene);
        let before = self.background.before.as_mut();
        if before.is_some_and(|before| std::mem::take(&mut before.is_another_document)) {
            self.start_document();
        }
    }

    /// Starts the next solve, if one is needed.
    fn start_solve(&mut self, returned: Option<Box<Model>>) {
        if self.background.solve.is_some() {
            return;
        }
        let own = returned.as_ref().map_or(&self.model.simulation, |model| &model.simulation);
        let is_new = !has_mesh_of(&self.present.scene, own.scene());
        let is_needed = returned.is_some()
            || own.scene() != &self.present.scene
            || self.background.from_rest
            || self.background.iterations.is_some()
            || self.running && *own.status() == Status::Running;
        // The time steps of a displayed motion are made between two frames.
        let is_motion = returned.is_none() && own.motion().is_some();
        if !self.is_for_background(&self.present.scene) || !is_new && (!is_needed || is_motion) {
            self.background.before = None;
            return;
        }
        self.keep_before();
        let base = match returned {
            _ if is_new => Some(ModelBase::None),
            Some(model) => Some(ModelBase::Model(model)),
            // A copy stays on display.
            None => {
                (self.model.snapshot()).map(|copy| ModelBase::Model(Box::new(std::mem::replace(&mut self.model, copy))))
            }
        };
        let Some(base) = base else { return };
        // Iterations of a body that is not that large are made between two frames.
        let is_made_here = !self.running || self.present.scene.unknowns() <= self.most_unknowns;
        let request = SolveRequest {
            scene: self.present.scene.clone(),
            base,
            // A result that is accepted early would depend on the state before.
            from_rest: std::mem::take(&mut self.background.from_rest) || self.scene().solver.accept_after > 0,
            iterations: self.background.iterations.take().or(is_made_here.then_some(0)),
            is_displayed: true,
        };
        match BackgroundSolve::start(request) {
            Ok(solve) => self.background.solve = Some(Box::new(solve)),
            Err(error) => {
                self.roll_back();
                self.running = false;
                let message = sentence!("Could not start the solve: %{error}", error = error.to_string());
                self.notices.push(Notice { label: None, message });
            }
        }
    }

    /// Cancels the background solve, and restores the session before the edit.
    pub(crate) fn cancel(&mut self) {
        self.roll_back();
        // An iteration that had not ended before the edit would otherwise continue at once.
        self.running &= self.model.simulation.is_at_rest();
    }

    /// Drops the background solve, and restores the session before the edit.
    fn roll_back(&mut self) {
        let Some(before) = std::mem::take(&mut self.background).before else { return };
        let Before { version, depth, .. } = *before;
        self.undo.take_back(depth);
        self.present = version;
    }
}
