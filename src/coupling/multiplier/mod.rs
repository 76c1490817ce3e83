//! Multiplier spaces: names and data of a case file, and the bases on the slave's elements built from them.
//!
//! | name | space |
//! | --- | --- |
//! | `p/p` | the trace's own spline space, degree lowered by one at constrained ends |
//! | `p/p-k` | degree p - k on the same breakpoints, knots kept with their multiplicity: regularity max(r - k, -1); on triangles continuous |
//! | `constant` | one constant per element |
//! | `dual` | biorthogonal to the functions of the trace, one each, none at constrained ends; in contact over the covered part, on surfaces of whole elements; on triangles of degree 1 |
//! | data | a degree, a continuity, and the treatment of the ends |
//!
//! A basis that offers no polynomials has `p/p` on its own functions and `constant`. What is special on surfaces is in [`build_on_surface`].

mod constants;
mod covered;
mod dual;
mod dual_surface;
mod edges;
mod end_lowered;
mod error;
mod handed_on;
mod kind;
mod reproduction;
mod sliver;
mod surface;

use crate::basis::{Basis, Elements, Polynomials};
use crate::coupling::Segments;
use crate::linalg::Real;
use crate::space::{Space, Trace};
use kind::{functions_of, known_here};
use std::sync::Arc;

pub use constants::PiecewiseConstant;
pub use covered::{CoveredDual, MOST, Reading, dual_covered};
pub use dual::dual;
pub use dual_surface::dual_on_surface;
pub use end_lowered::end_lowered;
pub use error::MultiplierError;
pub use kind::{Ends, KNOWN, MultiplierKind, has_triangles, least_degree};
pub use reproduction::reproduction;
pub use sliver::{SLIVER, without_slivers};
pub use surface::build_on_surface;
pub(crate) use surface::numbered_alike;

/// An end of a curve: a corner that belongs to one element only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SideEnd {
    /// The element at the end.
    pub element: usize,
    /// Its local coordinate there, 0 or 1.
    pub at: usize,
}

/// Ends of a curve by its corner ids, in order of elements; empty on a closed curve. Without corner ids the
/// elements are taken as one run: start of the first, end of the last.
pub fn side_ends<E: Elements + ?Sized>(elements: &E) -> Vec<SideEnd> {
    let n = elements.num_elements();
    let mut corners: Vec<(usize, SideEnd)> = Vec::with_capacity(2 * n);
    let mut ids = Vec::new();
    for element in 0..n {
        elements.corners(element, &mut ids);
        if ids.len() != 2 {
            return vec![SideEnd { element: 0, at: 0 }, SideEnd { element: n - 1, at: 1 }];
        }
        corners.extend(ids.iter().enumerate().map(|(at, &id)| (id, SideEnd { element, at })));
    }
    corners.sort_by_key(|&(id, end)| (id, end.element, end.at));
    let alone = |k: usize| (k == 0 || corners[k - 1].0 != corners[k].0) && corners.get(k + 1).is_none_or(|next| next.0 != corners[k].0);
    let mut ends: Vec<SideEnd> = (0..corners.len()).filter(|&k| alone(k)).map(|k| corners[k].1).collect();
    ends.sort_by_key(|end| (end.element, end.at));
    ends
}

/// Builds the multiplier space of `kind` on the slave side `space`, for one component.
///
/// `ends` gives for each of [`side_ends`] whether it is constrained in this component (prescribed, or a cross point);
/// missing entries count as free.
///
/// # Errors
/// [`MultiplierError::NotHere`] where the side has no such space, [`MultiplierError::NothingLeft`] where an end cannot
/// be lowered.
pub fn build<const N: usize, T: Real>(
    space: &Arc<dyn Space<1, N, T>>,
    kind: MultiplierKind,
    ends: &[bool],
) -> Result<Box<dyn Basis<1, T>>, MultiplierError> {
    let basis: &dyn Basis<1, T> = &**space;
    let kind = kind.resolved(basis);
    if kind == MultiplierKind::Dual && basis.polynomials(Polynomials::Lowered(0)).is_some() {
        return dual_here(space, ends);
    }
    let found = functions_of(space, kind)?;
    if !kind.lowers_ends(basis) {
        return Ok(found);
    }
    let always = matches!(kind, MultiplierKind::Uniform { ends: Ends::Lowered, .. });
    let lowered = chosen_ends(basis, |k| always || ends.get(k).copied().unwrap_or(false));
    if lowered.is_empty() { Ok(found) } else { end_lowered(found, &lowered) }
}

/// Ends of the side whose index satisfies `wanted`.
fn chosen_ends<T: Real>(basis: &dyn Basis<1, T>, wanted: impl Fn(usize) -> bool) -> Vec<SideEnd> {
    side_ends(basis).into_iter().enumerate().filter(|(k, _)| wanted(*k)).map(|(_, end)| end).collect()
}

/// Builds the dual space; its error lists the multipliers available instead.
fn dual_here<const N: usize, T: Real>(space: &Arc<dyn Space<1, N, T>>, ends: &[bool]) -> Result<Box<dyn Basis<1, T>>, MultiplierError> {
    let constrained = chosen_ends(&**space as &dyn Basis<1, T>, |k| ends.get(k).copied().unwrap_or(false));
    dual(&**space, &constrained).map(|psi| Box::new(psi) as Box<dyn Basis<1, T>>).map_err(|e| instead(e, &**space))
}

/// Builds the dual multipliers of a contact: [`dual_covered`] with `ends` as of [`build`].
///
/// # Errors
/// Those of [`dual_covered`]; [`MultiplierError::NoDual`] lists the multipliers available on this side.
pub fn build_covered<const N: usize, T: Real>(
    space: &Arc<dyn Space<1, N, T>>,
    ends: &[bool],
    segments: &Segments<1, T>,
) -> Result<CoveredDual<N, T>, MultiplierError> {
    let basis = &**space as &dyn Basis<1, T>;
    let constrained = chosen_ends(basis, |k| ends.get(k).copied().unwrap_or(false));
    dual_covered(space, &constrained, segments).map_err(|e| instead(e, &**space))
}

/// Adds to [`MultiplierError::NoDual`] the multipliers available instead on a side; other errors are unchanged.
fn instead<const S: usize, T: Real>(error: MultiplierError, basis: &dyn Basis<S, T>) -> MultiplierError {
    let MultiplierError::NoDual { reason, .. } = error else { return error };
    let known = known_here(basis).into_iter().filter(|name| name != "dual").collect::<Vec<_>>().join(", ");
    MultiplierError::NoDual { reason, known }
}

/// Checks that no component has more multipliers than unknowns of the slave side that are not prescribed.
///
/// `multiplier`: one for all components, or one per component; `is_fixed(function of the body, component)`.
///
/// # Errors
/// [`MultiplierError::TooMany`] for the first such component.
pub fn check_counts<const S: usize, const N: usize, T: Real>(
    slave: &Trace<S, N, T>,
    components: usize,
    multiplier: &[&dyn Basis<S, T>],
    is_fixed: &dyn Fn(usize, usize) -> bool,
) -> Result<(), MultiplierError> {
    for component in 0..components {
        let free = slave.dofs.iter().filter(|&&function| !is_fixed(function, component)).count();
        let own = if multiplier.len() == 1 { multiplier.first() } else { multiplier.get(component) };
        let multipliers = own.map_or(0, |m| m.num_functions());
        if multipliers > free {
            return Err(MultiplierError::TooMany { component, multipliers, free });
        }
    }
    Ok(())
}
