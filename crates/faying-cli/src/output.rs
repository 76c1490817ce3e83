//! What a run hands to the files beside its numbers: bodies with fields, sides with multipliers.

use crate::RunResult;
use crate::plot::{self, FieldPlot, PlotError};
use crate::reference::StoredRun;
use crate::table::InterfaceRow;
use faying::linalg::Vector;
use faying_files::vtu::{self, CellStyle, Part, VtuError};

/// What decides about a run beside its case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// Cells of every part; none: Lagrange.
    pub cells: Option<CellStyle>,
    /// Whether the last state is wanted as a stored run.
    pub keep: bool,
}

/// A run that came to an end, a good one or not: its numbers, and what its files show.
///
/// The command line calls `run::run(&Case, &Registry, &RunOptions, &Watch) -> Finished` for `faying run` and
/// `run::check(..) -> Finished` (same arguments) for `faying check`; all errors are in `result.diagnostics`, all warnings,
/// those of the case included, in `result.warnings`.
#[derive(Debug)]
pub struct Finished {
    /// Status, exit code and numbers.
    pub result: RunResult,
    /// What there is to show of the last step; none where nothing was solved (exits 3 and a foreseen 6): then no folder is made.
    pub output: Option<Output>,
    /// Every step with a state, where the case has `[steps]`.
    pub steps: Vec<StepOutput>,
    /// The last state, where it was asked for and the run came to its end.
    pub stored: Option<StoredRun>,
}

/// What there is to show of one step, made when it is asked for.
pub struct StepOutput {
    /// Its number, from 1.
    pub number: usize,
    /// Its time.
    pub t: f64,
    /// Makes it.
    pub make: Box<dyn Fn() -> Output + Send + Sync>,
}

impl std::fmt::Debug for StepOutput {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StepOutput").field("number", &self.number).field("t", &self.t).finish_non_exhaustive()
    }
}

/// The fields of a run, kept until the files are written; closures own what they need (`Arc` of the solution).
#[derive(Debug, Default)]
pub struct Output {
    /// Heading of the pictures: the case's title, else its name.
    pub title: String,
    /// The bodies.
    pub parts: Parts,
    /// The field of the picture; none: no picture.
    pub picture: Option<Picture>,
    /// Interfaces and contacts, in the order of the case.
    pub sides: Vec<SideOutput>,
}

/// One part per patch, in the order of the case: `u` (1) or `displacement` (N), `stress` (6), `von_mises` (1).
///
/// The first is added by [`Part::with_exact`], the others by [`Part::with`].
#[derive(Debug)]
#[non_exhaustive]
pub enum Parts {
    /// Bodies in the plane.
    Plane(Vec<Part<'static, 2, 2>>),
    /// Bodies in space.
    Volume(Vec<Part<'static, 3, 3>>),
}

impl Default for Parts {
    /// No bodies.
    fn default() -> Self {
        Self::Plane(Vec::new())
    }
}

impl Parts {
    /// Number of bodies.
    pub fn len(&self) -> usize {
        match self {
            Self::Plane(parts) => parts.len(),
            Self::Volume(parts) => parts.len(),
        }
    }

    /// Whether there is no body.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The bodies as `fields.vtu`.
    ///
    /// # Errors
    /// As [`vtu::write`].
    pub fn vtu(&self) -> Result<Vec<u8>, VtuError> {
        match self {
            Self::Plane(parts) => vtu::write(parts),
            Self::Volume(parts) => vtu::write(parts),
        }
    }

    /// The bodies as `fields.svg`: plane bodies as they are, solids by their surface.
    ///
    /// # Errors
    /// As [`plot::fields`] and [`plot::solids`].
    pub fn svg(&self, plot: &FieldPlot<'_>) -> Result<String, PlotError> {
        match self {
            Self::Plane(parts) => plot::fields(plot, parts),
            Self::Volume(parts) => plot::solids(plot, parts),
        }
    }
}

/// Which field `fields.svg` shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Name of a field of every part.
    pub field: String,
    /// Component of it.
    pub component: usize,
    /// What the colour bar says.
    pub label: String,
}

/// An exact multiplier at a point of the slave side.
pub type ExactCurve = Box<dyn Fn(&Vector<2>) -> f64 + Send + Sync>;

/// An interface or a contact as its files show it.
pub struct SideOutput {
    /// Name in the case.
    pub name: String,
    /// Whether it is a contact: its picture shows the pressure -lambda, else lambda itself.
    pub contact: bool,
    /// The slave side, [`Lagrange`](faying_files::vtu::CellStyle::Lagrange) or straight, `least_degree` that of the multiplier, with the fields
    /// `lambda` (1, or 2 where tied in elasticity), `gap` (1; where tied the jump along the normal), `active` (1: 0 or 1), `traction` (1 or 2),
    /// `normal` (2, of the master). Files of different sides may have different fields.
    pub part: Part<'static, 1, 2>,
    /// One per multiplier function: the table `interface_NAME.csv`.
    pub rows: Vec<InterfaceRow>,
    /// The case's `exact` multiplier, for the picture.
    pub exact: Option<ExactCurve>,
}

impl std::fmt::Debug for SideOutput {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SideOutput")
            .field("name", &self.name)
            .field("contact", &self.contact)
            .field("part", &self.part)
            .finish_non_exhaustive()
    }
}
