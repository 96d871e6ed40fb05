//! Background work that makes the thumbnails of the built-in scenes one after the other.

use super::thumbnail::Thumbnail;
use crate::app::task::thread::{Reporter, Task};
use crate::scene::{self, Source, registry};

/// Work on all thumbnails; its progress is the next thumbnail, with its scene's name.
pub(super) type ThumbnailTask = Task<(&'static str, Thumbnail), ()>;

/// Starts the work.
///
/// # Errors
/// The system cannot start another thread.
pub(super) fn start() -> std::io::Result<ThumbnailTask> {
    Task::start("thumbnails", work)
}

fn work(reporter: &Reporter<(&'static str, Thumbnail), ()>) {
    for built_in in registry::BUILT_IN {
        let scene = scene::open(&Source { name: built_in.id.into(), assignments: Vec::new() });
        let thumbnail = scene.ok().and_then(|scene| Thumbnail::of(&scene, || reporter.is_cancelled()));
        if reporter.is_cancelled() {
            return;
        }
        if let Some(thumbnail) = thumbnail
            && reporter.report((built_in.id, thumbnail)).is_break()
        {
            return;
        }
    }
}
