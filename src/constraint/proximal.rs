//! Contact rows made exact by an augmented Lagrangian: Uzawa's iteration with projection, around any solver of soft contact rows.
//!
//! ```text
//! lambda <- min(0, lambda + W (C u + g)),   (K + Bᵀ W C on closed rows) u = f - Bᵀ (lambda + W g)
//! ```
//!
//! One update is a system of contact rows with the compliance 1 / W and the offset g + lambda / W; its multiplier is the next one, and the
//! inner active set decides the projection. This is the proximal point method for the multipliers: it converges for every W > 0, the
//! faster the larger W is. Rows with zero `softness` stay unchanged: exact contact, ties and penalties may be in the same system.
//!
//! Sources: Rockafellar, Math. Oper. Res. 1 (1976) 97-116; Alart, Curnier, CMAME 92 (1991) 353-375; Simo, Laursen, Comput. Struct. 42
//! (1992) 97-116.

use super::scale::{RowScales, check_shape, combined, gaps, row_scales};
use super::verified::complete;
use super::{Abilities, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};

/// Default limit of the updates of the multipliers.
const MAX_UPDATES: usize = 200;
/// Ratio of successive changes of the multipliers above which the iteration does not converge.
const STALLED: f64 = 0.9;
/// Relative rounding error of a gap, against the sum of its terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Solver of exact contact rows that iterates a solver `inner` of soft ones.
#[derive(Clone, Debug)]
pub struct Proximal<C> {
    /// Solves systems with soft contact rows.
    pub inner: C,
    /// 1 / W of every row \[gap / lambda\]; zero: the row is unchanged. See [`super::penalty()`].
    pub softness: Vec<f64>,
    /// Error of the multipliers wanted, as forces, relative to the largest.
    pub tolerance: f64,
    /// Updates allowed.
    pub max_updates: usize,
}

impl<C> Proximal<C> {
    /// The factor of `factor = "auto"`: penalty stiffness over that of the row's own slave unknowns. An update gains about as many digits
    /// as the factor has, less those that the degree costs.
    pub const FACTOR: f64 = 1e4;
    /// The tolerance of `tolerance = "auto"`.
    pub const TOLERANCE: f64 = 1e-12;

    /// Iterates `inner` on the rows with `softness` until the error of their multipliers is below 1e-12.
    pub fn new(inner: C, softness: Vec<f64>) -> Self {
        Self { inner, softness, tolerance: Self::TOLERANCE, max_updates: MAX_UPDATES }
    }
}

impl<C: ConstraintSolver<f64>> ConstraintSolver<f64> for Proximal<C> {
    fn abilities(&self) -> Abilities {
        self.inner.abilities()
    }

    fn tolerance(&self) -> f64 {
        self.inner.tolerance().max(self.tolerance)
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        check_shape(system)?;
        let (n, m) = (system.stiffness.size(), system.offset.len());
        if self.softness.len() != m {
            return Err(SolveError::Shape { what: "softness of rows", found: self.softness.len(), expected: m });
        }
        let own = |j: usize| self.softness[j] > 0.0;
        let RowScales { stiffness, weight } = row_scales(&system.stiffness.diagonal(), system.constraint, m);
        let rows = combined(system.constraint, m, n);
        let compliance: Vec<f64> =
            (0..m).map(|j| if own(j) { self.softness[j] } else { system.compliance.get(j).copied().unwrap_or(0.0) }).collect();
        let mut lambda = vec![0.0; m];
        let (mut report, mut before) = (ActiveSetReport::default(), f64::INFINITY);
        let mut last: Option<ConstrainedSolution<f64>> = None;
        let mut linear = 0;
        loop {
            let offset: Vec<f64> = (0..m).map(|j| system.offset[j] + if own(j) { self.softness[j] * lambda[j] } else { 0.0 }).collect();
            let shifted = ConstrainedSystem { offset: &offset, compliance: &compliance, ..*system };
            let mut solution = match self.inner.solve(&shifted) {
                Ok(solution) => complete(&shifted, &solution).map(|()| solution)?,
                Err(error) => return Err(with_last(error, system, &report, last)),
            };
            solution.gap = gaps(system, &solution.unknowns);
            linear += solution.iterations;
            solution.iterations = linear;
            solution = solution.done_after(&report);
            report = solution.active_set.clone().unwrap_or_default();
            report.updates += 1;
            solution.active_set = Some(report.clone());
            // as forces: the multipliers, their change, and the effect of rounding of the gaps
            let (mut largest, mut step, mut noise) = (0.0f64, 0.0f64, 0.0f64);
            let mut rounding = vec![0.0; m];
            for j in (0..m).filter(|&j| own(j)) {
                largest = largest.max(solution.multipliers[j].abs() * weight[j]);
                step = step.max((solution.multipliers[j] - lambda[j]).abs() * weight[j]);
                let (cols, vals) = rows.row(j);
                let terms: f64 = cols.zip(vals).map(|(i, &c)| (c * solution.unknowns[i]).abs()).sum();
                rounding[j] = ROUNDING * (terms + system.offset[j].abs());
                noise = noise.max(rounding[j] / self.softness[j] * weight[j]);
            }
            // remaining gaps relative to the bodies: weak springs may leave large gaps at small changes of the multipliers
            let closed = (0..m).filter(|&j| own(j)).all(|j| {
                let gap = self.softness[j] * (solution.multipliers[j] - lambda[j]).abs();
                gap <= rounding[j].max(self.tolerance * largest * weight[j] / stiffness[j])
            });
            let rate = if before.is_finite() && before > 0.0 { step / before } else { 1.0 };
            let left = if rate < 1.0 { step * rate / (1.0 - rate) } else { f64::INFINITY };
            let settled = left <= self.tolerance * largest && closed;
            if step == 0.0 || settled || (closed && rate > STALLED && step <= noise.max(self.tolerance * largest)) {
                solution.method = format!("augmented, {}", solution.method);
                return Ok(solution);
            }
            if report.updates >= self.max_updates || !step.is_finite() {
                let error = if largest > 0.0 { step / largest } else { f64::INFINITY };
                return Err(SolveError::Multipliers {
                    updates: report.updates,
                    error,
                    tolerance: self.tolerance,
                    last: Box::new(solution),
                });
            }
            lambda.clone_from(&solution.multipliers);
            before = step;
            last = Some(solution);
        }
    }
}

/// Converts the `error` of an update to one of the whole iteration, with its last iterate or, if it has none, that of `before`.
fn with_last(
    error: SolveError,
    system: &ConstrainedSystem<'_, f64>,
    report: &ActiveSetReport,
    before: Option<ConstrainedSolution<f64>>,
) -> SolveError {
    let whole = |last: Option<Box<ConstrainedSolution<f64>>>| match last {
        Some(mut last) if last.unknowns.len() == system.load.len() => {
            last.gap = gaps(system, &last.unknowns);
            Some(Box::new(last.done_after(report)))
        }
        _ => before.clone().map(Box::new),
    };
    match error {
        SolveError::RigidMotion { iteration, open, best } => SolveError::RigidMotion { iteration, open, best: whole(best) },
        SolveError::Stopped { iterations, best } => SolveError::Stopped { iterations: report.iterations + iterations, best: whole(best) },
        SolveError::Cycling { first, second, rows, iterations, best } => {
            SolveError::Cycling { first, second, rows, iterations, best: whole(Some(best)).unwrap_or_default() }
        }
        SolveError::TooManyIterations { iterations, best } => {
            SolveError::TooManyIterations { iterations, best: whole(Some(best)).unwrap_or_default() }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::{ActiveSet, Direct, RowKind, penalty};
    use crate::coupling::Rows;
    use crate::linalg::{Csr, Operator, Triplets};

    // two springs of stiffness 2 under loads -1 and 3 over floors at zero: the first is held by lambda = -1, the second lifts by 1.5;
    // a third row of another method beside them holds u_0 - u_2 = 0, u_2 under its load 0.5
    #[test]
    fn rows_end_exact_beside_others_and_too_few_updates_are_an_error() {
        let mut k = Triplets::new(3, 3);
        (0..3).for_each(|i| k.push(i, i, 2.0));
        let stiffness: Csr = k.to_csr();
        let mut rows = Rows { slave: Triplets::new(3, 3), master: Triplets::new(3, 3) };
        rows.slave.push(0, 0, 1.0);
        rows.slave.push(1, 1, 1.0);
        rows.slave.push(2, 2, 1.0);
        rows.master.push(2, 0, -1.0);
        let load = [-1.0, 3.0, 0.5];
        let system = ConstrainedSystem {
            stiffness: &stiffness,
            load: &load,
            constraint: &rows,
            reaction: None,
            offset: &[0.0; 3],
            kind: &[RowKind::Contact, RowKind::Contact, RowKind::Equal],
            compliance: &[],
        };
        let mut softness = penalty(&stiffness.diagonal(), &rows, 3, 10.0);
        softness[2] = 0.0;
        let mut solver = Proximal::new(ActiveSet::new(Direct::new()), softness);
        let found = solver.solve(&system).unwrap();
        // u_0 = u_2 = 0: lambda_0 + lambda_2 take both loads
        for (value, expected) in found.unknowns.iter().chain(&found.multipliers).zip([0.0, 1.5, 0.0, -0.5, 0.0, 0.5]) {
            assert!((value - expected).abs() < 1e-11, "{found:?}");
        }
        let report = found.active_set.unwrap();
        assert!(report.updates > 2 && report.history.len() == report.iterations && report.iterations >= report.updates, "{report:?}");
        assert!(found.active[0] && !found.active[1]);
        solver.max_updates = 2;
        let Err(SolveError::Multipliers { updates: 2, last, .. }) = solver.solve(&system) else { panic!("two updates are too few") };
        assert!((last.unknowns[1] - 1.5).abs() < 1e-12 && last.gap[0] < 0.0);
    }
}
