//! Check that functions continue their polynomial or rational form outside the cell.

use super::basis::largest;
use super::points;
use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, lit, to_f64};
use nalgebra::DMatrix;

/// Parameters outside the unit segment at which the continuation of a function is tested.
const BEYOND: [f64; 2] = [-0.1, 1.1];
/// Nodes from which smooth functions that are neither polynomial nor rational are continued; half of them for low precision of T.
const NODES: usize = 18;

/// Checks that values beyond the cell lie on the smooth continuation of those inside, along every direction.
pub(super) fn continues<const D: usize, T: Real>(basis: &dyn Basis<D, T>, e: usize, table: &mut ShapeTable<D, T>) -> Result<(), String> {
    let epsilon = to_f64(T::default_epsilon());
    let allowed = epsilon.powf(0.3);
    for k in 0..D {
        let degree = basis.degree(e)[k];
        let nodes = if epsilon < 1e-10 { NODES } else { NODES / 2 };
        let mut apart = leaves_polynomial(basis, e, k, nodes.max(degree + 1), table);
        if apart.is_nan() || apart > allowed {
            apart = samples(basis, e, k, 2 * degree + 4, table).leaves_quotient(degree);
        }
        if apart.is_nan() || apart > allowed {
            return Err(format!("outside the cell in direction {k} a function leaves its own continuation by {apart:e}"));
        }
    }
    Ok(())
}

/// Largest distance of values beyond the cell from the polynomial through `nodes` values inside, relative to the largest value.
pub(super) fn leaves_polynomial<const D: usize, T: Real>(
    basis: &dyn Basis<D, T>,
    e: usize,
    axis: usize,
    nodes: usize,
    table: &mut ShapeTable<D, T>,
) -> f64 {
    samples(basis, e, axis, nodes, table).leaves_polynomial()
}

/// Values of the active functions along a segment across the cell.
struct Samples {
    /// Values at the Chebyshev nodes, function by function.
    inside: Vec<Vec<f64>>,
    /// Values at [`BEYOND`], function by function.
    outside: Vec<[f64; 2]>,
    size: f64,
}

fn samples<const D: usize, T: Real>(basis: &dyn Basis<D, T>, e: usize, axis: usize, nodes: usize, table: &mut ShapeTable<D, T>) -> Samples {
    let (start, direction) = points::line::<D, T>(basis.cell(e), axis);
    let inside = (0..nodes).map(|q| 0.5 - 0.5 * angle(q, nodes).cos());
    let xi: Vec<_> = inside.chain(BEYOND).map(|s| start + direction * lit::<T>(s)).collect();
    basis.tabulate(e, &xi, Order::Values, table);
    let value = |q: usize, a: usize| to_f64(table.values(q)[a]);
    Samples {
        inside: (0..table.num_functions()).map(|a| (0..nodes).map(|q| value(q, a)).collect()).collect(),
        outside: (0..table.num_functions()).map(|a| [value(nodes, a), value(nodes + 1, a)]).collect(),
        size: largest(table),
    }
}

fn angle(q: usize, nodes: usize) -> f64 {
    std::f64::consts::PI * (2 * q + 1) as f64 / (2 * nodes) as f64
}

/// Chebyshev polynomials T_0 .. T_(n - 1) at s, on the segment [0, 1], reversed as the nodes are.
fn chebyshev(n: usize, s: f64) -> Vec<f64> {
    let x = 1.0 - 2.0 * s;
    let mut t = vec![1.0, x];
    for k in 2..n {
        t.push(2.0 * x * t[k - 1] - t[k - 2]);
    }
    t.truncate(n);
    t
}

/// Chebyshev coefficient k of the values at the nodes.
fn coefficient(values: impl Iterator<Item = f64>, nodes: usize, k: usize) -> f64 {
    let sum: f64 = values.enumerate().map(|(q, v)| v * (k as f64 * angle(q, nodes)).cos()).sum();
    sum * if k == 0 { 1.0 } else { 2.0 } / nodes as f64
}

impl Samples {
    fn apart(&self, expected: impl Fn(usize, f64) -> f64) -> f64 {
        let mut worst = 0.0f64;
        for (a, found) in self.outside.iter().enumerate() {
            for (&s, v) in BEYOND.iter().zip(found) {
                let gap = (expected(a, s) - v).abs() / self.size;
                worst = if gap.is_nan() { return gap } else { worst.max(gap) };
            }
        }
        worst
    }

    fn leaves_polynomial(&self) -> f64 {
        self.apart(|a, s| {
            let n = self.inside[a].len();
            let t = chebyshev(n, s);
            (0..n).map(|k| coefficient(self.inside[a].iter().copied(), n, k) * t[k]).sum()
        })
    }

    /// Largest distance from quotients of polynomials of `degree` with a common denominator W, relative to the largest value: W is
    /// the polynomial for which no W N_a has a part of higher degree.
    fn leaves_quotient(&self, degree: usize) -> f64 {
        let n = self.inside.first().map_or(0, Vec::len);
        if n <= degree + 1 {
            return f64::NAN;
        }
        let times = |a: usize, j: usize| self.inside[a].iter().enumerate().map(move |(q, v)| v * (j as f64 * angle(q, n)).cos());
        let high = n - degree - 1;
        let parts =
            DMatrix::from_fn(self.inside.len() * high, degree + 1, |row, j| coefficient(times(row / high, j), n, degree + 1 + row % high));
        let Some(v) = parts.svd(false, true).v_t else { return f64::NAN };
        let w: Vec<f64> = v.row(v.nrows() - 1).iter().copied().collect(); // the smallest singular value is the last
        self.apart(|a, s| {
            let t = chebyshev(degree + 1, s);
            let below: f64 = w.iter().zip(&t).map(|(w, t)| w * t).sum();
            let above: f64 = (0..=degree).map(|k| t[k] * (0..=degree).map(|j| w[j] * coefficient(times(a, j), n, k)).sum::<f64>()).sum();
            above / below
        })
    }
}
