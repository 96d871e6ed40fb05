//! **warpbeam** computes the bending of 2D beams meshed with triangles and quadrilaterals by the *warped stiffness*
//! (corotational finite element) method, and reports the cost and the error of each method.
//!
//! A plastic ruler, 30 cm long, 3 cm high and 2 mm thick, with 10 N at its end. By hand, P L³/(3 E I) = 10 mm:
//!
//! ```
//! use warpbeam::{ElementKind, Material, Scene, Simulation, Status};
//!
//! let ruler = Scene::beam(0.3, 0.03)
//!     .with_cells(15, 1)
//!     .with_element(ElementKind::Q4)
//!     .with_material(Material { thickness: 0.002, ..Material::new(2e9, 0.35) })
//!     .clamp("left")
//!     .force("right", [0.0, -10.0])
//!     .probe("tip", "right");
//! let mut beam = Simulation::new(&ruler)?;
//! while *beam.status() == Status::Running {
//!     beam.step(); // one iteration: factorize → solve → advance → linearize
//! }
//! let tip = beam.probe("tip").unwrap_or_default();
//! assert!((tip.y + 0.010).abs() < 0.0001, "the tip went down by {} m", -tip.y);
//! # Ok::<(), warpbeam::SimulationError>(())
//! ```
//!
//! # The method in ten lines
//!
//! 1. A triangle maps its corners Xₐ at rest to xₐ: x = F X + b, with F = Σ xₐ ⊗ ∇Nₐ.
//! 2. R is the rotation closest to F, S = RᵀF the rest: F = R S. In the plane R has a closed form.
//! 3. S − I is the strain, zero under every rotation. Linear theory takes the symmetric part of F − I instead, which is
//!    not zero under a rotation: a rotated body grows.
//! 4. The energy density is μ ‖S − I‖² + λ/2 tr²(S − I).
//! 5. Its derivative, the force, is f = R Ke (Rᵀ x − X): rotated back, computed as in linear theory, rotated forward.
//! 6. Equilibrium is f_int(x) = f_ext.
//! 7. With A = Σ R Ke Rᵀ, method `warped` repeats x ← x + A⁻¹ (f_ext − f_int).
//! 8. A is not the derivative of f_int; that is A + G. The iteration converges where ρ, the largest eigenvalue of A⁻¹G
//!    in magnitude, is below 1.
//! 9. Method `newton` takes A + G, and follows the path of equilibria from rest where the body softens.
//! 10. A result is stable if A + G is positive definite. Its error is its distance from a reference solution.
//!
//! `docs/theory` derives all of it, and `docs/README.md` is the map of the documents.
//!
//! # Contents
//!
//! In the order in which one meets them:
//!
//! | task | types |
//! |---|---|
//! | describe a scene | [`Scene`] with its builder methods, or [`Scene::from_toml`]; [`Beam`], [`Material`], [`Load`], [`Support`], [`Probe`], [`SolverSettings`], [`DynamicsSettings`]; a mesh of your own: [`Mesh::new`] and [`Simulation::with_mesh`] |
//! | solve it | [`Simulation::solve`], or [`Simulation::step`] in a loop of your own; [`Status`], [`Solution`], [`Equilibrium`], [`Certificate`] |
//! | edit and grab | [`Simulation::edit`] takes setters of the scene such as [`Scene::set_force`]; [`Simulation::grab`] attaches a [`MouseSpring`] to a [`MaterialPoint`]; [`Simulation::change_scene`] |
//! | read results | [`Simulation::positions`], [`Simulation::probe`], [`Simulation::point_state`], [`Simulation::section`], [`Field`], [`NodalStress`]; files with [`export`] |
//! | move in time | [`Scene::moving`], [`Motion`] with its [`Ledger`] of energies, [`Moment`] |
//! | measure errors and time | [`Reference`], [`Study`], [`Timings`] |
//!
//! Results are [`nalgebra::Vector2<f64>`]; builders and setters of scenes and simulations also take `[f64; 2]`. The
//! data of a scene hold `[f64; 2]`. Units are SI and angles in rad, except where the name or the comment says otherwise
//! (`_deg`, `_percent`, `_ms`).
//!
//! `examples/warped.rs` is the method in 60 lines; `src/step.rs` is the code that every iteration executes.
//! `examples/` also has a game loop, grabbing, a mesh of one's own, a motion with energies, a load curve and a study.
//!
//! # Notation
//!
//! | symbol | meaning | shape, unit |
//! |---|---|---|
//! | `X`, `x` | rest and current node positions | n × 2, m |
//! | `u = x − X` | displacement, stored as a sum of two numbers so that small strains keep their digits | n × 2, m |
//! | `F = I + H` | deformation gradient Σ xₐ ⊗ ∇Nₐ at a quadrature point | 2 × 2 |
//! | `R`, `S` | polar factors F = R S; R a proper rotation, S symmetric | 2 × 2 |
//! | `E`, `ν`, `ρ`, `t` | Young's modulus Pa, Poisson ratio, density kg/m³, thickness m | scalars |
//! | `λ`, `μ` | Lamé constants of the plane problem | Pa |
//! | `Ke` | linear element stiffness ∫ Bᵀ C B t dA | 6 × 6 (`t3`), 12 × 12 (`t6`), 8 × 8 (`q4`), N/m |
//! | `A` | warped stiffness Σ R Ke Rᵀ | 2n × 2n, sparse, N/m |
//! | `G` | geometric part of the exact tangent A + G | as `A` |
//! | `ρ` of a result | largest eigenvalue of A⁻¹G in magnitude, by which an error shrinks per warped iteration; not the density | scalar |
//! | `fₑ` | nodal forces of one element | n × 2, N |
//! | `f_ext`, `f_int` | external force, and Σ R Ke (Rᵀ x − X) | n × 2, N |
//!
//! # The iteration
//!
//! ```text
//! factorize A → solve A d = f_ext − f_int → advance x ← x + d → linearize: R, f_int, A of the new x → (draw)
//! ```
//!
//! A module imports only from its own layer and from layers to its left: `format`, `sentence`, `progress`, `timings`,
//! `simd`, `image`, `atomic_write` → `model`, the scene's data → `rotation`, `displacement`, `material`, `state`, `continuation`,
//! `exact_beam` → `element` → `mesh`, `article` → `scene` → `solver` → `assembly` → `step` → `method`, `dynamics`, `stress`,
//! `section` → `simulation` → `export`, `study` → `plot` → `render` → the window → the commands. A test holds this
//! order (`LAYERS` in `tests/style/architecture.rs`).
//!
//! The feature `app` (on by default) adds the window and the commands; `cli` adds the commands alone, without a GPU or
//! a window. Without both features the library depends on no GPU, window or command line crate.
//!
//! # Sources
//!
//! - M. Müller, M. Gross, *Interactive Virtual Materials*, Graphics Interface 2004
//!   ([pdf](https://matthias-research.github.io/pages/publications/GI2004.pdf)): warped stiffness.
//! - "实时物理模拟之 Warped Stiffness 方法" (*the article*): equation numbers in these pages refer to it.
//! - [faer](https://docs.rs/faer) for sparse Cholesky, [nalgebra](https://docs.rs/nalgebra) for small matrices.
//!
//! `docs/theory/sources.md` lists all of them, `docs/theory/errata.md` the errata of the article.

#![forbid(unsafe_code)]

// The public face is the list of re-exports below. The modules are public for the program, tests and benchmarks of this
// package only: they may change without notice.
#[cfg(feature = "app")]
#[doc(hidden)]
pub mod app;
#[cfg(feature = "app")]
mod article;
#[doc(hidden)]
pub mod assembly;
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
mod atomic_write;
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
#[doc(hidden)]
pub mod cli;
mod continuation;
mod displacement;
mod dynamics;
#[doc(hidden)]
pub mod element;
mod exact_beam;
pub mod export;
#[doc(hidden)]
pub mod format;
#[cfg(feature = "app")]
mod image;
mod material;
mod mesh;
#[doc(hidden)]
pub mod method;
mod model;
// The page draws fewer pictures than the commands.
#[cfg(feature = "cli")]
#[cfg_attr(target_arch = "wasm32", allow(dead_code, unused_imports))]
mod plot;
mod progress;
#[cfg(feature = "app")]
#[doc(hidden)]
pub mod render;
#[doc(hidden)]
pub mod rotation;
#[doc(hidden)]
pub mod scene;
mod section;
mod sentence;
mod simd;
mod simulation;
#[doc(hidden)]
pub mod solver;
mod state;
#[doc(hidden)]
pub mod step;
mod stress;
#[doc(hidden)]
pub mod study;
mod timings;

pub use nalgebra;

// Describe a scene.
pub use mesh::{GmshError, Mesh, MeshError, Segment};
pub use scene::{
    Analysis, Axis, Beam, Damping, Diagonals, DynamicsSettings, ElementKind, IntegratorKind, Invalid, Load, Material,
    MeshFile, MethodKind, Place, Plane, Probe, Pulse, Scene, SceneError, SectionLine, SolverSettings, Start, Support,
};
// Solve it.
pub use method::{AutoReport, Certificate, Decision, IterationError, Reason};
pub use simulation::{Equilibrium, Simulation, SimulationError, Solution, Status};
pub use solver::SolverError;
// Edit and grab.
pub use assembly::MouseSpring;
pub use mesh::MaterialPoint;
pub use rotation::Rotation;
pub use state::{State, StateError};
// Read results.
pub use section::{Section, SectionError, SectionForces, SectionPoint, Wrench};
pub use sentence::Sentence;
pub use simulation::{Deformation, Energy, Field, PointState, PointValues, ProbeResult, SupportReaction};
pub use stress::{NodalStress, PlaneTensor};
// Move in time.
pub use dynamics::{Counts, Ledger, Momentum, StepError, StopReason};
pub use simulation::{Moment, Motion};
// Measure errors and time.
pub use progress::{Observer, Progress};
pub use study::{
    Demand, ErrorSplit, Extent, Measurement, MovedPoint, ProbeReference, Reference, ReferenceSource, Setting, Stepping,
    Study, StudyError,
};
pub use timings::Timings;
