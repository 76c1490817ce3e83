//! Loads: forces at the points, contracted with the functions direction by direction.

use super::Patches;
use super::aligned::Aligned;
use super::axis::Axis;
use super::gather::{self, Gather};
use super::grid::{Cell, Grid, Here, Sink, Visit};
use super::map::numbers;
use super::sites::{Answer, Sites};
use crate::linalg::Real;
use pulp::Simd;
use std::ops::Range;

struct Force<'a, V> {
    axes: &'a [Axis],
    width: usize,
    answer: &'a Answer<'a>,
    sites: Sites,
    forces: Vec<V>,
    gather: Gather<V, 1>,
    t: Aligned<V>,
}

impl<S: Simd, const N: usize> Visit<S, N> for Force<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, simd: S, _: &[(usize, usize)]) {
        self.gather.start(simd, self.axes);
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
            let mut dx = cell.map[q * numbers(N) + N + N * N + 1];
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
        self.gather.end(simd, out);
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
        };
        let functions: usize = axes[..N - 1].iter().map(|a| a.functions).product();
        grid.walk::<S, N, _>(simd, width * functions, new, sink);
    }
}

impl Patches<'_> {
    /// ∫ f . N dx for forces of `components` components, which `answer` gives; `functions` of the whole.
    pub fn load<T: Real>(&self, components: usize, functions: usize, answer: &Answer<'_>) -> Vec<T> {
        let mut out = vec![T::zero(); components * functions];
        for (k, patch) in self.patches.iter().enumerate() {
            let slow = &patch.axes[patch.axes.len() - 1];
            let owners = slow.owners();
            self.part(k, components).add(patch.functions(), &mut out, |own| {
                let mut sink = |points: Range<usize>, planes: &[f64]| gather::slow(slow, &owners, 1, planes, points, own);
                force(patch.grid(), components, answer, &mut sink);
            });
        }
        out
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
