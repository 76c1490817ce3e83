//! Gauss rules that fit a basis.

use crate::basis::{Basis, Cell};
use crate::linalg::Real;
use crate::quadrature::{PerElement, Quadrature, TensorRule, gauss_legendre, simplex_rule};
use std::sync::Arc;

/// Rules for bulk integrals over the elements of `basis`.
///
/// Tensor cells: degree + 1 + `extra` Gauss points per direction. Simplices: exact for polynomials of total degree
/// max(2p, D (p - 1)) + 2 `extra`, which is what linear fields on isoparametric cells of degree p ask for.
pub fn gauss_rules<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B, extra: usize) -> PerElement<D, T> {
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
pub(crate) fn element_rule<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(
    basis: &B,
    element: usize,
    extra: usize,
) -> Arc<dyn Quadrature<D, T>> {
    rule(basis.cell(element), basis.degree(element), extra)
}

/// The rule of one kind of cell.
fn rule<const D: usize, T: Real>(cell: Cell, degree: [usize; D], extra: usize) -> Arc<dyn Quadrature<D, T>> {
    match cell {
        Cell::Simplex => {
            let p = degree.iter().copied().max().unwrap_or(0);
            Arc::new(simplex_rule::<D, T>((2 * p).max(D * p.saturating_sub(1)) + 2 * extra))
        }
        Cell::Tensor => Arc::new(TensorRule::new(degree.map(|p| gauss_legendre(p + 1 + extra)))),
    }
}
