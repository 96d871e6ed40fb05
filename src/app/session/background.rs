//! Background solve of large models, one at a time. The last snapshot stays on display; edits change the requested
//! scene, which the next solve uses.

use std::sync::Arc;

use web_time::{Duration, Instant};

use crate::app::session::document::Document;
use crate::app::session::undo::Version;
use crate::app::session::{Notice, Session, has_mesh_of};
use crate::app::task::background_solve::{BackgroundSolve, SolveUpdate};
use crate::app::task::quality::Quality;
use crate::app::task::solve::{
    Bodies, MAX_PANE_UNKNOWNS, MAX_UNKNOWNS, Model, Phase, Rejected, Snapshot, SolveRequest, SolveStart, Solved,
};
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::{Analysis, Scene};
use crate::simulation::{Equilibrium, Simulation, Status};

/// Time after which the meshing of a body that is solved between two frames is shown.
const SOON: Duration = Duration::from_millis(500);

/// Background work of a session.
#[derive(Debug)]
pub(super) struct Background {
    /// Models with more unknowns than this are solved in the background.
    most_unknowns: u64,
    /// `true` if the requested scene has more unknowns than `most_unknowns`. Stored, because counting those of a mesh
    /// file takes too long for every frame.
    is_large: bool,
    work: SolveState,
    /// Model of a cancelled or rejected solve that is not displayed: the next solve continues with it.
    returned: Option<(Bodies, Option<Arc<DisplayGeometry>>)>,
    /// Initial state of the next solve.
    start: SolveStart,
    iterations: Option<u32>,
}

/// State of the background solve.
#[derive(Debug, Default)]
enum SolveState {
    /// The simulation is displayed and complete.
    #[default]
    Idle,
    /// An edit waits for the background thread to start.
    Waiting { rollback: Box<Rollback> },
    /// A solve is in progress; without a rollback the user has cancelled it, and the thread has not ended yet.
    Running { solve: Box<BackgroundSolve>, rollback: Option<Box<Rollback>> },
}

/// Session before the first edit whose result is incomplete, restored if that edit is cancelled.
#[derive(Debug)]
struct Rollback {
    since: Instant,
    version: Version,
    /// Number of undo steps.
    depth: usize,
    /// Label of the control that was edited.
    label: Option<&'static str>,
    /// `true` while the scene of a newly opened document is not displayed yet.
    is_another_document: bool,
    /// Display before the first snapshot.
    snapshot: Option<Snapshot>,
    quality: Quality,
}

impl Default for Background {
    fn default() -> Self {
        Self {
            most_unknowns: MAX_UNKNOWNS,
            is_large: false,
            work: SolveState::Idle,
            returned: None,
            start: SolveStart::Present,
            iterations: None,
        }
    }
}

impl SolveState {
    fn solve(&self) -> Option<&BackgroundSolve> {
        if let Self::Running { solve, .. } = self { Some(solve) } else { None }
    }

    fn solve_mut(&mut self) -> Option<&mut BackgroundSolve> {
        if let Self::Running { solve, .. } = self { Some(solve) } else { None }
    }

    fn rollback(&mut self) -> Option<&mut Rollback> {
        match self {
            Self::Running { rollback, .. } => rollback.as_deref_mut(),
            Self::Waiting { rollback } => Some(rollback),
            Self::Idle => None,
        }
    }

    /// Takes the solve that has ended; its rollback waits for the next one.
    fn take_solve(&mut self) -> Option<Box<BackgroundSolve>> {
        match std::mem::take(self) {
            Self::Running { solve, rollback } => {
                *self = rollback.map_or(Self::Idle, |rollback| Self::Waiting { rollback });
                Some(solve)
            }
            other => {
                *self = other;
                None
            }
        }
    }

    fn take_rollback(&mut self) -> Option<Box<Rollback>> {
        if let Self::Running { rollback, .. } = self {
            return rollback.take();
        }
        match std::mem::take(self) {
            Self::Waiting { rollback } => Some(rollback),
            Self::Idle | Self::Running { .. } => None,
        }
    }
}

impl Background {
    /// Returns the version that is restored if the edit in progress is cancelled.
    pub(super) fn earlier_version(&mut self) -> Option<&mut Version> {
        self.work.rollback().map(|rollback| &mut rollback.version)
    }

    /// Returns `true` while the scene of a newly opened document is not displayed yet.
    pub(super) fn opens_document(&mut self) -> bool {
        self.work.rollback().is_some_and(|rollback| rollback.is_another_document)
    }
}

impl Session {
    /// Sets the number of unknowns above which a model is meshed and solved in the background.
    pub(crate) fn set_most_unknowns(&mut self, most: u64) {
        self.background.most_unknowns = most;
        self.note_size();
    }

    /// Returns `true` while a model is meshed or solved in the background.
    pub(crate) fn is_working(&self) -> bool {
        self.background.work.solve().is_some()
    }

    /// Returns the scene of the background solve, its current phase, and the time since the edit, s.
    pub(crate) fn work(&self) -> Option<(&Scene, Phase, u64)> {
        match &self.background.work {
            SolveState::Running { solve, rollback: Some(rollback) } => {
                let (scene, since) = (solve.scene(), rollback.since.elapsed());
                // A mesh is usually made within this time.
                let is_soon_over = scene.unknowns() <= self.background.most_unknowns && since < SOON;
                (!is_soon_over).then(|| (scene, solve.phase(), since.as_secs()))
            }
            _ => None,
        }
    }

    /// Returns `true` if `scene` is set up in the background: it is large, and has a new mesh or is static. Time steps
    /// of motions are made between frames.
    pub(super) fn is_for_background(&self, scene: &Scene) -> bool {
        self.is_large(scene) && self.needs_work(scene)
    }

    /// Returns `true` if the requested scene is set up in the background.
    fn is_wanted_in_background(&self) -> bool {
        self.background.is_large && self.needs_work(&self.scene)
    }

    /// Returns `true` if a scene takes too long for the time between two frames: a new mesh takes longer than an
    /// iteration.
    fn is_large(&self, scene: &Scene) -> bool {
        let most = self.background.most_unknowns;
        let is_new = !has_mesh_of(scene, self.simulation.scene());
        scene.unknowns() > if is_new { most.min(MAX_PANE_UNKNOWNS) } else { most }
    }

    fn needs_work(&self, scene: &Scene) -> bool {
        let is_search = scene.analysis == Analysis::Static && self.simulation.motion().is_none();
        is_search || !has_mesh_of(scene, self.simulation.scene())
    }

    /// Returns `true` if the displayed model is solved in the background.
    pub(crate) fn is_in_background(&self) -> bool {
        self.is_working() || self.is_wanted_in_background()
    }

    /// Notes whether the wanted scene is large.
    pub(super) fn note_size(&mut self) {
        self.background.is_large = self.is_large(&self.scene);
    }

    /// Requests a scene, which the next background solve uses.
    pub(super) fn request_scene(&mut self, scene: Scene) {
        self.keep_rollback();
        self.scene = scene;
        self.note_size();
        self.changed.scene = true;
        self.stop_solve();
    }

    /// Records that the requested scene belongs to another document.
    pub(super) fn request_document(&mut self, document: Document) {
        self.document = document;
        self.check_file();
        self.background.start = SolveStart::Rest;
        if let Some(rollback) = self.background.work.rollback() {
            rollback.is_another_document = true;
        }
        self.poll();
    }

    /// Records the label of the control whose edit is in progress.
    pub(super) fn name_edit(&mut self, label: &'static str) {
        if let Some(rollback) = self.background.work.rollback() {
            rollback.label = Some(label);
        }
    }

    /// Restarts the background solve from another state, without limit or for a number of iterations.
    pub(super) fn restart_in_background(&mut self, start: SolveStart, iterations: Option<u32>) {
        self.keep_rollback();
        (self.background.start, self.background.iterations) = (start, iterations);
        self.stop_solve();
        self.poll();
    }

    /// Stores the current session for a rollback, unless an earlier one is stored.
    fn keep_rollback(&mut self) {
        // From now on the displayed model is a copy, which cannot be grabbed.
        self.release();
        if self.background.work.rollback().is_some() {
            return;
        }
        let rollback = Box::new(Rollback {
            since: Instant::now(),
            version: self.version(),
            depth: self.undo.depth(),
            label: None,
            is_another_document: false,
            snapshot: None,
            quality: Quality::default(),
        });
        match &mut self.background.work {
            SolveState::Running { rollback: own, .. } => *own = Some(rollback),
            work => *work = SolveState::Waiting { rollback },
        }
    }

    /// Cancels the solve; it returns the model that it has.
    pub(super) fn stop_solve(&self) {
        self.background.work.solve().into_iter().for_each(BackgroundSolve::cancel);
    }

    /// Drops the background work.
    pub(super) fn drop_background(&mut self) {
        let Background { most_unknowns, is_large, .. } = self.background;
        self.background = Background { most_unknowns, is_large, ..Background::default() };
    }

    /// Handles the updates of the background solve, and starts the next solve if one is needed.
    pub(crate) fn poll(&mut self) {
        while let Some(solve) = self.background.work.solve_mut() {
            match solve.next(false) {
                SolveUpdate::None => return,
                update => self.take_update(update),
            }
        }
        self.start_solve();
    }

    /// Waits until the background work is done.
    pub(super) fn wait_for_background(&mut self) {
        self.poll();
        while let Some(solve) = self.background.work.solve_mut() {
            let update = solve.next(true);
            self.take_update(update);
            self.poll();
        }
    }

    fn take_update(&mut self, update: SolveUpdate) {
        let is_cancelled = self.background.work.solve().is_some_and(BackgroundSolve::is_discarded);
        match update {
            SolveUpdate::None => {}
            SolveUpdate::Progress(_) if is_cancelled => {}
            SolveUpdate::Progress(snapshot) => self.display(*snapshot),
            SolveUpdate::Done(outcome) => {
                let Some(solve) = self.background.work.take_solve() else { return };
                match outcome {
                    Ok(solved) => self.receive(&solve, is_cancelled, *solved),
                    Err(rejected) => self.receive_rejection(&solve, is_cancelled, *rejected),
                }
            }
            SolveUpdate::Died => {
                self.roll_back();
                self.background.work = SolveState::Idle;
                // Repeating the same solve would fail in the same way.
                self.running = false;
                self.notices.push(Notice::SolveDied);
            }
        }
    }

    fn receive(&mut self, solve: &BackgroundSolve, is_cancelled: bool, solved: Solved) {
        let Solved { snapshot, quality } = solved;
        let background = &mut self.background;
        if is_cancelled {
            if !solve.is_new() {
                background.returned = Some((snapshot.bodies, None));
            }
            // The displayed model is a copy of the returned one.
            if background.returned.is_some() && matches!(background.start, SolveStart::Present) {
                background.start = SolveStart::State(self.simulation.state().clone());
            }
            return;
        }
        let is_wanted = *solve.scene() == self.scene
            && matches!(background.start, SolveStart::Present)
            && background.iterations.is_none();
        if !is_wanted {
            if has_mesh_of(&self.scene, snapshot.bodies.simulation.scene()) {
                background.returned = Some((snapshot.bodies, snapshot.geometry));
            }
            return;
        }
        self.display(snapshot);
        if let Some(quality) = quality {
            self.quality = quality;
        }
        (self.background.work, self.background.returned) = (SolveState::Idle, None);
    }

    fn receive_rejection(&mut self, solve: &BackgroundSolve, is_cancelled: bool, rejected: Rejected) {
        self.background.returned = rejected.model.or_else(|| self.background.returned.take());
        if is_cancelled || *solve.scene() != self.scene {
            return;
        }
        let label = self.background.work.rollback().and_then(|rollback| rollback.label);
        self.roll_back();
        self.notices.push(Notice::Rejected { label, message: (&rejected.error).into() });
    }

    /// Displays a snapshot in place of the current model.
    fn display(&mut self, snapshot: Snapshot) {
        let scene = self.simulation.scene().clone();
        let Snapshot { bodies, geometry, residuals } = snapshot;
        let simulation = std::mem::replace(&mut self.simulation, bodies.simulation);
        let linear = std::mem::replace(&mut self.linear, bodies.linear);
        let residuals = std::mem::replace(&mut self.residuals, residuals);
        let geometry = geometry.map(|geometry| std::mem::replace(&mut self.geometry, geometry));
        self.timings = *self.simulation.last_iteration();
        self.note_size();
        let is_another_document = self.background.work.rollback().is_some_and(|rollback| {
            if rollback.snapshot.is_none() {
                rollback.quality = std::mem::take(&mut self.quality);
                rollback.snapshot = Some(Snapshot { bodies: Bodies { simulation, linear }, geometry, residuals });
            }
            std::mem::take(&mut rollback.is_another_document)
        });
        self.scene_changed(&scene);
        if is_another_document {
            self.start_document();
        }
    }

    /// Starts the next solve, if one is needed.
    fn start_solve(&mut self) {
        if !self.is_wanted_in_background() {
            return;
        }
        let background = &self.background;
        let own = background.returned.as_ref().map_or(&self.simulation, |(bodies, _)| &bodies.simulation);
        let is_new = !has_mesh_of(&self.scene, own.scene());
        let is_needed = own.scene() != &self.scene
            || !matches!(background.start, SolveStart::Present)
            || background.iterations.is_some()
            || background.returned.is_some()
            || self.running && *own.status() == Status::Running;
        if !is_new && (!is_needed || own.motion().is_some()) {
            self.background.work = SolveState::Idle;
            return;
        }
        self.keep_rollback();
        let model = if is_new { Some(Model::New) } else { self.take_model() };
        let Some(model) = model else { return };
        // Iterations of a body that is not that large are made between two frames.
        let is_made_here = !self.running || self.scene.unknowns() <= self.background.most_unknowns;
        let request = SolveRequest {
            scene: self.scene.clone(),
            model,
            start: std::mem::take(&mut self.background.start),
            iterations: self.background.iterations.take().or(is_made_here.then_some(0)),
            residuals: self.residuals.clone(),
            is_displayed: true,
        };
        match BackgroundSolve::start(request) {
            Ok(solve) => {
                if let SolveState::Waiting { rollback } = std::mem::take(&mut self.background.work) {
                    self.background.work = SolveState::Running { solve: Box::new(solve), rollback: Some(rollback) };
                }
            }
            Err(error) => {
                self.roll_back();
                self.running = false;
                self.notices.push(Notice::NoThread(error));
            }
        }
    }

    /// Takes the model for a solve; a copy stays on display.
    fn take_model(&mut self) -> Option<Model> {
        if let Some(returned) = self.background.returned.take() {
            return Some(Model::Existing(Box::new(returned)));
        }
        let simulation = self.simulation.equilibrium()?.snapshot();
        let linear = self.linear.as_ref().and_then(Simulation::equilibrium).map(Equilibrium::snapshot);
        let simulation = std::mem::replace(&mut self.simulation, simulation);
        let linear = std::mem::replace(&mut self.linear, linear);
        Some(Model::Existing(Box::new((Bodies { simulation, linear }, None))))
    }

    /// Cancels the background solve, and restores the session before the edit.
    pub(crate) fn cancel(&mut self) {
        self.background.work.solve_mut().into_iter().for_each(|solve| solve.discard());
        self.roll_back();
        // An iteration that had not ended before the edit would otherwise continue at once.
        self.running &= self.simulation.is_at_rest();
    }

    fn roll_back(&mut self) {
        (self.background.start, self.background.iterations) = (SolveStart::Present, None);
        let Some(rollback) = self.background.work.take_rollback() else { return };
        let Rollback { version, depth, snapshot, quality, .. } = *rollback;
        self.undo.take_back(depth);
        Version { document: self.document, scene: self.scene } = version;
        self.note_size();
        if let Some(Snapshot { bodies, geometry, residuals }) = snapshot {
            let scene = self.simulation.scene().clone();
            (self.simulation, self.linear, self.residuals) = (bodies.simulation, bodies.linear, residuals);
            self.quality = quality;
            if let Some(geometry) = geometry {
                self.geometry = geometry;
            }
            self.scene_changed(&scene);
        }
    }
}
