//! Work that a page does between two frames, because it has no threads.

use std::io;

use wasm_bindgen::prelude::*;

use crate::app::platform::web::browser;

/// Starts `work` after the current frame.
///
/// # Errors
/// None.
pub(crate) fn start(_: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    browser::later(&Closure::once_into_js(work), 0);
    Ok(())
}
