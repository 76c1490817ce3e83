//! Studies: one case solved several times, a row each, in one table.
//!
//! A row is the case read again with [`Changes`](crate::io::case::Changes) and solved by the code of `run`. A study is the list of rows that
//! its [`Axes`] span, and what is asked of them; every command on studies shares the rows, the table, the files.

mod axes;
mod document;
mod quantities;
mod rates;
mod report;
mod rows;

pub use axes::{Axes, Degrees, Vary, split};
pub use document::{Study, Tolerance};
pub use quantities::{Asked, asked};
pub use report::{html, picture};
pub use rows::{Base, Row, Spec, slaves};
