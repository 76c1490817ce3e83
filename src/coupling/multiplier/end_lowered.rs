//! Multiplier spaces whose degree is one lower on the elements at constrained ends.
//!
//! On an end element with functions N_0 .. N_p (N_0 the one at the end) let c_i be the coefficient of xi^p of N_i. Two
//! neighbours at a time cancel it, with one function less in total:
//!
//! ```text
//! N_i' = h_i N_i + (1 - h_{i+1}) N_{i+1},   i = 0 .. p-1,   h_i = (c_0 + .. + c_i) / c_i,   h_p = 0
//! ```
//!
//! They still sum to one: sum_i c_i = 0 because the N_i do. For B-splines the c_i alternate and their partial sums follow
//! (they are top coefficients of degree p - 1), so 0 <= h_i <= 1 and the N_i' stay non-negative; on Bernstein functions this
//! is degree elevation backwards. Other bases, whose c_i do not alternate, take N_i' = N_i - (c_i / c_0) N_0, i = 1 .. p:
//! the same space with functions of any sign. c_i is a divided difference of values, so any univariate basis will do.
//! Source: Brivadis, Buffa, Wohlmuth, Wunderlich, CMAME 284 (2015) 292-319, section 4 (cross points).

use super::{MultiplierError, SideEnd};
use crate::basis::{Basis, Extracted, Order, ShapeTable};
use crate::linalg::{Real, Vector, num, to_f64};

/// Top coefficients below this share of the largest coefficient count as zero.
const NO_TOP_COEFFICIENT: f64 = 1e-10;

/// Lowers the degree of `inner` by one at each of `ends`; an element listed twice loses two degrees.
///
/// # Errors
/// [`MultiplierError::NothingLeft`] where an end element has no degree left to lose.
pub fn end_lowered<T: Real>(inner: Box<dyn Basis<1, T>>, ends: &[SideEnd]) -> Result<Box<dyn Basis<1, T>>, MultiplierError> {
    let mut basis = inner;
    let mut done: Vec<usize> = Vec::new();
    for end in ends {
        let degree = basis.degree(end.element)[0];
        let lost = done.iter().filter(|&&e| e == end.element).count();
        if degree <= lost || basis.num_functions() < 2 {
            return Err(MultiplierError::NothingLeft { element: end.element, degree });
        }
        basis = lowered_once(basis, end, degree - lost);
        done.push(end.element);
    }
    Ok(basis)
}

/// Removes the term of `degree` on the element of `end`.
fn lowered_once<T: Real>(basis: Box<dyn Basis<1, T>>, end: &SideEnd, degree: usize) -> Box<dyn Basis<1, T>> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    basis.active(end.element, &mut ids);
    let top = top_coefficients(&*basis, end.element, degree, &mut table);
    let at_end = Vector::<1, T>::new(if end.at == 0 { T::zero() } else { T::one() });
    if let Some(rows) = positive_rows(&ids, &top, end.at, basis.num_functions()) {
        let functions = basis.num_functions() - 1;
        return Box::new(Extracted::new::<1>(basis, functions, rows));
    }
    basis.tabulate(end.element, &[at_end], Order::Values, &mut table);
    let values: Vec<f64> = table.values(0).iter().map(|&v| to_f64(v).abs()).collect();
    let largest = top.iter().map(|&c| to_f64(c).abs()).fold(0.0, f64::max);
    // removes the function of the end; if it has no term of that degree (modal bases), the one with the largest
    let has_top = |a: usize| to_f64(top[a]).abs() > NO_TOP_COEFFICIENT * largest;
    let by_value = (0..ids.len()).filter(|&a| has_top(a)).max_by(|&a, &b| values[a].total_cmp(&values[b]));
    let by_top = || (0..ids.len()).max_by(|&a, &b| to_f64(top[a]).abs().total_cmp(&to_f64(top[b]).abs()));
    let gone = by_value.filter(|&a| values[a] > NO_TOP_COEFFICIENT).or_else(by_top).expect("an element has functions");
    let removed = ids[gone];
    // new numbers: the functions behind the removed one move up
    let number = |i: usize| i - usize::from(i > removed);
    let functions = basis.num_functions();
    let mut rows: Vec<Vec<(usize, T)>> = (0..functions).map(|i| vec![(number(i), T::one())]).collect();
    let shares = (0..ids.len()).filter(|&a| a != gone).map(|a| (number(ids[a]), -top[a] / top[gone]));
    rows[removed] = shares.filter(|&(_, alpha)| alpha != T::zero()).collect();
    Box::new(Extracted::new::<1>(basis, functions - 1, rows))
}

/// Values below this are negative; above one minus this they exceed one.
const NEGATIVE: f64 = -1e-12;

/// Rows of the two-term combinations, `None` unless non-negative; `ids` run along the element, `at` is its lowered end.
fn positive_rows<T: Real>(ids: &[usize], top: &[T], at: usize, functions: usize) -> Option<Vec<Vec<(usize, T)>>> {
    let last = ids.len() - 1;
    // functions from the lowered end inwards
    let inwards = |k: usize| if at == 0 { k } else { last - k };
    let ordered: Vec<usize> = (0..=last).map(|k| ids[inwards(k)]).collect();
    if last == 0 || !ids.windows(2).all(|w| w[0] < w[1]) {
        return None;
    }
    let (mut shares, mut sum) = (Vec::with_capacity(last), T::zero());
    for k in 0..last {
        let c = top[inwards(k)];
        sum += c;
        let share = sum / c; // not finite where c vanishes
        if !(to_f64(share) >= NEGATIVE && to_f64(share) <= 1.0 - NEGATIVE) {
            return None;
        }
        shares.push(share);
    }
    let removed = ordered[0];
    let number = |i: usize| i - usize::from(i > removed);
    let mut rows: Vec<Vec<(usize, T)>> = (0..functions).map(|i| vec![(number(i), T::one())]).collect();
    rows[removed] = vec![(number(ordered[1]), T::one())];
    for k in 1..last {
        rows[ordered[k]] = vec![(number(ordered[k]), T::one() - shares[k]), (number(ordered[k + 1]), shares[k])];
    }
    Some(rows)
}

/// Coefficients of xi^degree of the active functions on `element`: their divided differences on degree + 1 points.
fn top_coefficients<T: Real>(basis: &dyn Basis<1, T>, element: usize, degree: usize, table: &mut ShapeTable<1, T>) -> Vec<T> {
    let points: Vec<Vector<1, T>> = (0..=degree).map(|q| Vector::<1, T>::new(num::<T>(q) / num::<T>(degree.max(1)))).collect();
    basis.tabulate(element, &points, Order::Values, table);
    let mut top = vec![T::zero(); table.num_functions()];
    for q in 0..=degree {
        // product of (x_q - x_r) over r != q
        let gaps = (0..=degree).filter(|&r| r != q).fold(T::one(), |p, r| p * (points[q][0] - points[r][0]));
        for (c, &v) in top.iter_mut().zip(table.values(q)) {
            *c += v / gaps;
        }
    }
    // differences of equal numbers leave round-off where the true coefficient is zero
    let largest = top.iter().map(|&c| to_f64(c).abs()).fold(0.0, f64::max);
    top.iter_mut().filter(|c| to_f64(**c).abs() <= 1e-13 * largest).for_each(|c| *c = T::zero());
    top
}
