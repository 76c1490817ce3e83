//! Sides whose facets do not explain their distance.

/// Sides whose facets do not explain their distance: named ones that are tied all the same, or sides that nearly touch and are not.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetsApart {
    /// Labels of the sides, of a tie the slave first.
    pub sides: Vec<String>,
    /// The mean distance \[length\].
    pub mean: f64,
    /// The greatest distance \[length\].
    pub greatest: f64,
    /// The mean distance that the facets explain \[length\].
    pub explained: f64,
    /// Whether they are tied.
    pub is_tied: bool,
}
