//! Sparse LDLᵀ of symmetric positive definite and quasi-definite matrices: analysis by faer, numerical factorisation by fronts.
//!
//! P A Pᵀ = L D Lᵀ without pivoting. P is a geometric nested dissection if the operator has coordinates of its unknowns, else
//! approximate minimum degree. A pattern seen before keeps its analysis.

use super::csr::all_finite;
use super::faer_analysis::{Analysis, analyse};
use super::refine::refine;
use super::residual::{KERNEL, SAFE_GROWTH, Soft, kernel_ratio, row_scale, scaled_condition, softest};
use super::solver::NO_SYMMETRY;
use super::{Border, Buffer, Csr, LinearError, LinearSolver, Operator, Sparsity, Upper};
use faer::dyn_stack::MemBuffer;
use std::fmt;
use std::sync::{Arc, Mutex};

/// Relative increase of the diagonal that removes negative pivots due to rounding, as of a body on soft springs. A coupling that makes
/// the matrix indefinite does so in proportion to the stiffness.
const LIFT: f64 = 1e-7;

/// LDLᵀ factorisation with refinement and a check of the residual.
///
/// For positive definite and quasi-definite matrices of which both triangles are stored and only one is read.
/// A matrix that maps some vector to rounding errors is an error: it is singular.
#[derive(Default)]
pub struct Ldlt {
    analysis: Option<Analysis>,
    factor: Buffer<f64>,
    /// Memory of the last factorisation.
    work: Option<[Buffer<f64>; 2]>,
    /// Memory of the last solution.
    vectors: Mutex<Buffer<f64>>,
    ready: bool,
    /// Values that were factorised, from the second matrix of a pattern on: one matrix alone needs no memory to compare.
    values: Vec<f64>,
    analyses: usize,
    factorisations: usize,
    negative: usize,
    /// |diagonal| of the matrix factorised last.
    diagonal: Vec<f64>,
    scale: Vec<f64>,
}

impl fmt::Debug for Ldlt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ldlt").field("analyses", &self.analyses).field("factor_entries", &self.factor.len()).finish()
    }
}

impl Ldlt {
    /// Creates a solver without a factor.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of symbolic analyses so far.
    pub fn num_symbolic_factorizations(&self) -> usize {
        self.analyses
    }

    /// Number of numerical factorisations so far; repeating the last matrix does not count.
    pub fn factorisations(&self) -> usize {
        self.factorisations
    }

    /// Number of entries stored for the last factor, 8 bytes each.
    pub fn factor_entries(&self) -> usize {
        self.factor.len()
    }

    /// Whether the last analysis used the coordinates of the unknowns.
    pub fn uses_nested_dissection(&self) -> bool {
        self.analysis.as_ref().is_some_and(|a| a.dissected)
    }

    /// First part of [`LinearSolver::prepare`]: the order of the unknowns and the structure of the factor. A pattern seen before keeps its
    /// analysis.
    ///
    /// # Errors
    /// [`LinearError`] if `a` has no matrix, is not symmetric, or is too large.
    pub fn analyse(&mut self, a: &dyn Operator<f64>) -> Result<(), LinearError> {
        let upper = self.upper(a)?;
        self.analyse_upper(&upper, a.dof_coordinates())?;
        self.learn(a);
        Ok(())
    }

    /// Second part of [`LinearSolver::prepare`], with the first if needed: the values of the factor.
    ///
    /// # Errors
    /// [`LinearError`] as from [`Ldlt::analyse`], and if a pivot is zero or infinite.
    pub fn factorise(&mut self, a: &dyn Operator<f64>) -> Result<(), LinearError> {
        let upper = self.upper(a)?;
        self.factorise_upper(&upper, a.dof_coordinates())?;
        self.learn(a);
        Ok(())
    }

    /// Last part of [`LinearSolver::prepare`]: checks that the matrix maps no vector to rounding errors.
    ///
    /// # Errors
    /// [`LinearError::Singular`], also before [`Ldlt::factorise`].
    pub fn check(&mut self, a: &dyn Operator<f64>) -> Result<(), LinearError> {
        let matrix = self.factorised(a)?;
        self.scale = row_scale(a);
        if matrix.num_rows() == 0 {
            return Ok(());
        }
        // a kernel vector grows so much in one step that a regular matrix needs no second one
        let soft = self.soft(1)?;
        if soft.growth < SAFE_GROWTH {
            return Ok(());
        }
        let soft = self.soft(2)?;
        if kernel_ratio(matrix, &self.scale, &soft.vector) < KERNEL {
            self.ready = false;
            return Err(LinearError::Singular { residual: 1.0 });
        }
        Ok(())
    }

    /// Estimates the spectral condition number of D^-1/2 A D^-1/2, D = |diag A|: the amplification of errors of the load, and the condition
    /// that governs an iterative solver. Costs two solves with the factor.
    ///
    /// Largest absolute row sum, an upper bound of the largest eigenvalue, over the Rayleigh quotient after two steps of inverse iteration,
    /// an upper bound of the least one: accurate to a factor of a few.
    ///
    /// # Errors
    /// [`LinearError`] if `a` has no matrix or is not the one factorised.
    pub fn condition(&mut self, a: &dyn Operator<f64>) -> Result<f64, LinearError> {
        let matrix = self.factorised(a)?;
        if matrix.num_rows() == 0 {
            return Ok(1.0);
        }
        let soft = self.soft(2)?;
        Ok(scaled_condition(matrix, &self.diagonal, &soft.vector))
    }

    /// Returns the matrix of `a`; [`LinearError::Shape`] unless it has as many rows as the one factorised.
    fn factorised<'a>(&self, a: &'a dyn Operator<f64>) -> Result<&'a Csr<f64>, LinearError> {
        let matrix = a.csr().ok_or(LinearError::NoMatrix)?;
        let (expected, found) = (self.diagonal.len(), matrix.num_rows());
        if self.ready && expected != found {
            return Err(LinearError::Shape { expected, found });
        }
        Ok(matrix)
    }

    /// Runs inverse iteration with the factor; if it overflows, the factor is discarded.
    fn soft(&mut self, steps: usize) -> Result<Soft, LinearError> {
        let mut fault = None;
        let soft = softest(&self.diagonal, steps, |v| {
            if let Err(error) = self.apply_inverse(v) {
                fault = Some(error);
            }
        });
        let soft = match fault {
            Some(error) => Err(error),
            None => soft.ok_or(LinearError::Singular { residual: 1.0 }),
        };
        self.ready &= soft.is_ok();
        soft
    }

    /// Returns the upper triangle of `a`, which has to be symmetric.
    fn upper(&mut self, a: &dyn Operator<f64>) -> Result<Upper, LinearError> {
        let matrix = a.csr().ok_or(LinearError::NoMatrix)?;
        let fault = if !matrix.is_finite() {
            Some(LinearError::NotFinite)
        } else {
            (!matrix.is_symmetric(NO_SYMMETRY)).then_some(LinearError::NotSymmetric)
        };
        if let Some(fault) = fault {
            self.ready = false;
            return Err(fault);
        }
        let same = |s: &Arc<Sparsity>| Arc::ptr_eq(s, matrix.pattern()) || s == matrix.pattern();
        let known = self.analysis.as_ref().filter(|a| a.source.as_ref().is_some_and(same));
        Ok(known.map_or_else(|| Upper::of(matrix), |a| Upper::refilled(&a.pattern, matrix)))
    }

    /// Stores the pattern that the upper triangle was taken from.
    fn learn(&mut self, a: &dyn Operator<f64>) {
        if let (Some(analysis), Some(matrix)) = (&mut self.analysis, a.csr()) {
            analysis.source = Some(matrix.pattern().clone());
        }
    }

    /// Memory in bytes of a factorisation of this pattern beyond the matrix itself: factor, pattern, fronts, the values that a
    /// second matrix of the pattern is compared with, and two vectors for solves. The analysis is kept.
    pub(crate) fn predict(&mut self, upper: &Upper, places: &[[f64; 3]]) -> Result<usize, LinearError> {
        self.analyse_upper(upper, places)?;
        let analysis = self.analysis.as_ref().expect("analysed above");
        let symbolic = &analysis.symbolic;
        Ok(8 * (symbolic.len_val() + 3 * symbolic.nrows()) + 24 * upper.pattern.1.len() + analysis.work_bytes())
    }

    pub(crate) fn analyse_upper(&mut self, upper: &Upper, places: &[[f64; 3]]) -> Result<(), LinearError> {
        let seen = self.analysis.as_ref().is_some_and(|a| Arc::ptr_eq(&a.pattern, &upper.pattern) || a.pattern == upper.pattern);
        if !seen {
            self.ready = false;
            self.analysis = None;
            self.factor = Buffer::default();
            self.work = None;
            self.vectors = Mutex::default();
            self.analysis = Some(analyse(&upper.pattern, places)?);
            self.analyses += 1;
        }
        Ok(())
    }

    /// Factorises the matrix with this upper triangle; no check of singularity beyond zero and infinite pivots.
    pub(crate) fn factorise_upper(&mut self, upper: &Upper, places: &[[f64; 3]]) -> Result<(), LinearError> {
        if !all_finite(&upper.vals) {
            self.ready = false;
            return Err(LinearError::NotFinite);
        }
        let before = self.analyses;
        self.analyse_upper(upper, places)?;
        if self.holds(upper) {
            return Ok(());
        }
        self.ready = false;
        self.values.clear();
        if self.analyses == before {
            self.values.extend_from_slice(&upper.vals);
        }
        self.factorisations += 1;
        let symbolic = &self.analysis.as_ref().expect("analysed above").symbolic;
        let n = symbolic.nrows();
        if self.factor.len() != symbolic.len_val() {
            self.factor = Buffer::default();
            self.factor = Buffer::try_zeros(symbolic.len_val()).ok_or(LinearError::Memory)?;
        }
        self.diagonal.clear();
        if n == 0 {
            (self.ready, self.negative) = (true, 0);
            return Ok(());
        }
        let analysis = self.analysis.as_ref().expect("analysed above");
        analysis.factorise(upper, &mut self.factor, &mut self.work)?;
        self.diagonal.extend(upper.pattern.0[..n].iter().map(|&first| upper.vals[first].abs()));
        self.ready = true;
        self.negative = analysis.negative_pivots(upper, &self.factor);
        Ok(())
    }

    /// Whether the factor is that of the matrix with this upper triangle; known from the second matrix of a pattern on.
    fn holds(&self, upper: &Upper) -> bool {
        self.ready && self.values == upper.vals
    }

    /// [`Ldlt::factorise_upper`] for a matrix that will be factorised again: its values are kept for comparison from the first one on.
    /// Returns whether the factor is new.
    pub(crate) fn factorise_kept(&mut self, upper: Upper, places: &[[f64; 3]]) -> Result<bool, LinearError> {
        if self.analysis.as_ref().is_some_and(|a| Arc::ptr_eq(&a.pattern, &upper.pattern)) && self.holds(&upper) {
            return Ok(false);
        }
        self.values.clear();
        self.factorise_upper(&upper, places)?;
        self.values = upper.vals;
        Ok(true)
    }

    /// Analysis of the current factor; [`LinearError::Singular`] if there is none.
    fn at_hand(&self) -> Result<&Analysis, LinearError> {
        self.analysis.as_ref().filter(|_| self.ready).ok_or(LinearError::Singular { residual: 1.0 })
    }

    /// Number of negative pivots of the last factor, rounding left out.
    pub(crate) fn negative(&self) -> usize {
        self.negative
    }

    /// Number of entries of a factor of the last pattern, and operations to compute it; a multiplication and an addition are two.
    pub(crate) fn size(&self) -> (usize, f64) {
        self.analysis.as_ref().map_or((0, 0.0), |a| (a.symbolic.len_val(), a.operations()))
    }

    #[cfg(test)]
    pub(super) fn raw(&self) -> &faer::sparse::linalg::cholesky::SymbolicCholeskyRaw<usize> {
        self.analysis.as_ref().unwrap().symbolic.raw()
    }

    /// Parts of the factor reached by the rows `chosen` of `c`; needs an analysis only.
    pub(crate) fn border(&self, c: &Csr<f64>, chosen: &[usize]) -> Border {
        self.analysis.as_ref().expect("the pattern was analysed").border(c, chosen)
    }

    /// S = C A⁻¹ Cᵀ over the rows of `border`, column after column; the lower triangle alone is set.
    pub(crate) fn complement(&self, border: &Border, c: &Csr<f64>) -> Result<Buffer<f64>, LinearError> {
        self.at_hand()?.complement(&self.factor, border, c)
    }

    /// x = A⁻¹ (x - Cᵀ nu) for each of R vectors, where `inner`(r, h) replaces h = C A⁻¹ x, one number per row of `border`, by nu.
    pub(crate) fn solve_bordered<const R: usize>(
        &self,
        border: &Border,
        c: &Csr<f64>,
        x: [&mut [f64]; R],
        inner: impl FnMut(usize, &mut [f64]),
    ) -> Result<(), LinearError> {
        let (mut kept, mut own) = (self.vectors.try_lock().ok(), Buffer::default());
        self.at_hand()?.solve_bordered(&self.factor, border, c, x, kept.as_deref_mut().unwrap_or(&mut own), inner)
    }

    /// Returns [`LinearError::Indefinite`] if `upper`, the matrix factorised last, has more negative pivots than rows after the first
    /// `unknowns`.
    pub(crate) fn refuse_negative(&mut self, upper: &Upper, unknowns: usize, places: &[[f64; 3]]) -> Result<(), LinearError> {
        let rows = upper.pattern.0.len() - 1 - unknowns;
        if self.negative <= rows {
            return Ok(());
        }
        let mut vals = upper.vals.clone();
        for &diagonal in &upper.pattern.0[..unknowns] {
            vals[diagonal] += LIFT * vals[diagonal].abs();
        }
        self.factorise_upper(&Upper { pattern: upper.pattern.clone(), vals }, places)?;
        let negative = self.negative.saturating_sub(rows);
        self.factorise_upper(upper, places)?;
        if negative > 0 { Err(LinearError::Indefinite { negative }) } else { Ok(()) }
    }

    /// x = A⁻¹ x by the factor alone.
    pub(crate) fn apply_inverse(&self, x: &mut [f64]) -> Result<(), LinearError> {
        self.apply_inverse_each([x])
    }

    /// x = A⁻¹ x by the factor for each of R vectors, in little more than the time of one.
    pub(crate) fn apply_inverse_each<const R: usize>(&self, x: [&mut [f64]; R]) -> Result<(), LinearError> {
        let Some(analysis) = self.analysis.as_ref().filter(|_| self.ready) else {
            return Err(LinearError::Singular { residual: 1.0 });
        };
        let n = analysis.symbolic.nrows();
        if let Some(x) = x.iter().find(|x| x.len() != n) {
            return Err(LinearError::Shape { expected: n, found: x.len() });
        }
        // another thread may hold it
        let (mut kept, mut own) = (self.vectors.try_lock().ok(), Buffer::default());
        analysis.solve(&self.factor, x, kept.as_deref_mut().unwrap_or(&mut own))
    }
}

impl LinearSolver<f64> for Ldlt {
    fn prepare(&mut self, a: &dyn Operator<f64>) -> Result<(), LinearError> {
        self.factorise(a)?;
        self.check(a)
    }

    fn solve(&self, a: &dyn Operator<f64>, b: &[f64], x: &mut [f64]) -> Result<usize, LinearError> {
        refine(a, &self.scale, b, x, |r| self.apply_inverse(r))
    }
}

/// Scratch memory; [`LinearError::Memory`] if the system has none left.
pub(crate) fn buffer(size: faer::dyn_stack::StackReq) -> Result<MemBuffer, LinearError> {
    MemBuffer::try_new(size).map_err(|_| LinearError::Memory)
}
