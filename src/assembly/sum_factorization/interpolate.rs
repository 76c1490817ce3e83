//! Fields on the grid of points: coefficients contracted with the slowest direction, then with the middle one.
//!
//! Lanes are points of the slowest direction, so that no later step mixes them: coefficients become planes (value and
//! derivative along the slowest direction), planes become lines (value, and the derivative along each outer direction).

use super::axis::AxisTable;
use super::simd::{Aligned, rows};
use pulp::{NullaryFnOnce, Simd, bytemuck};

/// Copies coefficients, from a given one on.
pub(super) type Read<'a> = dyn Fn(usize, &mut [f64]) + Sync + 'a;

/// sum_i N_i c_i with `width` numbers c_i per function.
#[derive(Clone, Copy)]
pub(super) struct Coefficients<'a> {
    /// The directions of the functions.
    pub axes: &'a [AxisTable],
    /// Numbers per function.
    pub width: usize,
    /// The numbers, those of one function together.
    pub read: &'a Read<'a>,
}

impl Coefficients<'_> {
    /// Numbers of all functions that share one of the slowest direction.
    pub fn plane(&self) -> usize {
        self.width * self.axes[..self.axes.len() - 1].iter().map(|a| a.functions).product::<usize>()
    }
}

/// Memory of the planes and lines of one field.
#[derive(Clone, Debug)]
pub(super) struct Interpolation<V> {
    tables: Vec<[V; 2]>,
    numbers: Vec<f64>,
    planes: Aligned<V>,
    lines: Aligned<V>,
}

impl<V> Default for Interpolation<V> {
    fn default() -> Self {
        Self { tables: Vec::new(), numbers: Vec::new(), planes: Aligned::default(), lines: Aligned::default() }
    }
}

impl<V: bytemuck::Pod> Interpolation<V> {
    /// Contracts the slowest direction at `points[lane]` = (point, element): `planes[number * 2 + derivative]`.
    pub fn planes<S: Simd<f64s = V>>(&mut self, simd: S, field: Coefficients<'_>, points: &[(usize, usize)]) {
        simd.vectorize(Planes { simd, to: self, field, points });
    }

    #[inline(always)]
    fn planes_here<S: Simd<f64s = V>>(&mut self, simd: S, field: Coefficients<'_>, points: &[(usize, usize)]) {
        let zero = simd.splat_f64s(0.0);
        let axis = &field.axes[field.axes.len() - 1];
        let (mut lo, mut hi) = (usize::MAX, 0);
        for &(_, e) in points {
            (lo, hi) = (lo.min(axis.first[e]), hi.max(axis.first[e] + axis.active));
        }
        self.tables.clear();
        self.tables.resize(hi - lo, [zero; 2]);
        let lanes = S::F64_LANES;
        let tables: &mut [f64] = bytemuck::cast_slice_mut(self.tables.as_flattened_mut());
        for (lane, &(q, e)) in points.iter().enumerate() {
            for a in 0..axis.active {
                let at = 2 * (axis.first[e] + a - lo) * lanes + lane;
                tables[at] = axis.values[q * axis.active + a];
                tables[at + lanes] = axis.slopes[q * axis.active + a];
            }
        }
        let plane = field.plane();
        self.numbers.resize((hi - lo) * plane, 0.0);
        (field.read)(lo * plane, &mut self.numbers);
        self.planes.resize(2 * plane);
        for (j, out) in self.planes.chunks_exact_mut(2).enumerate() {
            let (mut value, mut slope) = (zero, zero);
            for (k, [v, s]) in self.tables.iter().enumerate() {
                let c = simd.splat_f64s(self.numbers[k * plane + j]);
                value = simd.mul_add_e_f64s(*v, c, value);
                slope = simd.mul_add_e_f64s(*s, c, slope);
            }
            (out[0], out[1]) = (value, slope);
        }
    }

    /// Contracts the middle direction of a solid at the points of its element `e`.
    pub fn lines<S: Simd<f64s = V>, const N: usize>(&mut self, simd: S, field: Coefficients<'_>, e: usize) {
        if N == 3 {
            simd.vectorize(LineInterpolation { simd, to: self, field, e });
        }
    }

    #[inline(always)]
    fn lines_here<S: Simd<f64s = V>>(&mut self, simd: S, field: Coefficients<'_>, e: usize) {
        let axis = &field.axes[1];
        let width = field.width * field.axes[0].functions;
        self.lines.resize((axis.start[e + 1] - axis.start[e]) * width * 3);
        match axis.active {
            2 => self.lines_of::<S, 2>(simd, axis, width, e),
            3 => self.lines_of::<S, 3>(simd, axis, width, e),
            4 => self.lines_of::<S, 4>(simd, axis, width, e),
            5 => self.lines_of::<S, 5>(simd, axis, width, e),
            6 => self.lines_of::<S, 6>(simd, axis, width, e),
            // nets of maps may have any degree
            _ => self.lines_of_any(simd, axis, width, e),
        }
    }

    #[inline(always)]
    fn lines_of<S: Simd<f64s = V>, const NP: usize>(&mut self, simd: S, axis: &AxisTable, width: usize, e: usize) {
        let zero = simd.splat_f64s(0.0);
        let points = axis.start[e]..axis.start[e + 1];
        let (values, slopes) = (&rows::<NP>(&axis.values)[points.clone()], &rows::<NP>(&axis.slopes)[points]);
        let planes = &self.planes[axis.first[e] * width * 2..][..NP * width * 2];
        for (out, (values, slopes)) in self.lines.chunks_exact_mut(width * 3).zip(values.iter().zip(slopes)) {
            for (k, out) in out.chunks_exact_mut(3).enumerate() {
                let mut sums = [zero; 3];
                for a in 0..NP {
                    let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
                    let at = &planes[2 * (a * width + k)..][..2];
                    sums[0] = simd.mul_add_e_f64s(at[0], v, sums[0]);
                    sums[1] = simd.mul_add_e_f64s(at[0], s, sums[1]);
                    sums[2] = simd.mul_add_e_f64s(at[1], v, sums[2]);
                }
                out.copy_from_slice(&sums);
            }
        }
    }

    #[inline(always)]
    fn lines_of_any<S: Simd<f64s = V>>(&mut self, simd: S, axis: &AxisTable, width: usize, e: usize) {
        let zero = simd.splat_f64s(0.0);
        let points = axis.start[e]..axis.start[e + 1];
        let planes = &self.planes[axis.first[e] * width * 2..][..axis.active * width * 2];
        for (q, out) in points.zip(self.lines.chunks_exact_mut(width * 3)) {
            let values = &axis.values[q * axis.active..][..axis.active];
            let slopes = &axis.slopes[q * axis.active..][..axis.active];
            for (k, out) in out.chunks_exact_mut(3).enumerate() {
                let mut sums = [zero; 3];
                let mut at = 2 * k;
                for (&v, &s) in values.iter().zip(slopes) {
                    let (v, s) = (simd.splat_f64s(v), simd.splat_f64s(s));
                    let (value, slope) = (planes[at], planes[at + 1]);
                    sums[0] = simd.mul_add_e_f64s(value, v, sums[0]);
                    sums[1] = simd.mul_add_e_f64s(value, s, sums[1]);
                    sums[2] = simd.mul_add_e_f64s(slope, v, sums[2]);
                    at += 2 * width;
                }
                out[0] = sums[0];
                out[1] = sums[1];
                out[2] = sums[2];
            }
        }
    }

    /// The line of the `k`-th point of the element of the middle direction: `[number * N + kind]`, kind 0 the value,
    /// kind d the derivative along direction d.
    #[inline(always)]
    pub fn line<const N: usize>(&self, field: Coefficients<'_>, k: usize) -> &[V] {
        if N == 2 {
            return &self.planes;
        }
        let size = field.width * field.axes[0].functions * 3;
        &self.lines[k * size..][..size]
    }
}

struct Planes<'a, S: Simd> {
    simd: S,
    to: &'a mut Interpolation<S::f64s>,
    field: Coefficients<'a>,
    points: &'a [(usize, usize)],
}

impl<S: Simd> NullaryFnOnce for Planes<'_, S> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.to.planes_here(self.simd, self.field, self.points);
    }
}

struct LineInterpolation<'a, S: Simd> {
    simd: S,
    to: &'a mut Interpolation<S::f64s>,
    field: Coefficients<'a>,
    e: usize,
}

impl<S: Simd> NullaryFnOnce for LineInterpolation<'_, S> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.to.lines_here(self.simd, self.field, self.e);
    }
}

/// Value and derivatives of M numbers per function at point `q` of the first direction, in its element `e`.
#[inline(always)]
pub(super) fn at<S: Simd, const N: usize, const M: usize>(
    simd: S,
    axis: &AxisTable,
    (q, e): (usize, usize),
    line: &[S::f64s],
) -> ([S::f64s; M], [[S::f64s; M]; N]) {
    let zero = simd.splat_f64s(0.0);
    let (mut value, mut slope) = ([zero; M], [[zero; M]; N]);
    let line = line[axis.first[e] * M * N..][..axis.active * M * N].chunks_exact(M * N);
    let tables = axis.values[q * axis.active..].iter().zip(&axis.slopes[q * axis.active..]);
    for (line, (&v, &s)) in line.zip(tables) {
        let (v, s) = (simd.splat_f64s(v), simd.splat_f64s(s));
        for c in 0..M {
            value[c] = simd.mul_add_e_f64s(line[c * N], v, value[c]);
            slope[0][c] = simd.mul_add_e_f64s(line[c * N], s, slope[0][c]);
            for k in 1..N {
                slope[k][c] = simd.mul_add_e_f64s(line[c * N + k], v, slope[k][c]);
            }
        }
    }
    (value, slope)
}

/// Values and gradients of a cell; compiled apart from what is done with them.
pub(super) struct Values<'a, S: Simd, const N: usize> {
    pub simd: S,
    pub axis: &'a AxisTable,
    pub e: usize,
    pub width: usize,
    pub line: &'a [S::f64s],
    pub out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Values<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, axis, e, width, line, out } = self;
        match axis.active {
            2 => cell::<S, N, 2, true>(simd, axis, e, width, line, out),
            3 => cell::<S, N, 3, true>(simd, axis, e, width, line, out),
            4 => cell::<S, N, 4, true>(simd, axis, e, width, line, out),
            5 => cell::<S, N, 5, true>(simd, axis, e, width, line, out),
            _ => cell::<S, N, 6, true>(simd, axis, e, width, line, out),
        }
    }
}

/// Values and derivatives of all numbers per function at the points of element `e` of the first direction:
/// `out[(point * width + number) * (N + 1) + d]`, d = N the value, which is left alone unless VALUE.
#[inline(always)]
pub(super) fn cell<S: Simd, const N: usize, const NP: usize, const VALUE: bool>(
    simd: S,
    axis: &AxisTable,
    e: usize,
    width: usize,
    line: &[S::f64s],
    out: &mut [S::f64s],
) {
    let zero = simd.splat_f64s(0.0);
    let points = axis.start[e]..axis.start[e + 1];
    let line = &line[axis.first[e] * width * N..][..NP * width * N];
    let values = &super::simd::rows::<NP>(&axis.values)[points.clone()];
    let slopes = &super::simd::rows::<NP>(&axis.slopes)[points];
    for c in 0..width {
        let mut own = [[zero; N]; NP];
        for a in 0..NP {
            let from = &line[(a * width + c) * N..][..N];
            own[a].copy_from_slice(from);
        }
        let out = out[c * (N + 1)..].chunks_mut(width * (N + 1));
        for (out, (values, slopes)) in out.zip(values.iter().zip(slopes)) {
            let mut sums = [zero; N];
            let mut value = zero;
            for a in 0..NP {
                let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
                sums[0] = simd.mul_add_e_f64s(own[a][0], s, sums[0]);
                for k in 1..N {
                    sums[k] = simd.mul_add_e_f64s(own[a][k], v, sums[k]);
                }
                if VALUE {
                    value = simd.mul_add_e_f64s(own[a][0], v, value);
                }
            }
            let out = &mut out[..N + 1];
            out[..N].copy_from_slice(&sums);
            if VALUE {
                out[N] = value;
            }
        }
    }
}
