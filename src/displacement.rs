//! Displacements with more digits than one f64 has.
//!
//! On a slender body neighbouring nodes have nearly equal displacements, and a strain is their difference over the size
//! of a cell: the rounding error of a large displacement is a large part of a small strain. Therefore every component
//! is kept as an unevaluated sum of two numbers (Dekker 1971, *A floating-point technique for extending the available
//! precision*): corrections below the last digit of the displacement are not lost, and elements form their differences
//! from both parts. All other code uses the first part alone, which is the rounded sum.

use nalgebra::Vector2;

use crate::simd::{LANES, Lanes, gather, zero_vector};

/// Displacement of every node, m. Dereferences to the rounded values.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Displacement {
    rounded: Vec<Vector2<f64>>,
    /// Rounding error of `rounded`, at most half of its last digit.
    remainder: Vec<Vector2<f64>>,
}

impl Displacement {
    /// Returns the zero displacement of `nodes` nodes.
    pub fn zeros(nodes: usize) -> Self {
        Self { rounded: vec![Vector2::zeros(); nodes], remainder: vec![Vector2::zeros(); nodes] }
    }

    /// Returns the displacement with exactly these values.
    pub fn from_rounded(rounded: Vec<Vector2<f64>>) -> Self {
        Self { remainder: vec![Vector2::zeros(); rounded.len()], rounded }
    }

    /// Returns both parts, used by elements.
    pub fn view(&self) -> Compensated<'_> {
        Compensated { rounded: &self.rounded, remainder: &self.remainder }
    }

    /// Sets all values to zero.
    pub fn reset(&mut self) {
        self.overwrite().fill(Vector2::zeros());
    }

    /// Copies another displacement of as many nodes without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.rounded.clone_from(&other.rounded);
        self.remainder.clone_from(&other.remainder);
    }

    /// Clears the remainders and returns the rounded values for writing.
    pub fn overwrite(&mut self) -> &mut [Vector2<f64>] {
        self.remainder.fill(Vector2::zeros());
        &mut self.rounded
    }

    /// Sets one component of a node, m.
    pub fn put(&mut self, node: u32, axis: usize, value: f64) {
        self.rounded[node as usize][axis] = value;
        self.remainder[node as usize][axis] = 0.0;
    }

    /// Adds `by`, m, to one component of a node.
    #[inline]
    pub fn advance(&mut self, node: usize, axis: usize, by: f64) {
        let (rounded, remainder) = (&mut self.rounded[node][axis], &mut self.remainder[node][axis]);
        let (sum, lost) = two_sum(*rounded, by);
        (*rounded, *remainder) = two_sum(sum, *remainder + lost);
    }
}

impl std::ops::Deref for Displacement {
    type Target = [Vector2<f64>];

    fn deref(&self) -> &[Vector2<f64>] {
        &self.rounded
    }
}

impl<'a> IntoIterator for &'a Displacement {
    type Item = &'a Vector2<f64>;
    type IntoIter = std::slice::Iter<'a, Vector2<f64>>;

    fn into_iter(self) -> Self::IntoIter {
        self.rounded.iter()
    }
}

/// Returns the rounded sum of two numbers and its exact rounding error (Knuth).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Displacements of nodes as unevaluated sums of two numbers, m; see [`crate::State::compensated`].
#[derive(Clone, Copy, Debug)]
pub struct Compensated<'a> {
    /// Rounded sums.
    pub rounded: &'a [Vector2<f64>],
    /// Rounding errors of [`Self::rounded`].
    pub remainder: &'a [Vector2<f64>],
}

impl Compensated<'_> {
    /// Returns the displacements of an element's nodes relative to its first one.
    #[inline(always)]
    pub(crate) fn relative<const N: usize>(&self, nodes: &[u32; N]) -> [Vector2<f64>; N] {
        let first = (self.rounded[nodes[0] as usize], self.remainder[nodes[0] as usize]);
        nodes.map(|n| (self.rounded[n as usize] - first.0) + (self.remainder[n as usize] - first.1))
    }

    /// Returns the displacements of the nodes of several elements, one element per SIMD lane, relative to each
    /// element's first node; `nodes` holds the node numbers of all lanes, node by node.
    #[inline(always)]
    pub(crate) fn relative_side_by_side<const N: usize>(&self, nodes: &[[u32; LANES]; N]) -> [Vector2<Lanes>; N] {
        let part = |n: [u32; LANES]| (gather(self.rounded, n), gather(self.remainder, n));
        let first = part(nodes[0]);
        let mut own = [zero_vector(); N];
        for (own, &nodes) in own.iter_mut().zip(nodes).skip(1) {
            let (rounded, remainder) = part(nodes);
            *own = (rounded - first.0) + (remainder - first.1);
        }
        own
    }
}
