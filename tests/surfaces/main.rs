//! Surfaces: segments of two sides in space, multipliers, and contact of bodies in space with rigid obstacles and with each other.
#![allow(clippy::unwrap_used)]

mod battery;
mod bodies;
#[path = "../common/cells.rs"]
mod cells;
mod common;
mod curved;
mod curved_neighbours;
mod curved_supports;
mod doubts;
mod dual;
mod evaluations;
mod extruded;
mod flat;
mod gaps;
mod hertz;
mod lists;
mod mixed;
mod moments;
mod moved;
mod multipliers;
mod obstacles;
mod poles;
mod press_fit;
mod pressed;
mod rims;
mod shaped;
mod slave_rule;
mod stacked;
mod thin;
mod threads;
mod tied;
mod turning;
mod zones;
