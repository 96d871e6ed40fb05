//! The article's formulas written out, for readers, the cards of Learn and tests; the solver itself uses none of them.
//!
//! "实时物理模拟之 Warped Stiffness 方法"; the equation numbers are its own.
//!
//! - [`affine`]: the maps of triangles (eqs. 4–15);
//! - [`stiffness`]: Ke, R Ke, R Ke Rᵀ and R Ke X of one element (eqs. 1–3).
//!
//! The maps of quadrilaterals and tetrahedra, the SVD and the polar decomposition in space (eqs. 21–36) are written out in
//! `tests/article`. The closed-form rotation of the plane (eqs. 37–39) is the solver's own: [`crate::rotation::polar`].

pub mod affine;
pub mod stiffness;
