//! Loads: forces at the points, contracted with the functions direction by direction; their sum and their first moments.

use super::Patches;
use super::aligned::Aligned;
use super::axis::Axis;
use super::gather::{self, Gather};
use super::grid::{Cell, Grid, Here, Sink, Visit};
use super::map::numbers;
use super::sites::{Answer, Sites};
use crate::linalg::Real;
use pulp::{Simd, bytemuck};
use std::ops::Range;

struct Force<'a, V> {
    axes: &'a [Axis],
    width: usize,
    answer: &'a Answer<'a>,
    sites: Sites,
    forces: Vec<V>,
    gather: Gather<V, 1>,
    t: Aligned<V>,
    /// sum f dx and sum x f dx per component.
    moments: Vec<V>,
}

impl<S: Simd, const N: usize> Visit<S, N> for Force<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, simd: S, _: &[(usize, usize)]) {
        self.gather.start(simd, self.axes);
        self.moments.clear();
        self.moments.resize(self.width * (N + 1), simd.splat_f64s(0.0));
    }

    #[inline(always)]
    fn open(&mut self, simd: S, element: usize) {
        self.gather.open::<S, N>(simd, self.axes, element);
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, here: Here<'_>, cell: Cell<'_, S::f64s>) {
        let width = self.width;
        self.sites.ask::<S, N>(simd, cell, here.lanes, self.answer, width, &mut self.forces);
        self.t.resize(cell.points * width * (N + 1));
        for q in 0..cell.points {
            let map = &cell.map[q * numbers(N)..][..numbers(N)];
            let mut dx = map[N + N * N + 1];
            add_moments::<S, N>(simd, map, &self.forces[q * width..][..width], &mut self.moments);
            if let Some(weight) = cell.weight {
                dx = simd.div_f64s(dx, weight[q * (N + 1)]);
            }
            for c in 0..width {
                self.t[(q * width + c) * (N + 1) + N] = simd.mul_f64s(self.forces[q * width + c], dx);
            }
        }
        let line = self.gather.line::<N>(self.axes, here.middle.1);
        let (axis, e, t) = (&self.axes[0], here.first, &self.t);
        match axis.active {
            2 => gather::cell::<S, N, 1, 2, true>(simd, axis, e, width, t, line),
            3 => gather::cell::<S, N, 1, 3, true>(simd, axis, e, width, t, line),
            4 => gather::cell::<S, N, 1, 4, true>(simd, axis, e, width, t, line),
            5 => gather::cell::<S, N, 1, 5, true>(simd, axis, e, width, t, line),
            _ => gather::cell::<S, N, 1, 6, true>(simd, axis, e, width, t, line),
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
        let moments: &[f64] = bytemuck::cast_slice(&self.moments);
        for (lane, out) in out.chunks_exact_mut(size).enumerate() {
            let out = &mut out[size - self.moments.len()..];
            out.iter_mut().zip(moments[lane..].iter().step_by(S::F64_LANES)).for_each(|(out, &m)| *out = m);
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

struct Run<'a, 'p, 's, const N: usize> {
    grid: Grid<'a, 'p>,
    width: usize,
    answer: &'a Answer<'a>,
    sink: &'a mut Sink<'s>,
}

impl<const N: usize> pulp::WithSimd for Run<'_, '_, '_, N> {
    type Output = ();
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { grid, width, answer, sink } = self;
        let axes = grid.axes;
        let new = || Force {
            axes,
            width,
            answer,
            sites: Sites::default(),
            forces: Vec::new(),
            gather: Gather::new(width),
            t: Aligned::default(),
            moments: Vec::new(),
        };
        let functions: usize = axes[..N - 1].iter().map(|a| a.functions).product();
        grid.walk::<S, N, _>(simd, width * (functions + N + 1), new, sink);
    }
}

impl Patches<'_> {
    /// ∫ f . N dx for forces of `components` components, computed by `answer`; `functions` of the whole. Then the moments,
    /// see [`add_moments`].
    pub fn load<T: Real>(&self, components: usize, functions: usize, answer: &Answer<'_>) -> (Vec<T>, Vec<f64>) {
        let mut out = vec![T::zero(); components * functions];
        let dimension = self.patches.first().map_or(0, |patch| patch.axes.len());
        let mut moments = vec![0.0; components * (dimension + 1)];
        for (k, patch) in self.patches.iter().enumerate() {
            let slow = &patch.axes[dimension - 1];
            let owners = slow.owners();
            let plane = components * patch.functions() / slow.functions.max(1);
            let size = plane + moments.len();
            self.part(k, components).add(patch.functions(), &mut out, |own| {
                let mut sink = |points: Range<usize>, planes: &[f64]| {
                    for numbers in planes.chunks_exact(size).take(points.len()) {
                        moments.iter_mut().zip(&numbers[plane..]).for_each(|(sum, m)| *sum += m);
                    }
                    gather::slow(slow, &owners, (1, size), planes, points, own);
                };
                force(patch.grid(), components, answer, &mut sink);
            });
        }
        (out, moments)
    }
}

fn force(grid: Grid<'_, '_>, width: usize, answer: &Answer<'_>, sink: &mut Sink<'_>) {
    let arch = grid.arch;
    if grid.axes.len() == 2 {
        arch.dispatch(Run::<2> { grid, width, answer, sink });
    } else {
        arch.dispatch(Run::<3> { grid, width, answer, sink });
    }
}
