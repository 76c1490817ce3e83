//! `[model]` and `[[material]]`: the equation and its constants.

use super::{Components, Head};
use crate::case::given::Given;
use crate::formula::Formula;
use crate::place::{Located, SourceSpan};
use crate::reference::StoredRun;
pub use faying::physics::Assumption;
use faying::physics::MaterialError;
use std::sync::Arc;

/// The equation to solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Physics {
    /// -div(k grad u) = f.
    Poisson,
    /// -div sigma(u) = f.
    Elasticity,
}

/// `[model]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The block.
    pub head: Head,
    /// The equation to solve.
    pub physics: Located<Physics>,
    /// 2 or 3.
    pub dimension: Located<usize>,
    /// Plane strain, plane stress or bodies of revolution; none in space.
    pub assumption: Located<Assumption>,
    /// Manufactured solution, one formula per component.
    pub exact: Option<Located<Vec<Located<Formula>>>>,
    /// Body force (elasticity) or source (Poisson), one formula per component.
    pub source: Option<Located<Vec<Located<Formula>>>>,
    /// Acceleration; needs a density.
    pub gravity: Option<Located<Vec<f64>>>,
    /// Springs of the volume per component; Poisson: the reaction term.
    pub foundation: Components<Formula>,
    /// Path of a stored run that replaces the exact solution.
    pub reference: Option<Located<String>>,
    /// Contents of the stored run.
    pub stored: Option<Arc<StoredRun>>,
}

impl Model {
    /// Components of the unknown: 1 for Poisson, the dimension for elasticity.
    pub fn components(&self) -> usize {
        match self.physics.value {
            Physics::Poisson => 1,
            Physics::Elasticity => self.dimension.value,
        }
    }
}

/// `[[material]]`; constants may be formulas of x, y, z.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The block.
    pub head: Head,
    /// Its name.
    pub name: Located<String>,
    /// A law of the registry; the constants below are not its own.
    pub law: Option<Located<Law>>,
    /// Elastic constants, `None` for Poisson and for a law of the registry.
    pub elastic: Option<Elastic>,
    /// Conductivity, 1 by default; Poisson only.
    pub conductivity: Located<Formula>,
    /// Mass per volume.
    pub density: Option<Located<Formula>>,
}

impl Material {
    /// Whether a constant depends on the time.
    pub fn changes(&self) -> bool {
        match &self.elastic {
            Some(Elastic::YoungPoisson(a, b) | Elastic::Lame(a, b)) => a.depends_on_time() || b.depends_on_time(),
            None => self.conductivity.depends_on_time(),
        }
    }

    /// Place of the constant that an error concerns.
    pub fn place_of(&self, error: &MaterialError) -> SourceSpan {
        match (&self.elastic, error) {
            (Some(Elastic::YoungPoisson(_, nu)), MaterialError::Singular { .. } | MaterialError::Ratio { .. }) => nu.at,
            (Some(Elastic::YoungPoisson(e, _)), _) => e.at,
            (Some(Elastic::Lame(l, _)), MaterialError::Lambda { .. }) => l.at,
            (Some(Elastic::Lame(_, m)), _) => m.at,
            (None, _) => self.conductivity.at,
        }
    }
}

/// A law of the registry.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Its name.
    pub name: String,
    /// Its values.
    pub given: Given,
}

/// Elastic constants in one of two pairs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Elastic {
    /// Young's modulus (force per area) and Poisson's ratio.
    YoungPoisson(Located<Formula>, Located<Formula>),
    /// Lamé's constants lambda and mu (force per area).
    Lame(Located<Formula>, Located<Formula>),
}
