//! A mesh as points, triangles and lines to draw, whatever its elements: curved sides become polylines.

use std::collections::{BTreeMap, HashSet};

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::mesh::{Mesh, Segment};
use crate::scene::ElementKind;

/// Pieces a side is drawn in that may be curved.
const PIECES: u32 = 4;

/// What is drawn of a mesh. Points are weighted sums of nodes.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    /// Nodes of an element, and for each point those of its element with their weights.
    stride: usize,
    nodes: Vec<u32>,
    weights: Vec<f64>,
    /// Triangles between points.
    pub triangles: Vec<[u32; 3]>,
    /// The first quadrature point of each triangle's element, and the weights of that and the next ones in its value.
    value_of: Vec<u32>,
    value_weights: Vec<f64>,
    /// Element sides.
    pub lines: Vec<[u32; 2]>,
    /// The lines around the body, each closed, counter-clockwise.
    pub outline: Vec<Vec<u32>>,
    /// The sides of triangles that make them up.
    pub boundary: Vec<Segment>,
}

impl Drawing {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut drawing = Self { stride: mesh.element.nodes(), ..Self::default() };
        drawing.boundary = mesh.outline();
        let boundary: HashSet<_> = drawing.boundary.iter().map(Segment::key).collect();
        let mut drawn = HashSet::new();
        // Every boundary side's end corner and points, by its first corner.
        let mut around: BTreeMap<u32, Vec<(u32, Vec<u32>)>> = BTreeMap::new();
        for (number, triangle) in (0..).zip(mesh.triangles()) {
            let sides = drawing.add(mesh.element, number, triangle);
            for (side, points) in Mesh::sides(triangle).iter().zip(sides) {
                let pieces = || points.windows(2).map(|w| [w[0], w[1]]);
                if drawn.insert(side.key()) {
                    drawing.lines.extend(pieces());
                }
                if boundary.contains(&side.key()) {
                    around.entry(side.ends[0]).or_default().push((side.ends[1], points.clone()));
                }
            }
        }
        while let Some((&first, _)) = around.first_key_value() {
            let mut line = Vec::new();
            let mut corner = first;
            while let Some(sides) = around.get_mut(&corner) {
                let Some((next, points)) = sides.pop() else { break };
                if sides.is_empty() {
                    around.remove(&corner);
                }
                line.extend(points);
                corner = next;
            }
            drawing.outline.push(line);
        }
        drawing
    }

    /// A triangle cut into a lattice, of one piece where its sides are straight; returns the points of its sides.
    fn add(&mut self, element: ElementKind, number: u32, triangle: &[u32]) -> [Vec<u32>; 3] {
        let pieces = if element.degree() == 1 { 1 } else { PIECES };
        let first = (self.nodes.len() / self.stride) as u32;
        let local = |[i, j]: [u32; 2]| {
            let [b, c] = [i, j].map(|k| f64::from(k) / f64::from(pieces));
            [1.0 - b - c, b, c]
        };
        // Rows of the lattice get shorter: row j holds pieces + 1 − j points.
        let point = |[i, j]: [u32; 2]| first + j * (pieces + 1) - j * j.saturating_sub(1) / 2 + i;
        for (i, j) in (0..=pieces).flat_map(|j| (0..=pieces - j).map(move |i| (i, j))) {
            self.nodes.extend(triangle);
            self.weights.extend(element.shape(local([i, j])));
        }
        let points = element.quadrature_points();
        let mut small = |corners: [[u32; 2]; 3]| {
            self.triangles.push(corners.map(point));
            self.value_of.push(number * points.len() as u32);
            let linear = linear_weights(points, corners.map(local));
            let mean = || vec![1.0 / points.len() as f64; points.len()];
            self.value_weights.extend(linear.unwrap_or_else(mean));
        };
        for (i, j) in (0..pieces).flat_map(|j| (0..pieces - j).map(move |i| (i, j))) {
            small([[i, j], [i + 1, j], [i, j + 1]]);
            if i + j + 2 <= pieces {
                small([[i + 1, j], [i + 1, j + 1], [i, j + 1]]);
            }
        }
        [
            (0..=pieces).map(|i| point([i, 0])).collect(),
            (0..=pieces).map(|j| point([pieces - j, j])).collect(),
            (0..=pieces).map(|j| point([0, pieces - j])).collect(),
        ]
    }

    /// Where point `p` is, for nodes that are where `place` says.
    pub(super) fn point(&self, p: u32, place: &dyn Fn(u32) -> Vector2<f64>) -> Vector2<f64> {
        let own = p as usize * self.stride..(p as usize + 1) * self.stride;
        self.nodes[own.clone()].iter().zip(&self.weights[own]).map(|(&n, &w)| place(n) * w).sum()
    }

    /// Where all points are.
    pub(super) fn points(&self, place: &dyn Fn(u32) -> Vector2<f64>, positions: &mut Vec<Vector2<f64>>) {
        positions.clear();
        positions.extend((0..(self.nodes.len() / self.stride.max(1)) as u32).map(|p| self.point(p, place)));
    }

    /// The value of every triangle, from those of the quadrature points.
    pub(super) fn values(&self, at_points: &[f64], values: &mut Vec<f64>) {
        values.clear();
        let stride = self.value_weights.len() / self.value_of.len().max(1);
        values.extend(self.value_of.iter().zip(self.value_weights.chunks(stride.max(1))).map(|(&first, weights)| {
            let own = at_points.get(first as usize..).unwrap_or_default();
            own.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f64>()
        }));
    }
}

/// The weights on an element's quadrature points with which a linear field has its value in the middle of a small
/// triangle; `None` for other than three points, whose value is the element's.
fn linear_weights(points: &[[f64; 3]], corners: [[f64; 3]; 3]) -> Option<Vec<f64>> {
    let &[a, b, c] = points else { return None };
    let middle = Vector3::from([0, 1, 2].map(|k| corners.iter().map(|l| l[k]).sum::<f64>() / 3.0));
    let weights = Matrix3::from_columns(&[a, b, c].map(Vector3::from)).try_inverse()? * middle;
    Some(weights.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Beam, Diagonals};

    #[test]
    fn drawn_triangles_cover_the_body_once() {
        for element in ElementKind::ALL {
            let beam = Beam { length: 3.0, height: 2.0, cells: [3, 2], element, diagonals: Diagonals::Alternating };
            let mesh = Mesh::beam(&beam).unwrap();
            let drawing = Drawing::new(&mesh);
            let mut points = Vec::new();
            drawing.points(&|n| mesh.nodes[n as usize], &mut points);
            let area: f64 = drawing
                .triangles
                .iter()
                .map(|t| t.map(|p| points[p as usize]))
                .map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a)))
                .inspect(|area| assert!(*area > 0.0))
                .sum();
            assert!((area - 6.0).abs() < 1e-12, "{element:?}: {area}");
            assert_eq!(drawing.outline.len(), 1, "{element:?}: one line around");
            let line: Vec<_> = drawing.outline[0].iter().map(|&p| points[p as usize]).collect();
            let around: f64 = line.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
            assert!((around - 10.0).abs() < 1e-12, "{element:?}: {around}");
            assert_eq!(drawing.triangles.len(), drawing.value_of.len());
            // A field that is linear within elements is drawn as it is: its mean over the body is that of its points.
            let count = mesh.triangle_count() * element.quadrature_points().len();
            let at_points: Vec<f64> = (0..count).map(|q| (q % 7) as f64).collect();
            let mut values = Vec::new();
            drawing.values(&at_points, &mut values);
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            assert!((mean(&values) - mean(&at_points)).abs() < 1e-12, "{element:?}");
            drawing.values(&vec![5.0; count], &mut values);
            assert!(values.iter().all(|v| (v - 5.0).abs() < 1e-12), "{element:?}");
        }
    }
}
