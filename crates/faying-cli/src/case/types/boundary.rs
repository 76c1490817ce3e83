//! `[[boundary]]`: what is held, pressed and pulled.

use super::{Head, SideRef};
use crate::formula::Formula;
use crate::place::Located;

/// Prescribed or applied data of one component.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Datum {
    /// Follows from `exact` of the model.
    Exact,
    /// A formula of x, y, z, t.
    Formula(Formula),
}

/// Data of some components: one entry per component, `None` where nothing is said.
pub type Components<D> = Vec<Option<Located<D>>>;

/// `[[boundary]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// The block.
    pub head: Head,
    /// Its name, `boundary-0`, ... by default.
    pub name: Located<String>,
    /// The sides; "all-outer" is already resolved, but for sides that will be found to touch others.
    pub on: Vec<Located<SideRef>>,
    /// Whether the case says "all-outer".
    pub all_outer: bool,
    /// Keeps facets whose centre satisfies it (`where`).
    pub filter: Option<Located<Formula>>,
    /// Prescribed components: `fix` (zero) and `dirichlet` together.
    pub dirichlet: Components<Datum>,
    /// `fix = ["normal"]`.
    pub fix_normal: Option<Located<()>>,
    /// `fix = ["tangential"]`.
    pub fix_tangential: Option<Located<()>>,
    /// Traction (force per area), or k du/dn: `traction` and `neumann`.
    pub traction: Components<Datum>,
    /// Pressure along minus the outward normal (force per area).
    pub pressure: Option<Located<Formula>>,
    /// Resultant per component, spread evenly, a force.
    pub force: Components<Formula>,
    /// Springs per component (force per area and length).
    pub spring: Components<Formula>,
    /// The side moves as one in this component, resultant given, a force.
    pub rigid_force: Components<Formula>,
}
