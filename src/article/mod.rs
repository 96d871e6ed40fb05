//! The article's formulas, for the cards of the Learn mode and tests; the solver does not use them.
//!
//! "实时物理模拟之 Warped Stiffness 方法"; equation numbers refer to it.
//!
//! - [`affine`]: the maps of triangles (eqs. 4–15);
//! - [`stiffness`]: Ke, R Ke and R Ke Rᵀ of one element (eqs. 1–3).
//!
//! The maps of quadrilaterals and tetrahedra (eqs. 21–24) are in the tests of [`affine`], the SVD and the polar
//! decomposition in space (eqs. 25–36) in `tests/physics/article`. The closed-form rotation of the plane (eqs. 37–39) is
//! the solver's own: [`crate::rotation::polar`].

pub mod affine;
pub mod stiffness;
