//! The window and its pictures. [`Lab`] is what is shown: a scene, its simulation and how to look at it. The
//! window, the offscreen shot and the tests of the panel all show the same lab through [`Lab::ui`].

use std::path::PathBuf;

use thiserror::Error;

use crate::render::RenderError;

mod action;
mod diagnosis;
mod language;
mod modes;
mod offscreen;
mod panel;
mod readout;
mod session;
mod shell;
mod task;
mod view_options;
mod viewport;
mod widgets;
mod window;

pub use language::Language;
pub use modes::compare::{MotionPane, MotionPaneSetting, Pane, PaneEnd, PaneSetting, PaneSettingError, parse_panes};
#[doc(hidden)]
pub use modes::learn::card_count;
pub use offscreen::record::{MovieFormat, Phase, RecordError, RecordOptions, RecordProgress, Recorded, record};
pub use offscreen::shot::{Canvas, FrameTimes, MAX_SHOT_SIDE, ShotOptions, picture, shot};
pub use panel::PANEL_WIDTH;
#[doc(hidden)]
pub use session::recovery::{Recovery, Unsaved};
pub use shell::lab::{Lab, Request};
pub use shell::settings::Settings;
pub use window::{Display, NoDisplay, opens_beside, run};

/// No number is free for a file's name.
#[derive(Debug, Error)]
#[error("warpbeam-001.{extension} to warpbeam-999.{extension} all exist")]
struct NoName {
    extension: &'static str,
}

/// The first of `warpbeam-001.png`, … that does not exist.
fn free_name(extension: &'static str) -> Result<PathBuf, NoName> {
    let mut names = (1..1000).map(|i| PathBuf::from(format!("warpbeam-{i:03}.{extension}")));
    names.find(|path| !path.exists()).ok_or(NoName { extension })
}

/// Why the window closed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AppError {
    /// Nothing to draw with, or a picture not written.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// No moving picture.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The window system gave no window.
    #[error("no window: {0}")]
    Window(String),
}

/// Light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThemeChoice {
    /// Light text on dark.
    #[default]
    Dark,
    /// Dark text on light.
    Light,
}

impl From<ThemeChoice> for egui::Theme {
    fn from(choice: ThemeChoice) -> Self {
        match choice {
            ThemeChoice::Dark => Self::Dark,
            ThemeChoice::Light => Self::Light,
        }
    }
}
