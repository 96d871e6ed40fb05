//! Differences between a program on a desktop and one on a web page: files, settings, clipboard, start, and the page
//! itself. Both folders have the same interface.

#[cfg(not(target_arch = "wasm32"))]
mod desktop;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use desktop::{clipboard, files, page, settings, work};
#[cfg(target_arch = "wasm32")]
pub(crate) use web::{clipboard, files, page, settings, work};

/// `true` if the program runs on a web page.
pub(crate) const IS_PAGE: bool = cfg!(target_arch = "wasm32");
/// Smallest size of the window, points: all controls can be reached. Where a window is smaller, such as a page on a phone,
/// everything in it is drawn smaller.
pub(crate) const SMALLEST: [f32; 2] = [640.0, 480.0];
