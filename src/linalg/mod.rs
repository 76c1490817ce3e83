//! Floor 1: scalars, small and sparse matrices, linear solvers. Knows no module above it.

mod csr;
mod faer_ldlt;
mod faer_lu;
mod krylov;
mod operator;
pub mod ordering;
mod product;
mod real;
pub(crate) mod residual;
mod small;
pub(crate) mod solver;
mod triplets;

pub use csr::Csr;
pub use faer_ldlt::Ldlt;
pub(crate) use faer_ldlt::Upper;
pub use faer_lu::Lu;
pub use krylov::Cg;
pub use operator::Operator;
pub use product::product;
pub use real::{Matrix, Real, Vector, lit, num, to_f64};
pub use small::{determinant, inverse, measure};
pub use solver::{LinearError, LinearSolver};
pub use triplets::Triplets;
