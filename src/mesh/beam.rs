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
        // Nodes a cell and direction: quadratic elements have one in the middle.
        let per_cell = beam.element.degree();
        let [nx, ny] = beam.cells;
        let [columns, rows] = beam.cells.map(|n| n * per_cell);
        let node = |i: u32, j: u32| i * (rows + 1) + j;
        let nodes = (0..=columns)
            .flat_map(|i| (0..=rows).map(move |j| (i, j)))
            .map(|(i, j)| {
                let along = f64::from(i) / f64::from(columns);
                let across = f64::from(j) / f64::from(rows) - 0.5;
                Vector2::new(beam.length * along, beam.height * across)
            })
            .collect();
        let mut connectivity = Vec::new();
        for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (i, j))) {
            let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[p, q]| [(i + p) * per_cell, (j + q) * per_cell]);
            let rising = beam.diagonals == Diagonals::Same || (i + j) % 2 == 0;
            for corners in if rising { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] } {
                connectivity.extend(corners.map(|[i, j]| node(i, j)));
                if per_cell == 2 {
                    let between = |p: [u32; 2], q: [u32; 2]| node((p[0] + q[0]) / 2, (p[1] + q[1]) / 2);
                    let [p, q, r] = corners;
                    connectivity.extend([between(p, q), between(q, r), between(r, p)]);
                }
            }
        }
        let chain = |points: Vec<u32>| -> Vec<Segment> {
            points
                .windows(per_cell as usize + 1)
                .step_by(per_cell as usize)
                .map(|w| Segment { ends: [w[0], w[per_cell as usize]], middle: (per_cell == 2).then_some(w[1]) })
                .collect()
        };
        let edges = BTreeMap::from([
            ("left".to_owned(), chain((0..=rows).map(|j| node(0, j)).collect())),
            ("right".to_owned(), chain((0..=rows).map(|j| node(columns, j)).collect())),
            ("bottom".to_owned(), chain((0..=columns).map(|i| node(i, 0)).collect())),
            ("top".to_owned(), chain((0..=columns).map(|i| node(i, rows)).collect())),
        ]);
        Self::new(nodes, beam.element, connectivity, edges)
    }
}
