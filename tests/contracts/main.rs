//! Every implementor of the crate's traits passes the public checkers of `faying::check`.
//!
//! One module per floor; each test instantiates the checkers for its own implementors.

mod bodies;
mod net;
