//! Names of bodies and sides in a problem.

/// A body of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// A side of a body of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SideOf<'a> {
    pub(super) body: BodyId,
    pub(super) name: &'a str,
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

/// One or several sides, such as the masters of a slave side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sides<'a>(pub Vec<SideOf<'a>>);

impl<'a> From<SideOf<'a>> for Sides<'a> {
    fn from(side: SideOf<'a>) -> Self {
        Self(vec![side])
    }
}

impl<'a, const K: usize> From<[SideOf<'a>; K]> for Sides<'a> {
    fn from(sides: [SideOf<'a>; K]) -> Self {
        Self(sides.into())
    }
}

impl<'a> From<Vec<SideOf<'a>>> for Sides<'a> {
    fn from(sides: Vec<SideOf<'a>>) -> Self {
        Self(sides)
    }
}
