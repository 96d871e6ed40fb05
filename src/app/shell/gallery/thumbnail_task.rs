//! Background work that makes the thumbnails of the built-in scenes one after the other.

use serde::{Deserialize, Serialize};

use super::thumbnail::Thumbnail;
use crate::app::task::thread::{Reporter, Work};
use crate::scene::{self, Source, registry};

/// Request for all thumbnails.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct ThumbnailWork;

/// Progress of the work: the next thumbnail, with the position of its scene in the list of built-in scenes.
pub(crate) type Made = (usize, Thumbnail);

impl Work for ThumbnailWork {
    const NAME: &'static str = "thumbnails";
    type Reported = Made;
    type Output = ();

    fn run(self, reporter: &Reporter<Made, ()>) {
        for (number, built_in) in registry::BUILT_IN.iter().enumerate() {
            let scene = scene::open(&Source { name: built_in.id.into(), assignments: Vec::new() });
            let thumbnail = scene.ok().and_then(|scene| Thumbnail::of(&scene, || reporter.is_cancelled()));
            if reporter.is_cancelled() {
                return;
            }
            if let Some(thumbnail) = thumbnail
                && reporter.report((number, thumbnail)).is_break()
            {
                return;
            }
        }
    }
}
