//! Node numbers of elements, per element and per SIMD batch.

use crate::simd::{LANES, Numbers, filled};

/// Node numbers of elements with `N` nodes.
#[derive(Debug)]
pub(super) struct Connectivity<const N: usize> {
    pub elements: Vec<[u32; N]>,
    /// Node numbers of the elements in all lanes, node by node.
    batches: Vec<[[u32; LANES]; N]>,
}

impl<const N: usize> Connectivity<N> {
    /// Builds the connectivity from node numbers, element by element.
    pub fn new(numbers: &[u32]) -> Self {
        let (elements, _) = numbers.as_chunks::<N>();
        let batches = elements.chunks(LANES).map(|own| {
            let own = filled(own);
            std::array::from_fn(|a| own.map(|nodes| nodes[a]))
        });
        Self { batches: batches.collect(), elements: elements.to_vec() }
    }

    /// Iterates over the elements in SIMD batches.
    #[inline(always)]
    pub fn batches(&self) -> impl Iterator<Item = (Numbers, &[[u32; LANES]; N])> {
        let count = self.elements.len();
        self.batches.iter().enumerate().map(move |(batch, nodes)| {
            let first = batch * LANES;
            (Numbers { first, count: LANES.min(count - first) }, nodes)
        })
    }
}
