//! Polynomial reproduction: degree of the polynomials that a multiplier space contains, found from its values alone.
//!
//! The coordinate t of a side is affine on every element, and its speed dt/ds is continuous across vertices: on a spline
//! side the parameter of the knots up to a factor (a smooth map has a continuous speed), on straight elements of equal
//! map the arc length. A speed of zero gives no ratio; then elements count by their chords.
//!
//! All functions of an element are independent there, so a polynomial has one set of coefficients per element: it lies in
//! the space if these have no residual, and if every function gets the same coefficient on all its elements. On
//! closed sides t continues through the first element.

use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::interface::Chain;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit, num, to_f64};
use crate::quadrature::gauss_legendre;
use nalgebra::DMatrix;

/// Largest residual of a polynomial in the space, relative to its size.
const LEFT_OVER: f64 = 1e-8;
/// Speeds below this share of the element's length count as zero.
const NO_SPEED: f64 = 1e-9;

/// An element in the order of the side: t = middle + half_width x, x = 2 xi - 1.
#[derive(Clone, Copy)]
struct Stretch<T> {
    middle: T,
    /// Negative where the element runs against t.
    half_width: T,
}

/// Returns the highest q such that all polynomials of degree q of the side's coordinate lie in the span of `multiplier`;
/// `None` if not even constants do.
///
/// `curve` is the map of the slave side, on whose elements `multiplier` is defined. Splines of degree p give p, with lowered
/// ends p - 1; discontinuous spaces their degree; dual ones of splines 0, of straight Lagrange
/// traces p - 1 at least.
pub fn reproduction<const N: usize, T: Real>(curve: &dyn Geometry<1, N, T>, multiplier: &dyn Basis<1, T>) -> Option<usize> {
    let highest = (0..multiplier.num_elements()).map(|e| multiplier.degree(e)[0]).max()?;
    let side = Coordinate::of(curve);
    // per function the index of its first element, and its coefficients of x^0 .. x^highest there
    let mut first: Vec<Option<(usize, Vec<T>)>> = vec![None; multiplier.num_functions()];
    let mut last_place = vec![0usize; multiplier.num_functions()];
    let (mut order, mut ids, mut table) = (highest as isize, Vec::new(), ShapeTable::new());
    for (place, &element) in side.elements.iter().enumerate() {
        let (local, coefficients) = local_coefficients(multiplier, element, highest, &mut table);
        order = order.min(local);
        multiplier.active(element, &mut ids);
        for (a, &j) in ids.iter().enumerate() {
            let own: Vec<T> = (0..=highest).map(|k| coefficients[(a, k)]).collect();
            match &first[j] {
                None => first[j] = Some((place, own)),
                Some((start, known)) => {
                    // a function that recurs after a gap is continued through the closed end
                    let through = side.period.filter(|_| place > last_place[j] + 1);
                    let from = through.map_or(side.stretches[*start], |(length, growth)| Stretch {
                        middle: length + growth * side.stretches[*start].middle,
                        half_width: growth * side.stretches[*start].half_width,
                    });
                    order = order.min(agreement(from, known, side.stretches[place], &own, order));
                    if through.is_some() {
                        first[j] = Some((place, own));
                    }
                }
            }
            last_place[j] = place;
        }
    }
    usize::try_from(order).ok()
}

/// The elements of a side along its coordinate.
struct Coordinate<T> {
    elements: Vec<usize>,
    stretches: Vec<Stretch<T>>,
    /// Length of a closed side, and the ratio of widths of a second round to the first.
    period: Option<(T, T)>,
}

impl<T: Real> Coordinate<T> {
    fn of<const N: usize>(curve: &dyn Geometry<1, N, T>) -> Self {
        let chain = Chain::of(curve);
        let walk = chain.walk();
        let mut map = MapTable::new();
        let ends = [Vector::<1, T>::new(T::zero()), Vector::<1, T>::new(T::one())];
        let mut speeds = |element: usize| {
            curve.map(element, &ends, Order::Gradients, &mut map);
            [0, 1].map(|q| map.jacobian[q].norm())
        };
        let half = lit::<T>(0.5);
        let (mut stretches, mut begin, mut before) = (Vec::with_capacity(walk.len()), T::zero(), None::<(usize, usize, T, T)>);
        let width_after = |before: Option<(usize, usize, T, T)>, element: usize, entry: usize, speed: T| {
            let joined = before.filter(|&(e, exit, ..)| chain.neighbour(e, exit) == Some((element, entry)));
            let moves = |e: usize, s: T| to_f64(s) > NO_SPEED * to_f64(chain.lengths[e]);
            match joined {
                Some((e, _, width, last)) if moves(e, last) && moves(element, speed) => width * speed / last,
                _ => chain.lengths[element],
            }
        };
        for &(element, backwards) in &walk {
            let speed = speeds(element);
            let (entry, exit) = if backwards { (1, 0) } else { (0, 1) };
            let width = width_after(before, element, entry, speed[entry]);
            let half_width = if backwards { -half * width } else { half * width };
            stretches.push(Stretch { middle: begin + half * width, half_width });
            begin += width;
            before = Some((element, exit, width, speed[exit]));
        }
        let period = walk.first().zip(before).and_then(|(&(element, backwards), last)| {
            let entry = usize::from(backwards);
            let closed = walk.len() > 1 && chain.neighbour(last.0, last.1) == Some((element, entry));
            closed.then(|| {
                let width = width_after(before, element, entry, speeds(element)[entry]);
                (begin, width / (stretches[0].half_width.abs() * lit(2.0)))
            })
        });
        Self { elements: walk.iter().map(|w| w.0).collect(), stretches, period }
    }
}

/// The highest k such that x^0 .. x^k lie in the span on `element` (-1: none), and the coefficients (function, k).
fn local_coefficients<T: Real>(
    multiplier: &dyn Basis<1, T>,
    element: usize,
    highest: usize,
    table: &mut ShapeTable<1, T>,
) -> (isize, DMatrix<T>) {
    let rule = gauss_legendre::<T>(highest + 2);
    multiplier.tabulate(element, &rule.points, Order::Values, table);
    let root: Vec<T> = rule.weights.iter().map(|w| w.sqrt()).collect();
    let values = DMatrix::<T>::from_fn(root.len(), table.num_functions(), |q, a| root[q] * table.values(q)[a]);
    let x = |q: usize| lit::<T>(2.0) * rule.points[q][0] - T::one();
    let powers = DMatrix::<T>::from_fn(root.len(), highest + 1, |q, k| root[q] * x(q).powi(k as i32));
    let none = || (-1, DMatrix::zeros(table.num_functions(), highest + 1));
    if table.num_functions() > root.len() {
        return none();
    }
    let qr = values.clone().qr();
    let Some(coefficients) = qr.r().solve_upper_triangular(&(qr.q().transpose() * &powers)) else { return none() };
    let rest = &powers - &values * &coefficients;
    let held = |k: &usize| to_f64(rest.column(*k).norm()) <= LEFT_OVER * to_f64(powers.column(*k).norm());
    let order = (0..=highest).take_while(held).count() as isize - 1;
    (order, coefficients)
}

/// The highest k <= `most` such that the coefficients of ((t - middle) / half_width)^0 .. ^k of `from` are the same on both elements.
fn agreement<T: Real>(from: Stretch<T>, known: &[T], to: Stretch<T>, own: &[T], most: isize) -> isize {
    // in the coordinate of the first element the second one is shift + stretch x
    let (shift, stretch) = ((to.middle - from.middle) / from.half_width, to.half_width / from.half_width);
    for k in 0..=usize::try_from(most).unwrap_or(0) {
        let (mut sum, mut size, mut binomial) = (T::zero(), known[k].abs(), T::one());
        for m in 0..=k {
            let term = binomial * shift.powi((k - m) as i32) * stretch.powi(m as i32) * own[m];
            sum += term;
            size += term.abs();
            binomial = binomial * num::<T>(k - m) / num::<T>(m + 1);
        }
        let apart = to_f64((sum - known[k]).abs());
        if apart.is_nan() || apart > LEFT_OVER * to_f64(size) {
            return k as isize - 1;
        }
    }
    most
}
