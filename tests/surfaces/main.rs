//! Segments of surfaces in space: tilings, columns of both sides, gaps, poles, random pairs.
#![allow(clippy::unwrap_used)]

mod common;
mod curved;
mod flat;
mod gaps;
