//! Contract tests for the public traits: run them on your own implementors.
//!
//! Each checker returns `Err` with a sentence that says which rule is broken and where.

mod flux;
mod material;

pub use flux::flux;
pub use material::material;
