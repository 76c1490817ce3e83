//! The gradient of a form's state at the points of a cell.

use super::aligned::Aligned;
use super::cell::{Cell, Here, quotient};
use super::interpolate::{Coefficients, Interpolation, Values};
use super::map::{inverse, numbers};
use super::part::PatchNumbering;
use super::tensor_field::TensorField;
use super::{Patch, point_operator};
use pulp::{NullaryFnOnce, Simd, bytemuck};

/// Unknowns of a state, and the share of a patch in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct State<'a> {
    pub part: PatchNumbering<'a>,
    pub u: &'a [f64],
}

impl State<'_> {
    /// Copies coefficients of the patch.
    pub fn read(&self, from: usize, to: &mut [f64]) {
        self.part.read(self.u, from, to);
    }

    /// The state on `patch` as a net; of a rational basis its numerator.
    pub fn net(&self, patch: &Patch<'_>) -> TensorField {
        let mut coefficients = vec![0.0; self.part.width * patch.functions()];
        self.read(0, &mut coefficients);
        TensorField { axes: patch.axes.clone(), width: self.part.width, coefficients }
    }
}

/// Memory of the gradients of a state on a grid of points.
#[derive(Clone, Debug)]
pub(super) struct Gradients<V> {
    pub spread: Interpolation<V>,
    g: Aligned<V>,
    out: Aligned<V>,
}

impl<V> Default for Gradients<V> {
    fn default() -> Self {
        Self { spread: Interpolation::default(), g: Aligned::default(), out: Aligned::default() }
    }
}

impl<V: bytemuck::Pod> Gradients<V> {
    /// The gradients at the points of a cell, from the lines of `field`.
    #[inline(always)]
    pub fn of<S: Simd<f64s = V>, const N: usize>(&mut self, simd: S, field: Coefficients<'_>, here: Here<'_>, cell: Cell<'_, V>) -> &[V] {
        let (Self { spread, g, out }, width) = (self, field.width);
        g.resize(cell.points * width * (N + 1));
        out.resize(cell.points * width * N);
        let line = spread.line::<N>(field, here.middle.1);
        simd.vectorize(Values::<'_, S, N> { simd, axis: &field.axes[0], e: here.first, width, line, out: g });
        simd.vectorize(Physical::<'_, S, N> { simd, cell, width, g, out });
        out
    }
}

/// Physical gradients of `width` numbers at the points of a cell, `out[(point * width + c) * N + k]`, from local derivatives and values
/// `g[(point * width + c) * (N + 1) + d]`, d = N the value, of the numerator where the basis is rational; overwrites them.
pub(in crate::assembly) struct Physical<'a, S: Simd, const N: usize> {
    pub simd: S,
    pub cell: Cell<'a, S::f64s>,
    pub width: usize,
    pub g: &'a mut [S::f64s],
    pub out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Physical<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, cell, width, g, out } = self;
        let points = g.chunks_exact_mut(width * (N + 1)).zip(out.chunks_exact_mut(width * N));
        for (q, (g, out)) in points.enumerate() {
            let r = inverse::<S, N>(simd, &cell.map[q * numbers(N)..][..numbers(N)]);
            for (g, out) in g.chunks_exact_mut(N + 1).zip(out.chunks_exact_mut(N)) {
                quotient::<S, N>(simd, cell, q, g);
                out.copy_from_slice(&point_operator::physical::<S, N>(simd, &r, g));
            }
        }
    }
}
