//! A case as a system, with the source locations and comparisons that the system itself does not know.

use super::places::Places;
use crate::case::SideRef;
use crate::errors::Diagnostics;
use crate::reference::Reference;
use crate::result::GluedSides;
use faying::problem::System;
use std::collections::HashMap;

/// A case as a system.
#[derive(Debug)]
pub struct LoweredCase<const S: usize, const N: usize> {
    /// The system.
    pub system: System<S, N>,
    /// Sides that interfaces of the case glue.
    pub glued_sides: Vec<GluedSides>,
    /// The sides of "all-outer" that are joined, with the measure of what nothing joins of them \[length^(dimension - 1)\].
    pub free_measures: HashMap<SideRef, f64>,
    /// A stored run that replaces an exact solution.
    pub reference: Option<Reference<S, N>>,
    /// Source locations of its statements.
    pub places: Places,
    /// Warnings found while building.
    pub warnings: Diagnostics,
}
