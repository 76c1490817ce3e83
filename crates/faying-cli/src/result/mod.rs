//! Results of a run: the public, serialisable content of `result.json`.

mod answers;
mod couples;
mod forces;
mod solve;

pub use answers::{CheckReport, LineReport, ProbeReport};
pub use couples::{ContactReport, Extremes, Gaps, GluedSides, InterfaceReport, Kkt, L2, MultiplierReport, Norm, SegmentsReport, TiedSides};
pub use forces::{Balance, LoadReport, Moment};
pub use solve::{ActiveSetSummary, Prediction, SolveReport, Unknowns};

use crate::errors::Diagnostic;
use indexmap::IndexMap;
use serde::Serialize;

/// Status of a finished command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Status {
    /// Done, every check passed.
    Ok,
    /// Done, a check failed.
    CheckFailed,
    /// The case is wrong.
    Invalid,
    /// A file could not be read or written.
    IoFailed,
    /// An iteration did not settle.
    NotConverged,
    /// A system has no unique solution.
    Singular,
    /// A number is infinite or not a number.
    NotFinite,
    /// A limit of memory or time was reached.
    Limit,
    /// The user stopped the run.
    Interrupted,
    /// A bug.
    Internal,
}

impl Status {
    /// The exit code that belongs to the status.
    pub fn exit(self) -> i32 {
        match self {
            Self::Ok => 0,
            Self::CheckFailed => 1,
            Self::Invalid => 3,
            Self::IoFailed => 4,
            Self::NotConverged | Self::Singular | Self::NotFinite => 5,
            Self::Limit => 6,
            Self::Internal => 70,
            Self::Interrupted => 130,
        }
    }
}

/// Size and quality of the bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GeometryReport {
    /// Area (volume in 3D) of each patch [length^N].
    pub measure: IndexMap<String, f64>,
    /// Least determinant dx/dxi of the maps from unit cells over all Gauss points, signed by the patch [length^N].
    pub least_jacobian: f64,
    /// Gauss points per direction of the bulk integrals of each patch, the most of its elements; of triangles and tetrahedra one
    /// number, the points of their rule. More than degree + 1 where the map is curved in space, see
    /// [`points_of_curved_cells`](faying::assembly::points_of_curved_cells).
    pub points: IndexMap<String, Vec<usize>>,
    /// Elements of all patches.
    pub elements: usize,
    /// Largest diameter of an element \[length\].
    pub h: f64,
    /// Sides that `coupling = "glue"` joins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub glued: Vec<GluedSides>,
}

/// One step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepReport {
    /// Its time.
    pub t: f64,
    /// Status of the step; checks are decided by the last step alone.
    pub status: Status,
    /// The probes at its end.
    pub probes: Vec<ProbeReport>,
    /// The contacts at its end.
    pub contact: IndexMap<String, ContactReport>,
    /// Its active set iteration, where there is contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_set: Option<ActiveSetSummary>,
}

/// The content of `result.json`.
///
/// A number that is not finite is `null` in the file, with a `reason` beside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RunResult {
    /// "faying.result/1".
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// "run" or "check".
    pub command: String,
    /// Status of the command.
    pub status: Status,
    /// Whether there is a solution; without one the numbers that need it are zero here, and `null` or absent in the file.
    #[serde(skip)]
    pub solved: bool,
    /// The exit code.
    pub exit: i32,
    /// The case file's name.
    pub case: String,
    /// The backend, or slave+master where they differ, or "mixed".
    pub backend: String,
    /// The backend of every patch.
    pub backends: IndexMap<String, String>,
    /// Numbers of unknowns.
    pub unknowns: Unknowns,
    /// Size and quality of the bodies.
    pub geometry: GeometryReport,
    /// The linear algebra.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solve: Option<SolveReport>,
    /// The model in words, a line each: `run --dry` alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub model: Vec<String>,
    /// Predicted size and memory of a run: `check` and `run --dry`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<Prediction>,
    /// Time of the numbers below: that of the last step with a state; `None` without steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
    /// Every contact by name.
    pub contact: IndexMap<String, ContactReport>,
    /// Every tied interface by name.
    pub interface: IndexMap<String, InterfaceReport>,
    /// Reaction force on the body from the support of every side with Dirichlet data \[force\]; a corner's share is split equally
    /// among the sides that hold it.
    pub reactions: IndexMap<String, Vec<f64>>,
    /// Resultant of the loads of every boundary block, by its name, and of what loads the volume of a patch: `PATCH.body_force` with the
    /// weight, `PATCH.source`.
    pub loads: IndexMap<String, LoadReport>,
    /// Sum of all forces.
    pub balance: Balance,
    /// 1/2 a(u, u).
    pub energy: f64,
    /// Every error that can be measured, by its quantity.
    pub errors: IndexMap<String, f64>,
    /// Reason for errors without value, where there is another than that they are not finite.
    #[serde(skip)]
    pub errors_reason: Option<String>,
    /// Probes in the order of the case.
    pub probes: Vec<ProbeReport>,
    /// Lines in the order of the case, at the last step.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<LineReport>,
    /// Checks in the order of the case.
    pub checks: Vec<CheckReport>,
    /// Checks that were decided.
    pub checks_performed: usize,
    /// Checks in the case.
    pub checks_expected: usize,
    /// Checks that were left to another command or backend.
    pub checks_skipped: usize,
    /// Every step, where the case has some.
    pub steps: Vec<StepReport>,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    /// Errors.
    pub diagnostics: Vec<Diagnostic>,
    /// Files written beside this one.
    pub files: Vec<String>,
}

impl RunResult {
    /// An empty result of `command` on the case file `case`.
    pub fn new(command: &str, case: &str) -> Self {
        Self {
            schema: "faying.result/1".into(),
            version: env!("CARGO_PKG_VERSION").into(),
            command: command.into(),
            status: Status::Ok,
            solved: false,
            exit: 0,
            case: case.into(),
            backend: String::new(),
            backends: IndexMap::default(),
            unknowns: Unknowns::default(),
            geometry: GeometryReport::default(),
            solve: None,
            model: Vec::new(),
            predicted: None,
            t: None,
            contact: IndexMap::default(),
            interface: IndexMap::default(),
            reactions: IndexMap::default(),
            loads: IndexMap::default(),
            balance: Balance::default(),
            energy: 0.0,
            errors: IndexMap::default(),
            errors_reason: None,
            probes: Vec::new(),
            lines: Vec::new(),
            checks: Vec::new(),
            checks_performed: 0,
            checks_expected: 0,
            checks_skipped: 0,
            steps: Vec::new(),
            warnings: Vec::new(),
            diagnostics: Vec::new(),
            files: Vec::new(),
        }
    }

    /// The result as a JSON value, numbers that are not finite or were not computed as `null` with a `reason` beside them.
    pub fn to_value(&self) -> serde_json::Value {
        let mut value = self.numbers();
        if !self.solved {
            let looked_at = self.command == "check" || self.predicted.is_some();
            super::null_out::forget(&mut value, looked_at, !self.backends.is_empty());
        }
        value
    }

    /// Every number of the result under its name, computed or not.
    pub(super) fn numbers(&self) -> serde_json::Value {
        let mut value = serde_json::to_value(self).expect("a result has string keys and plain values only");
        if let Some(reason) = &self.errors_reason {
            value["errors"]["reason"] = reason.as_str().into();
        }
        super::json::add_reasons(&mut value);
        value
    }

    /// The text of `result.json`: one line per top-level field, 17 significant digits.
    pub fn to_json(&self) -> String {
        super::json::text(&self.to_value())
    }
}
