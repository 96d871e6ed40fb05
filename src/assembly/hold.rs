//! Unknowns fixed by supports, and remaining rigid motions.

use nalgebra::{DMatrix, Matrix3, Vector2, Vector3};

use super::edge::{no_such_edge, node_at};
use super::held_points::{HeldPoint, axes};
use crate::format::number;
use crate::mesh::Mesh;
use crate::scene::{Analysis, Invalid, Place, Support};
use crate::sentence::sentence;

/// Returns the unknowns (2 · node + axis) that supports on nodes fix: `true` for fixed ones. The other supports hold
/// `points` between nodes.
pub(super) fn fixed_unknowns(supports: &[Support], mesh: &Mesh, points: &[HeldPoint]) -> Result<Vec<bool>, Invalid> {
    let mut fixed = vec![false; 2 * mesh.nodes().len()];
    let is_on_nodes = |i: usize| points.iter().all(|point| point.support != i);
    for (i, support) in supports.iter().enumerate().filter(|(i, _)| is_on_nodes(*i)) {
        for node in nodes_of(support, mesh, &format!("support.{i}"))? {
            for (fixed, fixes) in fixed[2 * node as usize..].iter_mut().zip(axes(support)) {
                *fixed |= fixes;
            }
        }
    }
    Ok(fixed)
}

/// Returns the nodes of a support on nodes; `key` is its table in the scene.
pub(super) fn nodes_of(support: &Support, mesh: &Mesh, key: &str) -> Result<Vec<u32>, Invalid> {
    match &support.place {
        Place::Edge(name) => mesh.edge_nodes(name).ok_or_else(|| no_such_edge(mesh, name, key)),
        Place::At(at) => Ok(vec![node_at(mesh, *at, key)?]),
    }
}

/// Rigid motions that the supports leave to a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hold {
    /// Number of parts that share no nodes.
    parts: usize,
    /// Number of parts that can still move freely.
    loose: usize,
    /// Hinge node about which a part can rotate.
    hinge: Option<u32>,
}

/// Rejects a static scene whose body can move freely; dynamic scenes are not restricted.
pub(super) fn check_held(hold: Hold, mesh: &Mesh, analysis: Analysis) -> Result<(), Invalid> {
    if analysis == Analysis::Dynamic {
        return Ok(());
    }
    if let (0, Some(node)) = (hold.loose, hold.hinge) {
        let (x, name) = (mesh.node(node), mesh.node_name(node));
        let message = format!(
            "expected elements that share sides, got a part that is connected only at node {} at ({}, {}) and can \
             rotate about it",
            name.map_or_else(|| "?".to_owned(), |name| name.to_string()),
            number(x.x),
            number(x.y)
        );
        return Err(Invalid::new("mesh", message));
    }
    if hold.loose == 0 {
        return Ok(());
    }
    if hold.parts > 1 {
        let Hold { parts, loose, .. } = hold;
        let mut message = format!(
            "expected one connected body, got {parts} parts that share no nodes; supports leave {loose} of them free to move"
        );
        mesh.seams().iter().for_each(|seam| message += &format!("; {seam}"));
        return Err(Invalid::new("mesh", message));
    }
    let message = sentence!(
        "expected supports that prevent translation along both axes and rotation: the body can still move freely"
    );
    Err(Invalid::new("support", message))
}

impl Hold {
    /// Determines the rigid motions; `is_grid` for a rectangle of cells, which has no hinges.
    pub(super) fn of(mesh: &Mesh, fixed: &[bool], points: &[HeldPoint], is_grid: bool) -> Self {
        let (parts, part_of) = mesh.parts();
        let mut held_nodes = vec![Vec::new(); parts];
        for point in points {
            // All nodes of an element are in one part.
            let part = point.weights.first().and_then(|&(node, _)| part_of.get(node as usize));
            if let Some(nodes) = part.and_then(|&part| held_nodes.get_mut(part as usize)) {
                nodes.push((point.at, point.axes.as_slice()));
            }
        }
        for ((x, fixed), &part) in mesh.nodes().iter().zip(fixed.chunks_exact(2)).zip(&part_of) {
            // Nodes without an element are in no part.
            if let (true, Some(nodes)) = (fixed.contains(&true), held_nodes.get_mut(part as usize)) {
                nodes.push((*x, fixed));
            }
        }
        let loose = held_nodes.iter().filter(|nodes| !is_held(nodes)).count();
        let hinged = if is_grid { None } else { mesh.hinged_parts() };
        let hinge = hinged.and_then(|(parts, of_node)| loose_hinge(mesh, fixed, points, parts, &of_node));
        Self { parts, loose, hinge }
    }
}

/// Returns the hinge between parts that can move relative to each other although supports hold the body: the Gram
/// matrix of the constraints of supports and hinges on the parts' rigid motions is singular. Of the nodes at which
/// parts meet, returns the one about which they rotate most.
fn loose_hinge(mesh: &Mesh, fixed: &[bool], points: &[HeldPoint], parts: usize, of_node: &[Vec<u32>]) -> Option<u32> {
    const SINGULAR: f64 = 1e-10;
    let (low, high) = mesh.bounds();
    let (centre, size) = ((low + high) * 0.5, (high - low).norm());
    // Displacements of a point by the two translations and the rotation of a part.
    let modes = |at: Vector2<f64>| {
        let arm = (at - centre) / size;
        [Vector3::new(1.0, 0.0, -arm.y), Vector3::new(0.0, 1.0, arm.x)]
    };
    let mut gram = DMatrix::<f64>::zeros(3 * parts, 3 * parts);
    let mut add = |terms: &[(u32, f64)], mode: &Vector3<f64>| {
        for &(a, x) in terms {
            for &(b, y) in terms {
                let mut block = gram.fixed_view_mut::<3, 3>(3 * a as usize, 3 * b as usize);
                block += mode * mode.transpose() * (x * y);
            }
        }
    };
    for (node, own) in of_node.iter().enumerate() {
        for (axis, mode) in modes(mesh.nodes()[node]).iter().enumerate() {
            if let (Some(&first), true) = (own.first(), fixed[2 * node + axis]) {
                add(&[(first, 1.0)], mode);
            }
            for &other in own.iter().skip(1) {
                add(&[(own[0], 1.0), (other, -1.0)], mode);
            }
        }
    }
    for point in points {
        // A node at which parts meet belongs to several of them; the element of the point is in the one common to its nodes.
        let of = |&(node, _): &(u32, f64)| of_node[node as usize].as_slice();
        let own = point.weights.first().into_iter().flat_map(of);
        let common = own.copied().find(|part| point.weights.iter().all(|weight| of(weight).contains(part)));
        for (mode, _) in modes(point.at).iter().zip(point.axes).filter(|(_, held)| *held) {
            if let Some(part) = common {
                add(&[(part, 1.0)], mode);
            }
        }
    }
    let eigen = gram.symmetric_eigen();
    let (least, value) = eigen.eigenvalues.argmin();
    if value > SINGULAR * eigen.eigenvalues.max() {
        return None;
    }
    let motion = eigen.eigenvectors.column(least);
    let turns = |node: &usize| {
        let rotations = of_node[*node].iter().map(|&part| motion[3 * part as usize + 2]);
        let (low, high) = rotations.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| (l.min(r), h.max(r)));
        high - low
    };
    let hinges = (0..of_node.len()).filter(|&node| of_node[node].len() > 1);
    hinges.max_by(|a, b| turns(a).total_cmp(&turns(b))).map(|node| node as u32)
}

/// Returns `true` if the fixed unknowns of these nodes leave no translation and no small rotation: the Gram matrix of
/// the three rigid modes, restricted to them, is regular.
fn is_held(nodes: &[(Vector2<f64>, &[bool])]) -> bool {
    const SINGULAR: f64 = 1e-12;
    // Relative to the fixed nodes themselves, so that the result does not depend on the length of the body.
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
