//! Differences between a program on a desktop and one on a web page: files, settings, clipboard, start, and the page
//! itself. Both folders have the same interface.

#[cfg(not(target_arch = "wasm32"))]
mod desktop;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use desktop::{IS_PAGE, clipboard, copies, files, graphics, new_file, page, settings, start, work};
#[cfg(target_arch = "wasm32")]
pub(crate) use web::{IS_PAGE, clipboard, copies, files, graphics, new_file, page, settings, start, work};
