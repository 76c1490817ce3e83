//! Sparse LU with partial pivoting, on faer: small and non-symmetric systems.

use super::faer_ldlt::buffer;
use super::refine::refine;
use super::residual::{KERNEL, kernel_ratio, row_scale, softest};
use super::{Csr, LinearError, LinearSolver, Operator, Sparsity, faer_kernels};
use faer::dyn_stack::MemStack;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};
use std::fmt;
use std::sync::Arc;

/// Rows up to which faer makes no dense products.
const FEW: usize = 16;

/// LU factorisation with refinement and a check of the residual; the order is COLAMD.
///
/// faer returns infinite or huge numbers for singular matrices; here they become [`LinearError::Singular`].
#[derive(Default)]
pub struct Lu {
    analysis: Option<Analysis>,
    numeric: Option<NumericLu<usize, f64>>,
    scale: Vec<f64>,
}

struct Analysis {
    pattern: Arc<Sparsity>,
    ptr: Vec<usize>,
    rows: Vec<usize>,
    symbolic: SymbolicLu<usize>,
}

impl fmt::Debug for Lu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lu").field("ready", &self.numeric.is_some()).finish()
    }
}

impl Lu {
    /// Creates a solver without a factor.
    pub fn new() -> Self {
        Self::default()
    }

    fn factorise(&mut self, a: &Csr<f64>) -> Result<(), LinearError> {
        self.numeric = None; // faer's storage of a larger matrix cannot take a smaller one
        let mut numeric = NumericLu::new();
        if a.vals().iter().any(|v| !v.is_finite()) {
            return Err(LinearError::NotFinite);
        }
        let n = a.num_rows();
        let transposed = a.transposed(); // rows of the transposed are columns
        if self.analysis.as_ref().is_none_or(|s| &s.pattern != transposed.pattern()) {
            let (mut ptr, mut rows) = (vec![0], Vec::with_capacity(transposed.num_entries()));
            for j in 0..n {
                rows.extend(transposed.row(j).0);
                ptr.push(rows.len());
            }
            let pattern = SymbolicSparseColMatRef::new_checked(n, n, &ptr, None, &rows);
            let symbolic = factorize_symbolic_lu(pattern, Default::default()).map_err(|_| LinearError::Memory)?;
            self.analysis = Some(Analysis { pattern: transposed.pattern().clone(), ptr, rows, symbolic });
        }
        let analysis = self.analysis.as_ref().expect("analysed above");
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &analysis.ptr, None, &analysis.rows);
        if n > FEW {
            faer_kernels::take()?;
        }
        let mut memory = buffer(analysis.symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default()))?;
        analysis
            .symbolic
            .factorize_numeric_lu(
                &mut numeric,
                SparseColMatRef::new(pattern, transposed.vals()),
                Par::Seq,
                MemStack::new(&mut memory),
                Spec::default(),
            )
            .map_err(|error| match error {
                LuError::SymbolicSingular { .. } => LinearError::Singular { residual: 1.0 },
                LuError::Generic(_) => LinearError::Memory,
            })?;
        self.numeric = Some(numeric);
        Ok(())
    }

    fn apply_inverse(&self, x: &mut [f64]) -> Result<(), LinearError> {
        let (Some(analysis), Some(numeric)) = (&self.analysis, &self.numeric) else {
            return Err(LinearError::Singular { residual: 1.0 });
        };
        let n = analysis.ptr.len() - 1;
        if x.len() != n {
            return Err(LinearError::Shape { expected: n, found: x.len() });
        }
        let mut memory = buffer(analysis.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
        LuRef::new_unchecked(&analysis.symbolic, numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }
}

impl LinearSolver<f64> for Lu {
    fn prepare(&mut self, a: &dyn Operator<f64>) -> Result<(), LinearError> {
        let matrix = a.csr().ok_or(LinearError::NoMatrix)?;
        self.scale = row_scale(a);
        if matrix.num_rows() == 0 {
            self.numeric = None;
            return Ok(());
        }
        self.factorise(matrix)?;
        let mut fault = None;
        let soft = softest(&vec![1.0; matrix.num_rows()], 2, |v| {
            if let Err(error) = self.apply_inverse(v) {
                fault = Some(error);
            }
        });
        if fault.is_some() || soft.is_none_or(|soft| kernel_ratio(matrix, &self.scale, &soft.vector) < KERNEL) {
            self.numeric = None;
            return Err(fault.unwrap_or(LinearError::Singular { residual: 1.0 }));
        }
        Ok(())
    }

    fn solve(&self, a: &dyn Operator<f64>, b: &[f64], x: &mut [f64]) -> Result<usize, LinearError> {
        if a.size() == 0 {
            return Ok(0);
        }
        refine(a, &self.scale, b, x, |r| self.apply_inverse(r))
    }
}
