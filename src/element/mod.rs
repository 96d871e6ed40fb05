//! Elements: what each says of itself ([`ElementType`]), and the loops over many of one kind ([`Elements`]).
//!
//! An element is one file that says everything of it, and a line in [`ELEMENTS`].

use nalgebra::{Matrix2, Vector2};

use crate::displacement::Compensated;
use crate::lanes::{LANES, Lanes, Number, one_plus};
use crate::material::Lame;
use crate::model::ElementKind;
use crate::rotation::{Rotation, polar_or_else};

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

/// What a mesh, its loads, its files and its picture ask of an element, whichever it is.
#[derive(Debug)]
pub struct ElementType {
    /// What scene files name.
    pub kind: ElementKind,
    /// The name scene files use.
    pub id: &'static str,
    /// One sentence for tooltips.
    pub about: &'static str,
    /// Its shape.
    pub cell: &'static Cell,
    /// Reference coordinates of the nodes in the order of Gmsh and VTK: corners first, counter-clockwise.
    pub nodes: &'static [[f64; 2]],
    /// Nodes along each side, counter-clockwise, ends included.
    pub sides: &'static [&'static [usize]],
    /// Shape functions Nₐ at a point in reference coordinates.
    pub shape: fn(at: [f64; 2]) -> Vec<f64>,
    /// (∂Nₐ/∂ξ, ∂Nₐ/∂η) at a point.
    pub local_gradients: fn(at: [f64; 2]) -> Vec<Vector2<f64>>,
    /// The rule of the stiffness; strains are known at its points.
    pub points: &'static [RulePoint],
    /// The weights of the quadrature points' values in the value at a point: exact for fields as the strain of a
    /// straight-sided element can be.
    pub point_weights: fn(at: [f64; 2]) -> Vec<f64>,
    /// The rule of mass and weight: exact for NₐN_b on straight-sided elements.
    pub mass_points: &'static [RulePoint],
    /// Pieces in which a side is drawn: more than one where sides may be curved.
    pub drawn_pieces: u32,
    /// VTK's number for the element.
    pub vtk_type: u8,
    /// Gmsh's number for the element.
    pub gmsh_type: u32,
    /// The loops over many of these elements.
    pub loops: MakeElements,
}

/// Makes the loops over elements with these rest nodes (m) and node numbers, element by element.
pub type MakeElements = fn(nodes: &[Vector2<f64>], connectivity: &[u32]) -> Box<dyn Elements>;

/// A point of a quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RulePoint {
    /// Reference coordinates.
    pub at: [f64; 2],
    /// Weight; the weights of a rule sum to the cell's area.
    pub weight: f64,
}

macro_rules! registry {
    ($($kind:ident => $entry:path),* $(,)?) => {
        /// Every element there is.
        pub static ELEMENTS: &[&ElementType] = &[$(&$entry),*];

        impl ElementKind {
            /// What the element says of itself.
            #[must_use]
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
pub(crate) const MOST_SIDE_NODES: usize = most_side_nodes(ELEMENTS);

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
    /// The name scene files use.
    #[must_use]
    pub fn id(self) -> &'static str {
        self.entry().id
    }

    /// Every element there is.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        ELEMENTS.iter().map(|e| e.kind)
    }
}

impl ElementType {
    /// The Jacobian ∂X/∂(ξ, η) at a point of an element with these rest nodes.
    #[must_use]
    pub fn jacobian(&self, nodes: &[Vector2<f64>], at: [f64; 2]) -> Matrix2<f64> {
        let mut jacobian = Matrix2::zeros();
        for (x, g) in nodes.iter().zip((self.local_gradients)(at)) {
            jacobian += x * g.transpose();
        }
        jacobian
    }

    /// Degree of the shape functions along a side.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.sides.first().map_or(1, |side| side.len() - 1)
    }

    /// Whether both are of the same shape: a mesh of one can be made a mesh of the other.
    #[must_use]
    pub fn shares_cell(&self, other: &Self) -> bool {
        self.cell.corners == other.cell.corners
    }

    /// The element's nodes in the order that turns it over: counter-clockwise becomes clockwise.
    #[must_use]
    pub fn turned_over(&self) -> Vec<usize> {
        // Mirroring the cell at its diagonal exchanges ξ and η.
        let mirrored = |&[x, y]: &[f64; 2]| self.nodes.iter().position(|n| *n == [y, x]).unwrap_or_default();
        self.nodes.iter().map(mirrored).collect()
    }

    /// The node at this place in reference coordinates, if there is one.
    #[must_use]
    pub fn node_at(&self, at: [f64; 2]) -> Option<usize> {
        const SAME: f64 = 1e-9;
        self.nodes.iter().position(|n| (n[0] - at[0]).abs() < SAME && (n[1] - at[1]).abs() < SAME)
    }

    /// ∫ Nₐ dA over an element with these rest nodes, m², for every node.
    #[must_use]
    pub fn nodal_areas(&self, nodes: &[Vector2<f64>]) -> Vec<f64> {
        let mut areas = vec![0.0; nodes.len()];
        for point in self.mass_points {
            let area = point.weight * self.jacobian(nodes, point.at).determinant();
            areas.iter_mut().zip((self.shape)(point.at)).for_each(|(sum, n)| *sum += area * n);
        }
        areas
    }
}

/// Which matrix a sweep adds up beside the force: a sum of A = Σ R Ke Rᵀ and G.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// Factor of A.
    pub warped: f64,
    /// Factor of G.
    pub geometric: f64,
    /// Whether G is taken only where it is positive.
    pub definite: bool,
}

impl Tangent {
    /// A, the article's matrix: the derivative of the force at fixed rotations.
    pub const WARPED: Self = Self { warped: 1.0, geometric: 0.0, definite: false };
    /// A + G: the exact Hessian of the corotated energy.
    pub const EXACT: Self = Self { geometric: 1.0, ..Self::WARPED };
    /// A + max(G, 0): positive definite, and its steps descend.
    pub const DEFINITE: Self = Self { definite: true, ..Self::EXACT };
    /// G alone.
    pub const GEOMETRIC: Self = Self { warped: 0.0, ..Self::EXACT };

    /// Whether all of G is in it: it belongs together with the loads' own tangent then.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.geometric != 0.0 && !self.definite
    }
}

/// Where a sweep adds a matrix.
#[derive(Debug)]
pub struct MatrixSum<'a> {
    /// Which matrix.
    pub tangent: Tangent,
    /// Where each entry of every element's lower triangle goes: node blocks (a, b), b ≤ a, row by row; the four entries
    /// of a block, of a diagonal block the three of its lower triangle.
    pub slots: &'a [u32],
    /// The values.
    pub values: &'a mut [f64],
}

/// The rotations with which a sweep sees the elements.
#[derive(Debug)]
pub enum Rotations<'a> {
    /// These.
    Given(&'a [Rotation]),
    /// The polar factors of F(x), which are written here; where one is undefined the old one stays.
    Follow(&'a mut [Rotation]),
}

impl Rotations<'_> {
    /// Those of these numbers, whose displacement gradients are H.
    #[inline(always)]
    fn see(&mut self, numbers: [usize; LANES], h: &Matrix2<Lanes>) -> Rotation<Lanes> {
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

/// The rotations of these numbers, side by side.
#[inline(always)]
fn rotations_at(r: &[Rotation], numbers: [usize; LANES]) -> Rotation<Lanes> {
    let [a, b, c, d] = numbers;
    let [a, b, c, d] = [r[a], r[b], r[c], r[d]];
    Rotation { c: [a.c, b.c, c.c, d.c].into(), s: [a.s, b.s, c.s, d.s].into() }
}

/// How fast Green's strain E = ½ (FᵀF − I) changes, 1/s.
#[derive(Clone, Copy, Debug)]
pub enum StrainRate<'a> {
    /// Σ cᵢ E(uᵢ): the factors (1/s) and displacements (m) of a difference quotient in time.
    Difference(&'a [(f64, &'a [Vector2<f64>])]),
    /// sym(Fᵀ ∇v) of a velocity field, m/s.
    Velocity(&'a [Vector2<f64>]),
}

/// Receives a quadrature point's number, its displacement gradient H and its strain sym(RᵀF) − I.
pub type StrainVisitor<'a> = dyn FnMut(usize, &Matrix2<f64>, &Matrix2<f64>) + 'a;

/// The elements of a mesh, all of one kind. Slices over quadrature points or rotations hold them element by element;
/// slices over nodes hold them in the mesh's order. Moduli are times the thickness, N/m.
pub trait Elements: std::fmt::Debug + Send + Sync {
    /// Rotations of the whole mesh.
    fn rotation_count(&self) -> usize;

    /// Quadrature points of the whole mesh.
    fn point_count(&self) -> usize;

    /// Quadrature points of one element.
    fn points_per_element(&self) -> usize;

    /// The number of the rotation that a quadrature point is seen with.
    fn rotation_of(&self, point: usize) -> usize;

    /// The area that a quadrature point stands for, m².
    fn point_area(&self, point: usize) -> f64;

    /// Sets every R to the polar factor of F(x); where that is undefined R stays.
    fn rotations(&self, u: Compensated<'_>, r: &mut [Rotation]);

    /// One sweep: finds the rotations where they are to follow `u`, adds the warped force Σ R Ke (Rᵀ x − X) to `force`,
    /// its elements' absolute values by component to `magnitude`, N, and a tangent to `matrix` where one is wanted, N/m.
    ///
    /// With the rotations of `u` the force is the gradient of the energy, and A + G its Hessian: an element whose energy
    /// R does not make stationary adds what R does as it follows x. With any others, as in linear theory, the force is
    /// linear in `u`.
    fn linearize(
        &self,
        moduli: Lame,
        u: Compensated<'_>,
        rotations: Rotations<'_>,
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        matrix: Option<MatrixSum<'_>>,
    );

    /// Adds to `bound` what rounding can at most have changed in the forces of [`Self::linearize`] where the rotations are
    /// the polar factors of F, or none, N: by component, to first order in the unit roundoff, and without that of adding up
    /// elements.
    fn add_rounding(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation], bound: &mut [Vector2<f64>]);

    /// One sweep between two states, as [`Self::linearize`]: the discrete gradient of the elastic energy, a force whose
    /// work from one to the other is exactly the difference of their energies, and that turns no body; and A and G at
    /// the mean rotation and strain. Half of A + G is about the derivative with respect to the second state.
    fn linearize_between(
        &self,
        moduli: Lame,
        states: [(Compensated<'_>, &[Rotation]); 2],
        force: &mut [Vector2<f64>],
        magnitude: &mut [Vector2<f64>],
        matrix: Option<MatrixSum<'_>>,
    );

    /// Adds the viscous force Σ ∫ F ℂ : Ė ∇N dA to `force`, N: `moduli` (N s/m) times a rate Ė of Green's strain, in a
    /// configuration F that belongs to the displacement `u`. A rigid motion has no such rate.
    fn viscous_force(&self, moduli: Lame, u: &[Vector2<f64>], rate: StrainRate<'_>, force: &mut [Vector2<f64>]);

    /// Adds to a matrix, with the slots and values of [`MatrixSum`], the derivative of the viscous force with respect to
    /// the velocities, N s/m: Σ ∫ F ℂ[sym(Fᵀ ∇v)] ∇N dA, positive semidefinite.
    fn viscous_matrix(&self, moduli: Lame, u: &[Vector2<f64>], slots: &[u32], values: &mut [f64]);

    /// Elastic energy Σ ψ dA, J.
    fn energy(&self, moduli: Lame, u: Compensated<'_>, r: &[Rotation]) -> f64;

    /// The smallest det F: area over that at rest, negative where an element is turned inside out.
    fn smallest_area_ratio(&self, u: &[Vector2<f64>]) -> f64;

    /// Calls `visit` for every quadrature point. Of the moduli only the ratio matters, and only where an element has
    /// modes of its own inside, whose size depends on it.
    fn visit_strains(&self, moduli: Lame, u: &[Vector2<f64>], r: &[Rotation], visit: &mut StrainVisitor<'_>);
}

/// The strain the element sees once turned back, sym(Rᵀ F) − I with F = I + H.
///
/// With R the polar factor of F this is the Biot strain S − I. Written with c − 1 = −s²/(1 + c), so that small strains
/// under small rotations keep their digits.
#[must_use]
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

/// c − 1 to the last digits: −s²/(1 + c).
#[inline(always)]
fn cosine_minus_1<T: Number>(Rotation { c, s }: Rotation<T>) -> T {
    (-s * s / (T::one() + c)).select(c.simd_gt(T::zero()), c - T::one())
}

#[cfg(test)]
mod tests {
    use super::{ELEMENTS, ElementKind, ElementType, MOST_SIDE_NODES, most_side_nodes};

    #[test]
    fn segments_have_room_for_the_longest_side_of_the_registry() {
        let longest = ELEMENTS.iter().flat_map(|e| e.sides).map(|side| side.len()).max();
        assert_eq!(longest, Some(MOST_SIDE_NODES));
        let t3 = ElementKind::T3.entry();
        let cubic = ElementType { sides: &[&[0, 1], &[1, 3, 4, 2], &[2, 0]], ..*t3 };
        assert_eq!(most_side_nodes(&[&cubic, t3]), 4);
    }
}
