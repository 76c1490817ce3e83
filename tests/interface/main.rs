//! Interfaces: segments, multipliers, ties, contact, and the solvers of their systems.
#![allow(clippy::unwrap_used)]

mod common;
mod contact;
mod dual;
mod inf_sup;
mod interface_quadrature;
mod lessons;
mod merging;
mod mesh_tied;
mod obstacle;
mod patch_test_tied;
mod solvers;
mod third_backend;
