//! The traction of an exact solution made of pieces, on a side that lies where they meet.
//!
//! On the line between two pieces the formulas choose one of them, whichever body asks. A body's own piece is the one that holds within
//! it, below its side: facets may leave the line by their deviation, so that the piece is asked for beyond that, and continued to the side.

use super::data::{Exact, Point};
use super::physics::Physics;
use crate::linalg::Vector;

/// Size of a difference of tractions, relative to them, that is no other piece.
const SAME: f64 = 1e-9;

/// Depths below a side at which the piece of a solution is asked for \[length\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depths {
    /// Distance from a side at which the body's own piece holds: beyond the deviation of the side from the line it stands for, and rounding.
    pub own: f64,
    /// Down to here the own piece must hold.
    pub certain: f64,
}

impl<const N: usize> Physics<N> {
    /// sigma n (k du/dn) of the exact solution at the point `x` of a side of the body of this material, at the time `t`, by the body's own
    /// piece, found at `depths` along the unit vector `inward`; missing components are zero. `None` if another piece begins before the
    /// certain depth, so that it stays open which one is meant.
    pub fn own_traction(
        &self,
        exact: &dyn Exact,
        t: f64,
        x: &Vector<N>,
        [normal, inward]: [&Vector<N>; 2],
        depths: Depths,
    ) -> Option<[f64; 3]> {
        let (at, components) = (Point::new(x.as_slice()).at_time(t), self.components());
        let mut out = [0.0; 3];
        if !exact.is_piecewise() {
            self.exact_traction(exact, &at, x, normal, &mut out[..components]);
            return Some(out);
        }
        // moduli may jump with the pieces
        let place = if self.is_homogeneous() { *x } else { x + inward * depths.own };
        let of_piece = |depth: f64| {
            let mut out = [0.0; 3];
            self.piece_traction(exact, &at, [&(x + inward * depth), &place], normal, &mut out[..components]);
            out
        };
        let [own, below] = [of_piece(depths.own), of_piece(depths.certain.max(depths.own))];
        let size = own.iter().chain(&below).fold(0.0f64, |m, v| m.max(v.abs()));
        own.iter().zip(&below).all(|(a, b)| (a - b).abs() <= SAME * size).then_some(own)
    }
}
