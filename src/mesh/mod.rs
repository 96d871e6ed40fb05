//! Triangle meshes: nodes, connectivity, named edges. Areas are checked once, here.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector2;
use thiserror::Error;

use crate::rotation::affine::DEGENERATE;
use crate::scene::ElementKind;

mod beam;
mod gmsh;
mod refine;

pub use gmsh::GmshError;

/// A mesh that cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// A triangle without area.
    #[error("triangle {triangle} has no area: expected corners that are not on one line, got {corners:?}")]
    Degenerate {
        /// Zero-based number of the triangle.
        triangle: usize,
        /// Its rest corners, m.
        corners: [[f64; 2]; 3],
    },
    /// A triangle with a node that does not exist.
    #[error("triangle {triangle} names node {node}: expected a node below {count}")]
    NoSuchNode {
        /// Zero-based number of the triangle.
        triangle: usize,
        /// The node it names.
        node: u32,
        /// How many nodes there are.
        count: usize,
    },
    /// No triangle at all, or a connectivity of the wrong length.
    #[error("expected triangles of {expected} nodes each, got {got} node numbers")]
    Connectivity {
        /// Nodes a triangle.
        expected: usize,
        /// Node numbers given.
        got: usize,
    },
}

/// The nodes made between two others, each once.
#[derive(Debug, Default)]
struct Middles(HashMap<[u32; 2], u32>);

/// Two nodes, smaller number first: the same for the side of either triangle.
fn side_key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Middles {
    /// The node between two of `nodes`, made where `place` says if there is none yet.
    fn between(
        &mut self,
        nodes: &mut Vec<Vector2<f64>>,
        ends: [u32; 2],
        place: impl FnOnce(&[Vector2<f64>]) -> Vector2<f64>,
    ) -> u32 {
        *self.0.entry(side_key(ends)).or_insert_with(|| {
            nodes.push(place(nodes));
            (nodes.len() - 1) as u32
        })
    }

    fn get(&self, ends: [u32; 2]) -> Option<u32> {
        self.0.get(&side_key(ends)).copied()
    }
}

/// One side of a triangle on a named edge, by node numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Its two ends.
    pub ends: [u32; 2],
    /// The node between them, if the element has one.
    pub middle: Option<u32>,
}

impl Segment {
    /// Its ends, smaller number first: the same for the side of either triangle.
    #[must_use]
    pub fn key(&self) -> [u32; 2] {
        side_key(self.ends)
    }

    /// All its nodes.
    pub fn nodes(&self) -> impl Iterator<Item = u32> {
        self.ends.into_iter().chain(self.middle)
    }
}

/// Nodes, triangles and named edges, at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Rest positions X, m.
    pub nodes: Vec<Vector2<f64>>,
    /// What every triangle is.
    pub element: ElementKind,
    /// Node numbers, `element.nodes()` a triangle: corners counter-clockwise, then the midpoints of sides 12, 23, 31.
    pub connectivity: Vec<u32>,
    /// Boundary segments by edge name.
    pub edges: BTreeMap<String, Vec<Segment>>,
}

impl Mesh {
    /// A mesh whose triangles all exist, have area, and are turned counter-clockwise.
    ///
    /// # Errors
    /// [`MeshError`], naming the triangle.
    pub fn new(
        nodes: Vec<Vector2<f64>>,
        element: ElementKind,
        mut connectivity: Vec<u32>,
        edges: BTreeMap<String, Vec<Segment>>,
    ) -> Result<Self, MeshError> {
        let n = element.nodes();
        if connectivity.is_empty() || !connectivity.len().is_multiple_of(n) {
            return Err(MeshError::Connectivity { expected: n, got: connectivity.len() });
        }
        for (triangle, t) in connectivity.chunks_exact_mut(n).enumerate() {
            if let Some(&node) = t.iter().find(|&&node| node as usize >= nodes.len()) {
                return Err(MeshError::NoSuchNode { triangle, node, count: nodes.len() });
            }
            let corners = [t[0], t[1], t[2]].map(|i| nodes[i as usize]);
            let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
            let longest = e1.norm().max(e2.norm()).max((e2 - e1).norm());
            let doubled_area = e1.perp(&e2);
            let floor = DEGENERATE * longest * longest;
            if doubled_area.is_nan() || floor.is_infinite() || doubled_area.abs() <= floor {
                return Err(MeshError::Degenerate { triangle, corners: corners.map(Into::into) });
            }
            if doubled_area < 0.0 {
                t.swap(1, 2);
                if n > 3 {
                    t.swap(3, 5);
                }
            }
        }
        Ok(Self { nodes, element, connectivity, edges })
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.connectivity.len() / self.element.nodes()
    }

    /// The node numbers of every triangle.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.element.nodes())
    }

    /// The nodes of a named edge, each once; `None` if there is no such edge.
    #[must_use]
    pub fn edge_nodes(&self, name: &str) -> Option<Vec<u32>> {
        let mut nodes: Vec<u32> = self.edges.get(name)?.iter().flat_map(Segment::nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Some(nodes)
    }

    /// The node nearest to a rest position; the first of equals.
    #[must_use]
    pub fn nearest_node(&self, at: Vector2<f64>) -> u32 {
        let mut best = (f64::INFINITY, 0);
        for (i, node) in (0..).zip(&self.nodes) {
            let distance = (node - at).norm_squared();
            if distance < best.0 {
                best = (distance, i);
            }
        }
        best.1
    }

    /// The corners of the box around the rest mesh, m.
    #[must_use]
    pub fn bounds(&self) -> (Vector2<f64>, Vector2<f64>) {
        let start = Vector2::repeat(f64::INFINITY);
        self.nodes.iter().fold((start, -start), |(low, high), p| (low.inf(p), high.sup(p)))
    }

    /// The three sides of a triangle.
    #[must_use]
    pub fn sides(triangle: &[u32]) -> [Segment; 3] {
        [0, 1, 2].map(|i| Segment { ends: [triangle[i], triangle[(i + 1) % 3]], middle: triangle.get(3 + i).copied() })
    }

    /// The sides that belong to one triangle only: the outline, each running counter-clockwise around the body.
    #[must_use]
    pub fn outline(&self) -> Vec<Segment> {
        let mut sides: Vec<Segment> = self.triangles().flat_map(Self::sides).collect();
        sides.sort_unstable_by_key(Segment::key);
        sides.chunk_by(|a, b| a.key() == b.key()).filter(|same| same.len() == 1).map(|same| same[0]).collect()
    }
}
