//! Gram matrices of a side's trace and multiplier spaces, and the matrix between them.

use super::{InfSupError, Measure, Norm};
use crate::assembly::gauss_rules;
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Csr, Triplets, measure};
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Gauss points beyond degree + 1, since speeds of curves and rational functions are not polynomials.
const EXTRA_POINTS: usize = 4;

/// The matrices of the inf-sup test.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grams {
    /// G_W: (N_k, N_l) in the norm of W.
    pub trace: Csr,
    /// G_M: (ψ_i, ψ_j) in the norm of M.
    pub multiplier: Csr,
    /// B_jk = ∫ ψ_j N_k ds: rows are multipliers.
    pub mixed: Csr,
    /// Largest size of an element: its measure to the power 1/S \[length\].
    pub h: f64,
}

/// Integrates the matrices; arguments as in [`inf_sup`](super::inf_sup()).
///
/// # Errors
/// [`InfSupError::Elements`] where the multiplier has other elements than the side.
///
/// # Panics
/// If `functions` or the sizes of [`Measure::Parametric`] do not have one entry per function, per element.
pub fn grams<const S: usize, const N: usize>(
    space: &dyn Space<S, N>,
    functions: &[Option<usize>],
    multiplier: &dyn Basis<S>,
    by: Measure<'_>,
    norm: Norm,
) -> Result<Grams, InfSupError> {
    let (expected, found) = (space.num_elements(), multiplier.num_elements());
    if expected != found {
        return Err(InfSupError::Elements { expected, found });
    }
    assert_eq!(functions.len(), space.num_functions(), "one entry per function of the side");
    if let Measure::Parametric(sizes) = by {
        assert_eq!(sizes.len(), expected, "one size per element");
    }
    let (n, m) = (functions.iter().flatten().max().map_or(0, |k| k + 1), multiplier.num_functions());
    let most = |basis: &dyn Fn(usize) -> [usize; S]| (0..expected).flat_map(basis).max().unwrap_or(0);
    let higher = most(&|e| multiplier.degree(e)).saturating_sub(most(&|e| space.degree(e)));
    let rules = gauss_rules(space, EXTRA_POINTS + higher);
    let (mut trace, mut of_multiplier, mut mixed) = (Triplets::new(n, n), Triplets::new(m, m), Triplets::new(m, n));
    let (mut map, mut shapes, mut psi) = (MapTable::new(), ShapeTable::new(), ShapeTable::new());
    let (mut ids, mut psi_ids, mut h) = (Vec::new(), Vec::new(), 0.0f64);
    for e in 0..expected {
        let rule = rules.rule(e);
        let ds: Vec<f64> = match by {
            Measure::Physical => {
                space.map(e, &rule.points, Order::Gradients, &mut map);
                rule.weights.iter().zip(&map.jacobian).map(|(w, j)| w * measure(j)).collect()
            }
            Measure::Parametric(sizes) => {
                let cell: f64 = rule.weights.iter().sum();
                rule.weights.iter().map(|w| w * sizes[e] / cell).collect()
            }
        };
        let size = ds.iter().sum::<f64>().powf(1.0 / S as f64);
        h = h.max(size);
        let (of_trace, of_psi) = match norm {
            Norm::L2 => (1.0, 1.0),
            Norm::HHalf => (1.0 / size, size),
        };
        space.active(e, &mut ids);
        space.tabulate(e, &rule.points, Order::Values, &mut shapes);
        multiplier.active(e, &mut psi_ids);
        multiplier.tabulate(e, &rule.points, Order::Values, &mut psi);
        let own: Vec<(usize, usize)> = ids.iter().enumerate().filter_map(|(a, &i)| Some((a, functions[i]?))).collect();
        let sum = |f: &dyn Fn(usize) -> f64| ds.iter().enumerate().map(|(q, ds)| ds * f(q)).sum::<f64>();
        for &(a, i) in &own {
            for &(b, j) in &own {
                trace.push(i, j, of_trace * sum(&|q| shapes.values(q)[a] * shapes.values(q)[b]));
            }
            for (b, &j) in psi_ids.iter().enumerate() {
                mixed.push(j, i, sum(&|q| shapes.values(q)[a] * psi.values(q)[b]));
            }
        }
        for (a, &i) in psi_ids.iter().enumerate() {
            for (b, &j) in psi_ids.iter().enumerate() {
                of_multiplier.push(i, j, of_psi * sum(&|q| psi.values(q)[a] * psi.values(q)[b]));
            }
        }
    }
    Ok(Grams { trace: trace.to_csr(), multiplier: of_multiplier.to_csr(), mixed: mixed.to_csr(), h })
}
