//! Boxes that surely hold a combination of basis functions on an element, and tighter ones for maps.

use super::{Bounds, Geometry, MapTable, cell};
use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::linalg::{Real, Vector, lit, num};

/// A box that holds sum_i N_i(xi) v_i for all xi in the cell of `element`; `value(i)` gives v_i. `None` without functions.
///
/// Where no function is negative the values themselves are a hull. Else (Lagrange) the functions are polynomials of the
/// basis' degree, and the Bernstein coefficients of the sum are.
pub fn hull<const D: usize, const N: usize, T: Real, B: Basis<D, T> + ?Sized>(
    basis: &B,
    element: usize,
    value: impl Fn(usize) -> Vector<N, T>,
) -> Option<Bounds<N, T>> {
    let mut ids = Vec::new();
    basis.active(element, &mut ids);
    let values: Vec<Vector<N, T>> = ids.iter().map(|&i| value(i)).collect();
    let around = Bounds::around(&values)?;
    let degree = basis.degree(element).into_iter().max().unwrap_or(0);
    let cell = basis.cell(element);
    if degree <= 1 && cell == Cell::Simplex {
        return Some(around);
    }
    // Chebyshev points: inside the cell, never nodes, so a Lagrange function of degree >= 2 shows a negative value
    let line: Vec<T> =
        (0..=degree).map(|j| lit((1.0 - (std::f64::consts::PI * (2 * j + 1) as f64 / (2 * degree + 2) as f64).cos()) / 2.0)).collect();
    let points = cell::spread::<D, T>(cell, &line);
    let mut table = ShapeTable::new();
    basis.tabulate(element, &points, Order::Values, &mut table);
    let noise = T::default_epsilon() * lit(64.0);
    if (0..points.len()).all(|q| table.values(q).iter().all(|&n| n >= -noise)) {
        return Some(around);
    }
    let mut coefficients: Vec<Vector<N, T>> =
        (0..points.len()).map(|q| table.values(q).iter().zip(&values).fold(Vector::zeros(), |s, (&n, v)| s + v * n)).collect();
    let inverse = bernstein_inverse(&line);
    let n = line.len();
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
    Some(hull.inflated(hull.diagonal() * noise * lit(16.0)))
}

/// The box `outer` of an element cut to one around samples, grown by four times the sampled deviation from straight pieces.
///
/// The control points of a coarse map surround all of its cells; this box is near to the one asked for.
pub(super) fn tightened<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(
    geometry: &G,
    element: usize,
    outer: Bounds<N, T>,
) -> Bounds<N, T> {
    let pieces = if D < 3 { 4 } else { 2 };
    let points = cell::grid::<D, T>(geometry.cell(element), pieces + 1);
    let mut table = MapTable::new();
    geometry.map(element, &points, Order::Hessians, &mut table);
    let Some(samples) = Bounds::around(&table.x) else { return outer };
    let bend = table.hessian.iter().flatten().fold(T::zero(), |m, h| m.max(h.iter().fold(T::zero(), |s, v| s + v.abs())));
    // |x - linear interpolation| <= max |x''| h^2 / 8 per coordinate; the samples of x'' may miss its peak
    let rounding = samples.diagonal() * T::default_epsilon() * lit(16.0);
    let grown = samples.inflated(bend * lit(0.5 / (pieces * pieces) as f64) + rounding);
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
