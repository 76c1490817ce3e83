//! Side pairs of interfaces.

use super::builder::Builder;
use crate::place::Place;
use crate::registry::is_glue;
use faying::problem::SideModel;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A slave side with its masters.
#[derive(Clone, Debug)]
pub(super) struct Couple<const S: usize, const N: usize> {
    pub slave: Arc<SideModel<S, N>>,
    pub masters: Vec<Arc<SideModel<S, N>>>,
    /// Source location in the case.
    pub at: Place,
    /// Largest admissible distance of the sides, if given \[length\].
    pub tolerance: Option<f64>,
    /// Whether the case names slave and masters, so that they are meant to be tied.
    pub is_named: bool,
    /// Largest admissible distance of points, if faceting explains the distance of the sides \[length\].
    pub explained: Option<f64>,
}

/// Side pairs of every interface in the order of the case; those of closed patches and multi-patch files are listed separately.
#[derive(Debug)]
pub(super) struct Couples<const S: usize, const N: usize> {
    /// Side pairs of each interface.
    pub ties: Vec<Vec<Couple<S, N>>>,
    /// Side pairs glued without an interface: closed patches, files of several patches, groups of one mesh.
    pub seams: Vec<Couple<S, N>>,
    /// All sides (patch, name) of both lists.
    pub sides: BTreeSet<(usize, String)>,
}

impl<const S: usize, const N: usize> Couples<S, N> {
    /// Whether a side is coupled to another.
    pub fn hold(&self, patch: usize, side: &str) -> bool {
        self.sides.contains(&(patch, side.to_owned()))
    }

    /// Side pairs with shared functions: `coupling = "glue"`, closed patches, files.
    pub fn glued<'a>(&'a self, builder: &'a Builder<'_, S, N>) -> impl Iterator<Item = &'a Couple<S, N>> {
        let ties = self.ties.iter().zip(&builder.case.interfaces).filter(|(_, tie)| is_glue(&tie.coupling.value));
        ties.flat_map(|(couples, _)| couples).chain(&self.seams)
    }
}

/// Two sides (patch, name), the lesser first.
pub(super) type Pair = [(usize, String); 2];

pub(super) fn pair(a: (usize, String), b: (usize, String)) -> Pair {
    if a <= b { [a, b] } else { [b, a] }
}
