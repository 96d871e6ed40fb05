//! The study that runs beside the window.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use thiserror::Error;

use crate::scene::Scene;
use crate::study::{Extent, Progress, Study, StudyError};

/// Why a study gave no result.
#[derive(Debug, Error)]
pub(super) enum BackgroundError {
    #[error("no thread for the study: {0}")]
    NoThread(#[from] std::io::Error),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error("the study ended unexpectedly")]
    Died,
}

/// What the study says while it runs.
enum Message {
    Now(f32, String),
    SoFar(Study),
    Done(Result<Study, StudyError>),
}

/// How far a study is, as last heard.
#[derive(Debug)]
pub(super) enum News {
    /// It goes on.
    Running,
    /// It has ended, or was called off; or why it could not.
    Ended(Result<(), BackgroundError>),
}

/// A study in a thread of its own. Dropped, it is called off.
#[derive(Debug)]
pub(super) struct Background {
    receiver: Receiver<Message>,
    cancel: Arc<AtomicBool>,
    /// Fraction that is done, and what is measured now.
    fraction: f32,
    now: String,
}

impl Background {
    /// Starts to measure the scene.
    ///
    /// # Errors
    /// [`BackgroundError::NoThread`].
    pub(super) fn start(scene: Scene, extent: Extent) -> Result<Self, BackgroundError> {
        let (sender, receiver) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let cancelled = cancel.clone();
        std::thread::Builder::new()
            .name("study".to_owned())
            .spawn(move || work(&scene, extent, &sender, &cancelled))?;
        Ok(Self { receiver, cancel, fraction: 0.0, now: String::new() })
    }

    /// Fraction that is done, and what is measured now.
    pub(super) fn progress(&self) -> (f32, &str) {
        (self.fraction, &self.now)
    }

    /// Takes what has been heard since; measurements go to `study`.
    pub(super) fn listen(&mut self, study: &mut Option<Study>) -> News {
        loop {
            match self.receiver.try_recv() {
                Ok(Message::Now(fraction, now)) => (self.fraction, self.now) = (fraction, now),
                Ok(Message::SoFar(so_far)) => *study = Some(so_far),
                Ok(Message::Done(Ok(done))) => {
                    *study = Some(done);
                    return News::Ended(Ok(()));
                }
                Ok(Message::Done(Err(StudyError::Cancelled))) => return News::Ended(Ok(())),
                Ok(Message::Done(Err(error))) => return News::Ended(Err(error.into())),
                Err(TryRecvError::Empty) => return News::Running,
                Err(TryRecvError::Disconnected) => return News::Ended(Err(BackgroundError::Died)),
            }
        }
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

fn work(scene: &Scene, extent: Extent, sender: &Sender<Message>, cancelled: &AtomicBool) {
    // Nobody listening is as good as being called off.
    let mut observe = |progress: Progress<'_>| {
        let heard = match progress.so_far {
            Some(study) => sender.send(Message::SoFar(study.clone())),
            None => sender.send(Message::Now(progress.fraction as f32, progress.now.to_owned())),
        };
        if heard.is_err() || cancelled.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let done = Study::new(scene, extent, &mut observe);
    let _ = sender.send(Message::Done(done));
}
