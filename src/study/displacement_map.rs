//! Displacement of a reference solution at every point of the body.

use nalgebra::{Matrix2, Vector2};

use crate::mesh::Mesh;
use crate::simulation::Simulation;

/// Displacement that is linear over triangles.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct DisplacementMap {
    /// Rest positions of the corners, m.
    rest: Vec<Vector2<f64>>,
    /// Displacements of the corners, m.
    displacements: Vec<Vector2<f64>>,
    /// Corners of every triangle.
    triangles: Vec<[u32; 3]>,
}

impl DisplacementMap {
    /// Returns the displacement of a simulation, from node to node.
    pub(crate) fn of(simulation: &Simulation) -> Self {
        let mesh = simulation.system().mesh();
        let triangles = mesh.elements().flat_map(|nodes| triangles(mesh, nodes)).collect();
        Self { rest: mesh.nodes().to_vec(), displacements: simulation.displacement().to_vec(), triangles }
    }

    /// Returns the displacement of an exact beam, whose sections stay plane, from its outlines at rest and now, m, as of
    /// [`ExactBeam::outline`](crate::exact_beam::ExactBeam::outline).
    pub(crate) fn of_beam([rest, moved]: [&[Vector2<f64>]; 2]) -> Self {
        let displacements = rest.iter().zip(moved).map(|(x, now)| now - x).collect();
        // The outline runs along the lower side, back along the upper side, and ends where it begins.
        let stations = (rest.len().saturating_sub(1) / 2) as u32;
        let quads = (1..stations).map(|i| [i - 1, i, 2 * stations - 1 - i, 2 * stations - i]);
        let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self { rest: rest.to_vec(), displacements, triangles }
    }

    /// Returns the displacement at every point, m; `None` outside the body. Points that are outside by a little, as on a
    /// curved side, have the displacement of the nearest triangle, continued.
    pub(crate) fn at(&self, points: &[Vector2<f64>]) -> Vec<Option<Vector2<f64>>> {
        /// Largest distance outside a triangle, relative to its height.
        const OUTSIDE: f64 = 0.5;
        let bounds = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
            let infinity = Vector2::repeat(f64::INFINITY);
            points.fold([infinity, -infinity], |[low, high], x| [low.inf(x), high.sup(x)])
        };
        let [low, high] = bounds(&mut self.rest.iter());
        // A point is compared with the triangles whose bounding boxes meet its cell of a grid. Cells are about as many as
        // triangles, and about square.
        let size = (high - low).map(|v| if v > 0.0 { v } else { 1.0 });
        let side = (size.x * size.y / self.triangles.len().max(1) as f64).sqrt();
        let [columns, rows] = [size.x, size.y].map(|v| (v / side).ceil().clamp(1.0, 2000.0) as usize);
        let cell = Vector2::new(size.x / columns as f64, size.y / rows as f64);
        // Column and row of the cell at a point, or of the nearest one; `None` if the point is not finite.
        let place = |at: &Vector2<f64>| {
            let place = (at - low).component_div(&cell);
            let one = |v: f64, count: usize| v.is_finite().then(|| (v.max(0.0) as usize).min(count - 1));
            Some([one(place.x, columns)?, one(place.y, rows)?])
        };
        let mut candidates: Vec<Vec<&[u32; 3]>> = vec![Vec::new(); columns * rows];
        for triangle in &self.triangles {
            let [first, last] = bounds(&mut triangle.iter().filter_map(|&corner| self.rest.get(corner as usize)));
            // A point outside the body finds the triangles of the neighbouring cell.
            let (Some(first), Some(last)) = (place(&(first - cell * 0.5)), place(&(last + cell * 0.5))) else {
                continue;
            };
            for row in first[1]..=last[1] {
                let cells = row * columns + first[0]..=row * columns + last[0];
                candidates[cells].iter_mut().for_each(|own| own.push(triangle));
            }
        }
        let value = |at: &Vector2<f64>| {
            let [column, row] = place(at)?;
            let inside = candidates[row * columns + column].iter().filter_map(|&triangle| {
                let weights = self.weights(triangle, at)?;
                Some((weights.into_iter().fold(f64::INFINITY, f64::min), triangle, weights))
            });
            let (depth, triangle, weights) = inside.max_by(|(a, ..), (b, ..)| a.total_cmp(b))?;
            let corners = triangle.iter().map(|&corner| self.displacements.get(corner as usize));
            let sum = corners.zip(weights).map(|(u, weight)| Some(u? * weight)).sum::<Option<Vector2<f64>>>();
            sum.filter(|_| depth >= -OUTSIDE)
        };
        points.iter().map(value).collect()
    }

    /// Returns the barycentric coordinates of a point in a triangle; `None` for a triangle without area.
    fn weights(&self, triangle: &[u32; 3], at: &Vector2<f64>) -> Option<[f64; 3]> {
        let [a, b, c] = triangle.map(|corner| self.rest.get(corner as usize));
        let (a, b, c) = (a?, b?, c?);
        let part = Matrix2::from_columns(&[b - a, c - a]).try_inverse()? * (at - a);
        Some([1.0 - part.x - part.y, part.x, part.y])
    }
}

/// Divides an element into triangles between its nodes.
fn triangles(mesh: &Mesh, nodes: &[u32]) -> Vec<[u32; 3]> {
    let around = mesh.sides(nodes).flat_map(|side| {
        // The last node of a side is the first of the next.
        let (_, own) = side.nodes().split_last().unwrap_or((&0, &[]));
        own.to_vec()
    });
    match around.collect::<Vec<u32>>()[..] {
        [a, b, c] => vec![[a, b, c]],
        [a, b, c, d] => vec![[a, b, c], [a, c, d]],
        [a, ab, b, bc, c, ca] => vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact_beam::ExactBeam;
    use crate::scene::{ElementKind, Scene};

    /// The map has the displacement of every node, also on a curved outline, of the nodes of another mesh of the same
    /// body, and none far outside; that of an exact beam has the displacement of its tip.
    #[test]
    fn the_map_has_the_displacement_of_every_point() {
        let scene = |element, cells: [u32; 2]| {
            let scene = Scene::beam(10.0, 1.0).with_cells(cells[0], cells[1]).with_element(element).clamp("left");
            let mut scene = scene.force("right", [0.0, -3e3]).probe("tip", "right");
            scene.beam.as_mut().unwrap().rise = 0.4;
            scene
        };
        for element in [ElementKind::T3, ElementKind::T6, ElementKind::Q4] {
            let solved = |scene: &Scene| {
                let mut simulation = Simulation::new(scene).unwrap();
                simulation.solve();
                simulation
            };
            let (fine, coarse) = (solved(&scene(element, [40, 4])), solved(&scene(element, [7, 1])));
            let map = DisplacementMap::of(&fine);
            let largest = fine.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
            for (own, u) in map.at(fine.mesh().nodes()).into_iter().zip(fine.displacement()) {
                assert!((own.unwrap() - u).norm() < 1e-9 * largest, "{element:?}");
            }
            assert!(map.at(coarse.mesh().nodes()).iter().all(Option::is_some), "{element:?}");
            assert_eq!(map.at(&[Vector2::new(20.0, 5.0), Vector2::repeat(f64::NAN)]), [None, None]);
        }
        let straight = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -3e3]).probe("tip", "right");
        let beam = ExactBeam::of(&straight).unwrap();
        let [rest, moved] = beam.outline(1.0).unwrap();
        let map = DisplacementMap::of_beam([&rest, &moved]);
        let tip = map.at(&[Vector2::new(10.0, 0.0)])[0].unwrap();
        let exact = beam.tip_displacement().unwrap();
        assert!((tip - exact).norm() < 1e-6 * exact.norm(), "{tip} {exact}");
    }
}
