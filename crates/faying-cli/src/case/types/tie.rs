//! `[[interface]]`: tied sides and their coupling.

use super::{Head, SideRef};
use crate::case::given::Given;
use crate::formula::Formula;
use crate::place::Located;
pub use faying::coupling::multiplier::Ends;

/// Multiplier space.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Multiplier {
    /// A name: `auto`, `p/p`, `p/p-2`, `constant`, `dual`, or one of a registry.
    Named(String),
    /// Degree, continuity and ends as data.
    Data {
        /// Degree.
        degree: usize,
        /// Continuity at the breakpoints, -1 is discontinuous; `None`: degree - 1.
        continuity: Option<isize>,
        /// Degree in the end elements.
        ends: Ends,
    },
}

/// `[[interface]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tie {
    /// The block.
    pub head: Head,
    /// Its name, `interface-0`, ... by default.
    pub name: Located<String>,
    /// Slave sides.
    pub slave: Vec<Located<SideRef>>,
    /// `where`: keeps only the slave's facets whose centre satisfies it.
    pub filter: Option<Located<Formula>>,
    /// Master sides.
    pub master: Vec<Located<SideRef>>,
    /// Patches whose touching sides are coupled, "all" for all; replaces slave and master.
    pub between: Option<Located<Vec<String>>>,
    /// Name of the coupling: `mortar`, `nitsche`, `penalty`, `glue`, or one of a registry.
    pub coupling: Located<String>,
    /// Multiplier.
    pub multiplier: Located<Multiplier>,
    /// Integration: `merged` (segments of both sides), `slave` (its elements), `mixed` (slave for the constraint, master for the
    /// reaction), or a rule of the registry.
    pub integration: Located<String>,
    /// Gauss points per segment beyond max(p_slave, p_master) + 1.
    pub extra_points: Located<usize>,
    /// Largest distance of the sides (a length), `None`: auto.
    pub tolerance: Located<Option<f64>>,
    /// Values of the keys of the coupling.
    pub given: Given,
    /// Exact multiplier, one formula per component.
    pub exact: Option<Located<Vec<Located<Formula>>>>,
}
