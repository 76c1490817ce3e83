//! A case as a problem, with the source locations and comparisons that the problem itself does not know.

use super::reference::Reference;
use crate::errors::Diagnostics;
use crate::place::Place;
use crate::result::GluedSides;
use faying::problem::{Condition, Model, Pin};
use std::ops::{Deref, DerefMut};

/// Source locations of conditions.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// Locations of the conditions on sides.
    pub conditions: Vec<Place>,
    /// Locations of the conditions on edges and in corners.
    pub pins: Vec<Place>,
}

impl Sources {
    /// Location of a condition, numbered as by [`faying::problem::Conditions`].
    pub fn of(&self, number: usize) -> Place {
        self.conditions.get(number).or_else(|| self.pins.get(number - self.conditions.len())).copied().unwrap_or_default()
    }
}

/// A case as a problem.
///
/// Derefs to its model. Conditions come in by `condition` and `pin`, which keep the source locations in step.
#[derive(Debug)]
pub struct Built<const S: usize, const N: usize> {
    /// The problem.
    pub model: Model<S, N>,
    /// Sides that interfaces of the case glue.
    pub glued_sides: Vec<GluedSides>,
    /// A stored run that replaces an exact solution.
    pub reference: Option<Reference<S, N>>,
    /// Source locations of its conditions.
    pub sources: Sources,
    /// Warnings found while building.
    pub warnings: Diagnostics,
}

impl<const S: usize, const N: usize> Built<S, N> {
    /// Adds a condition of a side, which the case has at `at`.
    pub(super) fn condition(&mut self, condition: Condition<S, N>, at: Place) {
        self.model.conditions.push(condition);
        self.sources.conditions.push(at);
    }

    /// Adds a condition of an edge or a corner, which the case has at `at`.
    pub(super) fn pin(&mut self, pin: Pin<N>, at: Place) {
        self.model.pins.push(pin);
        self.sources.pins.push(at);
    }
}

impl<const S: usize, const N: usize> Deref for Built<S, N> {
    type Target = Model<S, N>;
    fn deref(&self) -> &Self::Target {
        &self.model
    }
}

impl<const S: usize, const N: usize> DerefMut for Built<S, N> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.model
    }
}
