//! Rules of quadratures.

use crate::basis::{Basis, Cell};
use crate::linalg::{Real, to_f64};
use crate::quadrature::Quadrature;

/// Tolerance of integrals, in units of rounding of the sum of the absolute weights.
const EXACT: f64 = 1e3;

/// Checks `quadrature` on the elements of `basis`: rules integrate polynomials of degree `degree` exactly (per direction
/// on tensor cells, in total on simplices), and [`Quadrature::axes`] are factors of the rules of the basis' blocks.
///
/// # Errors
/// The rule that is broken, and where.
pub fn quadrature<const D: usize, T: Real>(
    quadrature: &dyn Quadrature<D, T>,
    basis: &dyn Basis<D, T>,
    degree: usize,
) -> Result<(), String> {
    for e in 0..basis.num_elements() {
        integrates(quadrature, e, basis.cell(e), degree).map_err(|what| format!("element {e}: {what}"))?;
        factors(quadrature, basis, e).map_err(|what| format!("element {e}: {what}"))?;
    }
    Ok(())
}

fn integrates<const D: usize, T: Real>(quadrature: &dyn Quadrature<D, T>, e: usize, cell: Cell, degree: usize) -> Result<(), String> {
    let rule = quadrature.rule(e);
    if rule.points.len() != rule.weights.len() {
        return Err(format!("the rule has {} points and {} weights", rule.points.len(), rule.weights.len()));
    }
    let bound: f64 = rule.weights.iter().map(|&w| to_f64(w).abs()).sum();
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    for m in 0..(degree + 1).pow(D as u32) {
        let powers: [usize; D] = std::array::from_fn(|k| m / (degree + 1).pow(k as u32) % (degree + 1));
        let total: usize = powers.iter().sum();
        let exact = match cell {
            Cell::Tensor => powers.iter().map(|&a| 1.0 / (a as f64 + 1.0)).product(),
            Cell::Simplex if total <= degree => powers.iter().map(|&a| factorial(a)).product::<f64>() / factorial(D + total),
            Cell::Simplex => continue,
        };
        let sum: f64 = rule
            .points
            .iter()
            .zip(&rule.weights)
            .map(|(x, &w)| powers.iter().enumerate().fold(to_f64(w), |v, (k, &a)| v * to_f64(x[k]).powi(a as i32)))
            .sum();
        let error = (sum - exact).abs();
        if error.is_nan() || error > EXACT * to_f64(T::default_epsilon()) * bound {
            return Err(format!("the rule integrates the monomial {powers:?} to {sum}, not {exact}"));
        }
    }
    Ok(())
}

fn factors<const D: usize, T: Real>(quadrature: &dyn Quadrature<D, T>, basis: &dyn Basis<D, T>, e: usize) -> Result<(), String> {
    let (Some(axes), Some(block)) = (quadrature.axes(e), basis.structure().block(e)) else { return Ok(()) };
    let rule = quadrature.rule(e);
    let mut rest = e - block.first;
    let lines: [_; D] = std::array::from_fn(|k| {
        let n = block.axes[k].num_elements();
        let at = rest % n;
        rest /= n;
        axes[k].rule(at)
    });
    let count: usize = lines.iter().map(|l| l.weights.len()).product();
    if count != rule.weights.len() {
        return Err(format!("the rule has {} points, the product of its axes {count}", rule.weights.len()));
    }
    for (q, (x, &w)) in rule.points.iter().zip(&rule.weights).enumerate() {
        let (mut rest, mut product, mut apart) = (q, 1.0, 0.0f64);
        for (k, line) in lines.iter().enumerate() {
            let i = rest % line.weights.len();
            rest /= line.weights.len();
            product *= to_f64(line.weights[i]);
            apart = apart.max(to_f64((line.points[i][0] - x[k]).abs()));
        }
        let error = apart.max((product - to_f64(w)).abs());
        if error.is_nan() || error > EXACT * to_f64(T::default_epsilon()) {
            return Err(format!("point {q} is not the product of the axes' points, first axis fastest"));
        }
    }
    Ok(())
}
