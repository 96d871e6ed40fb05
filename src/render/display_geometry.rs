//! Display geometry of a mesh: points, triangles and lines for all element types; curved sides become polylines.

use std::collections::HashSet;

use nalgebra::Vector2;

use crate::element::ElementType;
use crate::mesh::{Mesh, Segment};
use crate::render::interpolated_field::{Components, InterpolatedField, weighted_sum};
use crate::simulation::PointValues;

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
    /// Weights of an element's quadrature points at each of its points.
    point_weights: Vec<Vec<f64>>,
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
        /// Largest number of elements whose curved sides and fields are drawn in several pieces: those of more elements
        /// are too small to be seen, and fill hundreds of megabytes of the adapter.
        const MAX_CURVED: usize = 25_000;
        let entry = mesh.element().entry();
        let pieces = if mesh.element_count() > MAX_CURVED { 1 } else { entry.drawn_pieces };
        let stride = entry.nodes.len();
        let pattern = CellPattern::new(entry, pieces);
        let point_weights = pattern.point_weights.clone();
        let mut drawing = Self { stride, pieces, point_weights, boundary: mesh.outline(), ..Self::default() };
        let boundary: HashSet<_> = drawing.boundary.iter().map(Segment::key).collect();
        let mut drawn = HashSet::new();
        // Boundary sides, each with its points.
        let mut around = Vec::new();
        for nodes in mesh.elements() {
            let first_triangle = drawing.triangles.len() as u32;
            let first = drawing.add(&pattern, nodes);
            for ((side, points), triangles_of_lines) in
                mesh.sides(nodes).zip(&pattern.sides).zip(&pattern.triangles_of_lines)
            {
                let points: Vec<u32> = points.iter().map(|p| first + p).collect();
                if drawn.insert(side.key()) {
                    drawing.lines.extend(points.windows(2).map(|w| [w[0], w[1]]));
                    drawing.triangles_of_lines.extend(triangles_of_lines.iter().map(|t| first_triangle + t));
                }
                if boundary.contains(&side.key()) {
                    around.push((side.ends(), points));
                }
            }
        }
        drawing.outline = Mesh::closed_lines(around).into_iter().map(|line| line.concat()).collect();
        drawing
    }

    /// Adds an element; returns the index of its first point.
    fn add(&mut self, pattern: &CellPattern, nodes: &[u32]) -> u32 {
        let first = (self.nodes.len() / self.stride) as u32;
        for weights in &pattern.points {
            self.nodes.extend(nodes);
            self.weights.extend(weights);
        }
        self.triangles.extend(pattern.triangles.iter().map(|corners| corners.map(|p| first + p)));
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

    /// Computes the components of a field at every point; `None` where they are not finite.
    pub(crate) fn components(&self, field: &InterpolatedField, at_points: &mut Vec<Option<Components>>) {
        at_points.clear();
        let components = &field.components;
        match field.values {
            PointValues::Recovered => {
                let own = self.nodes.chunks(self.stride.max(1)).zip(self.weights.chunks(self.stride.max(1)));
                at_points.extend(own.map(|(nodes, weights)| {
                    weighted_sum(nodes.iter().map(|&node| components.get(node as usize)).zip(weights))
                }));
            }
            PointValues::Raw => {
                let count = self.point_weights.first().map_or(1, Vec::len);
                for own in components.chunks(count) {
                    let of_point = |weights: &Vec<f64>| weighted_sum(own.iter().map(Some).zip(weights));
                    at_points.extend(self.point_weights.iter().map(of_point));
                }
            }
        }
    }
}

/// Subdivision of an element type for display.
struct CellPattern {
    /// Values of the shape functions at its points.
    points: Vec<Vec<f64>>,
    /// Weights of the quadrature points at each of its points.
    point_weights: Vec<Vec<f64>>,
    /// Triangles, as indices of points.
    triangles: Vec<[u32; 3]>,
    /// Points along each side.
    sides: Vec<Vec<u32>>,
    /// Triangle adjacent to every segment of each side.
    triangles_of_lines: Vec<Vec<u32>>,
}

impl CellPattern {
    fn new(entry: &ElementType, pieces: u32) -> Self {
        let lattice = (entry.cell.lattice)(pieces);
        let triangle_at = |piece: &[u32]| {
            let found = lattice.triangles.iter().position(|t| piece.iter().all(|p| t.contains(p)));
            found.unwrap_or_default() as u32
        };
        let triangles_of_lines = lattice.sides.iter().map(|side| side.windows(2).map(triangle_at).collect()).collect();
        Self {
            points: lattice.points.iter().map(|&at| (entry.shape)(at)).collect(),
            point_weights: lattice.points.iter().map(|&at| (entry.point_weights)(at)).collect(),
            triangles: lattice.triangles.clone(),
            sides: lattice.sides.clone(),
            triangles_of_lines,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::mesh::MaterialPoint;
    use crate::scene::ElementKind;
    use crate::simulation::{Field, Simulation};

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
            assert_eq!(drawing.lines.len(), drawing.triangles_of_lines.len());
            let touches =
                |(line, &t): (&[u32; 2], &u32)| line.iter().all(|p| drawing.triangles[t as usize].contains(p));
            assert!(
                drawing.lines.iter().zip(&drawing.triangles_of_lines).all(touches),
                "{element:?}: a triangle elsewhere"
            );
        }
    }

    /// Elements of a large mesh are drawn in one piece each.
    #[test]
    fn elements_of_large_meshes_are_drawn_whole() {
        let scene = Scene::beam(20.0, 13.0).with_cells(200, 130).with_element(ElementKind::Q4);
        let mesh = Mesh::beam(scene.beam.as_ref().unwrap()).unwrap();
        assert_eq!(DisplayGeometry::new(&mesh).triangles.len(), 2 * mesh.element_count());
    }

    /// The components at the drawn points are those from which the value at these points is computed.
    #[test]
    fn drawn_components_have_the_value_of_their_point() {
        for element in ElementKind::all() {
            let scene = Scene::beam(3.0, 1.0).with_cells(3, 2).with_element(element);
            let scene = scene.clamp("left").force("right", [2e4, -3e4]);
            let mut simulation = Simulation::new(&scene).unwrap();
            simulation.solve();
            let mesh = simulation.mesh();
            let (geometry, mut drawn) = (DisplayGeometry::new(mesh), Vec::new());
            let entry = mesh.entry();
            let lattice = (entry.cell.lattice)(entry.drawn_pieces);
            for field in Field::ALL.into_iter().filter(|field| *field != Field::ReferenceDistance) {
                for values in [PointValues::Recovered, PointValues::Raw] {
                    let interpolated = InterpolatedField::new(&simulation, field, values);
                    geometry.components(&interpolated, &mut drawn);
                    assert_eq!(drawn.len(), mesh.element_count() * lattice.points.len());
                    let largest = interpolated.largest(mesh);
                    assert!(largest > 0.0);
                    let points = (0..mesh.element_count())
                        .flat_map(|element| lattice.points.iter().map(move |&at| MaterialPoint { element, at }));
                    for (point, components) in points.zip(&drawn) {
                        let components = components.unwrap();
                        let drawn = interpolated.value(components).unwrap();
                        let own = interpolated.at(mesh, point).unwrap();
                        let about = format!("{element:?} {field:?} {values:?}: {drawn} is not {own}");
                        assert!((drawn - own).abs() <= 1e-9 * largest, "{about}");
                        // Quadratic shape functions exceed the values at the nodes.
                        assert!(own.abs() < 1.05 * largest, "{about}, largest {largest}");
                        if let Some(state) = simulation.point_state(point, values).filter(|_| !field.is_of_elements()) {
                            assert!((state.field(field).unwrap() - own).abs() <= 1e-9 * largest, "{about}");
                        }
                    }
                }
            }
        }
    }
}
