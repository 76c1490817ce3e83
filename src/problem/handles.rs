//! Handles: names of bodies, sides, regions and statements of a problem.

/// A body of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId {
    /// The problem that it belongs to.
    pub(super) problem: u64,
    /// Its number there.
    pub(super) number: usize,
}

impl BodyId {
    /// A side of the body, by a name that [`Body::sides`](crate::space::Body::sides) lists.
    pub fn side(self, name: &str) -> SideOf<'_> {
        SideOf { body: self, name }
    }
}

/// A region of a problem: a side, a part of one, an edge, a corner, or several of these as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RegionId {
    pub(super) problem: u64,
    pub(super) number: usize,
}

/// A tie of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TieId {
    pub(super) problem: u64,
    pub(super) number: usize,
}

/// A contact of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ContactId {
    pub(super) problem: u64,
    pub(super) number: usize,
}

/// A tie or a contact of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum InterfaceId {
    /// A tie.
    Tie(TieId),
    /// A contact.
    Contact(ContactId),
}

impl From<TieId> for InterfaceId {
    fn from(tie: TieId) -> Self {
        Self::Tie(tie)
    }
}

impl From<ContactId> for InterfaceId {
    fn from(contact: ContactId) -> Self {
        Self::Contact(contact)
    }
}

/// A statement of a problem: a body, a region, a tie, a contact, a support, a load, or what holds bodies together. Errors and results refer to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Statement {
    pub(super) problem: u64,
    pub(super) kind: Kind,
    pub(super) number: usize,
}

/// Kinds of statements, each numbered by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Kind {
    Body,
    Region,
    Tie,
    Contact,
    Other,
}

impl From<BodyId> for Statement {
    fn from(body: BodyId) -> Self {
        Self { problem: body.problem, kind: Kind::Body, number: body.number }
    }
}

impl From<RegionId> for Statement {
    fn from(region: RegionId) -> Self {
        Self { problem: region.problem, kind: Kind::Region, number: region.number }
    }
}

impl From<TieId> for Statement {
    fn from(tie: TieId) -> Self {
        Self { problem: tie.problem, kind: Kind::Tie, number: tie.number }
    }
}

impl From<ContactId> for Statement {
    fn from(contact: ContactId) -> Self {
        Self { problem: contact.problem, kind: Kind::Contact, number: contact.number }
    }
}

impl From<InterfaceId> for Statement {
    fn from(of: InterfaceId) -> Self {
        match of {
            InterfaceId::Tie(tie) => tie.into(),
            InterfaceId::Contact(contact) => contact.into(),
        }
    }
}

/// A side of a body of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SideOf<'a> {
    pub(super) body: BodyId,
    pub(super) name: &'a str,
}

/// The region in which a statement acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Region<'a> {
    /// A side of a body.
    Side(SideOf<'a>),
    /// A region made before.
    Made(RegionId),
}

impl<'a> From<SideOf<'a>> for Region<'a> {
    fn from(side: SideOf<'a>) -> Self {
        Self::Side(side)
    }
}

impl From<RegionId> for Region<'_> {
    fn from(region: RegionId) -> Self {
        Self::Made(region)
    }
}

/// Components of the unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Components {
    /// All of them.
    All,
    /// One of them, from 0.
    One(usize),
}

impl Components {
    /// The first coordinate.
    pub const X: Self = Self::One(0);
    /// The second coordinate.
    pub const Y: Self = Self::One(1);
    /// The third coordinate.
    pub const Z: Self = Self::One(2);
}

/// An unknown of a body: a component of the coefficient of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Unknown {
    /// The body.
    pub body: BodyId,
    /// The function of its space, from 0.
    pub function: usize,
    /// The component, from 0.
    pub component: usize,
}

/// One or several sides or parts of sides, such as the masters of a slave side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sides<'a>(pub Vec<Region<'a>>);

impl<'a, R: Into<Region<'a>>> From<R> for Sides<'a> {
    fn from(side: R) -> Self {
        Self(vec![side.into()])
    }
}

impl<'a, R: Into<Region<'a>>, const K: usize> From<[R; K]> for Sides<'a> {
    fn from(sides: [R; K]) -> Self {
        Self(sides.into_iter().map(Into::into).collect())
    }
}

impl<'a, R: Into<Region<'a>>> From<Vec<R>> for Sides<'a> {
    fn from(sides: Vec<R>) -> Self {
        Self(sides.into_iter().map(Into::into).collect())
    }
}
