//! Quality and measure of the map of a body.

use super::Space;
use crate::basis::{Cell, Order};
use crate::geometry::{Geometry, MapTable, Sampler, cell, circumference};
use crate::linalg::{Matrix, Real, Vector, determinant, lit, measure as scale, to_f64};
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};

/// Jacobians below this share of the element's largest are zero: a collapsed edge, not an inversion.
const ZERO: f64 = 1e-10;
/// Rounding errors of a derivative, in units of the last place of the positions.
const ROUNDINGS: f64 = 16.0;
/// The largest share that counts as rounding: an element that folds over by more is inverted, however far away and small it is.
const MOST_ROUNDING: f64 = 1e-6;

/// Range of degrees that sets the number of sample points: lower and higher ones are clamped to it.
const DEGREES: [usize; 2] = [2, 4];

/// Quality of the map of a body: least Jacobian, orientation, degenerate elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality<const N: usize> {
    /// Least |det dx/dxi| over sampled points that are not degenerate, in local coordinates \[length^N\].
    pub least_jacobian: f64,
    /// The element that has it.
    pub element: usize,
    /// Position of the least Jacobian \[length\].
    pub at: Vector<N>,
    /// Whether the determinant is negative throughout.
    pub left_handed: bool,
    /// Elements with a point where the map is singular: a collapsed edge.
    pub degenerate: Vec<usize>,
}

/// The determinant of the Jacobian changes sign.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("element {element} is inverted: its Jacobian falls to {least_jacobian:.4e} at {at:?}; the map must not fold over")]
pub struct InvertedElement {
    /// The element.
    pub element: usize,
    /// Least determinant, in local coordinates, counted positive where the body as a whole is.
    pub least_jacobian: f64,
    /// Position; coordinates beyond the dimension are zero.
    pub at: [f64; 3],
}

/// Mean and extreme determinants of one element, with their points.
struct Sampled<const N: usize> {
    mean: f64,
    least: (f64, Vector<N>),
    most: (f64, Vector<N>),
}

/// Samples the Jacobian of every element on a grid of its cell, corners included; where the map is affine, once.
///
/// Of several elements with the least value the first is returned.
///
/// # Errors
/// [`InvertedElement`] where the determinant has two signs, or vanishes on a whole element; of several the worst.
pub fn quality<const N: usize, T: Real, X: Space<N, N, T> + ?Sized>(space: &X) -> Result<Quality<N>, InvertedElement> {
    let grids = [Cell::Tensor, Cell::Simplex]
        .map(|kind| (DEGREES[0]..=DEGREES[1]).map(|degree| cell::grid::<N, T>(kind, degree + 2)).collect::<Vec<_>>());
    let centers = [Cell::Tensor, Cell::Simplex].map(cell::center::<N, T>);
    let maps = || (Sampler::new(space, Order::Gradients), MapTable::<N, N, T>::new());
    let sampled: Vec<Sampled<N>> = parallel::map_init(space.num_elements(), maps, |(map, table), e| {
        let degree = space.degree(e).into_iter().max().unwrap_or(1).clamp(DEGREES[0], DEGREES[1]);
        let kind = usize::from(space.cell(e) == Cell::Simplex);
        // sets of points by their degree, the centre before them
        let (set, points) = match space.map_structure().is_affine(e) {
            true => (0, std::slice::from_ref(&centers[kind])),
            false => (degree, &grids[kind][degree - DEGREES[0]][..]),
        };
        map.map(e, 2 * set + kind, points, table);
        let mut s = Sampled { mean: 0.0, least: (f64::INFINITY, Vector::zeros()), most: (f64::NEG_INFINITY, Vector::zeros()) };
        for (j, x) in table.jacobian.iter().zip(&table.x) {
            let d = to_f64(determinant(j));
            let x = x.map(to_f64);
            s.mean += d / points.len() as f64;
            if d < s.least.0 || d.is_nan() {
                s.least = (d, x);
            }
            if d > s.most.0 || d.is_nan() {
                s.most = (d, x);
            }
        }
        s
    });
    let left_handed = sampled.iter().map(|s| s.mean).sum::<f64>() < 0.0;
    let mut worst: Option<InvertedElement> = None;
    let mut quality = Quality { least_jacobian: f64::INFINITY, element: 0, at: Vector::zeros(), left_handed, degenerate: Vec::new() };
    for (element, s) in sampled.iter().enumerate() {
        let (least, most) = if left_handed { ((-s.most.0, s.most.1), (-s.least.0, s.least.1)) } else { (s.least, s.most) };
        let largest = least.0.abs().max(most.0.abs());
        // far from the origin the rounding of positions decides
        let rounding = ROUNDINGS * f64::EPSILON * most.1.norm() / largest.powf(1.0 / N as f64);
        let zero = largest * if rounding > ZERO { rounding.min(MOST_ROUNDING) } else { ZERO };
        // NaN fails this test, too
        let sound = least.0 >= -zero && most.0 > 0.0;
        if !sound {
            if worst.as_ref().is_none_or(|w| least.0 < w.least_jacobian) {
                let at = std::array::from_fn(|k| if k < N { least.1[k] } else { 0.0 });
                worst = Some(InvertedElement { element, least_jacobian: least.0, at });
            }
        } else if least.0 <= zero {
            quality.degenerate.push(element);
        } else if least.0 < quality.least_jacobian {
            quality.least_jacobian = least.0;
            quality.element = element;
            quality.at = least.1;
        }
    }
    if quality.degenerate.len() == sampled.len() {
        quality.least_jacobian = 0.0;
    }
    worst.map_or(Ok(quality), Err)
}

/// Length, area or volume of a map: ∫ sqrt(det JᵀJ) dxi.
///
/// Gauss points are added per element until the sum settles, so that rational maps reach rounding, that of the Jacobian included;
/// polynomial maps do at once. Affine maps take one point.
pub fn measure<const D: usize, const N: usize, T: Real, X: Geometry<D, N, T> + ?Sized>(geometry: &X) -> T {
    integral(geometry, &|_| T::one())
}

/// Area or volume of what a map makes on its way around the axis: ∫ 2 pi r sqrt(det JᵀJ) dxi, r the first coordinate. As accurate as
/// [`measure`].
pub fn revolved_measure<const D: usize, const N: usize, T: Real, X: Geometry<D, N, T> + ?Sized>(geometry: &X) -> T {
    integral(geometry, &circumference)
}

/// ∫ f sqrt(det JᵀJ) dxi for a linear function f.
fn integral<const D: usize, const N: usize, T: Real, X: Geometry<D, N, T> + ?Sized>(
    geometry: &X,
    f: &(dyn Fn(&Vector<N, T>) -> T + Sync),
) -> T {
    const COUNTS: [usize; 8] = [2, 3, 4, 6, 9, 13, 18, 24];
    let rule_of = |kind: Cell, n: usize| -> Rule<D, T> {
        match kind {
            Cell::Tensor => TensorRule::<D, T>::gauss([n; D]).rule(0).clone(),
            Cell::Simplex => simplex_rule(2 * n - 1),
        }
    };
    // the large rules of a kind of cells cost more than many elements: none where nothing is curved
    let curved = [Cell::Tensor, Cell::Simplex]
        .map(|kind| (0..geometry.num_elements()).any(|e| geometry.cell(e) == kind && !geometry.map_structure().is_affine(e)));
    let rules_of = |kind: Cell, wanted: bool| COUNTS.iter().filter(|_| wanted).map(|&n| rule_of(kind, n)).collect::<Vec<_>>();
    let rules = [rules_of(Cell::Tensor, curved[0]), rules_of(Cell::Simplex, curved[1])];
    let affine = [Cell::Tensor, Cell::Simplex].map(|kind| match kind {
        Cell::Tensor => (cell::center::<D, T>(kind), T::one()),
        // the unit simplex has the measure 1 / D!
        Cell::Simplex => (cell::center::<D, T>(kind), T::one() / crate::linalg::num((1..=D).product::<usize>())),
    });
    let maps = || (Sampler::new(geometry, Order::Gradients), MapTable::<D, N, T>::new());
    let parts: Vec<T> = parallel::map_init(geometry.num_elements(), maps, |(map, table), e| {
        let kind = usize::from(geometry.cell(e) == Cell::Simplex);
        if geometry.map_structure().is_affine(e) {
            let (point, size) = &affine[kind];
            map.map(e, kind, std::slice::from_ref(point), table);
            return scale(&table.jacobian[0]) * *size * f(&table.x[0]);
        }
        let mut last = T::zero();
        for (k, rule) in rules[kind].iter().enumerate() {
            map.map(e, 2 * (k + 1) + kind, &rule.points, table);
            let points = table.jacobian.iter().zip(&rule.weights).zip(&table.x);
            let sum = points.fold(T::zero(), |s, ((j, &w), x)| s + scale(j) * w * f(x));
            let settled = k > 0 && (sum - last).abs() <= lit::<T>(16.0) * rounding(table) * sum.abs();
            last = sum;
            if settled {
                break;
            }
        }
        last
    });
    parts.into_iter().fold(T::zero(), |s, p| s + p)
}

/// Relative rounding error of a Jacobian: positions as large as x cancel in cells as thin as its least singular value, which is not
/// less than the measure over the other columns; large for thin cells far from the origin.
fn rounding<const D: usize, const N: usize, T: Real>(table: &MapTable<D, N, T>) -> T {
    let square = |v: T, x: &T| v + *x * *x;
    let size = table.x.iter().map(|x| x.iter().fold(T::zero(), square)).fold(T::zero(), |m, s| m.max(s)).sqrt();
    let share = |j: &Matrix<N, D, T>| {
        let columns = (0..D).map(|k| j.column(k).iter().fold(T::zero(), square).sqrt());
        let (product, least) = columns.fold((T::one(), None), |(p, m), c| (p * c, Some(m.map_or(c, |m: T| m.min(c)))));
        product / (least.unwrap_or(T::one()) * scale(j))
    };
    let thinnest = table.jacobian.iter().map(share).fold(T::zero(), |m, s| m.max(s));
    // cells vanish without any cancellation where they collapse: their sum must settle all the same
    let most = T::default_epsilon().sqrt() * lit(0.01);
    (T::default_epsilon() * (T::one() + size * thinnest)).min(most)
}
