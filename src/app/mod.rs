//! The window and its pictures. [`lab::Lab`] is what is shown: a scene, its simulation and how to look at it. The
//! window, the offscreen shot and the tests of the panel all show the same lab through [`lab::Lab::ui`].

use std::path::PathBuf;

use thiserror::Error;

use crate::render::RenderError;

mod action;
mod arrow;
mod background;
mod budget;
mod clicks;
mod clipboard;
mod compare;
mod crossing;
mod document;
mod drawing;
mod edits;
mod errand;
mod eye;
mod field;
mod figure;
mod file_dialog;
mod finder;
mod gallery;
mod handle;
mod headline;
mod help;
mod history;
mod intro;
mod job;
mod keys;
pub mod lab;
mod language;
mod learn;
mod legend;
mod load_scale;
mod measured;
mod mode;
mod motion_plot;
mod overlay;
mod pace;
mod palette;
mod panel;
mod past;
mod playback;
mod plot;
mod pointer;
mod probe;
mod quality;
mod record;
mod recorder;
mod recovery;
mod settings;
mod shape;
mod shot;
mod size;
mod stage;
mod time_line;
mod toolbar;
mod turn;
mod verdict;
mod window;

pub use compare::{MotionPane, MotionPaneSetting, Pane, PaneEnd, PaneSetting, PaneSettingError, parse_panes};
pub use lab::{Lab, PANEL_WIDTH};
pub use language::Language;
pub use record::{MovieFormat, Phase, RecordError, RecordOptions, RecordProgress, Recorded, record};
#[doc(hidden)]
pub use recovery::{Recovery, Unsaved};
pub use settings::Settings;
pub use shot::{Canvas, FrameTimes, MAX_SHOT_SIDE, ShotOptions, picture, shot};
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
