//! Bulk matrices, loads and norms of all spaces, against each other and against exact numbers.
#![allow(clippy::unwrap_used)]

mod assembly;
mod common;
mod convergence;
mod glued_assembly;
mod lanes;
mod lower_order;
mod matrix_free;
mod mesh_cells;
mod multipatch;
mod ordering;
mod patch_test;
mod states;
mod storage;
mod straight;
mod sums_on_patches;
mod tensor;
