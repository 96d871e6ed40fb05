//! The window's contents: bars, dialogs, shortcuts, and the dispatch of actions.

pub(crate) mod file_dialog;
pub(crate) mod gallery;
pub(crate) mod help;
pub(crate) mod intro;
pub mod lab;
pub(crate) mod settings;
pub(crate) mod shortcuts;
pub(crate) mod status_bar;
pub(crate) mod toolbar;
