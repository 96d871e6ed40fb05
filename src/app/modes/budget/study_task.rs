//! The study that runs beside the window.

use thiserror::Error;

use crate::app::modes::budget::measured::Measured;
use crate::app::task::thread::{Reporter, Task, Update};
use crate::scene::{Analysis, Scene};
use crate::study::{Extent, MotionStudy, Progress, Study, StudyError};

/// Why a study gave no result.
#[derive(Debug, Error)]
pub(crate) enum BackgroundError {
    #[error("no thread for the study: {0}")]
    NoThread(#[from] std::io::Error),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error("the study ended unexpectedly")]
    Died,
}

/// What the study says while it runs.
#[derive(Debug)]
enum Said {
    Now(f32, String),
    SoFar(Measured),
}

type Done = Result<Measured, StudyError>;

/// How far a study is, as last heard.
#[derive(Debug)]
pub(crate) enum News {
    /// It goes on.
    Running,
    /// It has ended, or was called off; or why it could not.
    Ended(Result<(), BackgroundError>),
}

/// A study in a thread of its own. Dropped, it is called off.
#[derive(Debug)]
pub(crate) struct Background {
    task: Task<Said, Done>,
    /// Fraction that is done, and what is measured now.
    fraction: f32,
    now: String,
}

impl Background {
    /// Starts to measure the scene.
    ///
    /// # Errors
    /// [`BackgroundError::NoThread`].
    pub(crate) fn start(scene: Scene, extent: Extent) -> Result<Self, BackgroundError> {
        let task = Task::start("study", move |reporter| work(&scene, extent, reporter))?;
        Ok(Self { task, fraction: 0.0, now: String::new() })
    }

    /// Fraction that is done, and what is measured now.
    pub(crate) fn progress(&self) -> (f32, &str) {
        (self.fraction, &self.now)
    }

    /// Asks the study to end with the measurements that it has.
    pub(crate) fn call_off(&self) {
        self.task.cancel();
    }

    /// Takes what has been heard since; measurements go to `study`.
    pub(crate) fn listen(&mut self, study: &mut Option<Measured>) -> News {
        loop {
            match self.task.poll() {
                Update::Progress(Said::Now(fraction, now)) => (self.fraction, self.now) = (fraction, now),
                Update::Progress(Said::SoFar(so_far)) => *study = Some(so_far),
                Update::Done(Ok(done)) => {
                    *study = Some(done);
                    return News::Ended(Ok(()));
                }
                Update::Done(Err(StudyError::Cancelled)) => return News::Ended(Ok(())),
                Update::Done(Err(error)) => return News::Ended(Err(error.into())),
                Update::None => return News::Running,
                Update::Died => return News::Ended(Err(BackgroundError::Died)),
            }
        }
    }
}

fn work(scene: &Scene, extent: Extent, reporter: &Reporter<Said, Done>) -> Done {
    let observe = |progress: Progress<'_>, so_far: Option<&Study>| {
        reporter.report(match so_far {
            Some(study) => Said::SoFar(Measured::Rest(study.clone())),
            None => Said::Now(progress.fraction as f32, progress.now.to_owned()),
        })
    };
    match scene.analysis {
        Analysis::Static => Study::observed(scene, extent, &mut { observe }).map(Measured::Rest),
        Analysis::Dynamic => {
            MotionStudy::new(scene, extent, &mut |progress| observe(progress, None)).map(Measured::Motion)
        }
    }
}
