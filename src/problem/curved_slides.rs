//! Curved sides that slide: the functions of their conditions.
//!
//! ```text
//! ∫ ψ_j n . u ds = 0,   or   ∫ ψ_j t . u ds = 0
//! ```
//!
//! for every ψ_j of degree p, the degree of the trace: u may be curved within its elements, and an exact u without normal, or tangential, part
//! satisfies every row. A condition in points would hold the coefficients of splines, which are no values, and both normals in the vertex of
//! a polygon, where the side could not slide at all. Where a function of the trace cannot move in the direction already, because supports,
//! ties or a curved side before it hold it, the degree is lowered as that of any multiplier. What holds another direction there leaves the
//! degree as it is: both are held where normals meet tangents, and in kinks.

use super::directions::slides;
use super::fixed::Eliminated;
use super::held_part::HeldPart;
use super::interface_side::InterfaceSide;
use super::model::{CurvedSlide, Model, SlidePart, tangents};
use super::multipliers::wrapped;
use super::side_points::{SidePoint, side_points};
use super::tie_part::TieCounts;
use crate::coupling::multiplier::{MultiplierError, MultiplierKind};
use crate::linalg::Vector;
use crate::space::Trace;
use std::collections::{HashMap, HashSet};

/// Squared cosine above which a direction that is held counts as that of a row, 45 degrees, where the normal is that of a place near by.
const NEAR: f64 = 0.5;
/// Squared cosine where the normal is that of the very place: 0.6 degrees.
const SAME: f64 = 1.0 - 1e-4;

/// A curved side that slides with points of it.
#[derive(Debug)]
pub(super) struct SampledSlide<'a, const S: usize, const N: usize> {
    pub slide: &'a CurvedSlide<S, N>,
    pub points: Vec<SidePoint<N>>,
    /// The points at which a function of the model has a value.
    at: HashMap<usize, Vec<usize>>,
}

impl<'a, const S: usize, const N: usize> SampledSlide<'a, S, N> {
    pub fn new(model: &Model<S, N>, slide: &'a CurvedSlide<S, N>) -> Self {
        let points = side_points(model, &slide.side);
        let mut at: HashMap<usize, Vec<usize>> = HashMap::new();
        for (q, point) in points.iter().enumerate() {
            point.functions.iter().for_each(|f| at.entry(f.0).or_default().push(q));
        }
        Self { slide, points, at }
    }

    /// The points at which `function` has a value.
    pub fn points_of(&self, function: usize) -> impl Iterator<Item = &SidePoint<N>> {
        self.at.get(&function).into_iter().flatten().map(|&q| &self.points[q])
    }

    /// The point at which `function` is largest.
    fn peak(&self, function: usize) -> Option<&SidePoint<N>> {
        self.points_of(function).max_by(|a, b| a.value(function).total_cmp(&b.value(function)))
    }

    /// Directions that the side holds where its normal is `normal`.
    pub fn directions(&self, normal: &Vector<N>) -> Vec<Vector<N>> {
        if self.slide.along_normal { vec![*normal] } else { tangents(normal) }
    }

    /// Whether a direction of the rows is within `near`, a squared cosine, of those that are `held`.
    fn is_held(&self, held: &[Vector<N>], normal: &Vector<N>, near: f64) -> bool {
        let mut basis = Vec::<Vector<N>>::new();
        for d in held {
            let across = basis.iter().fold(*d, |v, b| v - b * b.dot(d));
            if across.norm_squared() > 1.0 - near {
                basis.push(across / across.norm());
            }
        }
        let share: f64 = basis.iter().map(|b| b.dot(normal).powi(2)).sum();
        if self.slide.along_normal { share > near } else { basis.len() > 1 || (basis.len() == 1 && 1.0 - share > near) }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The rows of a curved side that slides beside others `before` it; they are not counted among those of the model yet.
    ///
    /// # Errors
    /// [`MultiplierError`] where the side has too few elements.
    pub(super) fn slide_part(
        &self,
        slide: &SampledSlide<'_, S, N>,
        before: &[SampledSlide<'_, S, N>],
        fixed: &Eliminated,
        tied: &TieCounts,
    ) -> Result<SlidePart<S, N>, MultiplierError>
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let side = &slide.slide.side;
        let (field, inclined) = (self.patches[side.patch].field, slides(self, side));
        let by_supports = |f: usize| -> Vec<Vector<N>> {
            let along: Vec<Vector<N>> = inclined.iter().filter(|(other, _)| *other == f).map(|(_, d)| *d).collect();
            // the largest component of a direction that is held is eliminated, too
            let is_held =
                |c: usize| if along.is_empty() { fixed.is(field.unknown(f, c)) } else { fixed.is_prescribed(field.unknown(f, c)) };
            let axes = (0..N).filter(|&c| is_held(c)).map(|c| Vector::from_fn(|k, _| f64::from(u8::from(k == c))));
            axes.chain(along.iter().copied()).collect()
        };
        let held: HashMap<usize, Vec<Vector<N>>> =
            side.trace.dofs.iter().map(|&f| (self.function(side.patch, f), by_supports(f))).collect();
        let is_stuck = |f: usize| {
            let function = self.function(side.patch, f);
            let Some(peak) = slide.peak(function) else { return false };
            // supports that hold all functions there end in the place
            let near = if peak.functions.iter().all(|f| !held[&f.0].is_empty()) { SAME } else { NEAR };
            slide.is_held(&held[&function], &peak.normal, near) || self.is_held_beside(slide, before, function, held[&function].clone())
        };
        let own: HashMap<usize, bool> = side.trace.dofs.iter().map(|&f| (f, tied.count(self, side.patch, f) > 0 || is_stuck(f))).collect();
        let stuck = |f: usize| own[&f];
        let free = side.trace.dofs.iter().filter(|&&f| !stuck(f)).map(|&f| self.function(side.patch, f));
        let free = free.collect::<HashSet<_>>().len();
        let mut psi = wrapped(self, side, &stuck, side.trace.multiplier(MultiplierKind::Lowered(0), &stuck)?);
        let multipliers = psi.num_functions();
        if multipliers > free {
            let part = HeldPart::of(side, &*psi, &stuck);
            if part.free() > free || part.free() == 0 {
                return Err(MultiplierError::TooMany { component: 0, multipliers, free });
            }
            psi = part.given(psi);
        }
        Ok(SlidePart::new(slide.slide.clone(), psi, self.unknowns, self.rows))
    }

    /// Whether a direction of the rows of `slide` at `function` is held by the sides `before` it, with those that are `held` already.
    fn is_held_beside(
        &self,
        slide: &SampledSlide<'_, S, N>,
        before: &[SampledSlide<'_, S, N>],
        function: usize,
        mut held: Vec<Vector<N>>,
    ) -> bool {
        let mut place = None;
        let mut apart = Vec::new();
        for other in before.iter().filter(|other| other.at.contains_key(&function)) {
            let common = slide.points_of(function).find_map(|a| Some((a, other.points_of(function).find(|b| self.is_near(&a.x, &b.x))?)));
            match (common, other.peak(function)) {
                (Some((own, there)), _) => {
                    place.get_or_insert(own.normal);
                    held.extend(other.directions(&there.normal));
                }
                // sides with elements between them
                (None, Some(peak)) => apart.extend(other.directions(&peak.normal)),
                (None, None) => {}
            }
        }
        if place.is_some_and(|normal| slide.is_held(&held, &normal, SAME)) {
            return true;
        }
        let normal = if apart.is_empty() { None } else { slide.peak(function).map(|peak| peak.normal) };
        held.extend(apart);
        normal.is_some_and(|normal| slide.is_held(&held, &normal, NEAR))
    }
}
