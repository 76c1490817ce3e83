//! The product of the matrix of a form with a vector, without the matrix.
//!
//! Gradients of the vector's field on the grid, the tangent there, the transposed contraction back: per point about
//! 2 N (p + 1) products for the fastest direction, and a fraction of that for the others. Kept tangents of one component are
//! taken point by point along whole lines, so that they are read while the points before them are still counted.

use super::axis::AxisTable;
use super::cell::{CellPoints, Here};
use super::grid::{QuadratureGrid, Sink, Visit};
use super::integrate::{self, Gather};
use super::interpolate::{self, Coefficients, Interpolation, Read};
use super::point_operator::{self, PointOperator};
use super::simd::{Aligned, rows};
use pulp::{NullaryFnOnce, Simd, bytemuck};

/// Functions along the first direction at most for which a point is done at once: more do not fit the registers.
const MOST_ACTIVE: usize = 5;

/// The field's way to the points, the tangent, the way back.
struct Product<'a, V, const N: usize> {
    field: Coefficients<'a>,
    law: &'a PointOperator<'a>,
    spread: Interpolation<V>,
    gather: Gather<V, N>,
    g: Aligned<V>,
    h: Aligned<V>,
    tangents: Vec<V>,
    buffer: Vec<f64>,
}

impl<S: Simd, const N: usize> Visit<S, N> for Product<'_, S::f64s, N> {
    #[inline(always)]
    fn start(&mut self, simd: S, lanes: &[(usize, usize)]) {
        self.spread.planes(simd, self.field, lanes);
        self.gather.start(simd, self.field.axes);
    }

    #[inline(always)]
    fn open(&mut self, simd: S, element: usize) {
        self.spread.lines::<S, N>(simd, self.field, element);
        self.gather.open::<S, N>(simd, self.field.axes, element);
    }

    #[inline(always)]
    fn line(&mut self, simd: S, (_, k): (usize, usize), kept: &[S::f64s]) -> bool {
        let scalar = matches!(self.law, PointOperator::Kept { symmetric: true }) && self.field.width == 1;
        let fits = self.field.axes[0].active <= MOST_ACTIVE;
        if scalar && fits {
            simd.vectorize(Line::<'_, '_, S, N> { simd, product: self, k, kept });
        }
        scalar && fits
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, S::f64s>) {
        simd.vectorize(Respond::<'_, '_, S, N> { simd, product: self, here, cell });
    }

    #[inline(always)]
    fn close(&mut self, simd: S, element: usize) {
        self.gather.close::<S, N>(simd, self.field.axes, element);
    }

    #[inline(always)]
    fn end(&mut self, simd: S, out: &mut [f64]) {
        let size = out.len() / S::F64_LANES;
        self.gather.end(simd, out, size);
    }
}

/// A line of one component whose tangents were kept: every point from the field to its sums, nothing stored in between.
struct Line<'a, 'p, S: Simd, const N: usize> {
    simd: S,
    product: &'a mut Product<'p, S::f64s, N>,
    /// Number of the line within its element of the middle direction.
    k: usize,
    kept: &'a [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Line<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, product, k, kept } = self;
        let axes = product.field.axes;
        let (from, to) = (product.spread.line::<N>(product.field, k), product.gather.line::<N>(axes, k));
        match axes[0].active {
            2 => points::<S, N, 2>(simd, &axes[0], from, kept, to),
            3 => points::<S, N, 3>(simd, &axes[0], from, kept, to),
            4 => points::<S, N, 4>(simd, &axes[0], from, kept, to),
            _ => points::<S, N, MOST_ACTIVE>(simd, &axes[0], from, kept, to),
        }
    }
}

/// Adds B^T D B of a line to `to`, terms in the order of [`interpolate::cell`] and [`integrate::cell`].
#[inline(always)]
fn points<S: Simd, const N: usize, const NP: usize>(simd: S, axis: &AxisTable, from: &[S::f64s], d: &[S::f64s], to: &mut [S::f64s]) {
    let zero = simd.splat_f64s(0.0);
    let (values, slopes) = (rows::<NP>(&axis.values), rows::<NP>(&axis.slopes));
    let size = N * (N + 1) / 2;
    for e in 0..axis.elements() {
        let range = axis.start[e]..axis.start[e + 1];
        let (from, to) = (&from[axis.first[e] * N..][..NP * N], &mut to[axis.first[e] * N..][..NP * N]);
        let (mut own, mut sums) = ([[zero; N]; NP], [[zero; N]; NP]);
        for a in 0..NP {
            for k in 0..N {
                own[a][k] = from[a * N + k];
                sums[a][k] = to[a * N + k];
            }
        }
        let tables = values[range.clone()].iter().zip(&slopes[range.clone()]);
        for ((values, slopes), d) in tables.zip(d[range.start * size..range.end * size].chunks_exact(size)) {
            let mut g = [zero; N];
            for a in 0..NP {
                let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
                g[0] = simd.mul_add_e_f64s(own[a][0], s, g[0]);
                for k in 1..N {
                    g[k] = simd.mul_add_e_f64s(own[a][k], v, g[k]);
                }
            }
            point_operator::kept_scalar::<S, N>(simd, d, &mut g);
            for a in 0..NP {
                let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
                sums[a][0] = simd.mul_add_e_f64s(g[0], s, sums[a][0]);
                for k in 1..N {
                    sums[a][k] = simd.mul_add_e_f64s(g[k], v, sums[a][k]);
                }
            }
        }
        for a in 0..NP {
            to[a * N..][..N].copy_from_slice(&sums[a]);
        }
    }
}

struct Respond<'a, 'p, S: Simd, const N: usize> {
    simd: S,
    product: &'a mut Product<'p, S::f64s, N>,
    here: Here<'a>,
    cell: CellPoints<'a, S::f64s>,
}

impl<S: Simd, const N: usize> NullaryFnOnce for Respond<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, product, here, cell } = self;
        match (product.field.axes[0].active, cell.weight.is_some()) {
            (2, false) => product.respond::<S, 2, false>(simd, here, cell),
            (3, false) => product.respond::<S, 3, false>(simd, here, cell),
            (4, false) => product.respond::<S, 4, false>(simd, here, cell),
            (5, false) => product.respond::<S, 5, false>(simd, here, cell),
            (6, false) => product.respond::<S, 6, false>(simd, here, cell),
            (2, _) => product.respond::<S, 2, true>(simd, here, cell),
            (3, _) => product.respond::<S, 3, true>(simd, here, cell),
            (4, _) => product.respond::<S, 4, true>(simd, here, cell),
            (5, _) => product.respond::<S, 5, true>(simd, here, cell),
            _ => product.respond::<S, 6, true>(simd, here, cell),
        }
    }
}

impl<V: bytemuck::Pod, const N: usize> Product<'_, V, N> {
    #[inline(always)]
    fn respond<S: Simd<f64s = V>, const NP: usize, const RATIONAL: bool>(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, V>) {
        let (axes, width) = (self.field.axes, self.field.width);
        self.g.resize(cell.points * width * (N + 1));
        self.h.resize(2 * width * N);
        let line = self.spread.line::<N>(self.field, here.middle.1);
        interpolate::cell::<S, N, NP, RATIONAL>(simd, &axes[0], here.first, width, line, &mut self.g);
        if let PointOperator::Kept { symmetric: true } = self.law
            && width == 1
            && !RATIONAL
        {
            for (d, g) in cell.kept.chunks_exact(N * (N + 1) / 2).zip(self.g.chunks_exact_mut(N + 1)) {
                point_operator::kept_scalar::<S, N>(simd, d, g);
            }
        } else {
            simd.vectorize(Tangents::<'_, '_, S, N> { simd, product: self, cell });
        }
        let line = self.gather.line::<N>(axes, here.middle.1);
        integrate::cell::<S, N, N, NP, RATIONAL>(simd, &axes[0], here.first, width, &self.g, line);
    }
}

/// The tangent at the points of a cell; compiled once for all degrees.
struct Tangents<'a, 'p, S: Simd, const N: usize> {
    simd: S,
    product: &'a mut Product<'p, S::f64s, N>,
    cell: CellPoints<'a, S::f64s>,
}

impl<S: Simd, const N: usize> NullaryFnOnce for Tangents<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, product, cell } = self;
        let Product { law, field, g, h, tangents, buffer, .. } = product;
        let width = field.width;
        law.tangents::<S, N>(simd, width, cell, buffer, tangents);
        let tangents = if matches!(law, PointOperator::Kept { .. }) { cell.kept } else { &tangents[..] };
        let (size, map_size) = (tangents.len() / cell.points.max(1), cell.map.len() / cell.points.max(1));
        for (q, g) in g.chunks_exact_mut(width * (N + 1)).enumerate() {
            let weight = cell.weight.map(|w| &w[q * (N + 1)..][..N + 1]);
            let (map, tangent) = (&cell.map[q * map_size..][..map_size], &tangents[q * size..][..size]);
            law.respond::<S, N>(simd, map, weight, tangent, g, h);
        }
    }
}

struct Apply<'a, 'p, 's, const N: usize> {
    grid: QuadratureGrid<'a, 'p>,
    law: &'a PointOperator<'a>,
    field: Coefficients<'a>,
    sink: &'a mut Sink<'s>,
}

impl<const N: usize> pulp::WithSimd for Apply<'_, '_, '_, N> {
    type Output = ();
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { grid, law, field, sink } = self;
        let new = || Product::<S::f64s, N> {
            field,
            law,
            spread: Interpolation::default(),
            gather: Gather::new(field.width),
            g: Aligned::default(),
            h: Aligned::default(),
            tangents: Vec::new(),
            buffer: Vec::new(),
        };
        grid.walk::<S, N, _>(simd, integrate::plane_kinds(N) * field.plane(), new, sink);
    }
}

/// Planes of the product with the field that `read` gives, point by point of the slowest direction.
pub(super) fn product(grid: QuadratureGrid<'_, '_>, law: &PointOperator<'_>, components: usize, read: &Read<'_>, sink: &mut Sink<'_>) {
    let field = Coefficients { axes: grid.axes, width: components, read };
    let arch = grid.arch;
    if grid.axes.len() == 2 {
        arch.dispatch(Apply::<2> { grid, law, field, sink });
    } else {
        arch.dispatch(Apply::<3> { grid, law, field, sink });
    }
}
