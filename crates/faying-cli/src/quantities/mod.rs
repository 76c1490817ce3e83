//! Quantities: one grammar for probes, checks and tables, and their evaluation on a solved model.

mod checks;
mod evaluate;
mod grammar;
mod locate;
mod path;
mod prepare;
pub mod reference;

pub use checks::Questions;
pub(crate) use checks::undecided;
pub use evaluate::{Answer, evaluate};
pub use grammar::{At, FieldName, GrammarError, Quantity, QuantityKind, Reduce};
pub use locate::{Locators, Spot};
pub use path::{known, look_up, resolve};
pub use prepare::{Prepared, Preparer, SideSpot};
