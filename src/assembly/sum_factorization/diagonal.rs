//! The diagonal of the matrix of a form, contracted from squared functions.
//!
//!   A(i, i) = sum_ab sum_q E_ab(q) prod_k N_ik^[a = k] N_ik^[b = k],   a, b directions or the value
//!
//! Per direction only the number of derivatives matters: N², N N', N'².

use super::axis::AxisTable;
use super::cell::{CellPoints, Here};
use super::grid::{QuadratureGrid, Sink, Visit};
use super::point_operator::PointOperator;
use pulp::{Simd, bytemuck};

/// Numbers of derivatives along a direction: none, one, two.
pub(super) const ORDERS: usize = 3;

/// N², N N', N'² at point `q` for local function `a`.
#[inline(always)]
pub(super) fn squares(axis: &AxisTable, q: usize, a: usize) -> [f64; ORDERS] {
    let (v, s) = (axis.values[q * axis.active + a], axis.slopes[q * axis.active + a]);
    [v * v, v * s, s * s]
}

struct Diagonal<'a, V> {
    axes: &'a [AxisTable],
    law: &'a PointOperator<'a>,
    components: usize,
    planes: Vec<V>,
    lines: Vec<V>,
    g: Vec<V>,
    h: Vec<V>,
    tangents: Vec<V>,
    buffer: Vec<f64>,
}

impl<V: bytemuck::Pod> Diagonal<'_, V> {
    /// Kinds of a line: pairs of orders along the outer directions.
    const fn kinds(n: usize) -> usize {
        if n == 3 { ORDERS * ORDERS } else { ORDERS }
    }
}

impl<S: Simd, const N: usize> Visit<S, N> for Diagonal<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, simd: S, _: &[(usize, usize)]) {
        let functions: usize = self.axes[..N - 1].iter().map(|a| a.functions).product();
        self.planes.clear();
        self.planes.resize(self.components * functions * ORDERS, simd.splat_f64s(0.0));
    }

    #[inline(always)]
    fn open(&mut self, simd: S, e: usize) {
        let points = if N == 3 { self.axes[1].start[e + 1] - self.axes[1].start[e] } else { 1 };
        self.lines.clear();
        self.lines.resize(points * self.components * self.axes[0].functions * Self::kinds(N), simd.splat_f64s(0.0));
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, S::f64s>) {
        let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
        let (axis, width) = (&self.axes[0], self.components);
        self.law.tangents::<S, N>(simd, width, cell, &mut self.buffer, &mut self.tangents);
        let tangents = if matches!(self.law, PointOperator::Kept { .. }) { cell.kept } else { &self.tangents };
        let (size, map_size) = (tangents.len() / cell.points.max(1), cell.map.len() / cell.points.max(1));
        self.h.resize(2 * width * N, zero);
        let line = here.middle.1 * axis.functions * width * Self::kinds(N);
        for k in 0..cell.points {
            let q = axis.start[here.first] + k;
            let weight = cell.weight.map(|w| &w[k * (N + 1)..][..N + 1]);
            let (map, tangent) = (&cell.map[k * map_size..][..map_size], &tangents[k * size..][..size]);
            for c in 0..width {
                for b in 0..if weight.is_some() { N + 1 } else { N } {
                    self.g.clear();
                    self.g.resize(width * (N + 1), zero);
                    self.g[c * (N + 1) + b] = one;
                    self.law.respond::<S, N>(simd, map, weight, tangent, &mut self.g, &mut self.h);
                    for a in 0..if weight.is_some() { N + 1 } else { N } {
                        let order = |d: usize| usize::from(a == d) + usize::from(b == d);
                        let kind = if N == 3 { order(1) * ORDERS + order(2) } else { order(1) };
                        let entry = self.g[c * (N + 1) + a];
                        for i in 0..axis.active {
                            let square = simd.splat_f64s(squares(axis, q, i)[order(0)]);
                            let to = line + ((axis.first[here.first] + i) * width + c) * Self::kinds(N) + kind;
                            self.lines[to] = simd.mul_add_e_f64s(entry, square, self.lines[to]);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn close(&mut self, simd: S, e: usize) {
        if N == 2 {
            self.planes.copy_from_slice(&self.lines);
            return;
        }
        let axis = &self.axes[1];
        let width = self.components * self.axes[0].functions;
        for (k, q) in (axis.start[e]..axis.start[e + 1]).enumerate() {
            for a in 0..axis.active {
                let squares = squares(axis, q, a);
                for number in 0..width {
                    let line = &self.lines[(k * width + number) * ORDERS * ORDERS..][..ORDERS * ORDERS];
                    let plane = &mut self.planes[((axis.first[e] + a) * width + number) * ORDERS..][..ORDERS];
                    for middle in 0..ORDERS {
                        for slow in 0..ORDERS {
                            plane[slow] = simd.mul_add_e_f64s(line[middle * ORDERS + slow], simd.splat_f64s(squares[middle]), plane[slow]);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn end(&mut self, _: S, out: &mut [f64]) {
        let planes: &[f64] = bytemuck::cast_slice(&self.planes);
        for (lane, out) in out.chunks_exact_mut(self.planes.len()).enumerate() {
            for (k, out) in out.iter_mut().enumerate() {
                *out = planes[k * S::F64_LANES + lane];
            }
        }
    }
}

struct DiagonalSweep<'a, 'p, 's, const N: usize> {
    grid: QuadratureGrid<'a, 'p>,
    law: &'a PointOperator<'a>,
    components: usize,
    sink: &'a mut Sink<'s>,
}

impl<const N: usize> pulp::WithSimd for DiagonalSweep<'_, '_, '_, N> {
    type Output = ();
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { grid, law, components, sink } = self;
        let axes = grid.axes;
        let new = || Diagonal {
            axes,
            law,
            components,
            planes: Vec::new(),
            lines: Vec::new(),
            g: Vec::new(),
            h: Vec::new(),
            tangents: Vec::new(),
            buffer: Vec::new(),
        };
        let functions: usize = axes[..N - 1].iter().map(|a| a.functions).product();
        grid.walk::<S, N, _>(simd, components * functions * ORDERS, new, sink);
    }
}

/// Squared contractions of all but the slowest direction, point by point of it: `number * ORDERS + order`.
pub(super) fn diagonal(grid: QuadratureGrid<'_, '_>, law: &PointOperator<'_>, components: usize, sink: &mut Sink<'_>) {
    let arch = grid.arch;
    if grid.axes.len() == 2 {
        arch.dispatch(DiagonalSweep::<2> { grid, law, components, sink });
    } else {
        arch.dispatch(DiagonalSweep::<3> { grid, law, components, sink });
    }
}
