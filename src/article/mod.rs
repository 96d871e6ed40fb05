//! The article's formulas written out, for readers and tests; the solver itself uses none of them.
//!
//! "实时物理模拟之 Warped Stiffness 方法"; the equation numbers are its own.
//!
//! - [`affine`]: the maps of triangles, quadrilaterals and tetrahedra (eqs. 4–24);
//! - [`decomposition`]: the SVD and its reading, the polar decomposition in space by iteration (eqs. 25–36);
//! - [`stiffness`]: Ke, R Ke, R Ke Rᵀ and R Ke X of one element (eqs. 1–3).
//!
//! The closed-form rotation of the plane (eqs. 37–39) is the solver's own: [`crate::rotation::polar`].

pub mod affine;
pub mod decomposition;
pub mod stiffness;
