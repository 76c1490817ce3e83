//! Interfaces: segments, multipliers, ties, contact, and the solvers of their systems.
#![allow(clippy::unwrap_used)]

mod abilities;
mod answers;
mod auto_multiplier;
mod changing_materials;
mod common;
mod contact;
mod contact_methods;
mod dual;
mod exact_answers;
mod faults;
mod held_and_loaded;
mod inf_sup;
mod interface_quadrature;
mod level_set;
mod merging;
mod mesh_tied;
mod obstacle;
mod patch_test_tied;
mod problems;
#[path = "../common/random.rs"]
mod random;
mod solvers;
mod statements;
mod touching;
mod warnings;
