//! Web page: chosen files instead of a folder, downloads, local storage, a canvas as the window; and the browser: its
//! document, its timer, its errors, and the event loop that they wake.

use std::cell::RefCell;

use wasm_bindgen::prelude::*;
use web_sys::{Document, HtmlCanvasElement};
use winit::event_loop::EventLoopProxy;

pub(crate) mod clipboard;
pub(crate) mod files;
pub(crate) mod page;
pub(crate) mod settings;
pub(crate) mod work;

thread_local! {
    static PROXY: RefCell<Option<EventLoopProxy<()>>> = RefCell::default();
}

/// Sets the event loop that [`wake`] wakes.
pub(super) fn set_proxy(proxy: EventLoopProxy<()>) {
    PROXY.set(Some(proxy));
}

/// Returns the document of the page; `None` in a worker.
pub(super) fn document() -> Option<Document> {
    web_sys::window()?.document()
}

pub(super) fn canvas() -> Option<HtmlCanvasElement> {
    document()?.get_element_by_id("warpbeam")?.dyn_into().ok()
}

pub(super) fn wake() {
    PROXY.with_borrow(|proxy| proxy.iter().for_each(|proxy| _ = proxy.send_event(())));
}

/// Calls a function after a delay, ms.
pub(super) fn later(function: &JsValue, delay: i32) {
    if let Some(window) = web_sys::window() {
        let function = function.unchecked_ref();
        let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(function, delay);
    }
}

/// Returns the message of an error of the browser.
pub(super) fn message(error: &JsValue) -> String {
    error.dyn_ref::<js_sys::Error>().map_or_else(|| format!("{error:?}"), |error| String::from(error.message()))
}
