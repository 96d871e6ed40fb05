//! Uniform refinement: every triangle into four, curved sides along their own curve.

use nalgebra::Vector2;

use super::{Mesh, Middles, Segment};

/// The corners of the four triangles, by corner (0, 1, 2) and middle of a side (3: between 0 and 1, then on).
const PARTS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
/// The area coordinates of those six.
const PLACES: [[f64; 3]; 6] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]];

impl Mesh {
    /// The mesh with every triangle cut into four of the same element and every named edge into halves. Its nodes come
    /// first, with the same numbers; the body is the same.
    #[must_use]
    pub fn refined(&self) -> Self {
        let quadratic = self.element.degree() > 1;
        let mut nodes = self.nodes.clone();
        let mut middles = Middles::default();
        let mut connectivity = Vec::with_capacity(4 * self.connectivity.len());
        for triangle in self.triangles() {
            let place = |l: [f64; 3]| -> Vector2<f64> {
                let shape = self.element.shape(l);
                triangle.iter().zip(&shape).map(|(&node, n)| self.nodes[node as usize] * *n).sum()
            };
            let mut six = [0; 6];
            six[..triangle.len()].copy_from_slice(triangle);
            if !quadratic {
                for side in 0..3 {
                    let at = PLACES[3 + side];
                    six[3 + side] = middles.between(&mut nodes, [six[side], six[(side + 1) % 3]], |_| place(at));
                }
            }
            for part in PARTS {
                connectivity.extend(part.map(|i| six[i]));
                if quadratic {
                    for side in 0..3 {
                        let (a, b) = (part[side], part[(side + 1) % 3]);
                        let at = [0, 1, 2].map(|i| 0.5 * (PLACES[a][i] + PLACES[b][i]));
                        connectivity.push(middles.between(&mut nodes, [six[a], six[b]], |_| place(at)));
                    }
                }
            }
        }
        let halves = |segment: &Segment| {
            let [a, b] = segment.ends;
            let middle = segment.middle.or_else(|| middles.get([a, b]));
            let half = |ends: [u32; 2]| Segment { ends, middle: if quadratic { middles.get(ends) } else { None } };
            // A segment that no triangle has stays whole; a mesh's edges are sides of its triangles.
            middle.map_or_else(|| vec![*segment], |m| vec![half([a, m]), half([m, b])])
        };
        let edges =
            self.edges.iter().map(|(name, segments)| (name.clone(), segments.iter().flat_map(halves).collect()));
        let edges = edges.collect();
        Self { nodes, element: self.element, connectivity, edges }
    }
}
