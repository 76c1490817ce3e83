//! Case files as a whole: reading, running, stored references, families of mutants.
#![allow(clippy::unwrap_used)]

mod battery;
mod bulk_terms;
mod case_files;
mod curved_neighbours;
mod error_norms;
mod exact_per_patch;
mod extremes;
mod left_out;
mod loads;
mod low_order;
mod magnitudes;
mod mesh_places;
mod mutated_files;
mod mutated_runs;
mod parity;
mod point_loads;
#[path = "../../../../tests/common/random.rs"]
mod random;
mod reference;
mod rough_models;
mod run;
mod said_at_once;
mod supports;
mod unjoined;
mod volume;
