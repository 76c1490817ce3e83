//! A case as a problem, with the source locations and comparisons that the problem itself does not know.

use super::places::Places;
use crate::errors::Diagnostics;
use crate::reference::Reference;
use crate::result::GluedSides;
use faying::problem::{Model, System};
use std::ops::Deref;

/// A case as a problem. Derefs to its model.
#[derive(Debug)]
pub struct Built<const S: usize, const N: usize> {
    /// The problem.
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

impl<const S: usize, const N: usize> Deref for Built<S, N> {
    type Target = Model<S, N>;
    fn deref(&self) -> &Self::Target {
        self.system.model()
    }
}
