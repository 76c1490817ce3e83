//! Floor 11: case files, geometry and mesh files, formulas, errors with places, tables, pictures. Computes nothing.

pub mod case;
pub mod codes;
pub mod errors;
pub mod files;
pub mod formula;
pub mod place;
pub mod plot;
pub mod pvd;
pub mod reference;
pub mod table;
pub mod vtu;

pub use case::Case;
pub use errors::{Diagnostic, Diagnostics, Severity};
pub use formula::Formula;
pub use place::{Located, Place};
