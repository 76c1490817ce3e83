//! Patches and sides that come from one file.

use super::types::SideRef;
use std::ops::Range;

/// Sides under a name that the file gives them.
#[derive(Clone, Debug)]
pub(crate) struct Label {
    /// The name.
    pub name: String,
    /// The sides.
    pub sides: Vec<SideRef>,
}

/// The patches of one file under the name of their block.
#[derive(Clone, Debug)]
pub(crate) struct Family {
    /// The name of the block.
    pub name: String,
    /// Its patches.
    pub patches: Range<usize>,
    /// Names of sides.
    pub labels: Vec<Label>,
}
