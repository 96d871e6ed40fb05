//! Seams of a mesh: places where elements meet without sharing nodes, so that the body is cut there. A mesh may mean such
//! a crack; more often the parts of a drawing were not joined.

use nalgebra::Vector2;

use super::{Mesh, Segment, unique};
use crate::format::{number, six_digits};
use crate::sentence::{Sentence, sentence};

/// Distance between coincident nodes, relative to the size of the body: files may have six digits.
const COINCIDENT: f64 = 1e-6;
/// Upper bound of this distance, relative to the shortest side.
const OF_SHORTEST: f64 = 1e-3;
/// Distance of a hanging node from its side, relative to the length of the side.
const HANGING: f64 = 1e-4;

impl Mesh {
    /// Returns sentences about coincident nodes and about nodes inside of sides of other elements, each kind with its
    /// number, its first place and the remedy. Takes O(n log n) time for an outline of n sides.
    pub(crate) fn seams(&self) -> Vec<Sentence> {
        let outline = self.outline();
        let (low, high) = self.bounds();
        let length = |side: &Segment| side.ends().map(|n| self.node(n));
        let lengths = outline.iter().map(length).map(|[a, b]| (b - a).norm());
        let near = lengths.fold(COINCIDENT * (high - low).norm(), |near, length| near.min(OF_SHORTEST * length));
        // Along an oblique axis few nodes have about the same place.
        let along = |x: Vector2<f64>| 1f64.cos() * x.x + 1f64.sin() * x.y;
        let nodes = unique(outline.iter().flat_map(Segment::nodes).copied());
        let mut nodes: Vec<(f64, u32)> = nodes.into_iter().map(|n| (along(self.node(n)), n)).collect();
        nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The nodes between two places along the axis.
        let between = |low: f64, high: f64| {
            let start = nodes.partition_point(|(s, _)| *s < low);
            nodes.iter().skip(start).take_while(move |(s, _)| *s <= high).map(|(_, n)| *n)
        };
        let is_double = |node: u32| {
            let (x, s) = (self.node(node), along(self.node(node)));
            between(s - near, s + near).any(|other| other < node && (self.node(other) - x).norm() <= near)
        };
        let doubles = nodes.iter().map(|(_, n)| *n).filter(|n| is_double(*n));
        let hanging = outline.iter().flat_map(|side| {
            let [a, b] = side.ends().map(|n| along(self.node(n)));
            let margin = HANGING.sqrt() * (self.node(side.ends()[1]) - self.node(side.ends()[0])).norm();
            between(a.min(b) - margin, a.max(b) + margin).filter(|n| self.hangs_on(side, *n, near)).collect::<Vec<_>>()
        });
        let doubles = self.first_of(doubles).map(|[n, x, y]| {
            sentence!(
                "nodes that lie on others without being joined to them: %{n}, the first at (%{x}, %{y}) m; the body is cut there, and `Coherence Mesh` in Gmsh joins them",
                n,
                x,
                y
            )
        });
        let hanging = self.first_of(hanging).map(|[n, x, y]| {
            sentence!(
                "nodes inside of sides of elements that do not have them: %{n}, the first at (%{x}, %{y}) m; the body is cut there, and `Coherence` in Gmsh before meshing joins its surfaces",
                n,
                x,
                y
            )
        });
        doubles.into_iter().chain(hanging).collect()
    }

    /// Returns `true` if a node lies inside of a side that does not have it, and at none of its nodes.
    fn hangs_on(&self, side: &Segment, node: u32, near: f64) -> bool {
        let (own, x) = (side.nodes(), self.node(node));
        if own.iter().any(|&n| (self.node(n) - x).norm() <= near) {
            return false;
        }
        let [a, b] = side.ends().map(|n| self.node(n));
        let t = (x - a).dot(&(b - a)) / (b - a).norm_squared();
        // The parabola through a node in the middle; else this is the chord.
        let middle = if let &[_, middle, _] = own { self.node(middle) } else { (a + b) * 0.5 };
        let foot = a * ((1.0 - t) * (1.0 - 2.0 * t)) + middle * (4.0 * t * (1.0 - t)) + b * (t * (2.0 * t - 1.0));
        (0.0..=1.0).contains(&t) && (foot - x).norm() <= HANGING * (b - a).norm()
    }

    /// Returns the count of nodes, and the place of the one with the smallest number.
    fn first_of(&self, nodes: impl Iterator<Item = u32>) -> Option<[String; 3]> {
        let nodes = unique(nodes);
        let first = self.node(*nodes.first()?);
        Some([nodes.len().to_string(), number(six_digits(first.x)), number(six_digits(first.y))])
    }
}
