//! The data of a scene: a beam, its material, supports, loads, probes and sections; builders, limits, units and validation.
//!
//! [`crate::scene`] reads it from files and re-exports these types.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

mod build;
mod dynamics;
mod error;
pub mod keys;
pub mod limits;
mod place;
mod table;
pub mod units;

pub use dynamics::{Damping, DynamicsSettings, IntegratorKind, Pulse, Start};
pub use error::{Invalid, SceneError};
pub use place::{Axis, Load, Place, Probe, SectionLine, Support};
pub(crate) use table::{check, check_required};
#[cfg(feature = "cli")]
pub(crate) use table::{keys_of, name_of};

use crate::format::number;
use crate::sentence::{Sentence, sentence};

/// Complete description of a simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct Scene {
    /// Title.
    pub name: String,
    /// One sentence for the scene list.
    pub about: String,
    /// Equilibrium or motion.
    pub analysis: Analysis,
    /// Meshed rectangle; given exactly if `mesh` is not.
    pub beam: Option<Beam>,
    /// Mesh from a file; given exactly if `beam` is not.
    pub mesh: Option<MeshFile>,
    /// Elastic material.
    pub material: Material,
    /// Supports, which fix nodes.
    #[serde(rename = "support")]
    pub supports: Vec<Support>,
    /// Forces, moments and gravity.
    #[serde(rename = "load")]
    pub loads: Vec<Load>,
    /// Places whose displacements are measured.
    #[serde(rename = "probe")]
    pub probes: Vec<Probe>,
    /// Lines along which the body is cut to print its section forces.
    #[serde(rename = "section", skip_serializing_if = "Vec::is_empty")]
    pub sections: Vec<SectionLine>,
    /// Settings of the equilibrium solver.
    pub solver: SolverSettings,
    /// Time integration settings of dynamic scenes.
    #[serde(skip_serializing_if = "is_default")]
    pub dynamics: DynamicsSettings,
    /// Initial velocities of dynamic scenes.
    #[serde(skip_serializing_if = "is_default")]
    pub start: Start,
}

/// Kind of result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Analysis {
    /// Equilibrium.
    #[default]
    Static,
    /// Motion.
    Dynamic,
}

/// Structured mesh of the rectangle [0, length] × [−height/2, height/2], or of the arch it is bent to.
///
/// ```
/// use warpbeam::{Beam, Diagonals, ElementKind, Scene};
///
/// let scene = Scene::beam(10.0, 1.0).with_cells(20, 2).with_element(ElementKind::T3).with_diagonals(Diagonals::Same);
/// assert_eq!(scene.unknowns(), 2 * 21 * 3); // two per node
/// let beam: Beam = scene.beam.ok_or("the scene has a beam")?;
/// assert_eq!((beam.cells, beam.diagonals), ([20, 2], Diagonals::Same));
/// assert_eq!(beam.point(0.5, 0.5), [5.0, 0.5]); // the middle of the upper side
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct Beam {
    /// Length, m.
    pub length: f64,
    /// Height, m.
    pub height: f64,
    /// Rise of the axis in the middle, along a parabola from end to end, m: a shallow arch, stress-free.
    #[serde(skip_serializing_if = "is_default")]
    pub rise: f64,
    /// Cells along and across; each is a quadrilateral, or is cut into two triangles.
    pub cells: [u32; 2],
    /// Element type of every cell, or of each of its triangles.
    pub element: ElementKind,
    /// Direction in which cells are cut into triangles; quadrilaterals are not cut.
    pub diagonals: Diagonals,
}

/// Mesh from a Gmsh file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct MeshFile {
    /// Path of the file, relative to the scene file. Its physical curves name the edges.
    pub file: String,
    /// Element type; if `None`, the type in the file is used, which is determined when the scene is opened.
    pub element: Option<ElementKind>,
    /// Metres per unit of the file; `None` means 1.
    pub scale: Option<f64>,
    /// Contents of the file, read when the scene is opened.
    #[serde(skip)]
    pub text: Option<Arc<str>>,
}

/// Element types.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ElementKind {
    /// Three nodes, constant strain.
    #[default]
    T3,
    /// Six nodes, linear strain, curved edges.
    T6,
    /// Four nodes, incompatible modes, one rotation.
    Q4,
}

/// Directions in which the cells of a beam are cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Diagonals {
    /// Cell (i, j) is cut from lower left to upper right if i + j is even, else from upper left to lower right.
    #[default]
    Alternating,
    /// Every cell is cut from lower left to upper right.
    Same,
}

/// Linear elastic, isotropic material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson ratio ν.
    pub poisson: f64,
    /// Density ρ, kg/m³; used for gravity and motion.
    pub density: f64,
    /// Thickness t out of the plane, m.
    pub thickness: f64,
    /// Plane stress or plane strain.
    pub plane: Plane,
}

/// Returns `true` for the default value of a type, such as 0; predicate for keys that scene files then omit.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Conditions out of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// No stress out of the plane, as in a thin plate.
    #[default]
    Stress,
    /// No strain out of the plane, as in a slice of a long body.
    Strain,
}

/// Settings of the equilibrium solver.
///
/// ```
/// use warpbeam::{MethodKind, Scene, Simulation, SolverSettings, Status};
///
/// // The budget of a game: two iterations, whatever the residual is then.
/// let mut solver = SolverSettings::default();
/// (solver.method, solver.accept_after) = (MethodKind::Warped, 2);
/// let mut scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]);
/// scene.solver = solver;
/// let mut beam = Simulation::new(&scene)?;
/// assert_eq!(*beam.solve(), Status::Accepted);
/// assert_eq!(beam.iterations(), 2);
/// # Ok::<(), warpbeam::SimulationError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct SolverSettings {
    /// Method that finds the equilibrium, or solves the time steps.
    pub method: MethodKind,
    /// Relative residual ‖f_ext − f_int‖ / ‖Σ|fₑ|‖ below which the solve has converged, with fₑ the nodal forces of
    /// element e.
    pub tolerance: f64,
    /// Number of linear solves after which the search ends without convergence.
    pub max_iterations: u32,
    /// Number of iterations after which the result is accepted without convergence; 0 accepts converged results only.
    #[serde(skip_serializing_if = "is_default")]
    pub accept_after: u32,
    /// Largest error that the method `auto` allows itself, percent of the displacement at equilibrium on the scene's
    /// own mesh; the error of the mesh is not included.
    pub max_error_percent: f64,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            method: MethodKind::default(),
            tolerance: 1e-8,
            max_iterations: 1000,
            accept_after: 0,
            max_error_percent: 1.0,
        }
    }
}

/// Methods that find an equilibrium or solve a time step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MethodKind {
    /// Small-rotation FEM, one solve.
    Linear,
    /// The article's iteration.
    Warped,
    /// Newton's method with the exact tangent.
    #[default]
    Newton,
    /// One of the other methods, chosen by an estimate of its error for the requested accuracy.
    Auto,
}

impl Scene {
    /// Serialises the scene as TOML.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] with the serializer's message; validated scenes have none.
    pub fn to_toml(&self) -> Result<String, SceneError> {
        let written = toml::to_string(self);
        written.map_err(|error| SceneError::Syntax { file: None, line: None, message: error.to_string() })
    }

    /// Checks every number and every choice that can be checked without a mesh.
    ///
    /// # Errors
    /// The first invalid key and the expected value.
    pub fn validate(&self) -> Result<(), Invalid> {
        match (&self.beam, &self.mesh) {
            (Some(_), None) | (None, Some(_)) => {}
            (None, None) => return Err(Invalid::new("beam", "expected [beam] or [mesh], got neither")),
            (Some(_), Some(_)) => return Err(Invalid::new("mesh", "expected [beam] or [mesh], got both")),
        }
        check(&toml::Table::try_from(self).map_err(unwritten)?)?;
        self.beam.as_ref().map_or(Ok(()), Beam::validate)?;
        self.validate_choices()
    }

    /// Checks all but the geometry and the members that are equal in a valid scene; for a scene on an existing mesh.
    pub(crate) fn validate_all_but_geometry(&self, valid: Option<&Self>) -> Result<(), Invalid> {
        let mut changed = toml::Table::new();
        macro_rules! compare {
            ($($key:literal: $member:ident,)*) => {
                $(if valid.is_none_or(|valid| valid.$member != self.$member) {
                    changed.insert($key.to_owned(), toml::Value::try_from(&self.$member).map_err(unwritten)?);
                })*
            };
        }
        compare! {
            "name": name, "about": about, "analysis": analysis, "material": material, "support": supports, "load": loads,
            "probe": probes, "section": sections, "solver": solver, "dynamics": dynamics, "start": start,
        }
        check(&changed).and_then(|()| self.validate_choices())
    }

    /// Checks everything but the kinds and ranges of [`keys::KEYS`].
    fn validate_choices(&self) -> Result<(), Invalid> {
        let dynamic = self.analysis == Analysis::Dynamic;
        refuse_if(self.name.trim().is_empty(), "name", "expected a title, got an empty string")?;
        let poisson = self.material.plane.poisson_limit().check(self.material.poisson);
        poisson.map_err(|message| Invalid::new("material.poisson", message))?;
        let unsupported = self.supports.is_empty() && !dynamic;
        refuse_if(unsupported, "support", sentence!("expected at least one support, got none"))?;
        let massless = sentence!("expected a density above 0: without mass nothing moves");
        refuse_if(dynamic && self.material.density == 0.0, "material.density", massless)?;
        for (i, support) in self.supports.iter().enumerate() {
            let key = format!("support.{i}");
            support.validate(&key)?;
            let name = if support.turn == 0.0 { "displacement" } else { "turn" };
            let message = "expected analysis = \"static\", or no value: supports of a dynamic scene cannot move";
            refuse_if(dynamic && support.moves(), format!("{key}.{name}"), message)?;
        }
        for (i, load) in self.loads.iter().enumerate() {
            let message = "expected analysis = \"dynamic\", or no pulse: a pulse acts for a time";
            refuse_if(load.pulse().is_some() && !dynamic, format!("load.{i}.pulse"), message)?;
        }
        for (i, probe) in self.probes.iter().enumerate() {
            if let Some(first) = self.probes[..i].iter().position(|other| other.name == probe.name) {
                let message = format!("expected a unique name, got \"{}\", which probe.{first} has", probe.name);
                return Err(Invalid::new(format!("probe.{i}.name"), message));
            }
        }
        let message = "expected analysis = \"static\", or 0: in a dynamic scene, dynamics.iterations limits the solves per \
             stage";
        refuse_if(dynamic && self.solver.accept_after != 0, "solver.accept_after", message)?;
        let message = "expected analysis = \"dynamic\" in a scene with this table";
        refuse_if(!dynamic && !is_default(&self.dynamics), "dynamics", message)?;
        refuse_if(!dynamic && !is_default(&self.start), "start", message)
    }
}

/// Returns the error of a scene with a value that no scene file can have.
fn unwritten(error: toml::ser::Error) -> Invalid {
    Invalid::new("scene", error.to_string())
}

/// Returns the error of a key if `refused` is `true`.
fn refuse_if(refused: bool, key: impl Into<String>, message: impl Into<Sentence>) -> Result<(), Invalid> {
    if refused { Err(Invalid::new(key, message)) } else { Ok(()) }
}

/// Largest ratio of the sides of a cell; beyond it rounding errors dominate the element stiffness.
const MAX_CELL_ASPECT: f64 = 1e5;

impl Beam {
    fn validate(&self) -> Result<(), Invalid> {
        let total = f64::from(self.cells[0]) * f64::from(self.cells[1]);
        let ([low, high], got) = (limits::TOTAL_CELLS.ends(), number(total));
        let message = sentence!("expected %{low} to %{high}, got %{got} cells in all", low, high, got);
        refuse_if(limits::TOTAL_CELLS.check(total).is_err(), "beam.cells", message)?;
        let aspect = self.cell_aspect();
        let message = sentence!(
            "expected cells at most %{n} times as long as high or as high as long, got %{got}",
            n = number(MAX_CELL_ASPECT),
            got = number(aspect)
        );
        refuse_if(!(1.0 / MAX_CELL_ASPECT..=MAX_CELL_ASPECT).contains(&aspect), "beam.cells", message)
    }

    /// Returns the height of the axis at rest above its ends, m; `along` is 0 at the left end and 1 at the right end.
    pub(crate) fn axis(&self, along: f64) -> f64 {
        4.0 * self.rise * along * (1.0 - along)
    }

    /// Returns the rest coordinates of a point, m: `along` is 0 at the left end and 1 at the right end, `across` −½ at
    /// the bottom and ½ at the top, measured upwards.
    pub fn point(&self, along: f64, across: f64) -> [f64; 2] {
        [along * self.length, self.axis(along) + across * self.height]
    }

    /// Returns length over height of one cell.
    pub fn cell_aspect(&self) -> f64 {
        let [nx, ny] = self.cells.map(f64::from);
        (self.length / nx) / (self.height / ny)
    }
}

impl Plane {
    /// Returns the range of Poisson ratios for this plane assumption. In plane strain ½ is incompressible, and λ infinite.
    #[doc(hidden)]
    pub fn poisson_limit(self) -> limits::Limit {
        match self {
            Self::Stress => const { keys::range("material.poisson") },
            Self::Strain => limits::Limit { max: 0.4999, ..Self::Stress.poisson_limit() },
        }
    }
}
