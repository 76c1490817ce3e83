//! Segments of surfaces in space: tilings, columns of both sides, gaps, poles, random pairs.
#![allow(clippy::unwrap_used)]

mod battery;
mod common;
mod curved;
mod flat;
mod gaps;
mod poles;
mod threads;
