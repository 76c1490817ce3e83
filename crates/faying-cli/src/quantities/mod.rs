//! Quantities: one grammar for probes, checks and tables, and their evaluation on a solved model.

mod checks;
mod cut;
mod evaluate;
mod fields;
mod grammar;
mod later;
mod lines;
mod locate;
mod path;
mod prepare;
mod prepare_sides;
pub mod reference;

pub(crate) use checks::undecided;
pub use checks::{Questions, Step, Told};
pub use cut::{CutSum, PreparedCut};
pub use evaluate::{Answer, evaluate};
pub use fields::{FieldAbout, FieldName};
pub use grammar::{At, GrammarError, Quantity, QuantityKind, Reduce};
pub use locate::{Locators, Spot};
pub use path::{known, look_up, resolve};
pub use prepare::{Prepared, Preparer, SideSpot};
