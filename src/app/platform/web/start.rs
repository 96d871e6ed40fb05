//! Canvas of the page, and the event loop on it.

use winit::application::ApplicationHandler;
use winit::error::EventLoopError;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::platform::web::{EventLoopExtWebSys as _, WindowAttributesExtWebSys as _};
use winit::window::WindowAttributes;

use crate::app::platform::web::{self, page};

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
    page::listen(event_loop.create_proxy());
    event_loop.spawn_app(app);
    Ok(None)
}
