//! A field and its gradient at all points of the grid, handed over element by element.
//!
//! The gradient of a form's state at the points of a cell.

use super::cell::{CellPoints, Here, quotient};
use super::grid::{QuadratureGrid, Visit};
use super::interpolate::{Coefficients, Interpolation, Values};
use super::map::{inverse, numbers};
use super::numbering::PatchNumbering;
use super::simd::Aligned;
use super::tensor_field::TensorField;
use super::{Patch, Patches, point_operator};
use crate::linalg::{Matrix, Real, Vector, lit};
use crate::parallel;
use crate::space::FieldAt;
use pulp::{NullaryFnOnce, Simd, bytemuck};
use std::ops::Range;

/// Numbers per point: position, values, gradients.
pub(in crate::assembly) const fn size(n: usize, components: usize) -> usize {
    n + components * (n + 1)
}

struct States<'a, V> {
    field: Coefficients<'a>,
    /// Points of the first direction.
    line: usize,
    spread: Interpolation<V>,
    g: Aligned<V>,
    /// `[lane][middle point][first point][number]`.
    all: Vec<f64>,
}

impl<S: Simd, const N: usize> Visit<S, N> for States<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, simd: S, lanes: &[(usize, usize)]) {
        self.spread.planes(simd, self.field, lanes);
    }

    #[inline(always)]
    fn open(&mut self, simd: S, element: usize) {
        self.spread.lines::<S, N>(simd, self.field, element);
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, S::f64s>) {
        let (axes, width) = (self.field.axes, self.field.width);
        self.g.resize(cell.points * width * (N + 1));
        let line = self.spread.line::<N>(self.field, here.middle.1);
        simd.vectorize(Values::<'_, S, N> { simd, axis: &axes[0], e: here.first, width, line, out: &mut self.g });
        let (size, plane) = (size(N, width), self.all.len() / S::F64_LANES);
        let first = here.middle.0 * self.line + axes[0].start[here.first];
        let mut put = |q: usize, k: usize, values: S::f64s| {
            let values: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&values));
            for (lane, &value) in values.iter().enumerate() {
                self.all[lane * plane + (first + q) * size + k] = value;
            }
        };
        for q in 0..cell.points {
            let map = &cell.map[q * numbers(N)..][..numbers(N)];
            let r = inverse::<S, N>(simd, map);
            for k in 0..N {
                put(q, k, map[k]);
            }
            for c in 0..width {
                let g = &mut self.g[(q * width + c) * (N + 1)..][..N + 1];
                quotient::<S, N>(simd, cell, q, g);
                put(q, N + c, g[N]);
                for (k, value) in point_operator::physical::<S, N>(simd, &r, g).into_iter().enumerate() {
                    put(q, N + width + c * N + k, value);
                }
            }
        }
    }

    #[inline(always)]
    fn close(&mut self, _: S, _: usize) {}

    #[inline(always)]
    fn end(&mut self, _: S, out: &mut [f64]) {
        out.copy_from_slice(&self.all);
    }
}

/// Takes the planes of the points of one element of the slowest direction, elements ascending.
type Slab<'a> = dyn FnMut(usize, &[f64]) + Send + 'a;

struct StateSweep<'a, 'p, 's, const N: usize> {
    grid: QuadratureGrid<'a, 'p>,
    field: Coefficients<'a>,
    slab: &'a mut Slab<'s>,
}

impl<const N: usize> pulp::WithSimd for StateSweep<'_, '_, '_, N> {
    type Output = ();
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { grid, field, slab } = self;
        let (line, slow) = (grid.axes[0].points(), &grid.axes[N - 1]);
        let plane = line * if N == 3 { grid.axes[1].points() } else { 1 } * size(N, field.width);
        let new = || States { field, line, spread: Interpolation::default(), g: Aligned::default(), all: vec![0.0; plane * S::F64_LANES] };
        // planes wait until an element has all of its own
        let (mut waiting, mut next) = (Vec::new(), 0);
        grid.walk::<S, N, _>(simd, plane, new, &mut |points: Range<usize>, planes: &[f64]| {
            waiting.extend_from_slice(&planes[..points.len() * plane]);
            let mut from = 0;
            while next < slow.elements() && (slow.start[next + 1] - slow.start[next]) * plane <= waiting.len() - from {
                let to = from + (slow.start[next + 1] - slow.start[next]) * plane;
                slab(next, &waiting[from..to]);
                (from, next) = (to, next + 1);
            }
            waiting.drain(..from);
        });
    }
}

impl Patches<'_> {
    /// `visit(kept, element, states)` of every element, ascending: the field of `u` at the points of its rule, first direction
    /// fastest. An empty `u` is zero; `kept` is memory of the visitor, whatever is in it.
    pub fn states<const C: usize, const N: usize, T: Real, W: Default, R: Send>(
        &self,
        u: &[T],
        visit: &(impl Fn(&mut W, usize, &[FieldAt<C, N, T>]) -> R + Sync),
    ) -> Vec<R> {
        let mut all = Vec::new();
        for (k, patch) in self.patches.iter().enumerate() {
            let part = self.part(k, C);
            let read = |from: usize, to: &mut [f64]| part.read(u, from, to);
            let field = Coefficients { axes: &patch.axes, width: C, read: &read };
            let grid = patch.grid();
            let slab = &mut |slow: usize, planes: &[f64]| all.extend(elements(patch, slow, planes, u.is_empty(), visit));
            if N == 2 {
                patch.arch.dispatch(StateSweep::<2> { grid, field, slab });
            } else {
                patch.arch.dispatch(StateSweep::<3> { grid, field, slab });
            }
        }
        all
    }
}

/// The elements at `slow` of the slowest direction, from the planes of its points; `nothing`: the field is zero, whatever the map.
fn elements<const C: usize, const N: usize, T: Real, W: Default, R: Send>(
    patch: &Patch<'_>,
    slow: usize,
    planes: &[f64],
    nothing: bool,
    visit: &(impl Fn(&mut W, usize, &[FieldAt<C, N, T>]) -> R + Sync),
) -> Vec<R> {
    let (first, middle) = (&patch.axes[0], if N == 3 { &patch.axes[1] } else { &patch.none });
    let size = size(N, C);
    let own = |(states, kept): &mut (Vec<FieldAt<C, N, T>>, W), e: usize| {
        let (i, j) = (e % first.elements(), e / first.elements());
        states.clear();
        for plane in planes.chunks_exact(middle.points() * first.points() * size) {
            for row in middle.start[j]..middle.start[j + 1] {
                let line = row * first.points();
                let points = &plane[(line + first.start[i]) * size..(line + first.start[i + 1]) * size];
                states.extend(points.chunks_exact(size).map(state));
            }
        }
        for state in states.iter_mut().filter(|_| nothing) {
            (state.value, state.gradient) = (Vector::zeros(), Matrix::zeros());
        }
        visit(kept, patch.first_element + e + slow * first.elements() * middle.elements(), states)
    };
    parallel::map_init(first.elements() * middle.elements(), Default::default, own)
}

/// A point from its numbers: position, values, gradients component by component.
pub(in crate::assembly) fn state<const C: usize, const N: usize, T: Real>(numbers: &[f64]) -> FieldAt<C, N, T> {
    let (x, rest) = numbers.split_at(N);
    let (value, gradient) = rest.split_at(C);
    FieldAt {
        x: Vector::from_fn(|k, _| lit(x[k])),
        value: Vector::from_fn(|c, _| lit(value[c])),
        gradient: Matrix::from_fn(|c, k| lit(gradient[c * N + k])),
    }
}

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
    pub fn of<S: Simd<f64s = V>, const N: usize>(
        &mut self,
        simd: S,
        field: Coefficients<'_>,
        here: Here<'_>,
        cell: CellPoints<'_, V>,
    ) -> &[V] {
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
    pub cell: CellPoints<'a, S::f64s>,
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
