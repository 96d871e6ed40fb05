//! Content of the window: bars, dialogs, shortcuts, and the dispatch of actions.

pub(crate) mod bars;
mod dispatch;
pub(crate) mod file_dialog;
mod files;
pub(crate) mod gallery;
pub mod lab;
mod layout;
pub(crate) mod settings;
pub(crate) mod shortcuts;
pub(crate) mod story;

use self::lab::{Desk, Lab, Request};
use crate::app::interface::*;
use crate::app::panel::PanelState;
use crate::app::session::document::built_in;
