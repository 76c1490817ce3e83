//! Studies: one case solved several times, a row each, in one table.
//!
//! A row is the case read again with [`Changes`](crate::case::Changes) and solved by a [`Method`]: the code of `run`, or another
//! computation. A study is the list of rows that its [`Axes`] span, and the quantities to evaluate; all commands on studies share the
//! rows, the table, the files.

mod axes;
mod choice;
mod constants;
mod csv;
mod document;
mod method;
mod picture;
mod quantities;
mod rates;
mod reading;
mod report;
mod rows;
mod stored_rows;
mod study;
mod table;

pub use axes::{Axes, MOST_ROWS};
pub use choice::{Degrees, Vary, repeated, split};
pub use method::{Method, Runs};
pub use picture::picture;
pub use quantities::{Asked, asked};
pub(crate) use rates::decided;
pub use report::html;
pub use rows::{Base, Row, Spec, slaves};
pub use stored_rows::StoredRows;
pub use study::{Study, StudyPlan, Tolerance};
