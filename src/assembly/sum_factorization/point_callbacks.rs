//! Points of a cell passed to a closure, and its values put back in lanes.

use super::axis::Axis;
use super::cell::{Cell, Here};
use super::map::numbers;
use pulp::{Simd, bytemuck};

/// The points of a cell, those of one lane together.
#[derive(Clone, Debug, Default)]
pub(in crate::assembly) struct QuadraturePoints {
    /// Physical points, N numbers each.
    pub x: Vec<f64>,
    /// Element per lane.
    pub elements: Vec<usize>,
    /// Local points, N numbers each; set by [`Self::locate`] or the caller.
    pub xi: Vec<f64>,
    /// First point per lane, counted in the rule of its element; set as `xi`.
    pub first: Vec<usize>,
    /// Physical gradients of the state, component by component; empty if there is none.
    pub gradients: Vec<f64>,
    answers: Vec<f64>,
}

/// Closure that writes values at all points of a cell, `size` numbers each.
pub(in crate::assembly) type PointCallback<'a> = dyn Fn(&QuadraturePoints, &mut [f64]) + Sync + 'a;

impl QuadraturePoints {
    /// Calls `answer` at all points of a cell: `out[point * size + number]`, zero in lanes beyond the last point.
    #[inline(always)]
    pub(in crate::assembly) fn ask<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        cell: Cell<'_, S::f64s>,
        lanes: &[(usize, usize)],
        answer: &PointCallback<'_>,
        size: usize,
        out: &mut Vec<S::f64s>,
    ) {
        let valid = 1 + lanes.windows(2).take_while(|w| w[0].0 != w[1].0).count();
        let (width, count) = (S::F64_LANES, cell.points);
        self.x.resize(valid * count * N, 0.0);
        let map: &[f64] = bytemuck::cast_slice(cell.map);
        for lane in 0..valid {
            for q in 0..count {
                for k in 0..N {
                    self.x[(lane * count + q) * N + k] = map[(q * numbers(N) + k) * width + lane];
                }
            }
        }
        let rows = cell.state.len() / count.max(1);
        self.gradients.resize(valid * count * rows, 0.0);
        let state: &[f64] = bytemuck::cast_slice(cell.state);
        for (lane, own) in self.gradients.chunks_exact_mut((count * rows).max(1)).enumerate() {
            own.iter_mut().enumerate().for_each(|(k, g)| *g = state[k * width + lane]);
        }
        self.answers.resize(valid * count * size, 0.0);
        let mut answers = std::mem::take(&mut self.answers);
        answer(self, &mut answers);
        out.clear();
        out.resize(count * size, simd.splat_f64s(0.0));
        let numbers: &mut [f64] = bytemuck::cast_slice_mut(out);
        for (lane, answers) in answers.chunks_exact((count * size).max(1)).enumerate() {
            for (k, &value) in answers.iter().enumerate() {
                numbers[k * width + lane] = value;
            }
        }
        self.answers = answers;
    }

    /// Sets elements and local points of a cell, for closures that depend on them.
    pub(super) fn locate<const N: usize>(&mut self, axes: &[Axis], here: Here<'_>) {
        let along = axes[0].start[here.first]..axes[0].start[here.first + 1];
        let counts = [axes[0].elements(), if N == 3 { axes[1].elements() } else { 1 }];
        self.elements.clear();
        self.xi.clear();
        self.first.clear();
        let middle = if N == 3 { axes[1].start[here.middle_element + 1] - axes[1].start[here.middle_element] } else { 1 };
        for &(q, slow) in here.lanes {
            self.elements.push(here.first_element + here.first + counts[0] * (here.middle_element + counts[1] * slow));
            self.first.push(along.len() * (here.middle.1 + middle * (q - axes[N - 1].start[slow])));
            for first in along.clone() {
                self.xi.push(axes[0].xi[first]);
                if N == 3 {
                    self.xi.push(axes[1].xi[here.middle.0]);
                }
                self.xi.push(axes[N - 1].xi[q]);
            }
        }
    }
}
