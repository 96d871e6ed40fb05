//! Background solve of a large model.

use web_time::{Duration, Instant};

use crate::app::task::solve::{Model, Phase, Snapshot, SolveOutcome, SolveProgress, SolveRequest, Solved, run};
use crate::app::task::thread::{Reporter, Task, Update};
use crate::scene::Scene;
use crate::sentence::{Sentence, sentence};

/// Update of a background solve: a snapshot, or the result.
pub(crate) type SolveUpdate = Update<Box<Snapshot>, SolveOutcome>;

/// Solve in a background thread, or on a web page after the current frame. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct BackgroundSolve {
    task: Task<SolveProgress, SolveOutcome>,
    scene: Scene,
    since: Instant,
    is_new: bool,
    /// `true` once the user has cancelled the solve: its snapshots and its result are not displayed.
    is_discarded: bool,
    phase: Phase,
}

impl BackgroundSolve {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(crate) fn start(request: SolveRequest) -> std::io::Result<Self> {
        let (scene, is_new) = (request.scene.clone(), matches!(request.model, Model::New));
        let phase = if is_new { Phase::Meshing } else { Phase::Iterating(0) };
        let work = move |reporter: &Reporter<_, _>| run(request, &|progress| reporter.report(progress));
        Ok(Self { task: Task::start("solve", work)?, scene, since: Instant::now(), is_new, is_discarded: false, phase })
    }

    /// Returns the scene that is solved.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the time since the start.
    pub(crate) fn age(&self) -> Duration {
        self.since.elapsed()
    }

    /// Returns `true` if a new model is meshed.
    pub(crate) fn is_new(&self) -> bool {
        self.is_new
    }

    pub(crate) fn phase(&self) -> Phase {
        self.phase
    }

    /// Cancels the solve, whose snapshots and result are not to be displayed.
    pub(crate) fn discard(&mut self) {
        self.is_discarded = true;
        self.task.cancel();
    }

    /// Returns `true` if the snapshots and the result are not to be displayed.
    pub(crate) fn is_discarded(&self) -> bool {
        self.is_discarded
    }

    /// Cancels the solve; it ends with the model that it has.
    pub(crate) fn cancel(&self) {
        self.task.cancel();
    }

    /// Returns the result of the solve, or the reason for which it has none; `None` until it has ended. Snapshots are
    /// dropped.
    pub(crate) fn poll_end(&mut self) -> Option<Result<Box<Solved>, Sentence>> {
        loop {
            return Some(match self.next(false) {
                SolveUpdate::None => return None,
                SolveUpdate::Progress(_) => continue,
                SolveUpdate::Done(Ok(solved)) => Ok(solved),
                SolveUpdate::Done(Err(rejected)) => Err((&rejected.error).into()),
                SolveUpdate::Died => Err(sentence!("the solve ended unexpectedly: change a value to solve again")),
            });
        }
    }

    /// Returns the next update, and records the phases that are reported before it; waits for it if `waits` is `true`.
    pub(crate) fn next(&mut self, waits: bool) -> SolveUpdate {
        loop {
            return match self.task.next(waits) {
                Update::Progress(SolveProgress::Phase(phase)) => {
                    self.phase = phase;
                    continue;
                }
                Update::Progress(SolveProgress::Snapshot(snapshot, receipt)) => {
                    drop(receipt);
                    Update::Progress(snapshot)
                }
                Update::Done(outcome) => Update::Done(outcome),
                Update::None => Update::None,
                Update::Died => Update::Died,
            };
        }
    }
}
