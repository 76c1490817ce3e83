//! Primal-dual active set iteration around any solver of equalities.
//!
//!   row j is active next iff lambda_j s_j + c k_j gap_j / s_j < 0      (both terms are forces)
//!
//! k_j, s_j: stiffness and weight of the row ([`super::scale::row_scales`]). Where both terms are within 1e-12 of their scale the row
//! keeps its state: all nine combinations of signs are decided, none by rounding.
//!
//! Source: Hintermueller, Ito, Kunisch, SIAM J. Optim. 13 (2002) 865-888; the nine cases: Brivadis, defence slides, Pavia 2017.

use super::scale::{check_shape, combined, row_scales};
use super::{ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SignCases, SolveError};
use crate::linalg::LinearError;
use std::collections::HashMap;

/// Forces below this part of their scale count as zero.
const ZERO: f64 = 1e-12;

/// Active set iteration around `inner`; rows of kind `Equal` and `Open` stay what they are.
#[derive(Clone, Debug)]
pub struct ActiveSet<C> {
    /// Solves the systems with equalities.
    pub inner: C,
    /// Linear systems allowed.
    pub max_iterations: usize,
    /// Weight of the gap's force against the multiplier's, a pure number.
    pub c: f64,
    /// First state, one per row (only contact rows are read); empty: all contact rows active.
    pub start: Vec<bool>,
}

impl<C> ActiveSet<C> {
    /// At most 30 iterations, c = 1, all contact rows active at first.
    pub fn new(inner: C) -> Self {
        Self { inner, max_iterations: 30, c: 1.0, start: Vec::new() }
    }

    /// The same with another first state, one per row.
    pub fn starting_from(mut self, start: Vec<bool>) -> Self {
        self.start = start;
        self
    }
}

/// A linear system that an active set is about to solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct IterationNews {
    /// Its number, from 1.
    pub iteration: usize,
    /// Active contact rows in it.
    pub active: usize,
    /// All contact rows.
    pub rows: usize,
}

impl<C: ConstraintSolver<f64>> ConstraintSolver<f64> for ActiveSet<C> {
    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        self.solve_watched(system, &mut |_| true)
    }
}

impl<C: ConstraintSolver<f64>> ActiveSet<C> {
    /// Solves `system` and asks `goes_on` before every linear system; one that has begun is not interrupted.
    ///
    /// # Errors
    /// [`SolveError::Stopped`] where `goes_on` says no, and all others of [`ConstraintSolver::solve`].
    pub fn solve_watched(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(IterationNews) -> bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        check_shape(system)?;
        let (n, m) = (system.stiffness.size(), system.offset.len());
        if !self.start.is_empty() && self.start.len() != m {
            return Err(SolveError::Shape { what: "start states", found: self.start.len(), expected: m });
        }
        let contact: Vec<usize> = (0..m).filter(|&j| system.kind[j] == RowKind::Contact).collect();
        let scales = row_scales(&system.stiffness.diagonal(), system.constraint, m);
        let rows = combined(system.constraint, m, n);
        let mut state: Vec<bool> = contact.iter().map(|&j| scales.weight[j] > 0.0 && self.start.get(j).is_none_or(|&s| s)).collect();
        let mut visited: HashMap<Vec<bool>, usize> = HashMap::new();
        let mut states: Vec<Vec<bool>> = Vec::new();
        let mut report = ActiveSetReport::default();
        let mut last: Option<ConstrainedSolution<f64>> = None;
        let mut linear = 0;
        loop {
            let iteration = report.iterations + 1;
            if iteration > self.max_iterations {
                let last = last.map(|l| finished(l, &report)).unwrap_or_default();
                return Err(SolveError::TooManyIterations { iterations: self.max_iterations, last: Box::new(last) });
            }
            if !goes_on(IterationNews { iteration, active: state.iter().filter(|&&a| a).count(), rows: contact.len() }) {
                return Err(SolveError::Stopped { iterations: report.iterations, last: last.map(|l| Box::new(finished(l, &report))) });
            }
            let mut kind = system.kind.to_vec();
            for (k, &j) in contact.iter().enumerate() {
                kind[j] = if state[k] { RowKind::Equal } else { RowKind::Open };
            }
            let solution = match self.inner.solve(&ConstrainedSystem { kind: &kind, ..*system }) {
                Ok(mut solution) => {
                    linear += solution.iterations;
                    solution.iterations = linear;
                    solution
                }
                Err(SolveError::Linear(LinearError::Stopped { .. })) => {
                    let last = last.map(|l| Box::new(finished(l, &report)));
                    return Err(SolveError::Stopped { iterations: report.iterations, last });
                }
                Err(SolveError::Linear(LinearError::Singular { .. })) if state.contains(&false) => {
                    return Err(SolveError::RigidMotion {
                        iteration,
                        open: contact.iter().enumerate().filter(|&(k, _)| !state[k]).map(|(_, &j)| j).collect(),
                        last: last.map(|l| Box::new(finished(l, &report))),
                    });
                }
                Err(error) => return Err(error),
            };
            let forces = Forces::of(&contact, &scales, &rows, system.offset, &solution);
            let next = forces.next(&state, self.c);
            report.iterations = iteration;
            report.history.push(state.iter().filter(|&&a| a).count());
            report.sign_cases.push(forces.sign_cases());
            if next == state {
                return Ok(finished(solution, &report));
            }
            visited.insert(state.clone(), iteration);
            states.push(state);
            if let Some(&first) = visited.get(&next) {
                let cycle = &states[first - 1..];
                let flips = |k: usize| cycle.iter().any(|s| s[k] != next[k]);
                return Err(SolveError::Cycling {
                    first,
                    second: iteration + 1,
                    rows: (0..contact.len()).filter(|&k| flips(k)).map(|k| contact[k]).collect(),
                    last: Box::new(finished(solution, &report)),
                });
            }
            last = Some(solution);
            state = next;
        }
    }
}

fn finished(mut solution: ConstrainedSolution<f64>, report: &ActiveSetReport) -> ConstrainedSolution<f64> {
    solution.active_set = Some(report.clone());
    solution
}

/// Multipliers and gaps of the contact rows as forces, and what counts as zero.
struct Forces {
    multiplier: Vec<f64>,
    gap: Vec<f64>,
    zero: Vec<f64>,
}

impl Forces {
    fn of(
        contact: &[usize],
        scales: &super::scale::RowScales<f64>,
        rows: &crate::linalg::Csr<f64>,
        offset: &[f64],
        solution: &ConstrainedSolution<f64>,
    ) -> Self {
        let mut forces = Self { multiplier: Vec::new(), gap: Vec::new(), zero: Vec::new() };
        let (mut largest, mut own) = (0.0f64, Vec::new());
        for &j in contact {
            let (s, k) = (scales.weight[j], scales.stiffness[j]);
            let per_length = if s > 0.0 { k / s } else { 0.0 };
            forces.multiplier.push(solution.multipliers[j] * s);
            // a row without entries feels nothing: its gap is only reported
            forces.gap.push(if s > 0.0 { solution.gap[j] * per_length } else { solution.gap[j] });
            let (cols, vals) = rows.row(j);
            let moved: f64 = cols.iter().zip(vals).map(|(&i, &c)| (c * solution.unknowns[i as usize]).abs()).sum();
            largest = largest.max(solution.multipliers[j].abs() * s).max(moved * per_length);
            // a far row's initial gap must not hide the small gaps of others
            own.push(offset[j].abs() * per_length);
        }
        forces.zero = own.iter().map(|&g| ZERO * largest.max(g)).collect();
        forces
    }

    fn next(&self, state: &[bool], c: f64) -> Vec<bool> {
        (0..state.len())
            .map(|k| {
                if self.multiplier[k].abs() <= self.zero[k] && self.gap[k].abs() <= self.zero[k] {
                    state[k]
                } else {
                    self.multiplier[k] + c * self.gap[k] < 0.0
                }
            })
            .collect()
    }

    /// Rows: lambda < 0, = 0, > 0; columns: gap = 0, > 0, < 0.
    fn sign_cases(&self) -> SignCases {
        let mut cases = [0; 9];
        for k in 0..self.zero.len() {
            let (lambda, gap, zero) = (self.multiplier[k], self.gap[k], self.zero[k]);
            let row = if lambda.abs() <= zero {
                1
            } else if lambda < 0.0 {
                0
            } else {
                2
            };
            let column = if gap.abs() <= zero {
                0
            } else if gap > 0.0 {
                1
            } else {
                2
            };
            cases[3 * row + column] += 1;
        }
        cases
    }
}
