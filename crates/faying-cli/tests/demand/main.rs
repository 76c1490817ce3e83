//! What a case asks for, and what it says of parts of sides: quantities, lines, steps, `where` and `adjust`.
#![allow(clippy::unwrap_used)]

mod along_lines;
mod asked_steps;
mod cuts;
mod parts_of_sides;
mod quantities;
