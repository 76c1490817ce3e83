//! Helpers of the SIMD kernels, and vectors of lanes that start on a cache line: loads and stores of 64 bytes then touch one line, not two.

use pulp::bytemuck;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

/// Components that one contraction along the fastest direction sums at once.
pub(super) const COMPONENTS_AT_ONCE: usize = 3;

/// A table of NP numbers per point as rows.
#[inline(always)]
pub(super) fn rows<const NP: usize>(table: &[f64]) -> &[[f64; NP]] {
    table.as_chunks::<NP>().0
}

/// Whether the processor has SIMD lanes, which the kernels need.
pub(in crate::assembly) fn available() -> bool {
    struct HasLanes;
    impl pulp::WithSimd for HasLanes {
        type Output = bool;
        fn with_simd<S: pulp::Simd>(self, _: S) -> bool {
            !S::IS_SCALAR
        }
    }
    pulp::Arch::new().dispatch(HasLanes)
}

/// Bytes of a cache line, and numbers.
const LINE: usize = 64;
pub(super) const NUMBERS: usize = LINE / size_of::<f64>();

/// First place of `numbers` that lies on a cache line, less than [`NUMBERS`]; zero where the address is not known.
pub(super) fn offset(numbers: &[f64]) -> usize {
    let offset = numbers.as_ptr().align_offset(LINE);
    if offset < NUMBERS { offset } else { 0 }
}

/// `count` vectors.
#[derive(Clone, Debug)]
pub(super) struct Aligned<V> {
    numbers: Vec<f64>,
    start: usize,
    count: usize,
    lanes: PhantomData<V>,
}

impl<V> Default for Aligned<V> {
    fn default() -> Self {
        Self { numbers: Vec::new(), start: 0, count: 0, lanes: PhantomData }
    }
}

impl<V: bytemuck::Pod> Aligned<V> {
    /// `count` vectors of zeros, which the system hands out where they are first touched.
    pub fn new(count: usize) -> Self {
        let numbers = vec![0.0; count * size_of::<V>() / size_of::<f64>() + NUMBERS];
        let start = offset(&numbers);
        Self { numbers, start, count, lanes: PhantomData }
    }

    /// Makes it `count` vectors; what they hold is not said.
    #[inline(always)]
    pub fn resize(&mut self, count: usize) {
        if count != self.count {
            let wanted = count * size_of::<V>() / size_of::<f64>() + NUMBERS;
            if self.numbers.len() < wanted {
                self.numbers.resize(wanted, 0.0);
                self.start = offset(&self.numbers);
            }
            self.count = count;
        }
    }

    /// Makes it `count` vectors of zeros.
    #[inline(always)]
    pub fn zeros(&mut self, count: usize) {
        self.resize(count);
        self.iter_mut().for_each(|v| *v = V::zeroed());
    }
}

impl<V: bytemuck::Pod> Deref for Aligned<V> {
    type Target = [V];
    #[inline(always)]
    fn deref(&self) -> &[V] {
        bytemuck::cast_slice(&self.numbers[self.start..self.start + self.count * (size_of::<V>() / size_of::<f64>())])
    }
}

impl<V: bytemuck::Pod> DerefMut for Aligned<V> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [V] {
        bytemuck::cast_slice_mut(&mut self.numbers[self.start..self.start + self.count * (size_of::<V>() / size_of::<f64>())])
    }
}
