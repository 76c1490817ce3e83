//! Every implementor of the crate's traits passes the public checkers of `faying::check`.
//!
//! One module per floor; each test instantiates the checkers for its own implementors.
#![allow(clippy::unwrap_used)]

mod allocation;
mod basis;
mod bodies;
mod floors;
mod forwarding;
mod geometry;
mod net;
mod quadrature;
#[path = "../common/random.rs"]
mod random;
mod splines;
