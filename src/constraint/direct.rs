//! The saddle-point system by one quasi-definite LDLᵀ and refinement on the true system.
//!
//!   [ K + Cᵀ W C   Cᵀ F       ]     W = min(1 / k, 1 / 2s),  F = 1 - W s   (exact rows: s = 0, F = 1)
//!   [ F C          -F s - e k ]     e = 1e-8; rows scaled as in [`super::scale`], s their compliance
//!
//! Strongly quasi-definite, so every symmetric permutation has an LDLᵀ without pivoting. Open rows keep their entries
//! as zeros: pattern and analysis stay while contact opens and closes. The factor only corrects:
//! the residual is that of the unmodified system, so the answer carries no trace of e.
//!
//! Source: Vanderbei, SIAM J. Optim. 5 (1995) 100-113 (quasi-definite matrices).

use super::scale::{Scaled, check_shape, gaps};
use super::{ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use crate::linalg::residual::{KERNEL, RESIDUAL_LIMIT, Soft, max, ratio, softest};
use crate::linalg::{Columns, Csr, Ldlt, LinearError, LinearSolver, Lu, Sparsity, Upper};
use std::sync::Arc;

/// e of the file's head: the floor of the residual is reached in two or three refinements; 1e-6 and 1e-10 need more.
const REGULARISATION: f64 = 1e-8;
/// Refinements allowed.
const MAX_REFINEMENTS: usize = 20;
/// Systems up to this size fall back to LU where refinement does not reach the residual wanted.
const LU_LIMIT: usize = 20_000;

/// Saddle-point solver: LDLᵀ for symmetric systems, sparse LU where the reaction differs from the constraint or the stiffness is
/// not symmetric. A symmetric stiffness with negative energy is refused: couplings may add some where their factor is too small.
///
/// Redundant rows that agree share their multiplier; rows that contradict each other are an error.
#[derive(Debug, Default)]
pub struct Direct {
    ldlt: Ldlt,
    lu: Lu,
    layout: Option<Layout>,
}

/// The pattern of the factorised matrix and what it was made of.
#[derive(Debug)]
struct Layout {
    stiffness: Arc<Sparsity>,
    rows: Arc<Sparsity>,
    pattern: Arc<(Vec<usize>, Vec<usize>)>,
}

/// What the factor was made with.
#[derive(Debug)]
pub(crate) struct Factor {
    /// W, zero on open rows.
    w: Vec<f64>,
    /// F.
    f: Vec<f64>,
    /// 1 / diagonal of K + Cᵀ W C.
    pub scale: Vec<f64>,
    /// Condition, see [`ConstrainedSolution::condition`].
    pub condition: f64,
}

impl Direct {
    /// A solver that has seen no system yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// How often a new pattern was analysed.
    pub fn analyses(&self) -> usize {
        self.ldlt.analyses()
    }

    /// Numbers stored for the last factor: 8 bytes each.
    pub fn factor_entries(&self) -> usize {
        self.ldlt.factor_entries()
    }

    /// Bytes that the factorisation of `system` needs beyond the system itself, found by the analysis alone; contact rows count as closed.
    ///
    /// The analysis is kept for [`ConstraintSolver::solve`]. Not for systems whose reaction differs from the constraint.
    ///
    /// # Errors
    /// [`SolveError`] where the system itself is at fault.
    pub fn predicted_memory(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<usize, SolveError> {
        check_shape(system)?;
        let kind: Vec<RowKind> = system.kind.iter().map(|&k| if k == RowKind::Contact { RowKind::Equal } else { k }).collect();
        let s = Scaled::of(&ConstrainedSystem { kind: &kind, ..*system })?;
        let upper = self.assemble(&s, &s.rows.transposed(), &vec![0.0; s.num_rows()], &vec![1.0; s.num_rows()]);
        Ok(self.ldlt.predict(&upper, &s.all_places(system.stiffness.places()))?)
    }

    /// Factorises the matrix at the file's head; refuses motions without resistance.
    pub(crate) fn factorise(&mut self, s: &Scaled<'_>, places: &[[f64; 3]]) -> Result<Factor, LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let w: Vec<f64> = (0..m).map(|a| if s.enforced[a] { (1.0 / s.k[a]).min(0.5 / s.compliance[a]) } else { 0.0 }).collect();
        let f: Vec<f64> = (0..m).map(|a| 1.0 - w[a] * s.compliance[a]).collect();
        let columns = s.rows.transposed();
        let upper = self.assemble(s, &columns, &w, &f);
        self.ldlt.factorise_upper(&upper, &s.all_places(places))?;
        let diagonal: Vec<f64> = (0..n).map(|i| upper.vals[upper.pattern.0[i]].abs()).collect();
        let scale: Vec<f64> = diagonal.iter().map(|&d| if d > 0.0 { 1.0 / d } else { 1.0 }).collect();
        let condition = self.refuse_kernel(s, &w, &diagonal, &scale)?;
        // every row has one negative pivot, the stiffness none
        self.ldlt.refuse_negative(&upper, n, &s.all_places(places))?;
        Ok(Factor { w, f, scale, condition })
    }

    /// (du, dl) with K du + Cᵀ dl = r1, C du - s dl = r2, up to the regularisation.
    pub(crate) fn correct(&self, s: &Scaled<'_>, factor: &Factor, r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let Factor { w, f, .. } = factor;
        let mut x = r1.to_vec();
        x.extend((0..m).map(|a| f[a] * r2[a]));
        for a in 0..m {
            let (cols, vals) = s.rows.row(a);
            for (j, &v) in cols.zip(vals) {
                x[j] += v * w[a] * r2[a];
            }
        }
        self.ldlt.apply_inverse(&mut x)?;
        let dl = (0..m).map(|a| if s.enforced[a] { x[n + a] } else { 0.0 }).collect();
        x.truncate(n);
        Ok((x, dl))
    }

    /// The solution, and the condition.
    fn quasi_definite(&mut self, s: &Scaled<'_>, places: &[[f64; 3]]) -> Result<((Vec<f64>, Vec<f64>, f64), f64), LinearError> {
        let factor = self.factorise(s, places)?;
        let answer = s.refined(&factor.scale, MAX_REFINEMENTS, |r1, r2| self.correct(s, &factor, r1, r2))?;
        Ok((answer, factor.condition))
    }

    /// Refuses a system that leaves a motion without any resistance: K v + Cᵀ W C v is rounding for some v. Returns the condition
    /// among motions that keep the rows, as v does: the largest row sum of S = D^-1/2 (K + Cᵀ W C) D^-1/2 over its Rayleigh quotient at v.
    fn refuse_kernel(&self, s: &Scaled<'_>, w: &[f64], diagonal: &[f64], scale: &[f64]) -> Result<f64, LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        if n == 0 {
            return Ok(1.0);
        }
        let mut fault = Ok(());
        let soft = softest(diagonal, 2, |v| {
            let mut x = v.to_vec();
            x.resize(n + m, 0.0); // no part in the rows
            if let Err(error) = self.ldlt.apply_inverse(&mut x) {
                fault = Err(error);
            }
            v.copy_from_slice(&x[..n]);
        });
        fault?;
        let Some(Soft { vector: v, .. }) = soft else {
            return Err(LinearError::Singular { residual: 1.0 });
        };
        let root: Vec<f64> = scale.iter().map(|s| s.sqrt()).collect();
        let (mut product, mut size, mut rows) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            let (cols, vals) = s.stiffness.row(i);
            for (j, &k) in cols.zip(vals) {
                let term = k * v[j];
                product[i] += term;
                size[i] += term.abs();
                rows[i] += k.abs() * root[j];
            }
        }
        for a in 0..m {
            let (cols, vals) = s.rows.row(a);
            let (mut sum, mut sum_size, mut sum_rows) = (0.0, 0.0, 0.0);
            for (j, &c) in cols.zip(vals) {
                sum += c * v[j];
                sum_size += (c * v[j]).abs();
                sum_rows += c.abs() * root[j];
            }
            for (j, &c) in cols.zip(vals) {
                product[j] += c * w[a] * sum;
                size[j] += c.abs() * w[a] * sum_size;
                rows[j] += c.abs() * w[a] * sum_rows;
            }
        }
        let (mut top, mut bottom, mut largest, mut energy) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..n {
            top = max(top, product[i].abs() * scale[i]);
            bottom = max(bottom, size[i] * scale[i]);
            largest = max(largest, rows[i] * root[i]);
            energy += v[i] * product[i];
        }
        // the whole matrix K = 0 maps everything to zero
        if bottom == 0.0 || ratio(top, bottom) < KERNEL {
            return Err(LinearError::Singular { residual: 1.0 });
        }
        // v has size one in the scaled norm
        Ok(largest / energy.abs())
    }

    /// Upper triangle of the matrix at the file's head; the pattern holds all rows, enforced or not.
    fn assemble(&mut self, s: &Scaled<'_>, columns: &Csr<f64>, w: &[f64], f: &[f64]) -> Upper {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let known = self.layout.as_ref().is_some_and(|l| &l.stiffness == s.stiffness.pattern() && &l.rows == s.rows.pattern());
        if !known {
            self.layout = Some(Layout {
                stiffness: s.stiffness.pattern().clone(),
                rows: s.rows.pattern().clone(),
                pattern: Arc::new(pattern(s.stiffness, &s.rows, columns)),
            });
        }
        let pattern = self.layout.as_ref().expect("made above").pattern.clone();
        let (ptr, cols) = &*pattern;
        let mut vals = vec![0.0; cols.len()];
        let mut place = vec![0usize; n + m];
        for i in 0..n {
            for k in ptr[i]..ptr[i + 1] {
                place[cols[k]] = k;
            }
            let (row, row_vals) = s.stiffness.row(i);
            for (j, &v) in row.zip(row_vals) {
                if j >= i {
                    vals[place[j]] += v;
                }
            }
            let (touching, entries) = columns.row(i);
            for (a, &c) in touching.zip(entries) {
                if !s.enforced[a] {
                    continue;
                }
                let (row, row_vals) = s.rows.row(a);
                for (j, &v) in row.zip(row_vals) {
                    if j >= i {
                        vals[place[j]] += c * w[a] * v;
                    }
                }
                vals[place[n + a]] += f[a] * c;
            }
        }
        for a in 0..m {
            vals[ptr[n + a]] = if s.enforced[a] { -f[a] * s.compliance[a] - REGULARISATION * s.k[a] } else { -s.k[a] };
        }
        Upper { pattern, vals }
    }

    /// [ K  Bᵀ ; C  -s ] by LU; open rows have -k on the diagonal.
    fn general(&mut self, s: &Scaled<'_>) -> Result<(Vec<f64>, Vec<f64>, f64), LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let columns = s.reaction.as_ref().unwrap_or(&s.rows).transposed();
        let index = |i: usize| u32::try_from(i).expect("fewer than 2^32 unknowns");
        let (mut ptr, mut cols, mut vals) = (vec![0usize], Vec::new(), Vec::new());
        for i in 0..n {
            let (row, row_vals) = s.stiffness.row(i);
            cols.extend(row.map(index));
            vals.extend_from_slice(row_vals);
            let (touching, entries) = columns.row(i);
            for (a, &b) in touching.zip(entries) {
                cols.push(index(n + a));
                vals.push(if s.enforced[a] { b } else { 0.0 });
            }
            ptr.push(cols.len());
        }
        for a in 0..m {
            let (row, row_vals) = s.rows.row(a);
            cols.extend(row.map(index));
            vals.extend(row_vals.iter().map(|&v| if s.enforced[a] { v } else { 0.0 }));
            cols.push(index(n + a));
            vals.push(if s.enforced[a] { -s.compliance[a] } else { -s.k[a] });
            ptr.push(cols.len());
        }
        let matrix = Csr::from_parts(n + m, ptr, cols, vals);
        let mut b = s.load.to_vec();
        b.extend((0..m).map(|a| if s.enforced[a] { -s.offset[a] } else { 0.0 }));
        let mut x = vec![0.0; n + m];
        self.lu.prepare(&matrix)?;
        self.lu.solve(&matrix, &b, &mut x)?;
        let l: Vec<f64> = (0..m).map(|a| if s.enforced[a] { x[n + a] } else { 0.0 }).collect();
        x.truncate(n);
        let scale: Vec<f64> = s.diagonal.iter().map(|d| if *d != 0.0 { 1.0 / d.abs() } else { 1.0 }).collect();
        let size = s.residual(&scale, &x, &l, &mut vec![0.0; n], &mut vec![0.0; m]);
        Ok((x, l, size))
    }
}

impl ConstraintSolver<f64> for Direct {
    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let s = Scaled::of(system)?;
        let small = s.num_unknowns() + s.num_rows() <= LU_LIMIT;
        let (method, answer, condition) = if s.reaction.is_some() || !s.symmetric {
            ("saddle-point, LU", self.general(&s)?, None)
        } else {
            let (first, condition) = self.quasi_definite(&s, system.stiffness.places())?;
            if first.2 > RESIDUAL_LIMIT && small {
                // the residual reached says more than LU's own complaint
                let residual = first.2;
                ("saddle-point, LU", self.general(&s).map_err(|_| LinearError::Singular { residual })?, Some(condition))
            } else {
                ("saddle-point, direct", first, Some(condition))
            }
        };
        let (unknowns, l, residual) = answer;
        if residual.is_nan() || residual > RESIDUAL_LIMIT {
            return Err(LinearError::Singular { residual: if residual.is_finite() { residual } else { 1.0 } }.into());
        }
        Ok(ConstrainedSolution {
            gap: gaps(system, &unknowns),
            unknowns,
            multipliers: (0..l.len()).map(|a| s.factor[a] * l[a]).collect(),
            active: s.enforced,
            residual,
            condition,
            method: method.into(),
            iterations: 0,
            active_set: None,
        })
    }
}

/// Upper triangle of K + Cᵀ C beside Cᵀ, with a diagonal below.
fn pattern(stiffness: &Csr<f64>, rows: &Csr<f64>, columns: &Csr<f64>) -> (Vec<usize>, Vec<usize>) {
    let (n, m) = (stiffness.num_rows(), rows.num_rows());
    let (mut ptr, mut cols) = (vec![0usize], Vec::with_capacity(stiffness.num_entries() / 2 + n + 2 * rows.num_entries() + m));
    let mut seen = vec![usize::MAX; n];
    for i in 0..n {
        let first = cols.len();
        seen[i] = i;
        cols.push(i);
        let mut add = |row: Columns<'_>| {
            for j in row {
                if j > i && seen[j] != i {
                    seen[j] = i;
                    cols.push(j);
                }
            }
        };
        add(stiffness.row(i).0);
        let touching = columns.row(i).0;
        for a in touching {
            add(rows.row(a).0);
        }
        cols[first..].sort_unstable();
        cols.extend(touching.map(|a| n + a));
        ptr.push(cols.len());
    }
    for a in 0..m {
        cols.push(n + a);
        ptr.push(cols.len());
    }
    (ptr, cols)
}
