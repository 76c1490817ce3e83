//! Symbolic part of a factorisation, which depends on the pattern alone and is reused for matrices of the same pattern.

use super::faer_border::{Border, Nodes};
use super::faer_ldlt::buffer;
use super::faer_solve::{solve, solve_bordered};
use super::multifrontal::Fronts;
use super::{Buffer, Csr, LinearError, Sparsity, Upper, faer_kernels, ordering};
use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{self, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use pulp::Arch;
use std::sync::Arc;

/// Relative size, against the diagonal entry, below which a pivot is rounding.
const NO_PIVOT: f64 = 1e-12;

/// Fill-reducing order of the unknowns and structure of the factor.
pub(super) struct Analysis {
    /// Pattern of the full matrix, if the upper triangle was taken from one.
    pub source: Option<Arc<Sparsity>>,
    /// The pattern of the upper triangle.
    pub pattern: Arc<(Vec<usize>, Vec<usize>)>,
    pub symbolic: SymbolicCholesky<usize>,
    /// Data of the multifrontal factorisation; `None` if it is not used.
    pub fronts: Option<Fronts>,
    /// Whether the order is a nested dissection by the coordinates of the unknowns.
    pub dissected: bool,
}

impl Analysis {
    /// Bytes that a factorisation needs beside the factor and the upper triangle.
    pub fn work_bytes(&self) -> usize {
        match &self.fronts {
            Some(fronts) => fronts.bytes() + fronts.work_bytes(),
            None => self.symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default()).size_bytes(),
        }
    }

    /// Computes the factor of the matrix with this upper triangle; `work` is kept for the next one.
    pub fn factorise(&self, upper: &Upper, factor: &mut [f64], work: &mut Option<[Buffer<f64>; 2]>) -> Result<(), LinearError> {
        if let SymbolicCholeskyRaw::Supernodal(_) = self.symbolic.raw() {
            faer_kernels::take()?;
        }
        match (&self.fronts, self.symbolic.raw()) {
            (Some(fronts), SymbolicCholeskyRaw::Supernodal(nodes)) => {
                let work = match work {
                    Some(work) => work,
                    None => work.insert(fronts.work().ok_or(LinearError::Memory)?),
                };
                fronts.factorise(nodes, &upper.vals, factor, work).ok_or(LinearError::Singular { residual: 1.0 })
            }
            _ => self.by_columns(upper, factor),
        }
    }

    /// Computes the factor by faer, by columns of supernodes or, if the factor has few entries, by single columns.
    pub fn by_columns(&self, upper: &Upper, factor: &mut [f64]) -> Result<(), LinearError> {
        let ((ptr, cols), symbolic) = (&*upper.pattern, &self.symbolic);
        let n = symbolic.nrows();
        // rows of the upper triangle are columns of the lower one
        let matrix = SparseColMatRef::new(SymbolicSparseColMatRef::new_checked(n, n, ptr, None, cols), &upper.vals);
        let mut memory = buffer(symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default()))?;
        let plain = LdltRegularization::default();
        symbolic
            .factorize_numeric_ldlt(factor, matrix, Side::Lower, plain, Par::Seq, MemStack::new(&mut memory), Spec::default())
            .map_err(|_| LinearError::Singular { residual: 1.0 })?;
        Ok(())
    }

    /// Number of negative pivots: as many as the matrix has negative eigenvalues (Sylvester). Pivots within rounding of zero,
    /// measured by the diagonal entry they come from, do not count.
    pub fn negative_pivots(&self, upper: &Upper, factor: &[f64]) -> usize {
        let order = self.symbolic.perm().map(|p| p.arrays().0);
        let negative = |new: usize, pivot: f64| {
            let old = order.map_or(new, |order| order[new]);
            pivot < -NO_PIVOT * upper.vals[upper.pattern.0[old]].abs()
        };
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(s) => (0..s.nrows()).filter(|&j| negative(j, factor[s.col_ptr()[j]])).count(),
            SymbolicCholeskyRaw::Supernodal(s) => {
                let factor = SupernodalLdltRef::new(s, factor);
                let of_node = |k: usize| {
                    let (node, first) = (factor.supernode(k).val(), s.supernode_begin()[k]);
                    (0..node.ncols()).filter(|&j| negative(first + j, node[(j, j)])).count()
                };
                (0..s.n_supernodes()).map(of_node).sum()
            }
        }
    }

    /// x = A⁻¹ x by the factor of A, for each of R vectors; `memory` is kept for the next ones.
    pub fn solve<const R: usize>(&self, factor: &[f64], x: [&mut [f64]; R], memory: &mut Buffer<f64>) -> Result<(), LinearError> {
        if let (raw @ SymbolicCholeskyRaw::Supernodal(_), Some(perm)) = (self.symbolic.raw(), self.symbolic.perm()) {
            return solve(Arch::new(), Nodes(raw), factor, perm.arrays().0, x, memory).ok_or(LinearError::Memory);
        }
        x.into_iter().try_for_each(|x| self.solve_by_faer(factor, x))
    }

    /// Nodes of the factor reached by the rows `chosen` of `c`.
    pub fn border(&self, c: &Csr<f64>, chosen: &[usize]) -> Border {
        Border::of(Nodes(self.symbolic.raw()), self.orders()[1], c, chosen)
    }

    /// Operations of a factorisation.
    pub fn operations(&self) -> f64 {
        Nodes(self.symbolic.raw()).operations()
    }

    /// C A⁻¹ Cᵀ over the rows of a border, the lower triangle alone.
    pub fn complement(&self, factor: &[f64], border: &Border, c: &Csr<f64>) -> Result<Buffer<f64>, LinearError> {
        faer_kernels::take()?;
        border.complement(Nodes(self.symbolic.raw()), factor, self.orders()[1], c).ok_or(LinearError::Memory)
    }

    /// x = A⁻¹ (x - Cᵀ nu) for each of R vectors, where `inner`(r, h) replaces h = C A⁻¹ x by nu.
    pub fn solve_bordered<const R: usize>(
        &self,
        factor: &[f64],
        border: &Border,
        c: &Csr<f64>,
        x: [&mut [f64]; R],
        memory: &mut Buffer<f64>,
        inner: impl FnMut(usize, &mut [f64]),
    ) -> Result<(), LinearError> {
        solve_bordered(Arch::new(), Nodes(self.symbolic.raw()), factor, self.orders(), border, c, x, memory, inner)
            .ok_or(LinearError::Memory)
    }

    /// The unknown of each column of the factor, and the column of each unknown.
    fn orders(&self) -> [&[usize]; 2] {
        self.symbolic.perm().map_or([&[]; 2], |perm| [perm.arrays().0, perm.arrays().1])
    }

    /// x = A⁻¹ x by faer, for factors of single columns.
    pub fn solve_by_faer(&self, factor: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let n = x.len();
        if n == 0 {
            return Ok(());
        }
        let mut memory = buffer(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
        LdltRef::new(&self.symbolic, factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }
}

/// Orders and analyses the upper triangle with this pattern.
pub(super) fn analyse(pattern: &Arc<(Vec<usize>, Vec<usize>)>, places: &[[f64; 3]]) -> Result<Analysis, LinearError> {
    let (ptr, cols) = &**pattern;
    let n = ptr.len() - 1;
    let order = ordering::nested_dissection(ptr, cols, places).map(|order| ordering::postordered(ptr, cols, &order));
    let mut inverse = vec![0usize; order.as_ref().map_or(0, Vec::len)];
    for (new, &old) in order.iter().flatten().enumerate() {
        inverse[old] = new;
    }
    let choice = match &order {
        Some(order) => SymmetricOrdering::Custom(PermRef::new_checked(order, &inverse, n)),
        None => SymmetricOrdering::Amd,
    };
    let matrix = SymbolicSparseColMatRef::new_checked(n, n, ptr, None, cols);
    let symbolic =
        cholesky::factorize_symbolic_cholesky(matrix, Side::Lower, choice, Default::default()).map_err(|_| LinearError::Memory)?;
    let fronts = match (symbolic.raw(), symbolic.perm()) {
        (SymbolicCholeskyRaw::Supernodal(s), Some(perm)) => {
            Fronts::of(s, ptr, cols, perm.arrays().1).filter(|fronts| fronts.is_profitable(symbolic.len_val()))
        }
        _ => None,
    };
    Ok(Analysis { source: None, pattern: pattern.clone(), symbolic, fronts, dissected: order.is_some() })
}
