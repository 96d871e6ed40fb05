//! SIMD lanes: element loops process [`LANES`] elements at once, one in each lane of a vector register.

use nalgebra::{Matrix2, Scalar, SimdRealField, SimdValue, Vector2};
use simba::simd::WideF64x4;

/// One f64 per SIMD lane.
pub type Lanes = WideF64x4;

/// Number of SIMD lanes, which is the number of elements per batch.
pub const LANES: usize = <Lanes as SimdValue>::LANES;

/// `f64` or [`Lanes`]: code generic over `Number` works on one element or on one element per lane.
pub trait Number: Scalar + Copy + SimdRealField<Element = f64> {}

impl<T: Scalar + Copy + SimdRealField<Element = f64>> Number for T {}

/// Batch of elements in the lanes: `count` elements from `first` on. Unused lanes repeat the last element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Numbers {
    pub first: usize,
    pub count: usize,
}

impl Numbers {
    /// Returns the element number of every lane.
    #[inline(always)]
    pub fn all(self) -> [usize; LANES] {
        let mut all = [self.first; LANES];
        all.iter_mut().enumerate().for_each(|(lane, number)| *number += lane.min(self.count - 1));
        all
    }

    /// Returns the index of quadrature point `point`, of `of` per element, for the element in every lane.
    #[inline(always)]
    pub fn points(self, of: usize, point: usize) -> [usize; LANES] {
        let mut all = self.all();
        all.iter_mut().for_each(|number| *number = of * *number + point);
        all
    }
}

/// Copies `own` into the lanes; unused lanes repeat the last value.
pub(crate) fn filled<T: Copy>(own: &[T]) -> [T; LANES] {
    Numbers { first: 0, count: own.len() }.all().map(|lane| own[lane])
}

/// Packs one vector per lane.
#[inline(always)]
pub(crate) fn side_by_side([a, b, c, d]: [Vector2<f64>; LANES]) -> Vector2<Lanes> {
    Vector2::new([a.x, b.x, c.x, d.x].into(), [a.y, b.y, c.y, d.y].into())
}

/// Returns the matrix in one lane.
#[inline(always)]
pub(crate) fn matrix_lane(m: &Matrix2<Lanes>, lane: usize) -> Matrix2<f64> {
    Matrix2::new(m.m11.extract(lane), m.m12.extract(lane), m.m21.extract(lane), m.m22.extract(lane))
}

/// Packs the vectors of these nodes, one per lane.
#[inline(always)]
pub(crate) fn gather(all: &[Vector2<f64>], [a, b, c, d]: [u32; LANES]) -> Vector2<Lanes> {
    side_by_side([all[a as usize], all[b as usize], all[c as usize], all[d as usize]])
}

/// Packs the vectors of the nodes of several elements, one element per lane.
#[inline(always)]
pub(crate) fn gather_nodes<const N: usize>(all: &[Vector2<f64>], nodes: &[[u32; LANES]; N]) -> [Vector2<Lanes>; N] {
    let mut own = [zero_vector(); N];
    own.iter_mut().zip(nodes).for_each(|(own, nodes)| *own = gather(all, *nodes));
    own
}

/// Returns the sum over the first `count` lanes.
#[inline(always)]
pub(crate) fn sum_of_lanes(values: Lanes, count: usize) -> f64 {
    values.into_arr().into_iter().take(count).sum()
}

/// Returns the vector in one lane.
#[inline(always)]
pub(crate) fn lane<T: Number>(v: &Vector2<T>, lane: usize) -> Vector2<f64> {
    Vector2::new(v.x.extract(lane), v.y.extract(lane))
}

// nalgebra has the following operations too, but its versions pass the registers through memory.

/// Returns the zero vector.
#[inline(always)]
pub(crate) fn zero_vector<T: Number>() -> Vector2<T> {
    Vector2::new(T::zero(), T::zero())
}

/// Returns the zero matrix.
#[inline(always)]
pub(crate) fn zero_matrix<T: Number>() -> Matrix2<T> {
    Matrix2::new(T::zero(), T::zero(), T::zero(), T::zero())
}

/// Returns I + H.
#[inline(always)]
pub(crate) fn one_plus<T: Number>(h: &Matrix2<T>) -> Matrix2<T> {
    Matrix2::new(T::one() + h.m11, h.m12, h.m21, T::one() + h.m22)
}

/// Returns v wᵀ.
#[inline(always)]
pub(crate) fn outer<T: Number>(v: &Vector2<T>, w: &Vector2<T>) -> Matrix2<T> {
    Matrix2::new(v.x * w.x, v.x * w.y, v.y * w.x, v.y * w.y)
}

/// Returns M v.
#[inline(always)]
pub(crate) fn apply<T: Number>(m: &Matrix2<T>, v: &Vector2<T>) -> Vector2<T> {
    Vector2::new(m.m11 * v.x + m.m12 * v.y, m.m21 * v.x + m.m22 * v.y)
}

/// Returns A B.
#[inline(always)]
pub(crate) fn product<T: Number>(a: &Matrix2<T>, b: &Matrix2<T>) -> Matrix2<T> {
    let columns = [Vector2::new(b.m11, b.m21), Vector2::new(b.m12, b.m22)].map(|column| apply(a, &column));
    Matrix2::new(columns[0].x, columns[1].x, columns[0].y, columns[1].y)
}
