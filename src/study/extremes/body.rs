//! Bodies of the stability atlas: beams with rectangular or distorted cells, and bodies from mesh files.

use nalgebra::Vector2;

use crate::mesh::Mesh;
use crate::scene::{Scene, Source, open};

/// Body of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseBody {
    /// Cantilever.
    Beam,
    /// Built-in scene with a mesh file, by its name.
    File(&'static str),
}

/// Built-in scenes with mesh files.
pub const FILES: [&str; 3] = ["bracket", "clip", "cook"];

impl CaseBody {
    /// Returns the identifier in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Beam => "beam",
            Self::File(id) => id,
        }
    }
}

/// Returns the built-in scene with this name.
pub(super) fn scene(id: &str) -> Option<Scene> {
    open(&Source { name: id.into(), assignments: Vec::new() }).ok()
}

/// Returns the mesh of a scene's beam with nodes moved along the beam by this fraction of a cell, with alternating
/// sign: rectangles become trapezoids that point up and down in turn. Below one half no cell is inverted. `None` if
/// nothing is moved.
pub(super) fn distorted(scene: &Scene, distortion: f64) -> Option<Mesh> {
    let beam = scene.beam.as_ref().filter(|_| distortion > 0.0)?;
    let mesh = Mesh::beam(beam).ok()?;
    let [along, across] = beam.cells.map(f64::from);
    let cell = Vector2::new(beam.length / along, beam.height / across);
    let place = |x: Vector2<f64>| {
        let (i, j) = ((x.x / cell.x).round(), ((x.y + 0.5 * beam.height) / cell.y).round());
        let displacement = if (i + j) % 2.0 == 0.0 { distortion } else { -distortion };
        let stays = i == 0.0 || i == along;
        x + Vector2::new(if stays { 0.0 } else { displacement * cell.x }, 0.0)
    };
    let (entry, mut nodes) = (mesh.element().entry(), mesh.nodes().to_vec());
    for element in mesh.elements() {
        let corners: Vec<_> = element.iter().take(entry.cell.corners.len()).map(|&n| place(mesh.node(n))).collect();
        for (&node, &at) in element.iter().zip(entry.nodes) {
            // Nodes between corners stay half way, so that sides stay straight.
            let weights = (entry.cell.corner_weights)(at);
            nodes[node as usize] = corners.iter().zip(weights).map(|(x, weight)| x * weight).sum();
        }
    }
    Mesh::new(nodes, mesh.element(), mesh.connectivity().to_vec(), mesh.edges().clone()).ok()
}
