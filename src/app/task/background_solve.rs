//! Background solve of a large model.

use web_time::{Duration, Instant};

use crate::app::platform::IS_PAGE;
use crate::app::task::remote_solve::RemoteSolve;
use crate::app::task::solve::{Model, Phase, Snapshot, SolveOutcome, SolveProgress, SolveRequest, Solved, run};
use crate::app::task::thread::{Reporter, Task, Update};
use crate::scene::{Analysis, Scene};
use crate::sentence::{Sentence, sentence};

/// Update of a background solve.
#[derive(Debug)]
pub(crate) enum SolveUpdate {
    /// Nothing new.
    None,
    Progress(Box<Snapshot>),
    Done(SolveOutcome),
    /// The solve was cancelled before it had a model.
    Cancelled,
    /// The solve has ended without a result.
    Died,
}

/// Solve in a background thread, or in a worker of a web page. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct BackgroundSolve {
    runner: Runner,
    scene: Scene,
    since: Instant,
    is_new: bool,
    /// `true` once the user has cancelled the solve: its snapshots and its result are not displayed.
    is_discarded: bool,
    phase: Phase,
}

#[derive(Debug)]
enum Runner {
    Thread(Task<SolveProgress, SolveOutcome>),
    Worker(Box<RemoteSolve>),
}

impl BackgroundSolve {
    /// Starts the thread or the worker.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(crate) fn start(request: SolveRequest) -> std::io::Result<Self> {
        let (scene, is_new) = (request.scene.clone(), matches!(request.model, Model::New));
        let phase = if is_new { Phase::Meshing } else { Phase::Iterating(0) };
        // A motion is only meshed in the background.
        let runner = if IS_PAGE && scene.analysis == Analysis::Static {
            Runner::Worker(Box::new(RemoteSolve::start(request)?))
        } else {
            let work = move |reporter: &Reporter<_, _>| run(request, &|progress| reporter.report(progress));
            Runner::Thread(Task::start("solve", work)?)
        };
        Ok(Self { runner, scene, since: Instant::now(), is_new, is_discarded: false, phase })
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
        match &self.runner {
            Runner::Thread(task) => task.cancel(),
            Runner::Worker(solve) => solve.end(),
        }
    }

    /// Returns `true` if the snapshots and the result are not to be displayed.
    pub(crate) fn is_discarded(&self) -> bool {
        self.is_discarded
    }

    /// Cancels the solve; it ends with the model that it has.
    pub(crate) fn cancel(&self) {
        match &self.runner {
            Runner::Thread(task) => task.cancel(),
            Runner::Worker(solve) => solve.cancel(),
        }
    }

    /// Returns the next update without waiting for it.
    pub(crate) fn poll(&mut self) -> SolveUpdate {
        self.next(false)
    }

    /// Returns the result of the solve, or the reason for which it has none; `None` until it has ended. Snapshots are
    /// dropped. A solve that was cancelled before it had a model has no reason.
    pub(crate) fn poll_end(&mut self) -> Option<Result<Box<Solved>, Option<Sentence>>> {
        loop {
            return Some(match self.poll() {
                SolveUpdate::None => return None,
                SolveUpdate::Progress(_) => continue,
                SolveUpdate::Done(Ok(solved)) => Ok(solved),
                SolveUpdate::Done(Err(rejected)) => Err(Some((&rejected.error).into())),
                SolveUpdate::Cancelled => Err(None),
                SolveUpdate::Died => {
                    Err(Some(sentence!("the solve ended unexpectedly: change a value to solve again")))
                }
            });
        }
    }

    /// Waits for the next update.
    pub(crate) fn wait(&mut self) -> SolveUpdate {
        self.next(true)
    }

    /// Returns the next update, and records the phases that are reported before it.
    fn next(&mut self, waits: bool) -> SolveUpdate {
        loop {
            let update = match &mut self.runner {
                Runner::Thread(task) => task.next(waits),
                Runner::Worker(solve) => solve.next(waits),
            };
            return match update {
                Update::None => SolveUpdate::None,
                Update::Progress(SolveProgress::Phase(phase)) => {
                    self.phase = phase;
                    continue;
                }
                Update::Progress(SolveProgress::Snapshot(snapshot, receipt)) => {
                    drop(receipt);
                    SolveUpdate::Progress(snapshot)
                }
                Update::Done(outcome) => SolveUpdate::Done(outcome),
                Update::Died => match &self.runner {
                    Runner::Worker(solve) if solve.is_cancelled() => SolveUpdate::Cancelled,
                    _ => SolveUpdate::Died,
                },
            };
        }
    }
}
