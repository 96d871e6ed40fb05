//! The unknowns that supports fix.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::edge::no_such_edge;
use crate::mesh::Mesh;
use crate::scene::{Analysis, Axis, Invalid, Place, Support};

/// The unknowns (2 · node + axis) that supports fix.
pub(super) fn fixed_unknowns(supports: &[Support], mesh: &Mesh) -> Result<Vec<bool>, Invalid> {
    let mut fixed = vec![false; 2 * mesh.nodes().len()];
    for (i, support) in supports.iter().enumerate() {
        let nodes = match &support.place {
            Place::Edge(name) => {
                mesh.edge_nodes(name).ok_or_else(|| no_such_edge(mesh, name, &format!("support.{i}")))?
            }
            Place::At(at) => vec![mesh.nearest_node((*at).into())],
        };
        for node in nodes {
            for axis in &support.fix {
                let axis = match axis {
                    Axis::X => 0,
                    Axis::Y => 1,
                };
                fixed[2 * node as usize + axis] = true;
            }
        }
    }
    if fixed.iter().all(|&f| f) {
        return Err(Invalid::new("support", "expected some node that can move, got supports that fix them all"));
    }
    Ok(fixed)
}

/// How the supports hold a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hold {
    /// Parts that share no nodes.
    parts: usize,
    /// Those of them that can still move freely.
    loose: usize,
}

/// Refuses to look for the equilibrium of a body that is not held; in motion it may be free.
pub(super) fn check_held(hold: Hold, analysis: Analysis) -> Result<(), Invalid> {
    if hold.loose == 0 || analysis == Analysis::Dynamic {
        return Ok(());
    }
    if hold.parts > 1 {
        let Hold { parts, loose } = hold;
        let message = format!(
            "expected one connected body, got {parts} parts that share no nodes; supports leave {loose} of them free to move"
        );
        return Err(Invalid::new("mesh", message));
    }
    Err(Invalid::new(
        "support",
        "expected supports that hold the body in both directions and against turning: it can still move freely",
    ))
}

impl Hold {
    pub(super) fn of(mesh: &Mesh, fixed: &[bool]) -> Self {
        let (parts, part_of) = mesh.parts();
        let mut held_nodes = vec![Vec::new(); parts];
        for ((x, fixed), &part) in mesh.nodes().iter().zip(fixed.chunks_exact(2)).zip(&part_of) {
            // Nodes without an element are in no part.
            if let (true, Some(nodes)) = (fixed.contains(&true), held_nodes.get_mut(part as usize)) {
                nodes.push((*x, fixed));
            }
        }
        Self { parts, loose: held_nodes.iter().filter(|nodes| !is_held(nodes)).count() }
    }
}

/// Whether the fixed unknowns of these nodes leave no translation and no small rotation: the Gram matrix of the three
/// rigid modes, restricted to them, is regular.
fn is_held(nodes: &[(Vector2<f64>, &[bool])]) -> bool {
    const SINGULAR: f64 = 1e-12;
    // Seen from the fixed nodes themselves: a clamp stays a clamp however long the body.
    if nodes.is_empty() {
        return false;
    }
    let centre = nodes.iter().map(|(x, _)| x).sum::<Vector2<f64>>() / nodes.len() as f64;
    let size = nodes.iter().map(|(x, _)| (x - centre).norm()).fold(0.0, f64::max);
    if size == 0.0 {
        return false;
    }
    let mut gram = Matrix3::zeros();
    for (node, fixed) in nodes {
        let arm = (node - centre) / size;
        for (axis, mode) in [Vector3::new(1.0, 0.0, -arm.y), Vector3::new(0.0, 1.0, arm.x)].iter().enumerate() {
            if fixed[axis] {
                gram += mode * mode.transpose();
            }
        }
    }
    let eigenvalues = gram.symmetric_eigenvalues();
    eigenvalues.min() > SINGULAR * eigenvalues.max()
}
