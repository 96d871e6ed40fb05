//! Displacement of a reference solution at every point of the body.

use nalgebra::Matrix2;

use super::prelude::*;

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
        // A triangle is compared with the points around it, which are found by x.
        let mut by_x: Vec<(usize, &Vector2<f64>)> = points.iter().enumerate().collect();
        by_x.sort_by(|(_, a), (_, b)| a.x.total_cmp(&b.x));
        let mut found = vec![(-OUTSIDE, None); points.len()];
        for triangle in &self.triangles {
            let corner = |corner: u32| (self.rest[corner as usize], self.displacements[corner as usize]);
            let [(a, u), (b, v), (c, w)] = triangle.map(corner);
            // Barycentric coordinates; a triangle without area has none.
            let Some(inverse) = Matrix2::from_columns(&[b - a, c - a]).try_inverse() else { continue };
            // Points at the largest distance are as far away as the triangle is large.
            let [low, high] = [a.inf(&b).inf(&c), a.sup(&b).sup(&c)];
            let [low, high] = [low * 2.0 - high, high * 2.0 - low];
            let first = by_x.partition_point(|(_, at)| at.x < low.x);
            let around = by_x[first..].iter().take_while(|(_, at)| at.x <= high.x);
            for &(point, at) in around.filter(|(_, at)| (low.y..=high.y).contains(&at.y)) {
                let part = inverse * (at - a);
                let weights = [1.0 - part.x - part.y, part.x, part.y];
                let depth = weights.into_iter().fold(f64::INFINITY, f64::min);
                if depth.total_cmp(&found[point].0).is_ge() {
                    found[point] =
                        (depth, Some([u, v, w].into_iter().zip(weights).map(|(u, weight)| u * weight).sum()));
                }
            }
        }
        found.into_iter().map(|(_, u)| u).collect()
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
