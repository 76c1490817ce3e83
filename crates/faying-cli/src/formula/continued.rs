//! Numbers that continue the piece of a formula beyond its end: every choice between pieces is made at another point.

use super::number::{Binary, Number, Unary, sign};

/// A number at a point, and the plain number at the point that makes the choices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Continued<N> {
    pub here: N,
    pub inside: f64,
}

impl<N: Number> Number for Continued<N> {
    fn constant(value: f64) -> Self {
        Self { here: N::constant(value), inside: value }
    }
    fn coordinate(value: f64, axis: usize) -> Self {
        Self { here: N::coordinate(value, axis), inside: value }
    }
    /// The number that chooses: conditions are asked of it.
    fn value(&self) -> f64 {
        self.inside
    }
    fn unary(self, f: Unary) -> Self {
        let inside = self.inside.unary(f);
        let here = match f {
            Unary::Abs if self.inside < 0.0 => self.here.unary(Unary::Neg),
            Unary::Abs => self.here,
            Unary::Sign => N::constant(sign(self.inside)),
            _ => self.here.unary(f),
        };
        Self { here, inside }
    }
    fn binary(self, other: Self, f: Binary) -> Self {
        let inside = self.inside.binary(other.inside, f);
        let here = match f {
            Binary::Add | Binary::Sub | Binary::Mul | Binary::Div | Binary::Pow | Binary::Atan2 => self.here.binary(other.here, f),
            Binary::Min if self.inside <= other.inside => self.here,
            Binary::Max if self.inside >= other.inside => self.here,
            Binary::Min | Binary::Max => other.here,
            // comparisons
            _ => N::constant(inside),
        };
        Self { here, inside }
    }
}
