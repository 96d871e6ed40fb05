//! View of a body in a part of the window: its drawn mesh, and the pointer over it. Several views can share a camera.

use crate::app::interface::*;
use crate::app::viewport::arrow::LoadedBody;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::pointer::Pointer;
use crate::app::viewport::probe;
use crate::app::viewport::projection::{Projection, viewport};

/// View of a body in a part of the window.
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
        View { viewport: viewport(self.rect, pixels_per_point), frame: self.body.frame(wireframe), camera }
    }

    pub(crate) fn projection(&self, camera: &CameraController) -> Projection {
        Projection { camera: camera.shown, rect: self.rect }
    }

    /// Returns the loads of a scene at a simulated time, s, on the body as of the last frame. `direction` is that of the arrow
    /// of a zero force, degrees.
    pub(crate) fn forces<'a>(
        &'a self,
        scene: &'a Scene,
        time: f64,
        (session, direction): (&Session, f64),
    ) -> Option<LoadedBody<'a>> {
        let (system, positions) = (self.body.system.as_ref()?, &self.body.nodes);
        Some(LoadedBody { scene, system, positions, time, direction, opening: session.document().opened })
    }

    /// Returns the displayed field and its value at a material point of a body's mesh.
    pub(crate) fn field_at(&self, mesh: &Mesh, point: MaterialPoint) -> (Field, Option<f64>) {
        (self.body.field.field, self.body.field.at(mesh, point))
    }

    /// Shows the values of a body at a material point, next to a position in the window.
    pub(crate) fn show_value(&self, ui: &Ui, body: &Simulation, point: MaterialPoint, at: Pos2) {
        if let Some(u) = probe::place(body.mesh(), body.displacement(), point) {
            probe::paint_hover(ui, &ui.painter_at(self.rect), at, self.field_at(body.mesh(), point), u);
        }
    }
}
