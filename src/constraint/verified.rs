//! Checks of a constraint solver's answer: lengths, residual and the conditions of contact, computed by the library.
//!
//! ```text
//! r1 = f - K u - Bᵀ lambda,   r2 = -g - C u + s lambda on enforced rows,   p - min(0, p + q) on contact rows
//! ```
//!
//! each relative to its terms; p and q are multipliers and gaps as forces, as in [`super::active_set`].

use super::active_set::violated;
use super::scale::{combined, gaps};
use super::{ConstrainedSolution, ConstrainedSystem, RowKind, SolveError};
use crate::linalg::LinearError;
use crate::linalg::residual::{RESIDUAL_LIMIT, max, relative};

/// Gaps below this part of the largest unknown are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Residuals of different measures differ by less than this factor.
const MEASURES: f64 = 10.0;
/// Tension and penetration of contact rows, relative to the largest force.
const SIGNS: f64 = 1e-6;

/// Checks that the lists of an answer have an entry per unknown and per row.
pub(crate) fn complete(system: &ConstrainedSystem<'_, f64>, solution: &ConstrainedSolution<f64>) -> Result<(), SolveError> {
    let (n, m) = (system.stiffness.size(), system.offset.len());
    for (what, found, expected) in [
        ("unknowns of the answer", solution.unknowns.len(), n),
        ("multipliers of the answer", solution.multipliers.len(), m),
        ("gaps of the answer", solution.gap.len(), m),
        ("states of the answer's rows", solution.active.len(), m),
    ] {
        if found != expected {
            return Err(SolveError::Shape { what, found, expected });
        }
    }
    Ok(())
}

/// Checks the answer of a solver to `system` by its true residual and the conditions of contact. Its gaps are computed again, and so is
/// its residual, where the one reported is far too small. `tolerance`: largest relative residual, and error of the contact conditions.
///
/// # Errors
/// [`SolveError::Shape`], [`LinearError::NotFinite`], [`SolveError::Residual`], [`SolveError::Conditions`].
pub fn verified(
    system: &ConstrainedSystem<'_, f64>,
    mut solution: ConstrainedSolution<f64>,
    tolerance: f64,
) -> Result<ConstrainedSolution<f64>, SolveError> {
    complete(system, &solution)?;
    if !solution.unknowns.iter().chain(&solution.multipliers).all(|v| v.is_finite()) {
        return Err(LinearError::NotFinite.into());
    }
    let tolerance = tolerance.max(RESIDUAL_LIMIT);
    let residual = residual(system, &solution);
    if residual.is_nan() || residual > MEASURES * tolerance {
        return Err(SolveError::Residual { residual, tolerance });
    }
    if residual > MEASURES * solution.residual.max(RESIDUAL_LIMIT) || solution.residual.is_nan() {
        solution.residual = residual;
    }
    solution.gap = gaps(system, &solution.unknowns);
    match violated(system, &solution, SIGNS.max(MEASURES * tolerance)) {
        Some(row) => Err(SolveError::Conditions { row, multiplier: solution.multipliers[row], gap: solution.gap[row] }),
        None => Ok(solution),
    }
}

/// Residual of an answer relative to its terms: rows of r1 are measured by the diagonal of K, those of r2 by their largest entries.
fn residual(system: &ConstrainedSystem<'_, f64>, solution: &ConstrainedSolution<f64>) -> f64 {
    let (n, m) = (system.stiffness.size(), system.offset.len());
    let (u, lambda) = (&solution.unknowns, &solution.multipliers);
    let (mut pulled, mut size) = (system.load.to_vec(), system.load.iter().map(|f| f.abs()).collect::<Vec<f64>>());
    let reaction = system.reaction.unwrap_or(system.constraint);
    for &(i, j, v) in reaction.slave.entries.iter().chain(&reaction.master.entries) {
        pulled[j] -= v * lambda[i];
        size[j] += (v * lambda[i]).abs();
    }
    let mut product = vec![0.0; n];
    system.stiffness.apply(u, &mut product);
    let diagonal = system.stiffness.diagonal();
    let (mut top, mut bottom) = (0.0, 0.0);
    for i in 0..n {
        let terms: f64 = match system.stiffness.csr() {
            Some(matrix) => {
                let (cols, vals) = matrix.row(i);
                cols.zip(vals).map(|(j, v)| (v * u[j]).abs()).sum()
            }
            None => product[i].abs() + (diagonal[i] * u[i]).abs(),
        };
        let scale = if diagonal[i] != 0.0 { 1.0 / diagonal[i].abs() } else { 1.0 };
        top = max(top, (pulled[i] - product[i]).abs() * scale);
        bottom = max(bottom, (size[i] + terms) * scale);
    }
    let unknown = u.iter().fold(bottom, |largest, v| max(largest, v.abs()));
    let equilibrium = relative(top, bottom);
    (top, bottom) = (0.0, 0.0);
    let rows = combined(system.constraint, m, n);
    for i in 0..m {
        let (cols, vals) = rows.row(i);
        let largest = vals.iter().fold(0.0, |largest, v| max(largest, v.abs()));
        let soft = system.compliance.get(i).copied().unwrap_or(0.0);
        // 0 u = 0 is no row
        let enforced = solution.active[i] || system.kind[i] == RowKind::Equal && (largest > 0.0 || soft > 0.0);
        if !enforced || largest == 0.0 && soft == 0.0 && system.offset[i] == 0.0 {
            continue;
        }
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        let (mut sum, mut terms) = (system.offset[i] - soft * lambda[i], system.offset[i].abs() + (soft * lambda[i]).abs());
        for (j, v) in cols.zip(vals) {
            sum += v * u[j];
            terms += (v * u[j]).abs();
        }
        top = max(top, sum.abs() * scale);
        bottom = max(bottom, terms * scale);
    }
    // rows that fix their unknowns at zero have terms of rounding size only: their gaps are measured by the largest unknown
    max(equilibrium, if top <= ROUNDING * unknown { 0.0 } else { relative(top, max(bottom, unknown)) })
}
