//! Content of the window: bars, dialogs, shortcuts, and the dispatch of actions.

mod api;
mod dispatch;
pub(crate) mod file_dialog;
mod files;
pub(crate) mod gallery;
pub mod lab;
mod layout;
mod learning;
mod messages;
pub(crate) mod settings;
pub(crate) mod shortcuts;
pub(crate) mod status_bar;
pub(crate) mod story;
pub(crate) mod toolbar;

use self::lab::{Desk, Lab, Request};
use crate::app::interface::*;
use crate::app::panel::PanelState;
use crate::app::session::document::built_in;
