//! Search for sides that touch: slaves with their masters, sides that nearly touch, sides and bodies that nothing joins.
//!
//! [`Search`] is asked in this order: sides that are glued, sides that are tied by name, lists of bodies, all bodies. It remembers the
//! facets that are joined, and does not find them again. What is worth a warning is collected in [`Search::findings`].

mod facing;
mod finding;
mod joined_sides;
mod lengths;
mod named;
mod nearest;
mod oriented;
mod overlapping;
mod paired_sides;
mod pairs;
mod partly_joined;
mod search;
mod touching_sides;
mod unjoined;

pub use facing::{Facing, facing};
pub use finding::{Finding, NearPair, Position, TouchError};
pub(super) use lengths::{explained, floor, sag};
pub use nearest::{NEAR, THIN};
pub use paired_sides::{PairedSides, Share};
pub use search::Search;
