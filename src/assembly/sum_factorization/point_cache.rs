//! Quadrature-point data stored by the matrix-free operator.

use super::aligned::{NUMBERS, offset};
use super::cell::{Cell, Here};
use super::grid::{Points, QuadratureGrid, Visit};
use super::point_operator::PointOperator;
use crate::linalg::Buffer;
use pulp::{Simd, bytemuck};
use std::ops::Range;

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
    pub fn points<'p>(&self) -> Points<'_, 'p> {
        let all = &self.all[self.range.clone()];
        self.tangent.map_or(Points::Map(all), |tangent| Points::Other(all, tangent.size))
    }

    /// Bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.all[..])
    }
}

/// Visitor that stores the tangent of `law` in local coordinates at the points, or the map without a law.
struct Keep<'a, V> {
    law: Option<&'a PointOperator<'a>>,
    symmetric: bool,
    components: usize,
    all: Vec<V>,
    g: Vec<V>,
    h: Vec<V>,
    tangents: Vec<V>,
    buffer: Vec<f64>,
}

impl<S: Simd, const N: usize> Visit<S, N> for Keep<'_, S::f64s> {
    #[inline(always)]
    fn start(&mut self, _: S, _: &[(usize, usize)]) {
        self.all.clear();
    }

    #[inline(always)]
    fn open(&mut self, _: S, _: usize) {}

    #[inline(always)]
    fn cell(&mut self, simd: S, _: Here<'_>, cell: Cell<'_, S::f64s>) {
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

struct Run<'a, 'p, const N: usize> {
    grid: QuadratureGrid<'a, 'p>,
    law: Option<&'a PointOperator<'a>>,
    symmetric: bool,
    components: usize,
    size: usize,
}

impl<const N: usize> pulp::WithSimd for Run<'_, '_, N> {
    type Output = (Buffer<f64>, Range<usize>);
    fn with_simd<S: Simd>(self, simd: S) -> (Buffer<f64>, Range<usize>) {
        if S::IS_SCALAR {
            return (Buffer::default(), 0..0);
        }
        let (axes, law, symmetric, components) = (self.grid.axes, self.law, self.symmetric, self.components);
        let points = if N == 3 { axes[0].points() * axes[1].points() } else { axes[0].points() };
        let new =
            || Keep { law, symmetric, components, all: Vec::new(), g: Vec::new(), h: Vec::new(), tangents: Vec::new(), buffer: Vec::new() };
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
        2 => arch.dispatch(Run::<2> { grid, law, symmetric, components, size }),
        _ => arch.dispatch(Run::<3> { grid, law, symmetric, components, size }),
    };
    PointCache { all, range, tangent: law.map(|_| Tangent { size, symmetric }) }
}
