//! Floor 1: scalars, small and sparse matrices, linear solvers. Knows no module above it.

mod csr;
mod operator;
mod real;
mod small;
mod solver;
mod triplets;

pub use csr::Csr;
pub use operator::Operator;
pub use real::{Matrix, Real, Vector, lit, num, to_f64};
pub use small::{determinant, inverse, measure};
pub use solver::{LinearError, LinearSolver};
pub use triplets::Triplets;
