//! **warpbeam** computes the bending of 2D beams meshed with triangles and quadrilaterals by the *warped stiffness*
//! (corotational finite element) method, and reports the cost and the error of each method.
//!
//! ```
//! use warpbeam::{Scene, Simulation, Status};
//!
//! let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]).probe("tip", "right");
//! let mut beam = Simulation::new(&scene)?;
//! while *beam.status() == Status::Running {
//!     beam.step(); // one iteration: rotations → assemble → factorize → solve → update
//! }
//! let tip = beam.probe("tip").unwrap_or_default();
//! assert!((tip.y + 1.93).abs() < 0.02, "the tip went down by {} m", -tip.y);
//! # Ok::<(), warpbeam::SimulationError>(())
//! ```
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
//! | `ρ` | error factor of the warped iteration, largest eigenvalue of A⁻¹G in magnitude | scalar |
//! | `f_ext`, `f_int` | external force, and Σ R Ke (Rᵀ x − X) | n × 2, N |
//!
//! # The iteration
//!
//! ```text
//! rotations(F(x)) → assemble A, f → factorize → solve → update x → (draw)
//! ```
//!
//! Data flows in one direction; each module imports only from modules to its left:
//!
//! [`format`], [`timings`], the scene's data (`model`), [`simd`] → [`rotation`], [`material`], [`displacement`] →
//! [`element`] → [`mesh`] → [`solver`], [`scene`] (reads scenes and mesh files, and re-exports their data), [`state`] →
//! [`assembly`] → [`method`] for equilibria, [`dynamics`] for motions, [`stress`] → [`simulation`] → [`exact_beam`] →
//! [`study`] → `plot`, the drawings → the window → the commands. [`article`] needs elements and rotations only. The list
//! `LAYERS` in `tests/architecture.rs` holds this order, and a test fails on imports against it.
//!
//! The feature `app` (on by default) adds the window and the commands; `cli` adds the commands alone, without a GPU or
//! a window. Without both features the library depends on no GPU, window or command line crate.
//!
//! # Sources
//!
//! - M. Müller, M. Gross, *Interactive Virtual Materials*, Graphics Interface 2004: warped stiffness.
//! - "实时物理模拟之 Warped Stiffness 方法" (*the article*): equation numbers in these pages refer to it. Its errata are
//!   documented at [`rotation::polar`]; those of formulas that the solver does not need, in `tests/article`.
//! - faer for sparse Cholesky, nalgebra for small matrices.

#![forbid(unsafe_code)]

#[cfg(feature = "app")]
pub mod app;
pub mod article;
pub mod assembly;
#[cfg(feature = "cli")]
pub mod cli;
pub mod displacement;
pub mod dynamics;
pub mod element;
pub mod exact_beam;
pub mod export;
pub mod format;
pub mod material;
pub mod mesh;
pub mod method;
mod model;
#[cfg(feature = "cli")]
pub mod picture;
#[cfg(feature = "cli")]
pub mod plot;
#[cfg(feature = "app")]
pub mod render;
pub mod rotation;
pub mod scene;
pub mod simd;
pub mod simulation;
pub mod solver;
pub mod state;
pub mod stress;
pub mod study;
pub mod timings;

pub use nalgebra;

pub use mesh::Mesh;
pub use scene::{
    Axis, Beam, Diagonals, ElementKind, IntegratorKind, Load, Material, MethodKind, Place, Plane, Scene, SceneError,
};
pub use simulation::{Field, Simulation, SimulationError, Solution, Status};
pub use state::State;
