//! The structured rectangle of a scene's `[beam]`.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::{Mesh, MeshError, Segment};
use crate::scene::{Beam, Diagonals};

impl Mesh {
    /// The rectangle [0, length] × [−height/2, height/2], two triangles a cell, with the edges `left`, `right`,
    /// `bottom` and `top`. Nodes are numbered column by column, from the left and from below.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`] where cells are too thin for their length.
    pub fn beam(beam: &Beam) -> Result<Self, MeshError> {
        let [nx, ny] = beam.cells;
        let node = |i: u32, j: u32| i * (ny + 1) + j;
        let nodes = (0..=nx)
            .flat_map(|i| (0..=ny).map(move |j| (i, j)))
            .map(|(i, j)| {
                let along = f64::from(i) / f64::from(nx);
                let across = f64::from(j) / f64::from(ny) - 0.5;
                Vector2::new(beam.length * along, beam.height * across)
            })
            .collect();
        let connectivity = (0..nx)
            .flat_map(|i| (0..ny).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                let rising = beam.diagonals == Diagonals::Same || (i + j) % 2 == 0;
                if rising { [a, b, c, a, c, d] } else { [a, b, d, b, c, d] }
            })
            .collect();
        let chain =
            |points: Vec<u32>| -> Vec<Segment> { points.windows(2).map(|w| Segment { ends: [w[0], w[1]] }).collect() };
        let edges = BTreeMap::from([
            ("left".to_owned(), chain((0..=ny).map(|j| node(0, j)).collect())),
            ("right".to_owned(), chain((0..=ny).map(|j| node(nx, j)).collect())),
            ("bottom".to_owned(), chain((0..=nx).map(|i| node(i, 0)).collect())),
            ("top".to_owned(), chain((0..=nx).map(|i| node(i, ny)).collect())),
        ]);
        Self::new(nodes, beam.element, connectivity, edges)
    }
}
