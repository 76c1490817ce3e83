//! Ties and contacts of a system, their slave sides, and what these are paired with.

use super::data::Data;
use super::handles::InterfaceId;
use super::model::{BodySide, ContactModel, ContactPart, Opposing, TieModel, TiePart};
use crate::basis::Basis;
use crate::contact::Obstacle;
use crate::coupling::Segments;
use crate::linalg::NO_SYMMETRY;
use std::ops::Range;

/// A tie or a contact of a system.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceView<'a, const S: usize, const N: usize>(Of<'a, S, N>);

#[derive(Clone, Copy, Debug)]
enum Of<'a, const S: usize, const N: usize> {
    Tie(&'a TieModel<S, N>),
    Contact(&'a ContactModel<S, N>),
}

impl<'a, const S: usize, const N: usize> InterfaceView<'a, S, N> {
    pub(super) fn of_tie(tie: &'a TieModel<S, N>) -> Self {
        Self(Of::Tie(tie))
    }

    pub(super) fn of_contact(contact: &'a ContactModel<S, N>) -> Self {
        Self(Of::Contact(contact))
    }

    /// Its handle.
    pub fn id(&self) -> InterfaceId {
        match self.0 {
            Of::Tie(tie) => tie.id.into(),
            Of::Contact(contact) => contact.id.into(),
        }
    }

    /// Its name.
    pub fn name(&self) -> &'a str {
        match self.0 {
            Of::Tie(tie) => &tie.name,
            Of::Contact(contact) => &contact.name,
        }
    }

    /// Its own exact multiplier, one function per component, of contacts one; empty without.
    pub fn exact(&self) -> &'a [Data] {
        match self.0 {
            Of::Tie(tie) => tie.exact.as_deref().unwrap_or_default(),
            Of::Contact(contact) => contact.exact.as_slice(),
        }
    }

    /// Whether it faces a rigid obstacle.
    pub fn has_obstacle(&self) -> bool {
        matches!(self.0, Of::Contact(contact) if contact.obstacle.is_some())
    }

    /// The rigid obstacle that it faces where it is at time `t`; its places where forces press it are those of `unknowns`, zero without any.
    /// `None` between bodies.
    pub fn obstacle(&self, t: f64, unknowns: Option<&[f64]>) -> Option<Box<dyn Obstacle<S, N>>> {
        match self.0 {
            Of::Contact(contact) => contact.obstacle.as_ref().map(|obstacle| obstacle.target(t, unknowns)),
            Of::Tie(_) => None,
        }
    }

    /// Its slave sides, those with kinks as their pieces; of a contact those that face something.
    pub fn sides(&self) -> Vec<SlaveSide<'a, S, N>> {
        match self.0 {
            Of::Tie(tie) => tie.parts.iter().map(|part| SlaveSide { part: Part::Tie(part) }).collect(),
            Of::Contact(contact) => contact.parts.iter().map(|part| SlaveSide { part: Part::Contact(part) }).collect(),
        }
    }

    /// Slave sides of a contact, by their places in the statement, that face nothing while others do.
    pub fn idle(&self) -> &'a [usize] {
        match self.0 {
            Of::Tie(_) => &[],
            Of::Contact(contact) => &contact.idle,
        }
    }

    /// Whether it leaves the system symmetric, at the first time.
    pub fn is_symmetric(&self) -> bool {
        match self.0 {
            Of::Tie(tie) => tie.parts.iter().all(|p| p.reaction.is_none() && p.stiffness.to_csr().is_symmetric(NO_SYMMETRY)),
            Of::Contact(contact) => contact.parts.iter().all(|p| p.first.reaction.is_none()),
        }
    }

    /// Whether its integration is mixed: other points for the master than for the slave.
    pub fn is_mixed(&self) -> bool {
        match self.0 {
            Of::Tie(tie) => tie.parts.iter().any(|part| part.reaction.is_some()),
            Of::Contact(contact) => contact.parts.iter().any(|part| part.second.is_some()),
        }
    }

    /// Whether its rows belong to points, of which there may be more than unknowns.
    pub fn has_rows_at_points(&self) -> bool {
        matches!(self.0, Of::Contact(contact) if contact.parts.iter().any(|part| part.first.row_of_points().is_some()))
    }
}

/// A slave side of a tie or a contact.
#[derive(Clone, Copy, Debug)]
pub struct SlaveSide<'a, const S: usize, const N: usize> {
    part: Part<'a, S, N>,
}

#[derive(Clone, Copy, Debug)]
enum Part<'a, const S: usize, const N: usize> {
    Tie(&'a TiePart<S, N>),
    Contact(&'a ContactPart<S, N>),
}

impl<'a, const S: usize, const N: usize> SlaveSide<'a, S, N> {
    /// The side.
    pub fn side(&self) -> &'a BodySide<S, N> {
        match self.part {
            Part::Tie(part) => &part.slave,
            Part::Contact(part) => &part.slave,
        }
    }

    /// Its place, from 0, among the slave sides of the statement; pieces of one side between kinks have the same.
    pub fn number(&self) -> usize {
        match self.part {
            Part::Tie(part) => part.number,
            Part::Contact(part) => part.number,
        }
    }

    /// Its multipliers: of ties one space per component, of contacts one; none where the method has no multiplier.
    pub fn multipliers(&self) -> Vec<&'a dyn Basis<S>> {
        match self.part {
            Part::Tie(part) => part.multipliers.iter().map(|m| &**m).collect(),
            Part::Contact(part) => part.multiplier.as_deref().into_iter().collect(),
        }
    }

    /// The functions through which lambda is read at points, in place of [`multipliers`](Self::multipliers) and with their coefficients.
    pub fn read_through(&self) -> Vec<&'a dyn Basis<S>> {
        match self.part {
            Part::Tie(_) => self.multipliers(),
            Part::Contact(part) => part.read_through().into_iter().collect(),
        }
    }

    /// (p, k) if the multiplier is the unstable pairing p/p-k under another name.
    pub fn unstable(&self) -> Option<(usize, usize)> {
        match self.part {
            Part::Tie(part) => part.unstable,
            Part::Contact(part) => part.unstable,
        }
    }

    /// Its rows among those of the system.
    pub fn rows(&self) -> Range<usize> {
        match self.part {
            Part::Tie(part) => part.first_row..part.first_row + part.num_rows,
            Part::Contact(part) => part.rows(),
        }
    }

    /// The master sides, each with its common segments; of a contact all as one, against an obstacle none.
    pub fn pairs(&self) -> Vec<PairView<'a, S, N>> {
        match self.part {
            Part::Tie(part) => part.pairings.iter().map(|p| PairView { master: &p.master, segments: &p.segments }).collect(),
            Part::Contact(part) => match &part.against {
                Opposing::Side(master, segments) => vec![PairView { master, segments }],
                Opposing::Rigid(..) => Vec::new(),
            },
        }
    }
}

/// A master side of a slave side.
#[derive(Clone, Copy, Debug)]
pub struct PairView<'a, const S: usize, const N: usize> {
    master: &'a BodySide<S, N>,
    segments: &'a Segments<S>,
}

impl<'a, const S: usize, const N: usize> PairView<'a, S, N> {
    /// The master side.
    pub fn master(&self) -> &'a BodySide<S, N> {
        self.master
    }

    /// Largest distance of paired points at rest \[length\].
    pub fn distance(&self) -> f64 {
        self.segments.report.distance
    }

    /// Measure of the slave side [length^S].
    pub fn slave_measure(&self) -> f64 {
        self.segments.report.slave_measure
    }

    /// Measure of the slave side that faces the master [length^S].
    pub fn covered(&self) -> f64 {
        self.segments.report.covered
    }
}
