//! The window and its pictures. [`lab::Lab`] is what is shown: a scene, its simulation and how to look at it. The
//! window, the offscreen shot and the tests of the panel all show the same lab through [`lab::Lab::ui`].

use thiserror::Error;

use crate::render::RenderError;

mod action;
mod background;
mod budget;
mod drawing;
mod field;
mod finder;
mod format;
mod help;
mod history;
mod keys;
pub mod lab;
mod motion_plot;
mod overlay;
mod pace;
mod panel;
mod playback;
mod plot;
mod pointer;
mod record;
mod shot;
mod stage;
mod window;

pub use lab::{Lab, PANEL_WIDTH};
pub use record::{MovieFormat, Phase, RecordError, RecordOptions, RecordProgress, Recorded, record};
pub use shot::{MAX_SHOT_SIDE, ShotOptions, picture, shot};
pub use window::{Display, NoDisplay, run};

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
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
