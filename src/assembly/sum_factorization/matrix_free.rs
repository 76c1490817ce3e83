//! Patches without their matrix, and the data at quadrature points that an operator stores between products.

use super::axis::AxisTable;
use super::cell::{CellPoints, Here};
use super::diagonal::{self, ORDERS, squares};
use super::grid::{PointSource, QuadratureGrid, Visit};
use super::map::{Map, MapEvaluators};
use super::numbering::PatchNumbering;
use super::point_operator::PointOperator;
use super::product::product;
use super::simd::{NUMBERS, offset};
use super::tensor_field::TensorField;
use super::{Patch, Patches, integrate};
use crate::assembly::source::Integrand;
use crate::assembly::{Coefficient, Form};
use crate::linalg::{Buffer, Real, lit};
use pulp::{Simd, bytemuck};
use std::ops::Range;

/// Tables of patches, and what is kept at their points.
#[derive(Debug)]
pub(in crate::assembly) struct Free {
    patches: Vec<FreePatch>,
    /// Number in the whole of every function of the patches.
    ids: Option<Vec<u32>>,
}

#[derive(Debug)]
struct FreePatch {
    axes: Vec<AxisTable>,
    weight: Option<(TensorField, Vec<f64>)>,
    net: Option<TensorField>,
    kept: Option<PointCache>,
    first_element: usize,
    /// Its functions among those of all patches.
    functions: Range<usize>,
    arch: pulp::Arch,
}

impl Free {
    /// `patches` for products with `form`; `keeps`: a map without product structure and tangents that vary are computed
    /// once, not at every product, and so are the tangents of one component.
    ///
    /// `None` where a function is a sum of several of one patch: its diagonal entry is no contraction of squares.
    pub fn new<const C: usize, const N: usize, T: Real>(patches: Patches<'_>, form: &Form<'_, C, N, T>, keeps: bool) -> Option<Self> {
        let Patches { patches, glue } = patches;
        if glue.as_ref().is_some_and(|glue| !glue.merged.is_empty()) {
            return None;
        }
        let (mut element, mut function) = (0, 0);
        let mut all = Vec::with_capacity(patches.len());
        let source = Integrand::new(form);
        for patch in patches {
            let functions = function..function + patch.functions();
            let ids = glue.as_ref().map(|glue| &glue.ids[functions.clone()]);
            let own = FreePatch::new(patch, element, functions, ids, (form, &source), keeps);
            element += own.axes.iter().map(AxisTable::elements).product::<usize>();
            function = own.functions.end;
            all.push(own);
        }
        Some(Self { patches: all, ids: glue.map(|glue| glue.ids.clone()) })
    }

    /// Bytes that are kept per operator beside tables of one direction.
    pub fn bytes(&self) -> usize {
        let ids = self.ids.as_ref().map_or(0, |ids| 4 * ids.len());
        ids + self.patches.iter().map(FreePatch::bytes).sum::<usize>()
    }

    fn part(&self, patch: &FreePatch, width: usize) -> PatchNumbering<'_> {
        PatchNumbering { ids: self.ids.as_ref().map(|ids| &ids[patch.functions.clone()]), weights: None, width }
    }

    /// y = A x; `asks` returns an evaluator of the map of one element, for maps that are no net and not stored.
    pub fn apply<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, asks: &MapEvaluators<'_>, x: &[T], y: &mut [T]) {
        y.fill(T::zero());
        let source = Integrand::new(form);
        for patch in &self.patches {
            let part = PatchNumbering { weights: patch.weights(), ..self.part(patch, C) };
            let read = |from: usize, to: &mut [f64]| part.read(x, from, to);
            let slow = &patch.axes[N - 1];
            let owners = slow.owners();
            part.add(patch.functions.len(), y, |own| {
                let kinds = (2, 2 * own.len() / slow.functions.max(1));
                let mut add = |points: Range<usize>, planes: &[f64]| integrate::slow(slow, &owners, kinds, planes, points, own);
                patch.with_law::<C, N>(part, &source, asks, |grid, law| product(grid, law, C, &read, &mut add));
            });
        }
    }

    /// The diagonal.
    pub fn diagonal<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, asks: &MapEvaluators<'_>, out: &mut [T]) {
        out.fill(T::zero());
        let source = Integrand::new(form);
        for patch in &self.patches {
            let part = self.part(patch, C);
            part.add(patch.functions.len(), out, |own| patch.diagonal::<C, N, T>(part, &source, asks, own));
        }
    }
}

impl FreePatch {
    fn new<const C: usize, const N: usize, T: Real>(
        patch: Patch<'_>,
        first_element: usize,
        functions: Range<usize>,
        ids: Option<&[u32]>,
        (form, source): (&Form<'_, C, N, T>, &Integrand<'_>),
        keeps: bool,
    ) -> Self {
        // for one component the map costs more than the rest of a product, for several components less
        let tangents = C == 1 || !matches!(form.coefficient, Coefficient::Constant(_));
        let kept = (keeps && (tangents || matches!(patch.map, Map::Elements(..)))).then(|| {
            let law = if tangents { PointOperator::new::<N>(source, C) } else { None };
            let part = PatchNumbering { ids, weights: patch.weight.as_ref().map(|(_, weights)| &weights[..]), width: C };
            keep(patch.grid().with_state(part, source), law.as_ref(), form.symmetric, C)
        });
        let Patch { axes, map, weight, arch, .. } = patch;
        let net = if let (Map::TensorField(net), None) = (map, &kept) { Some(net) } else { None };
        Self { axes, weight, net, kept, first_element, functions, arch }
    }

    fn weights(&self) -> Option<&[f64]> {
        self.weight.as_ref().map(|(_, weights)| &weights[..])
    }

    fn bytes(&self) -> usize {
        let kept = self.kept.as_ref().map_or(0, PointCache::bytes);
        kept + 8 * (self.net.as_ref().map_or(0, |net| net.coefficients.len()) + 2 * self.weights().map_or(0, <[f64]>::len))
    }

    fn grid<'a, 'p>(&'a self, asks: &'a MapEvaluators<'p>) -> QuadratureGrid<'a, 'p> {
        let points = match (&self.kept, &self.net) {
            (Some(kept), _) => kept.points(),
            (None, Some(net)) => PointSource::TensorField(net),
            (None, None) => PointSource::Elements(asks),
        };
        let weight = self.weight.as_ref().map(|(net, _)| net);
        QuadratureGrid { axes: &self.axes, weight, state: None, points, first_element: self.first_element, arch: self.arch }
    }

    /// Calls `work` with the grid and the law of `source`, or that of the tangents that were kept; `part`: the functions of the patch.
    fn with_law<const C: usize, const N: usize>(
        &self,
        part: PatchNumbering<'_>,
        source: &Integrand<'_>,
        asks: &MapEvaluators<'_>,
        work: impl FnOnce(QuadratureGrid<'_, '_>, &PointOperator<'_>),
    ) {
        if let Some(tangent) = self.kept.as_ref().and_then(|kept| kept.tangent) {
            work(self.grid(asks), &PointOperator::Kept { symmetric: tangent.symmetric });
        } else if let Some(law) = PointOperator::new::<N>(source, C) {
            let part = PatchNumbering { weights: self.weights(), ..part };
            work(self.grid(asks).with_state(part, source), &law);
        }
    }

    /// Adds the diagonal to `out`, the functions of the patch alone, `part` of all.
    fn diagonal<const C: usize, const N: usize, T: Real>(
        &self,
        part: PatchNumbering<'_>,
        source: &Integrand<'_>,
        asks: &MapEvaluators<'_>,
        out: &mut [T],
    ) {
        let slow = &self.axes[N - 1];
        let owners = slow.owners();
        let mut sums = vec![0.0; out.len()];
        let plane = sums.len() / slow.functions.max(1);
        self.with_law::<C, N>(part, source, asks, |grid, law| {
            diagonal::diagonal(grid, law, C, &mut |points: Range<usize>, numbers: &[f64]| {
                for (q, numbers) in points.zip(numbers.chunks_exact(plane * ORDERS)) {
                    for a in 0..slow.active {
                        let squares = squares(slow, q, a);
                        let to = &mut sums[(slow.first[owners[q]] + a) * plane..][..plane];
                        for (to, kinds) in to.iter_mut().zip(numbers.chunks_exact(ORDERS)) {
                            *to += (squares[0] * kinds[0] + squares[1] * kinds[1]) + squares[2] * kinds[2];
                        }
                    }
                }
            });
        });
        if let Some(weights) = self.weights() {
            sums.chunks_exact_mut(C).zip(weights).for_each(|(sums, &w)| sums.iter_mut().for_each(|s| *s *= w * w));
        }
        out.iter_mut().zip(sums).for_each(|(out, sum)| *out += lit(sum));
    }
}

/// Stored quadrature-point data, in SIMD lanes of this processor.
#[derive(Debug)]
pub(super) struct PointCache {
    all: Buffer<f64>,
    /// Range of the data in `all`.
    range: Range<usize>,
    /// The tangent in local coordinates in place of the map.
    pub tangent: Option<Tangent>,
}

/// A tangent in local coordinates: rows and columns are (component, direction).
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangent {
    /// Numbers per point.
    size: usize,
    /// Whether rows start at the diagonal.
    pub symmetric: bool,
}

impl PointCache {
    /// The data as points of a grid.
    pub fn points<'p>(&self) -> PointSource<'_, 'p> {
        let all = &self.all[self.range.clone()];
        self.tangent.map_or(PointSource::Map(all), |tangent| PointSource::Other(all, tangent.size))
    }

    /// Bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.all[..])
    }
}

/// Visitor that stores the tangent of `law` in local coordinates at the points, or the map without a law.
struct CacheVisitor<'a, V> {
    law: Option<&'a PointOperator<'a>>,
    symmetric: bool,
    components: usize,
    all: Vec<V>,
    g: Vec<V>,
    h: Vec<V>,
    tangents: Vec<V>,
    buffer: Vec<f64>,
}

impl<S: Simd, const N: usize> Visit<S, N> for CacheVisitor<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, _: S, _: &[(usize, usize)]) {
        self.all.clear();
    }

    #[inline(always)]
    fn open(&mut self, _: S, _: usize) {}

    #[inline(always)]
    fn cell(&mut self, simd: S, _: Here<'_>, cell: CellPoints<'_, S::f64s>) {
        let Some(law) = self.law else {
            self.all.extend_from_slice(cell.map);
            return;
        };
        let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
        let rows = self.components * N;
        law.tangents::<S, N>(simd, self.components, cell, &mut self.buffer, &mut self.tangents);
        let (size, map_size) = (self.tangents.len() / cell.points.max(1), cell.map.len() / cell.points.max(1));
        self.h.resize(2 * rows, zero);
        for q in 0..cell.points {
            let from = self.all.len();
            self.all.resize(from + size_of_tangent(rows, self.symmetric), zero);
            for column in 0..rows {
                // response to a unit derivative of one component
                self.g.clear();
                self.g.resize(self.components * (N + 1), zero);
                self.g[column / N * (N + 1) + column % N] = one;
                let (map, tangent) = (&cell.map[q * map_size..][..map_size], &self.tangents[q * size..][..size]);
                law.respond::<S, N>(simd, map, None, tangent, &mut self.g, &mut self.h);
                for row in 0..if self.symmetric { column + 1 } else { rows } {
                    let before = if self.symmetric { row * (2 * rows - row + 1) / 2 + column - row } else { row * rows + column };
                    self.all[from + before] = self.g[row / N * (N + 1) + row % N];
                }
            }
        }
    }

    #[inline(always)]
    fn close(&mut self, _: S, _: usize) {}

    #[inline(always)]
    fn end(&mut self, _: S, out: &mut [f64]) {
        out.copy_from_slice(bytemuck::cast_slice(&self.all));
    }
}

struct CacheSweep<'a, 'p, const N: usize> {
    grid: QuadratureGrid<'a, 'p>,
    law: Option<&'a PointOperator<'a>>,
    symmetric: bool,
    components: usize,
    size: usize,
}

impl<const N: usize> pulp::WithSimd for CacheSweep<'_, '_, N> {
    type Output = (Buffer<f64>, Range<usize>);
    fn with_simd<S: Simd>(self, simd: S) -> (Buffer<f64>, Range<usize>) {
        if S::IS_SCALAR {
            return (Buffer::default(), 0..0);
        }
        let (axes, law, symmetric, components) = (self.grid.axes, self.law, self.symmetric, self.components);
        let points = if N == 3 { axes[0].points() * axes[1].points() } else { axes[0].points() };
        let new = || CacheVisitor {
            law,
            symmetric,
            components,
            all: Vec::new(),
            g: Vec::new(),
            h: Vec::new(),
            tangents: Vec::new(),
            buffer: Vec::new(),
        };
        let tiles = axes[N - 1].points().div_ceil(S::F64_LANES);
        // room to start on a cache line; large pages, for every product streams all of it
        let mut all = Buffer::zeros(tiles * points * self.size * S::F64_LANES + NUMBERS);
        let first = offset(&all);
        let mut next = first;
        // map and tangent do not depend on the weight function, but the gradient of a state does
        let grid = QuadratureGrid { weight: self.grid.weight.filter(|_| self.grid.state.is_some()), ..self.grid };
        grid.walk::<S, N, _>(simd, points * self.size, new, &mut |_: Range<usize>, numbers: &[f64]| {
            all[next..next + numbers.len()].copy_from_slice(numbers);
            next += numbers.len();
        });
        (all, first..next)
    }
}

/// Numbers of a tangent of `rows` rows.
const fn size_of_tangent(rows: usize, symmetric: bool) -> usize {
    if symmetric { rows * (rows + 1) / 2 } else { rows * rows }
}

/// Stores the map of `grid`, or the tangent `law` in local coordinates.
pub(super) fn keep(grid: QuadratureGrid<'_, '_>, law: Option<&PointOperator<'_>>, symmetric: bool, components: usize) -> PointCache {
    let n = grid.axes.len();
    let size = if law.is_some() { size_of_tangent(components * n, symmetric) } else { super::map::numbers(n) };
    let arch = grid.arch;
    let (all, range) = match n {
        2 => arch.dispatch(CacheSweep::<2> { grid, law, symmetric, components, size }),
        _ => arch.dispatch(CacheSweep::<3> { grid, law, symmetric, components, size }),
    };
    PointCache { all, range, tangent: law.map(|_| Tangent { size, symmetric }) }
}
