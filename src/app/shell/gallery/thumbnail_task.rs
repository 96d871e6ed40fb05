//! Background thread that makes the thumbnails of the built-in scenes one after the other.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use super::thumbnail::Thumbnail;
use crate::scene::{self, Source, registry};

/// Background work on all thumbnails. Dropping it cancels it.
#[derive(Debug)]
pub(super) struct ThumbnailTask {
    receiver: Receiver<(&'static str, Thumbnail)>,
    cancel: Arc<AtomicBool>,
}

impl ThumbnailTask {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(super) fn start() -> std::io::Result<Self> {
        let (sender, receiver) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let cancelled = cancel.clone();
        std::thread::Builder::new().name("thumbnails".to_owned()).spawn(move || work(&sender, &cancelled))?;
        Ok(Self { receiver, cancel })
    }

    /// Returns the next thumbnail that is ready, with its scene's name; the error tells whether none is ready yet or no
    /// more will follow.
    pub(super) fn poll(&self) -> Result<(&'static str, Thumbnail), TryRecvError> {
        self.receiver.try_recv()
    }
}

impl Drop for ThumbnailTask {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

fn work(sender: &Sender<(&'static str, Thumbnail)>, cancelled: &AtomicBool) {
    let is_cancelled = || cancelled.load(Ordering::Relaxed);
    for built_in in registry::BUILT_IN {
        let scene = scene::open(&Source { name: built_in.id.into(), assignments: Vec::new() });
        let thumbnail = scene.ok().and_then(|scene| Thumbnail::of(&scene, is_cancelled));
        if is_cancelled() {
            return;
        }
        if let Some(thumbnail) = thumbnail
            && sender.send((built_in.id, thumbnail)).is_err()
        {
            return;
        }
    }
}
