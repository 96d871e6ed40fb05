//! Reads Gmsh's MSH format, version 4.1, ASCII: triangles of 3 or 6 nodes in the plane z = 0, and physical curves as
//! named edges. Own code because what we found on the registry leaves physical names out and panics on damaged files.
//!
//! Counts in the file are never trusted with memory: everything read is a line that is there.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector2;
use thiserror::Error;

use super::{Mesh, MeshError, Middles, Segment};
use crate::scene::ElementKind;
use crate::scene::limits::{COORDINATE, TOTAL_CELLS};

/// Why a mesh file cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GmshError {
    /// A line is not what the format has there.
    #[error("line {line}: expected {expected}")]
    Syntax {
        /// One-based.
        line: usize,
        /// What the format has there.
        expected: String,
    },
    /// The file as a whole lacks something.
    #[error("{0}")]
    Content(String),
    /// The triangles make no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Gmsh's numbers for the elements we read, and how many nodes each has.
const LINE_2: (u32, usize) = (1, 2);
const TRIANGLE_3: (u32, usize) = (2, 3);
const LINE_3: (u32, usize) = (8, 3);
const TRIANGLE_6: (u32, usize) = (9, 6);
const POINT: (u32, usize) = (15, 1);

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

    /// The numbers of the next line, at least `least` of them.
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
    triangles: Vec<(usize, Vec<u64>)>,
    lines: Vec<(i64, Vec<u64>)>,
}

impl Mesh {
    /// Reads a mesh. Its triangles become `element`: six-node triangles of straight sides get their middle nodes, those of
    /// a three-node mesh lose them.
    ///
    /// # Errors
    /// [`GmshError`], with the line where there is one.
    pub fn from_gmsh(text: &str, element: ElementKind) -> Result<Self, GmshError> {
        File::read(text)?.into_mesh(element)
    }
}

impl File {
    fn read(text: &str) -> Result<Self, GmshError> {
        let mut lines = Lines { lines: text.lines().enumerate(), number: 0 };
        let mut file = Self::default();
        if lines.next("$MeshFormat")? != "$MeshFormat" {
            return Err(lines.error("$MeshFormat: a Gmsh file of format 4.1, ASCII"));
        }
        let supported = "format 4.1, ASCII, as `gmsh -format msh41` writes it (\"4.1 0 8\")";
        let format: Vec<f64> = lines.numbers(3, supported)?;
        if format[0] != 4.1 || format[1] != 0.0 {
            return Err(lines.error(&format!("{supported}, got version {} of type {}", format[0], format[1])));
        }
        lines.finish("MeshFormat")?;
        while let Ok(section) = lines.next("a section") {
            let name = section.strip_prefix('$').ok_or_else(|| lines.error("a section such as $Nodes"))?;
            match name {
                "PhysicalNames" => file.read_names(&mut lines)?,
                "Entities" => file.read_entities(&mut lines)?,
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

    fn read_entities(&mut self, lines: &mut Lines<'_>) -> Result<(), GmshError> {
        let counts: Vec<u64> = lines.numbers(4, "the numbers of points, curves, surfaces and volumes")?;
        for _ in 0..counts[0] {
            lines.next("a point")?;
        }
        for _ in 0..counts[1] {
            let expected = "a curve: tag, box, physical tags";
            let curve: Vec<f64> = lines.numbers(8, expected)?;
            let groups = curve[7].max(0.0) as usize;
            let tags = curve.get(8..8usize.saturating_add(groups)).ok_or_else(|| lines.error(expected))?;
            self.curve_groups.insert(curve[0] as i64, tags.iter().map(|&t| t as i64).collect());
        }
        Ok(())
    }

    fn read_nodes(&mut self, lines: &mut Lines<'_>) -> Result<(), GmshError> {
        let header: Vec<u64> = lines.numbers(4, "the numbers of node blocks and nodes")?;
        for _ in 0..header[0] {
            let block: Vec<i64> = lines.numbers(4, "a node block: dimension, tag, parametric, count")?;
            let mut tags = Vec::new();
            for _ in 0..block[3] {
                tags.push(lines.numbers::<u64>(1, "a node tag")?[0]);
            }
            for tag in tags {
                let x: Vec<f64> = lines.numbers(3, "the coordinates of a node")?;
                if x[..2].iter().any(|&v| COORDINATE.check(v).is_err()) {
                    return Err(lines.error("coordinates within 1e6 m"));
                }
                if x[2] != 0.0 {
                    return Err(lines.error("a mesh in the plane z = 0"));
                }
                self.nodes.insert(tag, Vector2::new(x[0], x[1]));
            }
        }
        Ok(())
    }

    fn read_elements(&mut self, lines: &mut Lines<'_>) -> Result<(), GmshError> {
        let header: Vec<u64> = lines.numbers(4, "the numbers of element blocks and elements")?;
        for _ in 0..header[0] {
            let block: Vec<i64> = lines.numbers(4, "an element block: dimension, tag, type, count")?;
            let kinds = [LINE_2, TRIANGLE_3, LINE_3, TRIANGLE_6, POINT];
            let (kind, nodes) = kinds
                .into_iter()
                .find(|k| i64::from(k.0) == block[2])
                .ok_or_else(|| lines.error("lines and triangles of 2, 3 or 6 nodes (element types 1, 2, 8, 9)"))?;
            for _ in 0..block[3] {
                let element: Vec<u64> = lines.numbers(1 + nodes, "an element: tag, nodes")?;
                let element = element[1..=nodes].to_vec();
                if kind == TRIANGLE_3.0 || kind == TRIANGLE_6.0 {
                    self.triangles.push((lines.number, element));
                } else if kind != POINT.0 {
                    self.lines.push((block[1], element));
                }
            }
        }
        Ok(())
    }

    fn into_mesh(self, element: ElementKind) -> Result<Mesh, GmshError> {
        if self.triangles.is_empty() {
            return Err(GmshError::Content("expected triangles, got none".to_owned()));
        }
        TOTAL_CELLS
            .check(0.5 * self.triangles.len() as f64)
            .map_err(|_| GmshError::Content(format!("expected at most {} triangles", 2.0 * TOTAL_CELLS.max)))?;
        // Only the nodes of triangles: what else the file holds would be free to float away.
        let mut builder =
            Builder { tags: &self.nodes, numbers: HashMap::new(), nodes: Vec::new(), middles: Middles::default() };
        let mut connectivity = Vec::new();
        for (line, triangle) in &self.triangles {
            let missing =
                |tag: u64| GmshError::Syntax { line: *line, expected: format!("nodes that exist, got {tag}") };
            let mut numbers = Vec::with_capacity(6);
            for &tag in triangle {
                numbers.push(builder.number(tag).ok_or_else(|| missing(tag))?);
            }
            connectivity.extend(&numbers[..3]);
            if element.degree() == 2 {
                for side in 0..3 {
                    let ends = [numbers[side], numbers[(side + 1) % 3]];
                    let own = numbers.get(3 + side).copied();
                    connectivity.push(own.unwrap_or_else(|| builder.middle(ends)));
                }
            }
        }
        if element.degree() == 1 {
            // The middle nodes belong to no element now.
            let triangles = &mut connectivity;
            let mut kept = vec![u32::MAX; builder.nodes.len()];
            let mut nodes = Vec::new();
            for node in triangles.iter_mut() {
                let slot = &mut kept[*node as usize];
                if *slot == u32::MAX {
                    *slot = nodes.len() as u32;
                    nodes.push(builder.nodes[*node as usize]);
                }
                *node = *slot;
            }
            builder.nodes = nodes;
            builder.numbers = builder
                .numbers
                .iter()
                .map(|(&tag, &number)| (tag, kept[number as usize]))
                .filter(|&(_, number)| number != u32::MAX)
                .collect();
        }
        let mut edges: BTreeMap<String, Vec<Segment>> = BTreeMap::new();
        for (entity, line) in &self.lines {
            let ends = [line[0], line[1]].map(|tag| builder.numbers.get(&tag).copied());
            let [Some(a), Some(b)] = ends else { continue };
            let middle = (element.degree() == 2).then(|| match line.get(2) {
                Some(&tag) => builder.number(tag).unwrap_or_else(|| builder.middle([a, b])),
                None => builder.middle([a, b]),
            });
            for tag in self.curve_groups.get(entity).into_iter().flatten() {
                let name = self.curve_names.get(&tag.abs()).cloned().unwrap_or_else(|| tag.abs().to_string());
                edges.entry(name).or_default().push(Segment { ends: [a, b], middle });
            }
        }
        Ok(Mesh::new(builder.nodes, element, connectivity, edges)?)
    }
}

/// Numbers nodes in the order they are met, and makes the middle nodes that the file lacks.
struct Builder<'a> {
    tags: &'a HashMap<u64, Vector2<f64>>,
    numbers: HashMap<u64, u32>,
    nodes: Vec<Vector2<f64>>,
    middles: Middles,
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

    fn middle(&mut self, ends: [u32; 2]) -> u32 {
        self.middles.between(&mut self.nodes, ends, |nodes| {
            let [a, b] = ends.map(|n| nodes[n as usize]);
            (a + b) * 0.5
        })
    }
}
