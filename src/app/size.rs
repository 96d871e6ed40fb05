//! How large a scene is, before it is meshed: what is small is solved between two frames, the rest beside the window.

use crate::scene::{ElementKind, Scene};

/// More unknowns than this are not solved between two frames in a pane, which is one of several.
pub(crate) const MOST_UNKNOWNS: f64 = 4000.0;
/// More are not meshed and solved between two frames where one body is all there is.
pub(crate) const MOST_ALONE: f64 = 16_000.0;

/// About so many unknowns.
pub(crate) fn unknowns(scene: &Scene) -> f64 {
    // Nodes a side of a cell.
    let along = if scene.element() == ElementKind::T6 { 2.0 } else { 1.0 };
    match (&scene.beam, &scene.mesh) {
        (Some(beam), _) => {
            let [a, b] = beam.cells.map(|n| f64::from(n) * along + 1.0);
            2.0 * a * b
        }
        // A node takes a line of the file, and is counted without its elements' lines.
        (None, Some(mesh)) => {
            let lines = mesh.text.as_ref().map_or(0, |text| text.lines().count());
            2.0 * lines as f64 * along
        }
        (None, None) => 0.0,
    }
}
