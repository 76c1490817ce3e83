//! Loads: forces at the points, contracted with the functions direction by direction; their sum and their first moments. Internal
//! forces: stresses at the points, contracted with the gradients of the functions; the energy.

use super::axis::AxisTable;
use super::cell::{CellPoints, Here};
use super::grid::{PointCallback, QuadratureGrid, QuadraturePoints, Sink, Visit};
use super::integrate::{self, Gather};
use super::map::numbers;
use super::simd::Aligned;
use super::states::State;
use super::{Patches, point_operator};
use crate::linalg::{Real, to_f64};
use pulp::{Simd, bytemuck};
use std::ops::Range;

/// Forces times values of the functions (K = 1), or stresses times their gradients (K = N).
struct Force<'a, V, const K: usize> {
    axes: &'a [AxisTable],
    width: usize,
    answer: &'a PointCallback<'a>,
    sites: QuadraturePoints,
    answers: Vec<V>,
    gather: Gather<V, K>,
    t: Aligned<V>,
    /// Moments of forces, see [`add_moments`], or the energy.
    sums: Vec<V>,
}

/// Numbers of an answer, and of the sums.
const fn sizes<const N: usize, const K: usize>(width: usize) -> (usize, usize) {
    if K == 1 { (width, width * (N + 1)) } else { (width * N + 1, 1) }
}

impl<S: Simd, const N: usize, const K: usize> Visit<S, N> for Force<'_, S::f64s, K> {
    #[inline(always)]
    fn start(&mut self, simd: S, _: &[(usize, usize)]) {
        self.gather.start(simd, self.axes);
        self.sums.clear();
        self.sums.resize(sizes::<N, K>(self.width).1, simd.splat_f64s(0.0));
    }

    #[inline(always)]
    fn open(&mut self, simd: S, element: usize) {
        self.gather.open::<S, N>(simd, self.axes, element);
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, S::f64s>) {
        let (width, (size, _)) = (self.width, sizes::<N, K>(self.width));
        if K > 1 {
            self.sites.locate::<N>(self.axes, here);
        }
        self.sites.ask::<S, N>(simd, cell, here.lanes, self.answer, size, &mut self.answers);
        self.t.resize(cell.points * width * (N + 1));
        for q in 0..cell.points {
            let map = &cell.map[q * numbers(N)..][..numbers(N)];
            let (answers, t) = (&self.answers[q * size..][..size], &mut self.t[q * width * (N + 1)..][..width * (N + 1)]);
            let mut dx = map[N + N * N + 1];
            if K > 1 {
                let weight = cell.weight.map(|w| &w[q * (N + 1)..][..N + 1]);
                point_operator::tested::<S, N>(simd, map, weight, &answers[..width * N], t);
                self.sums[0] = simd.mul_add_e_f64s(answers[width * N], dx, self.sums[0]);
                continue;
            }
            add_moments::<S, N>(simd, map, answers, &mut self.sums);
            if let Some(weight) = cell.weight {
                dx = simd.div_f64s(dx, weight[q * (N + 1)]);
            }
            for c in 0..width {
                t[c * (N + 1) + N] = simd.mul_f64s(answers[c], dx);
            }
        }
        let line = self.gather.line::<N>(self.axes, here.middle.1);
        let (axis, e, t) = (&self.axes[0], here.first, &self.t);
        match axis.active {
            2 => integrate::cell::<S, N, K, 2, true>(simd, axis, e, width, t, line),
            3 => integrate::cell::<S, N, K, 3, true>(simd, axis, e, width, t, line),
            4 => integrate::cell::<S, N, K, 4, true>(simd, axis, e, width, t, line),
            5 => integrate::cell::<S, N, K, 5, true>(simd, axis, e, width, t, line),
            _ => integrate::cell::<S, N, K, 6, true>(simd, axis, e, width, t, line),
        }
    }

    #[inline(always)]
    fn close(&mut self, simd: S, element: usize) {
        self.gather.close::<S, N>(simd, self.axes, element);
    }

    #[inline(always)]
    fn end(&mut self, simd: S, out: &mut [f64]) {
        let size = out.len() / S::F64_LANES;
        self.gather.end(simd, out, size);
        let sums: &[f64] = bytemuck::cast_slice(&self.sums);
        for (lane, out) in out.chunks_exact_mut(size).enumerate() {
            let out = &mut out[size - self.sums.len()..];
            out.iter_mut().zip(sums[lane..].iter().step_by(S::F64_LANES)).for_each(|(out, &sum)| *out = sum);
        }
    }
}

/// Adds force times dx, and that times x, at a point: `moments[component * (N + 1) + k]`, k = N without x.
#[inline(always)]
pub(in crate::assembly) fn add_moments<S: Simd, const N: usize>(simd: S, map: &[S::f64s], forces: &[S::f64s], moments: &mut [S::f64s]) {
    let dx = map[N + N * N + 1];
    for (&force, moments) in forces.iter().zip(moments.chunks_exact_mut(N + 1)) {
        let force = simd.mul_f64s(force, dx);
        for k in 0..N {
            moments[k] = simd.mul_add_e_f64s(force, map[k], moments[k]);
        }
        moments[N] = simd.add_f64s(moments[N], force);
    }
}

struct ForceSweep<'a, 'p, 's, const N: usize, const K: usize> {
    grid: QuadratureGrid<'a, 'p>,
    width: usize,
    answer: &'a PointCallback<'a>,
    sink: &'a mut Sink<'s>,
}

impl<const N: usize, const K: usize> pulp::WithSimd for ForceSweep<'_, '_, '_, N, K> {
    type Output = ();
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { grid, width, answer, sink } = self;
        let axes = grid.axes;
        let new = || Force::<S::f64s, K> {
            axes,
            width,
            answer,
            sites: QuadraturePoints::default(),
            answers: Vec::new(),
            gather: Gather::new(width),
            t: Aligned::default(),
            sums: Vec::new(),
        };
        let functions: usize = axes[..N - 1].iter().map(|a| a.functions).product();
        grid.walk::<S, N, _>(simd, width * functions * integrate::plane_kinds(K) + sizes::<N, K>(width).1, new, sink);
    }
}

impl Patches<'_> {
    /// ∫ f . N dx for forces of `components` components, computed by `answer`; `functions` of the whole. Then the moments,
    /// see [`add_moments`].
    pub fn load<T: Real>(&self, components: usize, functions: usize, answer: &PointCallback<'_>) -> (Vec<T>, Vec<f64>) {
        self.forces(components, functions, None, answer)
    }

    /// ∫ P : grad N dx for the stress P and the energy density computed by `answer` from the gradient of `u` (empty: zero);
    /// `functions` of the whole. Then the energy.
    pub fn internal_force<T: Real>(&self, components: usize, functions: usize, u: &[T], answer: &PointCallback<'_>) -> (Vec<T>, f64) {
        let u: Vec<f64> = u.iter().map(|&u| to_f64(u)).collect();
        let (forces, energy) = self.forces(components, functions, Some(&u), answer);
        (forces, energy.iter().sum())
    }

    /// Forces times functions, or, with a `state`, stresses times their gradients; then the sums beside them.
    fn forces<T: Real>(
        &self,
        components: usize,
        functions: usize,
        state: Option<&[f64]>,
        answer: &PointCallback<'_>,
    ) -> (Vec<T>, Vec<f64>) {
        let mut out = vec![T::zero(); components * functions];
        let dimension = self.patches.first().map_or(0, |patch| patch.axes.len());
        let kinds = if state.is_some() { integrate::plane_kinds(dimension) } else { 1 };
        let mut sums = vec![0.0; if state.is_some() { 1 } else { components * (dimension + 1) }];
        for (k, patch) in self.patches.iter().enumerate() {
            let slow = &patch.axes[dimension - 1];
            let owners = slow.owners();
            let plane = kinds * components * patch.functions() / slow.functions.max(1);
            let size = plane + sums.len();
            let part = self.part(k, components);
            part.add(patch.functions(), &mut out, |own| {
                let mut sink = |points: Range<usize>, planes: &[f64]| {
                    for numbers in planes.chunks_exact(size).take(points.len()) {
                        sums.iter_mut().zip(&numbers[plane..]).for_each(|(sum, m)| *sum += m);
                    }
                    integrate::slow(slow, &owners, (kinds, size), planes, points, own);
                };
                let grid = QuadratureGrid { state: state.map(|u| State { part, u }), ..patch.grid() };
                force(grid, components, answer, &mut sink);
            });
        }
        (out, sums)
    }
}

fn force(grid: QuadratureGrid<'_, '_>, width: usize, answer: &PointCallback<'_>, sink: &mut Sink<'_>) {
    let arch = grid.arch;
    match (grid.axes.len(), grid.state.is_some()) {
        (2, false) => arch.dispatch(ForceSweep::<2, 1> { grid, width, answer, sink }),
        (2, true) => arch.dispatch(ForceSweep::<2, 2> { grid, width, answer, sink }),
        (_, false) => arch.dispatch(ForceSweep::<3, 1> { grid, width, answer, sink }),
        (_, true) => arch.dispatch(ForceSweep::<3, 3> { grid, width, answer, sink }),
    }
}
