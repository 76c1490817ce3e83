//! Gauss rules that fit a basis.

use crate::basis::{Basis, Cell, Order};
use crate::geometry::{Geometry, MapTable, circumference};
use crate::linalg::{Real, Vector, num, to_f64};
use crate::quadrature::{PerElement, Quadrature, Rule, TensorRule, gauss_legendre, simplex_rule};
use crate::space::Space;
use std::sync::Arc;

/// Differences of places below this share of the largest coordinate are round-off.
const ROUND_OFF: f64 = 1e-13;

/// Rules for bulk integrals over the elements of `basis`.
///
/// Tensor cells: degree + 1 + `extra` Gauss points per direction. Simplices: exact for polynomials of total degree
/// max(2p, D (p - 1)) + 2 `extra`, which linear fields on isoparametric cells of degree p need.
pub fn gauss_rules<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B, extra: usize) -> PerElement<D, T> {
    gauss_rules_along(basis, [extra; D])
}

/// [`gauss_rules`] with `extra` points per direction; simplices take the most of them.
pub fn gauss_rules_along<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B, extra: [usize; D]) -> PerElement<D, T> {
    let mut kinds: Vec<(Cell, [usize; D])> = Vec::new();
    let mut rules: Vec<Arc<dyn Quadrature<D, T>>> = Vec::new();
    let mut which = Vec::with_capacity(basis.num_elements());
    for e in 0..basis.num_elements() {
        let kind = (basis.cell(e), basis.degree(e));
        let k = kinds.iter().position(|k| *k == kind).unwrap_or_else(|| {
            kinds.push(kind);
            rules.push(rule(kind.0, kind.1, extra));
            kinds.len() - 1
        });
        which.push(k);
    }
    PerElement::new(rules, which)
}

/// The rule of [`gauss_rules`] of one element, its only one.
pub fn element_rule<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(
    basis: &B,
    element: usize,
    extra: usize,
) -> Arc<dyn Quadrature<D, T>> {
    rule(basis.cell(element), basis.degree(element), [extra; D])
}

/// Rules of integrals over bodies and surfaces of revolution: `rules` with weights times 2 pi r at their points, r the first coordinate.
///
/// Every element has a rule of its own, so that forms are assembled element by element.
pub fn revolved<const D: usize, const N: usize, T: Real, G, Q>(geometry: &G, rules: &Q) -> PerElement<D, T>
where
    G: Geometry<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    let mut table = MapTable::new();
    let of_element = |e: usize| -> Arc<dyn Quadrature<D, T>> {
        let Rule { points, weights } = rules.rule(e);
        geometry.map(e, points, Order::Values, &mut table);
        let weights = weights.iter().zip(&table.x).map(|(&w, x)| w * circumference(x)).collect();
        Arc::new(Rule { points: points.clone(), weights })
    };
    PerElement::new((0..geometry.num_elements()).map(of_element).collect(), (0..geometry.num_elements()).collect())
}

/// Gauss points per direction beyond degree + 1 that linear fields need on the curved tensor cells of `space`.
///
/// A linear field has a constant stress, so that its forces are integrals of ∇N_i = cof(J) ∇̂N_i, J = dx/dξ. With a map of degree
/// q_k and functions of degree p_k along direction k, a cofactor multiplies N - 1 derivatives of the map, of which all but the one
/// along k itself keep the degree q_k: in space the integrand has the degree 2 q_k + p_k - 1 along k and n = ⌈q_k + p_k / 2⌉ points
/// are exact. That is beyond p_k + 1 where q_k > p_k / 2 + 1. In the plane it is q_k + p_k - 1, for which p_k + 1 points suffice up
/// to q_k = p_k + 2: zero there, and for simplices, whose rules account for it. q_k is the actual degree of the map, not that of its
/// basis: straight cells have 1. Rational maps, which no rule integrates exactly, are counted by their numerators.
pub fn points_of_curved_cells<const N: usize, T: Real, X: Space<N, N, T> + ?Sized>(space: &X) -> [usize; N] {
    let mut more = [0; N];
    if N < 3 {
        return more;
    }
    let mut table = MapTable::new();
    for e in (0..space.num_elements()).filter(|&e| space.cell(e) == Cell::Tensor) {
        let (p, written) = (space.degree(e), written_degree(space, e));
        let beyond = |q: [usize; N], k: usize| (2 * q[k] + p[k]).div_ceil(2).saturating_sub(p[k] + 1);
        if (0..N).all(|k| beyond(written, k) <= more[k]) || space.map_structure().is_affine(e) {
            continue;
        }
        let q = true_degree(space, e, written, &mut table);
        more = std::array::from_fn(|k| more[k].max(beyond(q, k)));
    }
    more
}

/// The degree per direction in which the map of an element is written; that of the functions where it does not tell.
fn written_degree<const N: usize, T: Real, X: Space<N, N, T> + ?Sized>(space: &X, element: usize) -> [usize; N] {
    if let Some(map) = space.map_structure().map_block(element) {
        // the elements of an axis need not have one degree
        return map.basis.axes.map(|axis| (0..axis.num_elements()).map(|e| axis.degree(e)[0]).max().unwrap_or(1));
    }
    space.map_structure().control().map_or_else(|| space.degree(element), |c| c.basis.degree(element))
}

/// The highest order per direction of a difference of places on a regular grid that is not round-off, at most `written`.
fn true_degree<const N: usize, T: Real, X: Geometry<N, N, T> + ?Sized>(
    geometry: &X,
    element: usize,
    written: [usize; N],
    table: &mut MapTable<N, N, T>,
) -> [usize; N] {
    let counts = written.map(|q| q + 1);
    let strides: [usize; N] = std::array::from_fn(|k| counts[..k].iter().product());
    let point = |i: usize| Vector::<N, T>::from_fn(|k, _| num::<T>(i / strides[k] % counts[k]) / num::<T>(written[k].max(1)));
    let grid: Vec<Vector<N, T>> = (0..counts.iter().product()).map(point).collect();
    geometry.map(element, &grid, Order::Values, table);
    let largest = table.x.iter().flat_map(|x| x.iter()).fold(0.0, |m: f64, &v| m.max(to_f64(v).abs()));
    std::array::from_fn(|k| {
        let mut found = 0;
        for start in (0..grid.len()).filter(|i| (i / strides[k]).is_multiple_of(counts[k])) {
            let mut line: Vec<[f64; N]> =
                (0..counts[k]).map(|j| std::array::from_fn(|c| to_f64(table.x[start + j * strides[k]][c]))).collect();
            for order in 1..counts[k] {
                line = line.windows(2).map(|w| std::array::from_fn(|c| w[1][c] - w[0][c])).collect();
                // every difference may double what was there
                let noise = ROUND_OFF * largest * f64::from(1u32 << order.min(31));
                if line.iter().flatten().any(|d| d.abs() > noise) {
                    found = found.max(order);
                }
            }
        }
        found
    })
}

/// The rule of one kind of cell.
pub(super) fn rule<const D: usize, T: Real>(cell: Cell, degree: [usize; D], extra: [usize; D]) -> Arc<dyn Quadrature<D, T>> {
    match cell {
        Cell::Simplex => {
            let p = degree.iter().copied().max().unwrap_or(0);
            Arc::new(simplex_rule::<D, T>((2 * p).max(D * p.saturating_sub(1)) + 2 * extra.into_iter().max().unwrap_or(0)))
        }
        Cell::Tensor => Arc::new(TensorRule::new(std::array::from_fn(|k| gauss_legendre(degree[k] + 1 + extra[k])))),
    }
}
