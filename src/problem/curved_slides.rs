//! Curved sides that slide: the functions of their conditions.
//!
//! ```text
//! ∫ ψ_j n . u ds = 0,   or   ∫ ψ_j t . u ds = 0
//! ```
//!
//! for every ψ_j of degree p, the degree of the trace: u may be curved within its elements, and an exact u without normal, or tangential, part
//! satisfies every row. A condition in points would hold the coefficients of splines, which are no values, and both normals in the vertex of
//! a polygon, where the side could not slide at all. Where a function of the trace cannot move in the direction already, because supports,
//! ties or another curved side hold it, the degree is lowered as that of any multiplier.

use super::directions::{directions, slides};
use super::fixed::Eliminated;
use super::held_part::HeldPart;
use super::interface_side::InterfaceSide;
use super::model::{CurvedSlide, Model, SlidePart};
use super::multipliers::wrapped;
use super::tie_part::TieCounts;
use crate::coupling::multiplier::{MultiplierError, MultiplierKind};
use crate::linalg::Vector;
use crate::space::Trace;
use std::collections::HashSet;

/// Squared cosine above which a direction that is held counts as that of a row: 45 degrees.
const NEAR: f64 = 0.5;

impl<const S: usize, const N: usize> Model<S, N> {
    /// The rows of a curved side that slides; they are not counted among those of the model yet.
    ///
    /// # Errors
    /// [`MultiplierError`] where the side has too few elements.
    pub(super) fn slide_part(
        &self,
        slide: &CurvedSlide<S, N>,
        fixed: &Eliminated,
        members: &TieCounts,
    ) -> Result<SlidePart<S, N>, MultiplierError>
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let side = &slide.side;
        let (field, inclined) = (self.patches[side.patch].field, slides(self, side));
        let cannot_move = |function: usize, n: &Vector<N>| {
            let taken: Vec<usize> = (0..N).filter(|&c| fixed.is(field.unknown(function, c))).collect();
            let mut along = inclined.iter().filter(|(f, _)| *f == function).map(|(_, d)| d.dot(n).powi(2));
            if slide.along_normal {
                taken.iter().map(|&c| n[c].powi(2)).sum::<f64>() > NEAR || along.any(|share| share > NEAR)
            } else {
                taken.len() > 1 || taken.iter().any(|&c| n[c].powi(2) < NEAR) || along.any(|share| share < NEAR)
            }
        };
        // functions of an edge vanish at its corners where an element is its only one: their normal is taken where they are largest
        let normals = directions(side, None, 0.0, side.degree() + 2);
        let stuck = |f: usize| members.count(self, side.patch, f) > 1 || normals.get(&f).is_some_and(|n| cannot_move(f, n));
        let own = side.trace.dofs.iter().filter(|&&f| !stuck(f)).map(|&f| self.function(side.patch, f));
        let free = own.collect::<HashSet<_>>().len();
        let mut psi = wrapped(self, side, &stuck, side.trace.multiplier(MultiplierKind::Lowered(0), &stuck)?);
        let multipliers = psi.num_functions();
        if multipliers > free {
            let part = HeldPart::of(side, &*psi, &stuck);
            if part.free() > free || part.free() == 0 {
                return Err(MultiplierError::TooMany { component: 0, multipliers, free });
            }
            psi = part.given(psi);
        }
        Ok(SlidePart::new(slide.clone(), psi, self.unknowns, self.rows))
    }
}
