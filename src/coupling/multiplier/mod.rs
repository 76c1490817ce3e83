//! Multiplier spaces: names and data of a case file, and the bases on the slave's elements built from them.
//!
//! | name | space |
//! | --- | --- |
//! | `p/p` | the trace's own spline space, degree lowered by one at constrained ends |
//! | `p/p-k` | degree p - k on the same breakpoints, knots kept with their multiplicity: regularity max(r - k, -1) |
//! | `constant` | one constant per element |
//! | `dual` | biorthogonal to the functions of the trace, one each, none at constrained ends; in contact over the covered part |
//! | data | a degree, a continuity, and the treatment of the ends |
//!
//! A basis that offers no polynomials has `p/p` on its own functions and `constant`.

mod constants;
mod covered;
mod dual;
mod end_lowered;
mod reproduction;
mod sliver;

use crate::basis::{Basis, Elements, Polynomials};
use crate::coupling::Segments;
use crate::linalg::Real;
use crate::space::{Space, Trace};
use std::fmt::{self, Display};
use std::str::FromStr;
use std::sync::Arc;

pub use constants::PiecewiseConstant;
pub use covered::{CoveredDual, MOST, Reading, dual_covered};
pub use dual::dual;
pub use end_lowered::end_lowered;
pub use reproduction::reproduction;
pub use sliver::{SLIVER, without_slivers};

/// Error when a multiplier space does not exist or cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MultiplierError {
    /// The name is not known.
    #[error("unknown multiplier \"{name}\"; known: {known}")]
    Unknown {
        /// The name.
        name: String,
        /// The known names.
        known: &'static str,
    },
    /// The slave side has no such space.
    #[error("there is no multiplier \"{wanted}\" with degree {degree}; this side has {known}")]
    NotHere {
        /// The name or the data given.
        wanted: String,
        /// Degree of the slave side.
        degree: usize,
        /// Multipliers available on this side.
        known: String,
    },
    /// The functions of the slave side have no dual ones.
    #[error("there is no multiplier \"dual\" here: {reason}; this side has {known}")]
    NoDual {
        /// Cause and position.
        reason: String,
        /// Multipliers available on this side.
        known: String,
    },
    /// Multipliers of the library on surfaces.
    #[error("multipliers on surfaces are not in this version")]
    Surfaces,
    /// Dual multipliers on surfaces of revolution, whose weights 2 pi r are not those of the curve.
    #[error("dual multipliers on surfaces of revolution are not in this version")]
    Revolution,
    /// The degree cannot be lowered at an end.
    #[error(
        "the multiplier has degree {degree} on element {element} at the end of the side, too little to be lowered there; refine the side"
    )]
    NothingLeft {
        /// The element at the end.
        element: usize,
        /// Its degree.
        degree: usize,
    },
    /// More multipliers than slave unknowns that can carry them.
    #[error(
        "component {component} has {multipliers} multipliers for {free} free unknowns of the slave side; refine the side or take a multiplier of lower degree"
    )]
    TooMany {
        /// The component.
        component: usize,
        /// Its number of multiplier functions.
        multipliers: usize,
        /// Its number of unknowns on the slave side that are not prescribed.
        free: usize,
    },
}

/// Treatment of a multiplier at the ends of the side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ends {
    /// Lowered where the end is constrained and the degree is that of the trace.
    #[default]
    Auto,
    /// Never lowered.
    Full,
    /// Lowered at both ends.
    Lowered,
}

/// Kind of a multiplier space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MultiplierKind {
    /// `p/p-2` from degree 2 on, `p/p` at degree 1: the choice of [`MultiplierKind::resolved`], which depends on the space alone.
    #[default]
    Auto,
    /// `p/p-k`; k = 0 is `p/p` with lowered ends.
    Lowered(usize),
    /// One constant per element.
    Constant,
    /// Biorthogonal to the functions of the trace.
    Dual,
    /// Given by data.
    Uniform {
        /// Degree of the polynomials.
        degree: usize,
        /// Continuity between elements; `None`: the highest that the side allows.
        continuity: Option<isize>,
        /// Treatment of the ends.
        ends: Ends,
    },
}

/// Names that [`MultiplierKind::from_str`] accepts.
pub const KNOWN: &str = "auto, p/p, p/p-1, p/p-2, p/p-4, ..., constant, dual";

impl FromStr for MultiplierKind {
    type Err = MultiplierError;
    fn from_str(name: &str) -> Result<Self, MultiplierError> {
        let unknown = || MultiplierError::Unknown { name: name.into(), known: KNOWN };
        match name {
            "auto" => Ok(Self::Auto),
            "constant" => Ok(Self::Constant),
            "p/p" => Ok(Self::Lowered(0)),
            "dual" => Ok(Self::Dual),
            _ => {
                let k = name.strip_prefix("p/p-").ok_or_else(unknown)?;
                let k = k.parse::<usize>().ok().filter(|&v| v > 0 && v.to_string() == k).ok_or_else(unknown)?;
                Ok(Self::Lowered(k))
            }
        }
    }
}

impl Display for MultiplierKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Lowered(0) => f.write_str("p/p"),
            Self::Lowered(k) => write!(f, "p/p-{k}"),
            Self::Constant => f.write_str("constant"),
            Self::Dual => f.write_str("dual"),
            Self::Uniform { degree, continuity, ends } => {
                write!(f, "degree {degree}")?;
                if let Some(c) = continuity {
                    write!(f, ", continuity {c}")?;
                }
                match ends {
                    Ends::Auto => Ok(()),
                    Ends::Full => f.write_str(", full ends"),
                    Ends::Lowered => f.write_str(", lowered ends"),
                }
            }
        }
    }
}

impl MultiplierKind {
    /// Whether the pairing is known not to be uniformly stable: p/p-k with k odd.
    pub fn is_unstable(&self) -> bool {
        matches!(self, Self::Lowered(k) if k % 2 == 1)
    }

    /// Resolves `auto` on this basis; every other kind is returned unchanged. This is the one place of the choice.
    ///
    /// With p the least degree of the elements, `auto` is `p/p-2` for p >= 2 and `p/p` for p < 2. Number and order of the elements, the kind of
    /// body and the other side do not matter: equal spaces of splines and of meshes have the same multiplier. A basis from outside that
    /// offers no [polynomials](Basis::polynomials) has `p/p` on its own functions at any degree.
    pub fn resolved<T: Real>(&self, basis: &dyn Basis<1, T>) -> Self {
        if *self != Self::Auto {
            return *self;
        }
        if least_degree(basis) >= 2 && basis.polynomials(Polynomials::Lowered(2)).is_some() { Self::Lowered(2) } else { Self::Lowered(0) }
    }

    /// Whether [`build`] removes a function and a degree at constrained ends for this kind on `basis`.
    pub fn lowers_ends<T: Real>(&self, basis: &dyn Basis<1, T>) -> bool {
        match self.resolved(basis) {
            Self::Lowered(k) => k == 0,
            Self::Dual => true,
            Self::Uniform { degree, ends, .. } => match ends {
                Ends::Full => false,
                Ends::Lowered => true,
                Ends::Auto => degree >= least_degree(basis),
            },
            // `auto` is resolved
            Self::Constant | Self::Auto => false,
        }
    }
}

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
    let degree = least_degree(basis);
    let kind = kind.resolved(basis);
    let own_functions = || Box::new(Arc::clone(space)) as Box<dyn Basis<1, T>>;
    let offers = basis.polynomials(Polynomials::Lowered(0)).is_some();
    let found = match kind {
        MultiplierKind::Lowered(k) if k > degree => None,
        MultiplierKind::Lowered(0) => Some(basis.polynomials(Polynomials::Lowered(0)).unwrap_or_else(own_functions)),
        MultiplierKind::Lowered(k) => basis.polynomials(Polynomials::Lowered(k)),
        MultiplierKind::Constant => Some(
            basis.polynomials(Polynomials::Uniform { degree: 0, continuity: -1 }).unwrap_or_else(|| Box::new(PiecewiseConstant::of(basis))),
        ),
        MultiplierKind::Uniform { degree: wanted, continuity, .. } => {
            let most = isize::try_from(wanted).unwrap_or(isize::MAX) - 1;
            let highest = if continuity.is_none() && wanted <= degree && uniform_degree(basis) { Some(degree - wanted) } else { None };
            match (highest, continuity) {
                (_, Some(c)) if c > most || c < -1 => None,
                // continuity not given: that of the trace, lowered along with the degree
                (Some(k), _) => basis.polynomials(Polynomials::Lowered(k)),
                (None, c) => basis.polynomials(Polynomials::Uniform { degree: wanted, continuity: c.unwrap_or(most) }),
            }
        }
        MultiplierKind::Dual if offers => return dual_here(space, degree, ends),
        MultiplierKind::Dual | MultiplierKind::Auto => None,
    };
    let found =
        found.ok_or_else(|| MultiplierError::NotHere { wanted: kind.to_string(), degree, known: known_here(degree, offers).join(", ") })?;
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
fn dual_here<const N: usize, T: Real>(
    space: &Arc<dyn Space<1, N, T>>,
    degree: usize,
    ends: &[bool],
) -> Result<Box<dyn Basis<1, T>>, MultiplierError> {
    let constrained = chosen_ends(&**space as &dyn Basis<1, T>, |k| ends.get(k).copied().unwrap_or(false));
    dual(&**space, &constrained).map(|psi| Box::new(psi) as Box<dyn Basis<1, T>>).map_err(|e| instead(e, degree))
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
    dual_covered(space, &constrained, segments).map_err(|e| instead(e, least_degree(basis)))
}

/// Adds to [`MultiplierError::NoDual`] the multipliers available instead on a side of `degree`; other errors are unchanged.
fn instead(error: MultiplierError, degree: usize) -> MultiplierError {
    let MultiplierError::NoDual { reason, .. } = error else { return error };
    let known = known_here(degree, true).into_iter().filter(|name| name != "dual").collect::<Vec<_>>().join(", ");
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

/// The lowest degree of the side's elements.
pub fn least_degree<T: Real>(basis: &dyn Basis<1, T>) -> usize {
    (0..basis.num_elements()).map(|e| basis.degree(e)[0]).min().unwrap_or(0)
}

fn uniform_degree<T: Real>(basis: &dyn Basis<1, T>) -> bool {
    (1..basis.num_elements()).all(|e| basis.degree(e) == basis.degree(0))
}

/// Names of the multipliers available on a side of `degree`.
fn known_here(degree: usize, offers_polynomials: bool) -> Vec<String> {
    let mut names = vec!["p/p".to_string()];
    if offers_polynomials {
        names.extend((1..=degree).filter(|k| *k == 1 || k % 2 == 0).map(|k| format!("p/p-{k}")));
    }
    names.push("constant".into());
    if offers_polynomials {
        names.push("dual".into());
    }
    names
}
