//! A scene as equations: the mesh's elements, the free unknowns, the sparsity of A = Σ R Ke Rᵀ, and the loads.
//!
//! Everything here is found once; each frame refills numbers and allocates nothing.

use nalgebra::Vector2;

use crate::element::t3;
use crate::material::Lame;
use crate::mesh::Mesh;
use crate::rotation::Rotation;
use crate::scene::{ElementKind, Invalid, Material, Scene};

mod boundary;
mod elements;
mod pattern;

pub use boundary::NodalProbe;
pub use elements::{Elements, StrainVisitor};
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
    /// External nodal force f_ext, N.
    pub external_force: Vec<Vector2<f64>>,
    /// What is measured.
    pub probes: Vec<NodalProbe>,
}

impl System {
    /// Meshes a scene and sets up its equations. The scene is validated first.
    ///
    /// # Errors
    /// The key that is wrong and what was expected there.
    pub fn new(scene: &Scene) -> Result<Self, Invalid> {
        scene.validate()?;
        Self::with_mesh(scene, Mesh::beam(&scene.beam).map_err(|e| Invalid::new("beam", e.to_string()))?)
    }

    /// [`Self::new`] on another mesh than the scene's own, which has the edges that the scene names.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_mesh(scene: &Scene, mesh: Mesh) -> Result<Self, Invalid> {
        let held = boundary::held_unknowns(scene, &mesh)?;
        let external_force = boundary::external_force(scene, &mesh)?;
        let probes = boundary::probes(scene, &mesh)?;
        let pattern = Pattern::new(&mesh, &held);
        let elements = elements_of(&mesh, scene.material.thickness, &pattern);
        Ok(Self {
            material: scene.material,
            lame: scene.material.lame(),
            mesh,
            elements,
            pattern,
            external_force,
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

fn elements_of(mesh: &Mesh, thickness: f64, pattern: &Pattern) -> Box<dyn Elements> {
    match mesh.element {
        ElementKind::T3 => {
            let nodes: Vec<[u32; 3]> = mesh.triangles().map(|t| [t[0], t[1], t[2]]).collect();
            let points = nodes.iter().flat_map(|t| t3::quadrature(t.map(|n| mesh.nodes[n as usize]), thickness));
            Box::new(elements::ElementSet::new(nodes.clone(), points.collect(), 1, pattern))
        }
    }
}
