//! Augmented Lagrangian: a penalty made exact by Uzawa's iteration with projection.
//!
//! ```text
//! lambda <- min(0, lambda + W (C u + g)),   (K + Bᵀ W C on closed rows) u = f - Bᵀ (lambda + W g)
//! ```
//!
//! One update is a system of contact rows with the compliance 1 / W and the offset g + lambda / W; its multiplier is the next one, and the
//! active set decides the projection. This is the proximal point method for the multipliers: it converges for every W > 0, the faster the
//! larger W is. Rows without weight get no compliance: they face nothing.
//!
//! Sources: Rockafellar, Math. Oper. Res. 1 (1976) 97-116; Alart, Curnier, CMAME 92 (1991) 353-375; Simo, Laursen, Comput. Struct. 42
//! (1992) 97-116.

use super::{Begun, ContactMethod, MethodError, positive, softened};
use crate::constraint::{Answered, Next, RowChange, RowIteration};
use crate::contact::ContactRows;

/// Ratio of successive changes of the multipliers above which the iteration does not converge.
const STALLED: f64 = 0.9;
/// Relative rounding error of a gap, against the sum of its terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Rows softened as by a penalty and made exact by an iteration of the multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Augmented {
    /// Penalty stiffness over that of the row's own slave unknowns, a pure number. An update gains about as many digits as the factor
    /// has, less those that the degree costs.
    pub factor: f64,
    /// Error of the multipliers at which the iteration ends, as forces, relative to the largest.
    pub tolerance: f64,
}

impl Augmented {
    /// The factor of `factor = "auto"`.
    pub const FACTOR: f64 = 1e4;
    /// The tolerance of `tolerance = "auto"`.
    pub const TOLERANCE: f64 = 1e-12;
}

impl Default for Augmented {
    fn default() -> Self {
        Self { factor: Self::FACTOR, tolerance: Self::TOLERANCE }
    }
}

impl<const S: usize, const N: usize> ContactMethod<S, N> for Augmented {
    fn check(&self) -> Result<(), MethodError> {
        positive(self.factor)?;
        if self.tolerance > 0.0 && self.tolerance < 1.0 { Ok(()) } else { Err(MethodError::Tolerance(self.tolerance)) }
    }

    fn begin(&self, rows: &ContactRows<S, N>, unit: &dyn Fn(usize) -> f64) -> Begun {
        let iteration = Uzawa::new(softened(rows, unit, self.factor), self.tolerance);
        Begun { iteration: Some(Box::new(iteration)), ..Begun::default() }
    }
}

/// Uzawa's iteration with projection.
#[derive(Debug)]
struct Uzawa {
    /// 1 / W of every row \[gap / lambda\]; zero: the row is unchanged.
    softness: Vec<f64>,
    lambda: Vec<f64>,
    /// Change of the multipliers in the last update, as a force.
    before: f64,
    tolerance: f64,
}

impl Uzawa {
    fn new(softness: Vec<f64>, tolerance: f64) -> Self {
        Self { lambda: vec![0.0; softness.len()], softness, before: f64::INFINITY, tolerance }
    }
}

impl RowIteration for Uzawa {
    fn name(&self) -> &'static str {
        "augmented"
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn tighten(&mut self, tolerance: f64) {
        self.tolerance = self.tolerance.min(tolerance);
    }

    fn row(&self, j: usize) -> RowChange {
        if self.softness[j] > 0.0 {
            RowChange { kind: None, shift: self.softness[j] * self.lambda[j], compliance: Some(self.softness[j]) }
        } else {
            RowChange::default()
        }
    }

    fn next(&mut self, answered: &Answered<'_>) -> Next {
        let (range, u) = (answered.range.clone(), &answered.solution.unknowns);
        let lambda = &answered.solution.multipliers[range.clone()];
        let (weight, stiffness) = (&answered.scales.weight[range.clone()], &answered.scales.stiffness[range.clone()]);
        let own = || (0..self.softness.len()).filter(|&j| self.softness[j] > 0.0);
        // as forces: the multipliers, their change, and the effect of rounding of the gaps
        let (mut largest, mut step, mut noise) = (0.0f64, 0.0f64, 0.0f64);
        let mut rounding = vec![0.0; self.softness.len()];
        for j in own() {
            largest = largest.max(lambda[j].abs() * weight[j]);
            step = step.max((lambda[j] - self.lambda[j]).abs() * weight[j]);
            let (cols, vals) = answered.rows.row(range.start + j);
            let terms: f64 = cols.zip(vals).map(|(i, &c)| (c * u[i]).abs()).sum();
            rounding[j] = ROUNDING * (terms + answered.system.offset[range.start + j].abs());
            noise = noise.max(rounding[j] / self.softness[j] * weight[j]);
        }
        // remaining gaps relative to the bodies: weak springs may leave large gaps at small changes of the multipliers
        let open = own().fold(0.0f64, |open, j| {
            let gap = self.softness[j] * (lambda[j] - self.lambda[j]).abs();
            if gap <= rounding[j] { open } else { open.max(gap * stiffness[j] / weight[j]) }
        });
        let closed = open <= self.tolerance * largest;
        let rate = if self.before.is_finite() && self.before > 0.0 { step / self.before } else { 1.0 };
        let left = if rate < 1.0 { step * rate / (1.0 - rate) } else { f64::INFINITY };
        let settled = left <= self.tolerance * largest && closed;
        if step == 0.0 || settled || (closed && rate > STALLED && step <= noise.max(self.tolerance * largest)) {
            return Next::Done;
        }
        // of all that is left the worst, so that it is never below the tolerance
        let worst = if left.is_finite() { left } else { step }.max(open);
        let (error, tolerance) = (if largest > 0.0 { worst / largest } else { f64::INFINITY }, self.tolerance);
        if !step.is_finite() {
            return Next::Failed { error, tolerance };
        }
        self.lambda.copy_from_slice(lambda);
        self.before = step;
        Next::Again { error, tolerance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::{ActiveSet, ConstrainedSystem, ConstraintSolver, Direct, Outer, RowKind, SolveError, penalty};
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
        let softness = penalty(&stiffness.diagonal(), &rows, 3, 10.0);
        let solver = |max_updates: usize| {
            let iteration: Box<dyn RowIteration> = Box::new(Uzawa::new(softness[..2].to_vec(), Augmented::TOLERANCE));
            Outer { max_updates, ..Outer::new(ActiveSet::new(Direct::new()), vec![(0..2, iteration)]) }
        };
        let found = solver(200).solve(&system).unwrap();
        // u_0 = u_2 = 0: lambda_0 + lambda_2 take both loads
        for (value, expected) in found.unknowns.iter().chain(&found.multipliers).zip([0.0, 1.5, 0.0, -0.5, 0.0, 0.5]) {
            assert!((value - expected).abs() < 1e-11, "{found:?}");
        }
        let report = found.active_set.unwrap();
        assert!(report.updates > 2 && report.history.len() == report.iterations && report.iterations >= report.updates, "{report:?}");
        assert!(found.active[0] && !found.active[1]);
        let Err(SolveError::Multipliers { updates: 2, last, .. }) = solver(2).solve(&system) else { panic!("two updates are too few") };
        assert!((last.unknowns[1] - 1.5).abs() < 1e-12 && last.gap[0] < 0.0);
        // rows that the system does not have
        let beyond: Box<dyn RowIteration> = Box::new(Uzawa::new(vec![1.0; 4], Augmented::TOLERANCE));
        let mut wrong = Outer::new(ActiveSet::new(Direct::new()), vec![(0..4, beyond)]);
        assert!(matches!(wrong.solve(&system), Err(SolveError::Shape { found: 4, expected: 3, .. })));
    }
}
