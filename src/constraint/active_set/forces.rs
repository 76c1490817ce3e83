//! Multipliers and gaps of contact rows as forces, and the tolerance below which they count as zero.
//!
//! ```text
//! p_j = lambda_j s_j,   q_j = k_j (gap_j - compliance_j lambda_j) / s_j      k_j, s_j: row_scales
//! ```
//!
//! In a linear system with equalities q_j of a closed row and p_j of an open one are zero by construction. They are set to zero here, so
//! that rounding does not decide, whatever the factor between p and q.

use super::super::scale::{RowScales, combined, row_scales};
use super::super::{ConstrainedSolution, ConstrainedSystem, RowKind, SignCases};
use crate::linalg::Csr;

/// Relative size below which forces count as zero.
pub(super) const ZERO: f64 = 1e-12;

/// Scales and entries of the contact rows, which convert multipliers and gaps to forces.
#[derive(Debug)]
pub(super) struct Measure<'a> {
    /// The contact rows.
    pub contact: Vec<usize>,
    scales: RowScales<f64>,
    rows: Csr<f64>,
    offset: &'a [f64],
    compliance: &'a [f64],
}

impl<'a> Measure<'a> {
    pub fn of(system: &ConstrainedSystem<'a, f64>) -> Self {
        let (n, m) = (system.stiffness.size(), system.offset.len());
        Self {
            contact: (0..m).filter(|&j| system.kind[j] == RowKind::Contact).collect(),
            scales: row_scales(&system.stiffness.diagonal(), system.constraint, m),
            rows: combined(system.constraint, m, n),
            offset: system.offset,
            compliance: system.compliance,
        }
    }

    /// Maps lists of rows of a system with `m` rows to indices into `contact`; drops other rows, and lists of fewer than two contact rows.
    pub fn among_contact(&self, lists: &[Vec<usize>], m: usize) -> Vec<Vec<usize>> {
        let mut place = vec![None; m];
        self.contact.iter().enumerate().for_each(|(k, &j)| place[j] = Some(k));
        let list = |rows: &Vec<usize>| -> Vec<usize> { rows.iter().filter_map(|&j| place.get(j).copied().flatten()).collect() };
        lists.iter().map(list).filter(|l| l.len() > 1).collect()
    }

    /// Whether contact row `k` has nonzero entries.
    pub fn has_entries(&self, k: usize) -> bool {
        self.scales.weight[self.contact[k]] > 0.0
    }

    fn per_length(&self, j: usize) -> f64 {
        // a row without entries has no scale: its gap is only reported
        if self.scales.weight[j] > 0.0 { self.scales.stiffness[j] / self.scales.weight[j] } else { 1.0 }
    }

    /// The forces of a solution; `by_construction`: it comes from a system of equalities, closed where it is active; `zero`: relative size
    /// below which they count as zero.
    pub fn forces(&self, solution: &ConstrainedSolution<f64>, by_construction: bool, zero: f64) -> Forces {
        let mut forces = Forces { multiplier: Vec::new(), gap: Vec::new(), zero: Vec::new(), closed: Vec::new() };
        let (mut largest, mut own) = (0.0f64, Vec::new());
        for &j in &self.contact {
            let (lambda, per_length) = (solution.multipliers[j], self.per_length(j));
            let closed = solution.active[j];
            let soft = self.compliance.get(j).copied().unwrap_or(0.0);
            forces.multiplier.push(if by_construction && !closed { 0.0 } else { lambda * self.scales.weight[j] });
            forces.gap.push(if by_construction && closed { 0.0 } else { (solution.gap[j] - soft * lambda) * per_length });
            forces.closed.push(closed);
            let (cols, vals) = self.rows.row(j);
            let moved: f64 = cols.zip(vals).map(|(i, &c)| (c * solution.unknowns[i]).abs()).sum();
            // rows alone have no unknowns: their gaps tell how far these move
            let moved = moved.max((solution.gap[j] - self.offset[j]).abs());
            largest = largest.max(lambda.abs() * self.scales.weight[j]).max(moved * per_length);
            // a far row's initial gap must not hide the small gaps of others
            own.push(self.offset[j].abs() * per_length);
        }
        forces.zero = own.iter().map(|&g| zero * largest.max(g)).collect();
        forces
    }
}

/// Multipliers and gaps of the contact rows as forces.
#[derive(Clone, Debug)]
pub(super) struct Forces {
    /// p, positive in tension.
    pub multiplier: Vec<f64>,
    /// q, negative in penetration.
    pub gap: Vec<f64>,
    /// Tolerance below which both count as zero.
    pub zero: Vec<f64>,
    /// Whether the rows are closed.
    pub closed: Vec<bool>,
}

impl Forces {
    /// Rows that leave their state: active next iff p + c q < 0. A row with p = q = 0 keeps its state.
    pub fn violated(&self, c: f64) -> Vec<usize> {
        let changes = |k: &usize| {
            let (p, q, zero) = (self.multiplier[*k], self.gap[*k], self.zero[*k]);
            (p.abs() > zero || q.abs() > zero) && (p + c * q < 0.0) != self.closed[*k]
        };
        (0..self.closed.len()).filter(changes).collect()
    }

    /// Norm of p - min(0, p + q): zero exactly where the contact conditions hold.
    pub fn violation(&self) -> f64 {
        self.multiplier.iter().zip(&self.gap).map(|(p, q)| (p - (p + q).min(0.0)).powi(2)).sum::<f64>().sqrt()
    }

    /// The sign case of every contact row, 3 * row + column. Rows: lambda < 0, = 0, > 0; columns: gap = 0, > 0, < 0.
    pub fn sign_case(&self, k: usize) -> usize {
        let (p, q, zero) = (self.multiplier[k], self.gap[k], self.zero[k]);
        let of = |x: f64, below: usize, at: usize, above: usize| match x {
            x if x.abs() <= zero => at,
            x if x < 0.0 => below,
            _ => above,
        };
        3 * of(p, 0, 1, 2) + of(q, 2, 0, 1)
    }

    /// Number of rows in each sign case.
    pub fn sign_cases(&self) -> SignCases {
        let mut cases = [0; 9];
        (0..self.zero.len()).for_each(|k| cases[self.sign_case(k)] += 1);
        cases
    }
}

/// Returns the sign case of every row of kind `Contact`, 0 to 8 = 3 * row + column; `None` for other rows.
///
/// Rows: lambda < 0, = 0, > 0; columns: gap = 0, > 0, < 0 (of soft rows: gap minus compliance times lambda); zero within 1e-12 of the
/// largest of both as forces. In the solution of an active set, active rows have gap 0 and the others lambda 0 by construction.
pub fn sign_case_of_rows(system: &ConstrainedSystem<'_, f64>, solution: &ConstrainedSolution<f64>) -> Vec<Option<u8>> {
    let measure = Measure::of(system);
    let mut cases = vec![None; system.offset.len()];
    let complete = [solution.gap.len(), solution.multipliers.len(), solution.active.len()].iter().all(|&l| l == cases.len());
    if complete && solution.unknowns.len() == system.stiffness.size() {
        let forces = measure.forces(solution, solution.active_set.is_some(), ZERO);
        measure.contact.iter().enumerate().for_each(|(k, &j)| cases[j] = Some(forces.sign_case(k) as u8));
    }
    cases
}

/// Returns the first contact row whose multiplier and gap break the conditions of contact by more than `allowed`, relative to the largest
/// force.
pub fn violated(system: &ConstrainedSystem<'_, f64>, solution: &ConstrainedSolution<f64>, allowed: f64) -> Option<usize> {
    if !system.kind.contains(&RowKind::Contact) {
        return None;
    }
    let measure = Measure::of(system);
    let forces = measure.forces(solution, false, ZERO);
    let breaks = |k: usize| {
        let (p, q) = (forces.multiplier[k], forces.gap[k]);
        (p - (p + q).min(0.0)).abs() > allowed / ZERO * forces.zero[k]
    };
    (0..measure.contact.len()).find(|&k| measure.has_entries(k) && breaks(k)).map(|k| measure.contact[k])
}
