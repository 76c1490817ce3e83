//! Contract tests for the public traits: run them on your own implementors.
//!
//! Each checker returns `Err` with a sentence that says which rule is broken and where.

mod coupling;
mod flux;
mod interface_quadrature;
mod material;
mod target;

pub use coupling::coupling;
pub use flux::flux;
pub use interface_quadrature::{SegmentLimits, interface_quadrature};
pub use material::material;
pub use target::target;
