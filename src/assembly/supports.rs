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

/// Refuses to look for the equilibrium of a body that is not held; in motion it may be free.
pub(super) fn check_held(held: bool, analysis: Analysis) -> Result<(), Invalid> {
    if held || analysis == Analysis::Dynamic {
        return Ok(());
    }
    Err(Invalid::new(
        "support",
        "expected supports that hold the body in both directions and against turning: it can still move freely",
    ))
}

/// Whether the fixed unknowns leave no translation and no small rotation: the Gram matrix of the three rigid modes,
/// restricted to them, is regular.
pub(super) fn is_held(mesh: &Mesh, fixed: &[bool]) -> bool {
    const SINGULAR: f64 = 1e-12;
    let nodes = || mesh.nodes().iter().zip(fixed.chunks_exact(2)).filter(|(_, fixed)| fixed.contains(&true));
    // Seen from the fixed nodes themselves: a clamp stays a clamp however long the body.
    let count = nodes().count();
    if count == 0 {
        return false;
    }
    let centre = nodes().map(|(x, _)| x).sum::<Vector2<f64>>() / count as f64;
    let size = nodes().map(|(x, _)| (x - centre).norm()).fold(0.0, f64::max);
    if size == 0.0 {
        return false;
    }
    let mut gram = Matrix3::zeros();
    for (node, fixed) in nodes() {
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
