//! Equations of a scene.
//!
//! - [`System`]: data computed once for a mesh and its supports, and shared: elements, free unknowns, sparsity,
//!   elimination order.
//! - [`Loads`]: nodal forces and moments.
//! - [`Problem`]: a system with its material, loads and probes; forces, tangents and energies of a state.

mod edge;
mod held_points;
mod hold;
mod kinematics;
mod linear_system;
mod loads;
mod mass;
mod matrix;
mod mouse_spring;
mod pattern;
mod probe;
mod problem;
mod supports;
mod system;

pub(crate) use edge::weighted_sum;
pub use edge::{Edge, NodeWeights};
pub use kinematics::Kinematics;
pub use linear_system::{IterationError, LinearSystem};
pub use loads::Loads;
pub use mass::Mass;
pub use matrix::Matrix;
pub use mouse_spring::MouseSpring;
pub use pattern::Pattern;
pub use probe::NodalProbe;
pub use problem::{Change, Forces, Problem};
pub(crate) use supports::LARGEST_TURN;
pub use supports::{NodalSupport, Supports};
pub use system::{SimulationError, System};
