//! Search for the element that contains a point.

use nalgebra::Vector2;

use super::{Mesh, Segment};

/// Point that moves with the body: an element and a place in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPoint {
    /// Element number.
    pub element: usize,
    /// Reference coordinates (ξ, η) in the element: ξ ≥ 0, η ≥ 0, ξ + η ≤ 1 in a triangle, −1 to 1 each in a
    /// quadrilateral.
    pub at: [f64; 2],
}

/// Tolerance that keeps points on the boundary inside despite rounding.
const SLACK: f64 = 1e-9;

/// Distance by which curved sides may extend beyond the bounding box of their nodes, relative to its size.
const BULGE: f64 = 0.25;

impl Mesh {
    /// Returns the material point at a rest position, m; `None` outside the body.
    #[must_use]
    pub fn locate(&self, at: Vector2<f64>) -> Option<MaterialPoint> {
        self.locate_in(&self.nodes, at)
    }

    /// Returns the material point at a position, m, with the nodes at `positions`; `None` outside the body, and if the
    /// number of positions differs from the number of nodes.
    ///
    /// Tests the bounding boxes of all elements. For a moving body a search index would have to be rebuilt in every
    /// state, which costs more.
    #[must_use]
    pub fn locate_in(&self, positions: &[Vector2<f64>], at: Vector2<f64>) -> Option<MaterialPoint> {
        if positions.len() != self.nodes.len() {
            return None;
        }
        self.elements().enumerate().find_map(|(element, nodes)| {
            if !is_in_box(nodes, positions, at) {
                return None;
            }
            let place = self.invert(nodes, positions, at)?;
            ((self.entry().cell.depth)(place) >= -SLACK).then_some(MaterialPoint { element, at: place })
        })
    }

    /// Returns the material point nearest to a position, m, within the distance `within`, m, with the nodes at
    /// `positions`; `outline` is [`Self::outline`].
    #[must_use]
    pub fn pick(
        &self,
        positions: &[Vector2<f64>],
        outline: &[Segment],
        at: Vector2<f64>,
        within: f64,
    ) -> Option<MaterialPoint> {
        /// Offset of a boundary point towards the inside, relative to the length of its side.
        const INSIDE: f64 = 1e-3;
        if let Some(point) = self.locate_in(positions, at) {
            return Some(point);
        }
        let sides = outline.iter().filter_map(|side| {
            let [p, q] = side.ends().map(|n| positions.get(n as usize));
            let (p, side) = (p?, q? - p?);
            let t = ((at - p).dot(&side) / side.norm_squared()).clamp(INSIDE, 1.0 - INSIDE);
            // The outline runs counter-clockwise: inside is on its left.
            let inside = Vector2::new(-side.y, side.x) * INSIDE;
            Some((p + side * t, inside))
        });
        let nearest = sides.min_by(|(a, _), (b, _)| (a - at).norm().total_cmp(&(b - at).norm()));
        let (foot, inside) = nearest.filter(|(foot, _)| (foot - at).norm() <= within)?;
        self.locate_in(positions, foot + inside)
    }

    /// Returns the nodes of a material point's element with their shape functions there; the weights sum to 1. `None`
    /// if there is no such element.
    #[must_use]
    pub fn weights(&self, point: MaterialPoint) -> Option<Vec<(u32, f64)>> {
        let nodes = self.elements().nth(point.element)?;
        Some(nodes.iter().copied().zip((self.entry().shape)(point.at)).collect())
    }

    /// Returns the nodes of the element at a rest position, m, as [`Self::weights`] does; `None` outside the body.
    pub(crate) fn weights_at(&self, at: Vector2<f64>) -> Option<Vec<(u32, f64)>> {
        self.weights(self.locate(at)?)
    }

    /// Returns the reference coordinates of a rest position, m, in an element; `None` if there are none.
    pub(crate) fn place_in(&self, element: usize, at: Vector2<f64>) -> Option<[f64; 2]> {
        self.invert(self.elements().nth(element)?, &self.nodes, at)
    }

    /// Returns the reference coordinates of a position in an element whose nodes are at `positions`; `None` if the map
    /// cannot be inverted.
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

/// Returns `true` if a position is in or near the bounding box of an element's nodes.
fn is_in_box(nodes: &[u32], positions: &[Vector2<f64>], at: Vector2<f64>) -> bool {
    let mut own = nodes.iter().map(|&n| positions[n as usize]);
    let Some(first) = own.next() else { return false };
    let (low, high) = own.fold((first, first), |(low, high), x| (low.inf(&x), high.sup(&x)));
    let bulge = BULGE * (high - low).max();
    at.x >= low.x - bulge && at.x <= high.x + bulge && at.y >= low.y - bulge && at.y <= high.y + bulge
}
