//! View of a body in a part of the window: its drawn mesh, and the pointer over it. Several views can share a camera.

use crate::app::interface::*;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::pointer::Pointer;
use crate::app::viewport::probe;
use crate::app::viewport::projection::{DrawnBody, Projection};
use crate::render::Viewport;

#[derive(Debug)]
pub(crate) struct BodyView {
    /// Area in the window, points; empty before the first frame.
    pub rect: Rect,
    pub pointer: Pointer,
    pub body: BodyMesh,
}

impl Default for BodyView {
    fn default() -> Self {
        let mut body = BodyMesh::default();
        body.magnification = 1.0;
        Self { rect: Rect::ZERO, pointer: Pointer::default(), body }
    }
}

impl BodyView {
    /// Returns the input of the render pass, at this number of pixels per point.
    pub(crate) fn view(&self, camera: Camera, wireframe: bool, pixels_per_point: f32) -> View<'_> {
        let place = self.rect * pixels_per_point;
        let [corner, end] = [place.min, place.max].map(|p| [p.x, p.y].map(|v| v.round().max(0.0) as u32));
        let size = [0, 1].map(|axis| end[axis].saturating_sub(corner[axis]));
        View { viewport: Viewport { corner, size }, frame: self.body.frame(wireframe), camera }
    }

    pub(crate) fn projection(&self, camera: &CameraController) -> Projection {
        Projection { camera: camera.shown, rect: self.rect }
    }

    /// Returns the body as of the last frame, with the loads of a scene at a simulated time, s. `direction` is that of the
    /// arrow of a zero force, degrees.
    pub(crate) fn drawn_body<'a>(
        &'a self,
        projection: Projection,
        (scene, time): (&'a Scene, f64),
        (session, direction): (&Session, f64),
    ) -> Option<DrawnBody<'a>> {
        let (system, positions, geometry) = (self.body.system.as_ref()?, &self.body.nodes, &self.body.geometry);
        let opening = session.document().opened;
        Some(DrawnBody { scene, system, geometry, positions, projection, time, direction, opening })
    }

    /// Shows the value of the displayed field and the displacement of a body at a material point, next to a position in the
    /// window.
    pub(crate) fn show_value(&self, ui: &Ui, body: &Simulation, point: MaterialPoint, at: Pos2) {
        let Some(u) = probe::place(body.mesh(), body.displacement(), point) else { return };
        let field = self.body.field.field;
        let (factor, unit) = field.display_unit();
        let unknown = if unit == "Pa" { "not defined: crushed or inverted here" } else { "unknown" };
        let value = self.body.field.at(body.mesh(), point).map(|value| engineering(three_digits(factor * value), unit));
        let value = value.unwrap_or_else(|| tr(unknown).to_owned());
        let text = format!("{}: {value}\nu = {}", tr(field.name()), probe::metres(u));
        let (place, visuals) = (at + vec2(16.0, 18.0), ui.visuals());
        let color = visuals.strong_text_color();
        Labels::new(&ui.painter_at(self.rect), visuals).add(place, Align2::LEFT_TOP, &text, color, 320.0);
    }
}
