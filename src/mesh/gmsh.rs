//! Reader of Gmsh's MSH format, version 4.1, ASCII: triangles of 3 or 6 nodes or quadrilaterals of 4 in the plane z =
//! 0, and physical curves as named edges. We wrote our own reader because the crates we found omit physical names and
//! panic on damaged files.
//!
//! Memory is never allocated from counts in the file, only for lines that exist.

use std::collections::{BTreeMap, HashMap, HashSet};

use nalgebra::Vector2;
use thiserror::Error;

use super::refine::OnSides;
use super::{Mesh, MeshError, Segment, side_key};
use crate::element::cell::{SQUARE, TRIANGLE};
use crate::element::{ELEMENTS, ElementType};
use crate::format::number;
use crate::model::ElementKind;
use crate::model::limits::{COORDINATE, TOTAL_CELLS};

/// Reason why a mesh file cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GmshError {
    /// A line does not follow the format.
    #[error("line {line}: expected {expected}")]
    Syntax {
        /// One-based line number.
        line: usize,
        /// Expected content.
        expected: String,
    },
    /// The file follows the format, but no mesh can be made of it: it has no triangles or quadrilaterals, elements of
    /// another shape, or too many elements.
    #[error("{0}")]
    Content(String),
    /// The elements do not form a valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

const SAVE_IT: &str = "save it with `gmsh in.msh -save -format msh41 -o out.msh`";
const ONLY_PHYSICAL: &str = "Gmsh saves only the physical groups if there are any";

/// Distance from z = 0, relative to the size of the mesh, that counts as rounding error.
const FLAT: f64 = 1e-9;

/// Gmsh's element types of lines, with their numbers of nodes, and of points.
const LINES: [(i64, usize); 2] = [(1, 2), (8, 3)];
const POINT: i64 = 15;

struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    number: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self, expected: &str) -> Result<&'a str, GmshError> {
        for (i, line) in self.lines.by_ref() {
            self.number = i + 1;
            if !line.trim().is_empty() {
                return Ok(line.trim());
            }
        }
        self.number += 1;
        Err(self.error(expected))
    }

    fn error(&self, expected: &str) -> GmshError {
        GmshError::Syntax { line: self.number, expected: expected.to_owned() }
    }

    /// Parses the numbers of the next line, at least `least` of them.
    fn numbers<T: std::str::FromStr>(&mut self, least: usize, expected: &str) -> Result<Vec<T>, GmshError> {
        let line = self.next(expected)?;
        let numbers: Vec<T> = line
            .split_ascii_whitespace()
            .map(str::parse)
            .collect::<Result<_, _>>()
            .map_err(|_| self.error(expected))?;
        if numbers.len() < least { Err(self.error(expected)) } else { Ok(numbers) }
    }

    /// Skips to the end of a section.
    fn finish(&mut self, section: &str) -> Result<(), GmshError> {
        let end = format!("$End{section}");
        while self.next(&end)? != end {}
        Ok(())
    }
}

#[derive(Default)]
struct File {
    curve_names: HashMap<i64, String>,
    curve_groups: HashMap<i64, Vec<i64>>,
    nodes: HashMap<u64, Vector2<f64>>,
    /// Line of the file, element type and node tags.
    elements: Vec<(usize, &'static ElementType, Vec<u64>)>,
    /// Line of the file, curve, and the tags of both end nodes.
    lines: Vec<(usize, i64, [u64; 2])>,
    /// Metres per unit of the file.
    scale: f64,
    /// Largest distance from z = 0, m, and its line.
    out_of_plane: (f64, usize),
}

impl Mesh {
    /// Reads a mesh and converts its triangles or quadrilaterals to `element`: missing nodes are added in the middle of
    /// straight sides, nodes that `element` does not have are left out.
    ///
    /// ```
    /// use warpbeam::{ElementKind, GmshError, Mesh};
    ///
    /// // A square of two triangles: four corners, and a node in the middle of each of the five sides.
    /// let mesh = Mesh::from_gmsh(&std::fs::read_to_string("tests/data/square.msh")?, ElementKind::T6)?;
    /// assert_eq!((mesh.element_count(), mesh.nodes().len()), (2, 4 + 5));
    /// let error: GmshError = Mesh::from_gmsh("$MeshFormat\n2.2 0 8\n$EndMeshFormat", ElementKind::T6).unwrap_err();
    /// assert!(error.to_string().starts_with("line 2: expected Gmsh format 4.1"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`GmshError`], with the line if known.
    pub fn from_gmsh(text: &str, element: ElementKind) -> Result<Self, GmshError> {
        Self::from_gmsh_scaled(text, element, 1.0)
    }

    /// Reads a mesh as [`Self::from_gmsh`] from a file whose unit is `scale` metres: 0.001 for millimetres.
    ///
    /// # Errors
    /// Same errors as [`Self::from_gmsh`].
    pub fn from_gmsh_scaled(text: &str, element: ElementKind, scale: f64) -> Result<Self, GmshError> {
        File::read(text, scale)?.into_mesh(element)
    }

    /// Returns the element type in a file, from the headers of its blocks alone; of several types, the one with the
    /// most nodes, so that no node is lost. Errors in the file are reported when it is read.
    pub fn gmsh_element(text: &str) -> Option<ElementKind> {
        Headers::of(text).own().map(|entry| entry.kind)
    }

    /// Returns the number of nodes of a file's mesh converted to `element`, from the headers of its blocks alone: exact
    /// for the file's own element type; for others, valid for a connected body without holes.
    pub fn gmsh_nodes(text: &str, element: ElementKind) -> u64 {
        let headers = Headers::of(text);
        let Some(own) = headers.own() else { return 0 };
        // N = V + E n + F m: vertices, sides with n nodes between their ends, faces with m nodes inside; and V − E + F
        // = 1.
        let faces: f64 = headers.elements.iter().map(|(_, count)| *count as f64).sum();
        let nodes = headers.nodes as f64;
        let [(n, m), (new_n, new_m)] = [own, element.entry()].map(|entry| {
            let between = entry.degree() - 1;
            let inside = entry.nodes.len() - entry.cell.corners.len() - entry.sides.len() * between;
            (between as f64, inside as f64)
        });
        let vertices = (nodes - n * (faces - 1.0) - m * faces) / (1.0 + n);
        (vertices + new_n * (vertices + faces - 1.0) + new_m * faces).round() as u64
    }
}

/// Counts in the block headers of a file.
struct Headers {
    nodes: u64,
    /// Element type and count of every block with a supported type.
    elements: Vec<(&'static ElementType, u64)>,
}

impl Headers {
    fn of(text: &str) -> Self {
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let mut headers = Self { nodes: 0, elements: Vec::new() };
        let numbers = |line: &str| -> Option<[u64; 4]> {
            let numbers: Option<Vec<u64>> = line.split_ascii_whitespace().map(|n| n.parse().ok()).collect();
            numbers?.try_into().ok()
        };
        while let Some(line) = lines.next() {
            match line {
                "$Nodes" => headers.nodes = lines.next().and_then(numbers).map_or(0, |[_, count, ..]| count),
                "$Elements" => break,
                _ => {}
            }
        }
        lines.next();
        while let Some([_, _, kind, count]) = lines.next().and_then(numbers) {
            let entry = ELEMENTS.iter().copied().find(|e| u64::from(e.gmsh_type) == kind);
            headers.elements.extend(entry.map(|entry| (entry, count)));
            lines.by_ref().take(usize::try_from(count).unwrap_or(usize::MAX)).for_each(drop);
        }
        headers
    }

    /// Returns the element type with the most nodes; `None` if the file has no supported elements.
    fn own(&self) -> Option<&'static ElementType> {
        self.elements.iter().map(|(entry, _)| *entry).max_by_key(|entry| entry.nodes.len())
    }
}

/// Describes an unsupported Gmsh element type and how to avoid it.
fn foreign(kind: i64) -> String {
    let order = "mesh with `-order 1` or `-order 2`";
    match kind {
        10 | 16 => format!("quadrangles of second order (element type {kind}): mesh with `-order 1`"),
        20 | 21 => format!("triangles of third order (element type {kind}): {order}"),
        22..=25 => format!("triangles of fourth order or more (element type {kind}): {order}"),
        26..=28 => format!("lines of third order or more (element type {kind}): {order}"),
        4..=7 | 11..=14 | 17..=19 | 29..=31 => format!("volumes (element type {kind}): mesh with `gmsh -2`"),
        _ => format!("element type {kind}"),
    }
}

impl File {
    fn read(text: &str, scale: f64) -> Result<Self, GmshError> {
        let mut lines = Lines { lines: text.lines().enumerate(), number: 0 };
        let mut file = Self { scale, ..Self::default() };
        let supported = "Gmsh format 4.1, ASCII";
        if lines.next(&format!("$MeshFormat, {supported}"))? != "$MeshFormat" {
            return Err(lines.error(&format!("$MeshFormat, {supported}; if Gmsh reads the file, {SAVE_IT}")));
        }
        let format: Vec<f64> = lines.numbers(3, &format!("{supported} (\"4.1 0 8\"); {SAVE_IT}"))?;
        if format[0] != 4.1 || format[1] != 0.0 {
            let binary = if format[1] == 0.0 { "" } else { ", binary" };
            return Err(lines.error(&format!("{supported}, got version {}{binary}; {SAVE_IT}", format[0])));
        }
        lines.finish("MeshFormat")?;
        while let Ok(section) = lines.next("a section") {
            let name = section.strip_prefix('$').ok_or_else(|| lines.error("a section such as $Nodes"))?;
            match name {
                "PhysicalNames" => file.read_names(&mut lines)?,
                "Entities" => file.read_entities(&mut lines, false)?,
                "PartitionedEntities" => file.read_entities(&mut lines, true)?,
                "Nodes" => file.read_nodes(&mut lines)?,
                "Elements" => file.read_elements(&mut lines)?,
                _ => {}
            }
            lines.finish(name)?;
        }
        Ok(file)
    }

    fn read_names(&mut self, lines: &mut Lines<'_>) -> Result<(), GmshError> {
        let count: Vec<u64> = lines.numbers(1, "the number of physical names")?;
        for _ in 0..count[0] {
            let expected = "a dimension, a tag and a name in quotes";
            let line = lines.next(expected)?;
            let mut parts = line.splitn(3, char::is_whitespace);
            let dimension = parts.next().and_then(|v| v.parse::<u32>().ok()).ok_or_else(|| lines.error(expected))?;
            let tag = parts.next().and_then(|v| v.parse().ok()).ok_or_else(|| lines.error(expected))?;
            let name = parts.next().map(|v| v.trim().trim_matches('"')).ok_or_else(|| lines.error(expected))?;
            if dimension == 1 {
                self.curve_names.insert(tag, name.to_owned());
            }
        }
        Ok(())
    }

    /// Reads the physical groups of the curves; those of a partitioned mesh are parts of others.
    fn read_entities(&mut self, lines: &mut Lines<'_>, is_partitioned: bool) -> Result<(), GmshError> {
        if is_partitioned {
            lines.next("the number of partitions")?;
            let ghosts: Vec<u64> = lines.numbers(1, "the number of ghost entities")?;
            for _ in 0..ghosts[0] {
                lines.next("a ghost entity")?;
            }
        }
        let counts: Vec<u64> = lines.numbers(4, "the numbers of points, curves, surfaces and volumes")?;
        for _ in 0..counts[0] {
            lines.next("a point")?;
        }
        for _ in 0..counts[1] {
            let expected = "a curve: tag, box, physical tags";
            let mut curve: Vec<f64> = lines.numbers(8, expected)?;
            if is_partitioned {
                // Between tag and box: dimension and tag of the whole, the number of partitions, and these.
                let partitions = curve[3].max(0.0) as usize;
                curve.drain(1..curve.len().min(partitions.saturating_add(4)));
            }
            let [tag, _, _, _, _, _, _, groups, rest @ ..] = &curve[..] else { return Err(lines.error(expected)) };
            let tags = rest.get(..groups.max(0.0) as usize).ok_or_else(|| lines.error(expected))?;
            self.curve_groups.insert(*tag as i64, tags.iter().map(|&t| t as i64).collect());
        }
        Ok(())
    }

    fn read_nodes(&mut self, lines: &mut Lines<'_>) -> Result<(), GmshError> {
        let header: Vec<u64> = lines.numbers(4, "the numbers of node blocks and nodes")?;
        for _ in 0..header[0] {
            let block: Vec<i64> = lines.numbers(4, "a node block: dimension, tag, parametric, count")?;
            let mut tags = Vec::new();
            for _ in 0..block[3] {
                let tag = lines.numbers::<u64>(1, "a node tag")?[0];
                if self.nodes.insert(tag, Vector2::zeros()).is_some() {
                    return Err(lines.error(&format!("every node once, got node {tag} a second time")));
                }
                tags.push(tag);
            }
            for tag in tags {
                let x: Vec<f64> = lines.numbers(3, "the coordinates of a node")?;
                let [x, y, z] = [x[0], x[1], x[2]].map(|v| v * self.scale);
                if [x, y, z].iter().any(|&v| COORDINATE.check(v).is_err()) {
                    return Err(lines.error("coordinates within 1e6 m"));
                }
                if z.abs() > self.out_of_plane.0 {
                    self.out_of_plane = (z.abs(), lines.number);
                }
                self.nodes.insert(tag, Vector2::new(x, y));
            }
        }
        Ok(())
    }

    fn read_elements(&mut self, lines: &mut Lines<'_>) -> Result<(), GmshError> {
        let header: Vec<u64> = lines.numbers(4, "the numbers of element blocks and elements")?;
        let mut numbers: HashSet<u64> = HashSet::new();
        for _ in 0..header[0] {
            let block: Vec<i64> = lines.numbers(4, "an element block: dimension, tag, type, count")?;
            let [_, entity, kind, count] = [block[0], block[1], block[2], block[3]];
            let element = ELEMENTS.iter().copied().find(|e| i64::from(e.gmsh_type) == kind);
            let line = LINES.iter().find(|l| l.0 == kind).map(|l| l.1);
            if element.is_none() && line.is_none() && kind != POINT {
                let expected = "lines and triangles of first or second order and quadrilaterals of first";
                return Err(lines.error(&format!("{expected}, got {}", foreign(kind))));
            }
            for _ in 0..count {
                let least = 1 + element.map_or(line.unwrap_or(1), |e| e.nodes.len());
                let tags = lines.numbers::<u64>(least, "an element: tag, nodes")?;
                if !numbers.insert(tags[0]) {
                    return Err(lines.error(&format!("every element once, got element {} a second time", tags[0])));
                }
                match (element, line) {
                    (Some(element), _) => self.elements.push((lines.number, element, tags[1..least].to_vec())),
                    (None, Some(_)) => self.lines.push((lines.number, entity, [tags[1], tags[2]])),
                    (None, None) => {}
                }
            }
        }
        Ok(())
    }

    /// Rejects elements with another shape than `entry`, with advice.
    fn check_shapes(&self, entry: &ElementType) -> Result<(), GmshError> {
        let mut others = self.elements.iter().filter(|(_, own, _)| !own.shares_cell(entry));
        let Some((_, other, _)) = others.next() else { return Ok(()) };
        let (wrong, all) = (1 + others.count(), self.elements.len());
        let (found, expected) = (other.cell.name, entry.cell.name);
        let fitting: Vec<String> =
            ELEMENTS.iter().filter(|e| e.shares_cell(other)).map(|e| format!("\"{}\"", e.id)).collect();
        let remedy = if wrong == all {
            format!("set element = {}, or mesh the part again with {expected}s", fitting.join(" or "))
        } else {
            format!(
                "mesh the part again with one shape; in Gmsh, `Recombine Surface` with Mesh.RecombinationAlgorithm = \
                 2 or 3 gives {}s only, and no recombination {}s only",
                SQUARE.name, TRIANGLE.name
            )
        };
        Err(GmshError::Content(format!(
            "expected {expected}s for {}, got {wrong} {found}s of {all}: {remedy}",
            entry.id
        )))
    }

    /// Rejects elements with the same corners.
    fn check_doubles(&self, entry: &ElementType) -> Result<(), GmshError> {
        let mut lines: HashMap<Vec<u64>, usize> = HashMap::new();
        for (line, _, tags) in &self.elements {
            let mut corners = tags[..entry.cell.corners.len()].to_vec();
            corners.sort_unstable();
            if let Some(first) = lines.insert(corners.clone(), *line) {
                let expected =
                    format!("every element once, got nodes {corners:?}, which the element of line {first} has");
                return Err(GmshError::Syntax { line: *line, expected });
            }
        }
        Ok(())
    }

    fn into_mesh(self, kind: ElementKind) -> Result<Mesh, GmshError> {
        let entry = kind.entry();
        if self.elements.is_empty() {
            let message = match self.lines.len() {
                0 => "expected triangles or quadrilaterals, got none; mesh with `gmsh -2`".to_owned(),
                n => format!(
                    "expected triangles or quadrilaterals, got only {n} lines; {ONLY_PHYSICAL}: make the surface a \
                     physical group, too"
                ),
            };
            return Err(GmshError::Content(message));
        }
        let (distance, line) = self.out_of_plane;
        let size = self.nodes.values().map(|x| x.amax()).fold(0.0, f64::max);
        if distance > FLAT * size {
            let expected = format!("a mesh in the plane z = 0, got z = {} m", number(distance));
            return Err(GmshError::Syntax { line, expected });
        }
        self.check_shapes(entry)?;
        self.check_doubles(entry)?;
        // A cell of a beam consists of two triangles.
        let a_cell = if entry.cell.corners.len() == 3 { 2.0 } else { 1.0 };
        TOTAL_CELLS.check(self.elements.len() as f64 / a_cell).map_err(|_| {
            GmshError::Content(format!("expected at most {} {}s", a_cell * TOTAL_CELLS.max, entry.cell.name))
        })?;
        // Only nodes of elements are read; other nodes in the file would be unconnected.
        let mut builder =
            Builder { tags: &self.nodes, numbers: HashMap::new(), between: OnSides::default(), nodes: Vec::new() };
        let mut connectivity = Vec::with_capacity(entry.nodes.len() * self.elements.len());
        for (line, own, tags) in &self.elements {
            let missing =
                |tag: u64| GmshError::Syntax { line: *line, expected: format!("nodes that exist, got {tag}") };
            for &at in entry.nodes {
                // A node of the file at this place, or a new one between the ends of a straight side.
                let node = match own.node_at(at) {
                    Some(i) => builder.number(tags[i]).ok_or_else(|| missing(tags[i]))?,
                    None => builder.between(own, tags, at).map_err(missing)?,
                };
                connectivity.push(node);
            }
        }
        let Builder { numbers, nodes, .. } = builder;
        let mut tags = vec![None; nodes.len()];
        numbers.iter().for_each(|(&tag, &number)| tags[number as usize] = Some(tag));
        let bare = Mesh { tags, ..Mesh::new(nodes, kind, connectivity, BTreeMap::new())? };
        let sides: HashMap<[u32; 2], Segment> =
            bare.elements().flat_map(|nodes| bare.sides(nodes)).map(|side| (side.key(), side)).collect();
        let mut edges: BTreeMap<String, Vec<Segment>> = BTreeMap::new();
        for (line, curve, ends) in &self.lines {
            let [Some(&a), Some(&b)] = ends.map(|tag| numbers.get(&tag)) else { continue };
            for tag in self.curve_groups.get(curve).into_iter().flatten() {
                let expected = || "a line along a side of an element".to_owned();
                let side = sides.get(&side_key([a, b]));
                let side = side.ok_or_else(|| GmshError::Syntax { line: *line, expected: expected() })?;
                let name = self.curve_names.get(&tag.abs()).cloned().unwrap_or_else(|| tag.abs().to_string());
                edges.entry(name).or_default().push(*side);
            }
        }
        Ok(bare.with_edges(edges)?)
    }
}

/// Builder that numbers nodes in the order of use and adds missing nodes between others.
struct Builder<'a> {
    tags: &'a HashMap<u64, Vector2<f64>>,
    numbers: HashMap<u64, u32>,
    between: OnSides,
    nodes: Vec<Vector2<f64>>,
}

impl Builder<'_> {
    fn number(&mut self, tag: u64) -> Option<u32> {
        if let Some(&number) = self.numbers.get(&tag) {
            return Some(number);
        }
        let position = *self.tags.get(&tag)?;
        let number = self.nodes.len() as u32;
        self.nodes.push(position);
        self.numbers.insert(tag, number);
        Some(number)
    }

    /// Returns the node at `at` in an element of the file that has none there, adding it if necessary. The error is the
    /// tag of a missing corner node.
    fn between(&mut self, element: &ElementType, tags: &[u64], at: [f64; 2]) -> Result<u32, u64> {
        let weights = (element.cell.corner_weights)(at);
        let mut ends = Vec::new();
        let mut place = Vector2::zeros();
        for (&tag, &weight) in tags.iter().zip(&weights).filter(|(_, weight)| weight.abs() > 1e-9) {
            let number = self.number(tag).ok_or(tag)?;
            place += self.nodes[number as usize] * weight;
            ends.push((number, weight));
        }
        let mut add = || {
            self.nodes.push(place);
            (self.nodes.len() - 1) as u32
        };
        Ok(match ends[..] {
            [(a, _), (b, of_b)] => *self.between.0.entry(OnSides::key([a, b], of_b)).or_insert_with(add),
            _ => add(),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail")]

    use super::*;

    #[test]
    fn lines_along_the_sides_of_every_element_are_read() {
        for side in ELEMENTS.iter().flat_map(|e| e.sides) {
            assert!(LINES.iter().any(|line| line.1 == side.len()), "Gmsh's line of {} nodes is missing", side.len());
        }
    }

    #[test]
    fn two_elements_share_every_node_between_the_ends_of_a_side() {
        let tags = [(7, [0.0, 0.0]), (5, [3.0, 0.0]), (6, [0.0, 3.0])].map(|(tag, at)| (tag, Vector2::from(at))).into();
        let (numbers, between) = (HashMap::new(), OnSides::default());
        let mut builder = Builder { tags: &tags, numbers, between, nodes: Vec::new() };
        let t3 = ElementKind::T3.entry();
        let mut number = |tags: &[u64], along: f64| builder.between(t3, tags, [along / 3.0, 0.0]).unwrap();
        let [first, second] = [1.0, 2.0].map(|along| number(&[7, 5, 6], along));
        assert_ne!(first, second);
        assert_eq!([2.0, 1.0].map(|along| number(&[5, 7, 6], along)), [first, second]);
        assert_eq!(builder.nodes[second as usize], Vector2::new(2.0, 0.0));
    }
}
