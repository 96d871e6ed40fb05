//! Web page around the window: on a desktop there is none.

use winit::window::Window;

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
