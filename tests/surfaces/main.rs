//! Surfaces: segments of two sides in space, multipliers, and contact of bodies in space with rigid obstacles.
#![allow(clippy::unwrap_used)]

mod battery;
mod bodies;
#[path = "../common/cells.rs"]
mod cells;
mod common;
mod curved;
mod extruded;
mod flat;
mod gaps;
mod multipliers;
mod obstacles;
mod poles;
mod pressed;
mod threads;
mod tied;
mod zones;
