//! The pointer over the body: a press on it pulls it, a drag of empty space moves the view, the wheel zooms to the pointer.

use egui::{CursorIcon, Pos2, Response, Ui};
use nalgebra::Vector2;

use super::playback::Playback;
use crate::mesh::{MaterialPoint, Segment};
use crate::render::Camera;
use crate::simulation::Simulation;

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

/// So near to a thin body, points, counts as on it.
const NEAR: f64 = 8.0;

/// Follows the pointer over the view that `response` belongs to, while it does not hold the body.
pub(super) fn look(ui: &Ui, response: &Response, mut camera: Camera, holds: bool) -> Look {
    if response.double_clicked() {
        return Look::Fit;
    }
    let mut look = Look::Same;
    // Two fingers move the view together, wherever they are.
    let fingers = ui.input(|i| i.multi_touch()).map(|touch| touch.translation_delta);
    let drag = fingers.unwrap_or_else(|| response.drag_delta());
    if drag != egui::Vec2::ZERO && !holds {
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

/// What a hand needs to find the body.
pub(super) struct Reach<'a> {
    pub camera: Camera,
    /// Where the nodes are, m.
    pub positions: &'a [Vector2<f64>],
    pub outline: &'a [Segment],
}

impl Reach<'_> {
    /// The place in the plane under a place in the view, m.
    fn place(&self, response: &Response, at: Pos2) -> Vector2<f64> {
        let at = at - response.rect.center();
        self.camera.to_world([f64::from(at.x), f64::from(at.y)])
    }

    fn point(&self, simulation: &Simulation, place: Vector2<f64>) -> Option<MaterialPoint> {
        simulation.system().mesh().pick(self.positions, self.outline, place, NEAR / self.camera.scale)
    }
}

/// Takes hold of the body where it is pressed, pulls it to the pointer, and lets it go. Says whether it is held.
pub(super) fn hold(
    ui: &Ui,
    response: &Response,
    reach: &Reach<'_>,
    simulation: &mut Simulation,
    playback: &mut Playback,
) -> bool {
    let (pressed, down, pointer, fingers) = ui.input(|i| {
        (i.pointer.primary_pressed(), i.pointer.primary_down(), i.pointer.interact_pos(), i.multi_touch().is_some())
    });
    let place = pointer.map(|at| reach.place(response, at));
    if let Some((hand, _)) = simulation.hand() {
        let target = hand.target();
        match place.filter(|_| down && !fingers) {
            Some(place) if place != target => {
                // A pointer has a finite place.
                let _ = simulation.pull_to(place);
                playback.pull_to(place);
            }
            Some(_) => {}
            None => {
                simulation.release();
                playback.release();
            }
        }
    } else if let (Some(place), true) = (place, pressed && response.is_pointer_button_down_on()) {
        if let Some(point) = reach.point(simulation, place)
            && simulation.grab(point)
        {
            playback.grab(point);
        }
    } else if let (Some(at), false) = (response.hover_pos(), down) {
        let on_body = reach.point(simulation, reach.place(response, at)).is_some();
        ui.set_cursor_icon(if on_body { CursorIcon::Grab } else { CursorIcon::Default });
    }
    let holds = simulation.hand().is_some();
    if holds {
        ui.set_cursor_icon(CursorIcon::Grabbing);
    }
    holds
}
