//! A scene as equations: the mesh's elements, the free unknowns, the sparsity of A = Σ R Ke Rᵀ, and the loads.
//!
//! Everything here is found once; each frame refills numbers and allocates nothing.

use nalgebra::Vector2;

use crate::element::{GeometricShare, QuadraturePoint, t3, t6};
use crate::material::Lame;
use crate::mesh::Mesh;
use crate::rotation::Rotation;
use crate::scene::{ElementKind, Invalid, Material, Scene};

mod boundary;
mod elements;
mod moment;
mod pattern;

pub use boundary::NodalProbe;
pub use elements::{Elements, StrainVisitor};
pub use moment::EdgeMoment;
pub use pattern::Pattern;

/// The discrete problem of a scene.
#[derive(Debug)]
pub struct System {
    /// Rest mesh.
    pub mesh: Mesh,
    /// Material of the whole body.
    pub material: Material,
    /// Its Lamé constants, Pa.
    pub lame: Lame,
    /// The loops over elements.
    pub elements: Box<dyn Elements>,
    /// Free unknowns and sparsity.
    pub pattern: Pattern,
    /// Nodal force of the dead loads, N.
    pub dead_force: Vec<Vector2<f64>>,
    /// Moments that turn with their edges.
    pub moments: Vec<EdgeMoment>,
    /// What is measured.
    pub probes: Vec<NodalProbe>,
    /// Size of the body at rest: the diagonal of the box around it, m.
    pub size: f64,
}

impl System {
    /// Meshes a scene and sets up its equations. The scene is validated first.
    ///
    /// # Errors
    /// The key that is wrong and what was expected there.
    pub fn new(scene: &Scene) -> Result<Self, Invalid> {
        scene.validate()?;
        let mesh = match (&scene.beam, &scene.mesh) {
            (Some(beam), _) => Mesh::beam(beam).map_err(|e| Invalid::new("beam", e.to_string()))?,
            (None, Some(mesh)) => Mesh::from_gmsh(&mesh.text, mesh.element)
                .map_err(|e| Invalid::new("mesh.file", format!("{}: {e}", mesh.file)))?,
            (None, None) => return Err(Invalid::new("beam", "expected [beam] or [mesh], got neither")),
        };
        Self::with_mesh(scene, mesh)
    }

    /// [`Self::new`] on another mesh than the scene's own, which has the edges that the scene names.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_mesh(scene: &Scene, mesh: Mesh) -> Result<Self, Invalid> {
        let held = boundary::held_unknowns(scene, &mesh)?;
        let moments = boundary::moments(scene, &mesh)?;
        let groups: Vec<Vec<u32>> = moments.iter().map(|m| m.weights.iter().map(|&(node, _)| node).collect()).collect();
        let pattern = Pattern::new(&mesh, &held, &groups);
        let elements = elements_of(&mesh, scene.material.thickness, &pattern)?;
        let dead_force = boundary::dead_force(scene, &mesh, elements.as_ref())?;
        let probes = boundary::probes(scene, &mesh)?;
        let (low, high) = mesh.bounds();
        Ok(Self {
            size: (high - low).norm(),
            material: scene.material,
            lame: scene.material.lame(),
            mesh,
            elements,
            pattern,
            dead_force,
            moments,
            probes,
        })
    }

    /// Number of free unknowns.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.pattern.dofs()
    }

    /// A nodal vector's free components.
    pub fn restrict(&self, nodal: &[Vector2<f64>], free: &mut [f64]) {
        for (value, &unknown) in free.iter_mut().zip(&self.pattern.free) {
            *value = nodal[unknown as usize / 2][unknown as usize % 2];
        }
    }

    /// Adds a vector over the free unknowns to a nodal one. What supports hold does not move.
    pub fn add_free(&self, free: &[f64], nodal: &mut [Vector2<f64>]) {
        for (value, &unknown) in free.iter().zip(&self.pattern.free) {
            nodal[unknown as usize / 2][unknown as usize % 2] += value;
        }
    }

    /// The values of A = Σ R Ke Rᵀ over the free unknowns (article eq. 2), lower triangle, N/m. `values` has one slot
    /// more than the pattern has entries.
    pub fn stiffness(&self, r: &[Rotation], values: &mut [f64]) {
        values.fill(0.0);
        self.elements.stiffness(self.lame, r, values);
    }

    /// Adds G to the values of [`Self::stiffness`]: all of it makes the exact Hessian of the elastic energy.
    pub fn add_geometric_stiffness(
        &self,
        u: &[Vector2<f64>],
        r: &[Rotation],
        share: GeometricShare,
        values: &mut [f64],
    ) {
        self.elements.geometric_stiffness(self.lame, u, r, share, values);
    }

    /// Adds the Hessian of the moments' potential at this load factor.
    pub fn add_load_stiffness(&self, u: &[Vector2<f64>], factor: f64, values: &mut [f64]) {
        for moment in &self.moments {
            moment.add_stiffness(&self.mesh, u, factor, &self.pattern, values);
        }
    }

    /// The external nodal force f_ext at this load factor, N.
    pub fn external_force(&self, u: &[Vector2<f64>], factor: f64, force: &mut [Vector2<f64>]) {
        for (f, dead) in force.iter_mut().zip(&self.dead_force) {
            *f = dead * factor;
        }
        for moment in &self.moments {
            moment.add_force(&self.mesh, u, factor, force);
        }
    }

    /// Potential of the loads relative to rest, at this load factor, J.
    #[must_use]
    pub fn load_potential(&self, u: &[Vector2<f64>], factor: f64) -> f64 {
        let dead: f64 = self.dead_force.iter().zip(u).map(|(f, u)| -f.dot(u)).sum();
        factor * (dead + self.moments.iter().map(|m| m.potential(&self.mesh, u)).sum::<f64>())
    }

    /// The warped force f_int = Σ R Ke (Rᵀ x − X) and the sum of its elements' absolute values, N.
    ///
    /// It is A x − R K X, the article's system (eq. 2) with everything on one side; written with the strain, so that it
    /// vanishes exactly at rest.
    pub fn internal_force(
        &self,
        u: &[Vector2<f64>],
        r: &[Rotation],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
    ) {
        force.fill(Vector2::zeros());
        magnitude.fill(Vector2::zeros());
        self.elements.internal_force(self.lame, u, r, force, magnitude);
    }

    /// The article's force offset R K X, N: minus the warped force of a body whose nodes all sit at the origin.
    pub fn force_offset(&self, r: &[Rotation], offset: &mut [Vector2<f64>]) {
        let mut magnitude = vec![Vector2::zeros(); offset.len()];
        let collapsed: Vec<Vector2<f64>> = self.mesh.nodes.iter().map(|x| -x).collect();
        self.internal_force(&collapsed, r, offset, &mut magnitude);
        offset.iter_mut().for_each(|f| *f = -*f);
    }
}

fn elements_of(mesh: &Mesh, thickness: f64, pattern: &Pattern) -> Result<Box<dyn Elements>, Invalid> {
    match mesh.element {
        ElementKind::T3 => element_set(mesh, pattern, |x| Some(t3::quadrature(x, thickness))),
        ElementKind::T6 => element_set(mesh, pattern, |x| t6::quadrature(x, thickness)),
    }
}

fn element_set<const N: usize, const Q: usize>(
    mesh: &Mesh,
    pattern: &Pattern,
    quadrature: impl Fn([Vector2<f64>; N]) -> Option<[QuadraturePoint<N>; Q]>,
) -> Result<Box<dyn Elements>, Invalid> {
    let mut nodes = Vec::with_capacity(mesh.triangle_count());
    let mut points = Vec::with_capacity(Q * mesh.triangle_count());
    for (number, triangle) in mesh.triangles().enumerate() {
        let mut element = [0; N];
        element.copy_from_slice(triangle);
        let folded = || Invalid::new("mesh", format!("triangle {number} folds over: expected its sides less curved"));
        points.extend(quadrature(element.map(|n| mesh.nodes[n as usize])).ok_or_else(folded)?);
        nodes.push(element);
    }
    Ok(Box::new(elements::ElementSet::new(nodes, points, Q, pattern)))
}
