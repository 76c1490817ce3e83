//! Contract tests for the public traits: run them on your own implementors.
//!
//! Each checker returns `Err` with a sentence that says which rule is broken and where.

mod body;
mod coupling;
mod flux;
mod geometry;
mod interface_quadrature;
mod linear_solver;
mod material;
mod operator;
mod solver;
mod space;
mod target;

pub use body::{body, closed_body};
pub use coupling::coupling;
pub use flux::flux;
pub use geometry::geometry;
pub use interface_quadrature::{SegmentLimits, interface_quadrature};
pub use linear_solver::linear_solver;
pub use material::material;
pub use operator::operator;
pub use solver::solver;
pub use space::space;
pub use target::target;
