//! One model being worked on, without user interface: scene, simulation, solution of linear theory, motion, undo
//! history, file, and results computed in the background.

mod background;
pub(crate) mod clock;
pub(crate) mod document;
mod edit;
pub(crate) mod facts;
pub(crate) mod fallback;
pub(crate) mod playback;
pub(crate) mod recovery;
pub(crate) mod run;
#[cfg(test)]
mod tests;

use std::sync::LazyLock;

use crate::app::prelude::*;
use crate::app::session::background::Background;
use crate::app::session::document::Document;
pub(crate) use crate::app::session::edit::{Changed, Edit, UndoHistory, Version, object_name};
use crate::app::session::facts::{Facts, Live, SolveFromRest};
use crate::app::session::fallback::{Fallback, is_lost};
use crate::app::session::playback::Playback;
use crate::app::task::solve::{MAX_UNKNOWNS, Model, solve_linear};
use crate::mesh::MaterialPoint;
use crate::state::State;
use crate::study::{PathSummary, StudyError, is_unstable};
use crate::timings::Timings;

/// Time of iterations after which a displayed frame makes no more.
const MAX_FRAME_WORK: Duration = Duration::from_millis(8);

/// Message for the user about background work.
#[derive(Debug)]
pub(crate) struct Notice {
    /// Control that was edited, if its scene could not be set up.
    pub label: Option<&'static str>,
    pub message: Sentence,
}

/// Grab of the body with the pointer during one frame. The fields are applied in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Grab {
    /// Material point that is grabbed.
    pub start: Option<MaterialPoint>,
    /// Position that the grabbed point is pulled to, m.
    pub target: Option<Vector2<f64>>,
    pub release: bool,
}

/// Iterations of the displayed frames.
#[derive(Debug, Default)]
pub struct FrameWork {
    /// Time of iterations after which a frame makes no more.
    pub limit: Duration,
    /// Part of this time that is left in the current frame.
    left: Duration,
    /// Time of the iterations of the last frame.
    pub(crate) timings: Timings,
    /// `true` if a frame makes one iteration: slow motion of the method.
    pub is_slow: bool,
    /// `true` while the pointer is pressed.
    is_held: bool,
    /// `true` if the scene has been edited since the last [`Session::follow_edit`].
    is_edited_now: bool,
    /// `true` if the frame before, in which there was such an edit, has left the search unfinished.
    was_edited: bool,
    /// `true` if the search began at rest.
    is_from_rest: bool,
    /// `true` if this frame iterates once it is known that there is no edit.
    is_postponed: bool,
}

/// One model being worked on.
pub struct Session {
    /// Document, and the requested scene, which differs from the simulation's only while a background solve is in progress.
    present: Version,
    pub undo: UndoHistory,
    /// Displayed model; a copy of it while it is solved in the background.
    pub(crate) model: Model,
    /// Number of unknowns above which a model is meshed and solved in the background.
    pub most_unknowns: u64,
    background: Background,
    running: bool,
    pub frame: FrameWork,
    pub(crate) playback: Playback,
    /// Bodies drawn in place of a search that has found no equilibrium.
    fallback: Fallback,
    /// Equilibrium before the body was grabbed, which its release restores, and the time of its iterations.
    before_grab: Option<(Model, Timings)>,
    pub(crate) facts: Facts,
    /// `true` if the scene's file has changed on disk since it was read or saved.
    pub(crate) is_outdated: bool,
    pub(crate) changed: Changed,
    pub(crate) notices: Vec<Notice>,
}

/// Relative residual above which the iterate of a dragged body is not drawn.
pub(crate) const WILD: f64 = 0.1;

impl Session {
    /// Creates a session with `scene` that iterates from rest.
    pub(crate) fn new(source: Source, scene: Scene, simulation: Simulation) -> Self {
        let mut model = Model::new(simulation, None);
        model.linear = solve_linear(model.simulation.scene(), model.simulation.system(), None);
        let mut session = Self {
            present: Version { document: Document::new(source, scene.clone()), scene },
            undo: UndoHistory::default(),
            model,
            most_unknowns: MAX_UNKNOWNS,
            background: Background::default(),
            running: true,
            frame: FrameWork {
                limit: MAX_FRAME_WORK,
                left: MAX_FRAME_WORK,
                is_from_rest: true,
                ..FrameWork::default()
            },
            playback: Playback::default(),
            fallback: Fallback::default(),
            before_grab: None,
            facts: Facts::default(),
            is_outdated: false,
            changed: Changed::default(),
            notices: Vec::new(),
        };
        session.fallback.keep(&session.model.simulation);
        session
    }

    pub(crate) fn document(&self) -> &Document {
        &self.present.document
    }

    /// Returns the requested scene.
    pub(crate) fn scene(&self) -> &Scene {
        &self.present.scene
    }

    pub(crate) fn simulation(&self) -> &Simulation {
        &self.model.simulation
    }

    /// Returns the solution of linear theory.
    pub fn linear(&self) -> Option<&Simulation> {
        self.model.linear.as_ref()
    }

    /// Returns the reference solution that errors of the displayed result are measured against, or the reason for which
    /// there is none; `None` while neither is known.
    pub(crate) fn reference(&self) -> Option<Result<&Reference, &Sentence>> {
        static UNSTABLE: LazyLock<Sentence> = LazyLock::new(|| (&StudyError::Unstable).into());
        if is_unstable(&self.model.simulation, false) {
            return Some(Err(&UNSTABLE));
        }
        let facts = &self.facts.reference;
        facts.failure(&self.present.scene).map(Err).or_else(|| facts.get(&self.present.scene).map(Ok))
    }

    /// Returns the reason why the reference solution could not be computed.
    pub(crate) fn reference_failure(&self) -> Option<&Sentence> {
        self.reference()?.err()
    }

    /// Returns the load path from rest, compared with the state; `None` until it has been computed.
    pub(crate) fn path(&self) -> Option<PathSummary> {
        let path = self.facts.path.get(&self.present.scene)?;
        // Only an equilibrium is the end of a path, or of another one.
        let is_end = *self.model.simulation.status() == Status::Converged && !self.is_grabbed();
        is_end.then(|| path.to(self.model.simulation.displacement()))
    }

    /// Returns the reference solution, or the one that follows the load.
    pub(crate) fn known_reference(&self) -> Option<&Reference> {
        self.reference().and_then(Result::ok).or_else(|| self.live().map(|live| &live.reference))
    }

    /// Returns the reference solution that follows the load, until that of [`Self::reference`] is known. Scenes without an
    /// error at rest have none.
    pub(crate) fn live(&self) -> Option<&Live> {
        let has_error = |reference: &Reference| reference.first().is_some();
        let is_wanted = self.reference().is_none() && self.facts.reference.latest().is_some_and(has_error);
        self.facts
            .live
            .known
            .as_deref()
            .filter(|live| is_wanted && live.reference.first().is_some() && live.is_of_body(&self.present.scene))
    }

    /// Returns time and result of a solve from rest; `None` if they are not known for the present load, or the body is
    /// grabbed: the solve is without the pull.
    pub fn timed_from_rest(&self) -> Option<&SolveFromRest> {
        self.timed_solve().filter(|_| !self.is_grabbed())
    }

    fn timed_solve(&self) -> Option<&SolveFromRest> {
        let own =
            self.facts.timed.as_ref().filter(|(timed, _)| *timed.scene() == self.present.scene).map(|(_, solve)| solve);
        self.facts.time.get(&self.present.scene).or(own)
    }

    /// Returns time and result at the load at which the hand rested last, during the drag of a load.
    pub(crate) fn last_from_rest(&self) -> Option<&SolveFromRest> {
        self.facts.time.latest().filter(|_| self.frame.is_held && !self.is_grabbed())
    }

    fn is_grabbed(&self) -> bool {
        self.model.simulation.mouse_spring().is_some()
    }

    /// Returns `true` if the scene is a motion.
    pub(crate) fn is_motion(&self) -> bool {
        self.model.simulation.motion().is_some()
    }

    /// Returns `true` if iterations or time steps are being made.
    pub(crate) fn is_running(&self) -> bool {
        self.running
    }

    /// Returns `true` if the next frame changes the body.
    pub(crate) fn iterates(&self) -> bool {
        self.running && !self.has_ended()
    }

    /// Returns `true` if everything is at rest and the next iteration changes nothing.
    pub(crate) fn has_ended(&self) -> bool {
        self.model.simulation.is_at_rest()
    }

    /// Returns `true` if a search has ended without an equilibrium.
    pub(crate) fn has_failed(&self) -> bool {
        is_lost(&self.model.simulation)
    }

    /// Returns `true` if the scene has unsaved edits.
    pub(crate) fn is_edited(&self) -> bool {
        self.unsaved().is_some()
    }

    /// Returns the edited scene and its document; `None` if there are no unsaved edits.
    pub(crate) fn unsaved(&self) -> Option<&Version> {
        Some(&self.present).filter(|present| present.scene != present.document.original)
    }

    /// Returns the body drawn in place of the simulation, whose search has found no equilibrium; `None` if the simulation
    /// is drawn.
    pub(crate) fn fallback(&self) -> Option<&Simulation> {
        // An iterate that was asked for, or of a body that is not dragged, is drawn however far it is from equilibrium.
        let goes_on = self.running && self.frame.is_held && !self.frame.is_slow && !self.is_in_background();
        let is_wild = goes_on && self.model.simulation.residual() > WILD;
        let is_hidden = match self.model.simulation.status() {
            Status::Running => is_wild && !self.is_motion(),
            _ => is_lost(&self.model.simulation),
        };
        self.fallback.of(&self.model.simulation).filter(|_| is_hidden)
    }

    /// Returns the drawn body: the simulation, or the last equilibrium or the body at rest in place of a search that has
    /// found none.
    pub(crate) fn drawn(&self) -> &Simulation {
        self.fallback().unwrap_or(&self.model.simulation)
    }

    pub(crate) fn set_running(&mut self, running: bool) {
        self.running = running;
        if !running {
            self.stop_solve();
        }
    }

    /// Pauses. A background solve continues to its end.
    pub(crate) fn pause(&mut self) {
        self.running = false;
    }

    /// Makes the iterations of one displayed frame, or the time steps that are due at `now`, s (any clock that runs in real
    /// time). Returns `true` if it has iterated.
    pub(crate) fn advance(&mut self, now: f64) -> bool {
        self.poll();
        self.frame.left = self.frame.limit;
        if self.is_in_background() || !self.iterates() {
            self.playback.clock.rest();
            return false;
        }
        if self.is_motion() {
            self.playback.advance(now, &mut self.model.simulation);
            self.frame.timings = *self.model.simulation.last_iteration();
            return false;
        }
        // The edit that a drag makes in this frame comes first.
        self.frame.is_postponed = std::mem::take(&mut self.frame.was_edited) && !self.frame.is_slow;
        if !self.frame.is_postponed {
            self.search();
        }
        true
    }

    /// Iterates until the search ends or the frame has no more time; once in slow motion.
    fn search(&mut self) {
        self.frame.timings = Timings::default();
        let since = Instant::now();
        while *self.model.simulation.status() == Status::Running {
            self.iterate_once();
            // After a search from another state that has found no equilibrium, an iteration may lead to one from rest.
            let simulation = &mut self.model.simulation;
            let is_free = simulation.mouse_spring().is_none() && !self.frame.is_slow;
            if is_lost(simulation) && is_free && !std::mem::replace(&mut self.frame.is_from_rest, true) {
                self.playback.reset(simulation);
            }
            if self.frame.is_slow || since.elapsed() >= self.frame.left {
                break;
            }
        }
        self.frame.left = self.frame.left.saturating_sub(since.elapsed());
    }

    /// Iterates after an edit, in the same frame; returns `true` if that has changed what the frame shows.
    pub(crate) fn follow_edit(&mut self) -> bool {
        let is_edited = std::mem::take(&mut self.frame.is_edited_now) && !self.is_motion();
        self.frame.was_edited |= is_edited;
        let has_news = std::mem::take(&mut self.frame.is_postponed) || is_edited;
        if has_news && self.iterates() && !(self.is_motion() || self.frame.is_slow || self.is_in_background()) {
            self.search();
        }
        has_news
    }

    /// Makes one iteration or time step.
    pub(crate) fn iterate(&mut self) {
        if self.is_motion() {
            self.playback.step(&mut self.model.simulation);
            self.frame.timings = *self.model.simulation.last_iteration();
            return;
        }
        self.frame.timings = Timings::default();
        self.iterate_once();
    }

    fn iterate_once(&mut self) {
        if *self.model.simulation.status() == Status::Running {
            self.model.step();
            self.frame.timings.add(self.model.simulation.last_iteration());
            self.fallback.keep(&self.model.simulation);
        }
    }

    /// Pauses, and makes one iteration or time step; a finished iteration restarts from rest.
    pub(crate) fn step(&mut self) {
        self.running = false;
        let is_at_rest = self.model.simulation.is_at_rest();
        if self.is_in_background() {
            return self.restart_in_background(is_at_rest, Some(1));
        }
        if !self.is_motion() && is_at_rest {
            self.reset();
        }
        self.iterate();
    }

    /// Returns to rest, or to the start of the motion.
    pub(crate) fn reset(&mut self) {
        if self.is_in_background() {
            return self.restart_in_background(true, None);
        }
        self.playback.reset(&mut self.model.simulation);
        self.model.residuals.clear();
        self.frame.is_from_rest = true;
    }

    /// Iterates until the status is final, or to the end of the motion's duration.
    fn iterate_to_end(&mut self) {
        while *self.model.simulation.status() == Status::Running {
            self.iterate();
        }
    }

    /// Iterates to the end, and computes the results, with ρ if it is shown.
    pub(crate) fn solve(&mut self, shows_rho: bool) {
        self.poll();
        while self.take_update(true) {
            self.poll();
        }
        self.iterate_to_end();
        if self.is_motion() {
            return;
        }
        self.certify();
        let shows_rho = shows_rho || self.lacks_rho();
        self.facts.request_at_rest(&self.present.scene, shows_rho, false, true);
    }

    /// Solves the scene from rest and certifies the result, or computes ρ at the equilibrium that the warped iteration does
    /// not reach; for a body so small that this takes less than a frame.
    pub(crate) fn solve_from_rest(&mut self) {
        self.reset();
        self.iterate_to_end();
        self.certify();
        if self.lacks_rho() {
            self.facts.rho.wait(&self.present.scene);
        }
    }

    /// Displays `state`; returns `false` if it does not fit the mesh.
    pub(crate) fn restore(&mut self, state: &State) -> bool {
        self.model.simulation.restore(state).is_ok()
    }

    /// Grabs, pulls and releases the body. A release restores the equilibrium before the grab, unless the scene has changed.
    pub(crate) fn grab(&mut self, grab: Grab) {
        if self.is_in_background() {
            return;
        }
        if let Some(point) = grab.start {
            // If the body is in equilibrium, a copy is grabbed and the original is kept for the release.
            let is_final = self.model.simulation.status().is_success();
            match self.model.snapshot().filter(|_| is_final) {
                Some(mut copy) => {
                    if copy.simulation.grab(point) {
                        self.before_grab = Some((std::mem::replace(&mut self.model, copy), self.frame.timings));
                    }
                }
                None => _ = self.model.simulation.grab(point),
            }
        }
        if let Some(target) = grab.target
            && self.model.simulation.mouse_spring().is_some_and(|(spring, _)| spring.target() != target)
        {
            // Pulling fails only for a position that is not finite; the pointer's is.
            let _ = self.model.simulation.pull_to(target);
            self.frame.is_edited_now = true;
        }
        if grab.release {
            self.release();
        }
    }

    fn release(&mut self) {
        let before = self.before_grab.take();
        if let Some(before) = before.filter(|(model, _)| model.simulation.scene() == self.model.simulation.scene()) {
            (self.model, self.frame.timings) = before;
            return;
        }
        self.frame.is_from_rest = false;
        self.model.simulation.release();
        self.begin_accepted_at_rest();
    }

    /// Goes back to rest if results are accepted early, which would depend on the state before.
    fn begin_accepted_at_rest(&mut self) {
        if self.scene().solver.accept_after > 0 && !self.is_motion() {
            self.reset();
        }
    }

    /// Displays the recorded moment of a motion that is closest to `time`, s, and pauses there.
    pub(crate) fn show_moment(&mut self, time: f64) {
        self.running = false;
        self.playback.show_moment(time, &mut self.model.simulation);
    }

    /// Displays the next recorded moment (`forward`) or the previous one, and pauses there. After the last one, makes a
    /// time step.
    pub(crate) fn show_neighbour(&mut self, forward: bool) {
        self.running = false;
        let is_shown = self.playback.show_neighbour(forward, &mut self.model.simulation);
        if forward && !is_shown {
            self.iterate();
        }
    }
}

/// Returns `true` if two scenes have the same mesh.
pub(crate) fn has_mesh_of(scene: &Scene, other: &Scene) -> bool {
    scene.beam == other.beam && scene.mesh == other.mesh
}
