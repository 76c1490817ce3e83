//! The transposed way: numbers at points contracted with the functions, one direction after the other.
//!
//! Mirrors `spread`: lines (K = N kinds, or the value alone: K = 1), planes (two kinds, or one), sums. The slowest
//! direction is summed point by point in ascending order, so that the bits depend neither on lanes nor on threads.

use super::axis::AxisTable;
use super::simd::{Aligned, rows};
use crate::linalg::{Real, lit};
use crate::parallel;
use pulp::{NullaryFnOnce, Simd, bytemuck};
use std::ops::Range;

/// Memory of the lines and planes of one field of `width` numbers per function.
#[derive(Clone, Debug)]
pub(super) struct Gather<V, const K: usize> {
    width: usize,
    lines: Aligned<V>,
    planes: Aligned<V>,
}

/// Kinds of a plane whose lines have K.
pub(super) const fn plane_kinds(k: usize) -> usize {
    if k == 1 { 1 } else { 2 }
}

impl<V: bytemuck::Pod, const K: usize> Gather<V, K> {
    pub fn new(width: usize) -> Self {
        Self { width, lines: Aligned::default(), planes: Aligned::default() }
    }

    /// Starts a tile.
    #[inline(always)]
    pub fn start<S: Simd<f64s = V>>(&mut self, _simd: S, axes: &[AxisTable]) {
        let functions: usize = axes[..axes.len() - 1].iter().map(|a| a.functions).product();
        self.planes.zeros(self.width * functions * plane_kinds(K));
    }

    /// Starts an element of the middle direction.
    #[inline(always)]
    pub fn open<S: Simd<f64s = V>, const N: usize>(&mut self, _simd: S, axes: &[AxisTable], e: usize) {
        if N == 3 {
            let points = axes[1].start[e + 1] - axes[1].start[e];
            self.lines.zeros(points * self.width * axes[0].functions * K);
        }
    }

    /// The line of the `k`-th point of the element of the middle direction, to add to.
    #[inline(always)]
    pub fn line<const N: usize>(&mut self, axes: &[AxisTable], k: usize) -> &mut [V] {
        if N == 2 {
            return &mut self.planes;
        }
        let size = self.width * axes[0].functions * K;
        &mut self.lines[k * size..][..size]
    }

    /// Contracts the lines of element `e` of the middle direction.
    pub fn close<S: Simd<f64s = V>, const N: usize>(&mut self, simd: S, axes: &[AxisTable], e: usize) {
        if N == 3 {
            simd.vectorize(Close { simd, to: self, axes, e });
        }
    }

    #[inline(always)]
    fn middle<S: Simd<f64s = V>, const NP: usize>(&mut self, simd: S, axes: &[AxisTable], e: usize) {
        let zero = simd.splat_f64s(0.0);
        let axis = &axes[1];
        let points = axis.start[e]..axis.start[e + 1];
        let (values, slopes) = (&rows::<NP>(&axis.values)[points.clone()], &rows::<NP>(&axis.slopes)[points]);
        let width = self.width * axes[0].functions;
        let kinds = plane_kinds(K);
        let planes = &mut self.planes[axis.first[e] * width * kinds..][..NP * width * kinds];
        for k in 0..width {
            let mut sums = [[zero; 2]; NP];
            for a in 0..NP {
                for kind in 0..kinds {
                    sums[a][kind] = planes[(a * width + k) * kinds + kind];
                }
            }
            let lines = self.lines[k * K..].chunks(width * K);
            for (line, (values, slopes)) in lines.zip(values.iter().zip(slopes)) {
                for a in 0..NP {
                    let v = simd.splat_f64s(values[a]);
                    sums[a][0] = simd.mul_add_e_f64s(line[0], v, sums[a][0]);
                    if K == 3 {
                        sums[a][0] = simd.mul_add_e_f64s(line[1], simd.splat_f64s(slopes[a]), sums[a][0]);
                        sums[a][1] = simd.mul_add_e_f64s(line[2], v, sums[a][1]);
                    }
                }
            }
            for a in 0..NP {
                for kind in 0..kinds {
                    planes[(a * width + k) * kinds + kind] = sums[a][kind];
                }
            }
        }
    }

    /// Planes by points: `out[lane * size + kind * numbers + number]`.
    #[inline(always)]
    pub fn end<S: Simd<f64s = V>>(&self, _simd: S, out: &mut [f64], size: usize) {
        let kinds = plane_kinds(K);
        let numbers = self.planes.len() / kinds;
        let planes: &[f64] = bytemuck::cast_slice(&self.planes[..]);
        for (lane, out) in out.chunks_exact_mut(size).enumerate() {
            for kind in 0..kinds {
                let from = planes[kind * S::F64_LANES + lane..].iter().step_by(kinds * S::F64_LANES);
                out[kind * numbers..(kind + 1) * numbers].iter_mut().zip(from).for_each(|(to, &value)| *to = value);
            }
        }
    }
}

struct Close<'a, S: Simd, const K: usize> {
    simd: S,
    to: &'a mut Gather<S::f64s, K>,
    axes: &'a [AxisTable],
    e: usize,
}

impl<S: Simd, const K: usize> NullaryFnOnce for Close<'_, S, K> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, to, axes, e } = self;
        match axes[1].active {
            2 => to.middle::<S, 2>(simd, axes, e),
            3 => to.middle::<S, 3>(simd, axes, e),
            4 => to.middle::<S, 4>(simd, axes, e),
            5 => to.middle::<S, 5>(simd, axes, e),
            _ => to.middle::<S, 6>(simd, axes, e),
        }
    }
}

/// Adds the element `e` of the first direction: `t[(point * width + number) * (N + 1) + d]`, d = N what meets the value.
#[inline(always)]
pub(super) fn cell<S: Simd, const N: usize, const K: usize, const NP: usize, const VALUE: bool>(
    simd: S,
    axis: &AxisTable,
    e: usize,
    width: usize,
    t: &[S::f64s],
    line: &mut [S::f64s],
) {
    let zero = simd.splat_f64s(0.0);
    let points = axis.start[e]..axis.start[e + 1];
    let line = &mut line[axis.first[e] * width * K..][..NP * width * K];
    let (values, slopes) = (&rows::<NP>(&axis.values)[points.clone()], &rows::<NP>(&axis.slopes)[points]);
    for c in 0..width {
        let mut sums = [[zero; K]; NP];
        for a in 0..NP {
            for k in 0..K {
                sums[a][k] = line[(a * width + c) * K + k];
            }
        }
        let t = t[c * (N + 1)..].chunks(width * (N + 1));
        for (t, (values, slopes)) in t.zip(values.iter().zip(slopes)) {
            let t = &t[..N + 1];
            for a in 0..NP {
                let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
                if VALUE {
                    sums[a][0] = simd.mul_add_e_f64s(t[N], v, sums[a][0]);
                }
                if K > 1 {
                    sums[a][0] = simd.mul_add_e_f64s(t[0], s, sums[a][0]);
                    for k in 1..K {
                        sums[a][k] = simd.mul_add_e_f64s(t[k], v, sums[a][k]);
                    }
                }
            }
        }
        for a in 0..NP {
            for k in 0..K {
                line[(a * width + c) * K + k] = sums[a][k];
            }
        }
    }
}

/// Adds the slowest direction at its points `points`, planes by points at the front of `size` numbers each, to `out`.
pub(super) fn slow<T: Real>(
    axis: &AxisTable,
    owners: &[usize],
    (kinds, size): (usize, usize),
    planes: &[f64],
    points: Range<usize>,
    out: &mut [T],
) {
    let numbers = out.len() / axis.functions.max(1);
    if numbers == 0 || points.is_empty() {
        return;
    }
    let (from, to) = (axis.first[owners[points.start]], axis.first[owners[points.end - 1]] + axis.active);
    parallel::for_each(out[from * numbers..to * numbers].chunks_mut(numbers).enumerate(), |(k, out)| {
        let i = from + k;
        let support = axis.start[axis.support[i].0]..axis.start[axis.support[i].1];
        for q in support.start.max(points.start)..support.end.min(points.end) {
            let at = q * axis.active + i - axis.first[owners[q]];
            let (v, s) = (axis.values[at], axis.slopes[at]);
            let plane = &planes[(q - points.start) * size..][..kinds * numbers];
            let (values, slopes) = plane.split_at(numbers);
            if kinds == 1 {
                out.iter_mut().zip(values).for_each(|(to, x)| *to += lit(v * x));
            } else {
                out.iter_mut().zip(values).zip(slopes).for_each(|((to, x), y)| *to += lit(v * x + s * y));
            }
        }
    });
}
