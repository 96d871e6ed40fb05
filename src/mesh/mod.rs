//! Meshes of one element type: nodes, connectivity, named edges. The constructor validates them.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector2;
use thiserror::Error;

use crate::element::{ElementType, MAX_SIDE_NODES};
use crate::model::ElementKind;

mod beam;
mod crossing;
mod gmsh;
mod locate;
mod recovery;
mod refine;
mod seam;

pub(crate) use beam::{axis_angle, bent, straightened};
pub use gmsh::GmshError;
pub use locate::MaterialPoint;
pub use recovery::Recovery;

/// Error of a mesh. Elements are numbered from 0.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// No element, or a connectivity of the wrong length.
    #[error("expected elements of {expected} nodes each, got {got} node numbers")]
    Connectivity {
        /// Nodes per element.
        expected: usize,
        /// Node numbers given.
        got: usize,
    },
    /// A node position is NaN or infinite.
    #[error("node {node} is at {position:?}: expected finite coordinates")]
    NotFinite {
        /// Node number.
        node: usize,
        /// Position, m.
        position: [f64; 2],
    },
    /// An element refers to a node that does not exist.
    #[error("element {element} names node {node}: expected a node below {count}")]
    NoSuchNode {
        /// Element number.
        element: usize,
        /// Node number.
        node: u32,
        /// Number of nodes.
        count: usize,
    },
    /// An element has no area.
    #[error("element {element} has no area: expected corners that are not on one line, got {corners:?}")]
    Degenerate {
        /// Element number.
        element: usize,
        /// Rest corners, m.
        corners: Vec<[f64; 2]>,
    },
    /// An element folds over: its sides are too curved, or it is a quadrilateral that is not convex.
    #[error("element {element} folds over: expected sides that are less curved, and convex quadrilaterals")]
    Folded {
        /// Element number.
        element: usize,
    },
    /// A segment of a named edge is not a side of an element.
    #[error("edge \"{edge}\" has the nodes {nodes:?}: expected the nodes of an element's side")]
    NoSuchSide {
        /// Name of the edge.
        edge: String,
        /// Nodes of the segment.
        nodes: Vec<u32>,
    },
}

/// Side of an element, by node numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    nodes: [u32; MAX_SIDE_NODES],
    count: usize,
}

impl Segment {
    /// Returns the segment through these nodes, in their order along it; `None` for fewer than two nodes or more than a
    /// side has.
    pub fn new(nodes: &[u32]) -> Option<Self> {
        let count = nodes.len();
        if !(2..=MAX_SIDE_NODES).contains(&count) {
            return None;
        }
        let mut own = [0; MAX_SIDE_NODES];
        own[..count].copy_from_slice(nodes);
        Some(Self { nodes: own, count })
    }

    /// Returns the nodes, in their order along the segment.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count]
    }

    /// Returns the first and the last node.
    pub fn ends(&self) -> [u32; 2] {
        [self.nodes[0], self.nodes[self.count - 1]]
    }

    /// Returns the end nodes, smaller number first: the same for both elements that share the side.
    pub fn key(&self) -> [u32; 2] {
        side_key(self.ends())
    }
}

/// Sorts two node numbers.
fn side_key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Nodes, elements and named edges of a body at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    nodes: Vec<Vector2<f64>>,
    element: ElementKind,
    connectivity: Vec<u32>,
    edges: BTreeMap<String, Vec<Segment>>,
    /// Node numbers in the mesh file; empty for meshes that were not read from a file.
    tags: Vec<Option<u64>>,
}

/// Lower bound of area over squared size of an element: a few hundred rounding errors. It rejects slivers whose
/// stiffness would consist of rounding errors, at the cost of some that could still be solved.
const DEGENERATE: f64 = 1e-13;

impl Mesh {
    /// Returns a mesh with these rest positions (m), node numbers and named edges. Node numbers are element by element:
    /// the corners counter-clockwise, then for `t6` the middles of the sides 1–2, 2–3 and 3–1. Clockwise elements are
    /// reversed.
    ///
    /// ```
    /// use std::collections::BTreeMap;
    /// use warpbeam::{Mesh, Segment};
    /// use warpbeam::nalgebra::Vector2;
    /// use warpbeam::ElementKind;
    ///
    /// let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from).to_vec();
    /// let left = BTreeMap::from([("left".to_owned(), Vec::from_iter(Segment::new(&[3, 0])))]);
    /// let mesh = Mesh::new(nodes, ElementKind::T3, vec![0, 1, 2, 0, 2, 3], left)?;
    /// assert_eq!(mesh.element_count(), 2);
    /// # Ok::<(), warpbeam::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError`], which names the node, element or edge.
    pub fn new(
        nodes: Vec<Vector2<f64>>,
        element: ElementKind,
        connectivity: Vec<u32>,
        edges: BTreeMap<String, Vec<Segment>>,
    ) -> Result<Self, MeshError> {
        let mut mesh = Self { nodes, element, connectivity, edges, tags: Vec::new() };
        mesh.check()?;
        Ok(mesh)
    }

    /// Validates the mesh, and reverses clockwise elements.
    fn check(&mut self) -> Result<(), MeshError> {
        let entry = self.element.entry();
        let n = entry.nodes.len();
        if self.connectivity.is_empty() || !self.connectivity.len().is_multiple_of(n) {
            return Err(MeshError::Connectivity { expected: n, got: self.connectivity.len() });
        }
        let bad = self.nodes.iter().position(|x| !(x.x.is_finite() && x.y.is_finite()));
        if let Some(node) = bad {
            return Err(MeshError::NotFinite { node, position: self.nodes[node].into() });
        }
        let turned_over = entry.turned_over();
        for (element, own) in self.connectivity.chunks_exact_mut(n).enumerate() {
            if let Some(&node) = own.iter().find(|&&node| node as usize >= self.nodes.len()) {
                return Err(MeshError::NoSuchNode { element, node, count: self.nodes.len() });
            }
            let corners: Vec<Vector2<f64>> =
                own[..entry.cell.corners.len()].iter().map(|&n| self.nodes[n as usize]).collect();
            let doubled_area: f64 = corners.windows(2).map(|w| (w[0] - corners[0]).perp(&(w[1] - corners[0]))).sum();
            let distances =
                corners.iter().enumerate().flat_map(|(i, a)| corners[..i].iter().map(move |b| (a - b).norm()));
            let floor = DEGENERATE * distances.fold(0.0, f64::max).powi(2);
            if doubled_area.is_nan() || floor.is_infinite() || doubled_area.abs() <= floor {
                return Err(MeshError::Degenerate { element, corners: corners.iter().map(|&x| x.into()).collect() });
            }
            if doubled_area < 0.0 {
                let clockwise = own.to_vec();
                own.iter_mut().zip(&turned_over).for_each(|(node, &from)| *node = clockwise[from]);
            }
            let rest: Vec<Vector2<f64>> = own.iter().map(|&n| self.nodes[n as usize]).collect();
            // The comparison is `false` for NaN.
            let unfolded = |at: [f64; 2]| entry.jacobian(&rest, at).determinant() > 0.0;
            // The Jacobian of an element with straight sides is smallest at a corner.
            let corners = if entry.degree() == 1 { entry.nodes } else { &[] };
            let mut points = entry.points.iter().chain(entry.mass_points).map(|p| p.at).chain(corners.iter().copied());
            if !points.all(unfolded) {
                return Err(MeshError::Folded { element });
            }
        }
        self.check_edges()
    }

    fn check_edges(&self) -> Result<(), MeshError> {
        let mut wanted: HashMap<[u32; 2], Option<Segment>> = HashMap::new();
        wanted.extend(self.edges.values().flatten().map(|s| (s.key(), None)));
        if wanted.is_empty() {
            return Ok(());
        }
        for side in self.elements().flat_map(|nodes| self.sides(nodes)) {
            if let Some(found) = wanted.get_mut(&side.key()) {
                *found = Some(side);
            }
        }
        for (name, segments) in &self.edges {
            let is_side = |s: &Segment| {
                let side = wanted.get(&s.key()).copied().flatten();
                side.is_some_and(|side| side.nodes() == s.nodes() || side.nodes().iter().rev().eq(s.nodes()))
            };
            if let Some(segment) = segments.iter().find(|s| !is_side(s)) {
                return Err(MeshError::NoSuchSide { edge: name.clone(), nodes: segment.nodes().to_vec() });
            }
        }
        Ok(())
    }

    /// Returns the mesh with every node moved to `place` of its rest position.
    ///
    /// # Errors
    /// [`MeshError`] if an element then has no area.
    pub fn moved(&self, place: impl Fn(Vector2<f64>) -> Vector2<f64>) -> Result<Self, MeshError> {
        let nodes = self.nodes.iter().map(|&x| place(x)).collect();
        let moved = Self::new(nodes, self.element, self.connectivity.clone(), self.edges.clone())?;
        Ok(Self { tags: self.tags.clone(), ..moved })
    }

    /// Returns the number of parts that share no nodes, and the part of every node; `u32::MAX` for nodes without an
    /// element.
    pub(crate) fn parts(&self) -> (usize, Vec<u32>) {
        let mut of: Vec<usize> = (0..self.nodes.len()).collect();
        let mut used = vec![false; self.nodes.len()];
        for nodes in self.elements() {
            for &node in nodes {
                used[node as usize] = true;
                join(&mut of, nodes[0] as usize, node as usize);
            }
        }
        let mut parts = 0;
        let mut part_of = vec![u32::MAX; used.len()];
        for node in (0..used.len()).filter(|&node| used[node]) {
            let first = first(&mut of, node);
            // The first node of a part has its smallest number, so it is visited first.
            if first == node {
                part_of[node] = parts;
                parts += 1;
            }
            part_of[node] = part_of[first];
        }
        (parts as usize, part_of)
    }

    /// Divides the mesh into parts whose elements share sides; nodes at which parts meet without sharing a side are
    /// hinges. Returns the number of parts and for every node the parts that contain it, each once; empty for nodes
    /// without an element. `None` if no two parts meet at a hinge.
    pub(crate) fn hinged_parts(&self) -> Option<(usize, Vec<Vec<u32>>)> {
        // Two sides of the outline end at each of its nodes, four at a node where parts only touch.
        let mut ends = vec![0_u32; self.nodes.len()];
        self.outline().iter().flat_map(Segment::ends).for_each(|node| ends[node as usize] += 1);
        if ends.iter().all(|&count| count <= 2) {
            return None;
        }
        let mut of_side: HashMap<[u32; 2], usize> = HashMap::new();
        let mut of: Vec<usize> = (0..self.element_count()).collect();
        for (element, nodes) in self.elements().enumerate() {
            for side in self.sides(nodes) {
                if let Some(other) = of_side.insert(side.key(), element) {
                    join(&mut of, element, other);
                }
            }
        }
        let mut numbers: HashMap<usize, u32> = HashMap::new();
        let mut of_node = vec![Vec::new(); self.nodes.len()];
        for (element, nodes) in self.elements().enumerate() {
            let next = numbers.len() as u32;
            let number = *numbers.entry(first(&mut of, element)).or_insert(next);
            for &node in nodes {
                let parts: &mut Vec<u32> = &mut of_node[node as usize];
                if !parts.contains(&number) {
                    parts.push(number);
                }
            }
        }
        Some((numbers.len(), of_node))
    }

    /// Returns the mesh with its named edges replaced by `edges`.
    ///
    /// # Errors
    /// [`MeshError::NoSuchSide`].
    pub fn with_edges(self, edges: BTreeMap<String, Vec<Segment>>) -> Result<Self, MeshError> {
        let mesh = Self { edges, ..self };
        mesh.check_edges()?;
        Ok(mesh)
    }

    /// Returns the rest positions X, m.
    pub fn nodes(&self) -> &[Vector2<f64>] {
        &self.nodes
    }

    /// Returns the rest position of a node, m.
    pub(crate) fn node(&self, node: u32) -> Vector2<f64> {
        self.nodes[node as usize]
    }

    /// Returns `true` if the mesh was read from a file, with node numbers.
    pub fn is_from_file(&self) -> bool {
        !self.tags.is_empty()
    }

    /// Returns the number of a node for display: its number in the mesh file, or without a file its index from 0.
    /// `None` for a node that was added between those of a file.
    pub fn node_name(&self, node: u32) -> Option<u64> {
        if self.is_from_file() { self.tags.get(node as usize).copied().flatten() } else { Some(u64::from(node)) }
    }

    /// Returns the element type.
    pub fn element(&self) -> ElementKind {
        self.element
    }

    /// Returns the node numbers, element by element, in the order of [`Self::new`].
    pub fn connectivity(&self) -> &[u32] {
        &self.connectivity
    }

    /// Returns the segments of every edge, by name.
    pub fn edges(&self) -> &BTreeMap<String, Vec<Segment>> {
        &self.edges
    }

    /// Returns the number of elements.
    pub fn element_count(&self) -> usize {
        self.connectivity.len() / self.element.entry().nodes.len()
    }

    /// Iterates over the node numbers of every element.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.element.entry().nodes.len())
    }

    /// Returns the nodes of a named edge, each once; `None` if there is no such edge.
    pub fn edge_nodes(&self, name: &str) -> Option<Vec<u32>> {
        Some(unique(self.edges.get(name)?.iter().flat_map(Segment::nodes).copied()))
    }

    /// Returns the node nearest to a rest position; the first of several at the same distance.
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

    /// Returns the lower left and upper right corner of the bounding box of the rest mesh, m.
    pub fn bounds(&self) -> (Vector2<f64>, Vector2<f64>) {
        let start = Vector2::repeat(f64::INFINITY);
        self.nodes.iter().fold((start, -start), |(low, high), p| (low.inf(p), high.sup(p)))
    }

    /// Iterates over the sides of an element with these node numbers, counter-clockwise.
    pub fn sides<'a>(&self, nodes: &'a [u32]) -> impl Iterator<Item = Segment> + 'a {
        let sides = self.element.entry().sides;
        sides.iter().filter_map(|side| {
            let mut own = [0; MAX_SIDE_NODES];
            own.iter_mut().zip(*side).for_each(|(node, &i)| *node = nodes[i]);
            Segment::new(&own[..side.len()])
        })
    }

    /// Returns the sides that belong to only one element, each counter-clockwise around the body.
    pub fn outline(&self) -> Vec<Segment> {
        outer(self.elements().flat_map(|nodes| self.sides(nodes)).collect())
    }

    /// Returns `true` for every node on the outline.
    pub(crate) fn nodes_on_outline(&self) -> Vec<bool> {
        let mut is_outer = vec![false; self.nodes.len()];
        self.outline().iter().flat_map(Segment::nodes).for_each(|&node| is_outer[node as usize] = true);
        is_outer
    }

    /// Returns the sides, each with its ends and a value, as closed lines of these values.
    pub(crate) fn closed_lines<T>(sides: impl IntoIterator<Item = ([u32; 2], T)>) -> Vec<Vec<T>> {
        let mut from: BTreeMap<u32, Vec<(u32, T)>> = BTreeMap::new();
        sides.into_iter().for_each(|([start, end], value)| from.entry(start).or_default().push((end, value)));
        let mut lines = Vec::new();
        while let Some((&first, _)) = from.first_key_value() {
            let (mut line, mut corner) = (Vec::new(), first);
            while let Some((end, value)) = from.get_mut(&corner).and_then(Vec::pop) {
                if from[&corner].is_empty() {
                    from.remove(&corner);
                }
                line.push(value);
                corner = end;
            }
            lines.push(line);
        }
        lines
    }

    /// Returns the registry entry of the mesh's element type.
    pub(crate) fn entry(&self) -> &'static ElementType {
        self.element.entry()
    }
}

/// Returns the first member of a member's part (union-find): each member points towards the first one of its part.
fn first(of: &mut [usize], mut member: usize) -> usize {
    while of[member] != member {
        of[member] = of[of[member]];
        member = of[member];
    }
    member
}

/// Joins the parts of two members.
fn join(of: &mut [usize], a: usize, b: usize) {
    let (a, b) = (first(of, a), first(of, b));
    of[a.max(b)] = a.min(b);
}

/// Returns numbers in their order, each once.
fn unique(numbers: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut numbers: Vec<u32> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// Returns the sides that occur once.
fn outer(mut sides: Vec<Segment>) -> Vec<Segment> {
    sides.sort_unstable_by_key(Segment::key);
    sides.chunk_by(|a, b| a.key() == b.key()).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}
