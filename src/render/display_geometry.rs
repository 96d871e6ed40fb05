//! Display geometry of a mesh: points, triangles and lines for all element types; curved sides become polylines.

use std::collections::{BTreeMap, HashSet};

use nalgebra::Vector2;

use crate::element::ElementType;
use crate::mesh::{Mesh, Segment};

/// Display geometry of a mesh. Points are weighted sums of nodes.
#[derive(Debug, Default)]
pub(crate) struct DisplayGeometry {
    /// Number of nodes per element; `nodes` and `weights` have this many entries per point: the nodes of its element,
    /// and their weights.
    stride: usize,
    nodes: Vec<u32>,
    weights: Vec<f64>,
    /// Triangles, as indices of points.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the first quadrature point of each triangle's element.
    value_of: Vec<u32>,
    /// Weights of the element's quadrature points in each triangle's value.
    value_weights: Vec<f64>,
    /// Segments of the element sides, as indices of points.
    pub lines: Vec<[u32; 2]>,
    /// Triangle adjacent to each segment.
    pub triangles_of_lines: Vec<u32>,
    /// Number of segments per element side.
    pub pieces: u32,
    /// Closed lines around the body, counter-clockwise, as indices of points.
    pub outline: Vec<Vec<u32>>,
    /// Element sides on the boundary of the mesh.
    pub boundary: Vec<Segment>,
}

impl DisplayGeometry {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let entry = mesh.element().entry();
        let (stride, pieces) = (entry.nodes.len(), entry.drawn_pieces);
        let mut drawing = Self { stride, pieces, boundary: mesh.outline(), ..Self::default() };
        let pattern = CellPattern::new(entry);
        let boundary: HashSet<_> = drawing.boundary.iter().map(Segment::key).collect();
        let mut drawn = HashSet::new();
        // Boundary sides by their first corner: each with its end corner and its points.
        let mut around: BTreeMap<u32, Vec<(u32, Vec<u32>)>> = BTreeMap::new();
        for (number, nodes) in (0..).zip(mesh.elements()) {
            let first_triangle = drawing.triangles.len() as u32;
            let first = drawing.add(&pattern, number, nodes);
            for ((side, points), triangles_of_lines) in
                mesh.sides(nodes).zip(&pattern.sides).zip(&pattern.triangles_of_lines)
            {
                let points: Vec<u32> = points.iter().map(|p| first + p).collect();
                if drawn.insert(side.key()) {
                    drawing.lines.extend(points.windows(2).map(|w| [w[0], w[1]]));
                    drawing.triangles_of_lines.extend(triangles_of_lines.iter().map(|t| first_triangle + t));
                }
                if boundary.contains(&side.key()) {
                    let [from, to] = side.ends();
                    around.entry(from).or_default().push((to, points));
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

    /// Adds an element; returns the index of its first point.
    fn add(&mut self, pattern: &CellPattern, number: u32, nodes: &[u32]) -> u32 {
        let first = (self.nodes.len() / self.stride) as u32;
        for weights in &pattern.points {
            self.nodes.extend(nodes);
            self.weights.extend(weights);
        }
        for (corners, weights) in &pattern.triangles {
            self.triangles.push(corners.map(|p| first + p));
            self.value_of.push(number * weights.len() as u32);
            self.value_weights.extend(weights);
        }
        first
    }

    /// Returns the position of point `p`; `place` returns the positions of nodes.
    pub(crate) fn point(&self, p: u32, place: &dyn Fn(u32) -> Vector2<f64>) -> Vector2<f64> {
        let own = p as usize * self.stride..(p as usize + 1) * self.stride;
        self.nodes[own.clone()].iter().zip(&self.weights[own]).map(|(&n, &w)| place(n) * w).sum()
    }

    /// Computes the positions of all points.
    pub(crate) fn points(&self, place: &dyn Fn(u32) -> Vector2<f64>, positions: &mut Vec<Vector2<f64>>) {
        positions.clear();
        positions.extend((0..(self.nodes.len() / self.stride.max(1)) as u32).map(|p| self.point(p, place)));
    }

    /// Computes the values at the corners of every triangle from nodal values with the shape functions; `None` if a
    /// nodal value is missing. With a `period`, values that differ by a multiple of it are equivalent.
    pub(crate) fn nodal_values(
        &self,
        at_nodes: &[Option<f64>],
        period: Option<f64>,
        values: &mut Vec<[Option<f64>; 3]>,
    ) {
        values.clear();
        let at = |p: u32| -> Option<f64> {
            let own = p as usize * self.stride..(p as usize + 1) * self.stride;
            let mut first = None;
            self.nodes[own.clone()]
                .iter()
                .zip(&self.weights[own])
                .map(|(&n, &weight)| {
                    let value = *at_nodes.get(n as usize)?.as_ref()?;
                    let near = *first.get_or_insert(value);
                    let turns = period.map_or(0.0, |period| period * ((value - near) / period).round());
                    Some((value - turns) * weight)
                })
                .sum()
        };
        values.extend(self.triangles.iter().map(|corners| corners.map(at)));
    }

    /// Computes the value of every triangle, equal at its corners, from values at quadrature points; `None` if one is
    /// missing.
    pub(crate) fn values(&self, at_points: &[Option<f64>], values: &mut Vec<[Option<f64>; 3]>) {
        values.clear();
        let stride = self.value_weights.len() / self.value_of.len().max(1);
        values.extend(self.value_of.iter().zip(self.value_weights.chunks(stride.max(1))).map(|(&first, weights)| {
            let own = at_points.get(first as usize..).unwrap_or_default();
            [own.iter().zip(weights).map(|(value, weight)| Some((*value)? * weight)).sum(); 3]
        }));
    }
}

/// Subdivision of an element type for display.
struct CellPattern {
    /// Values of the shape functions at its points.
    points: Vec<Vec<f64>>,
    /// Triangles, as indices of points, with the weights of the quadrature points' values at the centre of each.
    triangles: Vec<([u32; 3], Vec<f64>)>,
    /// Points along each side.
    sides: Vec<Vec<u32>>,
    /// Triangle adjacent to every segment of each side.
    triangles_of_lines: Vec<Vec<u32>>,
}

impl CellPattern {
    fn new(entry: &ElementType) -> Self {
        let lattice = (entry.cell.lattice)(entry.drawn_pieces);
        let place = |p: u32| Vector2::from(lattice.points[p as usize]);
        let middle = |corners: &[u32; 3]| corners.iter().map(|&p| place(p)).sum::<Vector2<f64>>() / 3.0;
        let triangles = lattice.triangles.iter().map(|t| (*t, (entry.point_weights)(middle(t).into())));
        let triangle_at = |piece: &[u32]| {
            let found = lattice.triangles.iter().position(|t| piece.iter().all(|p| t.contains(p)));
            found.unwrap_or_default() as u32
        };
        let triangles_of_lines = lattice.sides.iter().map(|side| side.windows(2).map(triangle_at).collect()).collect();
        Self {
            points: lattice.points.iter().map(|&at| (entry.shape)(at)).collect(),
            triangles: triangles.collect(),
            sides: lattice.sides.clone(),
            triangles_of_lines,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::scene::ElementKind;

    #[test]
    fn drawn_triangles_cover_the_body_once() {
        for element in ElementKind::all() {
            let scene = Scene::beam(3.0, 2.0).with_cells(3, 2).with_element(element);
            let mesh = Mesh::beam(scene.beam.as_ref().unwrap()).unwrap();
            let drawing = DisplayGeometry::new(&mesh);
            let mut points = Vec::new();
            drawing.points(&|n| mesh.nodes()[n as usize], &mut points);
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
            assert_eq!(drawing.lines.len(), drawing.triangles_of_lines.len());
            let touches =
                |(line, &t): (&[u32; 2], &u32)| line.iter().all(|p| drawing.triangles[t as usize].contains(p));
            assert!(
                drawing.lines.iter().zip(&drawing.triangles_of_lines).all(touches),
                "{element:?}: a triangle elsewhere"
            );
            // For a field that is linear within elements, the mean over the drawn triangles is exact.
            let entry = element.entry();
            let field = |nodes: &[u32], at: [f64; 2]| -> f64 {
                let places = nodes.iter().map(|&n| mesh.nodes()[n as usize]);
                places.zip((entry.shape)(at)).map(|(x, n)| (x.x + 2.0 * x.y) * n).sum()
            };
            let all = mesh.elements().flat_map(|nodes| entry.points.iter().map(move |point| (nodes, point.at)));
            let at_points: Vec<Option<f64>> = all.map(|(nodes, at)| Some(field(nodes, at))).collect();
            let count = at_points.len();
            let mut values = Vec::new();
            drawing.values(&at_points, &mut values);
            let mean = |v: &[Option<f64>]| v.iter().flatten().sum::<f64>() / v.len() as f64;
            assert!((mean(values.as_flattened()) - mean(&at_points)).abs() < 1e-12, "{element:?}");
            drawing.values(&vec![Some(5.0); count], &mut values);
            assert!(values.as_flattened().iter().flatten().all(|v| (v - 5.0).abs() < 1e-12), "{element:?}");
            drawing.values(&vec![None; count], &mut values);
            assert!(values.as_flattened().iter().all(Option::is_none), "{element:?}");
            // Nodal values are interpolated exactly, and an angle takes the shorter way around.
            let at_nodes: Vec<Option<f64>> = mesh.nodes().iter().map(|x| Some(x.x + 2.0 * x.y)).collect();
            drawing.nodal_values(&at_nodes, None, &mut values);
            for (corners, values) in drawing.triangles.iter().zip(&values) {
                for (&p, value) in corners.iter().zip(values) {
                    let x = points[p as usize];
                    assert!((value.unwrap() - x.x - 2.0 * x.y).abs() < 1e-12, "{element:?}");
                }
            }
            let angles: Vec<Option<f64>> =
                (0..mesh.nodes().len()).map(|n| Some(if n % 2 == 0 { 179.0 } else { -179.0 })).collect();
            drawing.nodal_values(&angles, Some(360.0), &mut values);
            assert!(values.as_flattened().iter().flatten().all(|v| v.abs() > 178.0), "{element:?}");
        }
    }
}
