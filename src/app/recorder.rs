//! A recording that is made beside the window: the scene from its start, into a GIF in the present folder.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use thiserror::Error;

use super::language::{self, Language, count, fill, tr, translated};
use super::record::{Phase, RecordOptions, RecordProgress, record};
use super::{NoName, ThemeChoice, free_name};
use crate::scene::{Scene, Source};

/// Pixels of the recording.
const SIZE: [u32; 2] = [640, 400];

/// Why there is no recording.
#[derive(Debug, Error)]
pub(super) enum RecorderError {
    #[error(transparent)]
    NoName(#[from] NoName),
    #[error("no thread for it: {0}")]
    NoThread(#[from] std::io::Error),
}

enum Message {
    Progress(f32, String),
    Done(String),
}

/// A recording in a thread of its own. Dropped, it is called off.
#[derive(Debug)]
pub(super) struct Recorder {
    receiver: Receiver<Message>,
    cancel: Arc<AtomicBool>,
    /// Fraction that is done, 0 to 1.
    pub fraction: f32,
    /// What is done now.
    pub words: String,
}

impl Recorder {
    /// Starts to record a scene.
    ///
    /// # Errors
    /// [`RecorderError`].
    pub(super) fn start(
        source: Source,
        scene: Scene,
        theme: ThemeChoice,
        language: Language,
    ) -> Result<Self, RecorderError> {
        let path = free_name("gif")?;
        let (sender, receiver) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let cancelled = cancel.clone();
        let work = move || work(&source, scene, (theme, language), &path, &sender, &cancelled);
        std::thread::Builder::new().name("record".to_owned()).spawn(work)?;
        Ok(Self { receiver, cancel, fraction: 0.0, words: String::new() })
    }

    /// Ends it with what it has.
    pub(super) fn stop(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Hears how far it is; returns what there is to say once it has ended.
    pub(super) fn listen(&mut self) -> Option<String> {
        loop {
            match self.receiver.try_recv() {
                Ok(Message::Progress(fraction, words)) => (self.fraction, self.words) = (fraction, words),
                Ok(Message::Done(words)) => return Some(words),
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => return Some(tr("The recording ended unexpectedly").to_owned()),
            }
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.stop();
    }
}

fn work(
    source: &Source,
    scene: Scene,
    (theme, language): (ThemeChoice, Language),
    path: &Path,
    sender: &Sender<Message>,
    cancelled: &AtomicBool,
) {
    language::speak(language);
    let mut observe = |progress: RecordProgress| {
        let words = match progress.phase {
            Phase::Looking => tr("Looking ahead").to_owned(),
            Phase::Drawing => fill!("Recording %{file}", file = path.display()),
        };
        // Nobody listening is as good as being called off.
        let heard = sender.send(Message::Progress(progress.fraction as f32, words)).is_ok();
        if heard && !cancelled.load(Ordering::Relaxed) { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let options = RecordOptions { size: SIZE, seconds: None, speed: None, fps: None, theme, language };
    let words = match record(source, scene, &options, path, &mut observe) {
        Ok(recorded) if recorded.pictures == 0 => tr("Nothing was recorded").to_owned(),
        Ok(recorded) => {
            fill!("Saved %{file}, %{pictures}", file = path.display(), pictures = count(recorded.pictures, "picture"))
        }
        Err(error) => fill!("No recording: %{reason}", reason = translated(&error.to_string())),
    };
    let _ = sender.send(Message::Done(words));
}
