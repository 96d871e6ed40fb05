//! Uniform refinement: every element is cut into four; curved sides keep their curve.

use std::collections::HashMap;

use nalgebra::Vector2;

use super::{Mesh, Segment, side_key};
use crate::element::ElementType;

/// Position of a child's node in its parent.
#[derive(Clone, Copy, Debug)]
enum ChildNode {
    /// On a node of the parent.
    Node(usize),
    /// On a side of the parent: side number and distance from its first corner, as a fraction of the side.
    Side(usize, f64),
    /// Inside.
    Interior,
}

impl ChildNode {
    fn of(entry: &ElementType, at: [f64; 2]) -> Self {
        const ON: f64 = 1e-9;
        if let Some(node) = entry.node_at(at) {
            return Self::Node(node);
        }
        let on_side = entry.sides.iter().position(|side| {
            let [a, b] = ends(entry, side);
            let (d, p) = (b - a, Vector2::from(at) - a);
            d.perp(&p).abs() < ON
        });
        on_side.map_or(Self::Interior, |side| {
            let [a, b] = ends(entry, entry.sides[side]);
            Self::Side(side, (b - a).dot(&(Vector2::from(at) - a)) / (b - a).norm_squared())
        })
    }
}

/// Returns the reference coordinates of a side's ends.
fn ends(entry: &ElementType, side: &[usize]) -> [Vector2<f64>; 2] {
    [side[0], side[side.len() - 1]].map(|n| Vector2::from(entry.nodes[n]))
}

/// New nodes on sides, by the side's ends and the distance from the end with the smaller number: the same for both
/// elements.
#[derive(Default)]
pub(super) struct OnSides(pub HashMap<([u32; 2], u32), u32>);

impl OnSides {
    pub fn key(ends: [u32; 2], t: f64) -> ([u32; 2], u32) {
        // Distances are multiples of a small power of ½.
        const UNITS: f64 = 1024.0;
        let key = side_key(ends);
        let t = if key == ends { t } else { 1.0 - t };
        (key, (t * UNITS).round() as u32)
    }

    fn get(&self, ends: [u32; 2], t: f64) -> Option<u32> {
        self.0.get(&Self::key(ends, t)).copied()
    }
}

impl Mesh {
    /// Interpolates a nodal vector to [`Self::refined`] by the shape functions.
    pub fn prolonged(&self, nodal: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        // Refinement interpolates any nodal vector in the same way as positions.
        Self { nodes: nodal.to_vec(), ..self.clone() }.refined().nodes
    }

    /// Returns the mesh with every element cut into four of the same type and every named edge into halves. The old
    /// nodes come first, with the same numbers; the body is the same.
    pub fn refined(&self) -> Self {
        let entry = self.entry();
        // Distinct positions of all children's nodes, and their indices for each child.
        let mut places: Vec<[f64; 2]> = Vec::new();
        let mut children: Vec<Vec<usize>> = Vec::new();
        for corners in entry.cell.children {
            let own = entry.nodes.iter().map(|&at| {
                let weights = (entry.cell.corner_weights)(at);
                let at = [0, 1].map(|axis| corners.iter().zip(&weights).map(|(c, w)| c[axis] * w).sum::<f64>());
                places.iter().position(|p| *p == at).unwrap_or_else(|| {
                    places.push(at);
                    places.len() - 1
                })
            });
            children.push(own.collect());
        }
        let places: Vec<(ChildNode, Vec<f64>)> =
            places.into_iter().map(|at| (ChildNode::of(entry, at), (entry.shape)(at))).collect();

        let mut nodes = self.nodes.clone();
        let mut on_sides = OnSides::default();
        let mut connectivity = Vec::with_capacity(children.len() * self.connectivity.len());
        for own in self.elements() {
            let mut add = |shape: &[f64]| {
                nodes.push(own.iter().zip(shape).map(|(&n, weight)| self.node(n) * *weight).sum());
                (nodes.len() - 1) as u32
            };
            let numbers: Vec<u32> = places
                .iter()
                .map(|(place, shape)| match *place {
                    ChildNode::Node(i) => own[i],
                    ChildNode::Side(side, t) => {
                        let side = entry.sides[side];
                        let ends = [own[side[0]], own[side[side.len() - 1]]];
                        *on_sides.0.entry(OnSides::key(ends, t)).or_insert_with(|| add(shape))
                    }
                    ChildNode::Interior => add(shape),
                })
                .collect();
            connectivity.extend(children.iter().flatten().map(|&place| numbers[place]));
        }
        let edges = self.edges.iter().map(|(name, segments)| {
            (name.clone(), segments.iter().flat_map(|segment| halves(segment, &on_sides)).collect())
        });
        let mut tags = self.tags.clone();
        if !tags.is_empty() {
            tags.resize(nodes.len(), None);
        }
        Self { edges: edges.collect(), nodes, element: self.element, connectivity, tags }
    }
}

/// Returns the two halves of a segment, with the nodes that refinement has added to it.
fn halves(segment: &Segment, on_sides: &OnSides) -> [Segment; 2] {
    let own = segment.nodes();
    let pieces = own.len() - 1;
    let node = |half: usize, i: usize| {
        let (twice, odd) = ((half * pieces + i) / 2, (half * pieces + i) % 2 == 1);
        let t = (half * pieces + i) as f64 / (2 * pieces) as f64;
        let old = (!odd).then(|| own[twice]);
        // A new node exists for every named edge, because edges consist of element sides, which have all been cut.
        old.or_else(|| on_sides.get(segment.ends(), t)).unwrap_or(own[twice])
    };
    [0, 1].map(|half| {
        let mut nodes = segment.nodes;
        (0..=pieces).for_each(|i| nodes[i] = node(half, i));
        Segment { nodes, count: segment.count }
    })
}
