//! Contract tests for the public traits: run them on your own implementors.
//!
//! Each checker returns `Err` with a sentence that names the broken rule and the place.

mod basis;
mod block;
mod body;
mod contact_method;
mod continuation;
mod continuous;
mod coupling;
mod flux;
mod geometry;
mod interface_quadrature;
mod linear_solver;
mod material;
mod obstacle;
mod operator;
mod points;
mod quadrature;
mod reference;
mod solver;
mod space;

pub use basis::{basis, non_negative, partition_of_unity};
pub use body::{body, closed_body};
pub use contact_method::contact_method;
pub use coupling::coupling;
pub use flux::flux;
pub use geometry::geometry;
pub use interface_quadrature::{SegmentLimits, interface_quadrature};
pub use linear_solver::linear_solver;
pub use material::material;
pub use obstacle::obstacle;
pub use operator::operator;
pub use quadrature::quadrature;
pub use solver::{contact_solver, solver};
pub use space::space;
