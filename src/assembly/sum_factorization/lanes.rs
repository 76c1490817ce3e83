//! Helpers of the SIMD kernels.

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
