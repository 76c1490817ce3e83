//! Elements cut into parts of which the normals turn little.

use super::facets::{Facets, angle};
use super::polygon::Polygon;
use crate::basis::Order;
use crate::geometry::{MapTable, unit_normal};
use crate::linalg::{Matrix, Vector};

/// Largest turn of the normals along a direction of a facet \[rad\].
const TURN: f64 = std::f64::consts::FRAC_PI_3;

/// Origins and axes of the parts into which the element of facet `whole`, which is all of it, is cut.
pub(super) fn parts(facets: &Facets<'_>, whole: usize, table: &mut MapTable<2, 3>) -> Vec<(Vector<2>, Matrix<2, 2>)> {
    const LINES: usize = 5;
    let polygon = facets.list[whole].polygon;
    // lines a little inside: normals vanish at poles
    let at = |i: usize, j: usize| {
        let t = |k: usize| 0.01 + 0.98 * k as f64 / (LINES - 1) as f64;
        match polygon {
            Polygon::Square => Vector::<2>::new(t(i), t(j)),
            Polygon::Triangle => Vector::<2>::new(t(i) * (1.0 - t(j)), t(j)),
        }
    };
    let points: Vec<Vector<2>> = (0..LINES * LINES).map(|q| at(q % LINES, q / LINES)).collect();
    facets.at(whole, &points, Order::Gradients, table);
    let normals: Vec<Vector<3>> = table.jacobian.iter().map(|j| unit_normal(j, 1.0)).collect();
    let turn = |line: &dyn Fn(usize) -> usize| (1..LINES).map(|k| angle(&normals[line(k - 1)], &normals[line(k)])).sum::<f64>();
    let count = |of: &dyn Fn(usize, usize) -> usize| {
        let most = (0..LINES).map(|l| turn(&|k| of(l, k))).fold(0.0, f64::max);
        ((most / TURN - 1e-6).ceil() as usize).clamp(1, 64)
    };
    let (nu, nv) = (count(&|l, k| l * LINES + k), count(&|l, k| k * LINES + l));
    let mut out = Vec::new();
    match polygon {
        Polygon::Square => {
            let (du, dv) = (1.0 / nu as f64, 1.0 / nv as f64);
            for (i, j) in (0..nu * nv).map(|q| ((q % nu) as f64, (q / nu) as f64)) {
                out.push((Vector::<2>::new(i * du, j * dv), Matrix::<2, 2>::new(du, 0.0, 0.0, dv)));
            }
        }
        Polygon::Triangle => {
            let n = nu.max(nv);
            let d = 1.0 / n as f64;
            for (i, j) in (0..n * n).map(|q| (q % n, q / n)).filter(|&(i, j)| i + j < n) {
                let (x, y) = (i as f64 * d, j as f64 * d);
                out.push((Vector::<2>::new(x, y), Matrix::<2, 2>::new(d, 0.0, 0.0, d)));
                if i + j + 1 < n {
                    out.push((Vector::<2>::new(x + d, y + d), Matrix::<2, 2>::new(-d, 0.0, 0.0, -d)));
                }
            }
        }
    }
    out
}
