//! Findings of a search, and its errors.

use super::facing::Facing;
use crate::linalg::Vector;
use crate::problem::model::BodySide;
use crate::space::{Clearance, SideError};
use std::sync::Arc;

/// Two sides of different bodies that face each other.
#[derive(Clone, Debug)]
pub struct NearPair<const S: usize, const N: usize> {
    /// The sides.
    pub sides: [Arc<BodySide<S, N>>; 2],
    /// Their distance, seen from the side of which the larger share faces the other.
    pub facing: Facing,
}

/// Position of two sides to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Position {
    /// They touch.
    Touch,
    /// They are this far apart in the mean \[length\].
    Apart(f64),
    /// They are this deep in each other in the mean \[length\].
    Overlap(f64),
}

/// A finding that is worth a warning.
#[derive(Clone, Debug)]
pub enum Finding<const S: usize, const N: usize> {
    /// Sides that nearly touch and are not tied, because their facets do not explain their distance.
    NotTied {
        /// The sides.
        sides: [Arc<BodySide<S, N>>; 2],
        /// Their distance.
        clearance: Clearance,
    },
    /// Named sides that are tied though their facets do not explain their distance.
    NotExplained {
        /// The slave.
        slave: Arc<BodySide<S, N>>,
        /// Its masters.
        masters: Vec<Arc<BodySide<S, N>>>,
        /// Their distance.
        clearance: Clearance,
    },
    /// Sides that may have been meant to be tied, as near as [`NEAR`](super::NEAR) and [`THIN`](super::THIN) say.
    Near(NearPair<S, N>),
    /// Sides that touch, nearly touch or overlap, and that nothing joins; of one body if they would close it to a ring.
    Unjoined {
        /// The sides.
        sides: [Arc<BodySide<S, N>>; 2],
        /// Their position to each other.
        position: Position,
    },
    /// Bodies that overlap and that nothing joins.
    Overlap {
        /// The bodies.
        patches: [usize; 2],
        /// The middle of an element of one that lies in the other \[length\].
        x: Vector<N>,
    },
}

impl<const S: usize, const N: usize> Finding<S, N> {
    /// The bodies that it concerns, of several masters that of the first.
    pub fn patches(&self) -> [usize; 2] {
        match self {
            Self::NotTied { sides, .. } | Self::Near(NearPair { sides, .. }) | Self::Unjoined { sides, .. } => {
                sides.each_ref().map(|side| side.patch)
            }
            Self::NotExplained { slave, masters, .. } => [slave.patch, masters.first().map_or(slave.patch, |m| m.patch)],
            Self::Overlap { patches, .. } => *patches,
        }
    }
}

/// Error of a search among bodies.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TouchError<const S: usize, const N: usize> {
    /// A side cannot be made.
    #[error("side `{side}` of body {patch}: {error}")]
    Side {
        /// The body.
        patch: usize,
        /// Name of the side.
        side: String,
        /// The error of the body.
        error: SideError,
    },
    /// Of sides with common facets one touches another on facets of which the others have none.
    #[error("`{}` touches `{}` beyond the sides with which it shares facets", .sides[0].label, .sides[1].label)]
    Beyond {
        /// The side, and the one it touches.
        sides: [Arc<BodySide<S, N>>; 2],
    },
    /// No sides touch that are not joined yet.
    #[error("no sides of the bodies touch each other that are not joined yet")]
    Nothing {
        /// The sides that come nearest to each other, if there are any.
        nearest: Option<NearPair<S, N>>,
    },
}
