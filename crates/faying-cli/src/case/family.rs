//! Patches and sides that come from one file.

use super::types::SideRef;
use std::ops::Range;
use std::path::PathBuf;

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

/// Data of a `[[patch]]` read from a file, beside its parts, until it is expanded.
#[derive(Debug, Default)]
pub(super) struct FromFile {
    /// Source of its cells, for meshes: patches of equal sources share their common facets and points.
    pub mesh: Option<MeshSource>,
    /// Sides by their names in the file, as indices into the list of parts.
    pub labels: Vec<(String, Vec<(usize, String)>)>,
}

/// A mesh file and the transformation of its points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MeshSource {
    pub path: PathBuf,
    pub scale: Option<f64>,
    pub rotate_deg: Option<f64>,
    pub axis: Option<Vec<f64>>,
    pub translate: Option<Vec<f64>>,
}
