//! `[[boundary]]`: supports and loads.

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

/// Data of some components: one entry per component, `None` if not given.
pub type Components<D> = Vec<Option<Located<D>>>;

/// `[[boundary]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// The block.
    pub head: Head,
    /// Its name, `boundary-0`, ... by default.
    pub name: Located<String>,
    /// The sides; "all-outer" is already resolved, except for sides that are later found to touch others.
    pub on: Vec<Located<SideRef>>,
    /// Whether `on` is "all-outer" in the case.
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
    /// Resultant force per component on a side that moves as a rigid one in this component.
    pub rigid_force: Components<Formula>,
}
