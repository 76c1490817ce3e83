//! Contact from case files: states, iterations, measures.
#![allow(clippy::unwrap_used)]

mod active_set;
mod blocked;
mod bodies_in_space;
mod by_program;
mod carried;
mod common;
mod cones;
mod contact_benchmarks;
mod contact_invariance;
mod contact_methods;
mod contact_models;
mod dual_covered;
mod ends;
mod few_systems;
mod graded_contact;
mod half_width;
mod held_in_part;
mod in_space;
mod nitsche_points;
mod obstacles;
mod one_factor;
mod opposed;
mod own_entries;
mod revolution;
mod shaped_in_space;
mod thin;
