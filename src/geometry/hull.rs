//! Guaranteed boxes of combinations of basis functions on an element, and tighter ones for maps.

use super::{Bounds, Control, Geometry, MapBlock, MapTable, Sampler, cell};
use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::linalg::{Real, Vector, lit, num};
use std::collections::HashMap;

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
        let line = chebyshev(degree);
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

/// Hulls of the elements of a product: Bernstein coefficients of numerator and weight, axis by axis; tight on the cells of a coarse map,
/// whose control points are a hull of its coarse elements alone.
#[derive(Debug)]
struct Lines<const D: usize, T: Real> {
    /// First element of the block that `known` belongs to.
    first: usize,
    /// Per axis and element of it: active functions, and the matrix from their coefficients to Bernstein coefficients, row by row;
    /// `None` where the functions are no polynomials of the basis' degree.
    known: [HashMap<usize, Option<(Vec<usize>, Vec<T>)>>; D],
    /// By degree.
    grids: HashMap<usize, ChebyshevLine<T>>,
}

/// The Chebyshev points of a line, and the matrix from values there to Bernstein coefficients.
#[derive(Debug)]
struct ChebyshevLine<T: Real> {
    points: Vec<T>,
    inverse: Vec<T>,
}

impl<T: Real> ChebyshevLine<T> {
    fn of(degree: usize) -> Self {
        let points = chebyshev(degree);
        Self { inverse: bernstein_inverse(&points), points }
    }
}

impl<const D: usize, T: Real> Lines<D, T> {
    fn hull<const N: usize>(&mut self, block: &MapBlock<'_, D, N, T>, element: usize) -> Option<Bounds<N, T>> {
        let axes = &block.basis.axes;
        if self.first != block.basis.first {
            (self.first, self.known) = (block.basis.first, std::array::from_fn(|_| HashMap::new()));
        }
        let mut rest = element - block.basis.first;
        let at: [usize; D] = std::array::from_fn(|k| {
            let e = rest % axes[k].num_elements();
            rest /= axes[k].num_elements();
            e
        });
        for k in 0..D {
            let grids = &mut self.grids;
            self.known[k].entry(at[k]).or_insert_with(|| {
                let degree = axes[k].degree(at[k])[0];
                to_bernstein(axes[k], at[k], grids.entry(degree).or_insert_with(|| ChebyshevLine::of(degree)))
            });
        }
        let mut lines: [(&[usize], &[T]); D] = [(&[], &[]); D];
        for k in 0..D {
            let (ids, matrix) = self.known[k].get(&at[k])?.as_ref()?;
            lines[k] = (&ids[..], &matrix[..]);
        }
        let active = (0..lines.iter().map(|l| l.0.len()).product()).map(|a: usize| {
            let (mut rest, mut stride, mut i) = (a, 1, 0);
            for (k, (ids, _)) in lines.iter().enumerate() {
                i += stride * ids[rest % ids.len()];
                rest /= ids.len();
                stride *= axes[k].num_functions();
            }
            i
        });
        // w x and w of the active functions, x from the first control point: far from the origin nothing cancels
        let (mut origin, mut spread) = (None, T::zero());
        let mut from: Vec<(Vector<N, T>, T)> = active
            .map(|i| {
                let x = block.control[i] - *origin.get_or_insert(block.control[i]);
                let w = block.basis.weights.map_or(T::one(), |w| w[i]);
                spread = spread.max(x.amax());
                (x * w, w)
            })
            .collect();
        let origin = origin?;
        // the first axis of `from` is converted and becomes the last, D times
        for (ids, matrix) in lines {
            let (n, others) = (ids.len(), from.len() / ids.len());
            let rows = matrix.len() / n;
            let sum = |row: usize, other: usize| {
                let terms = matrix[row * n..(row + 1) * n].iter().zip(&from[other * n..(other + 1) * n]);
                terms.fold((Vector::zeros(), T::zero()), |(x, w), (&m, f)| (x + f.0 * m, w + f.1 * m))
            };
            from = (0..rows).flat_map(|row| (0..others).map(move |other| (row, other))).map(|(row, other)| sum(row, other)).collect();
        }
        let points: Vec<Vector<N, T>> = from.iter().filter(|(_, w)| *w > T::zero()).map(|(x, w)| origin + x / *w).collect();
        // rounding of the conversion, and of places
        let rounding = spread * noise::<T>() * lit(16.0) + origin.amax() * T::default_epsilon() * lit(16.0);
        // a weight function with a coefficient that is not positive has no hull
        (points.len() == from.len()).then(|| Bounds::around(&points))?.map(|hull| hull.inflated(rounding))
    }
}

/// Active functions of an element of a line, and the matrix that makes Bernstein coefficients of theirs; `None` unless they are
/// polynomials of the basis' degree.
fn to_bernstein<T: Real>(axis: &dyn Basis<1, T>, element: usize, grid: &ChebyshevLine<T>) -> Option<(Vec<usize>, Vec<T>)> {
    let ChebyshevLine { points: line, inverse } = grid;
    let n = line.len();
    // a further point shows whether the polynomials through the others are the functions
    let between = lit(0.37);
    let points: Vec<Vector<1, T>> = line.iter().chain([&between]).map(|&t| Vector::<1, T>::new(t)).collect();
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    axis.active(element, &mut ids);
    if ids.is_empty() {
        return None;
    }
    axis.tabulate(element, &points, Order::Values, &mut table);
    let coefficient = |row: usize, a: usize| (0..n).fold(T::zero(), |s, q| s + inverse[row * n + q] * table.values(q)[a]);
    let matrix: Vec<T> = (0..n).flat_map(|row| (0..ids.len()).map(move |a| (row, a))).map(|(row, a)| coefficient(row, a)).collect();
    let choose = |k: usize| (0..k).fold(T::one(), |c, i| c * num(n - 1 - i) / num(i + 1));
    let bernstein = |k: usize| choose(k) * between.powi(k as i32) * (T::one() - between).powi((n - 1 - k) as i32);
    let holds = (0..ids.len()).all(|a| {
        let value = (0..n).fold(T::zero(), |s, k| s + bernstein(k) * matrix[k * ids.len() + a]);
        (value - table.values(n)[a]).abs() <= noise::<T>() * lit(16.0)
    });
    holds.then_some((ids, matrix))
}

/// The `degree` + 1 Chebyshev points of (0, 1).
fn chebyshev<T: Real>(degree: usize) -> Vec<T> {
    let point = |j: usize| (1.0 - (std::f64::consts::PI * (2 * j + 1) as f64 / (2 * degree + 2) as f64).cos()) / 2.0;
    (0..=degree).map(|j| lit(point(j))).collect()
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
    lines: Lines<D, T>,
    table: MapTable<D, N, T>,
    ids: Vec<usize>,
    values: Vec<Vector<N, T>>,
}

impl<'a, const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized> Boxes<'a, D, N, T, G> {
    /// Creates the boxes of `geometry`, whose functions and points are `control`.
    pub fn new(geometry: &'a G, control: Control<'a, D, N, T>) -> Self {
        let sampler = Sampler::new(geometry, Order::Hessians);
        let lines = Lines { first: 0, known: std::array::from_fn(|_| HashMap::new()), grids: HashMap::new() };
        Self { geometry, control, sampler, kept: Vec::new(), lines, table: MapTable::new(), ids: Vec::new(), values: Vec::new() }
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
        let block = self.geometry.map_structure().map_block(element);
        if let Some(hull) = block.and_then(|block| self.lines.hull(&block, element)) {
            return hull;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, Rational, Refined, TensorProduct};
    use crate::geometry::ControlPoints;

    /// A quarter of an annulus, radii 1 and 2, one rational element cut into n x n cells.
    fn annulus(n: usize) -> ControlPoints<Rational<TensorProduct<2, Refined<BSpline>>>, 2> {
        let line = |degree| {
            let cells = (0..n).map(|i| (0, i as f64 / n as f64, 1.0 / n as f64)).collect();
            Refined::new(BSpline::uniform(degree, 1, 0), cells)
        };
        let basis = TensorProduct::new([line(2), line(2)]);
        let corner = [(1.0, 0.0, 1.0), (1.0, 1.0, 0.5f64.sqrt()), (0.0, 1.0, 1.0)];
        let all = (0..9).map(|k| (corner[k % 3], 1.0 + 0.5 * (k / 3) as f64));
        let (points, weights) = all.map(|((x, y, w), r)| (Vector::from([x * r, y * r]), w)).unzip();
        ControlPoints { basis: Rational::new(basis, weights), points }
    }

    #[test]
    fn hulls_hold_their_cells_far_from_the_origin() {
        for far in [0.0, 1e3, 1e6] {
            let mut map = annulus(20);
            map.points.iter_mut().for_each(|x| *x += Vector::from([far, -far]));
            let mut boxes = Boxes::new(&map, map.map_structure().control().unwrap());
            let mut table = MapTable::new();
            for e in 0..400 {
                map.map(e, &cell::grid::<2, f64>(Cell::Tensor, 7), Order::Values, &mut table);
                let (hull, own) = (boxes.hull(e), boxes.of(e));
                assert!(table.x.iter().all(|x| (0..2).all(|k| hull.lo[k] <= x[k] && x[k] <= hull.hi[k])), "{far}, cell {e}");
                assert!((0..2).all(|k| own.lo[k] <= own.hi[k]), "{far}, cell {e}");
            }
        }
    }

    #[test]
    fn hulls_of_cells_of_a_coarse_map_are_tight() {
        let n = 8;
        let map = annulus(n);
        let mut boxes = Boxes::new(&map, map.map_structure().control().unwrap());
        for e in 0..n * n {
            let (i, j) = (e % n, e / n);
            // radii and angles of a cell; the middle of the arc lies at half the parameter, other angles follow from the map
            let mut table = MapTable::new();
            let at = cell::grid::<2, f64>(Cell::Tensor, 9);
            map.map(e, &at, Order::Values, &mut table);
            let true_box = Bounds::around(&table.x).unwrap();
            let hull = boxes.hull(e);
            assert!(hull.inflated(1e-14).holds(&true_box), "cell {i} {j}");
            let over = (hull.hi - hull.lo) - (true_box.hi - true_box.lo);
            // a hull of Bernstein coefficients exceeds the arc by at most its sagitta
            let sagitta = 2.0 * (1.0 - (std::f64::consts::FRAC_PI_4 * 1.3 / n as f64).cos());
            assert!(over.max() <= sagitta, "cell {i} {j}: {over:?} of {sagitta}");
        }
        let all: Vec<_> = (0..n * n).map(|e| boxes.of(e)).collect();
        assert_eq!(map.extent(), all.into_iter().reduce(|a, b| a.union(&b)));
        assert!((map.extent().unwrap().hi - Vector::from([2.0, 2.0])).amax() < 1e-12);
    }
}
