//! Elements: the registry entry of each type ([`ElementType`]), and the loops over many elements of one type
//! ([`Elements`]).
//!
//! To add an element, write one file for it and a line in [`ELEMENTS`].

use nalgebra::{Matrix2, Vector2};

use crate::displacement::Compensated;
pub use crate::material::Lame;
use crate::model::ElementKind;
use crate::rotation::{Rotation, polar_or_else};
use crate::simd::{LANES, Lanes, Number, one_plus};

pub mod cell;
mod connectivity;
mod discrete_gradient;
mod incompatible;
mod isoparametric;
mod matrix;
mod point;
mod q4;
mod rounding;
mod side;
mod t3;
mod t6;

pub use cell::{Cell, Lattice};
pub use discrete_gradient::DiscreteGradient;
pub use incompatible::IncompatibleQuads;
pub use isoparametric::Isoparametric;
pub use point::QuadraturePoint;
pub(crate) use rounding::UNIT;
pub use side::side_weights;
pub(crate) use side::{integrate_side, lagrange};

/// Properties of an element type, used by meshes, loads, files and drawing.
#[derive(Debug)]
pub struct ElementType {
    /// Element type in scene files.
    pub kind: ElementKind,
    /// Name in scene files.
    pub id: &'static str,
    /// One sentence for tooltips.
    pub about: &'static str,
    /// Reference shape.
    pub cell: &'static Cell,
    /// Reference coordinates of the nodes in the order of Gmsh and VTK: corners first, counter-clockwise.
    pub nodes: &'static [[f64; 2]],
    /// Nodes along each side, counter-clockwise, ends included.
    pub sides: &'static [&'static [usize]],
    /// Shape functions Nₐ at a point in reference coordinates.
    pub shape: fn(at: [f64; 2]) -> Vec<f64>,
    /// (∂Nₐ/∂ξ, ∂Nₐ/∂η) at a point.
    pub local_gradients: fn(at: [f64; 2]) -> Vec<Vector2<f64>>,
    /// Quadrature rule of the stiffness; strains are computed at its points.
    pub points: &'static [RulePoint],
    /// Weights that interpolate values at the quadrature points to any point; exact for the strain fields of a
    /// straight-sided element.
    pub point_weights: fn(at: [f64; 2]) -> Vec<f64>,
    /// Quadrature rule of mass and weight, exact for NₐN_b on straight-sided elements.
    pub mass_points: &'static [RulePoint],
    /// Number of pieces in which a side is drawn; more than one if sides may be curved.
    pub drawn_pieces: u32,
    /// VTK cell type.
    pub vtk_type: u8,
    /// Gmsh element type.
    pub gmsh_type: u32,
    /// Constructor of the loops over many elements.
    pub loops: MakeElements,
}

/// Constructor of element loops from rest nodes (m) and node numbers, element by element.
pub type MakeElements = fn(nodes: &[Vector2<f64>], connectivity: &[u32]) -> ElementLoops;

/// Point of a quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RulePoint {
    /// Reference coordinates.
    pub at: [f64; 2],
    /// Weight; the weights of a rule sum to the cell's area.
    pub weight: f64,
}

macro_rules! registry {
    ($($kind:ident => $entry:path),* $(,)?) => {
        /// All element types.
        pub static ELEMENTS: &[&ElementType] = &[$(&$entry),*];

        impl ElementKind {
            /// Returns the registry entry of the element.
            pub fn entry(self) -> &'static ElementType {
                match self {
                    $(Self::$kind => &$entry),*
                }
            }
        }
    };
}

registry! {
    T3 => t3::T3,
    T6 => t6::T6,
    Q4 => q4::Q4,
}

/// Largest number of nodes along a side of an element.
pub(crate) const MAX_SIDE_NODES: usize = most_side_nodes(ELEMENTS);

const fn most_side_nodes(elements: &[&ElementType]) -> usize {
    let (mut most, mut element) = (0, 0);
    while element < elements.len() {
        let (sides, mut side) = (elements[element].sides, 0);
        while side < sides.len() {
            if sides[side].len() > most {
                most = sides[side].len();
            }
            side += 1;
        }
        element += 1;
    }
    most
}

impl ElementKind {
    /// Returns the name in scene files.
    pub fn id(self) -> &'static str {
        self.entry().id
    }

    /// Iterates over all element types.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        ELEMENTS.iter().map(|e| e.kind)
    }
}

impl ElementType {
    /// Returns the Jacobian ∂X/∂(ξ, η) at a point of an element with these rest nodes.
    pub fn jacobian(&self, nodes: &[Vector2<f64>], at: [f64; 2]) -> Matrix2<f64> {
        let mut jacobian = Matrix2::zeros();
        for (x, g) in nodes.iter().zip((self.local_gradients)(at)) {
            jacobian += x * g.transpose();
        }
        jacobian
    }

    /// Returns the degree of the shape functions along a side.
    pub fn degree(&self) -> usize {
        self.sides.first().map_or(1, |side| side.len() - 1)
    }

    /// Returns `true` if both have the same reference shape, so that a mesh of one can be converted to the other.
    pub fn shares_cell(&self, other: &Self) -> bool {
        self.cell.corners == other.cell.corners
    }

    /// Returns the element's nodes in the order of the mirrored element: counter-clockwise becomes clockwise.
    pub fn turned_over(&self) -> Vec<usize> {
        // Mirroring the cell at its diagonal exchanges ξ and η.
        let mirrored = |&[x, y]: &[f64; 2]| self.nodes.iter().position(|n| *n == [y, x]).unwrap_or_default();
        self.nodes.iter().map(mirrored).collect()
    }

    /// Returns the node at these reference coordinates, if there is one.
    pub fn node_at(&self, at: [f64; 2]) -> Option<usize> {
        const SAME: f64 = 1e-9;
        self.nodes.iter().position(|n| (n[0] - at[0]).abs() < SAME && (n[1] - at[1]).abs() < SAME)
    }

    /// Returns ∫ Nₐ dA over an element with these rest nodes, m², for every node.
    pub fn nodal_areas(&self, nodes: &[Vector2<f64>]) -> Vec<f64> {
        let mut areas = vec![0.0; nodes.len()];
        for point in self.mass_points {
            let area = point.weight * self.jacobian(nodes, point.at).determinant();
            areas.iter_mut().zip((self.shape)(point.at)).for_each(|(sum, n)| *sum += area * n);
        }
        areas
    }
}

/// Matrix that an element loop adds up with the force: a sum of A = Σ R Ke Rᵀ and G.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tangent {
    /// Factor of A.
    pub warped: f64,
    /// Factor of G.
    pub geometric: f64,
    /// `true` if only the positive semidefinite part of G is used.
    pub definite: bool,
}

impl Tangent {
    /// A, the article's matrix: the derivative of the force at fixed rotations.
    pub const WARPED: Self = Self { warped: 1.0, geometric: 0.0, definite: false };
    /// A + G: the exact Hessian of the corotated energy.
    pub const EXACT: Self = Self { geometric: 1.0, ..Self::WARPED };
    /// A + max(G, 0): positive definite, so its steps are descent directions.
    pub const DEFINITE: Self = Self { definite: true, ..Self::EXACT };
    /// G alone.
    pub const GEOMETRIC: Self = Self { warped: 0.0, ..Self::EXACT };

    /// Returns `true` if the tangent contains all of G; the tangent of the loads must then be added too.
    pub fn is_exact(&self) -> bool {
        self.geometric != 0.0 && !self.definite
    }
}

/// Destination of the matrix of an element loop.
#[derive(Debug)]
pub struct MatrixSum<'a> {
    /// Matrix to add.
    pub tangent: Tangent,
    /// Index in `values` of each entry of every element's lower triangle: node blocks (a, b), b ≤ a, row by row; the
    /// four entries of a block, or the three of the lower triangle of a diagonal block.
    pub slots: &'a [u32],
    /// Values of the sparse matrix.
    pub values: &'a mut [f64],
}

/// Rotation, strain and stress of a quadrature point, one element per lane.
#[derive(Clone, Copy, Debug)]
pub struct PointStress {
    /// Rotation R.
    pub rotation: Rotation<Lanes>,
    /// Trace of the strain S − I, by which the geometric stiffness G grows.
    pub trace: Lanes,
    /// First Piola–Kirchhoff stress R T, times the thickness, N/m.
    pub stress: Matrix2<Lanes>,
}

/// Destinations of a loop over the elements.
#[derive(Debug)]
pub struct Sums<'a> {
    /// Nodal forces, N.
    pub force: &'a mut [Vector2<f64>],
    /// Absolute values of the elements' forces, by component, N.
    pub magnitude: &'a mut [Vector2<f64>],
    /// Matrix, N/m, if requested.
    pub matrix: Option<MatrixSum<'a>>,
}

/// Loops over the elements of a mesh, all of one type.
#[derive(Debug)]
pub enum ElementLoops {
    /// Three-node triangles.
    T3(Isoparametric<3, 1>),
    /// Six-node triangles.
    T6(Isoparametric<6, 3>),
    /// Four-node quadrilaterals.
    Q4(IncompatibleQuads),
}

impl ElementLoops {
    /// Loops over all elements at a displacement: `point_stress` computes rotation and stress of the points with these indices
    /// from their displacement gradients H = F − I; the loop adds the forces Σ ∫ R T ∇N dA and the tangent at R.
    ///
    /// With the rotations of `u` the force is the gradient of the energy, and A + G its Hessian; elements whose energy
    /// is not stationary in R include the dependence of R on x. With any other rotations, as in linear theory, the
    /// force is linear in `u`.
    #[inline(always)]
    pub fn sweep(
        &self,
        moduli: Lame,
        u: Compensated<'_>,
        point_stress: impl FnMut([usize; LANES], &Matrix2<Lanes>) -> PointStress,
        sums: Sums<'_>,
    ) {
        match self {
            Self::T3(elements) => elements.sweep(moduli, u, point_stress, sums),
            Self::T6(elements) => elements.sweep(moduli, u, point_stress, sums),
            Self::Q4(elements) => elements.sweep(moduli, u, point_stress, sums),
        }
    }
}

impl std::ops::Deref for ElementLoops {
    type Target = dyn Elements;

    fn deref(&self) -> &(dyn Elements + 'static) {
        match self {
            Self::T3(elements) => elements,
            Self::T6(elements) => elements,
            Self::Q4(elements) => elements,
        }
    }
}

/// Rotations used by an element loop.
#[derive(Debug)]
pub enum Rotations<'a> {
    /// Given rotations.
    Given(&'a [Rotation]),
    /// Polar factors of F(x), which are written to this slice; where one is undefined, the old rotation is kept.
    Follow(&'a mut [Rotation]),
}

impl Rotations<'_> {
    /// Returns the rotations with these indices, for displacement gradients H; updates them if they follow.
    #[inline(always)]
    pub fn evaluate(&mut self, numbers: [usize; LANES], h: &Matrix2<Lanes>) -> Rotation<Lanes> {
        match self {
            Self::Given(r) => rotations_at(r, numbers),
            Self::Follow(r) => {
                let rotation = polar_or_else(&one_plus(h), || rotations_at(r, numbers));
                let (c, s): ([f64; LANES], [f64; LANES]) = (rotation.c.into(), rotation.s.into());
                for ((number, c), s) in numbers.into_iter().zip(c).zip(s) {
                    r[number] = Rotation { c, s };
                }
                rotation
            }
        }
    }
}

/// Gathers the rotations with these indices into lanes.
#[inline(always)]
fn rotations_at(r: &[Rotation], numbers: [usize; LANES]) -> Rotation<Lanes> {
    let [a, b, c, d] = numbers;
    let [a, b, c, d] = [r[a], r[b], r[c], r[d]];
    Rotation { c: [a.c, b.c, c.c, d.c].into(), s: [a.s, b.s, c.s, d.s].into() }
}

/// Rate of Green's strain E = ½ (FᵀF − I), 1/s.
#[derive(Clone, Copy, Debug)]
pub enum StrainRate<'a> {
    /// Σ cᵢ E(uᵢ): the factors (1/s) and displacements (m) of a difference quotient in time.
    Difference(&'a [(f64, &'a [Vector2<f64>])]),
    /// sym(Fᵀ ∇v) of a velocity field, m/s.
    Velocity(&'a [Vector2<f64>]),
}

/// Callback for a quadrature point: its index, its displacement gradient H and its strain sym(RᵀF) − I.
pub type StrainVisitor<'a> = dyn FnMut(usize, &Matrix2<f64>, &Matrix2<f64>) + 'a;

/// Elements of a mesh, all of one type. Slices over quadrature points or rotations are ordered element by element;
/// slices over nodes are in the mesh's order. Moduli are times the thickness, N/m.
pub trait Elements: std::fmt::Debug + Send + Sync {
    /// Returns the number of rotations of the whole mesh.
    fn rotation_count(&self) -> usize;

    /// Returns the number of quadrature points of the whole mesh.
    fn point_count(&self) -> usize;

    /// Returns the number of quadrature points of one element.
    fn points_per_element(&self) -> usize;

    /// Returns the index of the rotation of a quadrature point.
    fn rotation_of(&self, point: usize) -> usize;

    /// Returns the area of a quadrature point, weight times Jacobian, m².
    fn point_area(&self, point: usize) -> f64;

    /// Sets every R to the polar factor of F(x); where that is undefined, R is kept.
    fn rotations(&self, u: Compensated<'_>, r: &mut [Rotation]);

    /// Adds to `bound` an upper bound of the rounding error of the forces of [`ElementLoops::sweep`], N, for rotations that
    /// are the polar factors of F, or identities: by component, to first order in the unit roundoff, and without the
    /// error of summing elements.
    fn add_rounding(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation], bound: &mut [Vector2<f64>]);

    /// Adds force and tangent between two states, as [`ElementLoops::sweep`]: the discrete gradient of the elastic energy,
    /// a force whose work from one state to the other is exactly the difference of their energies and whose resultant
    /// moment is zero; and A and G at the mean rotation and strain. Half of A + G approximates the derivative with
    /// respect to the second state.
    fn linearize_between(&self, moduli: Lame, states: [(Compensated<'_>, &[Rotation]); 2], sums: Sums<'_>);

    /// Adds the viscous force Σ ∫ F ℂ : Ė ∇N dA to `force`, N: `moduli` (N s/m) times a rate Ė of Green's strain, in
    /// the configuration F of the displacement `u`. The rate vanishes for rigid motions.
    fn viscous_force(&self, moduli: Lame, u: &[Vector2<f64>], rate: StrainRate<'_>, force: &mut [Vector2<f64>]);

    /// Adds the derivative of the viscous force with respect to the velocities, N s/m, to a matrix with the slots and
    /// values of [`MatrixSum`]: Σ ∫ F ℂ[sym(Fᵀ ∇v)] ∇N dA, positive semidefinite.
    fn viscous_matrix(&self, moduli: Lame, u: &[Vector2<f64>], slots: &[u32], values: &mut [f64]);

    /// Returns the elastic energy Σ ψ dA, J.
    fn energy(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation]) -> f64;

    /// Returns the smallest det F, the ratio of current to rest area; negative if an element is inverted.
    fn smallest_area_ratio(&self, u: &[Vector2<f64>]) -> f64;

    /// Calls `visit` for every quadrature point. Only the ratio of the moduli matters, and only for elements with
    /// internal modes, whose amplitudes depend on it.
    fn visit_strains(&self, moduli: Lame, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>);
}

/// Returns the strain in the rotated frame of the element, sym(Rᵀ F) − I with F = I + H.
///
/// With R the polar factor of F this is the Biot strain S − I. It uses c − 1 = −s²/(1 + c), so that small strains under
/// small rotations keep their digits.
#[inline(always)]
pub fn warped_strain<T: Number>(r: Rotation<T>, h: &Matrix2<T>) -> Matrix2<T> {
    let (c, s) = (r.c, r.s);
    let c_minus_1 = cosine_minus_1(r);
    let xx = c_minus_1 + c * h.m11 + s * h.m21;
    let yy = c_minus_1 - s * h.m12 + c * h.m22;
    // The ±s of Rᵀ cancel in the symmetric part.
    let xy = T::splat(0.5) * (c * (h.m12 + h.m21) + s * (h.m22 - h.m11));
    Matrix2::new(xx, xy, xy, yy)
}

/// Returns c − 1 without cancellation: −s²/(1 + c).
#[inline(always)]
fn cosine_minus_1<T: Number>(Rotation { c, s }: Rotation<T>) -> T {
    (-s * s / (T::one() + c)).select(c.simd_gt(T::zero()), c - T::one())
}

#[cfg(test)]
mod tests {
    use super::{ELEMENTS, ElementKind, ElementType, MAX_SIDE_NODES, most_side_nodes};

    #[test]
    fn segments_have_room_for_the_longest_side_of_the_registry() {
        let longest = ELEMENTS.iter().flat_map(|e| e.sides).map(|side| side.len()).max();
        assert_eq!(longest, Some(MAX_SIDE_NODES));
        let t3 = ElementKind::T3.entry();
        let cubic = ElementType { sides: &[&[0, 1], &[1, 3, 4, 2], &[2, 0]], ..*t3 };
        assert_eq!(most_side_nodes(&[&cubic, t3]), 4);
    }
}
