//! Study in the background.

use serde::{Deserialize, Serialize};

use crate::app::task::sent_scene::SentScene;
use crate::app::task::thread::{Reporter, Task, Update, Work};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::sentence::{Sentence, sentence};
use crate::study::{Extent, Study, StudyError};

/// Progress report of a study.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum StudyProgress {
    /// Fraction done, and the current measurement, if it is another one.
    Now(f32, Option<Sentence>),
    SoFar(Box<Study>),
}

/// Measurements, or the reason why there are none; `None` for a cancelled study.
type Done = Result<Study, Option<Sentence>>;

/// Request for a study.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct StudyWork(SentScene, Extent);

impl Work for StudyWork {
    const NAME: &'static str = "study";
    type Reported = StudyProgress;
    type Output = Done;

    fn run(self, reporter: &Reporter<StudyProgress, Done>) -> Done {
        let observe = &|progress: Progress<'_>| {
            reporter.report(StudyProgress::Now(progress.fraction as f32, progress.now.cloned()))
        };
        // A cancellation is seen by the next report of progress.
        let partial = &mut |study: &Study| _ = reporter.report(StudyProgress::SoFar(Box::new(study.clone())));
        Study::with_partial(&self.0.0, self.1, observe, partial)
            .map_err(|error| (error != StudyError::Cancelled).then(|| (&error).into()))
    }
}

/// State of a study after a poll.
#[derive(Debug)]
pub(crate) enum StudyState {
    /// The study is in progress.
    Running,
    /// The study has ended or was cancelled; the error tells why it failed.
    Ended(Result<(), Sentence>),
}

/// Study in a background thread. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct BackgroundStudy {
    task: Task<StudyProgress, Done>,
    /// Fraction done, and (`now`) the current measurement.
    fraction: f32,
    now: Sentence,
}

impl BackgroundStudy {
    /// Starts a study of the scene.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(crate) fn start(scene: Scene, extent: Extent) -> Result<Self, Sentence> {
        let task = Task::run(StudyWork(SentScene(scene), extent)).map_err(|error| {
            sentence!("the system starts no thread for the study: %{error}", error = error.to_string())
        })?;
        Ok(Self { task, fraction: 0.0, now: Sentence::default() })
    }

    /// Returns the fraction done, and the current measurement.
    pub(crate) fn progress(&self) -> (f32, &Sentence) {
        (self.fraction, &self.now)
    }

    /// Asks the study to end with the measurements that it has.
    pub(crate) fn cancel(&self) {
        self.task.cancel();
    }

    /// Processes the updates since the last call; measurements are stored in `study`.
    pub(crate) fn poll(&mut self, study: &mut Option<Study>) -> StudyState {
        loop {
            match self.task.poll() {
                Update::Progress(StudyProgress::Now(fraction, now)) => {
                    self.fraction = fraction;
                    self.now = now.unwrap_or(std::mem::take(&mut self.now));
                }
                Update::Progress(StudyProgress::SoFar(so_far)) => *study = Some(*so_far),
                Update::Done(Ok(done)) => {
                    *study = Some(done);
                    return StudyState::Ended(Ok(()));
                }
                Update::Done(Err(None)) => return StudyState::Ended(Ok(())),
                Update::Done(Err(Some(error))) => return StudyState::Ended(Err(error)),
                Update::None => return StudyState::Running,
                Update::Died if self.task.is_cancelled() => return StudyState::Ended(Ok(())),
                Update::Died => {
                    return StudyState::Ended(Err(sentence!("the study ended unexpectedly: measure again")));
                }
            }
        }
    }
}
