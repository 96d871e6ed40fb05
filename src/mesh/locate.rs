//! Search for the element that contains a point.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::{Mesh, Segment, outer};
use crate::element::{integrate_side, lagrange, side_weights};

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
    pub fn locate(&self, at: Vector2<f64>) -> Option<MaterialPoint> {
        self.locate_in(&self.nodes, at)
    }

    /// Returns the material point at a position, m, with the nodes at `positions`; `None` outside the body, and if the
    /// number of positions differs from the number of nodes.
    ///
    /// Tests the bounding boxes of all elements. For a moving body a search index would have to be rebuilt in every
    /// state, which costs more.
    pub fn locate_in(&self, positions: &[Vector2<f64>], at: Vector2<f64>) -> Option<MaterialPoint> {
        if positions.len() != self.nodes.len() {
            return None;
        }
        self.locate_among(self.elements().enumerate(), positions, at)
    }

    fn locate_among<'a>(
        &self,
        elements: impl Iterator<Item = (usize, &'a [u32])>,
        positions: &[Vector2<f64>],
        at: Vector2<f64>,
    ) -> Option<MaterialPoint> {
        elements.filter(|(_, nodes)| is_in_box(nodes, positions, at, 0.0)).find_map(|(element, nodes)| {
            let place = self.invert(nodes, positions, at)?;
            ((self.entry().cell.depth)(place) >= -SLACK).then_some(MaterialPoint { element, at: place })
        })
    }

    /// Returns `true` if an element may have points of [`Self::points_over`].
    pub(crate) fn is_near(&self, element: usize, at: Vector2<f64>, length: f64) -> bool {
        self.elements().nth(element).is_some_and(|nodes| is_in_box(nodes, &self.nodes, at, 0.5 * length))
    }

    /// Returns the points of a length, m, of the body's outline around a rest position, or of the horizontal line through
    /// an inner one, each with its share of the part that lies in the body; the shares sum to 1. A length of 0 is the
    /// point. `None` outside the body.
    pub(crate) fn points_over(&self, at: Vector2<f64>, length: f64) -> Option<Vec<(MaterialPoint, f64)>> {
        /// Least number of parts of the length: a cut through it divides its load in small steps.
        const PARTS: f64 = 8.0;
        let middle = self.locate(at)?;
        if length <= 0.0 {
            return Some(vec![(middle, 1.0)]);
        }
        let near: Vec<(usize, &[u32])> =
            self.elements().enumerate().filter(|(_, nodes)| is_in_box(nodes, &self.nodes, at, 0.5 * length)).collect();
        let sides: Vec<Segment> = near.iter().flat_map(|(_, nodes)| self.sides(nodes)).collect();
        let pieces = self.pieces_of_outline(outer(sides.clone()), at, length);
        let pieces = pieces.unwrap_or_else(|| self.pieces_of_line(&sides, at, length));
        let mut points = Vec::new();
        for (nodes, [from, to]) in pieces {
            let parts = (PARTS * 0.5 * (to - from) * side_weights(&nodes).iter().sum::<f64>() / length).ceil().max(1.0);
            for part in 0..parts as u32 {
                let ends = [0, 1].map(|i| from + (to - from) * f64::from(part + i) / parts);
                integrate_side(&nodes, ends, |shape, length| {
                    let x = nodes.iter().zip(shape).map(|(x, n)| x * *n).sum();
                    let point = self.locate_among(near.iter().copied(), &self.nodes, x);
                    points.extend(point.map(|point| (point, length)));
                });
            }
        }
        let total: f64 = points.iter().map(|(_, length)| length).sum();
        points.iter_mut().for_each(|(_, length)| *length /= total);
        Some(if points.is_empty() { vec![(middle, 1.0)] } else { points })
    }

    /// Returns the parts of a length, m, of an outline around a point of it: nodes of sides with the range of their
    /// parameter, −1 to 1. The outline ends at corners. `None` for a point that does not lie on it.
    fn pieces_of_outline(&self, outline: Vec<Segment>, at: Vector2<f64>, length: f64) -> Option<Vec<LinePart>> {
        /// Distance from a side, relative to its length, that counts as on it.
        const ON: f64 = 1e-3;
        /// Cosine of the largest angle between two sides of one smooth line, 30°.
        const SMOOTH: f64 = 0.866;
        let rest = |side: &Segment| -> Vec<Vector2<f64>> { side.nodes().iter().map(|&n| self.node(n)).collect() };
        let chord = |side: &Segment| self.node(side.ends()[1]) - self.node(side.ends()[0]);
        let parameter = |side: &Segment| {
            let (nodes, chord) = (rest(side), chord(side));
            let xi = 2.0 * (at - nodes[0]).dot(&chord) / chord.norm_squared() - 1.0;
            let foot: Vector2<f64> = nodes.iter().zip(lagrange(nodes.len(), xi)).map(|(x, (n, _))| x * n).sum();
            let is_on = xi.abs() <= 1.0 + ON && chord.perp(&(at - foot)).abs() <= ON * chord.norm_squared();
            is_on.then_some(xi.clamp(-1.0, 1.0))
        };
        let found = outline.iter().filter_map(|side| Some((side, parameter(side)?)));
        // At a corner the side that is closer to horizontal.
        let slope = |side: &Segment| (chord(side).y / chord(side).norm()).abs();
        let (first, xi) = found.min_by(|(a, _), (b, _)| slope(a).total_cmp(&slope(b)))?;
        let mut pieces = Vec::new();
        for (end, limit) in [(0, -1.0), (1, 1.0_f64)] {
            let (mut side, mut start, mut left) = (*first, xi, 0.5 * length);
            loop {
                let nodes = rest(&side);
                let whole: f64 = side_weights(&nodes).iter().sum();
                let stop = start + limit * (2.0 * left / whole).min((limit - start).abs());
                pieces.push((nodes, [start.min(stop), start.max(stop)]));
                left -= 0.5 * whole * (stop - start).abs();
                let goes_on = |next: &&Segment| {
                    next.ends()[1 - end] == side.ends()[end]
                        && chord(next).dot(&chord(&side)) > SMOOTH * chord(next).norm() * chord(&side).norm()
                };
                match outline.iter().find(goes_on).filter(|next| left > SLACK * length && *next != first) {
                    Some(next) => (side, start) = (*next, -limit),
                    None => break,
                }
            }
        }
        Some(pieces)
    }

    /// Returns the parts of a length, m, of the horizontal line around a point, between the sides that cross it.
    fn pieces_of_line(&self, sides: &[Segment], at: Vector2<f64>, length: f64) -> Vec<LinePart> {
        let [low, high] = [at.x - 0.5 * length, at.x + 0.5 * length];
        let crossings = sides.iter().filter_map(|side| {
            let [p, q] = side.ends().map(|node| self.node(node));
            let crosses = p.y != q.y && (p.y - at.y) * (q.y - at.y) <= 0.0;
            crosses.then(|| p.x + (q.x - p.x) * (at.y - p.y) / (q.y - p.y)).filter(|x| (low..=high).contains(x))
        });
        let mut ends: Vec<f64> = crossings.chain([low, high]).collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|a, b| *a - *b <= SLACK * length);
        let piece = |pair: &[f64]| (pair.iter().map(|&x| Vector2::new(x, at.y)).collect(), [-1.0, 1.0]);
        ends.windows(2).map(piece).collect()
    }

    /// Returns the material point nearest to a position, m, within the distance `within`, m, with the nodes at
    /// `positions`; `outline` is [`Self::outline`].
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
    pub fn weights(&self, point: MaterialPoint) -> Option<Vec<(u32, f64)>> {
        let nodes = self.elements().nth(point.element)?;
        Some(nodes.iter().copied().zip((self.entry().shape)(point.at)).collect())
    }

    /// Returns the nodes of the element at a rest position, m, as [`Self::weights`] does; `None` outside the body.
    pub(crate) fn weights_at(&self, at: Vector2<f64>) -> Option<Vec<(u32, f64)>> {
        self.weights(self.locate(at)?)
    }

    /// Returns the nodes of [`Self::points_over`] with their mean weights.
    pub(crate) fn weights_over(&self, at: Vector2<f64>, length: f64) -> Option<Vec<(u32, f64)>> {
        let mut sum = BTreeMap::new();
        for (point, share) in self.points_over(at, length)? {
            self.weights(point)?.into_iter().for_each(|(node, n)| *sum.entry(node).or_default() += share * n);
        }
        Some(sum.into_iter().collect())
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

/// Nodes of a line with a range of its parameter, −1 to 1.
type LinePart = (Vec<Vector2<f64>>, [f64; 2]);

/// Returns `true` if a position is in the bounding box of an element's nodes, or nearer to it than `within`, m.
fn is_in_box(nodes: &[u32], positions: &[Vector2<f64>], at: Vector2<f64>, within: f64) -> bool {
    let mut own = nodes.iter().map(|&n| positions[n as usize]);
    let Some(first) = own.next() else { return false };
    let (low, high) = own.fold((first, first), |(low, high), x| (low.inf(&x), high.sup(&x)));
    let bulge = BULGE * (high - low).max() + within;
    at.x >= low.x - bulge && at.x <= high.x + bulge && at.y >= low.y - bulge && at.y <= high.y + bulge
}
