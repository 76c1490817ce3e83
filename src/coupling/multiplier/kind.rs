//! Kinds of multiplier spaces, by name or by data, and the functions of a side that they ask for.

use super::{MultiplierError, PiecewiseConstant};
use crate::basis::{Basis, Cell, Polynomials};
use crate::linalg::Real;
use crate::space::Space;
use std::fmt::{self, Display};
use std::str::FromStr;
use std::sync::Arc;

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
    /// Whether the pairing is known not to be uniformly stable on curves and on surfaces of tensor cells: p/p-k with k odd.
    pub fn is_unstable(&self) -> bool {
        matches!(self, Self::Lowered(k) if k % 2 == 1)
    }

    /// Whether the pairing is known not to be uniformly stable on this side: [`is_unstable`](Self::is_unstable), but where the side has
    /// triangles. There p/p-k is continuous, and so part of the space of the trace.
    pub fn is_unstable_on<const S: usize, T: Real>(&self, basis: &dyn Basis<S, T>) -> bool {
        self.is_unstable() && !has_triangles(basis)
    }

    /// Resolves `auto` on this basis; every other kind is returned unchanged. This is the one place of the choice.
    ///
    /// With p the least degree of the elements, `auto` is `p/p-2` for p >= 2 and `p/p` for p < 2; on surfaces with triangles, where p/p-2 is
    /// continuous, it is `p/p-1` for p = 2. Number and order of the elements, the kind of body and the other side do not matter: equal spaces
    /// of splines and of meshes have the same multiplier. A basis from outside that offers no [polynomials](Basis::polynomials) has `p/p` on
    /// its own functions at any degree.
    pub fn resolved<const S: usize, T: Real>(&self, basis: &dyn Basis<S, T>) -> Self {
        if *self != Self::Auto {
            return *self;
        }
        let wanted = Self::Lowered(match (least_degree(basis), has_triangles(basis)) {
            (0 | 1, _) => 0,
            (2, true) => 1,
            _ => 2,
        });
        let there = polynomials_of(basis, wanted).is_some_and(|p| basis.polynomials(p).is_some());
        if there { wanted } else { Self::Lowered(0) }
    }

    /// Whether [`build`](super::build) removes a function and a degree at constrained ends for this kind on `basis`, [`build_on_surface`](super::build_on_surface) at constrained
    /// edges.
    pub fn lowers_ends<const S: usize, T: Real>(&self, basis: &dyn Basis<S, T>) -> bool {
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

/// The polynomials of a kind on the elements of a side; `None` if it has none of that kind.
///
/// On triangles those of p/p-k are continuous: discontinuous ones of degree p - 2 are not stable there.
pub(super) fn polynomials_of<const S: usize, T: Real>(basis: &dyn Basis<S, T>, kind: MultiplierKind) -> Option<Polynomials> {
    let (degree, triangles) = (least_degree(basis), has_triangles(basis));
    match kind {
        MultiplierKind::Lowered(k) if k > degree => None,
        MultiplierKind::Lowered(k) if k > 0 && triangles => {
            (k < degree).then_some(Polynomials::Uniform { degree: degree - k, continuity: 0 })
        }
        MultiplierKind::Lowered(k) => Some(Polynomials::Lowered(k)),
        MultiplierKind::Constant => Some(Polynomials::Uniform { degree: 0, continuity: -1 }),
        MultiplierKind::Uniform { degree: wanted, continuity, .. } => {
            let most = isize::try_from(wanted).unwrap_or(isize::MAX) - 1;
            match continuity {
                Some(c) if c > most || c < -1 => None,
                // continuity not given: that of the trace, lowered along with the degree
                None if !triangles && wanted <= degree && uniform_degree(basis) => Some(Polynomials::Lowered(degree - wanted)),
                None if triangles => Some(Polynomials::Uniform { degree: wanted, continuity: most.min(0) }),
                c => Some(Polynomials::Uniform { degree: wanted, continuity: c.unwrap_or(most) }),
            }
        }
        MultiplierKind::Dual | MultiplierKind::Auto => None,
    }
}

/// The functions of a kind that is no `auto` and no `dual`, before anything is lowered.
pub(super) fn functions_of<const S: usize, const N: usize, T: Real>(
    space: &Arc<dyn Space<S, N, T>>,
    kind: MultiplierKind,
) -> Result<Box<dyn Basis<S, T>>, MultiplierError> {
    let basis: &dyn Basis<S, T> = &**space;
    let own = || -> Option<Box<dyn Basis<S, T>>> {
        match kind {
            MultiplierKind::Lowered(0) => Some(Box::new(Arc::clone(space))),
            MultiplierKind::Constant => Some(Box::new(PiecewiseConstant::of(basis))),
            _ => None,
        }
    };
    let found = polynomials_of(basis, kind).and_then(|wanted| basis.polynomials(wanted).or_else(own));
    found.ok_or_else(|| MultiplierError::NotHere {
        wanted: kind.to_string(),
        degree: least_degree(basis),
        known: known_here(basis).join(", "),
    })
}

/// The lowest degree of the side's elements, over all directions.
pub fn least_degree<const S: usize, T: Real>(basis: &dyn Basis<S, T>) -> usize {
    (0..basis.num_elements()).flat_map(|e| basis.degree(e)).min().unwrap_or(0)
}

/// Whether a surface has triangles; sides of triangles in the plane are curves like any other.
pub fn has_triangles<const S: usize, T: Real>(basis: &dyn Basis<S, T>) -> bool {
    S > 1 && (0..basis.num_elements()).any(|e| basis.cell(e) == Cell::Simplex)
}

fn uniform_degree<const S: usize, T: Real>(basis: &dyn Basis<S, T>) -> bool {
    let degree = least_degree(basis);
    (0..basis.num_elements()).all(|e| basis.degree(e) == [degree; S])
}

/// Names of the multipliers available on a side.
pub(super) fn known_here<const S: usize, T: Real>(basis: &dyn Basis<S, T>) -> Vec<String> {
    let (degree, triangles) = (least_degree(basis), has_triangles(basis));
    let offers_polynomials = basis.polynomials(Polynomials::Lowered(0)).is_some();
    let mut names = vec!["p/p".to_string()];
    if offers_polynomials {
        let lowest = if triangles { degree.saturating_sub(1) } else { degree };
        names.extend((1..=lowest).filter(|k| *k == 1 || k % 2 == 0).map(|k| format!("p/p-{k}")));
    }
    names.push("constant".into());
    // vertices of triangles of degree 2 have no weight
    if offers_polynomials && (!triangles || degree == 1) {
        names.push("dual".into());
    }
    names
}
