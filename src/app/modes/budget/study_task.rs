//! Study in the background.

use thiserror::Error;

use crate::app::modes::budget::measured::Measured;
use crate::app::task::thread::{Reporter, Task, Update};
use crate::scene::{Analysis, Scene};
use crate::study::{Extent, MotionStudy, Progress, Study, StudyError};

/// Reason for which a study has no result.
#[derive(Debug, Error)]
pub(crate) enum BackgroundError {
    #[error("no thread for the study: {0}")]
    NoThread(#[from] std::io::Error),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error("the study ended unexpectedly")]
    Died,
}

/// Progress report of a study.
#[derive(Debug)]
enum StudyProgress {
    Now(f32, String),
    SoFar(Measured),
}

type Done = Result<Measured, StudyError>;

/// State of a study after a poll.
#[derive(Debug)]
pub(crate) enum StudyState {
    /// The study is in progress.
    Running,
    /// The study has ended or was cancelled; the error tells why it failed.
    Ended(Result<(), BackgroundError>),
}

/// Study in a background thread. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct Background {
    task: Task<StudyProgress, Done>,
    /// Fraction done, and (`now`) the current measurement.
    fraction: f32,
    now: String,
}

impl Background {
    /// Starts a study of the scene.
    ///
    /// # Errors
    /// [`BackgroundError::NoThread`].
    pub(crate) fn start(scene: Scene, extent: Extent) -> Result<Self, BackgroundError> {
        let task = Task::start("study", move |reporter| work(&scene, extent, reporter))?;
        Ok(Self { task, fraction: 0.0, now: String::new() })
    }

    /// Returns the fraction done, and the current measurement.
    pub(crate) fn progress(&self) -> (f32, &str) {
        (self.fraction, &self.now)
    }

    /// Asks the study to end with the measurements that it has.
    pub(crate) fn cancel(&self) {
        self.task.cancel();
    }

    /// Processes the updates since the last call; measurements are stored in `study`.
    pub(crate) fn poll(&mut self, study: &mut Option<Measured>) -> StudyState {
        loop {
            match self.task.poll() {
                Update::Progress(StudyProgress::Now(fraction, now)) => (self.fraction, self.now) = (fraction, now),
                Update::Progress(StudyProgress::SoFar(so_far)) => *study = Some(so_far),
                Update::Done(Ok(done)) => {
                    *study = Some(done);
                    return StudyState::Ended(Ok(()));
                }
                Update::Done(Err(StudyError::Cancelled)) => return StudyState::Ended(Ok(())),
                Update::Done(Err(error)) => return StudyState::Ended(Err(error.into())),
                Update::None => return StudyState::Running,
                Update::Died => return StudyState::Ended(Err(BackgroundError::Died)),
            }
        }
    }
}

fn work(scene: &Scene, extent: Extent, reporter: &Reporter<StudyProgress, Done>) -> Done {
    let observe = |progress: Progress<'_>, so_far: Option<&Study>| {
        reporter.report(match so_far {
            Some(study) => StudyProgress::SoFar(Measured::Rest(study.clone())),
            None => StudyProgress::Now(progress.fraction as f32, progress.now.to_owned()),
        })
    };
    match scene.analysis {
        Analysis::Static => Study::observed(scene, extent, &mut { observe }).map(Measured::Rest),
        Analysis::Dynamic => {
            MotionStudy::new(scene, extent, &mut |progress| observe(progress, None)).map(Measured::Motion)
        }
    }
}
