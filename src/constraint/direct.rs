//! The saddle-point system by one quasi-definite LDLᵀ and refinement on the true system.
//!
//! ```text
//! [ K + Cᵀ W C   Cᵀ F       ]     W = min(1 / k, 1 / 2s),  F = 1 - W s   (exact rows: s = 0, F = 1)
//! [ F C          -F s - e k ]     e = 1e-8; rows scaled as in super::scale, s their compliance
//! ```
//!
//! Strongly quasi-definite, so every symmetric permutation has an LDLᵀ without pivoting. Open rows keep their entries
//! as zeros: pattern and analysis stay while contact opens and closes. The factor serves for refinement only:
//! the residual is that of the unmodified system, so the solution does not depend on e.
//!
//! Source: Vanderbei, SIAM J. Optim. 5 (1995) 100-113 (quasi-definite matrices).

use super::interface::{Interface, InterfaceWork};
use super::quasidefinite::LdltPattern;
use super::refinement::Refinement;
use super::rows_alone::RowsAlone;
use super::scale::{Scaled, ScaledPattern, check_shape, gaps};
use super::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError, kinds_of_set};
use crate::linalg::residual::{InverseIteration, KERNEL, RESIDUAL_LIMIT, Soft, max, ratio};
use crate::linalg::{Csr, Ldlt, LinearError, LinearSolver, Lu, Upper};

/// Refinements allowed.
pub(super) const MAX_REFINEMENTS: usize = 20;
/// Systems up to this size fall back to LU if refinement does not reach the residual wanted.
const LU_LIMIT: usize = 20_000;

/// Saddle-point solver: LDLᵀ for symmetric systems, sparse LU where the reaction differs from the constraint or the stiffness is
/// not symmetric. An indefinite symmetric stiffness is an error: couplings may cause one if their factor is too small.
///
/// Redundant rows that agree share their multiplier; rows that contradict each other are an error.
///
/// The sets of a contact ([`ConstraintSolver::solve_set`]) share one factor and the Schur complement of the contact rows if that is
/// cheaper than the factors of eight sets and takes little memory beside the factor; else every set has its own factor under one
/// analysis.
#[derive(Debug, Default)]
pub struct Direct {
    ldlt: Ldlt,
    lu: Lu,
    lu_factors: usize,
    layout: Option<LdltPattern>,
    interface: Interface,
    /// Scaled system kept for its next set of contact rows.
    kept: Option<ScaledPattern>,
}

/// Weights and scales of a factorised matrix, and its condition.
#[derive(Debug)]
pub(crate) struct Factor {
    /// W, zero on open rows.
    pub(super) w: Vec<f64>,
    /// F.
    f: Vec<f64>,
    /// |diagonal| of K + Cᵀ W C.
    pub(super) diagonal: Vec<f64>,
    /// 1 / diagonal of K + Cᵀ W C.
    pub scale: Vec<f64>,
    /// Condition, see [`ConstrainedSolution::condition`].
    pub condition: f64,
}

impl Direct {
    /// Creates a solver without a factor.
    pub fn new() -> Self {
        Self::default()
    }

    #[cfg(test)]
    pub(super) fn with_interface(interface: Interface) -> Self {
        Self { interface, ..Self::default() }
    }

    /// Number of symbolic analyses so far.
    pub fn num_symbolic_factorizations(&self) -> usize {
        self.ldlt.num_symbolic_factorizations() + self.interface.num_symbolic_factorizations()
    }

    /// Number of factorisations of symmetric matrices so far.
    pub fn factorisations(&self) -> usize {
        self.ldlt.factorisations() + self.interface.factorisations()
    }

    /// Number of entries stored for the current factors, 8 bytes each.
    pub fn factor_entries(&self) -> usize {
        self.ldlt.factor_entries() + self.interface.factor_entries()
    }

    /// Operation counts of the Schur complement of the contact rows so far; all zero if none was computed.
    pub fn interface_work(&self) -> InterfaceWork {
        self.interface.work
    }

    /// Memory in bytes that solving `system` needs beyond the system itself, from the symbolic analysis alone: the factor and, if the sets
    /// of its contact rows share one, their Schur complement; else contact rows count as closed.
    ///
    /// The analysis is kept for [`ConstraintSolver::solve`]. Not for systems whose reaction differs from the constraint.
    ///
    /// # Errors
    /// [`SolveError`] if the system itself is invalid.
    pub fn predicted_memory(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<usize, SolveError> {
        check_shape(system)?;
        let kind = kinds_of_set(system.kind, &vec![true; system.kind.len()]);
        // only the symmetric part is factorised, whatever the reaction
        let s = Scaled::of(&ConstrainedSystem { kind: &kind, reaction: None, ..*system })?;
        let places = system.stiffness.dof_coordinates();
        let symmetric = system.reaction.is_none_or(|b| b == system.constraint);
        if let Some(contact) = s.interface(system.kind).filter(|_| symmetric)
            && let Some(bytes) = self.interface.predict(&s, &contact, places)?
        {
            return Ok(bytes);
        }
        let layout = LdltPattern::of(&mut self.layout, &s, &[]);
        Ok(self.ldlt.predict(&layout.empty(), &layout.places(&s, places))?)
    }

    /// Factorises the matrix of the module docs; [`LinearError::Singular`] if it has a zero-energy mode.
    pub(crate) fn factorise(&mut self, s: &Scaled<'_>, places: &[[f64; 3]]) -> Result<Factor, LinearError> {
        let (mut factor, upper) = self.numbers(s, places)?;
        let whole = Whole { s, factor: &factor, ldlt: &self.ldlt };
        let mut motion = InverseIteration::begin(&factor.diagonal);
        for _ in 0..motion_steps(s) {
            whole.step(motion.right_side())?;
            motion.solved().ok_or(LinearError::Singular { residual: 1.0 })?;
        }
        factor.condition = refuse_kernel(s, &factor, &motion.end().vector)?;
        self.refuse_negative(s, &upper, places)?;
        Ok(factor)
    }

    /// Factorises without any check; returns the factor's data and the upper triangle that was factorised.
    fn numbers(&mut self, s: &Scaled<'_>, places: &[[f64; 3]]) -> Result<(Factor, Upper), LinearError> {
        let (w, f) = weights(s);
        let layout = LdltPattern::of(&mut self.layout, s, &[]);
        let upper = layout.assemble(s, &w, &f);
        self.ldlt.factorise_upper(&upper, &layout.places(s, places))?;
        let diagonal: Vec<f64> = (0..s.num_unknowns()).map(|i| upper.vals[upper.pattern.0[i]].abs()).collect();
        Ok((Factor::with(w, f, diagonal), upper))
    }

    /// Checks the inertia: one negative pivot per row, none of the stiffness.
    fn refuse_negative(&mut self, s: &Scaled<'_>, upper: &Upper, places: &[[f64; 3]]) -> Result<(), LinearError> {
        self.ldlt.refuse_negative(upper, s.num_unknowns(), &s.all_places(places))
    }

    /// (du, dl) with K du + Cᵀ dl = r1, C du - s dl = r2, up to the regularisation.
    pub(crate) fn correct(&self, s: &Scaled<'_>, factor: &Factor, r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        Whole { s, factor, ldlt: &self.ldlt }.correct(r1, r2)
    }

    /// Solves by the quasi-definite factor; returns (u, l, residual) and the condition.
    fn quasi_definite(&mut self, s: &Scaled<'_>, places: &[[f64; 3]]) -> Result<((Vec<f64>, Vec<f64>, f64), f64), LinearError> {
        let (factor, upper) = self.numbers(s, places)?;
        let (answer, more, soft) = begin(s, &factor, &Whole { s, factor: &factor, ldlt: &self.ldlt })?;
        let condition = refuse_kernel(s, &factor, &soft.vector)?;
        self.refuse_negative(s, &upper, places)?;
        let answer = if more { answer.finished(MAX_REFINEMENTS, |r1, r2| self.correct(s, &factor, r1, r2))? } else { answer.end() };
        Ok((answer, condition))
    }

    /// Solves with [ K  Bᵀ ; C  -s ] by LU; open rows have -k on the diagonal. Returns (u, l, residual).
    fn general(&mut self, s: &Scaled<'_>) -> Result<(Vec<f64>, Vec<f64>, f64), LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let index = |i: usize| u32::try_from(i).expect("fewer than 2^32 unknowns");
        let (mut ptr, mut cols, mut vals) = (vec![0usize], Vec::new(), Vec::new());
        for i in 0..n {
            let (row, row_vals) = s.stiffness.row(i);
            cols.extend(row.map(index));
            vals.extend_from_slice(row_vals);
            let (touching, entries) = s.columns.row(i);
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
        self.lu_factors += 1;
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
    fn abilities(&self) -> Abilities {
        Abilities { contact: false, unsymmetric: true, more_rows_than_unknowns: true }
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        self.solve_alone(system, &Scaled::of(system)?)
    }

    fn solve_set(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        closed: &[bool],
        again: bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        let kind = kinds_of_set(system.kind, closed);
        let of_set = ConstrainedSystem { kind: &kind, ..*system };
        let s = match self.kept.take() {
            Some(kept) if again => kept.with(&of_set)?,
            _ => Scaled::of(&of_set)?,
        };
        let shared = match s.interface(system.kind) {
            Some(contact) => self.interface.solve(&s, &contact, system.stiffness.dof_coordinates(), again),
            None => Ok(None),
        };
        if s.reaction.is_some() {
            self.interface.forget();
        }
        let solved = match shared {
            Ok(Some((u, l, size, condition))) => Ok(solution(&of_set, &s, DIRECT, (u, l, size), Some(condition))),
            Ok(None) => self.solve_alone(&of_set, &s),
            Err(error) => Err(error.into()),
        };
        self.kept = Some(s.into());
        solved
    }

    fn rows_alone(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        groups: &[Vec<usize>],
        again: bool,
    ) -> Result<Option<RowsAlone>, SolveError> {
        check_shape(system)?;
        let kind = kinds_of_set(system.kind, &vec![true; system.kind.len()]);
        let closed = ConstrainedSystem { kind: &kind, ..*system };
        let s = match self.kept.take() {
            Some(kept) if again => kept.with(&closed)?,
            _ => Scaled::of(&closed)?,
        };
        let alone = match s.interface(system.kind) {
            Some(contact) => self.interface.alone(&s, &contact, groups, system.stiffness.dof_coordinates(), again)?,
            None => None,
        };
        self.kept = Some(s.into());
        Ok(alone)
    }

    fn factors(&self) -> usize {
        self.factorisations() + self.lu_factors
    }
}

impl Direct {
    /// Solves `system`, whose scaled form is `s`, with a factor of its own.
    fn solve_alone(&mut self, system: &ConstrainedSystem<'_, f64>, s: &Scaled<'_>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let small = s.num_unknowns() + s.num_rows() <= LU_LIMIT;
        let (method, answer, condition) = if s.reaction.is_some() || !s.symmetric {
            (LU, self.general(s)?, None)
        } else {
            let (first, condition) = self.quasi_definite(s, system.stiffness.dof_coordinates())?;
            if first.2 > RESIDUAL_LIMIT && small {
                // the residual reached is more informative than the error of LU
                let residual = first.2;
                (LU, self.general(s).map_err(|_| LinearError::Singular { residual })?, Some(condition))
            } else {
                (DIRECT, first, Some(condition))
            }
        };
        let residual = answer.2;
        if residual.is_nan() || residual > RESIDUAL_LIMIT {
            return Err(LinearError::Singular { residual: if residual.is_finite() { residual } else { 1.0 } }.into());
        }
        Ok(solution(system, s, method, answer, condition))
    }
}

/// Names of the methods.
const DIRECT: &str = "saddle-point, direct";
const LU: &str = "saddle-point, LU";

/// Converts the solution to the caller's units.
fn solution(
    system: &ConstrainedSystem<'_, f64>,
    s: &Scaled<'_>,
    method: &str,
    (unknowns, l, residual): (Vec<f64>, Vec<f64>, f64),
    condition: Option<f64>,
) -> ConstrainedSolution<f64> {
    ConstrainedSolution {
        gap: gaps(system, &unknowns),
        unknowns,
        multipliers: (0..l.len()).map(|a| s.factor[a] * l[a]).collect(),
        active: s.enforced.clone(),
        residual,
        condition,
        method: method.into(),
        iterations: 0,
        active_set: None,
    }
}

/// Inverse of the saddle-point system, applied by a factor.
pub(super) trait Inverse {
    /// Replaces `vector` by the block of the unknowns of the inverse times it; the right-hand side is zero in the rows.
    fn step(&self, vector: &mut [f64]) -> Result<(), LinearError>;

    /// (du, dl) with K du + Cᵀ dl = r1, C du - s dl = r2, up to the regularisation.
    fn correct(&self, r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError>;

    /// [`Inverse::step`] and [`Inverse::correct`] in little more than the time of one, which is that of reading the factor.
    fn both(&self, vector: &mut [f64], r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError>;
}

/// The inverse by a factor of the matrix of the module docs.
struct Whole<'a, 'b> {
    s: &'a Scaled<'b>,
    factor: &'a Factor,
    ldlt: &'a Ldlt,
}

impl Inverse for Whole<'_, '_> {
    fn step(&self, vector: &mut [f64]) -> Result<(), LinearError> {
        let mut x = extended(vector, self.s.num_rows());
        self.ldlt.apply_inverse(&mut x)?;
        vector.copy_from_slice(&x[..vector.len()]);
        Ok(())
    }

    fn correct(&self, r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let mut x = right_side(self.s, self.factor, r1, r2);
        self.ldlt.apply_inverse(&mut x)?;
        Ok(parts(self.s, x))
    }

    fn both(&self, vector: &mut [f64], r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let (mut x, mut y) = (extended(vector, self.s.num_rows()), right_side(self.s, self.factor, r1, r2));
        self.ldlt.apply_inverse_each([&mut x, &mut y])?;
        vector.copy_from_slice(&x[..vector.len()]);
        Ok(parts(self.s, y))
    }
}

/// Computes the first corrections together with the inverse iteration for zero-energy modes. Returns the state, whether more corrections
/// may gain digits, and the softest mode found.
pub(super) fn begin<'a, 'b>(
    s: &'a Scaled<'b>,
    factor: &'a Factor,
    inverse: &impl Inverse,
) -> Result<(Refinement<'a, 'b>, bool, Soft), LinearError> {
    let mut motion = InverseIteration::begin(&factor.diagonal);
    let mut state = Refinement::begin(s, &factor.scale);
    let mut more = state.size > 0.0;
    for _ in 0..motion_steps(s) {
        let correction = if more {
            Some(inverse.both(motion.right_side(), &state.r1, &state.r2)?)
        } else {
            inverse.step(motion.right_side())?;
            None
        };
        motion.solved().ok_or(LinearError::Singular { residual: 1.0 })?;
        if let Some((du, dl)) = correction {
            more = state.improve(&du, &dl);
        }
    }
    Ok((state, more, motion.end()))
}

/// W and F of the rows, see the module docs; W is zero on open rows.
pub(super) fn weights(s: &Scaled<'_>) -> (Vec<f64>, Vec<f64>) {
    let m = s.num_rows();
    let w: Vec<f64> = (0..m).map(|a| if s.enforced[a] { (1.0 / s.k[a]).min(0.5 / s.compliance[a]) } else { 0.0 }).collect();
    let f = (0..m).map(|a| 1.0 - w[a] * s.compliance[a]).collect();
    (w, f)
}

impl Factor {
    fn with(w: Vec<f64>, f: Vec<f64>, diagonal: Vec<f64>) -> Self {
        let scale = diagonal.iter().map(|&d| if d > 0.0 { 1.0 / d } else { 1.0 }).collect();
        Self { w, f, diagonal, scale, condition: 1.0 }
    }

    /// Weights and scales of the matrix of the module docs for `s`, without factorising it; the condition is 1.
    pub(super) fn of(s: &Scaled<'_>) -> Self {
        let (w, f) = weights(s);
        let diagonal = s.diagonal_with(|a| w[a]);
        Self::with(w, f, diagonal)
    }

    /// Corrects the softest mode v, v·Dv = 1, of a matrix M by the residual of M v = (v·M v) D v, which is orthogonal to v: this removes
    /// stiff components even if v itself has almost no stiffness. `product`: M v, overwritten; `inverse` solves with M to few digits.
    pub(super) fn correct_motion(
        &self,
        v: &mut [f64],
        product: &mut [f64],
        inverse: impl FnOnce(&[f64]) -> Result<Vec<f64>, LinearError>,
    ) -> Result<(), LinearError> {
        let energy: f64 = v.iter().zip(&*product).map(|(v, r)| v * r).sum();
        (0..v.len()).for_each(|i| product[i] -= energy * v[i] / self.scale[i]);
        let correction = inverse(product)?;
        v.iter_mut().zip(correction).for_each(|(v, dv)| *v -= dv);
        let size = v.iter().zip(&self.scale).map(|(v, s)| v * v / s).sum::<f64>().sqrt();
        v.iter_mut().for_each(|v| *v /= size);
        Ok(())
    }
}

/// Steps of inverse iteration used to find a zero-energy mode; 0 without unknowns.
fn motion_steps(s: &Scaled<'_>) -> usize {
    if s.num_unknowns() == 0 { 0 } else { 2 }
}

/// v followed by `rows` zeros.
fn extended(v: &[f64], rows: usize) -> Vec<f64> {
    let mut x = Vec::with_capacity(v.len() + rows);
    x.extend_from_slice(v);
    x.resize(v.len() + rows, 0.0);
    x
}

/// Right-hand side of the matrix of the module docs for the residuals r1 and r2.
fn right_side(s: &Scaled<'_>, factor: &Factor, r1: &[f64], r2: &[f64]) -> Vec<f64> {
    let Factor { w, f, .. } = factor;
    let mut x = extended(r1, r2.len());
    for (a, &r2) in r2.iter().enumerate() {
        x[r1.len() + a] = f[a] * r2;
        let (cols, vals) = s.rows.row(a);
        for (j, &v) in cols.zip(vals) {
            x[j] += v * w[a] * r2;
        }
    }
    x
}

/// Splits x into unknowns and multipliers; those of open rows are zero.
fn parts(s: &Scaled<'_>, mut x: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let n = s.num_unknowns();
    let multipliers = (0..s.num_rows()).map(|a| if s.enforced[a] { x[n + a] } else { 0.0 }).collect();
    x.truncate(n);
    (x, multipliers)
}

/// Returns [`LinearError::Singular`] if (K + Cᵀ W C) v is zero up to rounding. Otherwise returns the condition on the null space of the
/// rows, in which v lies: the largest row sum of S = D^-1/2 (K + Cᵀ W C) D^-1/2 over its Rayleigh quotient at v.
pub(super) fn refuse_kernel(s: &Scaled<'_>, factor: &Factor, v: &[f64]) -> Result<f64, LinearError> {
    let (n, m) = (s.num_unknowns(), s.num_rows());
    if n == 0 {
        return Ok(1.0);
    }
    let Factor { w, scale, .. } = factor;
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
