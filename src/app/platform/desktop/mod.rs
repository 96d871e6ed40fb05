//! Desktop: files on disk, the system clipboard, a window of its own.

pub(crate) mod clipboard;
pub(crate) mod files;
pub(crate) mod page;
pub(crate) mod settings;
pub(crate) mod work;
