//! Methods of contact: how bodies are kept apart. One file per method; a method from outside implements [`ContactMethod`].

mod augmented;
mod lagrange;
mod nitsche;
mod penalty;

use super::{Cone, ContactError, ContactRows, Opponent};
use crate::basis::Basis;
use crate::constraint::RowIteration;
use crate::coupling::{CouplingError, Segments, Side};
use crate::linalg::{Real, Vector};
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

pub use augmented::Augmented;
pub use lagrange::Lagrange;

/// Needs of a method: what the sides of a contact must bring, and what it accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// A multiplier space on the slave side: rows belong to its functions. Without one the method makes rows of its own.
    pub multiplier: bool,
    /// Fluxes sigma n of the bodies at both sides, which it takes for what crosses: the sides may carry nothing else in the same points.
    pub fluxes: bool,
    /// Whether obstacles that a force presses are accepted: their translations enter the rows.
    pub pressed: bool,
    /// Whether mixed integration is accepted: the master's part of the reaction by points of the master.
    pub mixed: bool,
}

impl Needs {
    /// Rows of multiplier functions.
    pub const FUNCTIONS: Self = Self { multiplier: true, fluxes: false, pressed: true, mixed: true };
    /// Rows at points, of displacements alone.
    pub const POINTS: Self = Self { multiplier: false, fluxes: false, pressed: false, mixed: false };
    /// Rows at points, of displacements and fluxes.
    pub const FLUXES: Self = Self { fluxes: true, ..Self::POINTS };
}

/// A translation of an obstacle that a force presses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translation<const N: usize> {
    /// Unit vector along which it moves.
    pub direction: Vector<N>,
    /// The unknown that is its length.
    pub unknown: usize,
    /// Value of the unknown at which the obstacle stands \[length\].
    pub at: f64,
}

/// A slave side and what it faces, at a time and at a place of the obstacle: all that rows are made of.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct ContactAt<'a, const S: usize, const N: usize> {
    /// The slave side, with its flux if the method needs it.
    pub slave: Side<'a, S, N>,
    /// Its opponent.
    pub opponent: Opponent<'a, S, N>,
    /// Quadrature points of both sides, or of the slave alone against an obstacle.
    pub segments: &'a Segments<S>,
    /// Points of the master for its part of the reaction: mixed integration.
    pub second: Option<&'a Segments<S>>,
    /// The multiplier space, if the method needs one.
    pub multiplier: Option<&'a dyn Basis<S>>,
    /// Cone of admissible multipliers.
    pub cone: Cone,
    /// g'(x, g): the gap for the geometric gap g of a slave point x \[length\].
    pub gap: &'a dyn Fn(&Vector<N>, f64) -> f64,
    /// Translations of an obstacle that forces press.
    pub translations: &'a [Translation<N>],
    /// Number of unknowns of the system.
    pub unknowns: usize,
}

impl<const S: usize, const N: usize> Debug for ContactAt<'_, S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ContactAt").field("slave", &self.slave).field("opponent", &self.opponent).finish_non_exhaustive()
    }
}

impl<'a, const S: usize, const N: usize> ContactAt<'a, S, N> {
    /// `slave` against `opponent` on `segments` in a system of `unknowns`, with the gap formula `gap`; no mixed integration, the cone of
    /// coefficients, no translations.
    pub fn new(
        slave: Side<'a, S, N>,
        opponent: Opponent<'a, S, N>,
        segments: &'a Segments<S>,
        multiplier: Option<&'a dyn Basis<S>>,
        gap: &'a dyn Fn(&Vector<N>, f64) -> f64,
        unknowns: usize,
    ) -> Self {
        Self { slave, opponent, segments, second: None, multiplier, cone: Cone::Coefficients, gap, translations: &[], unknowns }
    }

    /// Rows of the multiplier functions, see [`ContactRows::new`]: with the master's own points, translations of the obstacle and the cone.
    ///
    /// # Errors
    /// [`ContactError`]; [`ContactError::NoMultiplier`] without multiplier.
    pub fn rows_of_functions(&self) -> Result<ContactRows<S, N>, ContactError> {
        let psi = self.multiplier.ok_or(ContactError::NoMultiplier)?;
        let mut rows = ContactRows::new(self.slave, self.opponent, psi, self.segments.clone(), self.gap, self.unknowns)?;
        if let (Opponent::Master(master), Some(second)) = (self.opponent, self.second) {
            rows = rows.with_master_sums(self.slave, master, psi, second, self.unknowns)?;
        }
        for translation in self.translations {
            rows.add_translation(psi, &translation.direction, translation.unknown, translation.at);
        }
        rows.with_cone(self.cone, psi)
    }
}

/// Enforcement of the rows of a contact in the systems of a step.
#[derive(Debug, Default)]
pub struct Begun {
    /// Gap over lambda of every row; empty: all are exact.
    pub compliance: Vec<f64>,
    /// Whether the rows are made softer on the way to a first state: those of points, whose first guess is arbitrary.
    pub eased: bool,
    /// Changes of the rows between systems, on the way to an answer of the rows without changes; `None`: one solution is all.
    pub iteration: Option<Box<dyn RowIteration>>,
}

/// Values of a method without multiplier at points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointValues<T: Real = f64> {
    /// Numbers of the points that face something, among those that were asked for.
    pub point: Vec<usize>,
    /// lambda at each of them \[force/area\].
    pub lambda: Vec<T>,
    /// The gap there \[length\].
    pub gap: Vec<T>,
}

impl<T: Real> PointValues<T> {
    /// Checks that every point has one lambda and one gap, and that it is one of so many `points`.
    ///
    /// # Errors
    /// A sentence that names what is wrong.
    pub(crate) fn sound(&self, points: usize) -> Result<(), String> {
        let (found, lambdas, gaps) = (self.point.len(), self.lambda.len(), self.gap.len());
        if [lambdas, gaps] != [found; 2] {
            return Err(format!("values at {found} points have {lambdas} numbers of lambda and {gaps} gaps"));
        }
        self.point.iter().find(|q| **q >= points).map_or(Ok(()), |q| Err(format!("there are values at point {q} of {points}")))
    }
}

/// A method whose own numbers are wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MethodError {
    /// The factor of a penalty.
    #[error("the factor of a penalty must be positive, found {0}")]
    Factor(f64),
    /// The tolerance of an iteration.
    #[error("the tolerance of a method is relative and must be between 0 and 1, found {0}")]
    Tolerance(f64),
    /// A number of a method that is a coupling as well.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A number of a method from outside.
    #[error("{0}")]
    Other(String),
}

/// A method that keeps the bodies of a contact apart.
///
/// ```text
/// K u + Bᵀ lambda = f,   C u + g >= 0, lambda <= 0, product zero        (rows C, reaction B, offset g)
/// ```
///
/// It makes the [rows](ContactRows), says how soft they are, and may change them from one system to the next. The answer is checked against
/// the rows with [`Begun::compliance`], without changes: laws in which the pressure is not linear in the gap do not fit. By default it is
/// that of Lagrange multipliers: exact rows of multiplier functions. [`crate::check::contact_method`] checks a method on two blocks.
pub trait ContactMethod<const S: usize, const N: usize>: Debug + Send + Sync {
    /// Needs that the sides must meet.
    fn needs(&self) -> Needs {
        Needs::FUNCTIONS
    }

    /// Checks its own numbers, before anything is built.
    ///
    /// # Errors
    /// [`MethodError`].
    fn check(&self) -> Result<(), MethodError> {
        Ok(())
    }

    /// Rows, offsets and weights of a slave side at a time.
    ///
    /// # Errors
    /// [`ContactError`] where there are none.
    fn rows(&self, at: &ContactAt<'_, S, N>) -> Result<ContactRows<S, N>, ContactError> {
        at.rows_of_functions()
    }

    /// Compliance of the rows and their iteration. `unit(j)` is the compliance w_j² / k_j of row j at the stiffness k_j of its own slave
    /// unknowns \[gap integral / (force/area)\], zero for a row without weight; see [`crate::constraint::penalty`].
    fn begin(&self, rows: &ContactRows<S, N>, unit: &dyn Fn(usize) -> f64) -> Begun {
        let _ = unit;
        Begun { compliance: rows.compliance.clone(), ..Begun::default() }
    }

    /// lambda and gap at the points of `at.segments`; `None` of methods whose lambda is the sum of the multiplier's functions.
    fn values(&self, at: &ContactAt<'_, S, N>, unknowns: &[f64]) -> Option<Result<PointValues, ContactError>> {
        let _ = (at, unknowns);
        None
    }
}

impl<const S: usize, const N: usize, M: ContactMethod<S, N> + ?Sized> ContactMethod<S, N> for Arc<M> {
    fn needs(&self) -> Needs {
        (**self).needs()
    }
    fn check(&self) -> Result<(), MethodError> {
        (**self).check()
    }
    fn rows(&self, at: &ContactAt<'_, S, N>) -> Result<ContactRows<S, N>, ContactError> {
        (**self).rows(at)
    }
    fn begin(&self, rows: &ContactRows<S, N>, unit: &dyn Fn(usize) -> f64) -> Begun {
        (**self).begin(rows, unit)
    }
    fn values(&self, at: &ContactAt<'_, S, N>, unknowns: &[f64]) -> Option<Result<PointValues, ContactError>> {
        (**self).values(at, unknowns)
    }
}

/// Compliance unit / factor of every row.
fn softened<const S: usize, const N: usize>(rows: &ContactRows<S, N>, unit: &dyn Fn(usize) -> f64, factor: f64) -> Vec<f64> {
    (0..rows.offset.len()).map(|j| unit(j) / factor).collect()
}

/// Checks the factor of a penalty.
fn positive(factor: f64) -> Result<(), MethodError> {
    if factor > 0.0 && factor.is_finite() { Ok(()) } else { Err(MethodError::Factor(factor)) }
}
