//! Guaranteed boxes of combinations of basis functions on an element, and tighter ones for maps.

use super::{Bounds, Control, Geometry, MapTable, Sampler, cell};
use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::linalg::{Real, Vector, lit, num};

/// A box that contains sum_i N_i(xi) v_i for all xi in the cell of `element`; `value(i)` gives v_i. `None` without functions.
///
/// Where no function is negative the values themselves are a hull. Otherwise (Lagrange) the functions are polynomials of the
/// basis' degree, and the Bernstein coefficients of the sum are a hull.
pub fn hull<const D: usize, const N: usize, T: Real, B: Basis<D, T> + ?Sized>(
    basis: &B,
    element: usize,
    value: impl Fn(usize) -> Vector<N, T>,
) -> Option<Bounds<N, T>> {
    let mut ids = Vec::new();
    basis.active(element, &mut ids);
    let values: Vec<Vector<N, T>> = ids.iter().map(|&i| value(i)).collect();
    around_functions(Bernstein::of(basis, element).as_ref(), &values)
}

/// A box around coefficients of non-negative functions, or of functions that `change` converts to such.
fn around_functions<const D: usize, const N: usize, T: Real>(
    change: Option<&Bernstein<D, T>>,
    values: &[Vector<N, T>],
) -> Option<Bounds<N, T>> {
    change.map_or_else(|| Bounds::around(values), |change| change.hull(values))
}

/// Conversion of coefficients to those of Bernstein polynomials: values at a tensor grid of points, then line by line.
#[derive(Debug)]
struct Bernstein<const D: usize, T: Real> {
    /// Number of points, and of those on a line.
    points: usize,
    line: usize,
    /// The functions at the points.
    functions: ShapeTable<D, T>,
    /// From values on a line to coefficients.
    inverse: Vec<T>,
}

impl<const D: usize, T: Real> Bernstein<D, T> {
    /// Builds the conversion; `None` if the functions of `element` are non-negative.
    fn of<B: Basis<D, T> + ?Sized>(basis: &B, element: usize) -> Option<Self> {
        let degree = basis.degree(element).into_iter().max().unwrap_or(0);
        let cell = basis.cell(element);
        if degree <= 1 && cell == Cell::Simplex {
            return None;
        }
        // Chebyshev points: inside the cell, never nodes, so a Lagrange function of degree >= 2 shows a negative value
        let line: Vec<T> =
            (0..=degree).map(|j| lit((1.0 - (std::f64::consts::PI * (2 * j + 1) as f64 / (2 * degree + 2) as f64).cos()) / 2.0)).collect();
        let points = cell::spread::<D, T>(cell, &line);
        let mut functions = ShapeTable::new();
        basis.tabulate(element, &points, Order::Values, &mut functions);
        if (0..points.len()).all(|q| functions.values(q).iter().all(|&n| n >= -noise::<T>())) {
            return None;
        }
        Some(Self { points: points.len(), functions, line: line.len(), inverse: bernstein_inverse(&line) })
    }

    fn hull<const N: usize>(&self, values: &[Vector<N, T>]) -> Option<Bounds<N, T>> {
        let Self { points, functions, line, inverse } = self;
        let (n, sum) = (*line, |q: usize| functions.values(q).iter().zip(values).fold(Vector::zeros(), |s, (&n, v)| s + v * n));
        let mut coefficients: Vec<Vector<N, T>> = (0..*points).map(sum).collect();
        for axis in 0..D {
            let stride = n.pow(axis as u32);
            let old = coefficients.clone();
            for (q, c) in coefficients.iter_mut().enumerate() {
                let k = q / stride % n;
                let base = q - k * stride;
                *c = (0..n).fold(Vector::zeros(), |s, j| s + old[base + j * stride] * inverse[k * n + j]);
            }
        }
        let hull = Bounds::around(&coefficients)?;
        Some(hull.inflated(hull.diagonal() * noise::<T>() * lit(16.0)))
    }
}

/// Values above minus this count as non-negative.
fn noise<T: Real>() -> T {
    T::default_epsilon() * lit(64.0)
}

/// Largest number of reference cells with cached tables.
const KEPT: usize = 64;

/// Bounding boxes of the elements of a map of control points; the tables of reference cells are cached.
#[derive(Debug)]
pub(super) struct Boxes<'a, const D: usize, const N: usize, T: Real, G: ?Sized> {
    geometry: &'a G,
    control: Control<'a, D, N, T>,
    sampler: Sampler<'a, D, N, T, G>,
    kept: Vec<(usize, Option<Bernstein<D, T>>)>,
    table: MapTable<D, N, T>,
    ids: Vec<usize>,
    values: Vec<Vector<N, T>>,
}

impl<'a, const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized> Boxes<'a, D, N, T, G> {
    /// Creates the boxes of `geometry`, whose functions and points are `control`.
    pub fn new(geometry: &'a G, control: Control<'a, D, N, T>) -> Self {
        let sampler = Sampler::new(geometry, Order::Hessians);
        Self { geometry, control, sampler, kept: Vec::new(), table: MapTable::new(), ids: Vec::new(), values: Vec::new() }
    }

    /// Bounding box of `element`: the box around its hull, tightened by samples.
    pub fn of(&mut self, element: usize) -> Bounds<N, T> {
        let held = self.hull(element);
        let points = samples(self.geometry.cell(element));
        self.sampler.map(element, 0, &points, &mut self.table);
        around::<D, N, T>(&self.table, held)
    }

    /// The box around the hull of `element`; it contains the element.
    pub fn hull(&mut self, element: usize) -> Bounds<N, T> {
        let basis = self.control.basis;
        basis.active(element, &mut self.ids);
        self.values.clear();
        self.values.extend(self.ids.iter().map(|&i| self.control.points[i]));
        let known = basis.structure().reference(element).and_then(|own| {
            let place = self.kept.iter().position(|(kept, _)| *kept == own);
            if place.is_none() && self.kept.len() < KEPT {
                self.kept.push((own, Bernstein::of(basis, element)));
                return Some(self.kept.len() - 1);
            }
            place
        });
        let held = match known {
            Some(k) => around_functions(self.kept[k].1.as_ref(), &self.values),
            None => around_functions(Bernstein::of(basis, element).as_ref(), &self.values),
        };
        held.unwrap_or(Bounds { lo: Vector::zeros(), hi: Vector::zeros() })
    }

    /// The box around the boxes of all elements, whose hulls are `hulls`; elements with hulls inside the box so far are skipped.
    pub fn around(&mut self, hulls: &[Bounds<N, T>]) -> Option<Bounds<N, T>> {
        // elements that reach furthest first: few others remain to be evaluated
        let furthest = |k: usize, sign: T| {
            let reach = |e: &usize| if sign > T::zero() { hulls[*e].hi[k] } else { -hulls[*e].lo[k] };
            (0..hulls.len()).reduce(|a, b| if reach(&b) > reach(&a) { b } else { a })
        };
        let first = (0..N).flat_map(|k| [furthest(k, T::one()), furthest(k, -T::one())]).flatten().collect::<Vec<_>>();
        let mut whole: Option<Bounds<N, T>> = None;
        for e in first.into_iter().chain(0..hulls.len()) {
            if whole.is_none_or(|whole| !whole.holds(&hulls[e])) {
                let own = self.of(e);
                whole = Some(whole.map_or(own, |whole| whole.union(&own)));
            }
        }
        whole
    }
}

/// The box `outer` of an element cut to one around samples, grown by four times the sampled deviation from straight pieces.
///
/// The control points of a coarse map surround all of its cells; this box is close to the element.
pub(super) fn tightened<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(
    geometry: &G,
    element: usize,
    outer: Bounds<N, T>,
) -> Bounds<N, T> {
    let mut table = MapTable::new();
    geometry.map(element, &samples(geometry.cell(element)), Order::Hessians, &mut table);
    around(&table, outer)
}

/// Number of intervals per direction of the sampling grid of a cell.
const fn pieces(d: usize) -> usize {
    if d < 3 { 4 } else { 2 }
}

/// Sample points of a map in its cell.
fn samples<const D: usize, T: Real>(cell: Cell) -> Vec<Vector<D, T>> {
    cell::grid::<D, T>(cell, pieces(D) + 1)
}

/// The box of [`tightened`] from a table of samples.
fn around<const D: usize, const N: usize, T: Real>(table: &MapTable<D, N, T>, outer: Bounds<N, T>) -> Bounds<N, T> {
    let Some(samples) = Bounds::around(&table.x) else { return outer };
    let bend = table.hessian.iter().flatten().fold(T::zero(), |m, h| m.max(h.iter().fold(T::zero(), |s, v| s + v.abs())));
    // |x - linear interpolation| <= max |x''| h^2 / 8 per coordinate; the samples of x'' may miss its peak
    let rounding = samples.diagonal() * T::default_epsilon() * lit(16.0);
    let grown = samples.inflated(bend * lit(0.5 / (pieces(D) * pieces(D)) as f64) + rounding);
    Bounds { lo: grown.lo.zip_map(&outer.lo, |a, b| a.max(b)), hi: grown.hi.zip_map(&outer.hi, |a, b| a.min(b)) }
}

/// The inverse of the matrix B_k(t_j) of Bernstein polynomials at `line`, row k and column j.
fn bernstein_inverse<T: Real>(line: &[T]) -> Vec<T> {
    let n = line.len();
    let p = n - 1;
    let choose = |k: usize| (0..k).fold(T::one(), |c, i| c * num(p - i) / num(i + 1));
    let matrix = nalgebra::DMatrix::from_fn(n, n, |j, k| choose(k) * line[j].powi(k as i32) * (T::one() - line[j]).powi((p - k) as i32));
    let inverse = matrix.try_inverse().expect("Bernstein polynomials are independent at distinct points");
    (0..n * n).map(|i| inverse[(i / n, i % n)]).collect()
}
