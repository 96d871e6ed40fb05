//! The matrix of one element, by blocks of two nodes.

use nalgebra::Vector2;

use super::QuadraturePoint;
use crate::rotation::Rotation;

/// Moduli of a point's tangent, times its area, N m; see [`QuadraturePoint::tangent`].
#[derive(Clone, Copy, Debug)]
pub(super) struct PointTangent {
    pub axial: f64,
    pub lambda: f64,
    pub plus: f64,
    pub minus: f64,
}

impl PointTangent {
    /// What all blocks K_ab of a node b have in common, for its turned gradient h: the factors of the two components of
    /// g in their four entries.
    #[inline(always)]
    fn column(&self, h: Vector2<f64>) -> [Block; 2] {
        let Self { axial, lambda, plus, minus } = *self;
        [[axial * h.x, lambda * h.y, minus * h.y, plus * h.x], [plus * h.y, minus * h.x, lambda * h.x, axial * h.y]]
    }
}

/// The part of a matrix that belongs to two nodes, row by row.
pub(super) type Block = [f64; 4];

/// A symmetric matrix of an element of `N` nodes that no translation feels: its rows sum to zero. The blocks (a, b), b < a,
/// are summed; those on the diagonal follow from them.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementMatrix<const N: usize>([[Block; N]; N]);

impl<const N: usize> ElementMatrix<N> {
    pub(super) const ZERO: Self = Self([[[0.0; 4]; N]; N]);

    /// Entries of its lower triangle.
    pub(super) const ENTRIES: usize = N * (2 * N + 1);

    /// Adds a matrix of which `block(a, b)` gives the blocks below the diagonal.
    #[inline(always)]
    pub(super) fn add_blocks(&mut self, mut block: impl FnMut(usize, usize) -> Block) {
        for a in 0..N {
            for b in 0..a {
                let k = block(a, b);
                for (sum, k) in self.0[a][b].iter_mut().zip(k) {
                    *sum += k;
                }
            }
        }
    }

    /// Adds the tangent of a point that is seen with a rotation. Apart from the loop that calls it the compiler turns it
    /// into short vector code; within it, into code that is half as fast. So it does [`Self::scatter`].
    #[inline(never)]
    pub(super) fn add(&mut self, point: &QuadraturePoint<N>, r: Rotation, tangent: PointTangent) {
        let mut turned = point.gradients;
        for g in &mut turned {
            *g = r.apply(*g);
        }
        for b in 0..N {
            let [x, y] = tangent.column(turned[b]);
            for (row, g) in self.0.iter_mut().zip(&turned).skip(b + 1) {
                for (i, sum) in row[b].iter_mut().enumerate() {
                    *sum += g.x * x[i] + g.y * y[i];
                }
            }
        }
    }

    /// Adds the matrix of the element of this number to the entries it belongs to; `slots` are those of
    /// [`super::MatrixSum`].
    #[inline(never)]
    pub(super) fn scatter(&self, element: usize, slots: &[u32], values: &mut [f64]) {
        let mut diagonal = [[0.0; 4]; N];
        for a in 0..N {
            for b in 0..a {
                let [xx, xy, yx, yy] = self.0[a][b];
                for (node, block) in [(a, [xx, xy, yx, yy]), (b, [xx, yx, xy, yy])] {
                    for (sum, k) in diagonal[node].iter_mut().zip(block) {
                        *sum -= k;
                    }
                }
            }
        }
        // A slice of known length: none of its slots is checked to be there.
        let slots = &slots[element * Self::ENTRIES..][..Self::ENTRIES];
        let mut next = 0;
        let mut add = |value: f64| {
            values[slots[next] as usize] += value;
            next += 1;
        };
        for (a, [xx, _, yx, yy]) in diagonal.into_iter().enumerate() {
            for b in 0..a {
                for k in self.0[a][b] {
                    add(k);
                }
            }
            for k in [xx, yx, yy] {
                add(k);
            }
        }
    }
}
