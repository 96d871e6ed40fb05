//! Which element holds a point, and where in it.

use nalgebra::Vector2;

use super::Mesh;

/// A point of the body, whatever the body does: an element and a place in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPoint {
    /// The element.
    pub element: usize,
    /// Reference coordinates in it.
    pub at: [f64; 2],
}

/// Points on the boundary must not fall out by rounding.
const SLACK: f64 = 1e-9;

impl Mesh {
    /// The material point at a rest position, m; `None` outside the body.
    #[must_use]
    pub fn locate(&self, at: Vector2<f64>) -> Option<MaterialPoint> {
        self.elements().enumerate().find_map(|(element, nodes)| {
            let place = self.invert(nodes, &self.nodes, at)?;
            ((self.entry().cell.depth)(place) >= -SLACK).then_some(MaterialPoint { element, at: place })
        })
    }

    /// The nodes of a material point's element with their shape functions there; the weights sum to 1. `None` where
    /// there is no such element.
    #[must_use]
    pub fn weights(&self, point: MaterialPoint) -> Option<Vec<(u32, f64)>> {
        let nodes = self.elements().nth(point.element)?;
        Some(nodes.iter().copied().zip((self.entry().shape)(point.at)).collect())
    }

    /// Reference coordinates of a position in an element whose nodes are at `positions`; `None` where its map cannot be
    /// inverted.
    fn invert(&self, nodes: &[u32], positions: &[Vector2<f64>], at: Vector2<f64>) -> Option<[f64; 2]> {
        // Newton's method: straight-sided elements take one step.
        const STEPS: u32 = 12;
        let entry = self.entry();
        let corners = entry.cell.corners;
        let mut place: Vector2<f64> =
            corners.iter().map(|&c| Vector2::from(c)).sum::<Vector2<f64>>() / corners.len() as f64;
        for _ in 0..STEPS {
            let own: Vec<Vector2<f64>> = nodes.iter().map(|&n| positions[n as usize]).collect();
            let mut missing = at;
            for (x, n) in own.iter().zip((entry.shape)(place.into())) {
                missing -= x * n;
            }
            let step = entry.jacobian(&own, place.into()).try_inverse()? * missing;
            place += step;
            if step.norm() < 1e-14 {
                break;
            }
        }
        Some(place.into())
    }
}
