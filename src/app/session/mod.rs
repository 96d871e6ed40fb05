//! One model being worked on, without user interface: scene, simulation, solution of linear theory, motion, undo
//! history, file, and results computed in the background.

mod background;
pub(crate) mod clock;
pub(crate) mod document;
pub(crate) mod facts;
pub(crate) mod fallback;
pub(crate) mod history;
pub(crate) mod playback;
pub(crate) mod recovery;
pub(crate) mod run;
#[cfg(test)]
mod tests;
pub(crate) mod undo;

use std::sync::LazyLock;

use crate::app::platform::IS_PAGE;
use crate::app::prelude::*;
use crate::app::session::background::Background;
use crate::app::session::document::Document;
use crate::app::session::facts::{Facts, Follower, Live, ShownFacts, first_probe};
use crate::app::session::fallback::{Fallback, is_lost};
use crate::app::session::playback::Playback;
use crate::app::session::undo::{Press, UndoHistory, Version};
use crate::app::task::solve::{MAX_UNKNOWNS, Model, Quality, solve_linear};
use crate::app::task::thread::{Reporter, Task, Update};
use crate::mesh::MaterialPoint;
use crate::render::display_geometry::DisplayGeometry;
use crate::simulation::{Equilibrium, SimulationError};
use crate::state::State;
use crate::study::{SolveFromRest, StudyError, is_unstable};
use crate::timings::Timings;

/// Time of iterations after which a displayed frame makes no more.
const MAX_FRAME_WORK: Duration = Duration::from_millis(8);
/// Number of unknowns above which a result is certified in the background: its eigenvalues then take longer than
/// [`MAX_FRAME_WORK`].
const MAX_CERTIFIED_HERE: usize = 2000;

/// Change of the model that can be undone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Edit {
    /// Change the scene with the control of this label. Edits with one control during one press are one undo step.
    Scene(&'static str, Box<Scene>),
    /// Open a scene in place of the current one.
    Open(Source),
    /// Replace the document, and the scene by one that may have been edited since the document was saved.
    Restore(Box<Version>),
    Undo,
    Redo,
}

/// Parts of the session that have changed since the window was last updated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Changed {
    pub scene: bool,
    /// `true` if the mesh has changed.
    pub mesh: bool,
    /// `true` if the scene comes from another document.
    pub document: bool,
    /// `true` if the mesh or the kind of analysis has changed, or an exploded motion has started again.
    pub restart: bool,
}

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

/// One model being worked on.
#[derive(Debug)]
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
    /// `true` if a displayed frame makes one iteration: slow motion of the method.
    pub is_slow: bool,
    /// Time of iterations after which a displayed frame makes no more.
    pub frame_work: Duration,
    /// Part of this time that is left in the current frame.
    frame_left: Duration,
    /// `true` while the pointer is pressed.
    is_held: bool,
    /// `true` if the scene has been edited since the last [`Self::follow_edit`].
    is_edited_now: bool,
    /// `true` if the frame before, in which there was such an edit, has left the search unfinished.
    was_edited: bool,
    /// `true` if the search began at rest.
    is_from_rest: bool,
    /// `true` if this frame iterates once it is known that there is no edit.
    is_postponed: bool,
    /// Time of the iterations of the last displayed frame.
    timings: Timings,
    pub(crate) playback: Playback,
    /// Certification of a copy of the displayed body.
    pub(crate) certifying: Option<Task<(), Box<(Simulation, Quality)>>>,
    /// Bodies drawn in place of a search that has found no equilibrium.
    fallback: Fallback,
    /// Equilibrium before the body was grabbed, which its release restores, and the time of its iterations.
    before_grab: Option<(Model, Timings)>,
    facts: Facts,
    live: Follower,
    /// Body that is solved from rest to measure the time of a dragged load, and the last such solve with its scene.
    timed: Option<(Simulation, SolveFromRest)>,
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
            is_slow: false,
            frame_work: MAX_FRAME_WORK,
            frame_left: MAX_FRAME_WORK,
            is_held: false,
            is_edited_now: false,
            was_edited: false,
            is_from_rest: true,
            is_postponed: false,
            timings: Timings::default(),
            playback: Playback::default(),
            certifying: None,
            fallback: Fallback::default(),
            before_grab: None,
            facts: Facts::default(),
            live: Follower::default(),
            timed: None,
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

    pub(crate) fn quality(&self) -> &Quality {
        &self.model.quality
    }

    pub(crate) fn facts(&self) -> &Facts {
        &self.facts
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

    /// Returns the reference solution, or the one that follows the load.
    pub(crate) fn known_reference(&self) -> Option<&Reference> {
        self.reference().and_then(Result::ok).or_else(|| self.live().map(|live| &live.reference))
    }

    /// Returns the reference solution that follows the load, until that of [`Self::reference`] is known. Scenes without an
    /// error at rest have none.
    pub(crate) fn live(&self) -> Option<&Live> {
        let has_error = |reference: &Reference| reference.first().is_some();
        let is_wanted = self.reference().is_none() && self.facts.reference.latest().is_some_and(has_error);
        self.live
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
        let own = self.timed.as_ref().filter(|(timed, _)| *timed.scene() == self.present.scene).map(|(_, solve)| solve);
        self.facts.time.get(&self.present.scene).or(own)
    }

    /// Returns time and result at the load at which the hand rested last, during the drag of a load.
    pub(crate) fn last_from_rest(&self) -> Option<&SolveFromRest> {
        self.facts.time.latest().filter(|_| self.is_held && !self.is_grabbed())
    }

    fn is_grabbed(&self) -> bool {
        self.model.simulation.mouse_spring().is_some()
    }

    pub(crate) fn timings(&self) -> &Timings {
        &self.timings
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
        let goes_on = self.running && self.is_held && !self.is_slow && !self.is_in_background();
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

    /// Records the presses of the pointer: edits during one press are one undo step.
    pub(crate) fn record_press(&mut self, press: Press) {
        self.is_held = press.goes_on;
        self.undo.record_press(press);
    }

    /// Applies an edit, and returns the parts that have changed. A large model is set up in the background; the display
    /// changes when it is solved.
    ///
    /// # Errors
    /// Reason for which the edit was refused; the session is unchanged. Errors of a mesh that is made in the background
    /// are reported later as a [`Notice`].
    pub(crate) fn apply(&mut self, edit: Edit) -> Result<Changed, Sentence> {
        let before = self.present.clone();
        let has_exploded = self.is_motion() && matches!(self.model.simulation.status(), Status::Stopped(_));
        let (mut label, is_step) = (None, matches!(edit, Edit::Undo | Edit::Redo));
        let applied = match edit {
            Edit::Scene(control, scene) => {
                label = Some(control);
                self.set_scene(*scene)
            }
            Edit::Open(source) => {
                // A built-in scene keeps its edits. Chosen while it is the present scene, it is opened without them.
                let is_kept = source.built_in().is_some() && source != before.document.source;
                let version = match self.undo.last_of(&source).filter(|_| is_kept).cloned() {
                    Some(version) => version,
                    None => {
                        let document = Document::open(source)?;
                        Version { scene: document.original.clone(), document }
                    }
                };
                self.replace(version)
            }
            Edit::Restore(version) => self.replace(*version),
            Edit::Undo => self.undo.undo(before.clone()).map_or(Ok(()), |step| self.go_to(step)),
            Edit::Redo => self.undo.redo(before.clone()).map_or(Ok(()), |step| self.go_to(step)),
        };
        applied.map_err(refusal)?;
        if !is_step && before != self.present {
            self.undo.record(before, label);
        }
        if label.is_some() {
            self.background.before.iter_mut().for_each(|before| before.label = label);
        }
        // With other settings an exploded body would still be kilometres long.
        if has_exploded && self.is_motion() {
            self.reset();
            self.changed.restart = true;
        }
        Ok(self.changed)
    }

    fn go_to(&mut self, step: Version) -> Result<(), SimulationError> {
        let is_same = step.document.source == self.present.document.source;
        if is_same { self.set_scene(step.scene) } else { self.replace(step) }
    }

    /// Changes the scene of the body, which continues from its current state if possible.
    ///
    /// # Errors
    /// [`SimulationError`]; the session is unchanged.
    pub(crate) fn set_scene(&mut self, scene: Scene) -> Result<(), SimulationError> {
        if self.is_for_background(&scene) {
            scene.validate()?;
            self.running |= !self.is_motion();
            self.request_scene(scene);
            self.poll();
            return Ok(());
        }
        let before = self.model.simulation.scene().clone();
        self.model.simulation.change_scene(&scene)?;
        let is_another_document = self.background.before.as_ref().is_some_and(|before| before.is_another_document);
        self.background = Background::default();
        if !has_mesh_of(&scene, &before) {
            self.model.geometry = Arc::new(DisplayGeometry::new(self.model.simulation.system().mesh()));
        }
        self.present.scene = scene;
        (self.is_edited_now, self.running) = (true, self.running || !self.is_motion());
        self.scene_changed(&before);
        self.begin_accepted_at_rest();
        let known = self.model.linear.take();
        self.model.linear = solve_linear(self.model.simulation.scene(), self.model.simulation.system(), known);
        if is_another_document {
            self.start_document();
            self.reset();
        }
        Ok(())
    }

    /// Updates everything that depends on the simulation's scene after it has changed from `before`.
    fn scene_changed(&mut self, before: &Scene) {
        self.changed.scene = true;
        self.fallback.keep(&self.model.simulation);
        let scene = self.model.simulation.scene();
        if scene == before {
            return;
        }
        self.is_from_rest = false;
        let is_another_mesh = !has_mesh_of(scene, before);
        let is_another_body = is_another_mesh || scene.analysis != before.analysis;
        self.changed.mesh |= is_another_mesh;
        self.changed.restart |= is_another_body;
        self.playback.change_scene(&self.model.simulation, is_another_body);
        self.facts.turn_to(scene);
        // A time step with other settings takes another time.
        let is_another_step = is_another_body || (&scene.dynamics, &scene.solver) != (&before.dynamics, &before.solver);
        if scene.analysis == Analysis::Dynamic && is_another_step {
            self.timings = Timings::default();
        }
    }

    /// Replaces the document.
    pub(crate) fn replace(&mut self, Version { document, scene }: Version) -> Result<(), SimulationError> {
        if self.is_for_background(&scene) {
            scene.validate()?;
            self.request_scene(scene);
            self.present.document = document;
            self.check_file();
            self.background.from_rest = true;
            self.background.before.iter_mut().for_each(|before| before.is_another_document = true);
            self.poll();
            return Ok(());
        }
        self.set_scene(scene)?;
        self.present.document = document;
        self.check_file();
        self.start_document();
        self.reset();
        Ok(())
    }

    /// Resets everything that belongs to the document to its default.
    fn start_document(&mut self) {
        self.changed.document = true;
        self.running = true;
        self.playback = Playback::default();
        self.facts.curve.clear();
        self.live = Follower::default();
        self.is_slow = false;
    }

    /// Makes the current scene the unedited scene of a document; the undo history is cleared.
    pub(crate) fn rebase(&mut self, source: Source) {
        self.present.document = Document::new(source, self.present.scene.clone());
        self.undo = UndoHistory::default();
        self.is_slow = false;
    }

    /// Saves the scene to a file, which is the document from now on. Undo does not return to the previous file.
    ///
    /// # Errors
    /// Reason for which the scene was not saved; the file is unchanged.
    pub(crate) fn save(&mut self, path: &Path) -> Result<(), Sentence> {
        let saved = self.present.document.save(&self.present.scene, path)?;
        let before = std::mem::replace(&mut self.present.document, saved);
        let in_background = self.background.before.iter_mut().map(|before| &mut before.version);
        let earlier = in_background.chain(self.undo.adjacent_versions(&before.source));
        for version in earlier.filter(|version| version.document.source == before.source) {
            version.document.clone_from(&self.present.document);
        }
        self.is_outdated = false;
        Ok(())
    }

    /// Checks whether the scene's file has changed on disk.
    pub(crate) fn check_file(&mut self) {
        self.is_outdated = self.present.document.has_changed();
    }

    /// Keeps the scene although its file has changed on disk, and stops reporting that change.
    pub(crate) fn ignore_file_change(&mut self) {
        self.present.document.text = self.present.document.read();
        self.is_outdated = false;
    }

    /// Returns the scene with load number `load` as in its document; `None` if the document has no load of the same
    /// kind with this number.
    pub(crate) fn with_original_load(&self, load: usize) -> Option<Scene> {
        let original = self.present.document.original.loads.get(load)?;
        let mut scene = self.present.scene.clone();
        let present = scene.loads.get_mut(load)?;
        if std::mem::discriminant(original) != std::mem::discriminant(present) {
            return None;
        }
        present.clone_from(original);
        Some(scene)
    }

    /// Starts or stops iterating.
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
        self.frame_left = self.frame_work;
        if self.is_in_background() || !self.iterates() {
            self.playback.clock.rest();
            return false;
        }
        if self.is_motion() {
            self.playback.advance(now, &mut self.model.simulation);
            self.timings = *self.model.simulation.last_iteration();
            return false;
        }
        // The edit that a drag makes in this frame comes first.
        self.is_postponed = std::mem::take(&mut self.was_edited) && !self.is_slow;
        if !self.is_postponed {
            self.search();
        }
        true
    }

    /// Iterates until the search ends or the frame has no more time; once in slow motion.
    fn search(&mut self) {
        self.timings = Timings::default();
        let since = Instant::now();
        while *self.model.simulation.status() == Status::Running {
            self.iterate_once();
            self.start_again();
            if self.is_slow || since.elapsed() >= self.frame_left {
                break;
            }
        }
        self.frame_left = self.frame_left.saturating_sub(since.elapsed());
    }

    /// Goes back to rest after a search from another state that has found no equilibrium: an iteration may lead to one from
    /// there.
    fn start_again(&mut self) {
        let simulation = &mut self.model.simulation;
        let is_free = simulation.mouse_spring().is_none() && !self.is_slow;
        if is_lost(simulation) && is_free && !std::mem::replace(&mut self.is_from_rest, true) {
            self.playback.reset(simulation);
        }
    }

    /// Iterates after an edit, in the same frame; returns `true` if that has changed what the frame shows.
    pub(crate) fn follow_edit(&mut self) -> bool {
        let is_edited = std::mem::take(&mut self.is_edited_now) && !self.is_motion();
        self.was_edited |= is_edited;
        let has_news = std::mem::take(&mut self.is_postponed) || is_edited;
        if has_news && self.iterates() && !self.is_slow && !self.is_in_background() {
            self.search();
        }
        has_news
    }

    /// Makes one iteration or time step.
    pub(crate) fn iterate(&mut self) {
        if self.is_motion() {
            self.playback.step(&mut self.model.simulation);
            self.timings = *self.model.simulation.last_iteration();
            return;
        }
        self.timings = Timings::default();
        self.iterate_once();
    }

    fn iterate_once(&mut self) {
        if *self.model.simulation.status() == Status::Running {
            self.model.step();
            self.timings.add(self.model.simulation.last_iteration());
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
        self.is_from_rest = true;
    }

    /// Iterates until the status is final, or to the end of the motion's duration, and computes the results.
    pub(crate) fn solve(&mut self, shown: ShownFacts<'_>) {
        self.poll();
        while self.take_update(true) {
            self.poll();
        }
        while *self.model.simulation.status() == Status::Running {
            self.iterate();
        }
        if self.is_motion() {
            return shown.limits_of.into_iter().for_each(|scene| self.facts.limits.wait(scene));
        }
        self.certify();
        let shown = ShownFacts { rho: shown.rho || self.lacks_rho(), ..shown };
        self.facts.request_at_rest(&self.present.scene, shown, true);
    }

    /// Solves the scene from rest and certifies the result, or computes ρ at the equilibrium that the warped iteration does
    /// not reach; for a body so small that this takes less than a frame.
    pub(crate) fn solve_from_rest(&mut self) {
        self.reset();
        while *self.model.simulation.status() == Status::Running {
            self.iterate();
        }
        self.certify();
        if self.lacks_rho() {
            self.facts.rho.wait(&self.present.scene);
        }
    }

    fn certify(&mut self) {
        self.model.simulation.certify();
        self.fallback.keep(&self.model.simulation);
        let mut quality = std::mem::take(&mut self.model.quality);
        quality.update(self.drawn());
        self.model.quality = quality;
    }

    /// Certifies the result, that of a large body in the background; returns `true` while that is pending.
    fn request_certificate(&mut self) -> bool {
        if let Some(task) = &self.certifying {
            match task.poll() {
                Update::None | Update::Progress(()) => return true,
                Update::Done(certified) => {
                    let (own, simulation) = (&self.model.simulation, &certified.0);
                    let is_current = simulation.state() == own.state()
                        && simulation.scene() == own.scene()
                        && simulation.status() == own.status()
                        && own.mouse_spring().is_none();
                    if is_current {
                        (self.model.simulation, self.model.quality) = *certified;
                        self.certify();
                    }
                }
                Update::Died => self.certify(),
            }
            self.certifying = None;
        }
        let is_known = !self.model.simulation.equilibrium().is_some_and(Equilibrium::needs_certificate)
            && self.model.quality.is_of(self.drawn());
        let is_small = self.model.simulation.system().dofs() <= MAX_CERTIFIED_HERE;
        let copy = self.model.simulation.equilibrium().filter(|_| !(is_known || is_small || IS_PAGE));
        let started = copy.map(Equilibrium::snapshot).and_then(|mut copy| {
            let work = move |_: &Reporter<_, _>| {
                let quality = Quality::certified(&mut copy);
                Box::new((copy, quality))
            };
            Task::start("certify", work).ok()
        });
        self.certifying = started;
        if self.certifying.is_none() {
            self.certify();
        }
        self.certifying.is_some()
    }

    /// Requests the results of the scene once the body is at rest; returns `true` while one of them is pending. During a
    /// press only those that a frame has time for are requested, and the reference that follows the load.
    pub(crate) fn request_facts(&mut self, shown: ShownFacts<'_>, is_pressed: bool) -> bool {
        if self.is_motion() {
            return shown.limits_of.is_some_and(|scene| self.facts.limits.request(scene));
        }
        if self.iterates() || self.is_working() {
            return false;
        }
        // A background solve has certified its result.
        let certifies = !self.is_in_background() && self.request_certificate();
        let follows = self.follow_reference();
        if is_pressed {
            self.time_in_frame();
            return follows || certifies;
        }
        let shown = ShownFacts { rho: shown.rho || self.lacks_rho(), ..shown };
        self.facts.request_at_rest(&self.present.scene, shown, false) || follows || certifies
    }

    /// Requests the reference that follows the load of a body of few unknowns, also at rest: its solutions are then ready
    /// when a drag begins. Returns `true` while it is pending.
    fn follow_reference(&mut self) -> bool {
        let simulation = &self.model.simulation;
        let is_found = simulation.status().is_success();
        let is_wanted = (is_found || is_lost(simulation)) && simulation.mouse_spring().is_none();
        if !is_wanted || simulation.system().dofs() > MAX_CERTIFIED_HERE {
            return self.live.poll();
        }
        let linear = self.model.linear.as_ref().and_then(first_probe);
        self.live.request(&self.present.scene, first_probe(simulation).filter(|_| is_found), linear)
    }

    /// Returns `true` while the reference that follows the load is being computed.
    pub fn is_following(&self) -> bool {
        self.live.running.is_some()
    }

    /// Measures the time of a solve from rest, if it was short at the last rest; if that failed, if the last search was.
    fn time_in_frame(&mut self) {
        /// Largest time of a solve in a frame.
        const SHORT: Duration = Duration::from_millis(2);
        let last = self.facts.time.latest().filter(|solve| solve.is_solved);
        let time = last.map_or(self.timings.total(), |solve| solve.timings.total());
        if time >= SHORT || self.timed_solve().is_some() {
            return;
        }
        let timed = self.timed.take().map(|(timed, _)| timed);
        let timed = timed.filter(|timed| Arc::ptr_eq(timed.system(), self.model.simulation.system()));
        let timed =
            timed.or_else(|| Simulation::with_system(&self.present.scene, self.model.simulation.system().clone()).ok());
        let Some(mut timed) = timed.filter(|_| !IS_PAGE) else { return };
        if timed.change_scene(&self.present.scene).is_ok() {
            timed.reset();
            timed.solve();
            let solve = SolveFromRest::of(&timed);
            self.timed = Some((timed, solve));
        }
    }

    /// Cancels the computation of limits, unless it is for this scene.
    pub(crate) fn turn_limits_to(&mut self, scene: Option<&Scene>) {
        match scene {
            Some(scene) => self.facts.limits.turn_to(scene),
            None if self.facts.limits.progress().is_some() => self.facts.limits.clear(),
            None => {}
        }
    }

    /// Requests the reference solution, in any state of the body, or computes it and `waits`; returns `true` while it is
    /// pending.
    pub(crate) fn obtain_reference(&mut self, waits: bool) -> bool {
        self.facts.reference.obtain(&self.present.scene, waits)
    }

    /// Returns `true` if the warped iteration has ended without a result that has a ρ of its own.
    pub(crate) fn lacks_rho(&self) -> bool {
        let is_warped = self.present.scene.solver.method == MethodKind::Warped && !self.is_motion();
        is_warped && self.has_ended() && *self.model.simulation.status() != Status::Converged
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
            self.start_grab(point);
        }
        if let Some(target) = grab.target
            && self.model.simulation.mouse_spring().is_some_and(|(spring, _)| spring.target() != target)
        {
            // Pulling fails only for a position that is not finite; the pointer's is.
            let _ = self.model.simulation.pull_to(target);
            self.is_edited_now = true;
        }
        if grab.release {
            self.release();
        }
    }

    /// Grabs the body at a material point. If the body is in equilibrium, a copy is grabbed and the original is kept
    /// for the release.
    fn start_grab(&mut self, point: MaterialPoint) {
        let is_final = self.model.simulation.status().is_success();
        match self.model.snapshot().filter(|_| is_final) {
            Some(mut copy) => {
                if copy.simulation.grab(point) {
                    self.before_grab = Some((std::mem::replace(&mut self.model, copy), self.timings));
                }
            }
            None => _ = self.model.simulation.grab(point),
        }
    }

    fn release(&mut self) {
        let before = self.before_grab.take();
        if let Some(before) = before.filter(|(model, _)| model.simulation.scene() == self.model.simulation.scene()) {
            (self.model, self.timings) = before;
            return;
        }
        self.is_from_rest = false;
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

/// Returns the name of the support or load that a key of a scene belongs to, with its number in the panel, or the key.
pub(crate) fn object_name(key: &str) -> String {
    let mut parts = key.split('.');
    match (parts.next(), parts.next().and_then(|i| i.parse::<usize>().ok())) {
        (Some("support"), Some(i)) => fill!("Support %{n}", n = i + 1),
        (Some("load"), Some(i)) => fill!("Load %{n}", n = i + 1),
        _ => key.to_owned(),
    }
}

/// Returns the reason for which an edit was refused, in the words of the panel.
fn refusal(error: SimulationError) -> Sentence {
    match error {
        SimulationError::Scene(invalid) if invalid.key == "support" => {
            sentence!("the body could move freely: supports must hold it along x, along y and against rotation")
        }
        SimulationError::Scene(invalid) => Sentence::located(object_name(&invalid.key), invalid.message.clone()),
        other => (&other).into(),
    }
}
