//! A mesh as points, triangles and lines to draw, whatever its elements: curved sides become polylines.

use std::collections::{BTreeMap, HashSet};

use nalgebra::Vector2;

use crate::element::t6;
use crate::mesh::{Mesh, Segment};
use crate::scene::ElementKind;

/// Pieces a curved side is drawn in.
const PIECES: u32 = 4;

/// What is drawn of a mesh. Points are weighted sums of nodes.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    /// Nodes a point, and for each point that many nodes and weights.
    stride: usize,
    nodes: Vec<u32>,
    weights: Vec<f64>,
    /// Triangles between points.
    pub triangles: Vec<[u32; 3]>,
    /// The quadrature point whose value each triangle shows.
    value_of: Vec<u32>,
    /// Element sides.
    pub lines: Vec<[u32; 2]>,
    /// The lines around the body, each closed, counter-clockwise.
    pub outline: Vec<Vec<u32>>,
}

fn key(side: &Segment) -> (u32, u32) {
    (side.ends[0].min(side.ends[1]), side.ends[0].max(side.ends[1]))
}

impl Drawing {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut drawing = Self { stride: mesh.element.nodes(), ..Self::default() };
        let boundary: HashSet<_> = mesh.outline().iter().map(key).collect();
        let mut drawn = HashSet::new();
        // Every boundary side's end corner and points, by its first corner.
        let mut around: BTreeMap<u32, Vec<(u32, Vec<u32>)>> = BTreeMap::new();
        if mesh.element == ElementKind::T3 {
            drawing.stride = 1;
            drawing.nodes = (0..mesh.nodes.len() as u32).collect();
            drawing.weights = vec![1.0; mesh.nodes.len()];
        }
        for (number, triangle) in (0..).zip(mesh.triangles()) {
            let sides = match mesh.element {
                ElementKind::T3 => drawing.add_straight(number, triangle),
                ElementKind::T6 => drawing.add_curved(number, triangle),
            };
            for (side, points) in Mesh::sides(triangle).iter().zip(sides) {
                let pieces = || points.windows(2).map(|w| [w[0], w[1]]);
                if drawn.insert(key(side)) {
                    drawing.lines.extend(pieces());
                }
                if boundary.contains(&key(side)) {
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

    /// A triangle between its nodes; returns the points of its sides.
    fn add_straight(&mut self, number: u32, triangle: &[u32]) -> [Vec<u32>; 3] {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
        self.triangles.push([a, b, c]);
        self.value_of.push(number);
        [vec![a, b], vec![b, c], vec![c, a]]
    }

    /// A six-node triangle cut into a lattice; returns the points of its sides.
    fn add_curved(&mut self, number: u32, triangle: &[u32]) -> [Vec<u32>; 3] {
        let first = (self.nodes.len() / self.stride) as u32;
        let local = |i: u32, j: u32| {
            let [b, c] = [i, j].map(|k| f64::from(k) / f64::from(PIECES));
            [1.0 - b - c, b, c]
        };
        // Rows of the lattice get shorter: row j holds PIECES + 1 − j points.
        let point = |i: u32, j: u32| first + j * (PIECES + 1) - j * j.saturating_sub(1) / 2 + i;
        for (i, j) in (0..=PIECES).flat_map(|j| (0..=PIECES - j).map(move |i| (i, j))) {
            self.nodes.extend(triangle);
            self.weights.extend(t6::shape(local(i, j)));
        }
        for (i, j) in (0..PIECES).flat_map(|j| (0..PIECES - j).map(move |i| (i, j))) {
            self.triangles.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
            self.value_of.push(3 * number + nearest_quadrature_point(local(i, j), local(i + 1, j), local(i, j + 1)));
            if i + j + 2 <= PIECES {
                self.triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                let q = nearest_quadrature_point(local(i + 1, j), local(i + 1, j + 1), local(i, j + 1));
                self.value_of.push(3 * number + q);
            }
        }
        [
            (0..=PIECES).map(|i| point(i, 0)).collect(),
            (0..=PIECES).map(|j| point(PIECES - j, j)).collect(),
            (0..=PIECES).map(|j| point(0, PIECES - j)).collect(),
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
        values.extend(self.value_of.iter().map(|&q| at_points.get(q as usize).copied().unwrap_or(0.0)));
    }
}

/// The quadrature point nearest to the middle of a small triangle: each lies towards one corner.
fn nearest_quadrature_point(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> u32 {
    let sum = [0, 1, 2].map(|k| a[k] + b[k] + c[k]);
    (0..3).max_by(|&p, &q| sum[p as usize].total_cmp(&sum[q as usize])).unwrap_or(0)
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
        }
    }
}
