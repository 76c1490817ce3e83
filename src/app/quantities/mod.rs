//! Quantities: one grammar for probes, checks and tables, and their evaluation on a solved model.

mod grammar;
mod path;

pub use grammar::{At, FieldName, GrammarError, Kind, Quantity, Reduce};
pub use path::{known, look_up, resolve};
