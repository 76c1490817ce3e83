//! The symbolic part of a factorisation: it depends on the pattern alone and is kept as long as that stays.

use super::{LinearError, Sparsity, ordering};
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{self, SymbolicCholesky, SymmetricOrdering};
use std::sync::Arc;

/// An order of the unknowns and the places of the factor's numbers.
pub(super) struct Analysis {
    /// The pattern of both triangles, where the matrix came so.
    pub source: Option<Arc<Sparsity>>,
    /// The pattern of the upper triangle.
    pub pattern: Arc<(Vec<usize>, Vec<usize>)>,
    pub symbolic: SymbolicCholesky<usize>,
    /// Whether places were used.
    pub dissected: bool,
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
    Ok(Analysis { source: None, pattern: pattern.clone(), symbolic, dissected: order.is_some() })
}
