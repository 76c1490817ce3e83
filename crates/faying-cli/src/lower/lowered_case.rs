//! A case as a system, with the source locations and comparisons that the system itself does not know.

use super::places::Places;
use crate::errors::Diagnostics;
use crate::reference::Reference;
use crate::result::GluedSides;
use faying::problem::System;

/// A case as a system.
#[derive(Debug)]
pub struct LoweredCase<const S: usize, const N: usize> {
    /// The system.
    pub system: System<S, N>,
    /// Sides that interfaces of the case glue.
    pub glued_sides: Vec<GluedSides>,
    /// A stored run that replaces an exact solution.
    pub reference: Option<Reference<S, N>>,
    /// Source locations of its statements.
    pub places: Places,
    /// Warnings found while building.
    pub warnings: Diagnostics,
}
