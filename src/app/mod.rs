//! The application: window, screenshots and recordings. [`Lab`] is the content of a window: a scene, its simulation and
//! the display options. The window, the offscreen shot and the tests of the panel all show it through [`Lab::ui`].

use thiserror::Error;

use crate::render::RenderError;
use crate::sentence::Sentence;

mod action;
mod diagnosis;
mod interface;
mod language;
mod modes;
mod offscreen;
mod panel;
mod platform;
mod prelude;
mod session;
mod shell;
mod task;
mod view_options;
mod viewport;
mod widgets;
mod window;

pub use crate::image::Picture;
pub use language::Language;
pub use modes::compare::{Pane, PaneSetting, PaneSettingError, parse_panes};
#[doc(hidden)]
pub use modes::learn::card_count;
pub use offscreen::options::{AdapterArgs, LookArgs, RecordOptions, ShotOptions};
pub use offscreen::record::{MovieFormat, RecordError, Recorded, record};
pub use offscreen::shot::{Canvas, FrameTimes, Shot, picture, shot};
pub use panel::PANEL_WIDTH;
pub use session::recovery::{RecoveryCopies, Unsaved};
#[doc(hidden)]
pub use session::run::PaneEnd;
pub use shell::lab::{Lab, Request};
pub use shell::settings::Settings;
#[doc(hidden)]
pub use shell::shortcuts::{FOCUS_KEYS, MOUSE};
pub use view_options::{Magnification, MeasureTab};
#[cfg(target_arch = "wasm32")]
pub use window::page::open_page;
pub use window::{Display, NoDisplay, opens_in_background, run};

/// Error of the window, of a screenshot or of a recording.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AppError {
    /// Drawing failed, or an image could not be written.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The recording failed.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The window system failed to open or to run the window.
    #[error("no window: {0}")]
    Window(String),
}

impl From<&AppError> for Sentence {
    fn from(error: &AppError) -> Self {
        match error {
            AppError::Record(error) => error.into(),
            other => other.to_string().into(),
        }
    }
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
        if choice == ThemeChoice::Dark { Self::Dark } else { Self::Light }
    }
}
