//! Surfaces: their multipliers, and contact of bodies in space with rigid obstacles.
#![allow(clippy::unwrap_used)]

mod bodies;
#[path = "../common/cells.rs"]
mod cells;
mod extruded;
mod multipliers;
mod obstacles;
mod pressed;
mod zones;
