//! The typed case: the content of a case file with all defaults, every value with its place.
//!
//! Vectors have one entry per coordinate (2 or 3), fields one per component of the unknown: 1 for Poisson, the
//! dimension for elasticity. Names of patches and sides are resolved; formulas are parsed.

mod boundary;
mod contact;
mod demand;
mod discretization;
mod model;
mod patch;
mod solver;
mod tie;

pub use boundary::*;
pub use contact::*;
pub use demand::*;
pub use discretization::*;
pub use model::*;
pub use patch::*;
pub use solver::*;
pub use tie::*;

use crate::case::family::Family;
use crate::case::files::FileRead;
use crate::errors::{CaseText, Diagnostics};
use crate::formula::Constants;
use crate::place::{Located, SourceSpan};
use crate::quantities::FieldName;

/// The head of a block, for errors that concern it as a whole.
pub type Head = Located<()>;

/// Names of units, empty where none is given; numbers are never converted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Unit of lengths.
    pub length: String,
    /// Unit of forces.
    pub force: String,
}

impl Units {
    /// The unit of stresses and pressures; empty unless both others are known.
    pub fn stress(&self) -> String {
        if self.length.is_empty() || self.force.is_empty() { String::new() } else { format!("{}/{}²", self.force, self.length) }
    }

    /// "Lengths in mm, forces in N."; empty without names.
    pub fn words(&self) -> String {
        let list = [("lengths in ", &self.length), ("forces in ", &self.force)];
        let given: Vec<String> = list.iter().filter(|(_, unit)| !unit.is_empty()).map(|(what, unit)| format!("{what}{unit}")).collect();
        if given.is_empty() { String::new() } else { format!("Units: {}.", given.join(", ")) }
    }
}

/// Factor of the displacements in the picture of the fields.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Deformed {
    /// The program chooses.
    #[default]
    Auto,
    /// This factor; 0: the bodies at rest.
    Factor(f64),
}

/// A number of the state at a point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PointNumber {
    /// The von Mises stress.
    VonMises,
    /// The length of the displacement.
    Displacement,
    /// A component of u.
    Unknown(usize),
    /// A stress: xx, yy, zz, xy, yz, xz.
    Stress(usize),
    /// Another field of quantities, and the centre of its directions if it has one \[length\].
    Derived(FieldName, [f64; 2]),
}

/// The subject of a panel of `fields.svg`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShownField {
    /// A number on the bodies.
    Bodies {
        /// Its name.
        word: String,
        /// The number.
        number: PointNumber,
    },
    /// The pressure or the multiplier on the slave sides of the contact or the interface of this name.
    Sides(String),
}

/// A whole case.
#[derive(Clone, Debug)]
pub struct Case {
    /// The text that places refer to.
    pub source: CaseText,
    /// Warnings found while reading.
    pub warnings: Diagnostics,
    /// Version of the case file's grammar: 1.
    pub schema: Located<usize>,
    /// Title, empty by default.
    pub title: Located<String>,
    /// `units`: names for pictures and reports.
    pub units: Units,
    /// `deformed` of `[output]`.
    pub deformed: Deformed,
    /// `fields` of `[output]`; empty: the von Mises stress, or u.
    pub fields: Vec<ShownField>,
    /// Constants of `[let]`.
    pub constants: Constants,
    /// `[model]`.
    pub model: Model,
    /// `[discretization]`: the defaults, already merged into every patch.
    pub discretization: Discretization,
    /// `[[material]]`; a Poisson case without any gets one named `default` of conductivity 1.
    pub materials: Vec<Material>,
    /// `[[patch]]`; a file of several patches gives NAME.0, NAME.1, ...
    pub patches: Vec<Patch>,
    /// Pairs of sides with common facets of groups of one mesh.
    pub joints: Vec<Joint>,
    /// Points that patches of one mesh share beside their common facets.
    pub meetings: Vec<Meeting>,
    /// Files that were read beside the case.
    pub files: Vec<FileRead>,
    pub(super) families: Vec<Family>,
    /// `[[boundary]]`.
    pub boundaries: Vec<Boundary>,
    /// `[[interface]]`.
    pub interfaces: Vec<Tie>,
    /// `[[contact]]`.
    pub contacts: Vec<Contact>,
    /// `[steps]`: times, `[1.0]` by default.
    pub steps: Located<Vec<f64>>,
    /// `[solver]`.
    pub solver: Solver,
    /// `[[probe]]`.
    pub probes: Vec<Probe>,
    /// `[[line]]`.
    pub lines: Vec<Line>,
    /// `[[check]]`.
    pub checks: Vec<Check>,
    /// The `[study.NAME]` tables.
    pub studies: Vec<Located<StudyValues>>,
    pub(super) effective: String,
}

impl Case {
    /// Place of the first exact solution, of the model or of a patch.
    pub fn exact_at(&self) -> Option<SourceSpan> {
        let of_patches = self.patches.iter().find_map(|p| p.exact.as_ref());
        self.model.exact.as_ref().or(of_patches).map(|exact| exact.at)
    }

    /// Times at which data are checked: all of the case if they change, else the first.
    pub fn times(&self, changes: bool) -> &[f64] {
        match self.steps.value.as_slice() {
            [] => &[1.0],
            all if changes => all,
            all => &all[..1],
        }
    }
}

impl PartialEq for Case {
    /// Equal content; names of files, places and options do not count.
    fn eq(&self, other: &Self) -> bool {
        self.schema == other.schema
            && self.title == other.title
            && self.units == other.units
            && self.deformed == other.deformed
            && self.fields == other.fields
            && self.constants == other.constants
            && self.model == other.model
            && self.discretization == other.discretization
            && self.materials == other.materials
            && self.patches == other.patches
            && self.joints.iter().map(|j| &j.sides).eq(other.joints.iter().map(|j| &j.sides))
            && self.meetings.iter().map(|m| (&m.patches, m.point)).eq(other.meetings.iter().map(|m| (&m.patches, m.point)))
            && self.boundaries == other.boundaries
            && self.interfaces == other.interfaces
            && self.contacts == other.contacts
            && self.steps == other.steps
            && self.solver == other.solver
            && self.probes == other.probes
            && self.lines == other.lines
            && self.checks == other.checks
            && self.studies == other.studies
    }
}
