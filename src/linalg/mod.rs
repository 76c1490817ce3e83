//! Floor 1: scalars, small and sparse matrices, linear solvers. Knows no module above it.

mod csr;
mod faer_ldlt;
mod faer_lu;
mod gmres;
mod krylov;
mod limits;
mod minres;
mod operator;
pub mod ordering;
mod precondition;
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
pub use gmres::Gmres;
pub(crate) use gmres::gmres;
pub use krylov::Cg;
pub(crate) use krylov::{conjugate_gradients, meets_kernel};
pub use limits::{Limits, StopSign};
pub use minres::Minres;
pub(crate) use minres::minres;
pub use operator::Operator;
pub use precondition::Preconditioner;
pub(crate) use precondition::gauss_seidel;
pub use product::{product, sum};
pub use real::{Matrix, Real, Vector, lit, num, to_f64};
pub use small::{determinant, inverse, measure};
pub use solver::{LinearError, LinearSolver};
pub use triplets::Triplets;
