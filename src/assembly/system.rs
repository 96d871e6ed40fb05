//! Data computed once for a mesh and its supports, and shared by all solvers on it.

use std::sync::{Arc, OnceLock};

use nalgebra::Vector2;
use thiserror::Error;

use super::edge::no_such_edge;
use super::held_points::{HeldPoints, held_points};
use super::hold::{Hold, check_held, fixed_unknowns};
use super::{Edge, Kinematics, Pattern};
use crate::element::ElementLoops;
use crate::mesh::{Mesh, Recovery};
use crate::rotation::Rotation;
use crate::scene::{Beam, Invalid, Load, MeshFile, Scene, Support};
use crate::sentence::{Sentence, sentence};
use crate::solver::{SolverError, Symbolic};
use crate::state::{State, StateError};

/// Reason why a scene cannot be simulated.
///
/// ```
/// use warpbeam::{Scene, Simulation, SimulationError, SolverError};
///
/// let scene = Scene::beam(10.0, 1.0).clamp("left").force("tip", [0.0, -1.0]); // the edge is called `right`
/// let advice = match Simulation::new(&scene).unwrap_err() {
///     SimulationError::Scene(invalid) => format!("edit {}", invalid.key),
///     SimulationError::TooLarge { .. } | SimulationError::Solver(SolverError::TooLarge) => {
///         "use fewer cells".to_owned()
///     }
///     other => other.to_string(),
/// };
/// assert_eq!(advice, "edit load.0.edge");
/// ```
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum SimulationError {
    /// The scene has an invalid value, or names an edge or point that the mesh does not have.
    Scene(#[from] Invalid),
    /// The factor of the matrix does not fit in memory.
    TooLarge {
        /// Number of free unknowns.
        unknowns: usize,
    },
    /// Not enough memory.
    Solver(#[from] SolverError),
}

impl From<&SimulationError> for Sentence {
    fn from(error: &SimulationError) -> Self {
        match error {
            SimulationError::Scene(invalid) => invalid.into(),
            SimulationError::TooLarge { unknowns } => sentence!(
                "the factorization of %{n} unknowns does not fit in memory; use a coarser mesh",
                n = *unknowns
            ),
            SimulationError::Solver(error) => error.into(),
        }
    }
}

/// Origin of a mesh.
#[derive(Clone, Debug, PartialEq)]
enum Origin {
    /// Given by the caller; used for every scene solved on it.
    Given,
    Beam(Beam),
    File(MeshFile),
}

/// Mesh with derived data that does not depend on supports.
#[derive(Debug)]
struct MeshData {
    origin: Origin,
    mesh: Mesh,
    elements: ElementLoops,
    edges: Vec<Edge>,
    nodal_areas: Vec<f64>,
    /// Largest number of elements that share a node.
    valence: u32,
    /// Computed on first use.
    recovery: OnceLock<Recovery>,
    strip: OnceLock<[f64; 2]>,
    #[cfg(feature = "cli")]
    seams: OnceLock<Vec<Sentence>>,
    size: f64,
}

impl MeshData {
    fn new(origin: Origin, mesh: Mesh) -> Self {
        let entry = mesh.entry();
        let mut nodal_areas = vec![0.0; mesh.nodes().len()];
        let mut valences = vec![0; mesh.nodes().len()];
        for nodes in mesh.elements() {
            let rest: Vec<Vector2<f64>> = nodes.iter().map(|&n| mesh.node(n)).collect();
            for (&node, area) in nodes.iter().zip(entry.nodal_areas(&rest)) {
                nodal_areas[node as usize] += area;
                valences[node as usize] += 1;
            }
        }
        let (low, high) = mesh.bounds();
        Self {
            origin,
            elements: (entry.loops)(mesh.nodes(), mesh.connectivity()),
            edges: Edge::of(&mesh),
            nodal_areas,
            valence: valences.into_iter().max().unwrap_or(0),
            recovery: OnceLock::new(),
            strip: OnceLock::new(),
            #[cfg(feature = "cli")]
            seams: OnceLock::new(),
            size: (high - low).norm(),
            mesh,
        }
    }
}

/// Equations of a mesh with its supports, without numerical values: elements, free unknowns, sparsity, elimination
/// order. Computed once, and shared.
#[derive(Debug)]
pub struct System {
    body: Arc<MeshData>,
    supports: Vec<Support>,
    /// Equations of supports at points between nodes.
    pub(super) held: HeldPoints,
    /// Rigid motions that the supports leave.
    hold: Hold,
    /// Indices of edges whose nodes are coupled, for moments.
    coupled: Vec<usize>,
    pattern: Pattern,
    /// Computed on first use, as is the symbolic factorization.
    slots: OnceLock<Vec<u32>>,
    symbolic: OnceLock<Symbolic>,
}

impl System {
    /// Meshes a scene and sets up its equations. The scene is validated first.
    ///
    /// # Errors
    /// The invalid key and the expected value, or that the mesh is too large.
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        Self::for_display(scene)?.analysed()
    }

    /// Meshes a scene as [`Self::new`]; the sparsity of the factor is computed on first use.
    ///
    /// # Errors
    /// Same errors as [`Self::new`].
    pub fn for_display(scene: &Scene) -> Result<Self, SimulationError> {
        scene.validate()?;
        let origin = match (&scene.beam, &scene.mesh) {
            (Some(beam), _) => Origin::Beam(beam.clone()),
            (None, Some(file)) => Origin::File(file.clone()),
            (None, None) => Origin::Given,
        };
        Self::of_body(Arc::new(MeshData::new(origin, Self::mesh_of(scene)?)), scene)
    }

    /// Meshes a validated scene.
    ///
    /// # Errors
    /// The invalid key and the expected value.
    pub(crate) fn mesh_of(scene: &Scene) -> Result<Mesh, Invalid> {
        match (&scene.beam, &scene.mesh) {
            (Some(beam), _) => Mesh::beam(beam).map_err(|e| Invalid::new("beam", e.to_string())),
            (None, Some(file)) => {
                let failed =
                    |message: String| Invalid::new("mesh.file", Sentence::located(file.file.as_str(), message));
                let unread = "its contents were not loaded: open the scene from its folder".to_owned();
                let text = file.text.as_deref().ok_or_else(|| failed(unread))?;
                let element = file.element.or_else(|| Mesh::gmsh_element(text)).unwrap_or_default();
                let mesh = Mesh::from_gmsh_scaled(text, element, file.scale.unwrap_or(1.0));
                mesh.map_err(|e| failed(e.to_string()))
            }
            (None, None) => Err(Invalid::new("beam", "expected [beam] or [mesh], got neither")),
        }
    }

    /// Sets up the equations as [`Self::new`] on a given mesh, which must have the edges that the scene names. The
    /// scene's own `[beam]` or `[mesh]`, if any, is not read.
    ///
    /// # Errors
    /// Same errors as [`Self::new`].
    pub fn with_mesh(scene: &Scene, mesh: Mesh) -> Result<Self, SimulationError> {
        scene.validate_all_but_geometry(None)?;
        Self::of_body(Arc::new(MeshData::new(Origin::Given, mesh)), scene)?.analysed()
    }

    /// Returns the system of another scene: this one if it fits, one that shares its mesh if only supports differ or a
    /// moment needs more couplings, else a new one. A mesh given by the caller is always kept. Lists of the scene that are
    /// equal in a valid one are not checked again.
    ///
    /// # Errors
    /// Same errors as [`Self::new`].
    pub fn adapt(self: &Arc<Self>, scene: &Scene, valid: Option<&Scene>) -> Result<Arc<Self>, SimulationError> {
        let same_mesh = match &self.body.origin {
            Origin::Given => true,
            Origin::Beam(beam) => scene.beam.as_ref() == Some(beam) && scene.mesh.is_none(),
            Origin::File(file) => scene.mesh.as_ref() == Some(file) && scene.beam.is_none(),
        };
        if !same_mesh {
            return Ok(Arc::new(Self::new(scene)?));
        }
        scene.validate_all_but_geometry(valid)?;
        let couples = || moment_edges(&self.body.edges, scene).iter().all(|edge| self.coupled.contains(edge));
        let same_supports = scene.supports.len() == self.supports.len()
            && scene.supports.iter().zip(&self.supports).all(|(a, b)| a.fixes_as(b));
        if same_supports && couples() {
            check_held(self.hold, self.mesh(), scene.analysis)?;
            return Ok(self.clone());
        }
        Ok(Arc::new(Self::of_body(self.body.clone(), scene)?.analysed()?))
    }

    fn of_body(body: Arc<MeshData>, scene: &Scene) -> Result<Self, SimulationError> {
        let points = held_points(&scene.supports, &body.mesh);
        let fixed = fixed_unknowns(&scene.supports, &body.mesh, &points)?;
        let held = HeldPoints::solve(points, &fixed);
        if fixed.iter().filter(|&&fixed| !fixed).count() <= held.dependent.len() {
            let message = sentence!("expected at least one node that can move, got supports that fix every node");
            return Err(Invalid::new("support", message).into());
        }
        let is_grid = matches!(body.origin, Origin::Beam(_));
        let hold = Hold::of(&body.mesh, &fixed, &held.points, is_grid);
        check_held(hold, &body.mesh, scene.analysis)?;
        let coupled = moment_edges(&body.edges, scene);
        let groups: Vec<Vec<u32>> =
            coupled.iter().map(|&edge| body.edges[edge].weights.iter().map(|&(node, _)| node).collect()).collect();
        let pattern = Pattern::new(&body.mesh, &fixed, &held, &groups);
        let supports = scene.supports.clone();
        let (slots, symbolic) = (OnceLock::new(), OnceLock::new());
        Ok(Self { body, supports, held, hold, coupled, pattern, slots, symbolic })
    }

    /// Computes the symbolic factorization.
    fn analysed(self) -> Result<Self, SimulationError> {
        self.symbolic().map_err(|_| SimulationError::TooLarge { unknowns: self.pattern.dofs() })?;
        Ok(self)
    }

    /// Returns the rest mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.body.mesh
    }

    /// Returns the beam of which this is the mesh; `None` for other meshes.
    pub(crate) fn beam(&self) -> Option<&Beam> {
        match &self.body.origin {
            Origin::Beam(beam) => Some(beam),
            Origin::Given | Origin::File(_) => None,
        }
    }

    /// Returns the loops over the elements.
    pub fn elements(&self) -> &ElementLoops {
        &self.body.elements
    }

    /// Returns free unknowns and sparsity.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Returns sentences about places where the elements of a mesh that is not a beam's meet without sharing nodes.
    #[cfg(feature = "cli")]
    pub(crate) fn seams(&self) -> &[Sentence] {
        let find = || if self.beam().is_some() { Vec::new() } else { self.mesh().seams() };
        self.body.seams.get_or_init(find)
    }

    /// Returns sentences about held points whose reaction is 0 or depends on the mesh; `name` is the name of a support.
    #[cfg(feature = "cli")]
    pub(crate) fn crowded_supports(&self, name: impl Fn(usize) -> String) -> Vec<Sentence> {
        let fixed = |unknown: u32| self.pattern.fixed(unknown / 2)[unknown as usize % 2];
        let [redundant, close] = self.held.crowded(fixed);
        let redundant = redundant.into_iter().map(|support| {
            sentence!("%{support} holds a point that other supports hold: it has no reaction", support = name(support))
        });
        let close = close.into_iter().map(|support| {
            sentence!(
                "%{support} holds a point of an element that another support holds: its reaction depends on the mesh",
                support = name(support)
            )
        });
        redundant.chain(close).collect()
    }

    /// Returns the points between nodes that supports hold, for these positions of the nodes, m, with `true` for fixed
    /// components.
    #[cfg(feature = "app")]
    pub(crate) fn held_places(&self, positions: &[Vector2<f64>]) -> Vec<(Vector2<f64>, [bool; 2])> {
        let place = |weights: &[(u32, f64)]| {
            weights.iter().map(|&(node, weight)| Some(positions.get(node as usize)? * weight)).sum::<Option<_>>()
        };
        self.held.points.iter().filter_map(|point| Some((place(&point.weights)?, point.axes))).collect()
    }

    /// Returns the indices of every element's matrix entries; see [`crate::element::MatrixSum`].
    pub fn slots(&self) -> &[u32] {
        self.slots.get_or_init(|| self.mesh().elements().flat_map(|nodes| self.pattern.block_slots(nodes)).collect())
    }

    /// Returns the symbolic factorization.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn symbolic(&self) -> Result<&Symbolic, SolverError> {
        if let Some(symbolic) = self.symbolic.get() {
            return Ok(symbolic);
        }
        let symbolic = Symbolic::new(&self.pattern.column_starts, &self.pattern.row_indices)?;
        Ok(self.symbolic.get_or_init(|| symbolic))
    }

    /// Returns the named edges, by name.
    pub fn edges(&self) -> &[Edge] {
        &self.body.edges
    }

    /// Returns ∫ Nₐ dA of every node, m².
    pub fn nodal_areas(&self) -> &[f64] {
        &self.body.nodal_areas
    }

    /// Returns the largest number of elements that share a node.
    pub(super) fn valence(&self) -> u32 {
        self.body.valence
    }

    /// Returns the recovery matrix from quadrature points to nodes, computed on first use and shared.
    pub fn recovery(&self) -> &Recovery {
        self.body.recovery.get_or_init(|| Recovery::new(&self.body.mesh))
    }

    /// Returns the length and height, m, of the straight strip with the body's area and perimeter at rest: those of a
    /// beam, and approximately those of a bent or curved strip.
    pub fn strip(&self) -> [f64; 2] {
        *self.body.strip.get_or_init(|| {
            let mesh = self.mesh();
            let along =
                |nodes: &[u32]| nodes.windows(2).map(|w| (mesh.node(w[1]) - mesh.node(w[0])).norm()).sum::<f64>();
            let quarter = 0.25 * mesh.outline().iter().map(|side| along(side.nodes())).sum::<f64>();
            let area: f64 = self.nodal_areas().iter().sum();
            // A body with a smaller perimeter than a square of its area gets the size of the square.
            let apart = (quarter * quarter - area).max(0.0).sqrt();
            [quarter + apart, quarter - apart]
        })
    }

    /// Returns the size of the body at rest: the diagonal of its bounding box, m.
    pub fn size(&self) -> f64 {
        self.body.size
    }

    /// Returns the number of free unknowns.
    pub fn dofs(&self) -> usize {
        self.pattern.dofs()
    }

    /// Returns `true` if both have the same mesh, so that states of one are valid for the other.
    pub(crate) fn shares_mesh(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.body, &other.body)
    }

    /// Returns a named edge and its index; an error refers to the scene's table `key`.
    pub(super) fn edge(&self, name: &str, key: &str) -> Result<(usize, &Edge), Invalid> {
        let edges = self.body.edges.iter().enumerate();
        edges.into_iter().find(|(_, e)| e.name() == name).ok_or_else(|| no_such_edge(self.mesh(), name, key))
    }

    /// Returns the state at rest.
    pub fn at_rest(&self) -> State {
        State::at_rest(self.mesh().nodes().len(), self.elements().rotation_count(), self.edges().len())
    }

    /// Returns the state with displacement `u`, m, one vector per node; other values as at rest.
    ///
    /// # Errors
    /// [`StateError`] if the number of vectors differs from the number of nodes, or one is not finite.
    pub fn state_of(&self, u: &[Vector2<f64>]) -> Result<State, StateError> {
        let mut state = self.at_rest().with_displacement(u.to_vec())?;
        self.update_rotations(&mut state, Kinematics::Corotated);
        Ok(state)
    }

    /// Sets rotations and edge angles to those of the displacement. Of the possible angles of an edge the one nearest
    /// to its previous angle is taken, so that full rotations are counted.
    pub fn update_rotations(&self, state: &mut State, kinematics: Kinematics) {
        let State { displacement: u, rotations, .. } = state;
        match kinematics {
            Kinematics::Corotated => self.elements().rotations(u.view(), rotations),
            Kinematics::Linear => rotations.fill(Rotation::IDENTITY),
        }
        self.rotate_edges(state, kinematics);
    }

    /// Sets the angles of the edges, rad, to those of the displaced edges.
    pub(crate) fn rotate_edges(&self, state: &mut State, kinematics: Kinematics) {
        let State { displacement: u, edge_angles, .. } = state;
        for (edge, angle) in self.edges().iter().zip(edge_angles).filter(|(edge, _)| edge.is_straight()) {
            *angle = match kinematics {
                Kinematics::Corotated => edge.angle(u, *angle),
                Kinematics::Linear => edge.linear_angle(u),
            };
        }
    }
}

/// Returns the indices of straight edges on which a scene has moments; unknown names are reported later.
fn moment_edges(edges: &[Edge], scene: &Scene) -> Vec<usize> {
    let carries = |edge: &Edge| {
        scene.loads.iter().any(|load| matches!(load, Load::Moment { edge: name, .. } if name == edge.name()))
    };
    (0..edges.len()).filter(|&i| edges[i].is_straight() && carries(&edges[i])).collect()
}
