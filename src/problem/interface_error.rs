//! Errors of ties and contacts.

use crate::contact::{ContactError, MethodError};
use crate::coupling::CouplingError;
use crate::coupling::multiplier::MultiplierError;

/// A tie or a contact cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InterfaceError {
    /// A contact without a master.
    #[error("there is no master side")]
    NoMaster,
    /// A method of contact whose own numbers are wrong.
    #[error(transparent)]
    Method(MethodError),
    /// A method of contact that does not accept what was asked for.
    #[error("this method of contact accepts {}", refused(*.pressed, *.mixed))]
    Refused {
        /// Whether it is an obstacle that a force presses.
        pressed: bool,
        /// Whether it is mixed integration.
        mixed: bool,
    },
    /// Sides that do not meet.
    #[error("the sides do not meet: {0}")]
    Apart(CouplingError),
    /// A slave side of a tie that its masters do not cover.
    #[error("only {} % of the slave side meets its masters", 100.0 * .share)]
    Uncovered {
        /// Covered share of the slave side.
        share: f64,
    },
    /// A slave side of a tie that two of its masters cover.
    #[error("two masters cover the same {} % of the slave side", 100.0 * .share)]
    Doubled {
        /// Share of the slave side that is covered twice.
        share: f64,
    },
    /// Segments that cannot be built, or that are not sound.
    #[error(transparent)]
    Segments(CouplingError),
    /// Blocks of a coupling that cannot be built.
    #[error(transparent)]
    Coupling(CouplingError),
    /// Rows of a contact that cannot be built.
    #[error(transparent)]
    Contact(ContactError),
    /// A gap that is no number at a point of the slave side.
    #[error("{} (t = {t})", ContactError::Gap { at: *.at, geometric: *.geometric })]
    Gap {
        /// The point \[length\]; coordinates beyond the dimension are zero.
        at: [f64; 3],
        /// The geometric gap there \[length\]; where it is no number the obstacle has none.
        geometric: f64,
        /// The time.
        t: f64,
    },
    /// An obstacle that looks the same way as the slave side at a time at which nothing of it faces the side: it was turned round.
    #[error("the obstacle looks the same way as the slave side at t = {t}")]
    TurnedRound {
        /// The time.
        t: f64,
    },
    /// A side of a tie or a contact by fluxes that carries something else in the same points: its stress is not that of the interface alone.
    #[error("this method takes the stress of `{side}` for what crosses the interface, but the side {carried}, too")]
    Carries {
        /// The side.
        side: String,
        /// A load, springs, a support or another interface.
        carried: Carried,
    },
    /// A slave side of which no point faces the opponent.
    #[error("no part of the slave side faces the opponent")]
    NothingFaces,
    /// A slave side without a free unknown in components or, if it is that of a contact, along the normal.
    #[error("the slave side has no free unknown in components {components:?}")]
    Held {
        /// The components; of contacts those that the normals have.
        components: Vec<usize>,
        /// Whether equations between components hold functions of the side.
        by_equations: bool,
    },
    /// A slave side of a contact of which every function lies on another slave side of the body, too.
    #[error("all functions of the slave side lie on other slave sides, too: no multiplier is left for it")]
    Shared,
    /// A multiplier that does not exist on the slave side.
    #[error("{error}")]
    Multiplier {
        /// Its component; `None` of contacts.
        component: Option<usize>,
        /// The reason.
        error: MultiplierError,
    },
    /// More multipliers of a component than free unknowns.
    #[error("{0}")]
    Counts(MultiplierError),
    /// More multipliers of a contact than free unknowns along the normal.
    #[error("the normal direction has {multipliers} functions for {free} free unknowns")]
    TooMany {
        /// Number of multipliers.
        multipliers: usize,
        /// Number of free unknowns.
        free: usize,
        /// Components that the normals have.
        components: Vec<usize>,
        /// Whether equations between components hold functions of the side.
        by_equations: bool,
    },
}

/// A load, springs, a support or another interface that a side carries beside its own.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Carried {
    /// A load, by its name.
    #[error("has the load \"{0}\"")]
    Load(String),
    /// Springs, by their name.
    #[error("has the springs \"{0}\"")]
    Spring(String),
    /// A support in a direction in which the other side may move.
    #[error("is held")]
    Support,
    /// A tie or a contact, by its name.
    #[error("belongs to \"{0}\" in the same points")]
    Interface(String),
}

/// A choice that a method does not accept, in words.
fn refused(pressed: bool, mixed: bool) -> &'static str {
    match (pressed, mixed) {
        (true, true) => "neither an obstacle that a force presses nor mixed integration",
        (true, false) => "no obstacle that a force presses",
        _ => "no mixed integration",
    }
}
