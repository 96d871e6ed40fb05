//! Page around the window: its canvas with the event loop, its address, its title, its messages, and the report that tests
//! read.

use std::cell::{Cell, RefCell};

use base64::Engine as _;
use base64::prelude::BASE64_URL_SAFE_NO_PAD;
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, DragEvent, Event, UrlSearchParams};
use winit::application::ApplicationHandler;
use winit::error::EventLoopError;
use winit::event_loop::{ActiveEventLoop, EventLoop, EventLoopProxy};
use winit::platform::web::{EventLoopExtWebSys as _, WindowAttributesExtWebSys as _, WindowExtWebSys as _};
use winit::window::{Window, WindowAttributes};

use crate::app::platform::web::{self, files};

/// Level of the compression of scenes in links, of 10.
const LEVEL: u8 = 9;
/// Largest text of a scene in a link, bytes.
const MAX_SCENE_BYTES: usize = 1 << 20;
/// Begin of the fragment of an address that holds a scene.
const FRAGMENT: &str = "scene=";

thread_local! {
    static FRAMES: Cell<u64> = const { Cell::new(0) };
    /// State of the window after the last frame, JSON.
    static REPORT: RefCell<String> = RefCell::default();
    /// `true` if the browser asks before the page is left.
    static ASKS: Cell<bool> = const { Cell::new(false) };
    /// `true` once the page listens for the event before it is left.
    static LISTENS: Cell<bool> = const { Cell::new(false) };
}

/// Request in the address of the page.
#[derive(Debug, Default)]
pub(crate) struct Address {
    /// Name of a built-in scene.
    pub scene: Option<String>,
    /// TOML text of a scene, or the reason for which the link has none.
    pub toml: Option<Result<String, String>>,
    pub language: Option<String>,
    /// Number of a card of Learn, from 1.
    pub card: Option<usize>,
}

impl Address {
    pub(crate) fn read() -> Self {
        let Some(window) = web_sys::window() else { return Self::default() };
        let location = window.location();
        let search = location.search().unwrap_or_default();
        let parameters = UrlSearchParams::new_with_str(&search).ok();
        let parameter = |name: &str| parameters.as_ref().and_then(|parameters| parameters.get(name));
        let fragment = location.hash().unwrap_or_default();
        Self {
            scene: parameter("scene"),
            toml: fragment.strip_prefix('#').and_then(|text| text.strip_prefix(FRAGMENT)).map(decode),
            language: parameter("lang"),
            card: parameter("card").and_then(|card| card.parse().ok()),
        }
    }
}

/// Returns the language that the browser prefers, such as `zh-CN`.
pub(crate) fn language() -> Option<String> {
    web_sys::window()?.navigator().language()
}

/// Returns the browser's description of itself, which names the system.
pub(crate) fn user_agent() -> String {
    web_sys::window().and_then(|window| window.navigator().user_agent().ok()).unwrap_or_default()
}

/// Returns `true` if the browser is set to reduce motion.
pub(crate) fn prefers_reduced_motion() -> bool {
    let query =
        web_sys::window().and_then(|window| window.match_media("(prefers-reduced-motion: reduce)").ok().flatten());
    query.is_some_and(|query| query.matches())
}

/// Returns the text of a scene in a link, or the reason for which it cannot be read.
fn decode(packed: &str) -> Result<String, String> {
    let bytes = BASE64_URL_SAFE_NO_PAD.decode(packed).map_err(|error| error.to_string())?;
    let text = decompress_to_vec_with_limit(&bytes, MAX_SCENE_BYTES).map_err(|error| error.to_string())?;
    String::from_utf8(text).map_err(|error| error.to_string())
}

/// Returns the address of the page with a scene in it.
pub(crate) fn link(toml: &str) -> String {
    let location = web_sys::window().map(|window| window.location());
    let part = |part: Option<Result<String, JsValue>>| part.and_then(Result::ok).unwrap_or_default();
    let origin = part(location.as_ref().map(web_sys::Location::origin));
    let path = part(location.as_ref().map(web_sys::Location::pathname));
    let packed = BASE64_URL_SAFE_NO_PAD.encode(compress_to_vec(toml.as_bytes(), LEVEL));
    format!("{origin}{path}#{FRAGMENT}{packed}")
}

/// Receives dropped files, answers requests for a report, and wakes the event loop from now on.
fn listen(proxy: EventLoopProxy<()>) {
    web::set_proxy(proxy);
    let Some(document) = web::document() else { return };
    let over = Closure::<dyn FnMut(DragEvent)>::new(|event: DragEvent| event.prevent_default());
    let dropped = Closure::<dyn FnMut(DragEvent)>::new(|event: DragEvent| {
        event.prevent_default();
        event.data_transfer().and_then(|data| data.files()).iter().for_each(files::receive);
    });
    document.set_ondragover(Some(over.as_ref().unchecked_ref()));
    document.set_ondrop(Some(dropped.as_ref().unchecked_ref()));
    let report = Closure::<dyn FnMut() -> String>::new(|| REPORT.with_borrow(String::clone));
    set("report", report.as_ref());
    // They live as long as the page.
    over.forget();
    dropped.forget();
    report.forget();
}

pub(crate) fn set_title(_: &Window, title: &str) {
    if let Some(document) = web::document().filter(|document| document.title() != title) {
        document.set_title(title);
    }
}

/// Lets the browser ask before the page is left, or not.
pub(crate) fn ask_before_leaving(asks: bool) {
    ASKS.set(asks);
    if !asks || LISTENS.replace(true) {
        return;
    }
    let ask = Closure::<dyn Fn(Event)>::new(|event: Event| {
        if ASKS.get() {
            event.prevent_default();
        }
    });
    if let Some(window) = web_sys::window()
        && window.add_event_listener_with_callback("beforeunload", ask.as_ref().unchecked_ref()).is_ok()
    {
        // The page listens until it is left.
        ask.forget();
    }
}

/// Saves the drawn frame as an image.
pub(crate) fn save_frame(window: &Window, name: &str) -> Result<(), String> {
    let name = name.to_owned();
    let done = Closure::once_into_js(move |blob: Option<Blob>| {
        if let Some(Err(error)) = blob.map(|blob| files::download(&name, &blob)) {
            log::warn!("no picture: {}", web::message(&error));
        }
    });
    let canvas = window.canvas().ok_or("canvas")?;
    canvas.to_blob(done.unchecked_ref()).map_err(|error| web::message(&error))
}

/// Tells the page that a frame has been drawn. `report` returns the state of the window as JSON; it receives the number
/// of frames.
pub(crate) fn drawn(report: impl FnOnce(u64) -> String) {
    let frames = FRAMES.get() + 1;
    FRAMES.set(frames);
    REPORT.set(report(frames));
    if frames == 1 {
        call("ready", &[]);
    }
}

/// Gives all fingers the same device. winit makes each finger a device of its own, and gestures in egui have one
/// device.
pub(crate) fn join_touches(events: &mut [egui::Event]) {
    for event in events {
        if let egui::Event::Touch { device_id, .. } = event {
            *device_id = egui::TouchDeviceId(0);
        }
    }
}

/// Shows a message in place of the window.
pub(crate) fn fail(message: &str) {
    call("fail", &[message.into()]);
}

/// Calls a function of the page's object `warpbeam`.
fn call(name: &str, arguments: &[JsValue]) {
    let object = js_sys::Reflect::get(&js_sys::global(), &"warpbeam".into());
    let function = object.and_then(|object| js_sys::Reflect::get(&object, &name.into()));
    if let Some(function) = function.ok().and_then(|function| function.dyn_into::<js_sys::Function>().ok()) {
        let _ = function.apply(&JsValue::UNDEFINED, &arguments.iter().collect());
    }
}

/// Sets a function of the page's object `warpbeam`.
fn set(name: &str, function: &JsValue) {
    if let Ok(object) = js_sys::Reflect::get(&js_sys::global(), &"warpbeam".into()) {
        let _ = js_sys::Reflect::set(&object, &name.into(), function);
    }
}

/// Returns the attributes of a window on the page's canvas, whose size the page sets.
pub(crate) fn window(attributes: WindowAttributes, _: &ActiveEventLoop, _: [f32; 2]) -> WindowAttributes {
    attributes.with_canvas(web::canvas())
}

/// Runs `opening` of the graphics device while the page goes on.
pub(crate) fn open(opening: impl Future<Output = ()> + 'static) {
    wasm_bindgen_futures::spawn_local(opening);
}

/// Starts the event loop, which runs as long as the page is open.
pub(crate) fn run<A: ApplicationHandler + 'static>(
    event_loop: EventLoop<()>,
    app: A,
) -> Result<Option<A>, EventLoopError> {
    listen(event_loop.create_proxy());
    event_loop.spawn_app(app);
    Ok(None)
}
