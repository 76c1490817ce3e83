//! Squares of a field's values, gradients and energy against another field, summed over the grid.
//!
//! Every point of the slowest direction has sums of its own, cell by cell; they are added in ascending order.

use super::Patches;
use super::cell::{CellPoints, Here, quotient};
use super::grid::{PointCallback, QuadratureGrid, QuadraturePoints, Visit};
use super::interpolate::{Coefficients, Interpolation, Values};
use super::map::{inverse, numbers};
use super::point_operator::{self, PointOperator};
use super::simd::Aligned;
use crate::assembly::Form;
use crate::assembly::source::Integrand;
use crate::linalg::Real;
use pulp::{Simd, bytemuck};
use std::ops::Range;

struct Deviation<'a, V> {
    field: Coefficients<'a>,
    answer: &'a PointCallback<'a>,
    sites: QuadraturePoints,
    /// Values and gradients of the other field, `C + C N` numbers per point.
    other: Vec<V>,
    spread: Interpolation<V>,
    g: Aligned<V>,
    squares: Squares<'a, V>,
    sums: [V; SQUARES],
}

impl<S: Simd, const N: usize> Visit<S, N> for Deviation<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, simd: S, lanes: &[(usize, usize)]) {
        self.spread.planes(simd, self.field, lanes);
        self.sums = [simd.splat_f64s(0.0); SQUARES];
    }

    #[inline(always)]
    fn open(&mut self, simd: S, element: usize) {
        self.spread.lines::<S, N>(simd, self.field, element);
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, S::f64s>) {
        self.add::<S, N>(simd, here, cell);
    }

    #[inline(always)]
    fn close(&mut self, _: S, _: usize) {}

    #[inline(always)]
    fn end(&mut self, _: S, out: &mut [f64]) {
        let sums: &[f64] = bytemuck::cast_slice(&self.sums);
        for (lane, out) in out.chunks_exact_mut(SQUARES).enumerate() {
            for (k, out) in out.iter_mut().enumerate() {
                *out = sums[k * S::F64_LANES + lane];
            }
        }
    }
}

impl<V: bytemuck::Pod> Deviation<'_, V> {
    #[inline(always)]
    fn add<S: Simd<f64s = V>, const N: usize>(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, V>) {
        let (axes, width) = (self.field.axes, self.field.width);
        self.sites.locate::<N>(axes, here);
        self.sites.ask::<S, N>(simd, cell, here.lanes, self.answer, width * (N + 1), &mut self.other);
        self.g.resize(cell.points * width * (N + 1));
        let line = self.spread.line::<N>(self.field, here.middle.1);
        simd.vectorize(Values::<'_, S, N> { simd, axis: &axes[0], e: here.first, width, line, out: &mut self.g });
        let sums = self.squares.of::<S, N>(simd, cell, &mut self.g, &self.other);
        for k in 0..SQUARES {
            self.sums[k] = simd.add_f64s(self.sums[k], sums[k]);
        }
    }
}

struct NormSweep<'a, 'p, const N: usize> {
    grid: QuadratureGrid<'a, 'p>,
    field: Coefficients<'a>,
    law: &'a PointOperator<'a>,
    answer: &'a PointCallback<'a>,
}

impl<const N: usize> pulp::WithSimd for NormSweep<'_, '_, N> {
    type Output = [f64; SQUARES];
    fn with_simd<S: Simd>(self, simd: S) -> [f64; SQUARES] {
        let mut total = [0.0; SQUARES];
        if S::IS_SCALAR {
            return total;
        }
        let Self { grid, field, law, answer } = self;
        let new = || Deviation {
            field,
            answer,
            sites: QuadraturePoints::default(),
            other: Vec::new(),
            spread: Interpolation::default(),
            g: Aligned::default(),
            squares: Squares::new(law, field.width),
            sums: [simd.splat_f64s(0.0); SQUARES],
        };
        grid.walk::<S, N, _>(simd, SQUARES, new, &mut |points: Range<usize>, sums: &[f64]| {
            for sums in sums.chunks_exact(SQUARES).take(points.len()) {
                total.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
            }
        });
        total
    }
}

impl Patches<'_> {
    /// The sums of squares of the difference between the field `u` (empty: zero) and the one of `answer`: C values, then
    /// C N derivatives.
    pub fn deviation<const C: usize, const N: usize, T: Real>(
        &self,
        form: &Form<'_, C, N, T>,
        u: &[T],
        answer: &PointCallback<'_>,
    ) -> [f64; SQUARES] {
        let source = Integrand::new(form);
        let mut total = [0.0; SQUARES];
        let Some(law) = PointOperator::new::<N>(&source, C) else { return total };
        for (k, patch) in self.patches.iter().enumerate() {
            let part = self.part(k, C);
            let read = |from: usize, to: &mut [f64]| part.read(u, from, to);
            let field = Coefficients { axes: &patch.axes, width: C, read: &read };
            let (grid, law) = (patch.grid().with_state(part, &source), &law);
            let sums = if N == 2 {
                patch.arch.dispatch(NormSweep::<2> { grid, field, law, answer })
            } else {
                patch.arch.dispatch(NormSweep::<3> { grid, field, law, answer })
            };
            total.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
        }
        total
    }
}

/// Squares that are summed: value, gradient, energy of the difference, then of the other field.
pub(in crate::assembly) const SQUARES: usize = 6;

/// Sums squares; what it needs in between is kept from cell to cell.
pub(in crate::assembly) struct Squares<'a, V> {
    law: &'a PointOperator<'a>,
    width: usize,
    h: Vec<V>,
    stress: Vec<V>,
    tangents: Vec<V>,
    buffer: Vec<f64>,
}

impl<'a, V: bytemuck::Pod> Squares<'a, V> {
    /// For fields of `width` components, with the energy of `law`.
    pub fn new(law: &'a PointOperator<'a>, width: usize) -> Self {
        Self { law, width, h: Vec::new(), stress: Vec::new(), tangents: Vec::new(), buffer: Vec::new() }
    }

    /// The sums over the points of a cell. The field has local derivatives and values `g[(point * width + c) * (N + 1) + d]`
    /// (d = N: value; numerators, where it is rational), the other one values, then derivatives, `width * (N + 1)` numbers
    /// per point.
    #[inline(always)]
    pub fn of<S: Simd<f64s = V>, const N: usize>(&mut self, simd: S, cell: CellPoints<'_, V>, g: &mut [V], other: &[V]) -> [V; SQUARES] {
        let width = self.width;
        let zero = simd.splat_f64s(0.0);
        self.law.tangents::<S, N>(simd, width, cell, &mut self.buffer, &mut self.tangents);
        let size = self.tangents.len() / cell.points.max(1);
        self.h.resize(width * N, zero);
        self.stress.resize(width * N, zero);
        let mut sums = [zero; SQUARES];
        for q in 0..cell.points {
            let map = &cell.map[q * numbers(N)..][..numbers(N)];
            let tangent = &self.tangents[q * size..][..size];
            let other = &other[q * width * (N + 1)..][..width * (N + 1)];
            let (dx, r) = (map[N + N * N + 1], inverse::<S, N>(simd, map));
            let mut squares = [zero; SQUARES];
            for c in 0..width {
                let g = &mut g[(q * width + c) * (N + 1)..][..N + 1];
                quotient::<S, N>(simd, cell, q, g);
                let own = point_operator::physical::<S, N>(simd, &r, g);
                let value = simd.sub_f64s(g[N], other[c]);
                squares[0] = simd.mul_add_e_f64s(value, value, squares[0]);
                squares[3] = simd.mul_add_e_f64s(other[c], other[c], squares[3]);
                for j in 0..N {
                    let there = other[width + c * N + j];
                    let apart = simd.sub_f64s(own[j], there);
                    self.h[c * N + j] = apart;
                    squares[1] = simd.mul_add_e_f64s(apart, apart, squares[1]);
                    squares[4] = simd.mul_add_e_f64s(there, there, squares[4]);
                }
            }
            self.law.stress::<S, N>(simd, tangent, &self.h, &mut self.stress);
            squares[2] = dot(simd, &self.stress, &self.h);
            self.law.stress::<S, N>(simd, tangent, &other[width..], &mut self.stress);
            squares[5] = dot(simd, &self.stress, &other[width..]);
            for k in 0..SQUARES {
                sums[k] = simd.mul_add_e_f64s(dx, squares[k], sums[k]);
            }
        }
        sums
    }
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[S::f64s], b: &[S::f64s]) -> S::f64s {
    let mut sum = simd.splat_f64s(0.0);
    for (a, b) in a.iter().zip(b) {
        sum = simd.mul_add_e_f64s(*a, *b, sum);
    }
    sum
}
