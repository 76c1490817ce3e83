//! Output of a run beside its numbers: bodies with fields, slave sides with multipliers.

use crate::RunResult;
use crate::case::Units;
use crate::marks::{Mark, RigidPicture};
use crate::plot::{self, FieldPlot, PlotError};
use crate::reference::StoredRun;
use crate::table::InterfaceRow;
use faying::linalg::Vector;
use faying_files::vtu::{self, CellStyle, Part, VtuError};

/// Options of a run that are not part of its case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// Cells of every part; `None`: Lagrange.
    pub cells: Option<CellStyle>,
    /// Whether to return the last state as a stored run.
    pub keep: bool,
}

/// Outcome of a run, successful or not: its numbers and the data of its files.
///
/// The command line calls `run::run(&Case, &Registry, &RunOptions, &RunControl) -> Finished` for `faying run` and
/// `run::check(..) -> Finished` (same arguments) for `faying check`; all errors are in `result.diagnostics`, all warnings,
/// those of the case included, in `result.warnings`.
#[derive(Debug)]
pub struct Finished {
    /// Status, exit code and numbers.
    pub result: RunResult,
    /// Output of the last step; `None` if nothing was solved (exit 3, or a predicted exit 6), and then no folder is made.
    pub output: Option<Output>,
    /// Every step with a state; empty without `[steps]`.
    pub steps: Vec<StepOutput>,
    /// The last state, if [`RunOptions::keep`] is set and the run finished.
    pub stored: Option<StoredRun>,
}

/// Output of one step, created on demand.
pub struct StepOutput {
    /// Its number, from 1.
    pub number: usize,
    /// Its time.
    pub t: f64,
    /// Creates the output of the step.
    pub make: Box<dyn Fn() -> Output + Send + Sync>,
}

impl std::fmt::Debug for StepOutput {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StepOutput").field("number", &self.number).field("t", &self.t).finish_non_exhaustive()
    }
}

/// The fields of a run, kept until the files are written; closures own their data (`Arc` of the solution).
#[derive(Debug, Default)]
pub struct Output {
    /// Heading of the pictures: the case's title, else its name.
    pub title: String,
    /// Names of the units in the pictures.
    pub units: Units,
    /// The bodies.
    pub parts: Parts,
    /// Panels of `fields.svg`, one below the other; empty: no picture.
    pub panels: Vec<Panel>,
    /// Whether u is an elastic displacement, so that multipliers are stresses.
    pub elastic: bool,
    /// Factor of the displacements on bodies; 0: the bodies at rest.
    pub deformed: DisplacementFactor,
    /// Supports and loads on bodies.
    pub marks: Vec<Mark>,
    /// Rigid obstacles beside bodies.
    pub obstacles: Vec<RigidPicture>,
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

/// The factor of displacements in a picture, found when it is asked for.
pub struct DisplacementFactor(pub Box<dyn Fn() -> f64 + Send + Sync>);

impl Default for DisplacementFactor {
    /// Bodies at rest.
    fn default() -> Self {
        Self(Box::new(|| 0.0))
    }
}

impl std::fmt::Debug for DisplacementFactor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("DisplacementFactor")
    }
}

/// Least and largest value of a field, found when they are asked for; `None` if it is not finite everywhere.
pub struct FieldRange(pub Box<dyn Fn() -> Option<[f64; 2]> + Send + Sync>);

impl std::fmt::Debug for FieldRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FieldRange")
    }
}

/// A panel of `fields.svg`.
#[derive(Debug)]
pub enum Panel {
    /// A field on the bodies.
    Bodies(Picture),
    /// The slave sides of the interface or contact of this name.
    Sides(String),
}

/// A field on the bodies.
#[derive(Debug)]
pub struct Picture {
    /// Name of a field of every part.
    pub field: String,
    /// Component of it; `None`: the root of the sum of their squares.
    pub component: Option<usize>,
    /// Label of the colour bar.
    pub label: String,
    /// Its extremes over the closed elements.
    pub range: FieldRange,
}

/// An exact multiplier at local points of an element of a slave side, components point by point.
pub type ExactAlong = Box<dyn Fn(usize, &[Vector<1>]) -> Vec<f64> + Send + Sync>;

/// A slave side with its fields.
#[derive(Debug)]
#[non_exhaustive]
pub enum SidePart {
    /// A curve in the plane.
    Curve(Part<'static, 1, 2>),
    /// A surface in space.
    Surface(Part<'static, 2, 3>),
}

/// An interface or a contact as its files show it.
pub struct SideOutput {
    /// Name in its files: that of the interface or contact, with the number of the side where there are several; pieces of one side between its
    /// kinks follow each other and have one name.
    pub name: String,
    /// Name of the interface or contact, whose sides one picture shows.
    pub of: String,
    /// The side: PATCH.SIDE.
    pub label: String,
    /// Whether it is a contact: its picture shows the pressure -lambda, else lambda itself.
    pub contact: bool,
    /// The slave side, [`Lagrange`](faying_files::vtu::CellStyle::Lagrange) or straight, `least_degree` that of the multiplier, with the
    /// fields `lambda` (1, or N for ties in elasticity), `gap` (1; for ties the jump along the normal), `active` (1: 0 or 1), `traction`
    /// (1 or N), `normal` (N, of the master), and of contacts `pressure` (1: -lambda). Files of different sides may have different fields.
    pub part: SidePart,
    /// One per multiplier function: the table `interface_NAME.csv`.
    pub rows: Vec<InterfaceRow>,
    /// The exact multiplier of a curve for its picture, of the interface or contact itself, or from the exact solution of the model.
    pub exact: Option<ExactAlong>,
}

impl SideOutput {
    /// The pieces of a side as `interface_NAME.vtu`.
    ///
    /// # Errors
    /// As [`vtu::write`].
    pub fn vtu(pieces: &[Self]) -> Result<Vec<u8>, VtuError> {
        let (mut curves, mut surfaces) = (Vec::new(), Vec::new());
        for piece in pieces {
            match &piece.part {
                SidePart::Curve(part) => curves.push(part),
                SidePart::Surface(part) => surfaces.push(part),
            }
        }
        if curves.is_empty() { vtu::write(&surfaces) } else { vtu::write(&curves) }
    }

    /// The table of a side: the rows of its pieces, of curves along the side.
    pub fn table(pieces: &[Self]) -> Vec<InterfaceRow> {
        let mut rows: Vec<InterfaceRow> = pieces.iter().flat_map(|piece| piece.rows.iter().cloned()).collect();
        if pieces.len() > 1 {
            rows.sort_by(|a, b| a.s.partial_cmp(&b.s).unwrap_or(std::cmp::Ordering::Equal));
        }
        rows
    }
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
