//! Supports, loads and probes of a scene, put on the nodes of its mesh.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::elements::Elements;
use super::moment::EdgeMoment;
use crate::element::side_weights;
use crate::mesh::Mesh;
use crate::scene::{Axis, Invalid, Load, Place, Scene};

/// A probe as weights on nodes; the weights sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalProbe {
    /// What it is called.
    pub name: String,
    /// The edge it averages over, if it is one.
    pub edge: Option<String>,
    /// Node and weight.
    pub weights: Vec<(u32, f64)>,
}

impl NodalProbe {
    /// Whether it looks at the right edge, where beam theories know the truth.
    #[must_use]
    pub fn is_at_tip(&self) -> bool {
        self.edge.as_deref() == Some("right")
    }

    /// The weighted mean of a nodal field.
    #[must_use]
    pub fn mean(&self, field: &[Vector2<f64>]) -> Vector2<f64> {
        self.weights.iter().map(|&(node, weight)| field[node as usize] * weight).sum()
    }
}

/// The unknowns (2 · node + axis) that supports hold.
pub(super) fn held_unknowns(scene: &Scene, mesh: &Mesh) -> Result<Vec<bool>, Invalid> {
    let mut held = vec![false; 2 * mesh.nodes.len()];
    for (i, support) in scene.supports.iter().enumerate() {
        let key = format!("support.{i}");
        let nodes = match support.place().map_err(|message| Invalid::new(&key, message))? {
            Place::Edge(name) => edge_nodes(mesh, &name, &key)?,
            Place::At(at) => vec![mesh.nearest_node(at.into())],
        };
        for node in nodes {
            for axis in &support.fix {
                let axis = match axis {
                    Axis::X => 0,
                    Axis::Y => 1,
                };
                held[2 * node as usize + axis] = true;
            }
        }
    }
    if held.iter().all(|&h| h) {
        return Err(Invalid::new("support", "expected some node that can move, got supports that hold them all"));
    }
    if free_rigid_motion(mesh, &held) {
        return Err(Invalid::new(
            "support",
            "expected supports that hold the body in both directions and against turning: it can still move freely",
        ));
    }
    Ok(held)
}

/// Whether a translation or a small rotation is left by the held unknowns: the Gram matrix of the three rigid modes,
/// restricted to them, is singular.
fn free_rigid_motion(mesh: &Mesh, held: &[bool]) -> bool {
    const SINGULAR: f64 = 1e-12;
    let nodes = || mesh.nodes.iter().zip(held.chunks_exact(2)).filter(|(_, held)| held.contains(&true));
    // Seen from the held nodes themselves: a clamp stays a clamp however long the body.
    let count = nodes().count();
    if count == 0 {
        return true;
    }
    let centre = nodes().map(|(x, _)| x).sum::<Vector2<f64>>() / count as f64;
    let size = nodes().map(|(x, _)| (x - centre).norm()).fold(0.0, f64::max);
    if size == 0.0 {
        return true;
    }
    let mut gram = Matrix3::zeros();
    for (node, held) in nodes() {
        let arm = (node - centre) / size;
        for (axis, mode) in [Vector3::new(1.0, 0.0, -arm.y), Vector3::new(0.0, 1.0, arm.x)].iter().enumerate() {
            if held[axis] {
                gram += mode * mode.transpose();
            }
        }
    }
    let eigenvalues = gram.symmetric_eigenvalues();
    eigenvalues.min() <= SINGULAR * eigenvalues.max()
}

/// The nodal forces of all dead loads, N.
pub(super) fn dead_force(scene: &Scene, mesh: &Mesh, elements: &dyn Elements) -> Result<Vec<Vector2<f64>>, Invalid> {
    let mut f = vec![Vector2::zeros(); mesh.nodes.len()];
    for (i, load) in scene.loads.iter().enumerate() {
        match load {
            Load::Force { place: Place::At(at), force } => {
                f[mesh.nearest_node((*at).into()) as usize] += Vector2::from(*force);
            }
            Load::Force { place: Place::Edge(name), force } => {
                for (node, weight) in edge_weights(mesh, name, &format!("load.{i}"))? {
                    f[node as usize] += Vector2::from(*force) * weight;
                }
            }
            Load::Gravity { acceleration } => {
                elements.body_force(Vector2::from(*acceleration) * scene.material.density, &mut f);
            }
            Load::Moment { .. } => {}
        }
    }
    Ok(f)
}

/// The moments on edges.
pub(super) fn moments(scene: &Scene, mesh: &Mesh) -> Result<Vec<EdgeMoment>, Invalid> {
    let mut moments = Vec::new();
    for (i, load) in scene.loads.iter().enumerate() {
        if let Load::Moment { edge, moment } = load {
            let key = format!("load.{i}");
            let weights = edge_weights(mesh, edge, &key)?;
            let edge_moment = EdgeMoment::new(mesh, &weights, *moment).ok_or_else(|| {
                Invalid::new(format!("{key}.edge"), format!("expected a straight edge, got \"{edge}\", which is not"))
            })?;
            moments.push(edge_moment);
        }
    }
    Ok(moments)
}

/// The scene's probes on this mesh.
pub(super) fn probes(scene: &Scene, mesh: &Mesh) -> Result<Vec<NodalProbe>, Invalid> {
    let probe = |(i, probe): (usize, &crate::scene::Probe)| {
        let key = format!("probe.{i}");
        let weights = match probe.place().map_err(|message| Invalid::new(&key, message))? {
            Place::Edge(name) => edge_weights(mesh, &name, &key)?,
            Place::At(at) => material_point(mesh, at.into()).ok_or_else(|| {
                Invalid::new(format!("{key}.at"), format!("expected a point of the body, got {at:?} outside it"))
            })?,
        };
        Ok(NodalProbe { name: probe.name.clone(), edge: probe.edge.clone(), weights })
    };
    scene.probes.iter().enumerate().map(probe).collect()
}

fn no_such_edge(mesh: &Mesh, name: &str, key: &str) -> Invalid {
    let known: Vec<&str> = mesh.edges.keys().map(String::as_str).collect();
    Invalid::new(format!("{key}.edge"), format!("expected one of {}, got \"{name}\"", known.join(", ")))
}

fn edge_nodes(mesh: &Mesh, name: &str, key: &str) -> Result<Vec<u32>, Invalid> {
    mesh.edge_nodes(name).ok_or_else(|| no_such_edge(mesh, name, key))
}

/// Nodes of an edge with their share of a uniform traction: ∫ Nₐ ds over the edge's length. The shares sum to 1.
fn edge_weights(mesh: &Mesh, name: &str, key: &str) -> Result<Vec<(u32, f64)>, Invalid> {
    let segments = mesh.edges.get(name).ok_or_else(|| no_such_edge(mesh, name, key))?;
    let mut weights = std::collections::BTreeMap::new();
    let mut total = 0.0;
    for segment in segments {
        let position = |node: u32| mesh.nodes[node as usize];
        let shares = side_weights(segment.ends.map(position), segment.middle.map(position));
        for (node, share) in segment.nodes().zip(shares) {
            *weights.entry(node).or_insert(0.0) += share;
            total += share;
        }
    }
    Ok(weights.into_iter().map(|(node, weight)| (node, weight / total)).collect())
}

/// Nodes and shape functions of the triangle that holds a rest position; `None` outside the body.
fn material_point(mesh: &Mesh, at: Vector2<f64>) -> Option<Vec<(u32, f64)>> {
    // Points on the boundary must not fall out by rounding.
    const SLACK: f64 = 1e-9;
    // The map of a six-node triangle is inverted by Newton's method; straight sides take one step.
    const STEPS: u32 = 12;
    mesh.triangles().find_map(|triangle| {
        let mut l = Vector2::repeat(1.0 / 3.0);
        for _ in 0..STEPS {
            let at_l = [1.0 - l.x - l.y, l.x, l.y];
            let (shape, gradients) = (mesh.element.shape(at_l), mesh.element.local_gradients(at_l));
            let mut missing = at;
            let mut jacobian = nalgebra::Matrix2::zeros();
            for ((&node, n), g) in triangle.iter().zip(&shape).zip(&gradients) {
                let x = mesh.nodes[node as usize];
                missing -= x * *n;
                jacobian += x * g.transpose();
            }
            let step = jacobian.try_inverse()? * missing;
            l += step;
            if step.norm() < 1e-14 {
                break;
            }
        }
        let l = [1.0 - l.x - l.y, l.x, l.y];
        let inside = l.iter().all(|&v| v >= -SLACK);
        inside.then(|| triangle.iter().copied().zip(mesh.element.shape(l)).collect())
    })
}
