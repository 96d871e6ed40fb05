//! Window and event loop. Around the window of a desktop there is no web page.

use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::error::EventLoopError;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowAttributes};

use crate::app::platform::SMALLEST;

/// Returns the attributes of a window of this size, points.
pub(crate) fn window(attributes: WindowAttributes, event_loop: &ActiveEventLoop, size: [f32; 2]) -> WindowAttributes {
    let [width, height] = SMALLEST;
    let attributes = attributes.with_min_inner_size(LogicalSize::new(width, height));
    with_icon(attributes).with_inner_size(first_size(event_loop, size))
}

/// Adds the icons of title bar and taskbar, which `build.rs` has put into the program. A window of Windows has none by
/// itself.
#[cfg(windows)]
fn with_icon(attributes: WindowAttributes) -> WindowAttributes {
    use winit::dpi::PhysicalSize;
    use winit::platform::windows::{IconExtWindows as _, WindowAttributesExtWindows as _};
    use winit::window::Icon;

    /// Number of the icon in the program.
    const ICON: u16 = 1;
    let icon = |side: u32| Icon::from_resource(ICON, Some(PhysicalSize::new(side, side))).ok();
    attributes.with_window_icon(icon(32)).with_taskbar_icon(icon(256))
}

/// Adds nothing: other systems show the icon of the installed program.
#[cfg(not(windows))]
fn with_icon(attributes: WindowAttributes) -> WindowAttributes {
    attributes
}

/// Returns the size of a new window, points: the wanted size, but at most nine tenths of the screen.
fn first_size(event_loop: &ActiveEventLoop, wanted: [f32; 2]) -> LogicalSize<f64> {
    const SHARE: f64 = 0.9;
    let wanted = LogicalSize::new(f64::from(wanted[0]), f64::from(wanted[1]));
    let monitor = event_loop.primary_monitor().or_else(|| event_loop.available_monitors().next());
    monitor.filter(|m| m.size().width > 0 && m.size().height > 0).map_or(wanted, |monitor| {
        let screen = monitor.size().to_logical::<f64>(monitor.scale_factor());
        LogicalSize::new(wanted.width.min(SHARE * screen.width), wanted.height.min(SHARE * screen.height))
    })
}

/// Runs `opening` of the graphics device to its end.
pub(crate) fn open(opening: impl Future<Output = ()> + 'static) {
    pollster::block_on(opening);
}

/// Runs the event loop; returns the application when the window is closed.
pub(crate) fn run<A: ApplicationHandler>(event_loop: EventLoop<()>, mut app: A) -> Result<Option<A>, EventLoopError> {
    event_loop.run_app(&mut app)?;
    Ok(Some(app))
}

pub(crate) fn set_title(window: &Window, title: &str) {
    window.set_title(title);
}

/// Does nothing: a window asks before it closes.
pub(crate) fn ask_before_leaving(_: bool) {}

/// Does nothing: a program draws its frame again for an image.
pub(crate) fn save_frame(_: &Window, _: &str) -> Result<(), String> {
    Ok(())
}

/// Tells the page that a frame has been drawn. `report` returns the state of the window as JSON; it receives the number
/// of frames.
pub(crate) fn drawn(_report: impl FnOnce(u64) -> String) {}

/// Does nothing: the fingers on a touch screen belong to one device.
pub(crate) fn join_touches(_: &mut [egui::Event]) {}

/// Returns `false`: the settings of a window say whether motion is reduced.
pub(crate) fn prefers_reduced_motion() -> bool {
    false
}

/// Shows an error in place of the window; a program prints it instead.
pub(crate) fn fail(_: &str) {}

/// Returns the address of the page with a scene in it.
pub(crate) fn link(_: &str) -> String {
    String::new()
}
