//! Dual multipliers of contact, where an element may be covered in part because the master ends beside it.
//!
//! On such an element the functions of [`dual`](super::dual()) have weights ∫ psi_j ds over the covered part that may be negative. So
//! duality is required over that part,
//!
//! ```text
//! ∫ psi_j N_i ds = delta_ij d_i,   d_i = ∫ N_i ds > 0,   both over the covered part, by the points of the rows themselves:
//! ```
//!
//! weights are those of the N_i, the psi_j sum to one, and D is diagonal. This requires N_i >= 0: Lagrange functions of degree two and more
//! are replaced by the Bernstein polynomials of the same numbers on such elements, in the order of the nodes, in which D is diagonal there.
//!
//! |psi| grows as the covered part shrinks: Bernstein polynomials of degree 1 to 4 stay at 4, 18, 80 and 350, since they scale like
//! monomials; functions of smooth splines reach 904 at 1 % (degree 2) and 5e5 (degree 3). Where |psi| exceeds [`MOST`] the function of
//! least weight is merged into its neighbour,
//!
//! ```text
//! N_j' = N_j + N_i,   one function and one degree less,   down to psi = 1 for a sliver;
//! ```
//!
//! and so is, on an element covered in part, the function of a constrained end. Smooth splines of degree three and more are an error.
//!
//! **The pressure** is evaluated with the functions of the side, sum lambda_j N_j: the same force per function, between the least and
//! the greatest coefficient where N >= 0, while sum lambda_j psi_j oscillates far beyond them. Functions without a multiplier are
//! merged into their neighbour there, so that a constant is evaluated as one.

use super::dual::{NO_WEIGHT, Work};
use super::sliver::lives_on_sliver;
use super::{MultiplierError, SideEnd};
use crate::basis::{BSpline, Basis, Cell, ElementPolynomials, Elements, Order, Piecewise, ShapeTable, legendre_polynomials};
use crate::coupling::Segments;
use crate::geometry::Geometry;
use crate::linalg::{Real, Vector, lit, num, to_f64};
use crate::quadrature::gauss_legendre;
use crate::space::Space;
use nalgebra::{DMatrix, Dyn, LU};
use std::ops::Range;
use std::sync::Arc;

/// Greatest |psi| on the covered part of an element.
pub const MOST: f64 = 1e3;
/// An element whose points span all but this share of its parameters is covered.
const WHOLE: f64 = 1e-9;
/// Values below minus this are negative, others below it are zero.
const NO_VALUE: f64 = 1e-9;
/// Largest error of duality at the points, as a share of the largest weight.
const NOT_DUAL: f64 = 1e-9;
/// Number of points of an element at which the signs of its functions are checked.
const SIGNS: usize = 17;
/// Smooth splines of this degree and more have no dual functions on elements covered in part.
const SMOOTH: usize = 3;

/// Dual multipliers of a side that is covered in part, and the functions for evaluating its pressure.
#[derive(Clone, Debug)]
pub struct CoveredDual<const N: usize, T: Real = f64> {
    /// psi_j.
    pub functions: Piecewise<T>,
    /// N_j, numbered alike.
    pub reading: Reading<N, T>,
}

/// Builds the dual multipliers of the side `space` over the part covered by `segments`; `constrained` ends have no free unknown.
///
/// Functions are numbered as those of the side, without the ones at constrained ends and those merged on all elements. On elements that
/// are covered as a whole, or not at all, they are those of [`dual`](super::dual()); on uncovered elements they have no weight.
///
/// # Errors
/// [`MultiplierError::NoDual`] on a smooth spline of degree three or more that is covered in part, and where an element has no dual
/// functions, or one whose weight ∫ psi_j ds vanishes; [`MultiplierError::NothingLeft`] where constrained ends leave an element without functions.
pub fn dual_covered<const N: usize, T: Real>(
    space: &Arc<dyn Space<1, N, T>>,
    constrained: &[SideEnd],
    segments: &Segments<1, T>,
) -> Result<CoveredDual<N, T>, MultiplierError> {
    let (gone, number, functions) = super::dual::numbering(&**space, constrained);
    // on elements covered in part functions on slivers give their share away as those of constrained ends do
    let on_sliver = lives_on_sliver(&**space as &dyn Basis<1, T>, &**space as &dyn Geometry<1, N, T>, segments);
    let gone_in_part: Vec<bool> = gone.iter().zip(on_sliver).map(|(&gone, sliver)| gone || sliver).collect();
    let mut work = Work::new();
    let mut points: Vec<Vec<Range<usize>>> = vec![Vec::new(); space.num_elements()];
    (0..segments.num_pieces()).for_each(|piece| points[segments.slave[piece]].push(segments.points(piece)));
    let (mut pieces, mut elements) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
    for (element, own) in points.iter().enumerate() {
        let in_part = !own.is_empty() && !is_whole(segments, element, own);
        let gone = if in_part { &gone_in_part } else { &gone };
        let in_order = Ordered::of(&**space, element, gone, &mut work);
        let (mut piece, owner, is_bernstein) = if in_part {
            over_part(&**space, element, &in_order, segments, own)?
        } else {
            work.integrate(&**space, element, gone);
            (work.piece(element, space.degree(element)[0])?, in_order.owners(), false)
        };
        piece.ids.iter_mut().for_each(|i| *i = number[*i]);
        pieces.push(piece);
        elements.push(Read::of(&in_order, &owner, &number, is_bernstein));
    }
    let functions = drop_unused(functions, &mut pieces, &mut elements);
    let functions = Piecewise::new(&**space, functions, pieces);
    refuse_weightless(&functions, segments)?;
    let reading = Reading { space: Arc::clone(space), functions: functions.num_functions(), elements };
    Ok(CoveredDual { functions, reading })
}

/// Checks that the functions on the covered part have weights ∫ psi_j ds over it: a row without weight would count as one that faces
/// nothing. Weights are those of the N_j where all of these have a multiplier; on a side of two quadratic Lagrange elements between
/// constrained ends the function in the middle has none.
fn refuse_weightless<T: Real>(psi: &Piecewise<T>, segments: &Segments<1, T>) -> Result<(), MultiplierError> {
    // per function: weight, length of what is covered of its elements, an element
    let mut sums = vec![(T::zero(), T::zero(), 0); psi.num_functions()];
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    for piece in 0..segments.num_pieces() {
        let (element, points) = (segments.slave[piece], segments.points(piece));
        psi.active(element, &mut ids);
        psi.tabulate(element, &segments.slave_xi[points.clone()], Order::Values, &mut table);
        for (k, q) in points.enumerate() {
            for (&j, &value) in ids.iter().zip(table.values(k)) {
                sums[j] = (sums[j].0 + value * segments.ds[q], sums[j].1 + segments.ds[q], element);
            }
        }
    }
    for (j, (weight, length, element)) in sums.into_iter().enumerate() {
        if length > T::zero() && to_f64(weight.abs()) <= NO_WEIGHT * to_f64(length) {
            let reason = format!("the weight of function {j} on element {element} is zero");
            return Err(MultiplierError::NoDual { reason, known: String::new() });
        }
    }
    Ok(())
}

/// Renumbers the functions used on any element consecutively; returns their number. A function merged into others everywhere
/// is used on none.
fn drop_unused<T: Real>(functions: usize, pieces: &mut [ElementPolynomials<T>], elements: &mut [Read]) -> usize {
    let mut number = vec![0; functions];
    pieces.iter().flat_map(|p| &p.ids).for_each(|&i| number[i] = 1);
    let mut used = 0;
    for n in &mut number {
        (*n, used) = (used, used + *n);
    }
    let ids = pieces.iter_mut().flat_map(|p| &mut p.ids).chain(elements.iter_mut().flat_map(|e| &mut e.ids));
    ids.for_each(|i| *i = number[*i]);
    used
}

/// Whether the points of these pieces span an element. On curves they are the Gauss points of the element, divided among the masters, or
/// each piece has its own, which give its beginning and end; of surfaces the segments tell their share.
pub(super) fn is_whole<const S: usize, T: Real>(segments: &Segments<S, T>, element: usize, pieces: &[Range<usize>]) -> bool {
    if S > 1 {
        return segments.report.share.get(element).is_none_or(|&share| share >= T::one() - lit(WHOLE));
    }
    let mut all: Vec<f64> = pieces.iter().flat_map(|p| &segments.slave_xi[p.clone()]).map(|xi| to_f64(xi[0])).collect();
    all.sort_by(f64::total_cmp);
    let mut rule: Vec<f64> = gauss_legendre::<f64>(all.len()).points.iter().map(|x| x[0]).collect();
    rule.sort_by(f64::total_cmp);
    if all.iter().zip(&rule).all(|(a, b)| (a - b).abs() < WHOLE) {
        return true;
    }
    let width = |points: &Range<usize>| {
        let xi = segments.slave_xi[points.clone()].iter().map(|xi| xi[0]);
        let spread = xi.clone().fold(T::zero(), |m, x| m.max(x)) - xi.fold(T::one(), |m, x| m.min(x));
        let first = gauss_legendre::<T>(points.len()).points.iter().fold(T::one(), |m, x| m.min(x[0]));
        if points.len() > 1 { spread / (T::one() - first - first) } else { T::zero() }
    };
    pieces.iter().fold(T::zero(), |sum, p| sum + width(p)) >= T::one() - lit(WHOLE)
}

/// Functions of an element, ordered by their centroids.
struct Ordered {
    /// Their numbers on the side, and their indices in its table.
    functions: Vec<(usize, usize)>,
    /// Flags of those without a multiplier.
    gone: Vec<bool>,
}

impl Ordered {
    fn of<const N: usize, T: Real>(space: &dyn Space<1, N, T>, element: usize, gone: &[bool], work: &mut Work<T>) -> Self {
        work.integrate(space, element, &vec![false; gone.len()]);
        let m = work.kept.len();
        // centroid: (1 + ∫ P_1 N / ∫ N) / 2
        let centre = |a: usize| if m > 1 { to_f64(work.products[a * m + 1] / work.weights[a]) } else { 0.0 };
        let mut order: Vec<(f64, usize, usize)> = work.kept.iter().enumerate().map(|(a, &i)| (centre(a), i, a)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let functions: Vec<(usize, usize)> = order.into_iter().map(|(_, i, a)| (i, a)).collect();
        let gone = functions.iter().map(|&(i, _)| gone[i]).collect();
        Self { functions, gone }
    }

    /// For every function the one it is merged into: itself, or the nearest that has a multiplier.
    fn owners(&self) -> Vec<usize> {
        let n = self.functions.len();
        let nearest = |k: usize| (0..n).filter(|&j| !self.gone[j]).min_by_key(|&j| j.abs_diff(k)).unwrap_or(k);
        (0..n).map(nearest).collect()
    }
}

/// Builds the piece of an element that is covered in part (ids of the side); also returns the function that each one is merged into
/// and whether they are Bernstein polynomials.
fn over_part<const N: usize, T: Real>(
    space: &dyn Space<1, N, T>,
    element: usize,
    own: &Ordered,
    segments: &Segments<1, T>,
    pieces: &[Range<usize>],
) -> Result<(ElementPolynomials<T>, Vec<usize>, bool), MultiplierError> {
    let degree = space.degree(element)[0];
    if own.gone.iter().all(|&g| g) {
        return Err(MultiplierError::NothingLeft { element, degree });
    }
    let (mut table, n) = (ShapeTable::new(), own.functions.len());
    let signs: Vec<Vector<1, T>> = (0..SIGNS).map(|k| Vector::<1, T>::new(num::<T>(k) / num::<T>(SIGNS - 1))).collect();
    space.tabulate(element, &signs, Order::Values, &mut table);
    let is_bernstein = (0..SIGNS).any(|q| table.values(q).iter().any(|&v| to_f64(v) < -NO_VALUE));
    let lives = |q: usize| table.values(q).iter().filter(|v| to_f64(v.abs()) > NO_VALUE).count();
    if !is_bernstein && degree >= SMOOTH && (lives(0) > 1 || lives(SIGNS - 1) > 1) {
        let reason = format!("element {element} is covered in part, where dual functions of splines of degree {degree} have no bound");
        return Err(MultiplierError::NoDual { reason, known: String::new() });
    }
    // (xi, ds, values in order) of the points
    let xi: Vec<Vector<1, T>> = pieces.iter().flat_map(|p| segments.slave_xi[p.clone()].iter().copied()).collect();
    let ds: Vec<T> = pieces.iter().flat_map(|p| segments.ds[p.clone()].iter().copied()).collect();
    let bernstein = BSpline::bernstein(n - 1, &[T::zero(), T::one()]);
    if is_bernstein {
        bernstein.tabulate(0, &xi, Order::Values, &mut table);
    } else {
        space.tabulate(element, &xi, Order::Values, &mut table);
    }
    let place = |k: usize| if is_bernstein { k } else { own.functions[k].1 };
    let values = DMatrix::<T>::from_fn(n, xi.len(), |k, q| table.values(q)[place(k)]);
    let weight = |k: usize| (0..xi.len()).fold(T::zero(), |sum, q| sum + ds[q] * values[(k, q)]);
    let mut owner = own.owners();
    loop {
        let mut kept = owner.clone();
        kept.sort_unstable();
        kept.dedup();
        let m = kept.len();
        let mut sums = DMatrix::<T>::zeros(m, xi.len());
        for (k, o) in owner.iter().enumerate() {
            let row = kept.iter().position(|r| r == o).expect("an owner is kept");
            (0..xi.len()).for_each(|q| sums[(row, q)] += values[(k, q)]);
        }
        if let Some(coefficients) = dual_at_points(&sums, &xi, &ds) {
            let piece = ElementPolynomials { ids: kept.iter().map(|&k| own.functions[k].0).collect(), degree: m - 1, coefficients };
            return Ok((piece, owner, is_bernstein));
        }
        // merge the one of least weight into the heavier of its neighbours
        let share = |r: usize| owner.iter().enumerate().filter(|(_, o)| **o == kept[r]).fold(0.0, |s, (k, _)| s + to_f64(weight(k)));
        let least = (0..m).min_by(|&a, &b| share(a).total_cmp(&share(b))).expect("some are kept");
        let beside = [least.checked_sub(1), Some(least + 1).filter(|&r| r < m)];
        let Some(heir) = beside.into_iter().flatten().max_by(|&a, &b| share(a).total_cmp(&share(b))) else {
            let reason = format!("the functions on element {element} have no dual ones over the part of it that is covered");
            return Err(MultiplierError::NoDual { reason, known: String::new() });
        };
        owner.iter_mut().filter(|o| **o == kept[least]).for_each(|o| *o = kept[heir]);
    }
}

/// Legendre coefficients of the dual functions of as many functions, given by their values at points with weights ds; `None` if they do
/// not exist or exceed [`MOST`] there.
fn dual_at_points<T: Real>(values: &DMatrix<T>, xi: &[Vector<1, T>], ds: &[T]) -> Option<Vec<T>> {
    let (m, points) = values.shape();
    if m == 1 {
        return Some(vec![T::one()]);
    }
    let mut legendre = DMatrix::<T>::zeros(m, points);
    let mut one = Vec::new();
    for (q, xi) in xi.iter().enumerate() {
        legendre_polynomials(m - 1, xi[0], &mut one);
        (0..m).for_each(|k| legendre[(k, q)] = one[k]);
    }
    let weighted = DMatrix::<T>::from_fn(m, points, |i, q| values[(i, q)] * ds[q]);
    let d: Vec<T> = (0..m).map(|i| weighted.row(i).sum()).collect();
    if d.iter().any(|&d| to_f64(d).is_nan() || d <= T::zero()) {
        return None;
    }
    // G_ik / d_i, so that all rows have the same size
    let g = DMatrix::<T>::from_fn(m, m, |i, k| weighted.row(i).dot(&legendre.row(k)) / d[i]);
    let lu: LU<T, Dyn, Dyn> = g.clone().lu();
    let first = lu.solve(&DMatrix::identity(m, m))?;
    let transposed = &first + lu.solve(&(DMatrix::identity(m, m) - &g * &first))?;
    let psi = transposed.transpose() * &legendre;
    let product = &psi * weighted.transpose();
    let largest = d.iter().fold(T::zero(), |l, &d| l.max(d));
    let missed = (0..m).flat_map(|j| (0..m).map(move |i| (j, i))).fold(T::zero(), |worst, (j, i)| {
        let wanted = if i == j { d[i] } else { T::zero() };
        worst.max((product[(j, i)] - wanted).abs())
    });
    let good = to_f64(missed) <= NOT_DUAL * to_f64(largest) && to_f64(psi.amax()) <= MOST;
    good.then(|| transposed.as_slice().to_vec())
}

/// Functions of the side for evaluating the pressure of dual multipliers.
#[derive(Clone, Debug)]
pub struct Reading<const N: usize, T: Real = f64> {
    space: Arc<dyn Space<1, N, T>>,
    functions: usize,
    elements: Vec<Read>,
}

/// The functions of [`Reading`] on one element, as sums of those of the table.
#[derive(Clone, Debug)]
struct Read {
    ids: Vec<usize>,
    /// The index in `ids` for every function of the table.
    place: Vec<usize>,
    is_bernstein: bool,
}

impl Read {
    fn of(own: &Ordered, owner: &[usize], number: &[usize], is_bernstein: bool) -> Self {
        let mut kept = owner.to_vec();
        kept.sort_unstable();
        kept.dedup();
        let mut place = vec![0; owner.len()];
        for (k, o) in owner.iter().enumerate() {
            let of_table = if is_bernstein { k } else { own.functions[k].1 };
            place[of_table] = kept.iter().position(|r| r == o).expect("an owner is kept");
        }
        Self { ids: kept.iter().map(|&k| number[own.functions[k].0]).collect(), place, is_bernstein }
    }
}

impl<const N: usize, T: Real> Elements for Reading<N, T> {
    fn num_elements(&self) -> usize {
        self.elements.len()
    }
    fn cell(&self, element: usize) -> Cell {
        self.space.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.space.corners(element, ids);
    }
}

impl<const N: usize, T: Real> Basis<1, T> for Reading<N, T> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, element: usize) -> [usize; 1] {
        self.space.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(&self.elements[element].ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1, T>], order: Order, table: &mut ShapeTable<1, T>) {
        let (read, mut own) = (&self.elements[element], ShapeTable::new());
        if read.is_bernstein {
            BSpline::bernstein(read.place.len() - 1, &[T::zero(), T::one()]).tabulate(0, xi, order, &mut own);
        } else {
            self.space.tabulate(element, xi, order, &mut own);
        }
        table.reset(xi.len(), read.ids.len(), order);
        if read.ids.len() == 1 {
            // a single function is one, without the rounding of its derivatives
            (0..xi.len()).for_each(|q| table.values_mut(q)[0] = T::one());
            return;
        }
        for q in 0..xi.len() {
            for (a, &at) in read.place.iter().enumerate() {
                table.values_mut(q)[at] += own.values(q)[a];
                if order >= Order::Gradients {
                    table.grads_mut(q)[at] += own.grads(q)[a];
                }
                if order >= Order::Hessians {
                    table.hessians_mut(q)[at] += own.hessians(q)[a];
                }
            }
        }
    }
}
