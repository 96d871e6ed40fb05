//! The pointer over the body: drags move the view, the wheel zooms to the pointer.

use egui::{Response, Ui};

use crate::render::Camera;

/// What the pointer has done to the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Look {
    /// Nothing.
    Same,
    /// Somewhere else.
    At(Camera),
    /// Back to the whole body.
    Fit,
}

/// Follows the pointer over the view that `response` belongs to.
pub(super) fn look(ui: &Ui, response: &Response, mut camera: Camera) -> Look {
    if response.double_clicked() {
        return Look::Fit;
    }
    let mut look = Look::Same;
    let drag = response.drag_delta();
    if drag != egui::Vec2::ZERO {
        camera.pan([f64::from(drag.x), f64::from(drag.y)]);
        look = Look::At(camera);
    }
    if let Some(pointer) = response.hover_pos() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = f64::from(pinch) * (f64::from(scroll) * 0.004).exp();
        // A pointer that only rests over the view must not stop it from following the body.
        if factor != 1.0 {
            let at = pointer - response.rect.center();
            camera.zoom(factor, [f64::from(at.x), f64::from(at.y)]);
            look = Look::At(camera);
        }
    }
    look
}
