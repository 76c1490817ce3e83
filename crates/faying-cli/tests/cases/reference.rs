//! Case files under reference/: published ones, and those of the problems that FEniCSx solves, too.

#[path = "reference/documents.rs"]
mod documents;
#[path = "reference/published.rs"]
mod published;
