//! A cell of the grid of points: its position, and what is known at its points.

use pulp::Simd;

/// Position of a cell in the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Here<'a> {
    /// First element of the grid.
    pub first_element: usize,
    /// Element of the first direction.
    pub first: usize,
    /// Point of the middle direction and its number within its element; 0 in the plane.
    pub middle: (usize, usize),
    /// Element of the middle direction; 0 in the plane.
    pub middle_element: usize,
    /// (point, element) of the slowest direction per lane; lanes beyond the last point repeat it.
    pub lanes: &'a [(usize, usize)],
}

/// The points of a cell: one element of the first direction, one point of the middle one, a tile of the slowest one.
#[derive(Clone, Copy)]
pub(in crate::assembly) struct Cell<'a, V> {
    /// Number of points.
    pub points: usize,
    /// The map, `[point * numbers(N) + k]`, see `map`; empty if other data were stored.
    pub map: &'a [V],
    /// Data stored in place of the map, `[point * size + k]`.
    pub kept: &'a [V],
    /// W and its derivatives, `[point * (N + 1) + k]`, of a rational basis.
    pub weight: Option<&'a [V]>,
    /// Physical gradients of the state, `[(point * components + c) * N + k]`; empty if there is none.
    pub state: &'a [V],
}

/// F / W and its local derivatives at point `q` from those of the numerator F, where the basis is rational.
#[inline(always)]
pub(super) fn quotient<S: Simd, const N: usize>(simd: S, cell: Cell<'_, S::f64s>, q: usize, g: &mut [S::f64s]) {
    let Some(weight) = cell.weight else { return };
    let w = &weight[q * (N + 1)..][..N + 1];
    let inverse = simd.div_f64s(simd.splat_f64s(1.0), w[0]);
    g[N] = simd.mul_f64s(g[N], inverse);
    for k in 0..N {
        g[k] = simd.mul_f64s(simd.negate_mul_add_e_f64s(g[N], w[1 + k], g[k]), inverse);
    }
}
