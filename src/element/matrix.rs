//! Element matrices by blocks of two nodes.

use nalgebra::Vector2;

use super::point::{PointTangent, QuadraturePoint};
use crate::rotation::Rotation;
use crate::simd::Number;

impl<T: Number> PointTangent<T> {
    /// Returns the common factors of all blocks K_ab of a node b with rotated gradient h: for each component of g, its
    /// factors in the four entries of the block.
    #[inline(always)]
    fn column(&self, h: Vector2<T>) -> [Block<T>; 2] {
        let Self { axial, lambda, plus, minus } = *self;
        [[axial * h.x, lambda * h.y, minus * h.y, plus * h.x], [plus * h.y, minus * h.x, lambda * h.x, axial * h.y]]
    }
}

/// Block of a matrix for two nodes, row by row.
pub(super) type Block<T> = [T; 4];

/// Symmetric matrix of an element with `N` nodes whose rows sum to zero (invariance under translation); with SIMD `T`,
/// one matrix per lane. Only the blocks (a, b), b < a, are summed; the diagonal blocks follow from them.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementMatrix<const N: usize, T>([[Block<T>; N]; N]);

impl<const N: usize, T: Number> ElementMatrix<N, T> {
    /// Number of entries of the lower triangle.
    const ENTRIES: usize = N * (2 * N + 1);

    #[inline(always)]
    pub(super) fn zero() -> Self {
        Self([[[T::zero(); 4]; N]; N])
    }

    /// Adds a matrix whose blocks below the diagonal are `block(a, b)`.
    #[inline(always)]
    pub(super) fn add_blocks(&mut self, mut block: impl FnMut(usize, usize) -> Block<T>) {
        for a in 0..N {
            for b in 0..a {
                let k = block(a, b);
                for (sum, k) in self.0[a][b].iter_mut().zip(k) {
                    *sum += k;
                }
            }
        }
    }

    /// Adds the tangent of a quadrature point with rotation `r`.
    #[inline(always)]
    pub(super) fn add(&mut self, point: &QuadraturePoint<N, T>, r: Rotation<T>, tangent: PointTangent<T>) {
        let mut rotated = point.gradients;
        rotated.iter_mut().for_each(|g| *g = r.apply(*g));
        for b in 0..N {
            let [x, y] = tangent.column(rotated[b]);
            for (row, g) in self.0.iter_mut().zip(&rotated).skip(b + 1) {
                for (i, sum) in row[b].iter_mut().enumerate() {
                    *sum += g.x * x[i] + g.y * y[i];
                }
            }
        }
    }

    /// Adds the matrices of `count` elements, from number `first` on, to the global entries; `slots` as in
    /// [`super::MatrixSum`].
    #[inline(never)]
    pub(super) fn scatter(&self, first: usize, count: usize, slots: &[u32], values: &mut [f64]) {
        let mut diagonal = [[T::zero(); 4]; N];
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
        for lane in 0..count {
            // A slice of known length avoids a bounds check per slot.
            let slots = &slots[(first + lane) * Self::ENTRIES..][..Self::ENTRIES];
            let mut next = 0;
            let mut add = |value: &T| {
                values[slots[next] as usize] += value.extract(lane);
                next += 1;
            };
            for (a, [xx, _, yx, yy]) in diagonal.iter().enumerate() {
                self.0[a][..a].iter().flatten().for_each(&mut add);
                [xx, yx, yy].into_iter().for_each(&mut add);
            }
        }
    }
}
